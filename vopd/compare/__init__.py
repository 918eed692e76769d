"""Compare one printed listing with another, field by field."""
