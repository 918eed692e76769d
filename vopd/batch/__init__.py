"""Solve many decks and flights into one folder: plan, chunks, processes, resume, summary."""
