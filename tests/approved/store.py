"""Expected outputs as files: expected/CASE/stdout, stderr, and files/NAME for each file written.

A file that holds binary data is kept as its content, by the name NAME.txt.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.approved.cases import EXPECTED


def read_expected(name: str, expected: Path = EXPECTED) -> dict[str, str] | None:
    """Read the expected outputs of a case, by name; None where it is not approved yet."""
    folder = expected / name
    if not folder.is_dir():
        return None
    return {
        path.relative_to(folder).as_posix(): path.read_bytes().decode()
        for path in folder.rglob("*")
        if path.is_file()
    }


def write_expected(name: str, outputs: dict[str, str], expected: Path = EXPECTED) -> None:
    """Write the expected outputs of a case in place of those there are."""
    folder = expected / name
    shutil.rmtree(folder, ignore_errors=True)
    for output, text in outputs.items():
        path = folder / output
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode())
