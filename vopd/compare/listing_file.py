"""Read the text of a listing from a file or from standard input; reject other files."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import BinaryIO

from vopd.findings import VopdError
from vopd.listing.lines import is_listing

_TEXT = bytes([*range(0x20, 0x7F), 0x0A, 0x0D])
_CHUNK = 1 << 16


def read_listing(name: str) -> str:
    """Read a listing.

    Args:
        name: name of the file; `-` is standard input

    Returns:
        The text, in printable ASCII.

    Raises:
        VopdError: if the file cannot be read, is empty, has a byte that is no printable ASCII
            character (reading stops there), or has no line that only a listing has.
    """
    where = "standard input" if name == "-" else name
    try:
        if name == "-":
            text = _read(sys.stdin.buffer, where)
        else:
            with Path(name).open("rb") as stream:
                text = _read(stream, where)
    except OSError as error:
        reason = error.strerror or str(error)
        raise VopdError(f"{where}: {reason[:1].lower()}{reason[1:]}") from None
    if not text:
        raise VopdError(f"{where}: empty, not a listing")
    if not is_listing(text):
        raise VopdError(
            f"{where}: not a listing: it has none of a listing's headings "
            "(vopd run prints the listing of a deck)"
        )
    return text


def _read(stream: BinaryIO, where: str) -> str:
    """Read a stream to its end, or to the first byte that no listing has."""
    chunks: list[bytes] = []
    while chunk := stream.read(_CHUNK):
        if chunk.translate(None, _TEXT):
            index = next(k for k, byte in enumerate(chunk) if byte not in _TEXT)
            line = sum(before.count(b"\n") for before in (*chunks, chunk[:index])) + 1
            raise VopdError(
                f"{where}: not a listing: line {line} has the byte 0x{chunk[index]:02X}, "
                "which is not a printable ASCII character"
            )
        chunks.append(chunk)
    return b"".join(chunks).decode("ascii")
