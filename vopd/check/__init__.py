"""Looks a deck over without running it: errors, and conditions that the original did not report."""
