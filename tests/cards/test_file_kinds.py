"""Files that are not decks, by their first bytes and lines; and what may be a deck."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.approved.texts import refused
from tests.kit.command import CASE_1, DECKS, ROOT, vopd
from vopd.cards.deck import refuse_other_file
from vopd.findings import VopdError

EXAMPLE = "vopd demo writes an example of a deck"

OTHER_FILES: dict[str, tuple[bytes, str]] = {
    "PNG": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", f"a PNG image, {{}}; {EXAMPLE}"),
    "JPEG": (b"\xff\xd8\xff\xe0\0\x10JFIF", f"a JPEG image, {{}}; {EXAMPLE}"),
    "PDF": (b"%PDF-1.7\n%\xe2\xe3\n", f"a PDF document, {{}}; {EXAMPLE}"),
    "zip": (b"PK\x03\x04\x14\0", f"a zip archive or an office document, {{}}; {EXAMPLE}"),
    "gzip": (b"\x1f\x8b\x08\0", f"a gzip archive, {{}}; {EXAMPLE}"),
    "HTML": (b"\n<!DOCTYPE html>\n<html>\n", f"an HTML page, {{}}; {EXAMPLE}"),
    "KML": (b'<?xml version="1.0"?>\n<kml>\n', f"an XML file, {{}}; {EXAMPLE}"),
    "TOML table": (b"# a flight\n\n[camera]\nx = 3\n", f"a TOML file, {{}}; {EXAMPLE}"),
    "TOML key": (b'title = "AV-4"\n', f"a TOML file, {{}}; {EXAMPLE}"),
    "JSON object": (b'{"frames": []}\n', f"a JSON file, {{}}; {EXAMPLE}"),
    "JSON array": (b"[\n  1,\n  2\n]\n", f"a JSON file, {{}}; {EXAMPLE}"),
    "JSON with a mark": (b'\xef\xbb\xbf{"a": 1}', f"a JSON file, {{}}; {EXAMPLE}"),
    "CSV": (b"time_s,yaw_deg\n1,2\n", f"a CSV file, {{}}; {EXAMPLE}"),
    "CSV of numbers": (b"1,2.5,3\n1,2,3\n", f"a CSV file, {{}}; {EXAMPLE}"),
    "CSV, semicolons": (b"1;2,5;3\n", f"a CSV file, {{}}; {EXAMPLE}"),
    "stars": (
        (DECKS / "stars" / "orion.csv").read_bytes(),
        "a CSV file of stars, {}; vopd stars solve takes it",
    ),
    "listing": (
        (ROOT / "golden_outputs" / "appendix_h" / "case1.lst").read_bytes(),
        "a listing, {}; vopd diff compares listings",
    ),
    "UTF-16": ("1 2 3".encode("utf-16"), f"UTF-16 text, {{}}; {EXAMPLE}"),
}


@pytest.mark.parametrize("name", OTHER_FILES)
def test_what_it_is_and_what_to_do(name: str, tmp_path: Path) -> None:
    content, words = OTHER_FILES[name]
    file = tmp_path / "input"
    file.write_bytes(content)
    words = words.format("not a deck of 80-column cards")
    done = vopd("run", file)
    assert (done.status, done.stdout) == (1, "")
    assert done.stderr == f"{file}: this is {words}\n"


@pytest.mark.parametrize("command", ["run", "check", "cards", "attitude"])
def test_every_command_that_reads_decks(command: str) -> None:
    done = vopd(command, "-", stdin=OTHER_FILES["PNG"][0])
    assert done.status == 1
    assert "-: this is a PNG image, not a deck" in done.stdout + done.stderr


@pytest.mark.parametrize("first_card", ["       .5        5.", "", "      3,5       55.", "[x"])
def test_a_deck_with_a_mistake_is_still_a_deck(first_card: str) -> None:
    """The first card may be blank or mispunched: the message is then about its field."""
    cards = CASE_1.read_text().splitlines()
    done = vopd("run", "-", stdin="\n".join([first_card, *cards[1:]]))
    assert "not a deck" not in done.stderr


# Kinds of text


ADVICE = {
    "a CSV file of stars": "vopd stars solve takes it",
    "a listing": "vopd diff compares listings",
}
OTHERS = {  # the beginning of a file: what it is
    b"\x89PNG\r\n\x1a\n": "a PNG image",
    b"%PDF-1.7\n": "a PDF document",
    b"<!doctype HTML>\n": "an HTML page",
    b"<html>": "an HTML page",
    b"<HEAD lang='en'>": "an HTML page",
    b"<body>": "an HTML page",
    b"<kml>": "an XML file",
    b"\n\n  <bodyguard/>": "an XML file",
    b"[camera]\n": "a TOML file",
    b"[[job]]  # the first\n": "a TOML file",
    b"# a flight\n#\n\ntitle = 1\n": "a TOML file",
    b"a.b='x'\n": "a TOML file",
    b"{\n": "a JSON file",
    b'{"a": 1}': "a JSON file",
    b"[]": "a JSON file",
    b"{}": "a JSON file",
    b"[[1, 2]]": "a JSON file",
    b"[[": "a JSON file",
    b"[-1.5]": "a JSON file",
    b"[ 3": "a JSON file",
    b"[\n1\n]": "a JSON file",
    b"\xef\xbb\xbf{}": "a JSON file",
    b"x_mm,y_mm,u\n": "a CSV file of stars",
    b" x_mm , y_mm\n": "a CSV file of stars",
    b"\xef\xbb\xbfx_mm,y_mm": "a CSV file of stars",
    b"# stars\nx_mm,y_mm,ra_deg\n": "a CSV file of stars",
    b"x_mm,y_mmm,u": "a CSV file",
    b"1,2,3": "a CSV file",
    b"1;2,5;3": "a CSV file",
    b"1;2;3": "a CSV file",
    b"1,2;3": "a CSV file",
    b"frame,": "a CSV file",
    b"time_s ; yaw": "a CSV file",
    b"1" + 70 * b" " + b"\n L-MARK LONGITUDE": "a listing",
    80 * b" \n" + b"PAGE 1\n L-MARK LONGITUDE\n": "a listing",
}


@pytest.mark.parametrize("start", OTHERS, ids=str)
def test_what_a_file_is_and_what_to_do(start: bytes) -> None:
    kind = OTHERS[start]
    with pytest.raises(VopdError) as caught:
        refuse_other_file(start, "some.file")
    advice = ADVICE.get(kind, EXAMPLE)
    assert str(caught.value) == (
        f"some.file: this is {kind}, not a deck of 80-column cards; {advice}"
    )


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
