"""A job's attitude history: its estimate, its uncertainty, and the flags of doubtful frames."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.flags import Flags, fits_as_well, flags, jumps
from vopd.attitude.geometry import LandmarkGeometry, landmark_geometry, second_solution_rms
from vopd.attitude.mistakes import MOST_FRAMES, misfit_text
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import AS_SIGMAS, Sigmas
from vopd.attitude.uncertainty import Uncertainty, uncertainties
from vopd.attitude.vertical import with_vertical
from vopd.estimate import About, Block, Estimate, FrameEstimate, FrameStatus
from vopd.findings import VopdError, refuse_other_kind
from vopd.geometry.rotations import from_yaw_pitch_roll
from vopd.records import Rows, alike_together

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from vopd.attitude.mean import MeanAttitude
    from vopd.attitude.rate import Turn, TurningRate

ROUNDING_RAD = 1e-10
"""Corrections below this one, 2e-5 arc seconds, are rounding, which differs from one processor to
another; a frame has converged at 1e-6."""

SumErrors = Callable[[Floats], Mapping[str, Floats]]
"""Covariances, by component, of k sums over the frames of a job, radians squared, (k, k).

It is given the weights (F, 3, k) of a small turn of the vehicle in each frame about its forward,
right and down axes.
"""


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

    def __post_init__(self) -> None:
        refuse_other_kind(self.sigmas, Sigmas, "an attitude history", AS_SIGMAS)


@dataclass(frozen=True, eq=False, repr=False)
class History(Rows):
    """One job's attitude history. The frame axis comes first in every array.

    A job whose frames were computed in several blocks has an estimate without landmarks here;
    `estimates` iterates over the blocks, `frame_landmarks` lists the landmarks of any job.
    """

    estimate: FrameEstimate
    landmarks: Ints  # (F,) how many take part
    quaternion: Floats  # (F, 4) local north-east-down to vehicle body, w x y z, w >= 0
    residual_rms: Floats  # (F,) over 2N, image units
    geometry: LandmarkGeometry
    uncertainty: Uncertainty
    flags: Flags
    blocks: Callable[[], Iterator[Block]] | None = None  # None: the estimate is the only one
    sum_errors: SumErrors | None = field(default=None, repr=False, compare=False)
    """Covariances of sums over frames, if these were solved together; see `mean`."""
    typical: History | None = field(default=None, repr=False, compare=False)
    """Of a long job: one frame, the history of which says how large errors are."""

    def estimates(self) -> Iterator[Block]:
        """Iterate over the blocks of the job, with their landmarks."""
        if self.blocks is not None:
            yield from self.blocks()
        elif isinstance(self.estimate, Estimate):
            yield np.arange(len(self.estimate.frame)), self.estimate

    def mean(self, frames: ArrayLike | slice | None = None) -> MeanAttitude:
        """Average the attitude over frames, with the uncertainty of the mean.

        Args:
            frames: indices from 0 (not the numbers of the frames), or a boolean for each frame;
                None: all. Frames without an attitude are left out

        Raises:
            VopdError: if no frame is left, one is 90 degrees or more from the mean, or there is
                no such frame
        """
        from vopd.attitude.mean import mean_attitude

        return mean_attitude(self, frames)

    def rate(self, frames: ArrayLike | slice | None = None) -> TurningRate:
        """Fit a steady turning rate to the attitudes of frames of a flight, with its uncertainty.

        Args:
            frames: as `mean` takes them

        Raises:
            VopdError: if fewer than two frames have an attitude and different times, if one is 90
                degrees or more from their mean attitude, or of a deck
        """
        from vopd.attitude.rate import turning_rate

        return turning_rate(self, frames)

    def turn(self, before: ArrayLike | slice, after: ArrayLike | slice) -> Turn:
        """Find how far the vehicle has turned from some frames of a flight to others.

        Args:
            before: the frames from which to turn, as `mean` takes them
            after: the frames to which to turn

        Raises:
            VopdError: if no frame before, or none after, has an attitude; if one is 90 degrees or
                more from the mean of its own; or if the source is a deck
        """
        from vopd.attitude.rate import turn_between

        return turn_between(self, before, after)

    def _repr_html_(self) -> str:
        from vopd.attitude.long_history import one_part
        from vopd.attitude.summary import html

        return html([one_part(self)])

    def take(self, rows: Ints | Bools | slice) -> History:
        """Select some frames.

        Args:
            rows: their indices, or a mark for each frame
        """
        taken, of_all, count = super().take(rows), self.sum_errors, len(self.landmarks)
        if of_all is None:
            return taken

        def of_some(weight: Floats) -> Mapping[str, Floats]:
            whole = np.zeros((count, *weight.shape[1:]))
            whole[rows] = weight
            return of_all(whole)

        return replace(taken, sum_errors=of_some)

    @property
    def about(self) -> About:
        """Describe the source: file, job, title and fixes."""
        return self.estimate.about

    @property
    def has_attitude(self) -> Bools:
        """Mark frames whose vehicle angles are known (F,): not ignored, not stopped, not NaN."""
        return np.asarray(np.isfinite(self.estimate.vehicle_deg).all(axis=1))

    @property
    def status(self) -> list[str]:
        """List how each frame ended: solved, ignored, exact or stopped."""
        words = {int(one): one.name.lower() for one in FrameStatus}
        return [words[code] for code in self.estimate.status.tolist()]

    @property
    def source_name(self) -> list[str]:
        """Repeat the source's name for every frame."""
        return [self.about.source] * len(self.estimate.frame)

    @property
    def order_axis(self) -> tuple[Floats, str]:
        """Choose the horizontal axis of figures, times or frame numbers: values (F,), label."""
        if np.isfinite(self.estimate.time_s).any():
            return self.estimate.time_s, "time, s"
        return self.estimate.frame.astype(np.float64), "frame"

    @property
    def image_name(self) -> list[str]:
        """Name every frame's image; empty where there is none."""
        return self.estimate.frame_names or [""] * len(self.estimate.frame)

    @property
    def job_number(self) -> Ints:
        """Repeat the job's number for every frame (F,)."""
        return np.full(len(self.estimate.frame), self.about.job)

    @property
    def reading_sigma(self) -> Floats:
        """Repeat the reading sigma of the job for every frame (F,), image units."""
        return np.full(len(self.estimate.frame), self.uncertainty.reading.sigma)

    @property
    def reading_freedom(self) -> Floats:
        """Repeat the degrees of freedom of the reading sigma for every frame (F,)."""
        return np.full(len(self.estimate.frame), self.uncertainty.reading.freedom)

    @property
    def last_correction_rad(self) -> Floats:
        """Find the largest of the last corrections (F,); NaN where there was none.

        Below `ROUNDING_RAD` it is 0: what is left there is the rounding of the processor.
        """
        largest = np.abs(self.estimate.correction_rad).max(axis=1)
        largest = np.where(largest < ROUNDING_RAD, 0.0, largest)
        return np.asarray(np.where(self.estimate.solved, largest, np.nan))

    @property
    def flag_text(self) -> list[str]:
        """Write the flags of every frame as one text."""
        return self.flags.text()


