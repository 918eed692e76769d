"""Decks of synthetic flights: a scene whose attitude is known, as the cards of program VOPD.

`make(Plan(...))` gives the jobs, ready for `write_deck`, and the truth. Nothing
here is taken from what the program computes: directions and film coordinates
come from vectors and matrices, so that a run which gives the truth back says
something. Only the Earth (its radius, the two latitude series) and the reader's
scale are the program's own constants.
"""
