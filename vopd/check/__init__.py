"""Check a deck without running it: errors, and conditions that the original did not report."""
