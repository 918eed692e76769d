"""Bytes of an input file: which text they are, what is said of others, and which reader is used."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from vopd.findings import Finding, InputError
from vopd.stellar.files.read import decoded_text, read_bytes, read_text
from vopd.stellar.files.solve import read_photographs

STARS = (
    "the stars in it must be found and identified first: give their image coordinates as "
    "CSV, or corr.fits of astrometry.net, or the JSON of tetra3"
)
REFUSED = {
    b"\x89PNG\r\n\x1a\n": f"this is a PNG image; {STARS}",
    b"\xff\xd8\xff\xe0": f"this is a JPEG image; {STARS}",
    b"II*\x00more": f"this is a TIFF image; {STARS}",
    b"\x1f\x8b\x08": "this is a gzip archive; unpack it first",
    b"PK\x03\x04": "this is a zip archive or an office document; export it as CSV",
    b"%PDF-1.7": "this is a PDF document; export it as CSV",
    b"\xff\xfea\x00": "this is UTF-16 text; save it as UTF-8 text",
    b"a\nb\nc \xe9\xea": "line 3: not UTF-8 text (byte 0xE9): save it as UTF-8",
    b"\x80": "line 1: not UTF-8 text (byte 0x80): save it as UTF-8",
    b"a\n\nb\0c\n\0": "line 3: not text: it holds a null byte",
    b"\0a": "line 1: not text: it holds a null byte",
    b"": "line 1: the file is empty",
    b" \n\t\r\n": "line 1: the file is empty",
    b"\xef\xbb\xbf\n": "line 1: the file is empty",
}


@pytest.mark.parametrize("data", REFUSED, ids=repr)
def test_what_is_no_text(data: bytes) -> None:
    with pytest.raises(InputError) as caught:
        decoded_text(data, "a.csv")
    assert str(caught.value) == f"a.csv: {REFUSED[data]}"


def test_text_has_no_mark_of_its_encoding() -> None:
    assert decoded_text(b"\xef\xbb\xbfx,\xc3\xa9\r\n", "a.csv") == "x,é\r\n"


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    missing = str(tmp_path / "none.csv")
    for name, reason in ((missing, "No such file or directory"), (str(tmp_path), "Is a directory")):
        with pytest.raises(InputError) as caught:
            read_bytes(name)
        assert str(caught.value) == f"{name}: cannot be read: {reason}"
    with pytest.raises(InputError, match=r"^cannot be read: Is a directory$"):
        read_bytes("")
    with pytest.raises(InputError, match=r"^a\x00b: cannot be read: embedded null byte$"):
        read_bytes("a\0b")


class Stream(NamedTuple):
    """Standard input of these bytes."""

    buffer: io.BytesIO


def test_standard_input_has_a_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for data in (b"a,b\n", b""):
        monkeypatch.setattr(sys, "stdin", Stream(io.BytesIO(data)))
        if data:
            assert read_text("-") == ("a,b\n", "standard input")
            continue
        with pytest.raises(InputError, match=r"^standard input: line 1: the file is empty$"):
            read_text("-")
    file = tmp_path / "a.csv"
    file.write_bytes(b"a\n")
    assert read_bytes(str(file)) == (b"a\n", str(file))


TABLE = "x_mm,y_mm,u,v,w,hue\n1,2,0,0,-1,3\n"
SOLVED = json.dumps({"matched_centroids": [[2.0, 1.0]], "matched_stars": [[80.0, -5.0, 2.5]]})
FORMATS = {  # a text: the unit of its photographs, and how many there are
    TABLE: ("mm", 1),
    SOLVED: ("px", 1),
    f"\n  {SOLVED}": ("px", 1),
    f"[{SOLVED},{SOLVED}]": ("px", 2),
    f" \r\n[{SOLVED}]": ("px", 1),
    f"{SOLVED}\n{SOLVED}\n{SOLVED}\n": ("px", 3),
}


@pytest.mark.parametrize("text", FORMATS, ids=repr)
def test_the_format_is_known_by_the_content(text: str, tmp_path: Path) -> None:
    """The name says nothing; messages have the file's name."""
    file, found = tmp_path / "of_any_name", list[Finding]()
    file.write_text(text)
    photographs = read_photographs(str(file), found.append)
    assert ({one.unit for one in photographs}, len(photographs)) == (
        {FORMATS[text][0]},
        FORMATS[text][1],
    )
    for one in photographs:
        assert (one.deck, one.image.tolist()) == (str(file), [[1.0, 2.0]])
    said = [(one.deck, one.message, one.severity) for one in found]
    ignored = (str(file), "line 1: columns that are ignored: hue", "warning")
    assert said == ([ignored] if text == TABLE else [])


def test_only_the_beginning_makes_it_fits(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("# SIMPLE  =\nx_mm,y_mm,u,v,w\n1,2,0,0,-1\n")
    assert len(read_photographs(str(file), list[Finding]().append)) == 1


@pytest.mark.parametrize("text", ["SIMPLE  =    no", "{", "x_mm\n"])
def test_errors_name_the_file(text: str, tmp_path: Path) -> None:
    file = tmp_path / "broken"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_photographs(str(file), list[Finding]().append)
    assert caught.value.finding.deck == str(file)
    assert ("not a FITS file that can be read" in str(caught.value)) == text.startswith("SIMPLE")


@pytest.mark.parametrize("data", [b"SIMPLE  =    no", b"{", b"x_mm\n"])
def test_errors_name_standard_input(data: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Stream(io.BytesIO(data)))
    with pytest.raises(InputError) as caught:
        read_photographs("-", list[Finding]().append)
    assert caught.value.finding.deck == "standard input"
