"""`vopd attitude`: formats by suffix and name, exit statuses, and bad input that leaves nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.export.formats_kit import EPOCH, ROOT, call, deck_text, message, status
from vopd.export import FORMATS

FIRST_BYTES = {
    "csv": b"# program: vopd",
    "jsonl": b'{"conventions": ',
    "npz": b"PK\x03\x04",
    "parquet": b"PAR1",
    "aem": b"CCSDS_AEM_VERS = 2.0\n",
    "czml": b'[\n{"id": "document"',
    "kml": b"<?xml version='1.0' encoding='UTF-8'?>\n<kml ",
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
    assert status(call("attitude", "deck.dat", "-o", f"t{suffix}", "--epoch", EPOCH)) == 0
    assert (place / f"t{suffix}").read_bytes().startswith(FIRST_BYTES[form])


@pytest.mark.parametrize("form", FORMATS)
def test_format_by_name_to_standard_output_and_file(form: str, place: Path) -> None:
    options = ("--format", form, "--epoch", EPOCH)
    result = call("attitude", "-", *options, text=deck_text("case4"))
    assert status(result) == 0 and result.stdout_bytes.startswith(FIRST_BYTES[form])
    assert status(call("attitude", "deck.dat", *options, "-o", "t.txt")) == 0
    assert (place / "t.txt").read_bytes().startswith(FIRST_BYTES[form])


def test_csv_is_the_default(place: Path) -> None:
    assert call("attitude", "deck.dat").stdout_bytes.startswith(FIRST_BYTES["csv"])


BAD = [  # options, exit status, what is said
    (("-o", "t.xyz"), 2, "'.xyz' is not known; known are .csv .jsonl"),
    (("-o", "table"), 2, "no suffix that names a format"),
    (("-o", ""), 2, "no suffix"),
    (("-o", "t.csv.gz"), 2, "'.gz' is not known"),
    (("--format", "xlsx"), 2, "not one of 'csv', 'jsonl'"),
    (("-o", "t.aem"), 2, "--epoch 1974-08-27T17:30:00Z"),
    (("-o", "t.czml"), 2, "czml has dates"),
    (("-o", "t.aem", "--epoch", "yesterday"), 2, "'yesterday' is no ISO 8601"),
    (("-o", "t.csv", "--epoch", "1974-02-30"), 2, "'1974-02-30' is no ISO 8601"),
    (("-o", "t.kml", "--epoch", ""), 2, "'' is no ISO 8601"),
    (("-o", "t.aem", "--epoch", "0001-01-01"), 1, "outside the years 1 to 9999"),
    (("-o", "t.aem", "--epoch", EPOCH, "--aem-version", "3"), 2, "'3' is not one of '1', '2'"),
    (("-o", "t.aem", "--epoch", EPOCH, "--originator", "\u00e9"), 2, "200 ASCII characters"),
    (("-o", "t.aem", "--epoch", EPOCH, "--object-id", "x" * 201), 2, "200 ASCII characters"),
    (("-o", "t.csv", "--aem-version", "1"), 2, "--aem-version is for aem, not csv"),
    (("-o", "t.csv", "--object-name", "X"), 2, "--object-name is for aem, czml, kml, not csv"),
    (("-o", "t.kml", "--object-id", "X"), 2, "--object-id is for aem, not kml"),
    (("-o", "t.csv", "--reading-sigma", "-1"), 2, "-1 is no standard deviation"),
    (("-o", "t.csv", "--landmark-sigma", "nan"), 2, "nan is no standard deviation"),
    (("-o", "t.csv", "--max-rate", "0"), 2, "--max-rate"),
    (("-o", "t.csv", "--fix", "everything"), 2, "--fix"),
    (("-o", "missing/t.csv"), 1, "missing/t.csv: cannot be written"),
    (("-o", "folder.csv"), 1, "folder.csv: cannot be written"),
    (("-o", "deck.dat/t.csv"), 1, "cannot be written"),
    (("-o", "deck.dat", "--format", "csv"), 1, "this file is needed already"),
]


@pytest.mark.parametrize(("options", "expected", "said"), BAD)
def test_bad_input_is_said_and_leaves_nothing(
    options: tuple[str, ...], expected: int, said: str, place: Path
) -> None:
    (place / "folder.csv").mkdir()
    result = call("attitude", "deck.dat", *options)
    assert (status(result), result.stdout) == (expected, "")
    assert said in " ".join(message(result).split())
    assert sorted(path.name for path in place.rglob("*")) == ["deck.dat", "folder.csv"]
    assert (place / "deck.dat").read_text() == deck_text("case4")


def test_no_deck_and_no_such_deck(place: Path) -> None:
    assert status(call("attitude")) == 2
    result = call("attitude", "none.dat", "-o", "t.csv")
    assert status(result) == 1 and "none.dat" in message(result)
    assert [path.name for path in place.iterdir()] == ["deck.dat"]


@pytest.mark.parametrize("form", FORMATS)
def test_no_frame_left(form: str, place: Path) -> None:
    """A deck whose only frame is ignored."""
    (job,) = vopd.read_deck("deck.dat")
    names = ("frame", "fiducial_in", "landmark", "present", "landmark_in")
    only = {name: getattr(job.readings, name)[:1] for name in names}
    alone = replace(job, readings=replace(job.readings, **only))
    (place / "one.dat").write_text(vopd.write_deck([alone]))
    (place / f"t.{form}").write_text("what was there")
    result = call("attitude", "one.dat", "-o", f"t.{form}", "--epoch", EPOCH)
    assert status(result) == 1
    assert "one.dat: no frame is left with an attitude" in message(result)
    assert (place / f"t.{form}").read_text() == "what was there"


def test_parquet_without_its_extra(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    result = call("attitude", "deck.dat", "-o", "t.parquet")
    assert status(result) == 1
    assert "pyarrow is not installed: pip install 'vopd[parquet]'" in message(result)
    assert [path.name for path in place.iterdir()] == ["deck.dat"]
    assert status(call("attitude", "deck.dat", "-o", "t.npz")) == 0


def test_a_wrong_source_date_epoch(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "today")
    result = call("attitude", "deck.dat", "-o", "t.aem", "--epoch", EPOCH)
    assert status(result) == 1 and "SOURCE_DATE_EPOCH: 'today'" in message(result)
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
    result = call("attitude", "none.dat", "deck.dat", "-o", "t.npz", "-q")
    assert status(result) == 1 and "none.dat" in message(result)
    with np.load(place / "t.npz") as table:
        assert table["frame"].tolist() == [55, 60, 65]


def test_exit_status_of_flags(place: Path) -> None:
    """Two landmarks are a flag."""
    assert status(call("attitude", "deck.dat", "-o", "t.csv")) == 0
    result = call("attitude", "deck.dat", "-o", "s.csv", "--strict")
    assert status(result) == 3 and "--strict: 2 frames are flagged" in message(result)
    assert (place / "s.csv").read_bytes() == (place / "t.csv").read_bytes()


def test_a_frame_that_does_not_converge_is_status_3(place: Path) -> None:
    """Case 1 with the vehicle ten million feet to the west, as the run's own test has it."""
    cards = deck_text("case1").splitlines()
    cards[33:37] = [card[:10] + " -9999999." + card[20:] for card in cards[33:37]]
    (place / "far.dat").write_text("\n".join(cards) + "\n")
    result = call("attitude", "far.dat", "-o", "t.jsonl")
    assert status(result) == 3 and "not_converged" in (place / "t.jsonl").read_text()
    both = call("attitude", "far.dat", "none.dat", "-o", "s.jsonl")
    assert status(both) == 1


