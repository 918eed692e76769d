"""What belongs to the report of Rae (1987) alone: its sample, its printed tables, its listings."""
