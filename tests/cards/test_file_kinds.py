"""Files that are not decks, by their first bytes and lines; and what may be a deck."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, DECKS, ROOT, vopd
from vopd.cards.deck import refuse_other_file
from vopd.findings import VopdError

OTHER_FILES = {
    "PNG": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
    "JPEG": b"\xff\xd8\xff\xe0\0\x10JFIF",
    "PDF": b"%PDF-1.7\n%\xe2\xe3\n",
    "zip": b"PK\x03\x04\x14\0",
    "gzip": b"\x1f\x8b\x08\0",
    "HTML": b"\n<!DOCTYPE html>\n<html>\n",
    "KML": b'<?xml version="1.0"?>\n<kml>\n',
    "TOML table": b"# a flight\n\n[camera]\nx = 3\n",
    "TOML key": b'title = "AV-4"\n',
    "JSON object": b'{"frames": []}\n',
    "JSON array": b"[\n  1,\n  2\n]\n",
    "JSON with a mark": b'\xef\xbb\xbf{"a": 1}',
    "CSV": b"time_s,yaw_deg\n1,2\n",
    "CSV of numbers": b"1,2.5,3\n1,2,3\n",
    "CSV, semicolons": b"1;2,5;3\n",
    "stars": (DECKS / "stars" / "orion.csv").read_bytes(),
    "listing": (ROOT / "golden_outputs" / "appendix_h" / "case1.lst").read_bytes(),
    "UTF-16": "1 2 3".encode("utf-16"),
}


@pytest.mark.parametrize("name", OTHER_FILES)
def test_what_it_is_and_what_to_do(name: str, tmp_path: Path) -> None:
    file = tmp_path / "input"
    file.write_bytes(OTHER_FILES[name])
    done = vopd("run", file)
    assert (done.status, done.stdout) == (1, "")
    assert_approved(done.stderr, parts=[file])


@pytest.mark.parametrize("command", ["run", "check", "cards", "attitude"])
def test_every_command_that_reads_decks(command: str) -> None:
    done = vopd(command, "-", stdin=OTHER_FILES["PNG"])
    assert done.status == 1
    assert_approved(done.stdout + done.stderr)


@pytest.mark.parametrize("first_card", ["       .5        5.", "", "      3,5       55.", "[x"])
def test_a_deck_with_a_mistake_is_still_a_deck(first_card: str) -> None:
    """The first card may be blank or mispunched: the message is then about its field."""
    cards = CASE_1.read_text().splitlines()
    done = vopd("run", "-", stdin="\n".join([first_card, *cards[1:]]))
    assert "not a deck" not in done.stderr


# Kinds of text


OTHERS = {  # the beginning of a file: what it is
    b"\x89PNG\r\n\x1a\n": "PNG",
    b"%PDF-1.7\n": "PDF",
    b"<!doctype HTML>\n": "HTML",
    b"<html>": "HTML",
    b"<HEAD lang='en'>": "HTML",
    b"<body>": "HTML",
    b"<kml>": "XML",
    b"\n\n  <bodyguard/>": "XML",
    b"[camera]\n": "TOML",
    b"[[job]]  # the first\n": "TOML",
    b"# a flight\n#\n\ntitle = 1\n": "TOML",
    b"a.b='x'\n": "TOML",
    b"{\n": "JSON",
    b'{"a": 1}': "JSON",
    b"[]": "JSON",
    b"{}": "JSON",
    b"[[1, 2]]": "JSON",
    b"[[": "JSON",
    b"[-1.5]": "JSON",
    b"[ 3": "JSON",
    b"[\n1\n]": "JSON",
    b"\xef\xbb\xbf{}": "JSON",
    b"x_mm,y_mm,u\n": "stars",
    b" x_mm , y_mm\n": "stars",
    b"\xef\xbb\xbfx_mm,y_mm": "stars",
    b"# stars\nx_mm,y_mm,ra_deg\n": "stars",
    b"x_mm,y_mmm,u": "CSV",
    b"star, RA_deg,dec_deg,x_px,y_px\n": "stars",
    b"x_px,y_px,ra\n": "stars",
    b"frame,range_m,x_px": "CSV",
    b"1,2,3": "CSV",
    b"1;2,5;3": "CSV",
    b"1;2;3": "CSV",
    b"1,2;3": "CSV",
    b"frame,": "CSV",
    b"time_s ; yaw": "CSV",
    b"1" + 70 * b" " + b"\n L-MARK LONGITUDE": "listing",
    b'{"conventions": {"program": "vopd 0.1.0", "project": "a.toml"}}\n': "results",
    b"# program: vopd 0.1.0\n# project: a.toml\nframe,yaw_deg\n": "results",
    b'[\n  {\n    "deck": "a.toml",\n    "errors": [],\n    "warnings": []\n  }\n]\n': "results",
    b'[\n{"method": "svd", "stars": [1, 2]': "vopd stars solve",
    b'[\n{"image": "a \\"b\\".csv", "method": "svd", "st': "vopd stars solve",
    b"image,method,stars,omega_deg,phi_deg\n": "vopd stars solve",
    b'{\n  "source": "a.toml",\n  "frames": 5,\n': "results",
    b'{\n  "version": 1,\n  "adjusted_from": "a.toml",\n': "results",
    b'[\n  {\n    "deck": "a.toml",\n    "images": []\n  }\n]\n': "JSON",
    b'{"program": "another 1"}': "JSON",
    80 * b" \n" + b"PAGE 1\n L-MARK LONGITUDE\n": "listing",
}


@pytest.mark.parametrize("start", OTHERS, ids=str)
def test_what_a_file_is_and_what_to_do(start: bytes) -> None:
    with refused(VopdError, parts=[OTHERS[start]]):
        refuse_other_file(start, "some.file")


MAY_BE_DECKS = [  # a first card that is mispunched, or behind comments and blank lines
    b"",
    b"\n\n",
    b"# nothing but a comment\n",
    b"       .5        5.\n",
    b"     1.E1    -2.D-1\n",
    b"  +1.e+0   3.d0     , no field any more, of the card\n",
    b"       0.        0.[a]\n",
    b"      3,5       55.\n",
    b"      O.5        5.\n",
    b"1,x2\n",
    b"1;x2\n",
    b"x\n",
    b"[x\n",
    b"title\n",
    b"title =\n",
    b"{x\n",
    b"       .5        5.\n1,2,3\n",
]


@pytest.mark.parametrize("start", MAY_BE_DECKS, ids=str)
def test_what_may_be_a_deck_is_not_refused(start: bytes) -> None:
    refuse_other_file(start, "some.file")


@pytest.mark.parametrize(("before", "seen"), [(4096 - 16, True), (4096, False)])
def test_how_far_into_a_file_a_listing_is_looked_for(before: int, seen: bool) -> None:
    start = b"1".ljust(before) + b"L-MARK LONGITUDE"
    if seen:
        with refused(VopdError):
            refuse_other_file(start, "some.file")
    else:
        refuse_other_file(start, "some.file")
