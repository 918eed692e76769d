"""Rolling shutter: picks of rows that are read one after the other, as at the frame's time."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import Finding
from vopd.flight.flight import Flight
from vopd.geometry.earth import NED_FROM_ENU
from vopd.geometry.lenses import project, ray_of_pixel
from vopd.geometry.rotations import rotation_matrices, rotation_vectors

if TYPE_CHECKING:
    from vopd.flight.solve.rotations import SolvedFlight

# three frame intervals and half a second, and what times are rounded by: a frame farther away than
NEAR_FRAMES, NEAR_S = 3.1, 0.51  # either does not say how the camera turns
BESIDE = 8  # frames on each side that say how a tracked flight turns; fewer do not follow shake
LONG_READOUT = 0.7  # of the time between frames: from there on shake is not seen well enough
LEAST_READOUT = 0.01  # of the same, over which rates are taken
EVEN = 0.02  # of their interval that the times of such frames may be off


def row_parts(flight: Flight) -> Floats:
    """Find when each pick's row is read after its frame's time, in readout times, (P,)."""
    picks = flight.picks
    assert flight.shutter is not None
    if picks.part is not None:
        return picks.part
    return flight.shutter.parts(picks.pixel, flight.lens.of(picks.frame).by_rows("size_px"))


@np.errstate(all="ignore")
def turning_rates(flight: Flight, rotation: Floats) -> tuple[Floats, Floats | None]:
    """Estimate how fast the camera turns in each frame, by the nearest frames on both sides.

    A frame that has a neighbour on one side alone, as the first has, takes the turn from it. The
    frames of a tracked flight are many and their attitudes good: the polynomial through up to
    `BESIDE` frames on each side follows shake, and says how the rate changes while the rows are
    read, too.

    Args:
        flight: the flight
        rotation: solved, from local axes to camera axes, (F, 3, 3)

    Returns:
        Radians a second about the camera's right, down, forward, (F, 3), NaN where no frame with
        an attitude is near enough; and the same a second of a tracked flight, (F, 3), else None.
    """
    rates, changes, _ = _rates_and_sums(flight, rotation)
    return rates, changes


Sums = tuple[Ints, Ints, Floats, Floats]
"""Sums over frames: the index of each, of the frame that is added, its weights in the rate, 1/s,
and in its change, 1/s^2."""


def _rates_and_sums(flight: Flight, rotation: Floats) -> tuple[Floats, Floats | None, Sums | None]:
    """Estimate `turning_rates`, and of a tracked flight say of which turns they are sums."""
    known = np.flatnonzero(np.isfinite(rotation[:, 0, 0]) & np.isfinite(flight.time_s))
    known = known[np.argsort(flight.time_s[known], kind="stable")]
    rates = np.full((len(rotation), 3), np.nan)
    changes = None if flight.picks.clicks is None else np.zeros((len(rotation), 3))
    if len(known) < 2:
        return rates, changes, None
    time_s = flight.time_s[known]
    apart = np.diff(time_s)
    named, rate_hz = flight.image_name, flight.frame_rate_hz
    interval_s = frame_interval_s(flight.frame, flight.time_s, named, rate_hz)
    interval_s = interval_s if np.isfinite(interval_s) else float(np.median(apart))
    near = (apart > 0.0) & (apart <= min(NEAR_FRAMES * interval_s, NEAR_S))
    at = np.arange(len(known))
    before = np.where(np.append(False, near), at - 1, at)
    after = np.where(np.append(near, False), at + 1, at)
    turn = rotation[known[after]] @ rotation[known[before]].swapaxes(1, 2)
    between_s = (time_s[after] - time_s[before])[:, None]
    rates[known] = rotation_vectors(turn) / between_s
    if changes is None or not near.any():
        return rates, changes, None
    step_s = float(np.median(apart[near]))
    several = _even_on_both_sides(near & (np.abs(apart - step_s) < EVEN * step_s))
    few = np.flatnonzero((several == 0) & (before < after))
    pair = known[np.stack([before[few], after[few]], axis=1)]
    by_pair = np.array([-1.0, 1.0]) / between_s[few]
    sums = [(known[few], pair, by_pair, np.zeros_like(by_pair))]
    for most in range(1, BESIDE + 1):
        rows, offset = np.flatnonzero(several == most), np.arange(-most, most + 1)
        beside = known[rows[:, None] + offset]
        turn = rotation[beside] @ rotation[known[rows], None].swapaxes(2, 3)
        vectors = rotation_vectors(turn.reshape(-1, 3, 3)).reshape(*beside.shape, 3)
        by_rate, by_change = _weights(offset, *_moments(flight, step_s))
        by_rate, by_change = by_rate / step_s, by_change / step_s**2
        rates[known[rows]] = np.einsum("b,fbi->fi", by_rate, vectors)
        changes[known[rows]] = np.einsum("b,fbi->fi", by_change, vectors)
        same = (np.broadcast_to(one, beside.shape) for one in (by_rate, by_change))
        sums.append((known[rows], beside, *same))
    row = np.concatenate([np.repeat(rows, beside.shape[1]) for rows, beside, _, _ in sums])
    column, by_rate, by_change = (
        np.concatenate([one[k].ravel() for one in sums]) for k in (1, 2, 3)
    )
    return rates, changes, (row, column, by_rate, by_change)


def _moments(flight: Flight, step_s: float) -> tuple[float, float]:
    """Choose the moments by whose turns rates are taken, steps after the frame's time.

    They are next to it, and in the middle and at the end of a readout that is long.
    """
    shutter = flight.shutter
    if shutter is None or shutter.readout_s < LONG_READOUT * step_s:
        return -LEAST_READOUT, LEAST_READOUT
    whole = shutter.readout_s / step_s
    return (-0.5 * whole, 0.5 * whole) if shutter.middle else (0.5 * whole, whole)


def _weights(offset: Ints, one: float, other: float) -> Floats:
    """Weigh turns of frames in the rate and its change of the one in the middle, (2, n).

    The polynomial through all of them gives the turn at two moments, and the rate and its change
    are those that turn as far by then. At the end of a long readout those of the frame's own time
    would be far off, and noise would be many times as large.

    Args:
        offset: of the frames, steps
        one: moment, steps after the frame's time
        other: the same
    """
    same = np.eye(len(offset))
    between = offset[:, None] - offset + same
    at = np.array([((one - offset + same * (1.0 - one + offset)) / between).prod(axis=1)
                   for one in (one, other)])  # fmt: skip
    at[:, offset == 0] -= 1.0  # turns are counted from that frame
    return np.asarray(np.linalg.solve([[one, one**2 / 2.0], [other, other**2 / 2.0]], at))


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


def frame_interval_s(
    frame: Ints, time_s: Floats, image: tuple[str, ...], rate_hz: float | None
) -> float:
    """Find the time between frames by their numbers; NaN of images that have none, or no times.

    Args:
        frame: numbers, (F,)
        time_s: of the frames, (F,)
        image: their names, (F,) or none
        rate_hz: by which they have times; None: these are given
    """
    if rate_hz is not None:
        return 1.0 / rate_hz
    known = np.isfinite(time_s)
    if image or known.sum() < 2:
        return np.nan
    return float(np.median(np.diff(time_s[known]) / np.diff(frame[known])))


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


@np.errstate(all="ignore")
def _rates_when_shifted(flight: Flight, solved: SolvedFlight) -> tuple[Floats, Floats | None]:
    """Estimate the rates that the attitudes have once their picks are shifted by these rates.

    Shifts by other rates than before turn each frame, by as much as it turns until its picks are
    read; and so the rates of the frames beside it are others, too. Where a readout lasts nearly
    as long as a frame, rates that left this out would swing from round to round.

    Args:
        flight: a tracked one, its picks as they were read
        solved: the same, its picks shifted by the rates of its path, or as read

    Returns:
        As `turning_rates`.
    """
    rates, changes, sums = _rates_and_sums(flight, solved.attitudes.rotation)
    if changes is None or sums is None:
        return rates, changes
    from scipy.sparse import block_diag, csr_array, identity, kron  # of few flights
    from scipy.sparse.linalg import spsolve

    assert flight.shutter is not None
    path, size = solved.flight.path, len(rates)
    late_s = row_parts(flight) * flight.shutter.readout_s
    by_rate, by_change = _turns_until_read(solved, np.stack([late_s, late_s**2 / 2.0]))
    row, column, in_rate, in_change = sums
    every, later = identity(3 * size, format="csr"), np.zeros(3 * size)
    followed, by_turns = every, []
    for weight, now, before, late in (
        (in_rate, rates, path.turning_rad_s, by_rate),
        (in_change, changes, path.turning_rad_s2, by_change),
    ):
        sum_of = csr_array((weight, (row, column)), (size, size))
        by_turns.append(kron(sum_of, identity(3)))
        lateness = block_diag(list(late), format="csr")
        followed = followed + lateness @ by_turns[-1]
        further = np.nan_to_num(now) - (0.0 if before is None else np.nan_to_num(before))
        later += lateness @ further.ravel()
    damped = followed.T @ followed + DAMPING**2 * every
    turn = spsolve(damped.tocsc(), -(followed.T @ later))
    rate, change = ((one @ turn).reshape(-1, 3) for one in by_turns)
    return rates + rate, changes + change


DAMPING = 0.03  # against turns to and fro from the first frame on, which hardly move what is read
MOST_CONDITION = 1e10  # of a frame's equations; with one landmark it has no attitude


def _turns_until_read(solved: SolvedFlight, late: Floats) -> Floats:
    """Average the lateness of picks as it turns their frames, (k, F, 3, 3).

    A turn of each pick's line by its lateness times a rate, as images see it, turns its frame by
    this matrix times the rate.

    Args:
        solved: the flight
        late: of each pick, in k powers, (k, P)
    """
    flight, frames = solved.flight, len(solved.flight.frame)
    taken = np.flatnonzero(solved.used & (solved.attitudes.weight > 0.0))
    frame = flight.picks.frame[taken]
    line = np.einsum("pij,pj->pi", solved.attitudes.rotation[frame], solved.lines.direction[taken])
    by_turns = project(flight.lens.of(frame), line).by_turns
    squares = by_turns.swapaxes(1, 2) @ by_turns * solved.attitudes.weight[taken, None, None]
    normal, own = np.zeros((frames, 3, 3)), np.zeros((len(late), frames, 3, 3))
    np.add.at(normal, frame, squares)
    for total, one in zip(own, late[:, taken], strict=True):
        np.add.at(total, frame, squares * one[:, None, None])
    known = np.linalg.cond(normal) < MOST_CONDITION
    normal[~known] = np.eye(3)
    return np.asarray(np.linalg.inv(normal) @ np.where(known[:, None, None], own, 0.0))


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
    if flight.picks.clicks is None:
        rates, changes = turning_rates(flight, rotation)
    else:
        rates, changes = _rates_when_shifted(flight, solved)
    path = replace(solved.flight.path, turning_rad_s=rates, turning_rad_s2=changes)
    # the lens and, by the clock, the velocity may have been solved for
    now = replace(flight, lens=solved.flight.lens, path=path)
    shift = row_shifts_px(now, rotation, solved.lines.distance_m)
    part = row_parts(flight)
    picks = replace(flight.picks, pixel=flight.picks.pixel - shift, part=part)
    path = replace(flight.path, turning_rad_s=rates, turning_rad_s2=changes)
    return replace(flight, picks=picks, path=path)


def part_of_interval(flight: Flight) -> float:
    """Divide the readout of a tracked flight by the time between its frames; 0 for others."""
    if flight.shutter is None or flight.picks.clicks is None:
        return 0.0
    apart = np.diff(np.unique(flight.time_s[np.isfinite(flight.time_s)]))
    return flight.shutter.readout_s / float(np.median(apart)) if len(apart) else 0.0


def readout_findings(flight: Flight) -> list[Finding]:
    """Say of a tracked flight that a long readout leaves shake out of its standard deviations."""
    part = part_of_interval(flight)
    if not part > LONG_READOUT:
        return []
    told = (
        f"[camera] readout_ms is {part:.2g} of the time between frames: how the camera shakes "
        "while a frame is read is hardly seen by the others, and the sigmas do not have it"
    )
    return [Finding(told, flight.source, severity="warning")]
