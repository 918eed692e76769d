"""Read star files, and write their solutions as text, JSON or CSV."""