def history(
    estimate: Estimate,
    *,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
) -> History:
    """Make the attitude history of one job.

    Args:
        estimate: the result of a solve
        sigmas: standard deviations of what the job was given
        max_rate_deg_s: frames that turn faster against a neighbour are flagged,
            degrees a second, above 0; None flags no frame

    Raises:
        VopdError: where the rate is not above 0
    """
    (made,) = histories([estimate], HistoryOptions(sigmas, max_rate_deg_s))
    return made


JOBS_TOGETHER = 4000  # frames


def histories(estimates: Sequence[Estimate], options: HistoryOptions) -> list[History]:
    """Make the attitude histories of jobs; short jobs together are faster than alone.

    Raises:
        VopdError: where the rate is not above 0, or there is no such vertical
    """
    check_rate(options.max_rate_deg_s)
    estimates = [with_vertical(one, options.vertical) for one in estimates]
    made: dict[int, History] = {}
    for indices in taken_together(estimates):
        found = histories_without_jumps([estimates[k] for k in indices], options.sigmas)
        made |= zip(indices, found, strict=True)
    for one in made.values():
        mark_jumps(one, options)
    return [made[k] for k in range(len(estimates))]


def taken_together(estimates: Sequence[Estimate]) -> Iterator[list[int]]:
    """Group jobs of one kind: indices, about `JOBS_TOGETHER` frames at a time."""
    kinds = ((_kind(one, k), len(one.frame)) for k, one in enumerate(estimates))
    return alike_together(kinds, JOBS_TOGETHER)


