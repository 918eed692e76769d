"""`vopd check`: every fault found once, at its card, and nothing else."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import vopd
from vopd.check.deck import check_deck
from vopd.cli import cli
from vopd.job import Job

CASE_1 = Path(__file__).parents[2] / "decks" / "appendix_h" / "case1.dat"
Cards = list[str]
Edit = Callable[[Cards], None]


def clean_cards() -> Cards:
    """Case 1 as two frames, 730 and 731, with the readings of landmark 66 drawn together."""
    (job,) = vopd.read_deck(CASE_1)
    readings = job.readings
    calm = readings.landmark_in.copy()
    calm[0, 1] = [11.137, 2.979]
    two: Job = replace(
        job,
        readings=replace(
            readings,
            frame=np.array([730, 731]),
            fiducial_in=np.repeat(readings.fiducial_in, 2, axis=0),
            landmark=np.repeat(readings.landmark, 2, axis=0),
            present=np.repeat(readings.present, 2, axis=0),
            landmark_in=np.repeat(calm, 2, axis=0),
        ),
        trajectory=replace(job.trajectory, altitude_ft=altitudes(job)),
    )
    return vopd.write_deck([two]).splitlines()


def altitudes(job: Job) -> np.ndarray:
    """Z and the round Earth's drop: 20 ft at 30000 ft, so the report's own H but for row 65."""
    x, y, z = job.trajectory.position_ft.T
    return np.round(z + (x**2 + y**2) / (2 * 20925698.0), 1)


def check(cards: Cards, tmp_path: Path, *options: str) -> tuple[int, dict[str, list[dict]]]:
    deck = tmp_path / "deck.dat"
    deck.write_text("\n".join(cards) + "\n")
    result = CliRunner().invoke(cli, ["check", "--format", "json", *options, str(deck)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    (report,) = json.loads(result.stdout)
    return result.exit_code, report


def put(card: int, first: int, text: str) -> Edit:
    """Punch `text` into a card, from column `first`, both counted from 1."""

    def edit(cards: Cards) -> None:
        line = cards[card - 1].ljust(80)
        cards[card - 1] = line[: first - 1] + text + line[first - 1 + len(text) :]

    return edit


# cards: 1-25 group 1, 26 title, 27 group 3, 28-30 group 4, 31 group 5, 32-33 group 6,
# 34-37 group 7, 38 group 8, 39-41 group 9, 42 group 10, 43 group 12, 44-64 frame 730, 65-85 731
FAULTS: dict[str, tuple[Edit, str, int, str | None, str]] = {
    "not a number": (put(39, 41, "      5O.3"), "error", 39, "41-50", "not a number: '5O.3'"),
    "not right-justified": (put(32, 1, "   0 "), "warning", 32, "1-5", "blanks read as zeros"),
    "signs": (put(40, 21, "     32.70"), "warning", 40, "21-30", "differ in sign"),
    "spread": (put(56, 41, " 010190"), "warning", 56, "41-47", "spread by 0.016 in"),
    "no rectangle": (
        lambda cards: [put(k, 41, " 014300")(cards) for k in (68, 69, 70)] and None,
        "warning", 65, None, "form no rectangle",
    ),
    "altitude": (put(37, 71, "  151014.9"), "warning", 37, "71-80", "X, Y, Z make it 141"),
    "frames out of order": (
        lambda cards: [put(k, 64, "0729")(cards) for k in range(65, 86)] and None,
        "warning", 65, "64-67", "frame 729 comes after frame 730",
    ),
    "wind too low": (
        lambda cards: put(30, 1, "   141000.")(cards), "warning", 30, "1-10", "2 frames lie beyond",
    ),
    "odd landmark number": (put(57, 9, "66"), "error", 57, "9-10", "numbered 65, 66, 65"),
    "lens": (
        lambda cards: [
            put(k, 1, f"{0.1 * k:10.1f}")(cards) for k in range(1, 26)
        ] and None,
        "warning", 25, "1-10", "mm from the centre",
    ),
}  # fmt: skip


def test_a_clean_deck_has_no_reports(tmp_path: Path) -> None:
    assert check(clean_cards(), tmp_path) == (0, {**EMPTY, "deck": str(tmp_path / "deck.dat")})


EMPTY: dict[str, object] = {"errors": [], "warnings": []}


def test_case_1_is_questioned_for_its_one_wide_reading() -> None:
    """Landmark 66: x 11.147, 11.137, 11.127."""
    with CASE_1.open("rb") as file:
        (finding,) = check_deck(file, "case1.dat")
    assert "spread by 0.020 in" in finding.message
    with CASE_1.open("rb") as file:
        assert check_deck(file, "case1.dat", spread_in=0.021) == []


def found(report: dict[str, list[dict]]) -> list[tuple[str, int, str | None, str]]:
    """Severity, card, columns and message of every report."""
    return [
        (kind, row["card"], row["columns"] and "{}-{}".format(*row["columns"]), row["message"])
        for kind, rows in (("error", report["errors"]), ("warning", report["warnings"]))
        for row in rows
    ]


def agrees(
    seen: tuple[str, int, str | None, str], fault: tuple[Edit, str, int, str | None, str]
) -> bool:
    return seen[:3] == fault[1:4] and fault[4] in seen[3]


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_alone(name: str, tmp_path: Path) -> None:
    cards = clean_cards()
    FAULTS[name][0](cards)
    status, report = check(cards, tmp_path)
    (seen,) = found(report)
    assert agrees(seen, FAULTS[name]), seen
    assert status == (1 if FAULTS[name][1] == "error" else 0)


def test_ten_faults_ten_reports(tmp_path: Path) -> None:
    cards = clean_cards()
    assert len(FAULTS) == 10
    for edit, *_ in FAULTS.values():
        edit(cards)
    status, report = check(cards, tmp_path)
    seen = found(report)
    for name, fault in FAULTS.items():
        assert sum(agrees(one, fault) for one in seen) == 1, (name, seen)
    assert len(seen) == 10, seen
    assert status == 1


MORE: dict[str, tuple[Edit, str]] = {
    "trajectory order": (put(36, 1, "       69."), "69 does not exceed 70"),
    "time order": (put(33, 1, "    0"), "0 does not exceed 0"),
    "wind order": (put(29, 1, "   120000."), "120000 does not exceed 130000"),
    "lens order": (put(25, 1, "        1."), "1 does not exceed 6.8"),
    "time table ends": (put(33, 1, "  730"), "1 frames lie beyond: frame 731"),
    "time table begins": (put(32, 1, "  731"), "1 frames lie beyond: frame 730"),
    "trajectory ends": (put(37, 1, "      70.5"), "beyond: time 70.9"),
    "unused landmark": (put(41, 9, "68"), "landmark 68 is on no frame"),
    "ignores everything": (put(43, 6, "   65   66   67"), "every landmark is to be ignored"),
    "return group": (put(43, 4, "14"), "no return group: 14"),
    "tab": (put(28, 5, "\t"), "a tab"),
    "too many columns": (put(28, 90, "x"), "80 columns"),
    "undefined": (put(41, 9, "68"), "landmark 67 is not defined in group 9"),
    "a count too large": (put(27, 1, "    5"), "the deck ends here"),
    "too few landmarks counted": (put(31, 21, "    2"), "one more"),
}


@pytest.mark.parametrize("name", MORE)
def test_more_faults(name: str, tmp_path: Path) -> None:
    cards = clean_cards()
    MORE[name][0](cards)
    _, report = check(cards, tmp_path)
    assert any(MORE[name][1] in row[3] for row in found(report)), report


def test_repeated_frame(tmp_path: Path) -> None:
    cards = clean_cards()
    for card in range(65, 86):
        put(card, 64, "0730")(cards)
    _, report = check(cards, tmp_path)
    assert "frame 730 has been read before" in [row[3] for row in found(report)]


def test_options(tmp_path: Path) -> None:
    cards = clean_cards()
    put(56, 41, " 010190")(cards)
    assert check(cards, tmp_path, "--spread", "0.02")[1]["warnings"] == []
    put(39, 9, "91")(cards)
    status, report = check(cards, tmp_path, "--limits-1974")
    assert status == 1 and "TTHJ(90)" in report["errors"][0]["message"]


def test_text_and_several_decks(tmp_path: Path) -> None:
    """Errors and warnings apart, with the ruler; a deck that is not there is an error."""
    deck = tmp_path / "deck.dat"
    cards = clean_cards()
    for name in ("not a number", "spread"):
        FAULTS[name][0](cards)
    deck.write_text("\n".join(cards))
    result = CliRunner().invoke(cli, ["check", str(deck), str(tmp_path / "none.dat")])
    assert result.exit_code == 1
    assert "landmark latitude minutes (columns 41-50): not a number: '5O.3'" in result.stdout
    assert f"{deck}: 1 error, 1 warning" in result.stdout
    assert result.stdout.index("error: ") < result.stdout.index("warning: ")
    assert "none.dat: No such file or directory" in result.stdout
    assert "^^^^^^^^^^" in result.stdout
