"""tools/other_processor.py makes numpy and OpenBLAS compute as an older processor would."""

from __future__ import annotations

import os
import platform
import subprocess
import sys

import pytest

from tests.kit.command import KERNELS, ROOT

TOOL = ROOT / "tools" / "other_processor.py"
LEFT = """import os, sys
sys.path.insert(0, sys.argv[1])
import numpy
from other_processor import features
print(*features(), os.environ["OPENBLAS_CORETYPE"])
"""
pytestmark = pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"), reason="no x86-64 processor"
)


def ran(*arguments: str, **settings: str) -> subprocess.CompletedProcess[str]:
    plain = {name: value for name, value in os.environ.items() if name not in KERNELS}
    return subprocess.run(
        [sys.executable, TOOL, *arguments], env=plain | settings, capture_output=True, text=True
    )


def test_numpy_has_what_the_processor_has() -> None:
    """Every feature that is disabled is one that numpy found: of another one it would warn."""
    command = [sys.executable, "-W", "error", "-c", LEFT, str(TOOL.parent)]
    older = ran("Nehalem", *command)
    assert (older.stdout, older.stderr) == ("Nehalem\n", "")
    newer = ran("Haswell", *command)
    assert newer.stderr == "" and newer.stdout.endswith("Haswell\n")
    assert "AVX512" not in newer.stdout and "X86_V4" not in newer.stdout


def test_the_status_is_that_of_the_command() -> None:
    assert ran("Nehalem", sys.executable, "-c", "raise SystemExit(3)").returncode == 3


def test_settings_are_printed_without_a_command() -> None:
    assert ran("Haswell").stdout.endswith("OPENBLAS_CORETYPE=Haswell\n")


def test_settings_that_hide_features_are_refused() -> None:
    done = ran("Haswell", NPY_DISABLE_CPU_FEATURES="none")
    assert done.returncode == 2 and "NPY_DISABLE_CPU_FEATURES is set already" in done.stderr
