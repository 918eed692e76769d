"""Makes card decks of synthetic flights whose attitude is known.

`make(Plan(...))` gives the jobs, ready for `write_deck`, and the true attitude.
Nothing here is taken from what the program computes: directions and film
coordinates come from vectors and matrices, so that it says something if a run
gives the truth back. Only the Earth (its radius, the two latitude series) and
the reader's scale are the program's own constants.
"""
