"""Results to printed pages, and one listing against another."""
