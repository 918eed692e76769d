"""Files that are not decks: each is named for what it is, by every command that reads decks."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kit.command import CASE_1, DECKS, ROOT, vopd

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
