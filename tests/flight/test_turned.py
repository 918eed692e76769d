"""Images that are solved as one: the camera has turned between them, or it has not."""

from __future__ import annotations

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.project.turned import doubts_of_turn

IMAGES = ("march.jpg", "april.jpg", "may.jpg")
PLACES = {"mast": (10, 20), "well": (610, 30), "arch": (320, 240), "barn": (15, 460)}
TENTHS = np.random.default_rng(1974).integers(-9, 10, (60, 4, 2)) / 10.0


def doubts(
    moved: dict[tuple[str, str], tuple[float, float]], days: tuple[str, ...] = IMAGES
) -> list[str]:
    """Doubt picks with errors below a pixel, those of an image and a landmark moved besides."""
    names, image, pixel = [], [], []
    for k, day in enumerate(days):
        for n, (name, (u, v)) in enumerate(PLACES.items()):
            right, down = moved.get((day, name), (0.0, 0.0))
            names.append(name)
            image.append(k)
            pixel.append(TENTHS[k, n] + (u + right, v + down))
    sigma = np.ones(len(names))
    rows = PickRows(
        Names(days[k] for k in image), Names(names), np.array(pixel), sigma, "centre", None, "CSV"
    )
    return doubts_of_turn(rows, np.array(image), days)


def test_an_image_whose_picks_are_all_shifted_is_told() -> None:
    """By 9 to the left and 12 down, 15 px, of which the mean of three images takes a third."""
    told = doubts({("april.jpg", name): (-9.0, 12.0) for name in PLACES})
    assert_approved(told)
    assert "april.jpg" in told[0]


def test_of_many_images_the_last_are_looked_at_too() -> None:
    days = tuple(f"{k:02d}.jpg" for k in range(60))
    assert len(doubts({(day, name): (0.0, 9.0) for day in days[50:] for name in PLACES}, days)) == 1


def test_a_picture_that_is_turned_about_its_middle_is_told() -> None:
    """By .02 rad, which shifts no pick alike."""
    turned = {
        ("may.jpg", name): (-0.02 * (v - 240.0), 0.02 * (u - 320.0))
        for name, (u, v) in PLACES.items()
    }
    assert len(doubts(turned)) == 1


@pytest.mark.parametrize(
    "moved",
    [{}, {("may.jpg", "well"): (50.0, 0.0)}, {(day, "well"): (50.0, 0.0) for day in IMAGES}],
)
def test_picks_of_a_camera_that_stood_still_are_not_doubted(
    moved: dict[tuple[str, str], tuple[float, float]],
) -> None:
    """One wrong pick, or a landmark that is elsewhere in all images, is no turn."""
    assert doubts(moved) == []


def test_one_image_tells_nothing() -> None:
    names, pixel = Names(["mast", "well", "arch"]), np.eye(3)[:, :2]
    rows = PickRows(Names(["a.jpg"] * 3), names, pixel, np.ones(3), "centre", None, "CSV")
    assert doubts_of_turn(rows, np.zeros(3, int), ["a.jpg"]) == []
