"""The errata: each fix moves the answer as its entry says, and all of them give the truth back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.kit import wgs84_film
from tests.kit.jobs import case
from tests.kit.wgs84_film import FOOT_M, PLACES, ecef, worst
from tests.tolerances import assert_close, within
from vopd.errata import NO_FIXES, VOPD_ERRATA, fixes


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
    with pytest.raises(vopd.VopdError, match="no fix is called 'earht'"):
        fixes("earht")
    with pytest.raises(vopd.VopdError, match="no ellipsoid is called 'mars'"):
        fixes("earth", ellipsoid="mars")
