"""Star files as spreadsheets, cameras and people hand them over, and what the messages say."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.kit.command import Ran, vopd
from tests.kit.star_photographs import HEAD, photograph, written

GOOD = written(photograph())
PX = "x_px,y_px,ra_deg,dec_deg"


def solve(text: str | bytes, *arguments: str) -> Ran:
    return vopd("stars", "solve", "-", "--focal", "76", *arguments, stdin=text)


def rows(text: str = GOOD) -> list[str]:
    return text.splitlines()


AS_GOOD = {
    "old line ends": "\r".join(rows()) + "\r",
    "unnamed columns at the end": "\n".join(line + ",," for line in rows()),
    "semicolons, BOM, CRLF, empty rows": "\ufeff"
    + "\r\n".join([*(line.replace(",", ";") for line in rows()), ";;;", " ; ; ; "]),
    "tabs and capitals": GOOD.replace(HEAD, HEAD.upper()).replace(",", "\t"),
}


@pytest.mark.parametrize("name", AS_GOOD)
def test_these_files_are_as_good_as_any(name: str) -> None:
    result = solve(AS_GOOD[name])
    assert result.status == 0 and result.stderr == "" and result.stdout == solve(GOOD).stdout


def changed(line: int, cell: int, value: str) -> str:
    """The good file with another value in a line (from 1) and cell (from 0)."""
    lines = [row.split(",") for row in rows()]
    lines[line - 1][cell] = value
    return "\n".join(map(",".join, lines))


SAID: dict[str, tuple[str | bytes, str]] = {
    "empty cell": (changed(5, 1, " "), "line 5: y_mm: the cell is empty"),
    "not a number": (changed(3, 0, "nan"), "line 3: x_mm: not a number: 'nan'"),
    "decimal comma": (
        GOOD.replace(",", ";").replace(".", ","),
        "with a decimal point, not a comma",
    ),
    "degrees as hours": (
        GOOD.replace("ra_deg", "ra_hours"),
        "is beyond +-24 hours (degrees go in column ra_deg)",
    ),
    "sigma of another unit": (
        "\n".join([HEAD + ",sigma_px", *(f"{row},1" for row in rows()[1:])]),
        "line 1: sigma_px: the images are in mm, and so must be their sigmas",
    ),
    "star of no photograph": (
        "\n".join(["image," + HEAD, *(f"a,{row}" for row in rows()[1:6]), f",{rows()[6]}"]),
        "line 7: image: the cell is empty",
    ),
    "photograph": (b"\xff\xd8\xff\xe0\x00\x10JFIF", "a JPEG image; the stars in it must be found"),
    "workbook": (b"PK\x03\x04\x14\x00", "export it as CSV"),
    "packed": (b"\x1f\x8b\x08\x00", "a gzip archive; unpack it first"),
    "UTF-16": (GOOD.encode("utf-16"), "UTF-16 text; save it as UTF-8 text"),
    "Latin-1": (
        (HEAD + ",name\n1,2,3,4,Bételgeuse\n").encode("latin-1"),
        "line 2: not UTF-8 text (byte 0xE9): save it as UTF-8",
    ),
}


@pytest.mark.parametrize("name", SAID)
def test_what_is_wrong_and_what_to_do_is_said(name: str) -> None:
    text, said = SAID[name]
    result = solve(text)
    assert result.status == 1 and result.stdout == "" and said in result.stderr, result.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--place", "48N,11E,500"), "'48N,11E,500' is not LAT,LON,H: not a number: '48N'"),
        (("--mount", "up"), "'up' is not forward|down|Y,P,R"),
        (("--size", "6000x4000"), "'6000x4000' is not W,H"),
        (("-o", "solved.png"), "solved.png: write the solution to a .json, and vopd plot draws"),
    ],
)
def test_an_option_of_another_form_is_told_the_form(
    arguments: tuple[str, ...], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = solve(GOOD, *arguments)
    assert result.status == 2 and said in result.stderr and not list(tmp_path.iterdir())


def test_figures_are_not_written_as_other_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = vopd("stars", "tables", "-o", "figures.gif")
    assert result.status == 2 and not list(tmp_path.iterdir())


def test_photographs_of_the_same_name_are_told_apart(tmp_path: Path) -> None:
    text = "\n".join(["image," + HEAD, *(f"a,{row}" for row in rows()[1:])])
    for name in ("one.csv", "two.csv"):
        (tmp_path / name).write_text(text)
    names = [str(tmp_path / name) for name in ("one.csv", "two.csv")]
    solved = vopd("stars", "solve", *names, "--focal", "76", "--format", "json")
    assert [one["image"] for one in json.loads(solved.stdout)] == [f"{name}: a" for name in names]
    alone = vopd("stars", "solve", names[0], "--focal", "76", "--format", "json")
    assert [one["image"] for one in json.loads(alone.stdout)] == ["a"]


def test_a_photograph_without_its_option_costs_the_others_nothing(tmp_path: Path) -> None:
    (tmp_path / "pixels.csv").write_text(GOOD.replace(HEAD, PX))
    (tmp_path / "mm.csv").write_text(GOOD)
    both = [str(tmp_path / "pixels.csv"), str(tmp_path / "mm.csv")]
    result = vopd("stars", "solve", *both, "--focal", "76", "--format", "json")
    assert result.status == 1 and len(json.loads(result.stdout)) == 1
    assert "pixels.csv: the file has pixels: --centre X,Y or --size W,H is needed" in result.stderr
    none = vopd("stars", "solve", both[0], both[0], "--focal", "76")
    assert none.status == 2 and none.stdout == ""


def test_a_solution_that_did_not_converge_states_no_accuracy() -> None:
    """From an optical axis far from the true one the corrections go on; sigmas would be noise."""
    good = json.loads(solve(GOOD, "--format", "json").stdout)[0]
    result = solve(GOOD, "--format", "json", "--initial", "0,0,0")
    assert result.status == 3 and "no convergence in 50 corrections" in result.stderr
    (wrong,) = json.loads(result.stdout)
    stated = {"rotation_sigma_arcsec", "boresight_95_arcsec", "sigma_omega_deg"}
    assert not wrong["converged"] and stated <= set(good) and not stated & set(wrong)
