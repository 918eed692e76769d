"""Attitude histories of long and of many short jobs, block by block."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.findings import HistorySummary, summary_of
from vopd.attitude.flags import jumps
from vopd.attitude.history import (
    History,
    HistoryOptions,
    SumErrors,
    check_rate,
    histories,
    histories_without_jumps,
    mark_jumps,
)
from vopd.attitude.mistakes import MOST_FRAMES, landmarks_of
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import outliers
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import block_reading_sigma, job_reading_sigmas
from vopd.attitude.vertical import with_vertical
from vopd.estimate import About, Block, Estimate
from vopd.geometry.rotations import from_yaw_pitch_roll
from vopd.landmark_layout import AT_ONCE, TOGETHER, LandmarkLayout

# Histories of many jobs


def histories_of_jobs(jobs: Sequence[Sequence[Block]], options: HistoryOptions) -> list[History]:
    """Make the attitude histories of many jobs; short jobs together are faster than alone.

    Args:
        jobs: the blocks of every job, which have each of its frames once
        options: sigmas, maximum rate and vertical

    Raises:
        VopdError: where the rate is not above 0, or there is no such vertical
    """
    short = [blocks[0][1] for blocks in jobs if len(blocks) == 1]
    made = iter(histories(short, options))
    return [
        next(made) if len(blocks) == 1 else _history_of_blocks(blocks, options) for blocks in jobs
    ]


def _history_of_blocks(blocks: Sequence[Block], options: HistoryOptions) -> History:
    """Make the attitude history of one job from the estimates of its blocks."""
    check_rate(options.max_rate_deg_s)
    frames = [some for some, _ in blocks]
    estimates = [with_vertical(one, options.vertical) for _, one in blocks]
    scales = job_reading_sigmas(estimates, options.sigmas)
    parts = [
        _without_landmarks(histories_without_jumps([estimate], options.sigmas, scale)[0])
        for estimate, scale in zip(estimates, scales, strict=True)
    ]
    whole = _joined(frames, parts, lambda: zip(frames, estimates, strict=True))
    mark_jumps(whole, options)
    return whole


def _joined(
    frames: Sequence[Ints], parts: Sequence[History], blocks: Callable[[], Iterator[Block]]
) -> History:
    """Join the histories of the blocks of a job, in the order of its frames."""
    return replace(History.concat(parts).take(np.argsort(np.concatenate(frames))), blocks=blocks)


def _without_landmarks(one: History) -> History:
    return replace(one, estimate=one.estimate.without_landmarks())


# Landmarks of all frames


class FrameLandmarks(NamedTuple):
    """The landmarks of all frames of a job that take part or are left out, frame after frame."""

    frame: Ints  # (N,) index of the frame
    landmark: Ints  # (N,) number
    used: Bools  # (N,) which take part
    ignored: Bools  # (N,) which the user left out
    image: Floats  # (N, 2) measured image coordinates x, y
    residual: Floats  # (N, 2) measured minus computed; NaN where it takes no part
    outlier: Bools  # (N,) which does not fit the others of its frame
    mends: Bools  # (N,) which is named alone, or with its like, as what mends a misfit

    @property
    def odd(self) -> Bools:
        """Mark those that are to be looked at (N,)."""
        return self.outlier | self.mends

    def odd_in(self, frame: int) -> list[int]:
        """List the numbers of those of a frame, by its index."""
        return [int(one) for one in self.landmark[(self.frame == frame) & self.odd]]


def frame_landmarks(one: History) -> FrameLandmarks:
    """List the landmarks of all frames, without the gaps of (F, L) arrays."""
    parts = []
    for frames, e in one.estimates():
        here = e.used | e.ignored
        outlier = outliers(e) if e.outlier is None else e.outlier
        values = e.landmark, e.used, e.ignored, e.image, e.residual_xy, outlier
        parts.append((frames[np.nonzero(here)[0]], *(value[here] for value in values)))
    joined = [np.concatenate(part) for part in zip(*parts, strict=True)]
    order = np.argsort(joined[0], kind="stable")
    frame, landmark, used, ignored, image, residual, outlier = (rows[order] for rows in joined)
    mends = _mending(one, frame, landmark)
    return FrameLandmarks(frame, landmark, used, ignored, image, residual, outlier, mends)


def _mending(one: History, frame: Ints, landmark: Ints) -> Bools:
    """Mark the landmarks that are named as what mends the misfits of their frames, (N,)."""
    mends = np.zeros(len(frame), bool)
    for k in np.flatnonzero(one.flags.raised["misfit"]).tolist():
        names = landmarks_of(one.flags.detail["misfit"][k])
        here = slice(*np.searchsorted(frame, [k, k + 1]).tolist())
        own = map(one.estimate.landmark_label, landmark[here].tolist())
        mends[here] = [name.replace(";", ",") in names for name in own]
    return mends


# History in parts


def with_about(one: History, about: About) -> History:
    """Replace the description of the source of a history."""
    return replace(one, estimate=replace(one.estimate, about=about))


class HistoryParts:
    """The attitude history of one job in parts of consecutive frames, in the order of the frames.

    A part is made during iteration, and made again in the next.

    Attributes:
        head: the history of one frame or more, for what all frames have in common
        frames: how many frames the job has
    """

    def __init__(
        self,
        head: History,
        frames: int,
        make: Callable[[], Iterator[History]],
        whole: Callable[[], History],
    ) -> None:
        self.head = head
        self.frames = frames
        self._make = make
        self._make_whole = whole
        self._whole: History | None = None
        self._summary: HistorySummary | None = None

    @property
    def about(self) -> About:
        """Describe the source: file, job, title and fixes."""
        return self.head.about

    def __iter__(self) -> Iterator[History]:
        if self._whole is not None:
            yield self._whole
            return
        summary = HistorySummary()
        for part in self._make():
            summary.add(part)
            yield part
        self._summary = summary

    @property
    def counted(self) -> bool:
        """Tell whether `summary` takes no further work."""
        return self._whole is not None or self._summary is not None

    @property
    def summary(self) -> HistorySummary:
        """Summarise the frames together; known once all parts have been made."""
        if self._summary is None:
            self._summary = summary_of(self)
        return self._summary

    @property
    def whole(self) -> History:
        """Join all frames."""
        if self._whole is None:
            self._whole = self._make_whole()
        return self._whole

    def has_attitude(self) -> bool:
        """Check whether any frame has an attitude; the parts up to that frame are made."""
        return any(part.has_attitude.any() for part in self)

    def with_about(self, about: About) -> HistoryParts:
        """Replace the description of the source."""
        return HistoryParts(
            with_about(self.head, about),
            self.frames,
            lambda: (with_about(part, about) for part in self),
            lambda: with_about(self.whole, about),
        )

    def watched(self, tell: Callable[[int], object]) -> HistoryParts:
        """Report progress: the frames of each part that is made."""

        def parts() -> Iterator[History]:
            for part in self:
                tell(len(part.estimate.frame))
                yield part

        return HistoryParts(self.head, self.frames, parts, lambda: self.whole)


def one_part(history: History) -> HistoryParts:
    """Wrap a history that is made already as its only part."""
    parts = HistoryParts(
        history, len(history.estimate.frame), lambda: iter((history,)), lambda: history
    )
    parts._whole = history
    return parts


# History of a job of any length
#
# The estimate of a block is made when it is needed. A job of more than `TOGETHER` landmarks
# has parts, which are made one after the other; whoever needs all of it at once has of each
# frame what does not depend on the number of its landmarks, about 1.5 KB. Where a job has
# more than `SAMPLE` landmarks, the reading sigma is estimated from frames with two or more
# that are spread over it.

SAMPLE = 25_000  # so many landmarks determine the reading sigma to a part in 250
EstimateOf = Callable[[Ints], Estimate]  # makes the estimate of frames, by their indices


def history_of_long_job(
    layout: LandmarkLayout,
    solved_estimate_of: EstimateOf,
    options: HistoryOptions,
    scale: JobReadingSigma | None = None,
    sum_errors: SumErrors | None = None,
) -> HistoryParts:
    """Make the attitude history of one job from the estimates of its blocks.

    The reading sigma, and the frames that turn too fast against a neighbour, are found of all
    frames before the first part is made.

    Args:
        layout: how many landmarks each frame has
        solved_estimate_of: makes the estimate of some frames
        options: sigmas, maximum rate and vertical
        scale: the reading sigma, where the solve has found it; None: from the estimates
        sum_errors: the covariances of sums over all frames, where they were solved together

    Raises:
        VopdError: where the rate is not above 0, or there is no such vertical
    """

    def estimate_of(frames: Ints) -> Estimate:
        return with_vertical(solved_estimate_of(frames), options.vertical)

    runs = layout.runs(TOGETHER, AT_ONCE)
    check_rate(options.max_rate_deg_s)
    if len(runs) == len(runs[0]) == 1:
        frames = runs[0][0]
        own = None if scale is None else scale.take(frames)
        (made,) = histories_without_jumps([estimate_of(frames)], options.sigmas, own)
        mark_jumps(made, options)
        return one_part(replace(made, sum_errors=sum_errors))
    if scale is None:
        scale = sampled_reading_sigma(layout, estimate_of, options.sigmas)
    jump = _jumps(layout, estimate_of, options.max_rate_deg_s)

    def block(frames: Ints, most_searched: int) -> History:
        estimate = estimate_of(frames)
        own = scale.take(frames)
        if layout.total > SAMPLE:
            own = block_reading_sigma(estimate, options.sigmas, scale)
        return histories_without_jumps([estimate], options.sigmas, own, most_searched)[0]

    def part(blocks: Sequence[Ints], left: int) -> History:
        made = []
        for frames in blocks:
            one = block(frames, left)
            left = max(left - int(one.uncertainty.reading.misfit.sum()), 0)
            made.append(_without_landmarks(one))
        every = np.sort(np.concatenate(blocks))
        within = [np.searchsorted(every, frames) for frames in blocks]
        whole = _joined(within, made, lambda: zip(within, map(estimate_of, blocks), strict=True))
        whole.flags.raised["jump"] = jump[every]
        return whole

    def parts(runs: Sequence[Sequence[Ints]]) -> Iterator[History]:
        left = MOST_FRAMES
        for blocks in runs:
            yield (made := part(blocks, left))
            left = max(left - int(made.uncertainty.reading.misfit.sum()), 0)

    every = [frames for blocks in runs for frames in blocks]

    if len(runs) == 1:
        return one_part(replace(part(every, MOST_FRAMES), sum_errors=sum_errors))
    several = np.flatnonzero(layout.count >= 2)
    middle = several[[len(several) // 2]] if len(several) else np.zeros(1, int)
    head = block(middle, 0)
    head.flags.raised["jump"] = jump[middle]

    def whole() -> History:
        return replace(part(every, MOST_FRAMES), sum_errors=sum_errors, typical=head)

    return HistoryParts(head, len(layout.count), lambda: parts(runs), whole)


def sampled_reading_sigma(
    layout: LandmarkLayout, estimate_of: EstimateOf, sigmas: Sigmas
) -> JobReadingSigma:
    """Estimate the reading sigma from all frames, or from a sample, and test those frames.

    In long jobs that is any one of so many, because every second frame may be a poor one.
    """
    several = np.flatnonzero(layout.count >= 2)
    several = several if len(several) else np.arange(len(layout.count))
    step = -(-int(layout.count[several].sum()) // SAMPLE) or 1
    first = np.arange(0, len(several), step)
    chosen = first + np.random.default_rng(0).integers(0, step, len(first))
    frames = several[np.minimum(chosen, len(several) - 1)]
    blocks = [frames[block] for run in layout.only(frames).runs(TOGETHER, AT_ONCE) for block in run]
    scales = job_reading_sigmas([estimate_of(block) for block in blocks], sigmas)
    chance = np.full(len(layout.count), np.nan)
    for block, scale in zip(blocks, scales, strict=True):
        chance[block] = scale.chance
    source = scales[0].source
    if step > 1 and source == "residuals":
        source = "sample"
    return replace(scales[0], chance=chance, source=source)


def _jumps(layout: LandmarkLayout, estimate_of: EstimateOf, max_rate_deg_s: float | None) -> Bools:
    """Find frames that turn too fast against a neighbour, from the angles of all frames."""
    frames = len(layout.count)
    if max_rate_deg_s is None:
        return np.zeros(frames, bool)
    quaternion, time_s = np.full((frames, 4), np.nan), np.full(frames, np.nan)
    for run in layout.runs(TOGETHER, AT_ONCE):
        for block in run:
            estimate = estimate_of(block)
            quaternion[block] = from_yaw_pitch_roll(estimate.vehicle_deg)
            time_s[block] = estimate.time_s
    return jumps(time_s, quaternion, max_rate_deg_s)
