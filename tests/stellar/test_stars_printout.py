"""`vopd stars solve --listing`: what program STARS prints."""

from __future__ import annotations

import re

import pytest

from tests.kit import rae_listings as listings
from tests.kit.command import vopd
from tests.kit.rae_goldens import Golden
from tests.kit.star_files import SAMPLE, STARS, seen_straight, solve_text
from tests.tolerances import assert_close
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM, TRUTH_DEG

START = (140.0, -10.0, 45.0)
SKY = [tuple(u) for u in DIRECTIONS.tolist()]
IMAGES = [tuple(xy) for xy in PERTURBED_MM.tolist()]


def blocks(text: str) -> list[list[str]]:
    """The lines of each correction."""
    return [("OMEGA" + part).splitlines() for part in text.split("OMEGA")[1:]]


def angles_deg(block: list[str]) -> list[float]:
    found = []
    for line in block[:3]:
        degrees, minutes, seconds = line.split("=")[1].split()
        size = abs(int(degrees)) + int(minutes) / 60 + float(seconds) / 3600
        found.append(-size if degrees.startswith("-") else size)
    return found


def run(*arguments: str) -> str:
    result = vopd("stars", "solve", SAMPLE, "--focal", "76", "--listing", *arguments)
    assert result.status == 0 and result.stderr == ""
    return result.stdout


@pytest.mark.parametrize("rule", ["uniform", "listed"])
def test_the_history_is_that_of_the_listing(rule: str) -> None:
    """STARS statement for statement, on plain numbers; angles to half a printed millisecond."""
    options = ("--corrections", "4", "--weights", rule) if rule == "listed" else ()
    found = blocks(run("--initial", "140,-10,45", *options))
    assert len(found) == 4
    for done, block in enumerate(found):
        expected = listings.stars_corrections(START, SKY, IMAGES, 76.0, done, rule == "listed")
        for mine, theirs in zip(angles_deg(block), expected, strict=True):
            assert_close("rae printed milliseconds", mine * 3600.0, theirs * 3600.0)
        m = listings.jnkmat(*expected)
        x, y = [], []
        for u, (image_x, image_y) in zip(SKY, IMAGES, strict=True):
            xn, yn, de = (listings.dot(tuple(row), u) for row in m)  # type: ignore[arg-type]
            x.append(image_x + 76.0 * xn / de)
            y.append(image_y + 76.0 * yn / de)
        for k, line in enumerate(block[4:8]):
            assert line == f"{k + 1:10d}{'':10}{x[k]:10.4f}{'':10}{y[k]:10.4f}"
        sums = (*(sum(v * v for v in values) for values in (x, y)),
                *(sum(abs(v) for v in values) for values in (x, y)))  # fmt: skip
        for total, line in zip(sums, block[8:], strict=True):
            assert line.endswith(f"{total:13.7f}") and line.startswith("SUM OF THE ")


def test_the_last_angles_are_those_of_table_6_4(golden: Golden) -> None:
    """The report's row of the collinearity equations, to the printed digit."""
    (row,) = [row for row in golden("table_6_4.csv") if row["method"] == "collinearity"]
    last = angles_deg(blocks(run("--initial", "140,-10,45"))[-1])
    errors = [f"{truth - angle:.4f}" for truth, angle in zip(TRUTH_DEG, last, strict=True)]
    assert errors == [row[name] for name in ("omega", "phi", "kappa")]


def test_angles_are_not_wrapped_and_keep_their_sign() -> None:
    """STARS adds corrections: from 500 degrees it stays there. -0.25 degree keeps its sign."""
    turned = blocks(run("--initial", "500,-0.25,45", "--corrections", "2"))
    assert turned[0][:2] == ["OMEGA  =   500   0   0.000", "PHI    =    -0  15   0.000"]
    assert 400.0 < angles_deg(turned[1])[0] < 600.0


def test_without_a_start_and_where_it_ends_behind_the_camera() -> None:
    assert len(blocks(run("--corrections", "2"))) == 2
    behind = vopd("stars", "solve", STARS / "stars_block_2.csv", "--focal", "76",
                  "--initial", "20,-15,50", "--listing")  # fmt: skip
    assert behind.status == 1 and "these stars lie behind the camera" in behind.stderr
    assert re.search(r"OMEGA  = +20   0   4.584", behind.stdout)


@pytest.mark.parametrize(
    "wrong", [("--format", "json"), ("--pair", "1,2"), ("--all-pairs",), ("--method", "svd"),
              ("--method", "all")],
)  # fmt: skip
def test_options_that_exclude_the_listing(wrong: tuple[str, ...]) -> None:
    text = seen_straight((1.0, 2.0), (9.0, -5.0), (-8.0, 3.0))
    assert solve_text(text, "--listing", *wrong).status == 2
