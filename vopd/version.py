"""The version, for the package's door, its files and its build."""

__version__ = "0.1.0"
