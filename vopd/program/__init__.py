"""The 1974 computation: one original routine a file, the original's names in lower case."""
