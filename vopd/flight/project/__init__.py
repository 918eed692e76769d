"""A flight project: its keys, the files that it names, and new projects."""
