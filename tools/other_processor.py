"""Run a command as an older x86-64 processor would compute.

    python tools/other_processor.py Haswell python -m pytest
    python tools/other_processor.py Nehalem python -m pytest
    python tools/other_processor.py Nehalem

numpy chooses its functions, and OpenBLAS its kernels, by the processor's instructions: the last
digits depend on it. As a Haswell both do without AVX-512; as a Nehalem numpy has only the
instructions that it requires, and OpenBLAS no AVX and no FMA. Without a command the settings are
printed. They name only features that numpy finds on this processor, since it warns of others.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys

PROCESSORS = ("Haswell", "Nehalem")  # names of OpenBLAS
FEATURES = "NPY_DISABLE_CPU_FEATURES"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("processor", choices=PROCESSORS)
    parser.add_argument("command", nargs=argparse.REMAINDER, help="without it: print the settings")
    given = parser.parse_args()
    if platform.machine() not in ("x86_64", "AMD64"):
        parser.error(f"{platform.machine()}: only an x86-64 processor can compute as another one")
    if FEATURES in os.environ:
        parser.error(f"{FEATURES} is set already, and hides features from numpy: unset it")
    settings = settings_of(given.processor, features())
    if not given.command:
        print(*(f"{name}={value}" for name, value in settings.items()))
        return 0
    return subprocess.run(given.command, env=os.environ | settings, check=False).returncode


def features() -> list[str]:
    """List the features of this processor for which numpy has functions, by numpy's names."""
    import numpy

    core = getattr(numpy, "_core", None) or numpy.core
    core = core._multiarray_umath
    return [name for name in core.__cpu_dispatch__ if core.__cpu_features__[name]]


def settings_of(processor: str, found: list[str]) -> dict[str, str]:
    """Choose the variables of the environment that make numpy and OpenBLAS compute as a processor.

    Args:
        processor: one of `PROCESSORS`
        found: the features of this processor, by numpy's names
    """
    newer = [name for name in found if name == "X86_V4" or name.startswith("AVX512")]
    without = newer if processor == "Haswell" else found
    settings = {FEATURES: ",".join(without)} if without else {}
    return settings | {"OPENBLAS_CORETYPE": processor}


if __name__ == "__main__":
    sys.exit(main())
