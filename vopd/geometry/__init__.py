"""Geometry that all computations share: rotations, local axes, ellipsoids, lenses, partials."""
