"""Readings, fiducials, ignored landmarks, and the table of a lens on cards, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.random_flights import lenses
from tests.kit.three_frames import three_frames
from tests.tolerances import assert_close
from vopd.convert.flight_to_deck import (
    CardFilm,
    _rows,
    _table,
    card_ignored,
    card_readings,
)
from vopd.geometry.lenses import Lens, LensKind

INCHES = 0.005
POINT_IN = np.stack([4.0 + 0.1 * np.arange(12.0), 2.0 + 0.2 * np.arange(12.0)], axis=1)
NUMBER = np.array([11, 12, 0, 14])


def film(centre_in: tuple[float, float] = (5.0, 3.0)) -> CardFilm:
    none = np.zeros(25)
    return CardFilm(INCHES, 5.0, np.array(centre_in), POINT_IN, none, none, ())


def test_three_readings_whose_mean_is_the_pick_and_has_its_deviation() -> None:
    """Frames 1 and 2 of three; the pick of the third landmark is not held."""
    flight = three_frames()
    held = np.tile([True, True, False, True], 3)
    frame = np.array([71, 72])
    found = card_readings(flight, film(), held, np.array([1, 2]), frame, NUMBER)
    assert found.frame.tolist() == [71, 72]
    assert found.landmark.tolist() == [[11, 12, 14]] * 2 and found.present.all()
    readings = found.landmark_in  # (F, L, 3, 2)
    rows = np.array([[4, 5, 7], [8, 9, 11]])
    assert_close("five decimals", readings.mean(axis=2), POINT_IN[rows])
    deviation = readings.std(axis=2, ddof=1) / np.sqrt(3.0) / INCHES
    sigma = np.array([0.5, 1.0, 4.0])[None, :, None]  # of u and of v
    assert_close("pick by readings", deviation, np.broadcast_to(sigma, (2, 3, 2)))


@pytest.mark.parametrize(
    ("centre", "away"), [((5.0, 3.0), (4.5, 2.7)), ((4.94, 2.47), (4.44, 2.22))]
)
def test_four_fiducials_stand_nine_tenths_off_the_centre(
    centre: tuple[float, float], away: tuple[float, float]
) -> None:
    """Each read three times alike: left below, right below, right above, left above."""
    found = card_readings(
        three_frames(), film(centre), np.ones(12, bool), np.arange(3), np.arange(3), NUMBER
    ).fiducial_in
    assert found.shape == (3, 4, 3, 2)
    (x, y), (dx, dy) = centre, away
    corners = [[x - dx, y - dy], [x + dx, y - dy], [x + dx, y + dy], [x - dx, y + dy]]
    for frame in range(3):
        for reading in range(3):
            assert_close("film length", found[frame, :, reading], corners)


def test_check_landmarks_are_ignored_everywhere_and_others_nowhere() -> None:
    """A column for each landmark that is seen; the last is a check landmark."""
    found = card_ignored(three_frames(), NUMBER)
    assert found.everywhere.tolist() == [14, 0, 0]
    assert len(found.frame) == 0
    assert card_ignored(three_frames(), np.array([11, 12, 13, 0])).everywhere.tolist() == [0] * 3
    base = three_frames()
    both = replace(base, landmarks=replace(base.landmarks, used=(False, True, True, False)))
    assert card_ignored(both, np.array([0, 12, 13, 14])).everywhere.tolist() == [14, 0, 0]
    every = replace(base, landmarks=replace(base.landmarks, used=()))
    assert card_ignored(every, NUMBER).everywhere.tolist() == [0, 0, 0]


def lens(kind: LensKind = LensKind.BROWN, **more: Any) -> Lens:
    k = np.zeros(12)
    for index, value in more.pop("k", {}).items():
        k[index] = value
    usual = {"focal_px": np.array([1500.0, 1500.0]), "centre_px": np.array([960.0, 540.0])}
    return Lens(kind, (1920, 1080), k=k, **(usual | more))


@pytest.mark.parametrize("index", range(12))
def test_which_coefficients_are_radial(index: int) -> None:
    """OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4: p and s are across."""
    assert lens(k={index: 1e-6}).is_radial == (index in (0, 1, 4, 5, 6, 7))


def test_which_lenses_are_radial() -> None:
    assert lens().is_radial and lens(LensKind.FISHEYE).is_radial
    assert lenses()["table"].is_radial
    assert not lens(skew_px=1e-3).is_radial
    assert not lens(focal_px=np.array([1500.0, 1500.001])).is_radial


def test_rows_of_a_table_and_those_beyond_it() -> None:
    """100 mm of focal length: 200 and 300 um at 10 and 20 mm, then 10 um a mm in steps of 2 mm."""
    table = np.array([[0.0, 0.0], [0.1, 0.102], [0.2, 0.203]])
    radius, added = _rows(table, 100.0)
    assert len(radius) == len(added) == 25
    assert_close("ratio", radius, [0.0, 10.0, *np.arange(20.0, 65.0, 2.0)])
    assert_close("ratio", added, [0.0, 200.0, *np.arange(300.0, 750.0, 20.0)])
    radius, added = _rows(np.array([[0.0, 0.0], [0.003, 0.0031]]), 100.0)
    assert_close("ratio", radius[1:4], [0.3, 0.4, 0.5])  # a tenth of a millimetre at least
    assert_close("ratio", added[1:4], [10.0, 13.333, 16.667])
    radius, added = _rows(np.array([[0.0, 0.0], [0.0123456789, 0.0123499999]]), 100.0)
    assert (radius[1], added[1]) == (1.234568, 0.432)
    whole = np.linspace(0.0, 0.24, 25)
    assert len(_rows(np.stack([whole, whole], axis=1), 100.0)[0]) == 25


def test_the_table_of_a_lens_goes_to_its_farthest_pick() -> None:
    """Two percent farther than the ideal radius .5, and at least .1; k1 = -.1 at every row."""
    ideal = np.array([[0.3, 0.4], [0.1, 0.0], [np.nan, np.nan]])
    found = _table(lens(k={0: -0.1}), ideal)
    assert len(found) == 25
    assert_close("ratio", found[:, 1], np.linspace(0.0, 0.51, 25))
    assert_close("ratio", found[:, 0], found[:, 1] * (1 - 0.1 * found[:, 1] ** 2))
    assert_close("ratio", _table(lens(), ideal[2:])[-1, 1], 0.102)
    folding = _table(lens(k={0: -1.5}), ideal)  # grows until r2 = 1 / 4.5, .471
    assert 20 < len(folding) < 25 and folding[-1, 1] < 0.472


@pytest.mark.parametrize("rows", [25, 26])
def test_a_table_of_25_rows_is_taken_as_it_is(rows: int) -> None:
    table = np.stack([np.linspace(0.0, 1000.0, rows), np.linspace(0.0, 30.0, rows)], axis=1)
    one = lens(LensKind.RADIAL_TABLE, table=table)
    found = _table(one, np.array([[0.2, 0.0]]))
    assert len(found) == 25
    last = [1000.0 / 1500.0, 1030.0 / 1500.0] if rows == 25 else [0.204 / 1.03, 0.204]
    assert_close("ratio", found[-1], last)
