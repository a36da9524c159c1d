"""The command line: one file for each command, which calls the core, the maps and the drawing."""
