"""Files that are read as listings, and how others are refused: name, line, byte."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from vopd.findings import VopdError
from vopd.listing.compare import read_listing

END = b" END OF CASE\r\n~ !\n"
REFUSED = {
    b"": "empty, not a listing",
    b"text\n": "not a listing: it has none of a listing's headings "
    "(vopd run prints the listing of a deck)",
    b"a\tb": "not a listing: line 1 has the byte 0x09, which is not a printable ASCII character",
    END + b"\x7f": "not a listing: line 3 has the byte 0x7F, which is not a printable ASCII "
    "character",
    END + b"a\xe9\xff": "not a listing: line 3 has the byte 0xE9, which is not a printable ASCII "
    "character",
    b"\n" * 70_000 + b"\x1f": "not a listing: line 70001 has the byte 0x1F, which is not a "
    "printable ASCII character",
}


@pytest.mark.parametrize("name", ["-", "a.lst"])
@pytest.mark.parametrize("content", REFUSED, ids=range(len(REFUSED)))
def test_what_is_no_listing(
    content: bytes, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the name of the file, or standard input."""
    monkeypatch.chdir(tmp_path)
    Path("a.lst").write_bytes(content)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(content)))
    with pytest.raises(VopdError) as refused:
        read_listing(name)
    where = "standard input" if name == "-" else name
    assert str(refused.value) == f"{where}: {REFUSED[content]}"


def test_a_listing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Longer than a piece that is read at a time; carriage returns are kept."""
    content = END + b"x" * 200_000
    file = tmp_path / "a.lst"
    file.write_bytes(content)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(END)))
    assert read_listing(str(file)) == content.decode()
    assert read_listing("-") == END.decode()


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for path, reason in ((tmp_path / "no.lst", "no such file"), (tmp_path, "is a directory")):
        with pytest.raises(VopdError) as refused:
            read_listing(str(path))
        assert str(refused.value).startswith(f"{path}: {reason}")
