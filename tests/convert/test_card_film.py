"""A flight's picks on a film reader: its steps, the centre, where points are, and what is noted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.flight_project import LENS, local_to_camera, three_frames, truth_deg
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.convert.flight_to_deck import CardFilm, card_film
from vopd.flight.flight import Flight, Refraction
from vopd.flight.solve import SolvedFlight, solve
from vopd.geometry.lenses import Lens, LensKind, project

CENTRE = np.array([950.0, 530.0])
MOVED, PICK = "picks are up to ", 5


@pytest.fixture(scope="module")
def solved() -> SolvedFlight:
    return solve(three_frames())


def film(solved: SolvedFlight, lens: Lens) -> CardFilm:
    return card_film(replace(solved.flight, lens=lens), solved)


@pytest.mark.parametrize(
    ("size", "inches"),
    [
        ((494, 9), 0.02), ((9, 494), 0.02), ((496, 9), 0.01), ((9, 496), 0.01), ((989, 9), 0.01),
        ((991, 9), 0.005), ((1920, 1080), 0.005), ((1980, 9), 0.005), ((1981, 9), 0.002),
        ((4950, 9), 0.002), ((4951, 9), 0.001), ((9899, 9), 0.001), ((9901, 9), 0.0005),
        ((19799, 9), 0.0005), ((19801, 9), 0.0002), ((49499, 9), 0.0002), ((49501, 9), 0.0001),
        ((500_000, 9), 0.0001),
    ],
)  # fmt: skip
def test_a_pixel_is_the_largest_step_that_keeps_the_image_below_9_9_inches(
    size: tuple[int, int], inches: float, solved: SolvedFlight
) -> None:
    found = film(solved, replace(LENS, size_px=size))
    assert found.inches_per_px == inches
    assert_close("ratio", found.focal_length_mm, 1495.0 * inches * 0.713816400205)


def test_the_centre_is_to_a_hundredth_of_an_inch(solved: SolvedFlight) -> None:
    """Of 4.8025 and 2.7075, half of the image."""
    found = film(solved, replace(LENS, size_px=(1921, 1083))).centre_in
    assert_close("film length", found, [4.8, 2.71])


def of_lens(lens: Lens, refraction: Refraction) -> Flight:
    """The flight as this lens shows it at the truth."""
    base = replace(three_frames(), refraction=refraction)
    lines = solve(base).lines.direction
    turn = np.array([local_to_camera(angles) for angles in truth_deg()])[base.picks.frame]
    pixel = project(lens, np.einsum("pij,pj->pi", turn, lines)).pixel
    return replace(base, lens=lens, picks=replace(base.picks, pixel=pixel))


def test_points_of_a_pinhole_are_its_pixels_to_the_left_and_up() -> None:
    focal = np.array([1500.0, 1500.0])
    lens = Lens(LensKind.BROWN, (1920, 1080), focal, CENTRE, np.zeros(12))
    flight = of_lens(lens, Refraction(0.0))
    found = card_film(flight, solve(flight))
    expected = np.array([4.8, 2.7]) - (flight.picks.pixel - CENTRE) * 0.005
    assert_close("five decimals", found.point_in[4:], expected[4:])
    assert np.isnan(found.point_in[:4]).all()  # the first frame has no attitude
    assert found.notes == () and not found.distortion_um.any()
    assert found.radius_mm.shape == found.distortion_um.shape == (25,)


def test_points_of_a_radial_lens_are_where_its_table_has_them() -> None:
    """The table takes each to its ideal place, of which 1 + k1 r2 is the image."""
    k = np.zeros(12)
    k[0] = -0.1
    lens = Lens(LensKind.BROWN, (1920, 1080), np.array([1500.0, 1500.0]), CENTRE, k)
    flight = of_lens(lens, Refraction(0.0))
    found = card_film(flight, solve(flight))
    pinhole = of_lens(replace(lens, k=np.zeros(12)), Refraction(0.0))
    mm = 0.005 * 0.713816400205
    ideal = np.hypot(*(pinhole.picks.pixel - CENTRE)[4:].T) * mm
    measured = np.hypot(*(found.point_in - found.centre_in)[4:].T) / 0.005 * mm
    added = np.interp(measured, found.radius_mm, found.distortion_um) / 1000.0
    assert_close("five decimals", measured + added, ideal)
    assert (found.distortion_um[1:] > 0.0).all() and found.notes == ()


def moved(solved: SolvedFlight, off_px: Floats) -> float:
    """How far the same gradient puts a pick from where the lens shows it, pixels.

    With D the derivative of pixels by the plane: D' r / f2 and not the inverse of D by r.
    """
    flight, step = solved.flight, 1e-5
    ray = solved.attitudes.rotation[flight.picks.frame[PICK]] @ solved.lines.direction[PICK]
    ray = ray / ray[2]
    columns = [
        (project(LENS, ray + way).pixel - project(LENS, ray - way).pixel) / (2 * step)
        for way in step * np.eye(3)[:2]
    ]
    by_plane, focal = np.stack(columns, axis=1), 1495.0
    apart = np.linalg.solve(by_plane, off_px) - by_plane.T @ off_px / focal**2
    return float(np.linalg.norm(apart) * focal)


@pytest.mark.parametrize(("wanted", "noted"), [(0.0045, False), (0.0055, True), (0.0123, True)])
def test_picks_that_are_moved_by_more_than_five_thousandths_are_noted(
    wanted: float, noted: bool, solved: SolvedFlight
) -> None:
    """And so is a lens that is not radial."""
    way = np.array([0.6, -0.8])
    pixel = solved.flight.picks.pixel.copy()
    pixel[PICK] += way * (wanted / moved(solved, way))
    flight = replace(solved.flight, picks=replace(solved.flight.picks, pixel=pixel))
    first, *more = card_film(flight, replace(solved, flight=flight)).notes
    assert first == (
        "the lens is not radial: its distortion is taken off the picks, and group 1 has none"
    )
    said = (
        f"{MOVED}{wanted:.2g} px from where the lens shows them, so that the 1974 solve, which "
        "weighs them without the lens, has the flight's solution"
    )
    assert more == [said] * noted


def test_refraction_is_taken_off_the_points() -> None:
    """By so much that it is seen: k = 1 raises lines by 5E-5, .07 px."""
    lens = Lens(LensKind.BROWN, (1920, 1080), np.array([1500.0, 1500.0]), CENTRE, np.zeros(12))
    bent, straight = (of_lens(lens, Refraction(k, False)) for k in (1.0, 0.0))
    found = card_film(bent, solve(bent))
    plain = card_film(straight, solve(straight))
    raised = np.abs(bent.picks.pixel - straight.picks.pixel)[4:, 1] * 0.005
    assert raised.min() > 1e-4
    assert_close("pick by readings", found.point_in * 10, plain.point_in * 10)
