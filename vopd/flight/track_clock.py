"""The times of a track on the clock of the frames: UTC, GPS time, or seconds of the flight."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

from vopd.arrays import Floats
from vopd.flight.frame_times import FrameTimes
from vopd.flight.project import Section
from vopd.flight.track_formats.track_rows import TrackRows

GPS_AHEAD_S = (  # of UTC, from a date on
    (datetime(2017, 1, 1, tzinfo=UTC), 18.0),
    (datetime(2015, 7, 1, tzinfo=UTC), 17.0),
    (datetime(2012, 7, 1, tzinfo=UTC), 16.0),
    (datetime(2009, 1, 1, tzinfo=UTC), 15.0),
    (datetime(2006, 1, 1, tzinfo=UTC), 14.0),
)


def track_on_clock(section: Section, rows: TrackRows, times: FrameTimes) -> Floats:
    """The track's times on the clock of the frames."""
    found = track_clock(section, rows)
    if rows.clock == "seconds":
        return found
    if times.epoch is None:
        message = "is needed: the track is in UTC, and the frames are in seconds"
        raise Section(section.project, "flight", {}).error("epoch", message)
    return found - times.epoch.timestamp()


def track_clock(section: Section, rows: TrackRows) -> Floats:
    """The track's times as UTC since 1970, or as they are where they are seconds."""
    assert rows.time_s is not None
    own = rows.clock
    if own == "utc-column":
        own = section.text("clock", ("utc", "gps"))
    elif section.has("clock"):
        own = section.text("clock", ("utc", "gps", "seconds"))
        if own != rows.clock and "seconds" in (own, rows.clock):
            raise section.error("clock", f"the file's times are {rows.clock}")
    if own != "gps":
        return rows.time_s
    first = datetime.fromtimestamp(float(rows.time_s[0]), UTC)
    ahead = next((seconds for since, seconds in GPS_AHEAD_S if first >= since), float("nan"))
    if not np.isfinite(ahead):
        raise section.error("clock", "GPS time before 2006 is not known: give UTC")
    return rows.time_s - ahead
