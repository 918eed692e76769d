"""The attitude history of a job of any length, whose frames are taken in blocks.

The estimate of a block is made when it is needed. A job of more than `TOGETHER` landmarks
has parts, which are made one after the other; whoever needs all of it at once has of each
frame what does not depend on the number of its landmarks, about 1.5 KB. Where a job has
more than `SAMPLE` landmarks, the reading sigma is estimated from frames with two or more
that are spread over it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from functools import cache, partial
from typing import Any

import numpy as np

from vopd.arrays import Bools, Ints
from vopd.attitude.flags import Flags, jumps
from vopd.attitude.history import History, check_rate, history
from vopd.attitude.history_parts import HistoryParts, one_part
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.landmark_geometry import LandmarkGeometry, landmark_geometry
from vopd.attitude.long_history import Join, Makers
from vopd.attitude.mistakes import MOST_FRAMES
from vopd.attitude.outliers import outliers
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.uncertainty import block_reading_scale, job_reading_scales
from vopd.estimate import Estimate
from vopd.geometry.rotations import from_yaw_pitch_roll
from vopd.landmark_layout import AT_ONCE, TOGETHER, LandmarkLayout

SAMPLE = 25_000
"""So many landmarks determine the reading sigma to a part in 250."""

EstimateOf = Callable[[Ints], Estimate]
"""Makes the estimate of frames, by their indices."""

BY_LANDMARK: dict[type, tuple[str, ...]] = {
    Estimate: (
        "landmark", "used", "ignored", "direction", "image", "residual", "partials", "gain",
        "body_gain", "responses", "relative_sigma", "outlier",
    ),
    LandmarkGeometry: ("ahead",),
    Flags: ("outlier",),
}  # fmt: skip
"""The arrays with an axis of landmarks, which are made anew when they are asked for."""


def history_of_long_job(
    layout: LandmarkLayout,
    estimate_of: EstimateOf,
    *,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
) -> HistoryParts:
    """Make the attitude history of one job from the estimates of its blocks.

    Args:
        layout: how many landmarks each frame has
        estimate_of: makes the estimate of some frames
        sigmas: as `history` takes it
        max_rate_deg_s: as `history` takes it

    Raises:
        VopdError: as `history` does
    """
    runs = layout.runs(TOGETHER, AT_ONCE)
    if len(runs) == len(runs[0]) == 1:
        return one_part(
            history(estimate_of(runs[0][0]), sigmas=sigmas, max_rate_deg_s=max_rate_deg_s)
        )
    job = _LongJob(layout, estimate_of, sigmas, max_rate_deg_s)
    if len(runs) == 1:
        return one_part(*job.histories(runs))
    return HistoryParts(
        job.head(),
        len(layout.count),
        lambda: job.histories(runs),
        lambda: next(job.histories([[frames for blocks in runs for frames in blocks]])),
    )


class _LongJob:
    """A job of several blocks: what must be known of all frames before the first part is made.

    That is the reading sigma, and the frames that turn too fast against a neighbour.
    """

    def __init__(
        self,
        layout: LandmarkLayout,
        estimate_of: EstimateOf,
        sigmas: Sigmas,
        max_rate_deg_s: float | None,
    ) -> None:
        check_rate(max_rate_deg_s)
        self._estimate_of = estimate_of
        self._sigmas = sigmas
        self._scale = _sampled_scale(layout, estimate_of, sigmas)
        self._all_tested = layout.total <= SAMPLE
        self._jump = _jumps(layout, estimate_of, max_rate_deg_s)

    def head(self) -> History:
        """The history of the first frame."""
        first = np.zeros(1, np.int64)
        return self._part(first, self._estimate_of(first), 0)

    def histories(self, runs: Sequence[Sequence[Ints]]) -> Iterator[History]:
        """The histories of runs of frames, each of several blocks."""
        searched = 0
        for blocks in runs:
            parts, landmarks = [], []
            for frames in blocks:
                part = self._part(frames, self._estimate_of(frames), MOST_FRAMES - searched)
                misfits = int(part.uncertainty.reading.misfit.sum())
                searched = min(searched + misfits, MOST_FRAMES)
                landmarks.append(part.landmarks)
                parts.append(_without_landmarks(part))
            yield self._joined(blocks, parts, landmarks)

    def _part(self, frames: Ints, estimate: Estimate, most_searched: int) -> History:
        """The history of a block."""
        if self._all_tested:
            scale = self._scale._replace(chance=self._scale.chance[frames])
        else:
            scale = block_reading_scale(estimate, self._sigmas, self._scale)
        part = history(estimate, sigmas=self._sigmas, scale=scale, most_searched=most_searched)
        part.flags.raised["jump"] = self._jump[frames]
        return part

    def _joined(
        self, blocks: Sequence[Ints], parts: list[History], landmarks: list[Ints]
    ) -> History:
        every = np.sort(np.concatenate(blocks))
        within = [np.searchsorted(every, frames) for frames in blocks]
        join = Join(within, _makers(cache(lambda: self._estimate_of(every))))
        whole: History = join.records(parts, landmarks=join.values(landmarks, ""))
        whole.__dict__["landmark_blocks"] = partial(
            _landmark_blocks, blocks, within, self._estimate_of
        )
        return whole


def _sampled_scale(
    layout: LandmarkLayout, estimate_of: EstimateOf, sigmas: Sigmas
) -> JobReadingSigma:
    """The reading sigma by all frames that tell of it, or by one of each so many, and their tests.

    In long jobs that is any one of so many, because every second frame may be a poor one.
    """
    several = np.flatnonzero(layout.count >= 2)
    several = several if len(several) else np.arange(len(layout.count))
    step = -(-int(layout.count[several].sum()) // SAMPLE) or 1
    first = np.arange(0, len(several), step)
    chosen = first + np.random.default_rng(0).integers(0, step, len(first))
    frames = several[np.minimum(chosen, len(several) - 1)]
    blocks = [frames[block] for run in layout.only(frames).runs(TOGETHER, AT_ONCE) for block in run]
    scales = job_reading_scales([estimate_of(block) for block in blocks], sigmas)
    chance = np.full(len(layout.count), np.nan)
    for block, scale in zip(blocks, scales, strict=True):
        chance[block] = scale.chance
    source = scales[0].source
    if step > 1 and source == "residuals":
        source = "sample"
    return scales[0]._replace(chance=chance, source=source)


def _jumps(layout: LandmarkLayout, estimate_of: EstimateOf, max_rate_deg_s: float | None) -> Bools:
    """Frames that turn too fast against a neighbour, by the angles of all frames."""
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


def _without_landmarks(one: History) -> History:
    """A copy without the arrays that have an axis of landmarks."""
    one = copy(one)
    for name in ("estimate", "geometry", "flags"):
        record = one.__dict__[name] = copy(getattr(one, name))
        for array in BY_LANDMARK[type(record)]:
            del record.__dict__[array]
    return one


def _makers(whole: Callable[[], Estimate]) -> Makers:
    """What makes each of these arrays for all frames."""
    return {
        Estimate: {name: partial(_of_estimate, whole, name) for name in BY_LANDMARK[Estimate]},
        LandmarkGeometry: {"ahead": lambda _: landmark_geometry(whole()).ahead},
        Flags: {"outlier": lambda _: outliers(whole())},
    }


def _of_estimate(whole: Callable[[], Estimate], name: str, _: object) -> Any:
    return getattr(whole(), name)


def _landmark_blocks(
    blocks: Sequence[Ints], within: Sequence[Ints], estimate_of: EstimateOf
) -> Iterator[tuple[Ints, Estimate, Bools]]:
    for frames, index in zip(blocks, within, strict=True):
        estimate = estimate_of(frames)
        yield index, estimate, outliers(estimate)
