"""`vopd` and `python -m vopd`: the command line as a process.

This module imports little, so that signals are handled before the rest is loaded.
"""

from __future__ import annotations

import gc
import os
import sys

try:
    import signal
except KeyboardInterrupt:  # the one signal that Python has made an exception of by now
    os._exit(130)

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP


def main() -> None:
    """Run the command line and end the process with its exit status."""
    stop_at_signals()
    refuse_small_address_space()
    keep_freed_memory()
    # threads wait for each other in a loop, which on busy processors takes longer than the work
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # a notebook's, which matplotlib refuses where it is not installed; figures go to files alone
    os.environ.pop("MPLBACKEND", None)
    gc.set_threshold(10_000)  # modules are no garbage, and looking for it is 4 % of a start
    from vopd.cli import cli
    from vopd.cli.console import prepare_streams

    prepare_streams()
    try:
        cli()
    finally:
        gc.freeze()  # nor is anything else worth a search while the process ends: 17 %


LEAST_ADDRESS_MB = 300  # below, OpenBLAS may try without end to get memory while scipy is loaded


def refuse_small_address_space() -> None:
    """End the process if its address space is too small for numpy and scipy."""
    try:
        import resource
    except ImportError:  # Windows has no such limit
        return
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit == resource.RLIM_INFINITY:
        return
    if limit < LEAST_ADDRESS_MB * 1_000_000:
        needed = f"vopd needs {LEAST_ADDRESS_MB}"
        sys.exit(f"the address space is limited to {limit / 1e6:.0f} MB (ulimit -v): {needed}")


KEPT_BYTES = 32 << 20, 128 << 20  # arrays of less, the most that glibc takes; of all together
MMAP_THRESHOLD, TRIM_THRESHOLD = -3, -1  # their numbers in malloc.h


def keep_freed_memory() -> None:
    """Keep the memory of freed arrays for the next ones, where the C library is glibc.

    Given back to the system, it comes as pages that are cleared first: a tenth of a solve.
    """
    try:
        from ctypes import CDLL

        set_option = CDLL(None).mallopt
    except (ImportError, OSError, AttributeError, TypeError):  # another library, or system
        return
    for option, most in zip((MMAP_THRESHOLD, TRIM_THRESHOLD), KEPT_BYTES, strict=True):
        set_option(option, most)


def stop_at_signals() -> None:
    """End the process at a signal, unless its caller has it ignore the signal, as nohup does."""
    for name in SIGNALS:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, stop)


def stop(number: int, frame: object) -> None:
    """Remove temporary files, say how far the work had come, and end the process at once.

    The status is 128 + the signal's number.

    Raising an exception instead would leave the process to whatever code was interrupted.
    """
    output = sys.modules.get("vopd.files")
    for name in list(getattr(output, "TEMPORARY", ())):
        try:
            os.unlink(name)  # noqa: PTH108
        except OSError:
            continue
    progress = getattr(sys.modules.get("vopd.cli.console"), "Progress", None)
    for one in getattr(progress, "running", ()):
        if text := one.stop_text():
            try:
                os.write(2, f"\n{text}\n".encode())
            except OSError:
                break
    os._exit(128 + number)


if __name__ == "__main__":
    main()
