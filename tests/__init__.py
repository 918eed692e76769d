"""Tests of the package, a folder to a room."""

import os
import time

# Far from UTC, so that no test can take the machine's clock for it.
os.environ["TZ"] = "TEST-05:45"
if hasattr(time, "tzset"):  # not on Windows
    time.tzset()

# As the commands have it, before numpy is loaded: a process for each processor is enough.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
