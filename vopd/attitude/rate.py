"""How fast the vehicle turns, by the attitudes of frames that were solved together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.attitude.mean import by_turns_of, covariances_of_sums, middle_of, with_attitude
from vopd.attitude.table import BODY_AXES
from vopd.attitude.uncertainty import student_factor, total_freedom
from vopd.estimate import About
from vopd.findings import VopdError, size_text
from vopd.geometry.linear import covariance_factor_95
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
        from vopd.attitude.summary import decimals_for

        few = decimals_for(self.half_width_95, 2)
        each = zip(BODY_AXES, self.rate_deg_s, self.half_width_95, strict=True)
        turns = [f"{axis} {rate:.{few}f} +- {half:.{few}f}" for axis, rate, half in each]
        return (
            f"{self.about.label}: {self.frames} frames about {self.time_s:.3f} s turn by degrees a "
            f"second about {', '.join(turns)} (95 %); they are {size_text(self.residual_deg)} "
            "degree off a steady turn, rms"
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
    if history.sum_errors is None:
        raise VopdError(
            f"{history.about.label}: no turning rate: the frames of a deck are solved each by "
            "itself, and what their errors have in common is not known; vopd new DIR --deck makes "
            "a flight project of it"
        )
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
    found = covariances_of_sums(history, middle.some, by_frames)
    covariance = sum(found.values(), np.zeros((3, 3)))
    components = {name: np.sqrt(np.maximum(np.diag(one), 0.0)) for name, one in found.items()}
    total, reading = np.sqrt(np.diag(covariance)), history.uncertainty.reading
    freedom = total_freedom(reading.freedom, total**2, components["reading"] ** 2)
    return TurningRate(
        history.about,
        int(middle.some.sum()),
        float(time_s.mean()),
        np.degrees(rate),
        total,
        total * student_factor(freedom),
        components,
        covariance,
        float(covariance_factor_95(freedom.min())),
        float(np.degrees(np.sqrt(((middle.away - away_s[:, None] * rate) ** 2).mean()))),
    )
