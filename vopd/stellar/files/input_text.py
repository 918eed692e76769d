"""Read an input file, or standard input, as bytes or as text."""

from __future__ import annotations

import sys
from pathlib import Path

from vopd.file_signatures import kind_by_first_bytes
from vopd.findings import DeckError, Finding

STANDARD_INPUT = "standard input"


def read_bytes(name: str) -> tuple[bytes, str]:
    """Read an input file.

    Args:
        name: the file's name; `-` is standard input

    Returns:
        Its bytes, and what to call it in messages.

    Raises:
        DeckError: it cannot be read.
    """
    deck = STANDARD_INPUT if name == "-" else name
    try:
        return (sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()), deck
    except (OSError, ValueError) as error:  # ValueError: a null in the name
        reason = str(getattr(error, "strerror", None) or error)
        raise _error(deck, f"cannot be read: {reason}") from None


def read_text(name: str) -> tuple[str, str]:
    """Read an input file as text; arguments, result and errors as `read_bytes` and `as_text`."""
    data, deck = read_bytes(name)
    return as_text(data, deck), deck


def as_text(data: bytes, deck: str) -> str:
    """The text of a file.

    Args:
        data: its bytes
        deck: its name in messages

    Raises:
        DeckError: it is empty, or is not UTF-8 text.
    """
    kind = kind_by_first_bytes(data)
    if kind is not None:
        raise _error(deck, f"this is {kind}; {_advice(kind)}")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise _error(
            deck, f"line {line}: not UTF-8 text (byte 0x{data[error.start]:02X}): save it as UTF-8"
        ) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise _error(deck, f"line {line}: not text: it holds a null byte")
    if not text.strip():
        raise _error(deck, "line 1: the file is empty")
    return text


def _advice(kind: str) -> str:
    """What to do with a file of another kind."""
    if kind.endswith("image"):
        return (
            "the stars in it must be found and identified first: give their image coordinates as "
            "CSV, or corr.fits of astrometry.net, or the JSON of tetra3"
        )
    if kind.endswith("archive"):
        return "unpack it first"
    return "save it as UTF-8 text" if kind.endswith("text") else "export it as CSV"


def _error(deck: str, message: str) -> DeckError:
    return DeckError(Finding(message, deck=deck))
