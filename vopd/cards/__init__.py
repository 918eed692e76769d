"""Reads and writes card decks: columns of cards to jobs and back, without any photogrammetry."""
