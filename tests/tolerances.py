"""Every tolerance of the tests: quantity, unit, absolute tolerance, reason."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Tolerance(NamedTuple):
    """How far a number may be from the expected one."""

    unit: str
    absolute: float
    reason: str


TOLERANCES = {
    "angle wrapped 22 times": Tolerance(
        "deg", 1e-10, "sums of 8000 degrees; 22 times the twelfth decimal"
    ),
    "angle from the film reader": Tolerance(
        "deg", 0.01, "readings of .001 in. are .0007 mm of 10.4, .004 degree; four landmarks"
    ),
    "start of a kept frame": Tolerance(
        "deg", 1e-10, "the rule: a converged frame is not solved again for less"
    ),
    "vehicle position": Tolerance(
        "ft", 1e-8, "table values of 1E5 ft; the time has 1E-11 s, 500 ft/s"
    ),
    "time": Tolerance("s", 1e-11, "table values of 100 s, a few roundings"),
    "angle from readings": Tolerance(
        "deg",
        2e-5,
        "unit 9 keeps 5E-7 in. of 10 in., 2E-6 degree; roll and yaw at 86 degrees pitch",
    ),
    "residual of readings": Tolerance(
        "mm", 1e-6, "unit 9 keeps 5E-7 in. of 10 in., which is 3.6E-7 mm"
    ),
    "geocentric latitude": Tolerance(
        "deg", 1e-10, "RAD has ten digits: 2E-10 of 200 degrees, times .19"
    ),
    "airspeed by hand": Tolerance("ft/s", 1e-7, "seven decimals were worked"),
    "airspeed": Tolerance(
        "ft/s", 1e-8, "speeds of 1E3 ft/s by other means; DPR has ten digits, 1E-11"
    ),
    "solved angle": Tolerance("deg", 1e-6, "no noise; the erratum makes the last passes slow"),
    "correction": Tolerance(
        "rad", 1e-9, "below 10 rad, from normal equations of condition below 1E6"
    ),
    "recovered angle": Tolerance(
        "deg", 1e-10, "film of full precision, last corrections below 1E-13 rad"
    ),
    "wrapped angle": Tolerance(
        "deg", 1e-11, "twelve decimals were worked by hand, angles below 400"
    ),
    "angle after 22 passes": Tolerance(
        "deg", 1e-9, "another solver; frames with condition up to 1E3"
    ),
    "normal equation": Tolerance("mm2/rad", 1e-11, "sums of 6 products of 1 mm by 20 mm/rad"),
    "minimiser's angle": Tolerance(
        "deg", 1e-6, "scipy stops where the sum of squares no longer shows a change"
    ),
    "table value": Tolerance("1", 1e-12, "small decimals worked by hand, a few roundings"),
    "inverse element": Tolerance("1", 1e-9, "elements and condition below 1E3"),
    "determinant": Tolerance("1", 1e-9, "up to 1E5, the product of four pivots"),
    "direction cosine": Tolerance("1", 1e-12, "6378 km cancel to 40 km: 160 roundings of 1E-16"),
    "angle of attack by hand": Tolerance("deg", 5e-6, "five decimals were worked"),
    "attitude, noise-free arrays": Tolerance(
        "deg", 1e-6, "RAD and PI have ten digits: 1E-8 degree, and the solve ends far below"
    ),
    "attitude, noise-free deck": Tolerance(
        "deg", 0.003, "readings of .0001 in. are 2E-4 degree, more about the optical axis"
    ),
    "radius, km": Tolerance("km", 1e-8, "6378 km by another formula"),
    "latitude, deg": Tolerance("deg", 1e-10, "the same"),
    "residual": Tolerance("mm", 1e-11, "film coordinates of 10 mm"),
    "film length": Tolerance("mm", 1e-12, "lengths below 10 mm, a few roundings"),
    "printed angle": Tolerance("deg", 5.1e-4, "half of the last of three printed decimals"),
    "printed time": Tolerance("s", 5.1e-4, "half of the last of three printed decimals"),
    "printed feet": Tolerance("ft", 5.1e-3, "half of the last of two printed decimals"),
    "axis by printed angles": Tolerance(
        "1", 2.7e-5, "three angles of half the third decimal, 9E-6 rad each"
    ),
    "direction by printed feet": Tolerance(
        "1", 1e-9, "three times half the second decimal, of 2E7 ft from the Earth's centre"
    ),
    "six decimals": Tolerance("deg", 2e-6, "a root of squares of three numbers of six decimals"),
    "ten decimals": Tolerance("1", 2e-10, "four components of ten decimals"),
    "rae rotation": Tolerance("1", 1e-9, "elements of a matrix, condition below 1E5"),
    "rae rotation by angles": Tolerance("1", 1e-7, "an arc sine near 1 has half the digits"),
    "rae printed angle": Tolerance("deg", 1e-8, "the golden values have ten decimals"),
    "rae printed cosine": Tolerance("1", 0.6e-8, "half a unit of the eighth decimal"),
    "rae RADEC2 angle": Tolerance("deg", 0.6e-8, "half a unit of the eighth decimal"),
    "rae table 6.4": Tolerance("deg", 0.51e-4, "half a unit of the fourth decimal"),
    "rae table 6.4 early": Tolerance("deg", 1.01e-4, "one unit: three corrections, unknown start"),
    "rae element": Tolerance("1", 1e-12, "double precision through a few products"),
    "rae element near a pole": Tolerance("1", 3e-8, "an arc sine near 1 has half the digits"),
    "rae stack element": Tolerance("1", 1e-12, "sums over a longer axis may round otherwise"),
    "rae weight": Tolerance("mm2", 1.0, "the report has whole numbers, one of them cut"),
    "rae angle": Tolerance("deg", 1e-9, "matrices good to 1E-12, an arc tangent"),
    "rae angle of nine digits": Tolerance("deg", 1e-6, "stars of nine digits, arms above .1"),
    "rae outlier chance": Tolerance("1", 0.01, "a ratio; images are not quite linear in turns"),
    "rae figure": Tolerance("deg", 0.51e-7, "half of the last of seven printed decimals"),
    "rae arc cosine": Tolerance("arcsec", 1e-6, "angles above .1 rad by an arc cosine: 1E-15"),
    "rae stated sigma": Tolerance("1", 0.04, "a ratio; a deviation of 4,000 draws has 1.1 percent"),
    "rae stated correlation": Tolerance("1", 0.08, "covariances over deviations of 4,000 draws"),
    "rae interstar sigma": Tolerance("1", 0.15, "a ratio; medians of 100 estimates from 3 angles"),
    "rae method error": Tolerance("1", 0.05, "a ratio; 5,000 draws, and two printed digits"),
    "rae arc cosine, rounded stars": Tolerance("arcsec", 1e-3, "cosines of nine digits"),
    "extrapolated table value": Tolerance("", 1e-9, "values up to 1E5 by a few operations"),
    "demo time": Tolerance("s", 1e-9, "32nds of a second, which five decimals print exactly"),
    "demo position": Tolerance("ft", 5.1e-5, "half of the last of four printed decimals"),
    "demo angle": Tolerance("deg", 1.1e-6, "two angles of six printed decimals"),
    "demo speed": Tolerance("ft/s", 0.1, "positions to .01 ft, rows .16 s apart; 6 ft/s3 between"),
    "demo altitude": Tolerance("ft", 0.051, "one printed decimal; the next order is 1E-5"),
    "film of eight digits": Tolerance(
        "mm", 2e-6, "unit 9 keeps 5E-7 in., 4E-7 mm, of each of 16 coordinates at most"
    ),
    "flight pixel": Tolerance("px", 1e-9, "coordinates of 1E4 px, a few dozen roundings"),
    "flight ray": Tolerance("1", 1e-13, "undone by iteration to the last bits"),
    "flight partial": Tolerance("px/rad", 1e-5, "central differences of 1E-5 rad of 1E3 px"),
    "flight rotation": Tolerance(
        "deg", 1e-9, "residuals of .02 px: scipy's sum of squares shows no smaller turn"
    ),
    "flight Newton step": Tolerance(
        "deg", 1e-9, "what is left to the minimum, by differences in extended precision"
    ),
    "published angle": Tolerance("deg", 6e-4, "matrices of six and angles of three decimals"),
    "published cosine": Tolerance("1", 2e-6, "matrices of six decimals"),
    "flight response": Tolerance(
        "rad", 2e-7, "central differences of .001: third order, refraction by another path"
    ),
    "flight turn": Tolerance("rad", 1e-7, "turns of 1E-4 rad, second order"),
    "flight angle": Tolerance(
        "deg", 2e-6, "files of a micrometre at 300 m and of 1E-9 px; a track's chord"
    ),
    "flight height": Tolerance("m", 0.01, "two decimals were worked by hand"),
    "flight refraction": Tolerance("rad", 1e-12, "an integral good to 1E-11 of 4E-4"),
    "flight direction": Tolerance("1", 1e-10, "6.4E6 m cancel to 90 m"),
    "flight position": Tolerance("m", 1e-4, "four decimals were worked; 6E6 m in between"),
    "curvature": Tolerance("rad", 2e-8, "the meridian's radius changes by 1E-5 over 10 km"),
    "flight time": Tolerance("s", 1e-12, "a few decimals"),
    "flight speed": Tolerance("m/s", 1e-3, "north turns by 1E-5 rad along the track"),
    "flight robust step": Tolerance("deg", 1e-6, "the same, for a loss with kinks"),
}
"""By name; the unit is that of the number compared."""


def within(name: str) -> float:
    """The absolute tolerance of that name."""
    return TOLERANCES[name].absolute


def assert_close(quantity: str, actual: ArrayLike, expected: ArrayLike) -> None:
    """Fail unless every element is as near as the table asks; NaN equals NaN."""
    np.testing.assert_allclose(
        actual,
        expected,
        rtol=0,
        atol=within(quantity),
        err_msg=f"{quantity} ({TOLERANCES[quantity].unit})",
    )