@pytest.mark.parametrize("name", ["vanished", "zero_residuals", "asterisks", "ignored", "restart"])
@pytest.mark.parametrize("form", FORMATS)
def test_odd_decks_end_as_their_run_does(name: str, form: str, place: Path) -> None:
    """Frames without landmarks, without residuals, dropped: every format takes them."""
    deck = str(ROOT / "decks" / "regression" / f"{name}.dat")
    result = call("attitude", deck, "-o", f"t.{form}", "--epoch", EPOCH, "-q")
    assert status(result) == status(call("run", deck, "-o", "t.lst")), message(result)
    assert (place / f"t.{form}").read_bytes().startswith(FIRST_BYTES[form])


def test_a_corrected_run_says_so(place: Path) -> None:
    result = call("attitude", "deck.dat", "--fix", "earth")
    assert "corrected run, not the original: earth" in result.stderr
    assert "\n# fixes: earth (WGS 84)\n" in result.stdout
    assert call("attitude", "deck.dat", "--fix", "earth", "-q").stderr == ""


def test_the_help_names_every_format_and_status() -> None:
    text = call("attitude", "--help").stdout
    for one in FORMATS.values():
        assert one.about in text and all(suffix in text for suffix in one.suffixes)
    assert all(f"{k} " in text.split("Exit status:")[1] for k in range(4))
