"""`vopd` and `python -m vopd`: the command line as a process."""

from __future__ import annotations

import atexit
import os
import sys

from vopd.cli import main


def process() -> None:
    """Run the command line and end at once.

    To take numpy down module by module would cost 20 ms, and nothing needs it.
    """
    try:
        main()
    except SystemExit as end:
        if isinstance(end.code, str):
            raise
        atexit._run_exitfuncs()
        os._exit(_flushed(end.code or 0))


def _flushed(status: int) -> int:
    """The status, or 1 where what is still to be written cannot be."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has seen enough
        pass
    except OSError as error:
        print(f"standard output: {error.strerror}", file=sys.stderr)  # noqa: T201
        return 1
    return status


if __name__ == "__main__":
    process()
