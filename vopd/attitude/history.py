"""A job's attitude history: its estimate, its uncertainty, and the flags of doubtful frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.flags import Flags, fits_as_well, flags, jumps
from vopd.attitude.geometry import LandmarkGeometry, landmark_geometry, second_solution_rms
from vopd.attitude.joined_estimates import JoinedEstimates, joined_estimates, taken_together
from vopd.attitude.mistakes import MOST_FRAMES, misfit_text
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import Uncertainty, uncertainties
from vopd.estimate import About, Estimate, FrameStatus
from vopd.findings import VopdError
from vopd.geometry.rotations import from_yaw_pitch_roll


@dataclass(frozen=True)
class HistoryOptions:
    """Options of an attitude history.

    Args:
        sigmas: standard deviations of the inputs
        max_rate_deg_s: frames that turn faster against a neighbour are flagged,
            degrees a second, above 0; None flags no frame
        vertical: "geodetic" or "geocentric" axes for angles and quaternion; None keeps
            those of the solve
    """

    sigmas: Sigmas = Sigmas()  # noqa: RUF009  it is frozen
    max_rate_deg_s: float | None = None
    vertical: str | None = None


@dataclass(frozen=True, eq=False)
class History:
    """One job's attitude history. The frame axis comes first in every array."""

    estimate: Estimate
    quaternion: Floats  # (F, 4) local north-east-down to vehicle body, w x y z, w >= 0
    residual_rms: Floats  # (F,) over 2N, image units
    geometry: LandmarkGeometry
    uncertainty: Uncertainty
    flags: Flags

    @property
    def about(self) -> About:
        """What the history is about: source, job, title and fixes."""
        return self.estimate.about

    @property
    def has_attitude(self) -> Bools:
        """Frames whose vehicle angles are known (F,): not ignored, not stopped, not NaN."""
        return np.asarray(np.isfinite(self.estimate.vehicle_deg).all(axis=1))

    @property
    def status(self) -> list[str]:
        """How each frame ended: solved, ignored, exact or stopped."""
        words = {int(one): one.name.lower() for one in FrameStatus}
        return [words[code] for code in self.estimate.status.tolist()]

    @property
    def source_name(self) -> list[str]:
        """The source's name, for every frame."""
        return [self.about.source] * len(self.estimate.frame)

    @property
    def order_axis(self) -> tuple[Floats, str]:
        """Values (F,) and label of the horizontal axis of figures: times, or frame numbers."""
        if np.isfinite(self.estimate.time_s).any():
            return self.estimate.time_s, "time, s"
        return self.estimate.frame.astype(np.float64), "frame"

    @property
    def image_name(self) -> list[str]:
        """The name of every frame's image; empty where there is none."""
        return list(self.estimate.frame_names) or [""] * len(self.estimate.frame)

    @property
    def job_number(self) -> Ints:
        """The job's number, for every frame (F,)."""
        return np.full(len(self.estimate.frame), self.about.job)

    @property
    def reading_sigma(self) -> Floats:
        """The reading sigma of the job, for every frame (F,), image units."""
        return np.full(len(self.estimate.frame), self.uncertainty.reading.sigma)

    @property
    def reading_freedom(self) -> Floats:
        """Degrees of freedom of the reading sigma, for every frame (F,)."""
        return np.full(len(self.estimate.frame), self.uncertainty.reading.freedom)

    @property
    def landmarks(self) -> Ints:
        """How many landmarks take part (F,)."""
        return np.asarray(self.estimate.used.sum(axis=1))

    @property
    def last_correction_rad(self) -> Floats:
        """The largest of the last corrections (F,); NaN where there was none."""
        largest = np.abs(self.estimate.correction_rad).max(axis=1)
        return np.asarray(np.where(self.estimate.solved, largest, np.nan))

    @property
    def flag_text(self) -> list[str]:
        """The flags of every frame as one text."""
        return self.flags.text()


def history(
    estimate: Estimate,
    *,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
    scale: JobReadingSigma | None = None,
    most_searched: int = MOST_FRAMES,
) -> History:
    """Make the attitude history of one job.

    Args:
        estimate: the result of a solve
        sigmas: standard deviations of what the job was given
        max_rate_deg_s: frames that turn faster against a neighbour are flagged,
            degrees a second, above 0; None flags no frame
        scale: the reading sigma, where the estimate is a block of a job
        most_searched: frames that misfit and are searched for what explains them

    Raises:
        VopdError: where the rate is not above 0
    """
    (made,) = histories(
        [estimate],
        sigmas=sigmas,
        max_rate_deg_s=max_rate_deg_s,
        scale=scale,
        most_searched=most_searched,
    )
    return made


def histories(
    estimates: Sequence[Estimate],
    *,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
    scale: JobReadingSigma | None = None,
    most_searched: int = MOST_FRAMES,
) -> list[History]:
    """Make the attitude histories of jobs; short jobs together are faster than alone.

    Args:
        estimates: the results of solves
        sigmas: as `history` takes it
        max_rate_deg_s: as `history` takes it
        scale: as `history` takes it
        most_searched: as `history` takes it

    Raises:
        VopdError: where the rate is not above 0
    """
    check_rate(max_rate_deg_s)
    made: dict[int, History] = {}
    for indices in taken_together(estimates):
        some = joined_estimates([estimates[k] for k in indices])
        found = _histories(some, sigmas, max_rate_deg_s, scale, most_searched)
        made |= zip(indices, found, strict=True)
    return [made[k] for k in range(len(estimates))]


def check_rate(max_rate_deg_s: float | None) -> None:
    """Refuse a maximum rate that is not above 0 degrees a second."""
    if max_rate_deg_s is not None and not max_rate_deg_s > 0.0:
        raise VopdError(f"maximum rate: {max_rate_deg_s:g} degrees a second is not above 0")


@np.errstate(all="ignore")
def _histories(
    some: JoinedEstimates,
    sigmas: Sigmas,
    max_rate_deg_s: float | None,
    scale: JobReadingSigma | None,
    most_searched: int,
) -> list[History]:
    e = some.estimate
    shape = landmark_geometry(e)
    doubts, doubt, reading = uncertainties(some, sigmas, scale)
    told = [
        misfit_text(one, own.reading, own.sigmas, most_searched)
        for one, own in zip(some.jobs, doubts, strict=True)
    ]
    text = [of_frame for of_job in told for of_frame in of_job]
    quaternion = from_yaw_pitch_roll(e.vehicle_deg)
    squares = np.where(np.tile(e.used, 2), e.residual, 0.0) ** 2
    rms = np.sqrt(squares.sum(axis=1) / (2.0 * e.used.sum(axis=1)))
    second_rms = second_solution_rms(e, fits_as_well(rms, reading))
    raised = flags(e, shape, quaternion, rms, doubt, reading, text, second_rms)
    known = np.where(np.isfinite(e.camera_deg[:, 0]), rms, np.nan)
    made = []
    for one, frames, own in zip(some.jobs, some.frames, doubts, strict=True):
        of_job = raised.of(frames)
        of_job.raised["jump"] = jumps(one.time_s, quaternion[frames], max_rate_deg_s)
        made.append(
            History(one, quaternion[frames], known[frames], shape.take(frames), own, of_job)
        )
    return made
