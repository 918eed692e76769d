"""GPS time of a track to UTC: the leap seconds of IERS Bulletin C, from their first days on."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from vopd.findings import VopdError
from vopd.flight.formats.track import TrackRows
from vopd.flight.project import Section
from vopd.flight.track import track_clock

LEAPS = [  # the first day, and GPS time less UTC before it and from it on
    ((2009, 1, 1), 14.0, 15.0),
    ((2012, 7, 1), 15.0, 16.0),
    ((2015, 7, 1), 16.0, 17.0),
    ((2017, 1, 1), 17.0, 18.0),
]


def on_clock(since_1970_s: float, own: str = "gps", **given: str) -> float:
    """A track of two positions, a second apart; gives the first one's time."""
    times = np.array([since_1970_s, since_1970_s + 1.0])
    rows = TrackRows(np.zeros((2, 3)), True, None, own, times, "")
    first, second = track_clock(Section("flight.toml", "track", dict(given)), rows)
    assert second - first == 1.0
    return float(first)


@pytest.mark.parametrize(("day", "before", "after"), LEAPS)
def test_leap_seconds(day: tuple[int, int, int], before: float, after: float) -> None:
    start = datetime(*day, tzinfo=UTC)
    for moment, ahead in ((start - timedelta(hours=1), before), (start, after)):
        seconds = moment.timestamp()
        assert on_clock(seconds) == seconds - ahead
        assert on_clock(seconds, "utc-column", clock="gps") == seconds - ahead
        assert on_clock(seconds, "utc") == on_clock(seconds, clock="utc") == seconds


def test_gps_time_before_the_table_is_refused() -> None:
    start = datetime(2006, 1, 1, tzinfo=UTC).timestamp()
    assert on_clock(start) == start - 14.0
    with pytest.raises(VopdError, match="GPS time before 2006 is not known: give UTC"):
        on_clock(start - 1.0)


def test_seconds_are_no_date() -> None:
    assert on_clock(12.5, "seconds") == 12.5
    for own, given in (("seconds", "gps"), ("utc", "seconds")):
        with pytest.raises(VopdError, match=f"clock: the file's times are {own}"):
            on_clock(12.5, own, clock=given)
