"""The constants of the listing, as its cards have them: every digit counts."""

from __future__ import annotations

import pytest

from vopd.program import constants, geocentric, ignored, orient
from vopd.program.earth import SEA_LEVEL_KFT

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
