"""Tests of the command line, the pictures, the demo and the README."""
