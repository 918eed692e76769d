"""Star files in, and their solutions out as text, JSON or CSV."""
