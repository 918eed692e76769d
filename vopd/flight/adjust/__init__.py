"""Joint adjustment of a flight: its table, its tests, and the project that it writes."""
