"""What a run has done so far, beside its output: the same command goes on where it stopped.

Blocks are appended while the run goes on, so that nothing but the last frames is lost however the
process ends, and so that the memory of a run does not grow with the video.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from vopd.findings import VopdError

ATTITUDE = np.dtype([
    ("frame", "i4"), ("known", "i1"), ("segment", "i4"), ("rotation", "f8", (3, 3)),
    ("begins", "?"), ("cut", "i4"), ("state", "i4"), ("hidden", "i4"), ("predicted", "i4"),
    ("lost", "i4"),
])  # fmt: skip
"""A frame of the first run; `state` is the frame that the next one is aligned with, `lost` that
from which the track is lost; each -1 where there is none."""
ROW = np.dtype([
    ("frame", "i4"), ("landmark", "i4"), ("click", "i4"), ("pixel", "f8", (2,)), ("sigma", "f8"),
    ("by_click", "f8", (2, 2)), ("correlation", "f4"), ("status", "i1"),
    ("residual", "f4", (2,)),
])  # fmt: skip
"""A row of the tracked file, its sigma before it is scaled."""
KINDS = {"forward": ATTITUDE, "backward": ATTITUDE, "row": ROW}
AT_ONCE = 40  # frames a block

Block = NDArray[Any]
SUM = 4  # bytes of a block's check sum


def _sum(head: bytes, content: bytes) -> bytes:
    """Make the check sum of a block."""
    return crc32(content, crc32(head)).to_bytes(SUM, "little")


class Journal:
    """The blocks of a run.

    Args:
        path: of the file
        about: on what the run depends; blocks of another run are thrown away
    """

    def __init__(self, path: Path, about: dict[str, Any]) -> None:
        self.path = path
        self._head = (json.dumps(about, sort_keys=True, default=str) + "\n").encode()
        self._begun = path.is_file() and self._first_line() == self._head
        if self._begun:
            self._cut()
        self._size = self._size_now()

    def _size_now(self) -> int:
        """Measure the file, bytes; -1 where there is none."""
        return self.path.stat().st_size if self.path.is_file() else -1

    def _first_line(self) -> bytes:
        with self.path.open("rb") as file:
            return file.readline()

    def add(self, kind: str, block: Block) -> None:
        """Append a block; an empty one ends its kind.

        Raises:
            VopdError: where it cannot be written, or another run writes the file
        """
        if self._size_now() != self._size:
            raise VopdError(
                f"{self.path}: another run of vopd track writes this file: wait until it ends, and "
                "repeat the command if its tracks are not there then"
            )
        name = kind.encode().ljust(8)
        size = len(block).to_bytes(8, "little")
        content = np.ascontiguousarray(block, KINDS[kind]).tobytes()
        head = b"" if self._begun else self._head
        try:
            with self.path.open("ab" if self._begun else "wb") as file:
                file.write(head + name + size + _sum(name + size, content) + content)
        except OSError as error:
            raise VopdError(f"{self.path}: cannot be written: {error.strerror}") from error
        self._begun = True
        self._size = self._size_now()

    def blocks(self, kind: str) -> Iterator[Block]:
        """Read the blocks of one kind, the one that ends it included."""
        for one, place, size in self._scan():
            if one == kind:
                with self.path.open("rb") as file:
                    file.seek(place)
                    yield np.frombuffer(file.read(size), KINDS[kind])

    def _scan(self) -> Iterator[tuple[str, int, int]]:
        """Find the kinds of whole blocks, and where they are, as far as none is damaged.

        After a failure of the power a file may have zeros within it that were never written.
        """
        if not self._begun:
            return
        with self.path.open("rb") as file:
            file.readline()
            end = self.path.stat().st_size
            while len(head := file.read(16 + SUM)) == 16 + SUM:
                kind = head[:8].strip().decode("ascii", "replace")
                if kind not in KINDS:
                    return
                size = int.from_bytes(head[8:16], "little") * KINDS[kind].itemsize
                place = file.tell()
                if place + size > end or _sum(head[:16], file.read(size)) != head[16:]:
                    return
                yield kind, place, size

    def _cut(self) -> None:
        """Cut off a block that is not whole, and what follows it."""
        end = len(self._head)
        for _, place, size in self._scan():
            end = place + size
        with self.path.open("r+b") as file:
            file.truncate(end)

    def remove(self) -> None:
        """Delete the file: the output is there."""
        self.path.unlink(missing_ok=True)
