"""Attitude histories with numbers of one's own, for what figures and pages make of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tests.kit.estimates import estimate
from tests.kit.histories import about, with_estimate
from vopd.attitude.history import History, history


@cache
def base(frames: int) -> History:
    """So many frames, a second apart, with four landmarks each; nothing is flagged."""
    made = history(estimate(np.tile([10.0, -60.0, 20.0], (frames, 1))))
    assert not made.flags.any().any()
    return made


def by_hand(
    frames: int = 3,
    *,
    angles_deg: ArrayLike | None = None,
    half_deg: ArrayLike | None = None,
    eta_deg: ArrayLike | None = None,
    flags: Mapping[str, Sequence[int]] | None = None,
    misfit: Sequence[str] = (),
    outlier: ArrayLike | None = None,
    said: Mapping[str, Any] | None = None,
    **changes: Any,
) -> History:
    """A history with numbers of one's own, and nothing computed anew.

    Args:
        frames: how many
        angles_deg: camera and vehicle yaw, pitch, roll, alpha, beta, eta, (F, 9)
        half_deg: half of their 95 % intervals, (F, 9)
        eta_deg: the interval of eta, (F, 2)
        flags: indices of the frames that have them, by name
        misfit: what explains the misfit of each frame
        outlier: landmarks that are outliers, (F, L)
        said: source, job, title, fixes
        changes: of the estimate
    """
    one = base(frames)
    if angles_deg is not None:
        angles = np.asarray(angles_deg, float)
        names = ("camera_deg", "vehicle_deg", "attack_deg")
        changes |= dict(zip(names, np.split(angles, 3, axis=1), strict=True))
    one = with_estimate(one, **changes)
    doubt, raised = one.uncertainty, dict(one.flags.raised)
    if half_deg is not None:
        doubt = replace(doubt, half_width_95=np.asarray(half_deg, float))
    if eta_deg is not None:
        doubt = replace(doubt, eta_interval_95_deg=np.asarray(eta_deg, float))
    for name, indices in (flags or {}).items():
        assert name in raised
        raised[name] = np.isin(np.arange(frames), indices)
    detail = one.flags.detail | ({"misfit": list(misfit)} if misfit else {})
    odd = one.flags.outlier if outlier is None else np.asarray(outlier)
    shown = replace(one.flags, raised=raised, detail=detail, outlier=odd)
    return about(replace(one, uncertainty=doubt, flags=shown), **(said or {}))
