"""Tables 6.1 to 6.5 and figures 6.1 to 6.3 as printed, against listings and golden files."""

from __future__ import annotations

import csv
import itertools
from pathlib import Path

import numpy as np
import pytest

from tests.kit import rae_listings as listings
from tests.kit.command import vopd
from tests.kit.rae_goldens import RAE_GOLDENS, Golden
from tests.tolerances import assert_close, within
from vopd.geometry.sexagesimal import parse_angle_deg
from vopd.stellar import image_directions
from vopd.stellar import tables_1987 as printed
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM, TRUTH_DEG

DECKS = Path(__file__).parents[2] / "decks" / "stars"
STARS = [tuple(u) for u in DIRECTIONS.tolist()]
PHOTO = [tuple(p) for p in image_directions(PERTURBED_MM, 76.0).tolist()]
IMAGES = [tuple(xy) for xy in PERTURBED_MM.tolist()]
PAIRS = list(itertools.combinations(range(4), 2))
GOLDENS = {
    "table_6_1.csv": printed.TABLE_6_1,
    "table_6_2.csv": printed.TABLE_6_2,
    "table_6_3.csv": printed.TABLE_6_3,
    "table_6_4.csv": printed.TABLE_6_4,
}


@pytest.fixture(scope="module")
def pages() -> dict[str, list[str]]:
    """The lines of each table, by the first two words of its title."""
    result = vopd("stars", "tables")
    assert result.status == 0
    found = {}
    for page in result.stdout.split("\n\n"):
        title, *lines = page.splitlines()
        found[" ".join(title.split()[:2]).rstrip(".")] = lines
    return found


def row(lines: list[str], label: str) -> list[float]:
    """The numbers after a label."""
    (line,) = [line for line in lines if line.startswith(label)]
    return [float(cell) for cell in line.removeprefix(label).split() if cell != "computed"]


@pytest.mark.parametrize("name", GOLDENS)
def test_what_the_command_calls_printed_is_printed(name: str, golden: Golden) -> None:
    rows = [[cell.replace("''", '"') for cell in row.values()] for row in golden(name)]
    assert rows == [list(cells) for cells in GOLDENS[name]]


def test_misprints_are_the_marked_ones(golden: Golden) -> None:
    rows = {(r["table"], r["row"], r["column"]): (r["should_be"], r["why"])
            for r in golden("misprints.csv")}  # fmt: skip
    assert rows == printed.MISPRINTS


@pytest.mark.parametrize("name", ["table_6_1.csv", "table_6_3.csv"])
def test_the_decks_hold_the_report_s_stars(name: str, golden: Golden) -> None:
    with (DECKS / name).open(encoding="utf-8") as file:
        deck = list(csv.DictReader(line for line in file if not line.startswith("#")))
    for mine, theirs in zip(deck, golden(name), strict=True):
        assert (mine["x_mm"], mine["y_mm"]) == (theirs["x_mm"], theirs["y_mm"])
        for short, long in (("ra_deg", "right_ascension"), ("dec_deg", "declination")):
            assert parse_angle_deg(mine[short], hours=True) == parse_angle_deg(theirs[long])


def test_no_golden_file_is_left_unread() -> None:
    """Those that the tests of this folder name; a file that is missing fails there."""
    text = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("*.py"))
    files = sorted(path.name for path in RAE_GOLDENS.iterdir() if path.name != "README.md")
    assert len(files) == 10
    assert [name for name in files if name not in text] == []


@pytest.mark.parametrize("star", ["star 1", "star 2", "star 3", "star 4"])
def test_table_6_1_agrees_to_every_printed_digit(star: str, pages: dict[str, list[str]]) -> None:
    lines = pages["Table 6.1"]
    at = next(k for k, line in enumerate(lines) if line.startswith(star))
    made, told = (line.split()[-4:] for line in lines[at : at + 2])
    for mine, theirs in zip(made[:2], told[:2], strict=True):
        off = parse_angle_deg(mine, hours=True) - parse_angle_deg(theirs)
        assert abs(off) * 3600 < within("rae printed hundredths")
    assert made[2:] == told[2:]


def test_table_6_4_to_the_printed_digit(pages: dict[str, list[str]]) -> None:
    lines = pages["Table 6.4"]
    assert [f"{v:.4f}" for v in row(lines, "church ")] == ["0.0501", "0.2033", "-0.2315"]
    assert [f"{v:.4f}" for v in row(lines, "church-weighted")] == ["0.0521", "0.2025", "-0.2469"]
    assert [f"{v:.4f}" for v in row(lines, "collinearity")] == ["0.0151", "0.0215", "-0.0604"]
    marks = [cell for line in lines for cell in line.split() if cell[-1] in "+*" and len(cell) > 1]
    assert marks == ["0.0216+", "-0.0605+", "-0.2318*"]


@pytest.mark.parametrize("pair", PAIRS)
def test_table_6_5_is_twostars(pair: tuple[int, int], pages: dict[str, list[str]]) -> None:
    """Axis and angle of the listing, of either sense: (axis, angle) and (-axis, -angle) are one."""
    stars, photo = [STARS[k] for k in pair], [PHOTO[k] for k in pair]
    axis, angle, _ = listings.twostar(stars, photo)
    cells = row(pages["Table 6.5"], f"stars {pair[0] + 1},{pair[1] + 1}")
    assert_close("rae printed cosine", cells[:3], axis)
    assert_close("rae printed angle", cells[3], angle)
    d1, d2 = (listings.unit(listings.minus(p, u)) for u, p in zip(stars, photo, strict=True))
    cross = listings.cross(d1, d2)
    assert f"{cells[4]:.2f}" == f"{listings.dot(cross, cross) ** 0.5:.2f}"


def test_table_6_5_s_sines(pages: dict[str, list[str]]) -> None:
    """The source notes: .10 for pair 2,4, .30 for 1,2, .71 for 1,3."""
    sines = {pair: row(pages["Table 6.5"], f"stars {pair}")[4] for pair in ("2,4", "1,2", "1,3")}
    assert sines == {"2,4": 0.10, "1,2": 0.30, "1,3": 0.71}


@pytest.mark.parametrize("pair", PAIRS)
def test_figures_are_the_listings_errors(
    pair: tuple[int, int], pages: dict[str, list[str]]
) -> None:
    """Four methods by STARS (12 corrections), TUSTAR with and without unit products, TWOSTAR."""
    stars, photo = [STARS[k] for k in pair], [PHOTO[k] for k in pair]
    images = [IMAGES[k] for k in pair]
    solved = [
        listings.stars_corrections(tuple(TRUTH_DEG), stars, images, 76.0, 12, False),
        listings.angles_deg(listings.tustar(stars, photo, unit_third=True)),
        listings.angles_deg(listings.tustar(stars, photo, unit_third=False)),
        listings.angles_deg(listings.twostar(stars, photo)[2]),
    ]
    errors = TRUTH_DEG - np.array(solved)
    for k in range(3):
        cells = row(pages[f"Figure 6.{k + 1}"], f"stars {pair[0] + 1},{pair[1] + 1}")
        assert_close("rae figure", cells, errors[:, k])
