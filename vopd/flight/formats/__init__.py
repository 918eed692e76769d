"""Formats of the files that a flight project names: a module for each kind of file."""
