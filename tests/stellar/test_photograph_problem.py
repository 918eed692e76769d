"""What is solved of a photograph: options that another needs, errors, and what is handed on."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import Finding, InputError
from vopd.stellar.field import star_directions
from vopd.stellar.files import photograph as photograph_directions_module
from vopd.stellar.files.images import ImageAxes, MissingOption
from vopd.stellar.files.photograph import StarRequest, photograph_directions, photograph_problem
from vopd.stellar.files.read import PixelFormat, StarFile
from vopd.stellar.methods.run import StarOptions
from vopd.stellar.sky import FileSky, SkyRequest

UTC_2020 = datetime(2020, 1, 15, 21, tzinfo=UTC)
PLACE = (48.0, 11.0, 500.0)
IMAGE = np.array([[1.0, 2.0], [3.0, 4.0], [-5.0, 6.0]])
SKY = np.array([[10.0, 20.0], [30.0, 40.0], [50.0, 60.0]])
AXES = ImageAxes(focal_mm=76.0)


def star_file(kind: str = "ra_deg,dec_deg", **more: Any) -> StarFile:
    positions = SKY if "dec" in kind else np.column_stack([SKY, [70.0, 80.0, 90.0]])
    if kind == "u,v,w":
        positions = star_directions(SKY[:, 0], SKY[:, 1])
    one = StarFile("a.csv", (2, 3, 4), ("", "", ""), IMAGE, "mm", kind, positions)
    return replace(one, **more)


def request(sky: dict[str, Any] | None = None, **more: Any) -> StarRequest:
    return StarRequest(AXES, sky=SkyRequest(**(sky or {})), **more)


MOUNT = "--mount needs --place, for the vehicle's yaw and pitch"
DATE = "needs --date, or a column utc"
MISSING: list[tuple[dict[str, Any], str]] = [
    ({"place": PLACE}, f"--place {DATE}"),
    ({"ephemeris": "de421.bsp"}, f"--ephemeris {DATE}"),
    ({"place": PLACE, "ephemeris": "de421.bsp"}, f"--place {DATE}"),
    ({"mount": np.eye(3)}, MOUNT),
    ({"mount": np.eye(3), "utc": UTC_2020}, MOUNT),
    ({"mount": np.eye(3), "place": PLACE}, f"--place {DATE}"),
]


@pytest.mark.parametrize(("sky", "said"), MISSING)
@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "u,v,w"])
def test_an_option_that_needs_another(sky: dict[str, Any], said: str, kind: str) -> None:
    with pytest.raises(MissingOption) as caught:
        photograph_directions(star_file(kind), request(sky), list[Finding]().append)
    assert str(caught.value) == f"a.csv: {said}"


CAMERA = "--camera is for ground points; the file has {}"
FOR_STARS = "a date and a place are for stars by ra and dec or by name, not {}"
AT = {"utc": UTC_2020, "place": PLACE}
REFUSED: list[tuple[str, dict[str, Any], dict[str, Any], str]] = [
    ("ra_deg,dec_deg", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("ra_hours,dec_deg", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("name", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("u,v,w", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("x_m,y_m,z_m", {}, {}, "ground points need --camera X,Y,Z, or --resection"),
    ("u,v,w", AT, {}, FOR_STARS),
    ("u,v,w", {"utc": UTC_2020}, {}, FOR_STARS),
    ("x_m,y_m,z_m", {"utc": UTC_2020}, {"camera_m": (0.0, 0.0, 0.0)}, FOR_STARS),
]


@pytest.mark.parametrize(("kind", "sky", "more", "said"), REFUSED)
def test_an_option_for_another_kind_of_file(
    kind: str, sky: dict[str, Any], more: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        photograph_directions(star_file(kind), request(sky, **more), list[Finding]().append)
    assert str(caught.value) == f"a.csv: {said.format(kind)}"


def test_directions_and_what_they_refer_to() -> None:
    """Nothing is said of stars that are as the file has them."""
    found: list[Finding] = []
    for kind, more, epoch in (
        ("ra_deg,dec_deg", {}, "ICRF axes (J2000), stars as the file has them: no proper motion, "
         "aberration or refraction"),
        ("u,v,w", {}, "the axes of u, v, w"),
        ("x_m,y_m,z_m", {"camera_m": (10.0, 20.0, 0.0)}, ""),
    ):  # fmt: skip
        sky = photograph_directions(star_file(kind), request(**more), found.append)
        assert (sky.epoch, sky.frame, sky.magnitude) == (epoch, None, None)
        if kind != "x_m,y_m,z_m":
            assert_close("rae element", sky.directions, star_directions(SKY[:, 0], SKY[:, 1]))
        else:
            assert_close("rae element", sky.directions[0], [0.0, 0.0, 1.0])
    assert found == []
    long = star_file("u,v,w", positions=np.array([[0.0, 0.0, 2.0]] * 3))
    photograph_directions(long, request(), found.append)
    assert len(found) == 3 and "u, v, w have length 2" in str(found[0])


def test_the_date_of_the_file_is_used() -> None:
    """Before that of the option; everything else that was said of the sky stays."""
    pytest.importorskip("skyfield")
    sky = {"utc": UTC_2020.replace(year=2000), "place": PLACE, "pressure_mbar": 0.0}
    other = UTC_2020.replace(month=2)
    found = photograph_problem(star_file(utc=other), request(sky)).request.sky
    assert (found.utc, found.place, found.pressure_mbar) == (other, PLACE, 0.0)
    assert photograph_problem(star_file(), request(sky)).request.sky.utc == sky["utc"]


def test_warnings_about_the_stars_are_kept() -> None:
    long = star_file("u,v,w", positions=2.0 * star_directions(SKY[:, 0], SKY[:, 1]))
    notes = photograph_problem(long, request()).notes
    assert [str(one) for one in notes] == [
        f"a.csv: line {n}: u, v, w have length 2 and are taken as a direction" for n in (2, 3, 4)
    ]


SIGMAS = np.array([[0.01, 0.02, 0.5], [0.02, 0.01, 0.25], [0.01, 0.01, -0.5]])


@pytest.mark.parametrize("down", ["neither", "option", "format"])
def test_errors_of_the_readings(down: str) -> None:
    """Variances 1, 4, 4, 1, 1, 1 E-4, of which the mean is 2E-4; y turned turns correlations."""
    pixels = PixelFormat(y_down=down == "format")
    asked = replace(request(), axes=ImageAxes(focal_mm=76.0, y_down=down == "option"))
    found = photograph_problem(star_file(sigmas=SIGMAS, pixels=pixels), asked)
    sign = 1.0 if down == "neither" else -1.0
    assert found.stars.errors is not None
    covariance = [[[0.5, 0.5 * sign], [0.5 * sign, 2.0]], [[2.0, 0.25 * sign], [0.25 * sign, 0.5]]]
    assert_close("rae element", found.stars.errors[:2], covariance)
    assert found.request.options.reading_sigma_mm is not None
    assert_close("rae element", found.request.options.reading_sigma_mm, 2.0**0.5 / 100.0)
    assert found.stars.image_mm[:, 1].tolist() == [2.0 * sign, 4.0 * sign, 6.0 * sign]


def test_readings_that_are_all_alike() -> None:
    asked = request(options=StarOptions(reading_sigma_mm=0.03, weights="listed"))
    found = photograph_problem(star_file(), asked)
    assert found.stars.errors is None and found.request.options.reading_sigma_mm == 0.03
    assert photograph_problem(star_file(), request()).request.options.reading_sigma_mm is None


LISTED = "--weights listed knows no columns of sigma, and no other errors"
ERRORS: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"sigmas": SIGMAS}, {"weights": "listed"}, LISTED),
    ({"sigmas": SIGMAS}, {"reading_sigma_mm": 0.1}, "the file has standard deviations: no "
     "--reading-sigma"),
]  # fmt: skip


@pytest.mark.parametrize(("file", "options", "said"), ERRORS)
def test_errors_that_do_not_go_together(
    file: dict[str, Any], options: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        photograph_problem(star_file(**file), request(options=StarOptions(**options)))
    assert str(caught.value) == f"a.csv: {said}"


def test_how_many_stars_a_photograph_may_have() -> None:
    images = np.stack(np.meshgrid(np.arange(100.0), np.arange(1.0, 52.0)), -1).reshape(-1, 2)
    rays = np.column_stack([images, np.full(len(images), -76.0)])
    for count, refused in ((5001, True), (5000, False)):
        lines = tuple(range(11, 11 + count))
        many = StarFile("a.csv", lines, ("",) * count, images[:count], "mm", "u,v,w", rays[:count])
        many = replace(many, positions=rays[:count] / np.linalg.norm(rays[:count], axis=1)[:, None])
        if refused:
            with pytest.raises(InputError) as caught:
                photograph_problem(many, request())
            said = "a.csv: line 5011: more than 5000 stars in one photograph"
            assert str(caught.value) == said
        else:
            assert len(photograph_problem(many, request()).stars.used) == 5000


def test_resection_is_for_ground_points() -> None:
    """Before anything is asked of directions; a position that is given is not used."""
    for more in ({}, {"camera_m": (1.0, 2.0, 3.0)}):
        with pytest.raises(InputError) as caught:
            photograph_problem(star_file("u,v,w"), request(resection=True, **more))
        assert str(caught.value) == "a.csv: --resection is for ground points; the file has u,v,w"


@pytest.mark.parametrize("own", [None, [1.0, 2.0, 3.0]])
@pytest.mark.parametrize("listed", [None, [7.0, 8.0, 9.0]])
def test_magnitudes_of_the_catalogue(
    monkeypatch: pytest.MonkeyPatch, own: list[float] | None, listed: list[float] | None
) -> None:
    """They are used where the file has none of its own; stars by name are looked up there."""
    asked: list[str] = []

    def directions(file: StarFile, sky: SkyRequest, report: Any) -> FileSky:
        asked.append(file.kind)
        known = None if listed is None else np.array(listed)
        return FileSky(star_directions(SKY[:, 0], SKY[:, 1]), None, "", known)

    monkeypatch.setattr(photograph_directions_module, "sky_directions", directions)
    file = star_file("name", magnitude=None if own is None else np.array(own))
    found = photograph_problem(file, request()).file.magnitude
    expected = own or listed
    assert (None if found is None else found.tolist()) == expected and asked == ["name"]
