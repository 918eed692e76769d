"""Expected outputs as files.

Of a case, expected/CASE/stdout, stderr, and files/NAME for each file written. Of all trials, one
text with a heading for each output.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Protocol

Outputs = dict[str, str]
"""Text by the name of an output: stdout, stderr, files/NAME."""


class Store(Protocol):
    """Expected outputs of cases by the name of the case."""

    def names(self) -> set[str]: ...

    def read(self, case: str) -> Outputs | None:
        """Read the expected outputs of a case; None where it is not approved yet."""

    def write(self, case: str, outputs: Outputs) -> None:
        """Write the expected outputs of a case in place of those there are."""


class Folders:
    """A folder for each case, a file for each output."""

    def __init__(self, place: Path) -> None:
        self._place = place

    def names(self) -> set[str]:
        return {path.name for path in self._place.iterdir()} if self._place.exists() else set()

    def read(self, case: str) -> Outputs | None:
        folder = self._place / case
        if not folder.is_dir():
            return None
        return {
            path.relative_to(folder).as_posix(): path.read_bytes().decode()
            for path in folder.rglob("*")
            if path.is_file()
        }

    def write(self, case: str, outputs: Outputs) -> None:
        folder = self._place / case
        shutil.rmtree(folder, ignore_errors=True)
        for output, text in outputs.items():
            path = folder / output
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text.encode())


class OneText:
    """All outputs of all cases in one text, each after a line `##### CASE: OUTPUT`."""

    def __init__(self, path: Path) -> None:
        self._path = path
        text = path.read_bytes().decode() if path.exists() else ""
        _, *parts = re.split(r"^##### (\S+): (.+)\n", text, flags=re.MULTILINE)
        self._cases: dict[str, Outputs] = {}
        for case, output, content in zip(parts[::3], parts[1::3], parts[2::3], strict=True):
            self._cases.setdefault(case, {})[output] = content.removesuffix("\n")

    def names(self) -> set[str]:
        return set(self._cases)

    def read(self, case: str) -> Outputs | None:
        return self._cases.get(case)

    def write(self, case: str, outputs: Outputs) -> None:
        self._cases[case] = outputs
        parts = (
            f"##### {name}: {output}\n{text}\n"
            for name, outputs in self._cases.items()
            for output, text in outputs.items()
        )
        self._path.write_bytes("".join(parts).encode())
