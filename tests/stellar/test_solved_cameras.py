"""Cameras solved with the attitude: values, deviations, needs, doubts and errors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import InputError
from vopd.stellar.field import Failure, StarField
from vopd.stellar.files import photograph as solved_calibration
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.photograph import SolvedCalibration, solve_calibration
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.calibration import Calibration, LensOfStars

COUNT = 8
IMAGE = np.random.default_rng(2).uniform(-20.0, 20.0, (COUNT, 2))
EVERYONE = np.arange(COUNT)


def star_file(unit: str = "mm") -> StarFile:
    lines = tuple(range(2, 2 + COUNT))
    return StarFile("a.csv", lines, ("",) * COUNT, IMAGE, unit, "ra_deg,dec_deg", IMAGE)


RAYS = np.column_stack([IMAGE, np.full(COUNT, -76.0)])
STARS = StarField.of(RAYS / np.linalg.norm(RAYS, axis=1)[:, None], IMAGE, 76.0)
AXES = ImageAxes(focal_mm=76.0)
PX = ImageAxes(focal_px=76.0, centre_px=(1000.0, 500.0), y_down=True)


def lens_of(**more: Any) -> Calibration:
    """What a calibration came to: 1, 2, 3, 4, 5, 6, 7 are the deviations, 9 corrections."""
    given: dict[str, Any] = {
        "failure": Failure.NONE, "matrix": np.eye(3), "lens": LensOfStars(80.0, 0.5, 0.25, 0.001),
        "free": ("focal", "centre_x", "centre_y", "k1"), "growth": 2.0, "variance": 0.04,
        "covariance": np.diag([1e-6, 4e-6, 9e-6, 16e-4, 25e-4, 36e-4, 49e-6]), "freedom": 9,
        "iterations": 9,
    } | more  # fmt: skip
    return Calibration(**given)


def solve(
    monkeypatch: pytest.MonkeyPatch, found: Calibration, free: tuple[str, ...], *,
    unit: str = "mm", used: Any = EVERYONE, sigma: float | None = None,
) -> tuple[SolvedCalibration, list[Any]]:  # fmt: skip
    given: list[Any] = []

    def calibrate(stars: StarField, unknowns: tuple[str, ...]) -> Calibration:
        given.extend([stars.used.shape[-1], unknowns])
        return found

    monkeypatch.setattr(solved_calibration, "calibrate_from_both_starts", calibrate)
    axes = AXES if unit == "mm" else PX
    return solve_calibration(star_file(unit), STARS, used, free, axes, sigma), given


ALL = ("k1", "centre", "focal")


@pytest.mark.parametrize("sigma", [None, 0.5])
def test_a_camera_in_millimetres(monkeypatch: pytest.MonkeyPatch, sigma: float | None) -> None:
    """Unknowns in their own order; deviations times the reading sigma, .2 by the residuals."""
    used = np.array([0, 2, 3, 4, 5, 6])
    found, given = solve(monkeypatch, lens_of(), ALL, used=used, sigma=sigma)
    one, size = found.solved, sigma or 0.2
    assert given == [6, ("focal", "centre_x", "centre_y", "k1")]
    assert (one.method, one.stars, one.iterations) == ("collinearity", (1, 3, 4, 5, 6, 7), 9)
    assert one.converged and one.failure == Failure.NONE
    assert one.camera == {"focal": 80.0, "centre_x": 0.5, "centre_y": 0.25, "k1": 0.001}
    assert list(one.camera) == ["focal", "centre_x", "centre_y", "k1"]
    assert one.camera_sigmas is not None and one.rotation_sigma_arcsec is not None
    deviations = np.array([0.04, 0.05, 0.06, 0.007]) * size
    assert_close("rae element", list(one.camera_sigmas.values()), deviations)
    turns = np.degrees(np.array([1e-3, 2e-3, 3e-3]) * size) * 3600.0
    assert_close("rae angle", one.rotation_sigma_arcsec, turns)
    assert_close("rae element", one.reading_sigma, size)  # type: ignore[arg-type]
    assert one.reading_freedom == (9 if sigma is None else None)
    assert found.findings == []
    assert_close("rae element", found.stars.focal_length_mm, [80.0])
    assert_close("rae element", found.stars.directions, STARS.directions)
    inner = found.stars.image_mm
    r2 = (inner**2).sum(axis=1, keepdims=True) / 80.0**2
    assert_close("flight pixel", [0.5, 0.25] + inner * (1.0 + 0.001 * r2), IMAGE)


def test_a_camera_in_millimetres_with_y_down(monkeypatch: pytest.MonkeyPatch) -> None:
    """The principal point is that of the file; all digits are there."""
    lens = LensOfStars(80.123456789, 0.512345678, 0.212345678, 0.00123456789)
    monkeypatch.setattr(
        solved_calibration, "calibrate_from_both_starts", lambda *_: lens_of(lens=lens)
    )
    axes = ImageAxes(focal_mm=76.0, y_down=True)
    found = solve_calibration(star_file(), STARS, EVERYONE, ALL, axes, None)
    assert found.solved.camera == {
        "focal": 80.123456789, "centre_x": 0.512345678, "centre_y": -0.212345678,
        "k1": 0.00123456789,
    }  # fmt: skip


def test_a_camera_in_pixels(monkeypatch: pytest.MonkeyPatch) -> None:
    """The principal point is that of the file, y down."""
    found, given = solve(monkeypatch, lens_of(), ALL, unit="px")
    assert given[0] == 8
    assert found.solved.camera == {
        "focal": 80.0, "centre_x": 1000.5, "centre_y": 499.75, "k1": 0.001
    }  # fmt: skip


NEEDED = [
    (("focal",), 3), (("centre",), 3), (("k1",), 3), (("focal", "k1"), 3), (("focal", "centre"), 4),
    (("k1", "focal", "centre"), 4),
]  # fmt: skip


@pytest.mark.parametrize(("free", "needed"), NEEDED)
def test_stars_that_a_camera_takes(
    monkeypatch: pytest.MonkeyPatch, free: tuple[str, ...], needed: int
) -> None:
    """Of those that are used, whatever others the file has."""
    count = {"focal": 1, "centre": 2, "k1": 1}
    unknowns = 3 + sum(count[one] for one in free)
    found = lens_of(covariance=np.eye(unknowns) * 1e-6)
    assert solve(monkeypatch, found, free, used=np.arange(needed))[0].findings == []
    with pytest.raises(InputError) as caught:
        solve(monkeypatch, found, free, used=np.arange(needed - 1))
    assert str(caught.value) == f"a.csv: --free {','.join(free)} takes {needed} stars at least"


NO_CAMERA = {
    Failure.SINGULAR: "the stars do not determine it",
    Failure.NO_CONVERGENCE: "no convergence",
    Failure.BEHIND_CAMERA: "a star lies behind the camera in the solution",
}


@pytest.mark.parametrize("failure", NO_CAMERA)
def test_a_camera_that_is_not_found(monkeypatch: pytest.MonkeyPatch, failure: Failure) -> None:
    with pytest.raises(InputError) as caught:
        solve(monkeypatch, lens_of(failure=failure), ("focal", "k1"))
    assert str(caught.value) == f"a.csv: --free focal,k1: {NO_CAMERA[failure]}"


def test_a_lens_that_cannot_be_inverted(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError) as caught:
        solve(monkeypatch, lens_of(lens=LensOfStars(10.0, k1=-0.3)), ("k1", "focal"))
    said = "a.csv: --free k1,focal: the lens that fits best cannot be inverted"
    assert str(caught.value) == said


def deviations(**sigmas: float) -> np.ndarray:
    """The covariance for a reading sigma of .2 and these deviations."""
    names = ("focal", "centre_x", "centre_y", "k1")
    return np.diag([1e-8] * 3 + [(sigmas.get(name, 0.0) / 0.2) ** 2 for name in names])


HARDLY = (
    "the stars can hardly tell {} from a turn of the camera: the standard deviation of the "
    "attitude is {} times as large as with a known camera"
)
HOLD = "the stars do not hold {}: its standard deviation is {}"
DOUBTS: list[tuple[dict[str, Any], list[str]]] = [
    ({"growth": 10.0}, []),
    ({"growth": 10.6}, [HARDLY.format("focal, centre_x, centre_y and k1", "11")]),
    ({"growth": 123.4, "free": ("focal",)}, [HARDLY.format("focal", "123")]),
    ({"growth": 11.0, "free": ("focal", "k1")}, [HARDLY.format("focal and k1", "11")]),
    ({"covariance": deviations(focal=0.799, centre_x=0.799, centre_y=0.799, k1=0.00999)}, []),
    ({"covariance": deviations(focal=0.80123)}, [HOLD.format("focal", "0.801 px")]),
    ({"covariance": deviations(centre_x=0.80123)}, [HOLD.format("centre_x", "0.801 px")]),
    ({"covariance": deviations(centre_y=12.3456, k1=0.0101234)},
     [HOLD.format("centre_y", "12.3 px"), HOLD.format("k1", "0.0101")]),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "said"), DOUBTS)
def test_cameras_that_the_stars_do_not_hold(
    monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any], said: list[str]
) -> None:
    """A growth of 10, and a hundredth of the principal distance, are the limits."""
    found, _ = solve(monkeypatch, lens_of(**changes), ALL, unit="px")
    assert [str(one.finding) for one in found.findings] == [f"a.csv: {text}" for text in said]
    assert [one.kind for one in found.findings] == [f"calibration {k}" for k in range(len(said))]
    assert {one.finding.severity for one in found.findings} <= {"warning"}


@pytest.mark.parametrize("stated", [None, 0.25])
def test_what_the_readings_do_not_determine(
    monkeypatch: pytest.MonkeyPatch, stated: float | None
) -> None:
    """An attitude known to 20 degrees is refused, however the reading sigma is known."""
    camera, _ = solve(monkeypatch, lens_of(covariance=4.0 * np.eye(7)), ALL, sigma=stated)
    assert camera.solved.failure == Failure.TOO_UNCERTAIN
