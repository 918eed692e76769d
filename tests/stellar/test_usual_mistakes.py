"""Mistakes of a star file that leave large residuals: each is named, and mends the file."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import f as f_distribution

from tests.kit.command import DECKS, Ran, vopd
from tests.kit.star_photographs import HEAD, Star, photograph, written
from tests.tolerances import assert_close, within
from vopd.stellar import StarField, find_outliers, right_ascension_declination_deg
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import judge
from vopd.stellar.files.read import StarFile
from vopd.stellar.outlier_search import fit_attitude


def solve(text: str, *arguments: str, focal: float = 76.0) -> Ran:
    return vopd("stars", "solve", "-", "--focal", f"{focal}", *arguments, stdin=text)


def misidentified(stars: list[Star]) -> Iterator[Star]:
    for k, (x, y, ra, dec) in enumerate(stars):
        yield (x, y, ra + 3.0 * (k == 2), dec)


MISTAKES: dict[str, tuple[Callable[[Star], Star], str]] = {
    "hours": (lambda s: (s[0], s[1], s[2] / 15.0, s[3]), "seems to be in hours: name its column"),
    "ra, dec": (lambda s: (s[0], s[1], s[3], s[2]), "right ascension and declination seem to be"),
    "x, y": (lambda s: (s[1], s[0], s[2], s[3]), "or x and y are exchanged"),
    "y down": (lambda s: (s[0], -s[1], s[2], s[3]), "y seems to point down: --y-down"),
}


@pytest.mark.parametrize("count", [3, 4, 10])
@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_of_coordinates_is_named(name: str, count: int) -> None:
    """The residuals without it are those of the readings: .005 mm, not millimetres."""
    make, said = MISTAKES[name]
    result = solve(written([make(star) for star in photograph(count)]))
    assert result.status == 3, result.stderr
    assert "the residuals are implausible" in result.stderr
    (line,) = [line for line in result.stderr.splitlines() if said in line]
    assert 0.0005 < float(line.split("then ")[1].split()[0]) < 0.015


def test_the_advice_mends_the_file() -> None:
    stars = photograph()
    good = solve(written(stars), "--format", "csv")
    assert good.status == 0 and good.stderr == ""
    in_hours = [(x, y, ra / 15.0, dec) for x, y, ra, dec in stars]
    hours = written(in_hours, HEAD.replace("ra_deg", "ra_hours"))
    down = written([(x, -y, ra, dec) for x, y, ra, dec in stars])
    expected = [float(cell) for cell in good.stdout.splitlines()[1].split(",")[2:5]]
    for result in (solve(hours, "--format", "csv"), solve(down, "--y-down", "--format", "csv")):
        assert result.status == 0 and result.stderr == ""
        found = [float(cell) for cell in result.stdout.splitlines()[1].split(",")[2:5]]
        assert_close("rae angle of seven decimals", found, expected)
    wrong = solve(written(stars), "--y-down")
    assert wrong.status == 3 and "y seems to point up: no --y-down" in wrong.stderr


@pytest.mark.parametrize("focal", [50.0, 75.0, 100.0])
def test_a_wrong_principal_distance_is_found(focal: float) -> None:
    result = solve(written(photograph()), focal=focal)
    assert result.status == 3
    found = float(result.stderr.split("principal distance seems to be ")[1].split()[0])
    assert_close("rae principal distance", found, 76.0)


@pytest.mark.parametrize("count", [4, 5, 10, 30])
def test_a_misidentified_star_is_named_and_left_out(count: int) -> None:
    text = written(list(misidentified(photograph(count))))
    plain = solve(text)
    assert plain.status == 3 and "line 4: star 3 disagrees with the others" in plain.stderr
    left_out = solve(text, "--reject", "--format", "csv")
    assert left_out.status == 0 and "line 4: star 3 is left out" in left_out.stderr
    numbers = left_out.stdout.splitlines()[1].split(",")[1].split()
    assert numbers == [str(k) for k in range(1, count + 1) if k != 3]
    if count >= 10:
        robust = solve(text, "--weights", "robust")
        assert robust.status == 0 and "star 3 disagrees with the others" in robust.stderr


def test_of_three_stars_none_can_be_accused() -> None:
    result = solve(written(list(misidentified(photograph(3)))))
    assert result.status == 3 and "none of the common mistakes explains this" in result.stderr


def test_a_given_reading_sigma_is_the_measure() -> None:
    text = written(photograph(30))
    assert solve(text, "--reading-sigma", "0.005").stderr == ""
    small = solve(text, "--reading-sigma", "0.001")
    assert small.status == 3 and "the stated sigma allows 0.001 mm" in small.stderr
    assert "is the stated sigma too small?" in small.stderr


@pytest.mark.parametrize("name", ["table_6_1", "table_6_3", "table_6_3_cosines", "orion"])
def test_good_files_draw_no_warning(name: str) -> None:
    result = vopd("stars", "solve", DECKS / "stars" / f"{name}.csv", "--focal", "76")
    assert result.status == 0 and result.stderr == ""


@pytest.mark.parametrize(("count", "wrong"), [(4, 1), (6, 2), (10, 3), (30, 8)])
def test_several_wrong_stars_do_not_hide_each_other(count: int, wrong: int) -> None:
    """Images .3 to 3 mm off among readings good to .01: none of 20 photographs is misjudged."""
    rng = np.random.default_rng(9)
    for _ in range(20):
        images = rng.uniform(-18.0, 18.0, (count, 2))
        rays = np.column_stack([images, np.full(count, -50.0)])
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        read = images + rng.normal(0.0, 0.01, images.shape)
        read[:wrong] += rng.choice([-1.0, 1.0], (wrong, 2)) * rng.uniform(0.3, 3.0, (wrong, 2))
        found = find_outliers(StarField.of(rays, read, 50.0))
        assert sorted(outlier.star for outlier in found) == list(range(wrong))
        assert find_outliers(StarField.of(rays[wrong:], read[wrong:], 50.0)) == []


def test_warnings_of_one_kind_are_counted() -> None:
    """27 stars have 351 pairs; those with a poor axis are three lines and a number."""
    result = solve(written(photograph(27)), "--all-pairs", "--method", "all")
    lines = result.stderr.splitlines()
    assert 0 < len(lines) <= 8
    assert sum("rotation axis lies near" in line for line in lines) == 3
    assert any("more like these" in line for line in lines)
    assert solve(written(photograph(27)), "--all-pairs", "-q").stderr == ""


def test_a_robust_solution_marks_the_star_that_hardly_counts() -> None:
    text = written(list(misidentified(photograph(10))))
    plain, robust = solve(text), solve(text, "--weights", "robust")
    marked = [line for line in robust.stdout.splitlines() if line.strip().startswith("3 ")]
    assert marked and marked[0].rstrip().endswith("*")
    assert "* weight below 0.5" in robust.stdout
    rms = [float(run.stdout.splitlines()[1].split()[8]) for run in (plain, robust)]
    assert rms[0] > 0.5 and rms[1] < 0.05


def test_the_chance_of_an_outlier_is_that_of_the_f_distribution() -> None:
    """Of good readings few stars stand out: at most one of 100 photographs, at 1 in 1,000 each."""
    rng = np.random.default_rng(12)
    images = rng.uniform(-18.0, 18.0, (100, 8, 2))
    rays = np.concatenate([images, np.full((100, 8, 1), -50.0)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    read = images + rng.normal(0.0, 0.01, images.shape)
    found = [find_outliers(StarField.of(r, i, 50.0)) for r, i in zip(rays, read, strict=True)]
    assert sum(map(bool, found)) <= 1
    read[0, 3] += [0.12, 0.0]  # twelve deviations: the chance by scipy from the others' attitude
    (outlier,) = find_outliers(StarField.of(rays[0], read[0], 50.0))
    others = np.arange(8) != 3
    fit = fit_attitude(StarField.of(rays[0][others], read[0][others], 50.0))
    whole = fit_attitude(StarField.of(rays[0], read[0], 50.0))
    assert outlier.star == 3 and (fit.freedom, whole.freedom) == (11, 13)
    gained = whole.variance_mm2 * 13 - fit.variance_mm2 * 11
    expected = 8.0 * f_distribution.sf(gained / 2.0 / fit.variance_mm2, 2, 11)
    assert abs(outlier.chance / expected - 1.0) < within("rae outlier chance")


@pytest.mark.parametrize("count", [3, 4, 5, 12])
def test_good_photographs_are_not_called_implausible(count: int) -> None:
    """30 photographs of any attitude and reading error: no status 3."""
    rng = np.random.default_rng(60 + count)
    for _ in range(30):
        images = rng.uniform(-15.0, 15.0, (count, 2))
        rays = np.column_stack([images, np.full(count, -50.0)])
        turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
        stars = rays / np.linalg.norm(rays, axis=1)[:, None] @ turn
        read = images + rng.normal(0.0, 10.0 ** rng.uniform(-3.0, -1.3), images.shape)
        ra, dec = right_ascension_declination_deg(stars)
        columns = np.column_stack([ra, dec])
        lines = tuple(range(2, count + 2))
        file = StarFile("", lines, ("",) * count, read, "mm", "ra_deg,dec_deg", columns)
        assert judge(file, StarField.of(stars, read, 50.0), None, ImageAxes(50.0)).expected == ""
