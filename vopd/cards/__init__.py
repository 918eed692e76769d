"""Card images to jobs and back. Knows columns; knows no photogrammetry."""
