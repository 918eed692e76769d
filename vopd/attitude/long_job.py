"""The attitude history of a job of any length, whose frames are taken in blocks.

The estimate of a block is made when it is needed, and of each frame only what does not
depend on the number of its landmarks is kept. Where a job has more than `SAMPLE`
landmarks, the reading sigma is estimated from frames that are spread evenly over it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import copy
from functools import cache, partial
from typing import Any

import numpy as np

from vopd.arrays import Bools, Ints
from vopd.attitude.blocks import Join, Makers
from vopd.attitude.flags import Flags, jumps
from vopd.attitude.history import History, history
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.label_search import MOST_FRAMES
from vopd.attitude.landmark_geometry import LandmarkGeometry, landmark_geometry
from vopd.attitude.outliers import outliers
from vopd.attitude.reading_scale import JobReadingSigma
from vopd.attitude.uncertainty import block_reading_scale, job_reading_scales
from vopd.estimate import Estimate
from vopd.landmark_layout import AT_ONCE, LandmarkLayout

SAMPLE = 25_000
"""So many landmarks determine the reading sigma to a part in 250."""

EstimateOf = Callable[[Ints], Estimate]
"""Makes the estimate of frames, by their indices."""

BY_LANDMARK: dict[type, tuple[str, ...]] = {
    Estimate: (
        "landmark", "used", "ignored", "direction", "image", "residual", "partials", "gain",
        "body_gain", "responses", "relative_sigma",
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
) -> History:
    """Make the attitude history of one job from the estimates of its blocks.

    Args:
        layout: how many landmarks each frame has
        estimate_of: makes the estimate of some frames
        sigmas: as `history` takes it
        max_rate_deg_s: as `history` takes it

    Raises:
        VopdError: as `history` does
    """
    blocks = layout.blocks(AT_ONCE)
    if len(blocks) == 1:
        return history(estimate_of(blocks[0]), sigmas=sigmas, max_rate_deg_s=max_rate_deg_s)
    step = -(-layout.total // SAMPLE)
    scales = _sampled_scales(layout, step, estimate_of, sigmas)
    parts, landmarks, searched = [], [], 0
    for k, frames in enumerate(blocks):
        estimate = estimate_of(frames)
        own = scales[k] if step == 1 else block_reading_scale(estimate, sigmas, scales[0])
        part = history(
            estimate,
            sigmas=sigmas,
            max_rate_deg_s=max_rate_deg_s,
            scale=own,
            most_searched=MOST_FRAMES - searched,
        )
        searched = min(searched + int(own.misfit.sum()), MOST_FRAMES)
        landmarks.append(part.landmarks)
        parts.append(_without_landmarks(part))
    join = Join(blocks, _makers(cache(lambda: estimate_of(np.arange(len(layout.count))))))
    whole: History = join.records(parts, landmarks=join.values(landmarks, ""))
    whole.flags.raised["jump"] = jumps(whole.estimate, whole.quaternion, max_rate_deg_s)
    whole.__dict__["landmark_blocks"] = partial(_landmark_blocks, blocks, estimate_of)
    return whole


def _sampled_scales(
    layout: LandmarkLayout, step: int, estimate_of: EstimateOf, sigmas: Sigmas
) -> list[JobReadingSigma]:
    """The reading sigma by every frame, or by each of so many steps, for each block of them."""
    frames = np.arange(0, len(layout.count), step)
    blocks = layout.only(frames).blocks(AT_ONCE)
    return job_reading_scales([estimate_of(frames[block]) for block in blocks], sigmas)


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
    blocks: list[Ints], estimate_of: EstimateOf
) -> Iterator[tuple[Ints, Estimate, Bools]]:
    for frames in blocks:
        estimate = estimate_of(frames)
        yield frames, estimate, outliers(estimate)
