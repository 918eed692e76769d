"""A flight as a deck of 1974 cards, and a deck as a flight project."""
