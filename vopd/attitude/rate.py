"""How far and how fast the vehicle turns, by attitudes of frames that were solved together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats
from vopd.attitude.mean import by_turns_of, covariances_of_sums, middle_of, with_attitude
from vopd.attitude.table import BODY_AXES
from vopd.attitude.uncertainty import student_factor, total_freedom
from vopd.estimate import About
from vopd.findings import VopdError, size_text
from vopd.geometry.linear import covariance_factor_95
from vopd.geometry.rotations import rotation_vectors_deg
from vopd.records import Record

if TYPE_CHECKING:
    from vopd.attitude.history import History


@dataclass(frozen=True, eq=False, repr=False)
class TurningRate(Record):
    """The steady rate that fits the attitudes of frames best, about the vehicle's axes.

    Attributes:
        about: of which job
        frames: how many it is of
        time_s: the mean of their times, for which it holds
        rate_deg_s: about forward, right and down of their mean attitude, against north, east and
            down; (3,), degrees a second
        total: standard deviations, all components together, (3,)
        half_width_95: half-widths of 95 % intervals, with Student's factor, (3,)
        components: standard deviations by component, (3,) each
        covariance_deg2_s2: (3, 3)
        covariance_factor_95: times that: the ellipsoid that contains the truth with 95 %
        residual_deg: how far the frames are turned from that rate, root mean square over the axes
    """

    about: About = field(repr=False)
    frames: int
    time_s: float
    rate_deg_s: Floats
    total: Floats
    half_width_95: Floats
    components: dict[str, Floats]
    covariance_deg2_s2: Floats
    covariance_factor_95: float
    residual_deg: float

    def __str__(self) -> str:
        turns, off = _about_axes(self.rate_deg_s, self), size_text(self.residual_deg)
        return (
            f"{self.about.label}: {self.frames} frames about {self.time_s:.3f} s turn by degrees a "
            f"second {turns} (95 %); they are {off} degree off a steady turn, rms"
        )


def turning_rate(history: History, frames: ArrayLike | slice | None = None) -> TurningRate:
    """Fit a steady turning rate to the attitudes of frames.

    The rotation vectors from their mean attitude are fitted by a line in time, with equal weights.
    Errors that turn all frames alike do not change it.

    Args:
        history: of one flight
        frames: as `mean_attitude` takes them. Frames without a time are left out, too

    Raises:
        VopdError: if fewer than two frames have an attitude and different times, if one is 90
            degrees or more from their mean attitude, or frames were solved each by itself
    """
    _refuse_deck(history, "turning rate")
    every_s = history.estimate.time_s
    timed = with_attitude(history, frames) & np.isfinite(every_s)
    if len(np.unique(every_s[timed])) < 2:
        raise VopdError(
            f"{history.about.label}: no turning rate: it takes two frames with an attitude, and "
            "times that differ"
        )
    middle = middle_of(history, timed)
    time_s = every_s[middle.some]
    away_s = time_s - time_s.mean()
    weight = away_s / (away_s**2).sum()
    by_middle, by_frame = by_turns_of(middle.away)
    middle_by_frames = np.linalg.solve(by_middle.sum(axis=0), by_frame)
    by_frames = weight[:, None, None] * by_frame
    by_frames -= np.tensordot(weight, by_middle, 1) @ middle_by_frames
    rate = weight @ middle.away
    return TurningRate(
        history.about,
        int(middle.some.sum()),
        float(time_s.mean()),
        np.degrees(rate),
        *_uncertainty(history, middle.some, by_frames),
        float(np.degrees(np.sqrt(((middle.away - away_s[:, None] * rate) ** 2).mean()))),
    )


@dataclass(frozen=True, eq=False, repr=False)
class Turn(Record):
    """The turn of the vehicle from some frames to others, about its axes.

    Attributes:
        about: of which job
        turn_deg: from the mean attitude of the first frames to that of the others, about forward,
            right and down; (3,), degrees
        total: standard deviations, all components together, (3,)
        half_width_95: half-widths of 95 % intervals, with Student's factor, (3,)
        components: standard deviations by component, (3,) each
        covariance_deg2: (3, 3)
        covariance_factor_95: times that: the ellipsoid that contains the truth with 95 %
    """

    about: About = field(repr=False)
    turn_deg: Floats
    total: Floats
    half_width_95: Floats
    components: dict[str, Floats]
    covariance_deg2: Floats
    covariance_factor_95: float

    def __str__(self) -> str:
        return f"{self.about.label}: turned by degrees {_about_axes(self.turn_deg, self)} (95 %)"


def turn_between(history: History, before: ArrayLike | slice, after: ArrayLike | slice) -> Turn:
    """Find how far the vehicle has turned from some frames to others.

    Errors that turn all frames alike do not change it.

    Args:
        history: of one flight
        before: the frames from which, as `mean_attitude` takes them
        after: those to which

    Raises:
        VopdError: if none of one of them has an attitude, one is 90 degrees or more from the
            mean of its own, or frames were solved each by itself
    """
    _refuse_deck(history, "turn")
    first, last = (middle_of(history, frames) for frames in (before, after))
    turn = rotation_vectors_deg(first.quaternion, last.quaternion)
    slopes = by_turns_of(np.radians(turn))
    weights = np.zeros((len(first.some), 3, 3))
    for way, middle, slope in zip((-1.0, 1.0), (first, last), slopes, strict=True):
        by_middle, by_frame = by_turns_of(middle.away)
        weights[middle.some] += way * slope[0] @ np.linalg.solve(by_middle.sum(axis=0), by_frame)
    some = first.some | last.some
    return Turn(history.about, turn[0], *_uncertainty(history, some, weights[some]))


def _refuse_deck(history: History, what: str) -> None:
    """Refuse frames that were solved each by itself."""
    if history.sum_errors is None:
        raise VopdError(
            f"{history.about.label}: no {what}: the frames of a deck are solved each by "
            "itself, and what their errors have in common is not known; vopd new DIR --deck makes "
            "a flight project of it"
        )


def _uncertainty(
    history: History, some: Bools, weights: Floats
) -> tuple[Floats, Floats, dict[str, Floats], Floats, float]:
    """Find the standard deviations of three sums of small turns of some frames, to the factor.

    The arguments are those of `covariances_of_sums`.
    """
    found = covariances_of_sums(history, some, weights)
    covariance = sum(found.values(), np.zeros((3, 3)))
    components = {name: np.sqrt(np.maximum(np.diag(one), 0.0)) for name, one in found.items()}
    total, reading = np.sqrt(np.diag(covariance)), history.uncertainty.reading
    freedom = total_freedom(reading.freedom, total**2, components["reading"] ** 2)
    half_width, factor = total * student_factor(freedom), covariance_factor_95(freedom.min())
    return total, half_width, components, covariance, float(factor)


def _about_axes(values: Floats, doubt: Turn | TurningRate) -> str:
    from vopd.attitude.summary import decimals_for

    few = decimals_for(doubt.half_width_95, 2)
    each = zip(BODY_AXES, values, doubt.half_width_95, strict=True)
    return f"about {', '.join(f'{axis} {v:.{few}f} +- {half:.{few}f}' for axis, v, half in each)}"
