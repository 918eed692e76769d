"""The flag of frames whose errata exceed a sigma, and the columns and words that go with it."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit import estimates, wgs84_film
from tests.kit.command import CASE_1, vopd
from tests.tolerances import assert_close
from vopd.attitude.conventions import conventions
from vopd.attitude.flags import model_error
from vopd.attitude.history import History, history
from vopd.attitude.table import columns_of
from vopd.cards.write import write_deck
from vopd.pipeline import run

TRUTH = np.tile([40.0, -60.0, 10.0], (5, 1))
SIGMA = np.full((5, 9), 0.1)


def effect(*rows: dict[int, float]) -> np.ndarray:
    """Five frames with these effects, an index in the nine angles and degrees; 0 elsewhere."""
    found = np.zeros((5, 9))
    for k, row in enumerate(rows):
        for index, degrees in row.items():
            found[k, index] = degrees
    return found


def test_an_angle_of_vehicle_or_camera_beyond_one_sigma() -> None:
    """Below sigma; above; an angle of attack alone; negative, in sigmas; not determined."""
    given = effect({3: 0.099}, {4: 0.101}, {6: 5.0}, {0: -0.3, 5: 0.4}, {})
    given[4] = np.nan
    sigma = SIGMA.copy()
    sigma[3, 5] = 0.2  # two sigmas of vehicle roll, three of camera yaw
    marked, worst = model_error(estimates.estimate(TRUTH, slip_effect_deg=given), sigma)
    assert marked.tolist() == [False, True, False, True, False]
    assert (worst[1], worst[3]) == ("vehicle_pitch", "camera_yaw")


def test_of_the_same_angle_of_camera_and_vehicle_the_vehicle_is_named() -> None:
    given = effect({1: 0.3, 4: -0.3 * (1.0 - 1e-12)})
    _, worst = model_error(estimates.estimate(TRUTH, slip_effect_deg=given), SIGMA)
    assert worst[0] == "vehicle_pitch"


def test_no_sigma_no_flag() -> None:
    given = effect({4: 100.0})
    for sigma in (np.nan, np.inf):
        marked, _ = model_error(
            estimates.estimate(TRUTH, slip_effect_deg=given), np.full((5, 9), sigma)
        )
        assert not marked.any()


def test_without_errata_there_are_neither_flags_nor_columns_nor_words() -> None:
    one = history(estimates.estimate(TRUTH))
    assert not one.flags.raised["model_error"].any()
    assert not [column.name for column in columns_of([one]) if "slip" in column.name]
    assert "errata" not in conventions([one])["sigmas"]


def low_film() -> History:
    """From 120 m above the landmarks, where the Earth of 1974 is 1.7 degrees wrong."""
    job, _ = wgs84_film.film(46.6, 7.4, decimals=None, scale=1 / 300)
    (one,) = run(job).histories()
    return one


def test_a_low_flight_is_flagged_in_every_frame() -> None:
    one = low_film()
    assert one.flags.raised["model_error"].all()
    assert all("model_error:vehicle_pitch" in text for text in one.flag_text)
    worst = np.abs(one.estimate.slip_effect_deg[:, :6]).max()
    assert f"up to {worst:.3f} degree" in conventions([one])["sigmas"]


def table(*arguments: object) -> tuple[dict[str, str], list[dict[str, str]]]:
    done = vopd("attitude", *arguments)
    assert done.status == 0, done.stderr
    lines = done.stdout.splitlines()
    said = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    rows = csv.DictReader(io.StringIO("\n".join(one for one in lines if one[0] != "#")))
    return said, list(rows)


def test_the_table_has_what_all_fixes_change() -> None:
    """Case 1 with and without the fixes: the difference of the two tables."""
    said, (plain,) = table(CASE_1)
    said_fixed, (fixed,) = table(CASE_1, "--fix", "all", "-q")
    for angle in ("camera_pitch", "vehicle_yaw", "vehicle_roll", "alpha", "eta"):
        change = float(fixed[f"{angle}_deg"]) - float(plain[f"{angle}_deg"])
        assert_close("six decimals", float(plain[f"slip_effect_{angle}_deg"]), change)
    assert_approved(said["sigmas"])
    assert "camera_pitch" in said["sigmas"]
    assert "slip_effect_alpha_deg" not in fixed and "errata" not in said_fixed["sigmas"]


@pytest.mark.parametrize("fix", [(), ("--fix", "all")], ids=["faithful", "fixed"])
def test_strict_sees_it(fix: tuple[str, ...]) -> None:
    job, _ = wgs84_film.film(33.08, -106.33, decimals=3)
    done = vopd("attitude", "-", "--strict", "-q", *fix, stdin=write_deck([job]))
    assert done.status == (0 if fix else 3)
    assert ("model_error:vehicle_pitch" in done.stdout) == (not fix)
