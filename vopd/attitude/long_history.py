"""The attitude history of a job whose frames are taken in blocks of like numbers of landmarks.

Every array of a block is frames by the largest number of landmarks of the block, so that
one frame with many landmarks costs the others nothing. What is said of a frame is put
together for the whole job; an array with an axis of landmarks is put together when it is
asked for, and the parts that need the landmarks of all frames take `frame_landmarks`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import fields, is_dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.flags import jumps
from vopd.attitude.history import History, histories, history
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.uncertainty import job_reading_scales
from vopd.estimate import About, Estimate, EstimateBlock

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
    jobs: Sequence[Sequence[EstimateBlock]],
    *,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
) -> list[History]:
    """Make the attitude histories of many jobs; short jobs together are faster than alone.

    Args:
        jobs: the blocks of every job, as `history_of_blocks` takes them
        sigmas: as `history` takes it
        max_rate_deg_s: as `history` takes it

    Raises:
        VopdError: as `history` does
    """
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
        """One value of the job in the place of the values of its blocks."""
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
        """One dataclass of the job; its later values become properties."""
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
        """An array of all frames; NaN, 0 or false stands where a frame has fewer landmarks.

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
    """The history with other words about its source.

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
    """The history as its only block."""
    return [(np.arange(len(one.estimate.frame)), one.estimate, one.flags.outlier)]


def frame_landmarks(one: History) -> FrameLandmarks:
    """The landmarks of all frames, without the gaps of arrays of frames by landmarks.

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
