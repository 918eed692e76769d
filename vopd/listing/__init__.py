"""Turn results into the printed pages of the 1974 program, and into its tape 10."""
