"""Tests of the package, a folder to a room."""

import os

# As the commands have it, before numpy is loaded: a process for each processor is enough.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
