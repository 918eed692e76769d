"""Compare two listings page by page and field by field, as `vopd diff` does."""
