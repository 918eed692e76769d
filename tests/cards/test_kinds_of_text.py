"""Files that are no decks, by their first bytes; and what looks like one and may be a deck."""

from __future__ import annotations

import pytest

from vopd.cards.deck import refuse_other_file
from vopd.findings import VopdError

EXAMPLE = "vopd demo writes an example of a deck"
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


DECKS = [  # what may be a deck: a first card that is mispunched, or behind comments and blank lines
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


@pytest.mark.parametrize("start", DECKS, ids=str)
def test_what_may_be_a_deck_is_not_refused(start: bytes) -> None:
    refuse_other_file(start, "some.file")


@pytest.mark.parametrize(("before", "seen"), [(4096 - 16, True), (4096, False)])
def test_how_far_into_a_file_a_listing_is_looked_for(before: int, seen: bool) -> None:
    start = b"1".ljust(before) + b"L-MARK LONGITUDE"
    if seen:
        with pytest.raises(VopdError, match="this is a listing"):
            refuse_other_file(start, "some.file")
    else:
        refuse_other_file(start, "some.file")
