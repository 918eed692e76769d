"""Cameras of star files: principal point, scale and distortion by each option, and what lacks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import InputError
from vopd.stellar.files.images import ImageAxes, MissingOption, centred_images, in_file_coordinates
from vopd.stellar.files.read import PixelFormat, StarFile

IMAGE = np.array([[1010.0, 520.0], [900.0, 700.0]])


def star_file(unit: str = "px", **pixels: Any) -> StarFile:
    pixel_format = PixelFormat(**pixels)
    return StarFile(
        "a.csv", (2, 3), ("", ""), IMAGE, unit, "name", IMAGE, pixels=pixel_format
    )  # fmt: skip


SIZE, MIDDLE = (2001.0, 1001.0), {"size_px": (2001.0, 1001.0), "focal_px": 500.0}
CENTRED: list[tuple[StarFile, dict[str, Any], list[float], float]] = [
    # a file, the options, the first image from the principal point, the principal distance
    (star_file("mm"), {"focal_mm": 76.0}, [1010.0, 520.0], 76.0),
    (star_file("mm"), {"focal_mm": 76.0, "y_down": True}, [1010.0, -520.0], 76.0),
    (star_file(), MIDDLE, [10.0, 20.0], 500.0),
    (star_file(y_down=True), MIDDLE, [10.0, -20.0], 500.0),
    (star_file(y_down=True), MIDDLE | {"y_down": True}, [10.0, -20.0], 500.0),
    (star_file(), MIDDLE | {"y_down": True}, [10.0, -20.0], 500.0),
    (star_file(first_centre=0.5), MIDDLE, [9.5, 19.5], 500.0),
    (star_file(first_centre=1.0), MIDDLE, [9.0, 19.0], 500.0),
    (star_file(), MIDDLE | {"centre_px": (1000.5, 510.0)}, [9.5, 10.0], 500.0),
    (star_file(first_centre=1.0), {"centre_px": (1000.0, 500.0), "focal_px": 5.0},
     [10.0, 20.0], 5.0),
    (star_file(), {"size_px": SIZE, "focal_mm": 6.0, "pitch_um": 4.0}, [10.0, 20.0], 1500.0),
    (star_file(), MIDDLE | {"focal_mm": 6.0}, [10.0, 20.0], 500.0),
    (star_file(), MIDDLE | {"focal_mm": 6.0, "pitch_um": 4.0}, [10.0, 20.0], 500.0),
    (star_file(field_of_view_deg=90.0), {"size_px": SIZE}, [10.0, 20.0], 1000.5),
    (star_file(field_of_view_deg=60.0), {"size_px": SIZE}, [10.0, 20.0], 1000.5 * 3.0**0.5),
    (star_file(field_of_view_deg=60.0), MIDDLE, [10.0, 20.0], 500.0),
    (star_file(field_of_view_deg=60.0), {"size_px": SIZE, "focal_mm": 6.0, "pitch_um": 4.0},
     [10.0, 20.0], 1500.0),
]  # fmt: skip


@pytest.mark.parametrize(("file", "options", "first", "focal"), CENTRED)
def test_images_from_the_principal_point(
    file: StarFile, options: dict[str, Any], first: list[float], focal: float
) -> None:
    axes = ImageAxes(**options)
    points, distance = centred_images(file, axes)
    assert_close("flight pixel", points[0], first)
    assert_close("flight pixel", distance, focal)
    assert_close("flight pixel", in_file_coordinates(points[1], file, axes), IMAGE[1])


@pytest.mark.parametrize("unit", ["mm", "px"])
@pytest.mark.parametrize("down", [False, True])
def test_distortion_that_is_stated(unit: str, down: bool) -> None:
    """An image lies 1 + k1 r**2 times as far out, r the tangent of the true angle."""
    axes = ImageAxes(focal_mm=2000.0, y_down=down, k1=-0.1)
    if unit == "px":
        axes = ImageAxes(focal_px=2000.0, centre_px=(0.0, 0.0), y_down=down, k1=-0.1)
    true, _ = centred_images(star_file(unit), axes)
    r = np.hypot(*true.T) / 2000.0
    sign = np.array([1.0, -1.0 if down else 1.0])
    assert_close("flight pixel", true * (1.0 - 0.1 * r**2)[:, None] * sign, IMAGE)


@pytest.mark.parametrize(("focal", "line"), [(500.0, 2), (600.0, 3)])
def test_images_where_the_distortion_does_not_hold(focal: float, line: int) -> None:
    """With k1 -.2 nothing is seen beyond 2/3 sqrt(5/3) = .861 principal distances."""
    limit = 2.0 / 3.0 * (5.0 / 3.0) ** 0.5 * focal
    image = np.array([[limit * 1.01, 0.0], [limit * 1.01, 0.0]])
    image[: line - 2] *= 0.98
    file = StarFile("a.csv", (2, 3), ("", ""), image, "mm", "name", image)
    with pytest.raises(InputError) as caught:
        centred_images(file, ImageAxes(focal_mm=focal, k1=-0.2))
    said = f"a.csv: line {line}: the image lies outside the field in which --k1 holds"
    assert str(caught.value) == said


@pytest.mark.parametrize("k", [0.1, -0.05])
def test_distortion_of_a_plate_solution(k: float) -> None:
    """Radii over half the width: r (1 - k r**2) / (1 - k)."""
    file = star_file(distortion=k, y_down=True)
    points, _ = centred_images(file, ImageAxes(**MIDDLE))
    half = 1000.5
    for point, (x, y) in zip(points, ((10.0, 20.0), (-100.0, 200.0)), strict=True):
        r = (x * x + y * y) ** 0.5 / half
        scale = (1.0 - k * r * r) / (1.0 - k)
        assert_close("flight pixel", point, [x * scale, -y * scale])


MIDDLE_POINT = {"centre_px": (1.0, 1.0)}
LACKS: list[tuple[StarFile, dict[str, Any], str]] = [
    (star_file("mm"), {}, "--focal MM is needed"),
    (star_file(), {"focal_px": 5.0}, "the file has pixels: --centre X,Y or --size W,H is needed"),
    (star_file(), MIDDLE_POINT, "the file has pixels: --focal-px, or --focal with --pitch-um, is "
     "needed"),
    (star_file(), {"focal_mm": 5.0} | MIDDLE_POINT, "the file has pixels: with --focal give "
     "--pitch-um, or --focal-px"),
    (star_file(field_of_view_deg=9.0), MIDDLE_POINT, "the plate solution needs --size W,H"),
    (star_file(distortion=0.1), {"focal_px": 5.0} | MIDDLE_POINT, "the plate solution needs "
     "--size W,H"),
]  # fmt: skip


@pytest.mark.parametrize(("file", "options", "said"), LACKS)
def test_options_that_lack(file: StarFile, options: dict[str, Any], said: str) -> None:
    with pytest.raises(MissingOption) as caught:
        centred_images(file, ImageAxes(**options))
    assert str(caught.value) == f"a.csv: {said}"


@pytest.mark.parametrize("name", ["focal_px", "pitch_um", "centre_px", "size_px"])
def test_options_for_pixels(name: str) -> None:
    value = (5.0, 6.0) if name in ("centre_px", "size_px") else 5.0
    with pytest.raises(InputError) as caught:
        centred_images(star_file("mm"), ImageAxes(focal_mm=76.0, **{name: value}))  # type: ignore[arg-type]
    said = "--focal-px, --pitch-um, --centre, --size are for pixels; the file has mm"
    assert str(caught.value) == f"a.csv: {said}"


ADVICE = [
    ("px", None, "1234.57 px: --focal-px 1234.57"),
    ("px", 5.0, "6.173 mm: --focal 6.173"),
    ("mm", None, "1235 mm: --focal 1235"),
    ("mm", 5.0, "1235 mm: --focal 1235"),
]


@pytest.mark.parametrize(("unit", "pitch", "said"), ADVICE)
def test_a_principal_distance_in_words(unit: str, pitch: float | None, said: str) -> None:
    assert ImageAxes(pitch_um=pitch).focal_advice(1234.56789, unit) == said
