"""Attitude histories of long and of many short jobs, block by block."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import fields, is_dataclass
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.findings import HistorySummary, summary_of
from vopd.attitude.flags import Flags, jumps
from vopd.attitude.geometry import LandmarkGeometry, landmark_geometry
from vopd.attitude.history import History, HistoryOptions, check_rate, histories, history
from vopd.attitude.mistakes import MOST_FRAMES
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import outliers
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import block_reading_scale, job_reading_scales
from vopd.attitude.vertical import with_vertical
from vopd.estimate import About, Estimate, EstimateBlock
from vopd.geometry.rotations import from_yaw_pitch_roll
from vopd.landmark_layout import AT_ONCE, TOGETHER, LandmarkLayout

# History of a job in blocks of frames with like numbers of landmarks.
#
# Every array of a block is frames by the largest number of landmarks of the block, so that
# one frame with many landmarks costs the others nothing. What is said of a frame is put
# together for the whole job; an array with an axis of landmarks is put together when it is
# asked for, and the parts that need the landmarks of all frames take `frame_landmarks`.

OF_THE_JOB = ("about", "units", "stated", "sigmas", "landmark_names")
"""What all blocks of a job have in common, by its name."""


def history_of_blocks(
    blocks: Sequence[EstimateBlock],
    *,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
) -> History:
    """Make the attitude history of one job from the estimates of its blocks.

    Args:
        blocks: one or more, which have every frame of the job once
        sigmas: as `history` takes it
        max_rate_deg_s: as `history` takes it

    Raises:
        VopdError: as `history` does
    """
    estimates = [block.estimate for block in blocks]
    if len(estimates) == 1:
        return history(estimates[0], sigmas=sigmas, max_rate_deg_s=max_rate_deg_s)
    scales = job_reading_scales(estimates, sigmas)
    parts = [
        history(estimate, sigmas=sigmas, max_rate_deg_s=max_rate_deg_s, scale=scale)
        for estimate, scale in zip(estimates, scales, strict=True)
    ]
    counts = [estimate.used.shape[1] for estimate in estimates]
    join = Join([block.frames for block in blocks], counts=counts)
    landmarks = join.values([part.landmarks for part in parts], "")
    whole: History = join.records(parts, landmarks=landmarks)
    whole.flags.raised["jump"] = jumps(whole.estimate.time_s, whole.quaternion, max_rate_deg_s)
    outliers = [part.flags.outlier for part in parts]
    frames = [block.frames for block in blocks]
    whole.__dict__["landmark_blocks"] = partial(zip, frames, estimates, outliers, strict=True)
    return whole


def histories_of_jobs(
    jobs: Sequence[Sequence[EstimateBlock]], options: HistoryOptions
) -> list[History]:
    """Make the attitude histories of many jobs; short jobs together are faster than alone.

    Args:
        jobs: the blocks of every job, as `history_of_blocks` takes them
        options: sigmas, maximum rate and vertical

    Raises:
        VopdError: where the rate is not above 0, or there is no such vertical
    """
    sigmas, max_rate_deg_s = options.sigmas, options.max_rate_deg_s
    jobs = [
        [one._replace(estimate=with_vertical(one.estimate, options.vertical)) for one in blocks]
        for blocks in jobs
    ]
    whole = [blocks[0].estimate for blocks in jobs if len(blocks) == 1]
    made = iter(histories(whole, sigmas=sigmas, max_rate_deg_s=max_rate_deg_s))
    return [
        next(made)
        if len(blocks) == 1
        else history_of_blocks(blocks, sigmas=sigmas, max_rate_deg_s=max_rate_deg_s)
        for blocks in jobs
    ]


class _Later(NamedTuple):
    """An array with an axis of landmarks, which is put together when it is asked for."""

    parts: list[Any]


Makers = Mapping[type, Mapping[str, Callable[[Any], Any]]]
"""By the type of a record: attributes that its parts do not have, and what makes them."""


class Join:
    """Puts together what the blocks of a job have.

    Args:
        frames: the frames of each block
        makers: makes what the parts do not have; then the parts are emptied one by one
        counts: the largest number of landmarks of each block, where the parts have them
    """

    def __init__(
        self, frames: Sequence[Ints], makers: Makers | None = None, counts: Sequence[int] = ()
    ) -> None:
        self.frames = frames
        self.order = np.argsort(np.concatenate(frames))
        self.counts = counts
        self.makers = makers or {}
        self._value = dict.pop if self.makers else dict.__getitem__

    def values(self, parts: list[Any], name: str) -> Any:
        """Join one value of all blocks."""
        first = parts[0]
        if name in OF_THE_JOB:
            return first
        if isinstance(first, dict):
            value = self._value
            return {key: self.values([value(part, key) for part in parts], key) for key in [*first]}
        if is_dataclass(first):
            return self.records(parts)
        if isinstance(first, tuple) and hasattr(first, "_fields"):
            joined = [self.values(list(part), "") for part in zip(*parts, strict=True)]
            if any(isinstance(one, _Later) for one in joined):
                return _Later(parts)
            return type(first)(*joined)
        sizes = [len(part) if isinstance(part, list | tuple | np.ndarray) else -1 for part in parts]
        if sizes != [len(frames) for frames in self.frames]:
            return first
        if not isinstance(first, np.ndarray):
            every = [one for part in parts for one in part]
            return type(first)(every[k] for k in self.order)
        if len({part.shape[1:] for part in parts}) > 1:
            return _Later(parts)
        return np.concatenate(parts)[self.order]

    def records(self, parts: list[Any], **known: Any) -> Any:
        """Join a dataclass of all blocks; its later values become properties."""
        kind = type(parts[0])
        makers = self.makers.get(kind, {})
        later = {name: property(make) for name, make in makers.items()}
        for name in (field.name for field in fields(kind) if field.name not in makers):
            value = self.values([self._value(part.__dict__, name) for part in parts], name)
            if isinstance(value, _Later):
                later[name] = property(partial(self._arranged, value.parts))
            else:
                known[name] = value
        later |= {n: property(partial(_known, n)) for n in known if hasattr(kind, n)}
        record: Any = object.__new__(type(kind.__name__, (kind,), later))
        record.__dict__.update(known)
        return record

    def _arranged(self, parts: list[Any], _: object) -> Any:
        """Arrange an array of all frames; NaN, 0 or false if a frame has fewer landmarks.

        It is 0 in an axis of image coordinates, as for landmarks that take no part.
        """
        if isinstance(parts[0], tuple):
            return type(parts[0])(
                *(self._arranged(list(part), _) for part in zip(*parts, strict=True))
            )
        shapes = zip(*(part.shape[1:] for part in parts), strict=True)
        widest, twice = max(self.counts), [2 * count for count in self.counts]
        size, halved = [len(self.order)], []
        for axis, sizes in enumerate(shapes, 1):
            if list(sizes) == twice:
                halved.append(axis)
            same = len(set(sizes)) == 1
            size.append(sizes[0] if same else 2 * widest if list(sizes) == twice else widest)
        empty = np.nan if parts[0].dtype.kind == "f" and not halved else 0
        whole = np.full(size, empty, parts[0].dtype)
        for part, frames, count in zip(parts, self.frames, self.counts, strict=True):
            index: list[Any] = [np.arange(n) for n in part.shape]
            index[0] = frames
            for axis in halved:  # x of every landmark, then y of every landmark
                index[axis] = np.append(np.arange(count), widest + np.arange(count))
            whole[np.ix_(*index)] = part
        return whole


def _known(name: str, record: Any) -> Any:
    return record.__dict__[name]


def with_about(one: History, about: About) -> History:
    """Replace the description of the source of a history.

    Args:
        one: the history of a job
        about: what it is about
    """
    other, estimate = copy(one), copy(one.estimate)
    estimate.__dict__["about"] = about
    other.__dict__["estimate"] = estimate
    return other


class FrameLandmarks(NamedTuple):
    """The landmarks of all frames of a job that take part or are left out, frame after frame."""

    frame: Ints  # (N,) index of the frame
    landmark: Ints  # (N,) number
    used: Bools  # (N,) which take part
    ignored: Bools  # (N,) which the user left out
    image: Floats  # (N, 2) measured image coordinates x, y
    residual: Floats  # (N, 2) measured minus computed; NaN where it takes no part
    outlier: Bools  # (N,) which does not fit the others of its frame


def _alone(one: History) -> list[tuple[Ints, Estimate, Bools]]:
    """Treat the history as its only block."""
    return [(np.arange(len(one.estimate.frame)), one.estimate, one.flags.outlier)]


def frame_landmarks(one: History) -> FrameLandmarks:
    """List the landmarks of all frames, without the gaps of (F, L) arrays.

    Args:
        one: the history of a job
    """
    parts = []
    for frames, e, outlier in one.__dict__.get("landmark_blocks", partial(_alone, one))():
        here = e.used | e.ignored
        values = e.landmark, e.used, e.ignored, e.image, e.residual_xy, outlier
        parts.append((frames[np.nonzero(here)[0]], *(value[here] for value in values)))
    joined = [np.concatenate(part) for part in zip(*parts, strict=True)]
    order = np.argsort(joined[0], kind="stable")
    return FrameLandmarks(*(values[order] for values in joined))


# History in parts.


class HistoryParts:
    """The attitude history of one job in parts of consecutive frames, in the order of the frames.

    A part is made when it is come to, and made again whenever the parts are gone through again.

    Attributes:
        head: the history of one frame or more, for what is said of the whole job
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
        """What the history is about: source, job, title and fixes."""
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
        """Whether `summary` takes no further work."""
        return self._whole is not None or self._summary is not None

    @property
    def summary(self) -> HistorySummary:
        """What is said of the frames together; known once all parts have been made."""
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
        """Report progress: the frames of each part that is made.

        Args:
            tell: is given the number of frames
        """

        def parts() -> Iterator[History]:
            for part in self:
                tell(len(part.estimate.frame))
                yield part

        return HistoryParts(self.head, self.frames, parts, lambda: self.whole)


