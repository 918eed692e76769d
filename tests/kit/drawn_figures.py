"""Attitude histories by hand for figures, and what is drawn in a figure, read from its artists."""

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

OKABE_ITO = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
DARK_RED = "#b30000"


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


def points(line: Any) -> list[list[float]]:
    """The points of a line, (n, 2); None for NaN."""
    both = np.column_stack([np.asarray(values, float) for values in line.get_data()])
    return [[None if np.isnan(one) else one for one in pair] for pair in both.tolist()]


def labelled(axis: Any) -> dict[str, Any]:
    """The lines of an axis by their label."""
    return {line.get_label(): line for line in axis.lines}


def arrows_and_key(axis: Any) -> tuple[Any, Any]:
    """The arrows of an axis, and the key of their length, None without one."""
    (arrows,) = [one for one in axis.collections if hasattr(one, "U")]
    keys = [one for one in axis.get_children() if type(one).__name__ == "QuiverKey"]
    return arrows, keys[0] if keys else None


def texts(legend: Any) -> list[str]:
    """The texts of a legend."""
    return [text.get_text() for text in legend.get_texts()]


def ticks(axis: Any) -> tuple[list[float], list[str]]:
    """Where the fixed ticks of an x axis are, and their labels."""
    return list(axis.get_xticks()), [label.get_text() for label in axis.get_xticklabels()]
