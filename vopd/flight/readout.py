"""Rolling shutter: picks of rows that are read one after the other, as at the frame's time."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.flight.flight import Flight
from vopd.geometry.earth import NED_FROM_ENU
from vopd.geometry.lenses import project, ray_of_pixel
from vopd.geometry.rotations import rotation_matrices

if TYPE_CHECKING:
    from vopd.flight.solve import SolvedFlight

NEAR_FRAMES = 3.0  # frame intervals: a frame farther away does not say how the camera turns
NEAR_S = 0.5  # nor does one farther away than this, whatever the interval of the frames
BESIDE = 8  # frames on each side that say how a tracked flight turns; fewer do not follow shake
EVEN = 0.02  # of their interval that the times of such frames may be off


def row_parts(flight: Flight) -> Floats:
    """Find when each pick's row is read after its frame's time, in readout times, (P,)."""
    shutter, pixel = flight.shutter, flight.picks.pixel
    assert shutter is not None
    if flight.picks.part is not None:
        return flight.picks.part
    axis = int(shutter.way in ("down", "up"))
    size_px = flight.lens.of(flight.picks.frame).by_rows("size_px")
    part = pixel[:, axis] / (size_px[..., axis] - 1.0)
    if shutter.way in ("up", "left"):
        part = 1.0 - part
    return np.asarray(part - 0.5 if shutter.middle else part)


@np.errstate(all="ignore")
def turning_rates(flight: Flight, rotation: Floats) -> tuple[Floats, Floats | None]:
    """Estimate how fast the camera turns in each frame, by the nearest frames on both sides.

    A frame that has a neighbour on one side alone, as the first has, takes the turn from it. The
    frames of a tracked flight are many and their attitudes good: the polynomial through up to
    `BESIDE` frames on each side follows shake, and says how the rate changes, too.

    Args:
        flight: the flight
        rotation: solved, from local axes to camera axes, (F, 3, 3)

    Returns:
        Radians a second about the camera's right, down, forward, (F, 3), NaN where no frame with
        an attitude is near enough; and the same a second of a tracked flight, (F, 3), else None.
    """
    known = np.flatnonzero(np.isfinite(rotation[:, 0, 0]) & np.isfinite(flight.time_s))
    known = known[np.argsort(flight.time_s[known], kind="stable")]
    rates = np.full((len(rotation), 3), np.nan)
    changes = None if flight.picks.clicks is None else np.zeros((len(rotation), 3))
    if len(known) < 2:
        return rates, changes
    time_s = flight.time_s[known]
    apart = np.diff(time_s)
    near = (apart > 0.0) & (apart <= min(NEAR_FRAMES * _interval_s(flight, known, apart), NEAR_S))
    at = np.arange(len(known))
    before = np.where(np.append(False, near), at - 1, at)
    after = np.where(np.append(near, False), at + 1, at)
    turn = rotation[known[after]] @ rotation[known[before]].swapaxes(1, 2)
    rates[known] = _rotation_vectors(turn) / (time_s[after] - time_s[before])[:, None]
    if changes is None or not near.any():
        return rates, changes
    step_s = float(np.median(apart[near]))
    beside = _even_on_both_sides(near & (np.abs(apart - step_s) < EVEN * step_s))
    for most in range(1, BESIDE + 1):
        rows, offset = np.flatnonzero(beside == most), np.arange(-most, most + 1)
        of = np.linalg.inv(np.vander(offset.astype(float), increasing=True))
        beside_them = known[rows[:, None] + offset].ravel()
        turn = rotation[beside_them] @ rotation[np.repeat(known[rows], len(offset))].swapaxes(1, 2)
        vectors = _rotation_vectors(turn).reshape(len(rows), len(offset), 3)
        rates[known[rows]] = np.einsum("b,fbi->fi", of[1] / step_s, vectors)
        changes[known[rows]] = np.einsum("b,fbi->fi", 2.0 * of[2] / step_s**2, vectors)
    return rates, changes


def _even_on_both_sides(even: Bools) -> Ints:
    """Count frames that follow evenly on both sides of each, `BESIDE` at most, (F,).

    Args:
        even: whether the next frame follows evenly, (F - 1,)
    """
    before, after = np.zeros((2, len(even) + 1), np.int64)
    for _ in range(BESIDE):
        before[1:] = np.where(even, before[:-1] + 1, 0)
        after[:-1] = np.where(even, after[1:] + 1, 0)
    return np.minimum(np.minimum(before, after), BESIDE)


def _interval_s(flight: Flight, known: Ints, apart: Floats) -> float:
    """Find the time between frames: from number to number, or the usual one of named images."""
    if flight.image_name:
        return float(np.median(apart))
    numbers = np.diff(flight.frame[known])
    return float(np.median(apart[numbers > 0] / numbers[numbers > 0]))


def _rotation_vectors(matrices: Floats) -> Floats:
    """Convert rotations of less than half a turn to vectors, axis times angle, (B, 3)."""
    out = np.stack([matrices[:, 2, 1], matrices[:, 0, 2], matrices[:, 1, 0]], axis=1)
    out -= np.stack([matrices[:, 1, 2], matrices[:, 2, 0], matrices[:, 0, 1]], axis=1)
    sine = np.linalg.norm(out, axis=1) / 2.0
    angle = np.arctan2(sine, (np.trace(matrices, axis1=1, axis2=2) - 1.0) / 2.0)
    return np.asarray(out / 2.0 * np.where(sine > 0.0, angle / sine, 1.0)[:, None])


@np.errstate(all="ignore")
def row_shifts_px(flight: Flight, rotation: Floats, distance_m: Floats) -> Floats:
    """Calculate how far each pick is from where it would be at its frame's time, (P, 2).

    Args:
        flight: with the picks as they were read, and turning rates; NaN counts as none
        rotation: of each frame, from local axes to camera axes, (F, 3, 3)
        distance_m: of each pick's landmark, (P,)
    """
    picks, path, part = flight.picks, flight.path, row_parts(flight)
    assert flight.shutter is not None and path.turning_rad_s is not None
    late_s = (part * flight.shutter.readout_s)[:, None]
    speed = np.zeros((len(flight.frame), 3))
    if path.velocity_m_s is not None:
        speed = np.nan_to_num(path.velocity_m_s @ NED_FROM_ENU)
    # what the camera moves, and the landmark's line at the row's time, in the frame's axes
    moved = np.einsum("pij,pj->pi", rotation[picks.frame], speed[picks.frame] * late_s)
    rates = np.nan_to_num(path.turning_rad_s)[picks.frame]
    if path.turning_rad_s2 is not None:
        rates = rates + 0.5 * path.turning_rad_s2[picks.frame] * late_s
    turn = rotation_matrices(rates * late_s)
    lens = flight.lens.of(picks.frame)
    late = np.einsum("pji,pj->pi", turn, ray_of_pixel(lens, picks.pixel))
    nearer = distance_m - (late * moved).sum(axis=1)
    ray = late * nearer[:, None] + moved
    shift = picks.pixel - project(lens, ray).pixel
    return np.where(np.isfinite(shift), shift, 0.0)


ROUNDS = 6  # of shifts and solves; two leave a 500th of what the rows' times turn a frame by
SETTLED = 3e-3  # of a pick's standard deviation: shifts that change less are left


def picks_at_frame_times(flight: Flight, solved: SolvedFlight) -> Flight:
    """Shift the picks of a flight to where they would be at their frames' times.

    The shifts are by the turning rates of a solution, so that the flight is to be solved again,
    twice, and until shifts are `SETTLED`. Picks of a frame whose turning rate is not known are
    shifted by its velocity alone.

    Args:
        flight: with a rolling shutter, and the picks as they were read
        solved: the same flight, its picks as read or shifted before
    """
    rotation = solved.attitudes.rotation
    rates, changes = turning_rates(flight, rotation)
    path = replace(solved.flight.path, turning_rad_s=rates, turning_rad_s2=changes)
    # the lens and, by the clock, the velocity may have been solved for
    now = replace(flight, lens=solved.flight.lens, path=path)
    shift = row_shifts_px(now, rotation, solved.lines.distance_m)
    part = row_parts(flight)
    picks = replace(flight.picks, pixel=flight.picks.pixel - shift, part=part)
    path = replace(flight.path, turning_rad_s=rates, turning_rad_s2=changes)
    return replace(flight, picks=picks, path=path)
