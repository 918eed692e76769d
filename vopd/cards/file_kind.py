"""Recognises files that are not card decks, so that the message can name what they are."""

from __future__ import annotations

import re

from vopd.file_signatures import kind_by_first_bytes
from vopd.findings import VopdError

ADVICE = {
    "a CSV file of stars": "vopd stars solve takes it",
    "a listing": "vopd diff compares listings",
}
"""What to do with a file of some kinds."""

_NUMBERS = r"[\d .+\-EeDd]*"
"""What the two fields of a deck's first card can hold, columns 1 to 20."""
_COMMA_SEPARATED = r"[^,;]*[,;][^,;]*[,;]|[A-Za-z_]\w*\s*[,;]"
_STAR_COLUMNS = r"\s*x_mm\s*,\s*y_mm\b"
_TOML = r"\[+[\w.\"' -]+\]+\s*(#.*)?$|[\w.\"'-]+\s*=\s*\S"
_JSON = r"[\[{]\s*($|[{\"\d-]|\[(?![A-Za-z_])|\]|\})"  # [[table]] is TOML
_MARKUP = r"(?i)<(!doctype html|html|head|body)\b"


_LISTING = "L-MARK LONGITUDE"


def refuse_other_file(start: bytes, name: str) -> None:
    """Raise `VopdError` for a file that is certainly not a deck of cards.

    Args:
        start: the first bytes of the file; a few thousand suffice
        name: the file's name, for the message
    """
    kind = _kind(start[:4096])
    if kind is not None:
        advice = ADVICE.get(kind, "vopd demo writes an example of a deck")
        raise VopdError(f"{name}: this is {kind}, not a deck of 80-column cards; {advice}")


def _kind(start: bytes) -> str | None:
    """What a file is, such as "a PNG image"; None where it may be a deck."""
    kind = kind_by_first_bytes(start)
    if kind is not None:
        return kind
    text = start.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    if _LISTING in text:
        return "a listing"
    lines = filter(str.strip, text.splitlines())
    line = next(lines, "")
    if re.fullmatch(_NUMBERS, line[:20]):
        return None
    while line.lstrip().startswith("#"):
        line = next(lines, "")
    return _kind_of_text(line.strip()) if line else None


def _kind_of_text(line: str) -> str | None:
    """What a text file is by its first line that is neither blank nor a comment."""
    if line.startswith("<"):
        return "an HTML page" if re.match(_MARKUP, line) else "an XML file"
    if re.match(_JSON, line):
        return "a JSON file"
    if re.match(_TOML, line):
        return "a TOML file"
    if re.match(_STAR_COLUMNS, line):
        return "a CSV file of stars"
    return "a CSV file" if re.match(_COMMA_SEPARATED, line) else None