def one_part(history: History) -> HistoryParts:
    """Wrap a history that is made already as its only part.

    Args:
        history: of one job
    """
    parts = HistoryParts(
        history, len(history.estimate.frame), lambda: iter((history,)), lambda: history
    )
    parts._whole = history
    return parts


# History of a job of any length.
#
# The estimate of a block is made when it is needed. A job of more than `TOGETHER` landmarks
# has parts, which are made one after the other; whoever needs all of it at once has of each
# frame what does not depend on the number of its landmarks, about 1.5 KB. Where a job has
# more than `SAMPLE` landmarks, the reading sigma is estimated from frames with two or more
# that are spread over it.

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
    layout: LandmarkLayout, solved_estimate_of: EstimateOf, options: HistoryOptions
) -> HistoryParts:
    """Make the attitude history of one job from the estimates of its blocks.

    Args:
        layout: how many landmarks each frame has
        solved_estimate_of: makes the estimate of some frames
        options: sigmas, maximum rate and vertical

    Raises:
        VopdError: where the rate is not above 0, or there is no such vertical
    """
    sigmas, max_rate_deg_s = options.sigmas, options.max_rate_deg_s

    def estimate_of(frames: Ints) -> Estimate:
        return with_vertical(solved_estimate_of(frames), options.vertical)

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
        """Make the history of the first frame."""
        first = np.zeros(1, np.int64)
        return self._part(first, self._estimate_of(first), 0)

    def histories(self, runs: Sequence[Sequence[Ints]]) -> Iterator[History]:
        """Iterate over the histories of runs of frames, each of several blocks."""
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
        """Make the history of a block."""
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
    scales = job_reading_scales([estimate_of(block) for block in blocks], sigmas)
    chance = np.full(len(layout.count), np.nan)
    for block, scale in zip(blocks, scales, strict=True):
        chance[block] = scale.chance
    source = scales[0].source
    if step > 1 and source == "residuals":
        source = "sample"
    return scales[0]._replace(chance=chance, source=source)


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


def _without_landmarks(one: History) -> History:
    """Copy a history without the arrays that have an axis of landmarks."""
    one = copy(one)
    for name in ("estimate", "geometry", "flags"):
        record = one.__dict__[name] = copy(getattr(one, name))
        for array in BY_LANDMARK[type(record)]:
            del record.__dict__[array]
    return one


def _makers(whole: Callable[[], Estimate]) -> Makers:
    """Assign each of these arrays its maker for all frames."""
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
