"""The solve of a flight: rotations of its frames, and what is unknown besides them."""
