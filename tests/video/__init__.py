"""Tests of the room that reads videos."""
