"""The attitudes of a job in order of time, each time once, for formats that need dates."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.history import History
from vopd.export.file_request import has_date
from vopd.findings import Finding, Report, VopdError

LATEST_S = 1e12  # no two dates are this many seconds apart
FARTHEST_M = 1e15  # a tenth of a light year: nothing that flew


class TimedAttitude(NamedTuple):
    """The frames of one job that have an attitude, a time and a position, T of them."""

    history: History
    frames: Ints  # (T,) their indices in the history
    microseconds: list[int]  # since time zero, increasing
    quaternion: Floats  # (T, 4) w x y z, local north-east-down to body
    position: Floats  # (T, 3) longitude and latitude, degrees, and altitude, metres


def timed_attitudes(
    histories: Sequence[History], epoch: datetime | None, report: Report
) -> list[TimedAttitude]:
    """The attitudes in order of time of every job that has at least one such frame.

    Of frames with the same time, to the microsecond, the first in the source is kept.

    Args:
        histories: the jobs
        epoch: the moment of time zero; frames that have no date then are left out
        report: is given a warning for each frame that is left out

    Raises:
        VopdError: where no frame of any job is left
    """
    found = [timed_attitude(h, epoch, report) for h in histories]
    left = [one for one in found if len(one.frames)]
    if not left:
        raise VopdError("no frame has an attitude, a time and a position")
    return left


def timed_attitude(history: History, epoch: datetime | None, report: Report) -> TimedAttitude:
    """The attitudes of one job in order of time, possibly none; arguments as `timed_attitudes`."""
    e = history.estimate
    time_s, here = e.time_s, e.position
    altitude_m = here.altitude * e.units.metres_per_length
    position = np.stack([here.longitude_deg, here.latitude_deg, altitude_m], axis=1)
    known = history.has_attitude & np.isfinite(time_s) & (np.abs(position) < FARTHEST_M).all(axis=1)
    known &= np.isfinite(here.north_east_down).all(axis=(1, 2))
    known &= np.isfinite(history.quaternion).all(axis=1)
    whole = np.flatnonzero(known)
    order = whole[np.argsort(time_s[whole], kind="stable")]
    kept: dict[int, int] = {}
    for k in order.tolist():
        if abs(time_s[k]) > LATEST_S or not _dated(epoch, moment := round(time_s[k] * 1e6)):
            why = f"its time of {time_s[k]:g} s is outside the years 1 to 9999"
            report(_left_out(history, k, why))
        elif kept.setdefault(moment, k) != k:
            report(_left_out(history, k, f"it has the time of row {kept[moment] + 1}"))
    frames = np.array(list(kept.values()), dtype=np.int64)
    return TimedAttitude(history, frames, list(kept), history.quaternion[frames], position[frames])


def _dated(epoch: datetime | None, microseconds: int) -> bool:
    return epoch is None or has_date(epoch, microseconds)


def _left_out(history: History, k: int, why: str) -> Finding:
    about = history.about
    return Finding(
        f"frame {history.estimate.frame_label(k)}, row {k + 1}, is left out: {why}",
        deck=about.source,
        job=about.job,
        severity="warning",
    )


def continuous(quaternion: Floats) -> Floats:
    """Choose the signs of quaternions so that each is close to the one before it.

    q and -q are one attitude; a reader that interpolates components needs
    neighbours with the same sign. The first keeps its sign.

    Args:
        quaternion: w x y z, (T, 4)
    """
    turned = (quaternion[1:] * quaternion[:-1]).sum(axis=1) < 0.0
    sign = np.cumprod(np.append(1.0, np.where(turned, -1.0, 1.0))[: len(quaternion)])
    return np.asarray(quaternion * sign[:, None])
