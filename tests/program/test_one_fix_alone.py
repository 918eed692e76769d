"""Each fix changes what its erratum is about, what follows from that, and nothing else.

Without the fix `restart` every frame of case 4 starts from group 8, whatever else is corrected.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.kit import appendix_a
from tests.kit.jobs import RESULT_ARRAYS, case, turned
from tests.tolerances import assert_close
from vopd.errata import NO_FIXES, Fix, Fixes, fixes
from vopd.program.vopd import run
from vopd.results import Results

LATITUDES = {"geocentric_latitude_deg", "direction"}
FILM = {"centre_in", "point_in", "centre_mm", "point_mm", "radius_mm", "distortion_mm"}
SOLVED = {
    "camera_deg", "vehicle_deg", "alpha_deg", "beta_deg", "eta_deg",
    "airspeed_ft_s", "residual_mm", "residual_deviation_mm", "correction_rad",
}  # fmt: skip
CHANGED = {  # what may change by each fix; what follows from the solve is in SOLVED
    "latitude-series": LATITUDES | SOLVED,
    "first-landmark": SOLVED,
    "restart": {"start_deg"} | SOLVED,
    "earth": LATITUDES | {"radius_km", "radius_kft"} | SOLVED,
    "sin-6phi": LATITUDES | SOLVED,
    "feet-per-km": {"direction"} | SOLVED,
    "eight-digits": FILM | SOLVED,
    "standard-deviation": {"residual_deviation_mm"},
}
MUST = {  # what does change of case 4, in each fix, beside what follows from it
    "latitude-series": LATITUDES,
    "first-landmark": {"camera_deg", "residual_mm"},
    "restart": {"start_deg"},
    "earth": LATITUDES | {"radius_km", "radius_kft"},
    "sin-6phi": LATITUDES,
    "feet-per-km": {"direction"},
    "eight-digits": FILM,
    "standard-deviation": {"residual_deviation_mm"},
}


@cache
def of_case_4(chosen: Fixes = NO_FIXES) -> Results:
    return run(case(4), chosen)


def test_these_are_all_fixes() -> None:
    assert set(CHANGED) == set(MUST) == {fix.value for fix in Fix}


@pytest.mark.parametrize("name", CHANGED)
def test_a_fix_alone(name: str) -> None:
    plain, fixed = of_case_4(), of_case_4(fixes(name))
    changed = {
        array
        for array in RESULT_ARRAYS
        if getattr(plain, array).dtype == np.float64
        and not np.array_equal(getattr(plain, array), getattr(fixed, array), equal_nan=True)
    }
    assert MUST[name] <= changed <= CHANGED[name]


@pytest.mark.parametrize("name", CHANGED)
def test_all_fixes_but_one(name: str) -> None:
    """What only this erratum is about is as in the original, whatever else is corrected."""
    others = of_case_4(Fixes(frozenset(Fix) - {Fix(name)}))
    everything = of_case_4(fixes("all"))
    apart = {"latitude-series", "sin-6phi", "feet-per-km"}  # no longer used with the fix `earth`
    for array in MUST[name]:
        same = np.array_equal(getattr(others, array), getattr(everything, array), equal_nan=True)
        assert same == (name in apart)


def test_corrections_have_their_signs() -> None:
    """Of frames that are on their way after 22 passes, by least squares of Appendix A."""
    truth = np.tile([140.0, -80.0, 60.0], (4, 1))
    starts = np.array([
        [140.0, 10.0, 60.0], [20.0, 20.0, 300.0], [300.0, 30.0, 10.0], [200.0, 5.0, 190.0],
    ])  # fmt: skip
    results = run(turned(truth, truth[0]), start_deg=starts)
    signs = set()
    for k in np.flatnonzero(~results.converged):
        film = results.residual_mm[k] + appendix_a.project(
            results.camera_deg[k] / appendix_a.RAD, results.direction[k], 10.4
        )
        expected = appendix_a.correction(
            results.camera_deg[k] / appendix_a.RAD, results.direction[k], film, 10.4
        )
        scale = np.abs(expected).max()
        assert_close("derivative by steps", results.correction_rad[k] / scale, expected / scale)
        signs |= set(np.sign(expected))
    assert signs == {-1.0, 1.0}
