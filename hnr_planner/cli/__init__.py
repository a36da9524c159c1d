"""The command line: one file for each command, thin over the core, the maps and the drawing."""
