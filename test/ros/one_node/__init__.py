"""
Tests of one node with the usual parameters, which all files here share.

A test of how a node starts or ends, of its parameters at the start or of its memory, or one that
counts what it has published since then, has a node of its own and is elsewhere.
"""
