"""Read the text of an input file or of standard input."""

from __future__ import annotations

import sys
from pathlib import Path

from vopd.findings import DeckError, Finding

STANDARD_INPUT = "standard input"


def read_text(name: str) -> tuple[str, str]:
    """Read an input file.

    Args:
        name: the file's name; `-` is standard input

    Returns:
        Its text, and what to call it in messages.

    Raises:
        DeckError: it cannot be read, is empty, or is not UTF-8 text.
    """
    deck = STANDARD_INPUT if name == "-" else name
    try:
        data = sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a null in the name
        reason = str(getattr(error, "strerror", None) or error)
        raise _error(deck, f"cannot be read: {reason}") from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise _error(deck, f"line {line}: not text: byte 0x{data[error.start]:02X}") from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise _error(deck, f"line {line}: not text: it holds a null byte")
    if not text.strip():
        raise _error(deck, "line 1: the file is empty")
    return text, deck


def _error(deck: str, message: str) -> DeckError:
    return DeckError(Finding(message, deck=deck))
