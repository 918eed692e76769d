"""The constants of the listing, and the errata: each fix by its entry, alone and together."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.approved.texts import refused
from tests.kit import appendix_a, wgs84_film
from tests.kit.jobs import RESULT_ARRAYS, case, film, turned
from tests.kit.wgs84_film import FOOT_M, PLACES, ecef, worst
from tests.tolerances import assert_close, within
from vopd.errata import NO_FIXES, VOPD_ERRATA, Fix, Fixes, fixes
from vopd.program import constants, geocentric, ignored, orient
from vopd.program.earth import SEA_LEVEL_KFT
from vopd.program.positions import kilometres
from vopd.program.vopd import run
from vopd.results import Results

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
    """A 56 and A 195, which has one zero too many; sin 6PHI has the wrong sign in both."""
    assert geocentric.ORIGIN_FOUR_PHI == 0.0003258611111111
    assert geocentric.LANDMARK_FOUR_PHI == 0.0000325861111111
    assert geocentric.SIX_PHI == 7.2222222222e-07


def test_counts_of_the_solve_and_of_group_11() -> None:
    assert (orient.PASSES, ignored.WHOLE_FRAME, SEA_LEVEL_KFT) == (22, 100, 20925.698)


def test_feet_andkilometres() -> None:
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
        assert kilometres(fixes(*names), feet).tolist() == (feet.T * km).tolist()


def test_degrees_and_minutes_are_added_with_their_signs() -> None:
    """-106 degrees and -36.65 minutes; 33 degrees and -2.5 minutes are 32.958333."""
    results = run(film(1))
    longitude = [-106.0 + m / 60.0 for m in (-12.0, -24.0, -18.0, -27.5, -20.25)]
    latitude = [33.0 + m / 60.0 for m in (2.0, 1.0, 8.5, 9.75, -2.5)]
    assert results.longitude_deg[0].tolist() == longitude
    assert results.latitude_deg[0].tolist() == latitude


# Each fix, and all


@pytest.mark.parametrize("place", PLACES)
def test_all_fixes_give_the_true_attitude_back(place: tuple[float, float]) -> None:
    job, truth = wgs84_film.film(*place, decimals=None)
    found = vopd.run(job, fixes("all"))
    assert worst(found.camera_deg, truth) < within("attitude, noise-free arrays")
    assert found.converged.all()


@pytest.mark.parametrize("place", PLACES)
def test_all_fixes_through_a_deck(place: tuple[float, float], tmp_path: Path) -> None:
    job, truth = wgs84_film.film(*place, decimals=4)  # -1.2345 and 12.3456 fill seven columns
    deck = tmp_path / "synthetic.dat"
    deck.write_text(vopd.write_deck([job]))
    (read,) = vopd.read_deck(deck)
    found = vopd.run(read, fixes("all"))
    assert worst(found.camera_deg, truth) < within("attitude, noise-free deck")
    if abs(place[0]) > 30:  # at the equator the sphere's vertical is the ellipsoid's
        assert worst(vopd.run(read).camera_deg, truth) > 0.003


DEFINED = {  # equatorial radius, km, and flattening, of the manuals
    "wgs84": (6378.137, 1 / 298.257223563),
    "international1924": (6378.388, 1 / 297.0),
    "clarke1866": (6378.2064, 1 / 294.9786982138),
}


def test_the_ellipsoid_is_the_one_asked_for() -> None:
    """On another ellipsoid the same job has other radii, those of its own formula."""
    job, _ = wgs84_film.film(-33.9, 18.4, decimals=None)
    for name, (a_km, f) in DEFINED.items():
        results = vopd.run(job, fixes("earth", ellipsoid=name))
        marks = job.landmarks
        for k in range(4):
            lat, lon = marks.latitude_min[k] / 60, marks.longitude_min[k] / 60
            there = ecef(lat, lon, marks.altitude_ft[k] * FOOT_M, a_km * 1000.0, f)
            radius_km = np.linalg.norm(there) / 1000.0
            assert abs(results.radius_km[0, k] - radius_km) < within("radius, km")
            geocentric = np.degrees(np.arctan2(there[2], np.hypot(there[0], there[1])))
            off = results.geocentric_latitude_deg[0, k] - geocentric
            assert abs(off) < within("latitude, deg")


def test_each_fix_alone_and_in_its_direction() -> None:
    """What each entry of the errata says, on the printed cases."""
    plain = {k: vopd.run(case(k)) for k in (1, 4)}

    def fixed(k: int, name: str) -> vopd.Results:
        return vopd.run(case(k), fixes(name))

    # Appendix A's series by hand for 32.83833 degrees: 32.66249, where the listing prints 32.66227
    latitude = fixed(1, "latitude-series").geocentric_latitude_deg[0, 0]
    assert f"{latitude:.5f}" == "32.66249"
    assert f"{plain[1].geocentric_latitude_deg[0, 0]:.5f}" == "32.66227"
    # scipy's least squares on the collinearity equations of frame 60 ends at 225.1196489
    assert f"{plain[4].camera_deg[1, 0]:.3f}" == "225.133"
    assert f"{fixed(4, 'first-landmark').camera_deg[1, 0]:.3f}" == "225.120"
    # frame 65 starts where frame 60 ended, as the report's text has it, and not at group 8
    assert plain[4].start_deg[2].tolist() == [225.0, -86.0, 182.0]
    start = fixed(4, "restart").start_deg[2]
    assert_close("start of a kept frame", start, plain[4].camera_deg[1])
    # - 2 * 7.2222E-7 sin 6PHI, PHI 32.83833: sin 197.03 deg = -.2929, so + 4.2E-7 degrees
    shift = fixed(1, "sin-6phi").geocentric_latitude_deg - plain[1].geocentric_latitude_deg
    assert_close("term of the latitude", shift[0, 0], 4.23e-7)
    # averages 10.178, 10.174, 10.174: 10.175333..., which unit 9 cuts at eight digits
    assert plain[1].point_in[0, 0, 0] == 10.175333
    assert_close("mean reading", fixed(1, "eight-digits").point_in[0, 0, 0], 30.526 / 3)
    # three landmarks: root of 6/(6 - 3) times as much
    ratio = fixed(1, "standard-deviation").residual_deviation_mm / plain[1].residual_deviation_mm
    assert_close("ratio", ratio[0], np.sqrt(2.0))
    # 1/3280.8336 is 5E-8 less than .0003048006: the camera is 2 mm nearer to the origin
    moved = fixed(1, "feet-per-km").direction - plain[1].direction
    assert 1e-9 < np.abs(moved).max() < 1e-7
    assert worst(fixed(1, "earth").camera_deg, plain[1].camera_deg) > 0.01


def test_nothing_moves_without_a_fix() -> None:
    assert vopd.run(case(4))[0] == vopd.run(case(4), NO_FIXES)[0]
    assert not NO_FIXES


def test_two_landmarks_leave_one_degree_of_freedom() -> None:
    job, _ = wgs84_film.film(33.08, -106.33, decimals=3)
    two = replace(job, ignored=replace(job.ignored, everywhere=np.array([11, 22, 0, 0])))
    one, other = vopd.run(two), vopd.run(two, fixes("standard-deviation"))
    assert_close("ratio", other.residual_deviation_mm / one.residual_deviation_mm, 2.0)


@pytest.mark.parametrize("name", [erratum.name for erratum in VOPD_ERRATA])
def test_a_corrected_run_cannot_be_mistaken(name: str) -> None:
    text = vopd.listing_text(vopd.run(case(4), fixes(name)))
    pages = text.split("\n1")
    assert len(pages) == 4  # the ignored frame's line, two frames, the last title
    assert all(f"CORRECTED RUN, NOT THE ORIGINAL: {name}" in page for page in pages[1:])


def test_unknown_names_are_refused() -> None:
    with refused(vopd.VopdError):
        fixes("earht")
    with refused(vopd.VopdError):
        fixes("earth", ellipsoid="mars")


# One fix alone
#
# Without the fix `restart` every frame of case 4 starts from group 8, whatever else is corrected.


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
