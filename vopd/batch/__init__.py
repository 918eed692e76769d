"""Whole decks: from cards to pages and tape."""
