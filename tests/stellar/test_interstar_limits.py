"""Limits of the tests by interstar angles, and which stars are compared."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.random_stars import stars
from tests.tolerances import assert_close
from vopd.stellar import interstar_angles
from vopd.stellar.field import StarField
from vopd.stellar.interstar_angles import (
    Disagreement,
    interstar_reading_sigma_mm,
    median_disagreement_mm,
    outliers,
    star_disagreement_arcsec,
    star_pairs,
    widest_pair,
)

MEDIANS: list[tuple[list[float], list[bool]]] = [
    ([2.0, 2.0, 2.0, 10.1], [False, False, False, True]),
    ([2.0, 2.0, 2.0, 9.9], [False] * 4),
    ([2.0, 2.0, 2.0, 10.0], [False] * 4),
    ([0.1, 0.1, 0.1, 0.99], [False] * 4),
    ([0.1, 0.1, 0.1, 1.01], [False, False, False, True]),
    ([0.1, 0.1, 9.0], [False] * 3),
    ([1.0, 1.0, np.nan, 6.0, 1.0], [False, False, False, True, False]),
    ([np.nan] * 4, [False] * 4),
]


@pytest.mark.parametrize(("medians", "marked"), MEDIANS)
def test_five_times_the_others_and_a_second(
    monkeypatch: pytest.MonkeyPatch, medians: list[float], marked: list[bool]
) -> None:
    """Of four stars and more; the others are told by their median."""
    table = Disagreement(np.array(medians), np.array(medians))
    monkeypatch.setattr(interstar_angles, "star_disagreement_arcsec", lambda field: table)
    assert outliers(stars(len(medians))).tolist() == marked


def test_the_reading_error_of_interstar_angles(monkeypatch: pytest.MonkeyPatch) -> None:
    """A normal error is larger than .6745 deviations in half of all cases."""
    table = np.array([[1.0, 2.0, np.nan], [3.0, 4.0, 100.0]])
    monkeypatch.setattr(interstar_angles, "_sampled_discrepancies", lambda field: table)
    assert_close("rae element", interstar_reading_sigma_mm(stars(3)), 3.0 / 0.6744897501960817)
    assert_close("rae element", median_disagreement_mm(stars(3)), [2.0, 3.0, 100.0])
    assert np.isnan(interstar_reading_sigma_mm(stars(2)))


@pytest.mark.parametrize(("count", "partners"), [(3, 2), (41, 40), (42, 40), (300, 40)])
def test_partners_of_a_star(monkeypatch: pytest.MonkeyPatch, count: int, partners: int) -> None:
    """Forty others at most, spread over the whole list, the same for each star."""
    given: list[np.ndarray] = []
    whole = StarField.select

    def select(field: StarField, index: np.ndarray) -> StarField:
        given.append(index)
        return whole(field, index)

    monkeypatch.setattr(StarField, "select", select)
    assert interstar_angles._sampled_discrepancies(stars(count)).shape == (partners, count)
    (pairs,) = given
    steps = (pairs[:, 1] - pairs[:, 0]) % count
    assert pairs[:, 0].tolist() == list(range(count)) * partners
    assert (steps[0], steps[-1], len(set(steps.tolist()))) == (1, count - 1, partners)
    assert max(np.diff(sorted(set(steps.tolist()))), default=1) <= count // 40 + 1


def test_pairs_in_the_order_of_the_report() -> None:
    assert star_pairs(4).tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert star_pairs(1).tolist() == []


def test_the_widest_pair() -> None:
    """By the sine: 80 degrees before 150; of stars that are used; the first of none."""
    degrees = np.radians([0.0, 150.0, 80.0, 20.0])
    directions = np.column_stack([np.cos(degrees), np.sin(degrees), np.zeros(4)])
    used = np.array([[1, 1, 1, 1], [1, 1, 0, 1], [1, 0, 0, 0], [1, 0, 0, 1]], bool)
    field = StarField.of(directions, np.zeros((4, 2)), 1.0, used)
    assert widest_pair(field).tolist() == [[0, 2], [1, 3], [0, 1], [0, 3]]
    same = StarField.of(
        np.tile([0.0, 0.0, 1.0], (3, 1)), np.zeros((3, 2)), 1.0, [False, True, True]
    )
    assert widest_pair(same).tolist() == [1, 2]


def test_disagreements_leave_out_stars_that_are_not_used() -> None:
    """Right angles in the sky, 45, 45 and 60 degrees on the photograph."""
    images = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [5.0, 5.0]])
    sky = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    used = np.array([[1, 1, 1, 0], [1, 1, 0, 0], [1, 0, 0, 0]], bool)
    total, median = star_disagreement_arcsec(StarField.of(sky, images, 1.0, used))
    none = np.nan
    sums = [[90.0, 75.0, 75.0, none], [45.0, 45.0, none, none], [none] * 4]
    middles = [[45.0, 37.5, 37.5, none], [45.0, 45.0, none, none], [none] * 4]
    assert_close("rae angle", total / 3600.0, sums)
    assert_close("rae angle", median / 3600.0, middles)
