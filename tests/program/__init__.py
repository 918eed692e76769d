"""The computation against hand work and independent code."""
