"""A job's frames as a track: those with an attitude, in order of time, each time once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.history import History
from vopd.findings import Finding, Report, VopdError


class Track(NamedTuple):
    """T frames of one job; `place` is longitude, latitude (degrees) and altitude (m)."""

    history: History
    frames: Ints  # (T,) their places in the history
    microseconds: list[int]  # of flight, increasing
    quaternion: Floats  # (T, 4) w x y z, local north-east-down to body
    place: Floats  # (T, 3)


def tracks(histories: Sequence[History], report: Report) -> list[Track]:
    """The tracks of all jobs that have a frame left.

    Of frames with the same time, to the microsecond, the first in the deck
    stays, and `report` is told of the others. Raises `VopdError` where no frame
    of any job has an attitude, a time and a place.
    """
    found = [track(h, report) for h in histories]
    left = [one for one in found if len(one.frames)]
    if not left:
        raise VopdError("no frame is left with an attitude, a time and a place")
    return left


def track(history: History, report: Report) -> Track:
    """The track of one job, which may be empty."""
    e = history.estimate
    time_s, here = e.time_s, e.position
    altitude_m = here.altitude * e.units.metres_per_length
    place = np.stack([here.longitude_deg, here.latitude_deg, altitude_m], axis=1)
    known = history.has_attitude & np.isfinite(time_s) & np.isfinite(place).all(axis=1)
    whole = np.flatnonzero(known)
    order = whole[np.argsort(time_s[whole], kind="stable")]
    kept: dict[int, int] = {}
    for k in order.tolist():
        moment = round(time_s[k] * 1e6)
        if kept.setdefault(moment, k) != k:
            report(_repeated(history, k, kept[moment]))
    frames = np.array(list(kept.values()), dtype=np.int64)
    return Track(history, frames, list(kept), history.quaternion[frames], place[frames])


def _repeated(history: History, k: int, first: int) -> Finding:
    frame, about = history.estimate.frame, history.about
    return Finding(
        f"frame {frame[k]}, row {k + 1}, has the time of row {first + 1} and is left out",
        deck=about.source,
        job=about.job,
        severity="warning",
    )


def continuous(quaternion: Floats) -> Floats:
    """The same attitudes (T, 4), signs such that neighbours are near each other.

    q and -q are one attitude; a reader that interpolates components needs them
    on one side. The first is as it was.
    """
    turned = (quaternion[1:] * quaternion[:-1]).sum(axis=1) < 0.0
    sign = np.cumprod(np.append(1.0, np.where(turned, -1.0, 1.0))[: len(quaternion)])
    return np.asarray(quaternion * sign[:, None])
