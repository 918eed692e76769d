"""Attitude histories: the angles of every frame with uncertainty and flags, as a table."""
