"""What holds the package to its sources; the folders mirror those of `vopd`."""
