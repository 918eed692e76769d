"""Rows of a track as a reader returns them, and the keys of a project's [track]."""

from __future__ import annotations

from typing import Any

import numpy as np

from vopd.flight.formats.track import TrackRows
from vopd.flight.project import Section


def track(clock: str | None, *time_s: float, image: tuple[str, ...] = (), **more: Any) -> TrackRows:
    position = np.zeros((len(time_s), 3))
    times = None if clock is None else np.array(time_s)
    return TrackRows(position, True, None, clock, times, "", [*image], **more)


def keys(**values: Any) -> Section:
    return Section("p.toml", "track", values)