def _kind(one: Estimate, index: int) -> Hashable:
    """Identify the kind of a job; a flight has names and stays alone."""
    if one.landmark_names or one.frame_names or one.grid or one.gimbal_deg is not None:
        return index
    return (
        one.used.shape[1],
        one.units,
        id(one.about.words),
        one.stated,
        one.fiducial_sigma > 0.0,
        one.slip_effect_deg is None,
        one.position.vertical,
        one.position.to_own_m is None,
    )


def has_photographs(one: History) -> bool:
    """Tell whether the photograph of the first frame with an attitude is there.

    Args:
        one: of a job
    """
    e, frames = one.estimate, np.flatnonzero(one.has_attitude).tolist()
    if e.scene is None or not frames:
        return False
    return e.scene().has_photograph(*e.frame_key(frames[0]))


def is_turned(history: History) -> bool:
    """Tell whether the camera's angles are others than the vehicle's.

    Args:
        history: of a job
    """
    return are_others(history.estimate.camera_deg, history.estimate.vehicle_deg)


def are_others(camera_deg: Floats, vehicle_deg: Floats) -> bool:
    """Tell whether angles of the camera are others than those of the vehicle, in any frame.

    Args:
        camera_deg: yaw, pitch, roll, (F, 3); NaN where they are not known
        vehicle_deg: likewise
    """
    apart = np.abs((camera_deg - vehicle_deg + 180.0) % 360.0 - 180.0)
    return bool((np.nan_to_num(apart) > SAME_DEG).any())


SAME_DEG = 1e-6  # angles of camera and vehicle that are printed alike; a mount has rounded elements


def check_rate(max_rate_deg_s: float | None) -> None:
    """Refuse a maximum rate that is not above 0 degrees a second."""
    if max_rate_deg_s is None:
        return
    if not isinstance(max_rate_deg_s, Real) or isinstance(max_rate_deg_s, bool | np.bool_):
        raise VopdError(f"maximum rate: {max_rate_deg_s!r} is no number of degrees a second")
    if not max_rate_deg_s > 0.0:
        raise VopdError(f"maximum rate: {max_rate_deg_s:g} degrees a second, must be above 0")


def mark_jumps(one: History, options: HistoryOptions) -> None:
    """Flag the frames of a whole job that turn too fast."""
    rate = options.max_rate_deg_s
    one.flags.raised["jump"] = jumps(one.estimate.time_s, one.quaternion, rate)


@np.errstate(all="ignore")
def histories_without_jumps(
    jobs: Sequence[Estimate],
    sigmas: Sigmas,
    scale: JobReadingSigma | None = None,
    most_searched: int = MOST_FRAMES,
) -> list[History]:
    """Make the histories of jobs of one kind, but for the flags of frames that turn too fast.

    Args:
        jobs: the jobs, or one block of a job
        sigmas: standard deviations of the inputs
        scale: the reading sigma, where it is a block
        most_searched: frames that misfit and are searched for what explains them
    """
    e, counts = Estimate.concat(jobs), [len(one.frame) for one in jobs]
    if len(jobs) > 1:
        e = replace(e, focal_length=np.repeat([one.focal_length for one in jobs], counts))
    shape = landmark_geometry(e)
    doubt, doubts = uncertainties(jobs, e, sigmas, scale)
    reading_sigma = np.repeat([one.reading.sigma for one in doubts], counts)
    of_jobs = [
        misfit_text(one, own.reading, own.sigmas, most_searched)
        for one, own in zip(jobs, doubts, strict=True)
    ]
    text = [of_frame for of_job in of_jobs for of_frame in of_job]
    quaternion = from_yaw_pitch_roll(e.vehicle_deg)
    landmarks = np.asarray(e.used.sum(axis=1))
    squares = np.where(np.tile(e.used, 2), e.residual, 0.0) ** 2
    rms = np.sqrt(squares.sum(axis=1) / (2.0 * landmarks))
    second_rms = second_solution_rms(e, fits_as_well(rms, reading_sigma))
    raised = flags(e, shape, quaternion, rms, doubt, reading_sigma, text, second_rms)
    known = np.where(np.isfinite(e.camera_deg[:, 0]), rms, np.nan)
    made = []
    for one, own, count, end in zip(jobs, doubts, counts, np.cumsum(counts).tolist(), strict=True):
        frames = slice(end - count, end)
        arrays = landmarks[frames], quaternion[frames], known[frames]
        made.append(History(one, *arrays, shape.take(frames), own, raised.take(frames)))
    return made
