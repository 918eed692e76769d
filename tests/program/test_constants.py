"""The constants of the listing, as its cards have them: every digit counts."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.jobs import case, film
from vopd.errata import fixes
from vopd.program import constants, geocentric, ignored, orient
from vopd.program.earth import SEA_LEVEL_KFT
from vopd.program.positions import _kilometres
from vopd.program.vopd import run

CARDS = {  # TM X-3050, A 19 to A 23, C 4 and C 5
    "rad": 57.29577951,
    "dr": 0.0174532925,
    "pi": 3.14159265,
    "twopi": 6.2831853,
    "ftpkm": 3280.8336,
    "vftpkm": 0.0003048006,
    "factor": 0.713816400205,
    "eradkm": 6378.165,
}


@pytest.mark.parametrize("name", CARDS)
def test_a_constant(name: str) -> None:
    assert getattr(constants, name) == CARDS[name]


def test_there_are_no_others() -> None:
    assert {name for name in vars(constants) if not name.startswith("__")} == set(CARDS)


def test_the_series_of_the_latitude() -> None:
    """A 55 and A 195, which has one zero too many; sin 6PHI has the wrong sign in both."""
    assert geocentric.ORIGIN_FOUR_PHI == 0.0003258611111111
    assert geocentric.LANDMARK_FOUR_PHI == 0.0000325861111111
    assert geocentric.SIX_PHI == 7.2222222222e-07


def test_counts_of_the_solve_and_of_group_11() -> None:
    assert (orient.PASSES, ignored.WHOLE_FRAME, SEA_LEVEL_KFT) == (22, 100, 20925.698)


def test_feet_and_kilometres() -> None:
    """Altitudes and radii by 3280.8336 ft, X, Y, Z by .0003048006 km, unless that is corrected."""
    results = run(case(1))
    radius_km = np.array([10000.0, 10000.0, 4000.0]) / 3280.8336 + 6378.165
    assert results.radius_km[0].tolist() == radius_km.tolist()
    assert results.radius_kft[0].tolist() == (radius_km * 3280.8336 / 1000.0).tolist()
    feet = np.array([[1000.0, -20.0, 3.0]])
    for names, km in {
        (): 0.0003048006,
        ("restart", "latitude-series"): 0.0003048006,
        ("feet-per-km",): 1 / 3280.8336,
        ("earth",): 1 / 3280.8336,
    }.items():
        assert _kilometres(fixes(*names), feet).tolist() == (feet.T * km).tolist()


def test_degrees_and_minutes_are_added_with_their_signs() -> None:
    """-106 degrees and -36.65 minutes; 33 degrees and -2.5 minutes are 32.958333."""
    results = run(film(1))
    longitude = [-106.0 + m / 60.0 for m in (-12.0, -24.0, -18.0, -27.5, -20.25)]
    latitude = [33.0 + m / 60.0 for m in (2.0, 1.0, 8.5, 9.75, -2.5)]
    assert results.longitude_deg[0].tolist() == longitude
    assert results.latitude_deg[0].tolist() == latitude
