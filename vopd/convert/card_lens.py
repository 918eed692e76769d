"""The lens of a flight as the 1974 table of distortion by radius, and picks as film coordinates.

The table has 25 rows between which it is linear. A pick is put where the table takes
it to the right direction, so that nothing is lost by the table's coarseness; a lens
that is not radial has a table of zeros.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.flight.flight import Flight
from vopd.flight.solved_flight import SolvedFlight
from vopd.geometry import radial_table_lens
from vopd.geometry.image_partials import partials_by_turns
from vopd.geometry.lenses import Lens, LensKind, project, ray_of_pixel
from vopd.program.constants import factor

ROWS = 25
LARGEST_IN = 9.9  # below ten inches the reader's seven columns hold five decimals
STEPS_IN = (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002, 0.0001)
"""What a pixel is on the film reader, inches: the largest that keeps the image below 9.9."""

NOTED_PX = 0.005


class CardFilm(NamedTuple):
    """Picks on the film reader and the lens of group 1."""

    inches_per_px: float
    focal_length_mm: float
    centre_in: Floats  # (2,) the principal point
    point_in: Floats  # (P, 2) NaN where a pick has no image
    radius_mm: Floats  # (25,)
    distortion_um: Floats  # (25,)
    notes: tuple[str, ...]


@np.errstate(all="ignore")
def card_film(flight: Flight, solved: SolvedFlight) -> CardFilm:
    """The picks of a flight as they would be read from film.

    x grows to the left and y up, seen from behind the camera. Refraction, which
    the cards do not know, is taken off the picks.

    Args:
        flight: gives lens and picks
        solved: its solution, from which refraction is known
    """
    lens = flight.lens
    inches = next((s for s in STEPS_IN if s * max(lens.size_px) <= LARGEST_IN), STEPS_IN[-1])
    focal = float(lens.focal_px.mean())
    focal_mm = focal * inches * factor
    ideal = _ideal(flight, solved)
    radius, added = np.arange(float(ROWS)), np.zeros(ROWS)
    notes = []
    if is_radial(lens):
        radius, added = _rows(_table(lens, ideal), focal_mm)
    else:
        notes.append(
            "the lens is not radial: its distortion is taken off the picks, and group 1 has none"
        )
    moved = _moved_px(flight, solved, ideal)
    if moved > NOTED_PX:
        notes.append(
            f"picks are up to {moved:.2g} px from where the lens shows them, so that the 1974 "
            "solve, which weighs them without the lens, has the flight's solution"
        )
    film = ideal
    if np.any(added):
        table = np.stack([radius, radius + added / 1000.0], axis=1) / focal_mm
        film = np.stack(radial_table_lens.distort(table, *ideal.T)[0], axis=1)
    size = np.array(lens.size_px, dtype=np.float64) * inches
    centre = np.round(size / 2.0, 2)
    return CardFilm(
        inches, focal_mm, centre, centre - film * focal * inches, radius, added,
        tuple(notes),
    )  # fmt: skip


def is_radial(lens: Lens) -> bool:
    """Whether a table of distortion by radius can be this lens."""
    square = lens.focal_px[0] == lens.focal_px[1] and lens.skew_px == 0.0
    across = lens.kind is LensKind.BROWN and np.any(lens.k[[2, 3, 8, 9, 10, 11]])
    return bool(square and not across)


def _ideal(flight: Flight, solved: SolvedFlight) -> Floats:
    """Picks without distortion and refraction in the plane at unit distance, (P, 2).

    The 1974 solve makes squares of residuals least on a film without distortion, a
    flight's on the image as it was taken. A pick is put where both have the same
    gradient, and so the same solution: with D the derivative of pixels by x and y, and f
    the focal length, a residual r stands as D' r / f2 beside the landmark's image.
    """
    lens, picks = flight.lens, flight.picks
    rotation = solved.attitudes.rotation[picks.frame]
    seen = project(lens, np.einsum("pij,pj->pi", rotation, solved.lines.direction))
    straight = np.einsum("pij,pj->pi", rotation, _straight(flight, solved))
    x, y = straight[:, 0] / straight[:, 2], straight[:, 1] / straight[:, 2]
    by_turns = partials_by_turns(x, y, np.ones_like(x))
    across = by_turns.swapaxes(1, 2)
    by_plane = seen.by_turns @ across @ np.linalg.inv(_known(by_turns @ across))
    residual = picks.pixel - seen.pixel
    moved = (by_plane.swapaxes(1, 2) @ residual[..., None])[..., 0] / lens.focal_px.mean() ** 2
    return np.asarray(np.stack([x, y], axis=1) + moved)


def _moved_px(flight: Flight, solved: SolvedFlight, ideal: Floats) -> float:
    """The farthest that a pick is from where it is without distortion and refraction."""
    lens, picks = flight.lens, flight.picks
    ray = ray_of_pixel(lens, picks.pixel)
    raised = [
        np.einsum("pij,pj->pi", solved.attitudes.rotation[picks.frame], line)
        for line in (solved.lines.direction, _straight(flight, solved))
    ]
    apparent, straight = (one[:, :2] / one[:, 2:] for one in raised)
    off = ray[:, :2] / ray[:, 2:] - (apparent - straight) - ideal
    return float(np.nanmax(np.hypot(*off.T), initial=0.0) * lens.focal_px.mean())


def _straight(flight: Flight, solved: SolvedFlight) -> Floats:
    """From the camera to the landmark of each pick, east, north, up, without refraction."""
    picks = flight.picks
    away = flight.landmarks.position_m[picks.landmark] - solved.camera_m[picks.frame]
    return np.asarray(np.einsum("pij,pj->pi", solved.lines.axes[picks.frame], away))


def _known(matrices: Floats) -> Floats:
    """Matrices (P, 2, 2) that can be inverted; NaN becomes the unit matrix."""
    finite = np.asarray(np.isfinite(matrices).all(axis=(1, 2)))
    return np.where(finite[:, None, None], matrices, np.eye(2))


def _table(lens: Lens, ideal: Floats) -> Floats:
    """Measured and ideal radius in the plane at unit distance, from the centre to the last pick."""
    if lens.kind is LensKind.RADIAL_TABLE and lens.table is not None and len(lens.table) <= ROWS:
        radius, added = lens.table.T / lens.focal_px[0]
        return np.stack([radius, radius + added], axis=1)
    farthest = float(np.nanmax(np.hypot(*ideal.T), initial=0.1)) * 1.02
    tangent = np.linspace(0.0, farthest, ROWS)
    ray = np.stack([tangent, np.zeros(ROWS), np.ones(ROWS)], axis=1)
    measured = project(lens, ray).distorted[:, 0]
    held = np.isfinite(measured)
    return np.stack([measured[held], tangent[held]], axis=1)


def _rows(table: Floats, focal_mm: float) -> tuple[Floats, Floats]:
    """Radius, mm, and distortion, micrometres, of 25 cards, to what their columns hold."""
    measured, ideal = table.T * focal_mm
    radius = np.round(measured, 6)
    added = np.round((ideal - measured) * 1000.0, 3)
    more = ROWS - len(radius)  # rows beyond the last, on the same line
    slope = (added[-1] - added[-2]) / (radius[-1] - radius[-2])
    beyond = np.round(np.arange(1, more + 1) * max(radius[-1] / 10.0, 0.1), 3)
    return (
        np.append(radius, np.round(radius[-1] + beyond, 6)),
        np.append(added, np.round(added[-1] + slope * beyond, 3)),
    )
