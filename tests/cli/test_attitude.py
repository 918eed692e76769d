"""`vopd attitude`: formats by suffix and name, exit statuses, and bad input that leaves nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.attitude_files import EPOCH, deck_text
from tests.kit.command import DECKS, ROOT, vopd
from tests.kit.jobs import reread
from vopd.cards.read import read_deck
from vopd.cards.write import write_deck
from vopd.export import FORMATS

FIRST_BYTES = {
    "csv": b"# program: vopd",
    "jsonl": b'{"conventions": ',
    "npz": b"PK\x03\x04",
    "parquet": b"PAR1",
    "aem": b"CCSDS_AEM_VERS = 2.0\n",
    "acm": b"CCSDS_ACM_VERS = 2.0\n",
    "czml": b'[\n{"id": "document"',
    "kml": b"<?xml version='1.0' encoding='UTF-8'?>\n<kml ",
    "odm": b"EPSG:4326\n# vopd ",
    "colmap": b"# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n",
    "opk": b"# vopd ",
}
SUFFIXES = [(suffix, one.name) for one in FORMATS.values() for suffix in one.suffixes]


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with case 4 as `deck.dat`, and in it."""
    (tmp_path / "deck.dat").write_text(deck_text("case4"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("suffix", "form"), [*SUFFIXES, (".CSV", "csv"), (".Kml", "kml")])
def test_the_suffix_says_the_format(suffix: str, form: str, place: Path) -> None:
    assert vopd("attitude", "deck.dat", "-o", f"t{suffix}", "--epoch", EPOCH).status == 0
    assert (place / f"t{suffix}").read_bytes().startswith(FIRST_BYTES[form])


@pytest.mark.parametrize("form", FORMATS)
def test_format_by_name_to_standard_output_and_file(form: str, place: Path) -> None:
    options = ("--format", form, "--epoch", EPOCH)
    result = vopd("attitude", "-", *options, stdin=deck_text("case4"))
    assert result.status == 0 and result.output.startswith(FIRST_BYTES[form])
    assert vopd("attitude", "deck.dat", *options, "-o", "t.txt").status == 0
    assert (place / "t.txt").read_bytes().startswith(FIRST_BYTES[form])


def test_csv_is_the_default(place: Path) -> None:
    assert vopd("attitude", "deck.dat").output.startswith(FIRST_BYTES["csv"])


BAD = [  # options, exit status, what is said
    (("-o", "t.xyz"), 2),
    (("-o", "table"), 2),
    (("-o", ""), 2),
    (("-o", "t.csv.gz"), 2),
    (("--format", "xlsx"), 2),
    (("-o", "t.aem"), 2),
    (("-o", "t.czml"), 2),
    (("-o", "t.aem", "--epoch", "yesterday"), 2),
    (("-o", "t.csv", "--epoch", "1974-02-30"), 2),
    (("-o", "t.kml", "--epoch", ""), 2),
    (("-o", "t.aem", "--epoch", "0001-01-01"), 1),
    (("-o", "t.aem", "--epoch", EPOCH, "--aem-version", "3"), 2),
    (("-o", "t.aem", "--epoch", EPOCH, "--originator", "\u00e9"), 2),
    (("-o", "t.aem", "--epoch", EPOCH, "--object-id", "x" * 201), 2),
    (("-o", "t.csv", "--aem-version", "1"), 2),
    (("-o", "t.csv", "--object-name", "X"), 2),
    (("-o", "t.kml", "--object-id", "X"), 2),
    (("-o", "t.csv", "--reading-sigma", "-1"), 2),
    (("-o", "t.csv", "--landmark-sigma", "nan"), 2),
    (("-o", "t.csv", "--max-rate", "0"), 2),
    (("-o", "t.csv", "--fix", "everything"), 2),
    (("-o", "missing/t.csv"), 1),
    (("-o", "folder.csv"), 1),
    (("-o", "deck.dat/t.csv"), 1),
    (("-o", "deck.dat", "--format", "csv"), 1),
]


@pytest.mark.parametrize(("options", "expected"), BAD)
def test_bad_input_is_said_and_leaves_nothing(
    options: tuple[str, ...], expected: int, place: Path
) -> None:
    (place / "folder.csv").mkdir()
    result = vopd("attitude", "deck.dat", *options)
    assert (result.status, result.stdout) == (expected, "")
    assert_approved(" ".join(result.stderr.split()))
    assert sorted(path.name for path in place.rglob("*")) == ["deck.dat", "folder.csv"]
    assert (place / "deck.dat").read_text() == deck_text("case4")


def test_no_deck_and_no_such_deck(place: Path) -> None:
    assert vopd("attitude").status == 2
    result = vopd("attitude", "none.dat", "-o", "t.csv")
    assert result.status == 1 and "none.dat" in result.stderr
    assert [path.name for path in place.iterdir()] == ["deck.dat"]


@pytest.mark.parametrize("form", FORMATS)
def test_no_frame_left(form: str, place: Path) -> None:
    """A deck whose only frame is ignored."""
    (job,) = read_deck("deck.dat")
    names = ("frame", "fiducial_in", "landmark", "present", "landmark_in")
    only = {name: getattr(job.readings, name)[:1] for name in names}
    alone = replace(job, readings=reread(job.readings, **only))
    (place / "one.dat").write_text(write_deck([alone]))
    (place / f"t{FORMATS[form].suffixes[0]}").write_text("what was there")
    result = vopd("attitude", "one.dat", "-o", f"t{FORMATS[form].suffixes[0]}", "--epoch", EPOCH)
    assert result.status == 1
    assert_approved(result.stderr)
    assert (place / f"t{FORMATS[form].suffixes[0]}").read_text() == "what was there"


def test_parquet_without_its_extra(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    result = vopd("attitude", "deck.dat", "-o", "t.parquet")
    assert result.status == 1
    assert_approved(result.stderr)
    assert [path.name for path in place.iterdir()] == ["deck.dat"]
    assert vopd("attitude", "deck.dat", "-o", "t.npz").status == 0


def test_a_wrong_source_date_epoch(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "today")
    result = vopd("attitude", "deck.dat", "-o", "t.aem", "--epoch", EPOCH)
    assert result.status == 1 and "SOURCE_DATE_EPOCH: 'today'" in result.stderr
    assert [path.name for path in place.iterdir()] == ["deck.dat"]


def test_a_binary_file_is_not_sent_to_a_terminal(place: Path) -> None:
    main, terminal = os.openpty()
    try:
        run = subprocess.run(
            [sys.executable, "-m", "vopd", "attitude", "deck.dat", "--format", "npz"],
            stdout=terminal, stderr=subprocess.PIPE, text=True,
            env=os.environ | {"PYTHONPATH": str(ROOT)}, check=False,
        )  # fmt: skip
    finally:
        os.close(terminal)
        os.close(main)
    assert run.returncode == 2 and "npz is binary: name a file with -o" in run.stderr


def test_one_deck_that_fails_does_not_keep_the_others(place: Path) -> None:
    result = vopd("attitude", "none.dat", "deck.dat", "-o", "t.npz", "-q")
    assert result.status == 1 and "none.dat" in result.stderr
    with np.load(place / "t.npz") as table:
        assert table["frame"].tolist() == [55, 60, 65]


def test_exit_status_of_flags(place: Path) -> None:
    """Two landmarks are a flag."""
    assert vopd("attitude", "deck.dat", "-o", "t.csv").status == 0
    result = vopd("attitude", "deck.dat", "-o", "s.csv", "--strict")
    assert result.status == 3 and "--strict: 2 frames are flagged" in result.stderr
    assert (place / "s.csv").read_bytes() == (place / "t.csv").read_bytes()
    one = vopd("attitude", DECKS / "appendix_h" / "case2.dat", "-o", "one.csv", "--strict")
    assert one.status == 3 and "--strict: 1 frame is flagged" in one.stderr


def test_a_frame_that_does_not_converge_is_status_3(place: Path) -> None:
    """Case 1 with the vehicle ten million feet to the west, as the run's own test has it."""
    cards = deck_text("case1").splitlines()
    cards[33:37] = [card[:10] + " -9999999." + card[20:] for card in cards[33:37]]
    (place / "far.dat").write_text("\n".join(cards) + "\n")
    result = vopd("attitude", "far.dat", "-o", "t.jsonl")
    assert result.status == 3 and "not_converged" in (place / "t.jsonl").read_text()
    both = vopd("attitude", "far.dat", "none.dat", "-o", "s.jsonl")
    assert both.status == 1


@cache
def status_of_run(deck: Path) -> int:
    """The exit status of `vopd run` with a deck, in the folder of the test that asks first."""
    return vopd("run", deck, "-o", "t.lst").status


@pytest.mark.parametrize("name", ["vanished", "zero_residuals", "asterisks", "ignored", "restart"])
@pytest.mark.parametrize("form", FORMATS)
def test_odd_decks_end_as_their_run_does(name: str, form: str, place: Path) -> None:
    """Frames without landmarks, without residuals, dropped: every format takes them."""
    deck = DECKS / "regression" / f"{name}.dat"
    result = vopd("attitude", deck, "-o", f"t{FORMATS[form].suffixes[0]}", "--epoch", EPOCH, "-q")
    assert result.status == status_of_run(deck), result.stderr
    assert (place / f"t{FORMATS[form].suffixes[0]}").read_bytes().startswith(FIRST_BYTES[form])


def test_a_corrected_run_says_so(place: Path) -> None:
    result = vopd("attitude", "deck.dat", "--fix", "earth")
    assert_approved(result.stderr)
    assert "\n# fixes: earth (WGS 84)\n" in result.stdout
    assert vopd("attitude", "deck.dat", "--fix", "earth", "-q").stderr == ""


def test_the_help_names_every_format_and_status() -> None:
    text = vopd("attitude", "--help").stdout
    for one in FORMATS.values():
        assert one.about in text and all(suffix in text for suffix in one.suffixes)
    assert all(f"{k} " in text.split("Exit status:")[1] for k in range(4))
