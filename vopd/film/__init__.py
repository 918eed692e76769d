"""Solve the jobs of card decks, and make of the results what `vopd.attitude` takes."""
