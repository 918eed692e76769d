"""Times of frames by rate, table or track; clocks of tracks."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import keys, track
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.project import Project, Section
from vopd.flight.track import FrameTimes, first_whole_second, frames_of, track_clock, track_on_clock

EPOCH = datetime(2026, 5, 1, 12, tzinfo=UTC)


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refused:
        action()
    return str(refused.value)


def frames(folder: Path, frame: Any, epoch: Any = None, **keys: Any) -> Any:
    """Numbers, times and indices of the frames of three picks or so."""
    flight = Section("p.toml", "flight", {} if epoch is None else {"epoch": epoch})
    picks = Section("p.toml", "picks", keys)
    project = Project("p.toml", folder, {"flight": flight, "picks": picks})
    nothing = np.zeros(len(frame))
    rows = PickRows(frame, Names(["m"] * len(frame)), nothing, nothing, None, None, "")
    return frames_of(project, rows)


NUMBERS = np.array([12, 4, 12, 7])
NAMED = Names(["b", "a", "b", "c"])


@pytest.mark.parametrize("epoch", [None, EPOCH])
def test_times_by_the_rate_of_the_frames(epoch: Any, tmp_path: Path) -> None:
    """Frame 4 at 20 a second and .5 s is at .7 s."""
    keys = {"frame_rate_hz": 20, "first_frame_t_s": 0.5}
    number, times, index = frames(tmp_path, NUMBERS, epoch, **keys)
    assert (number.tolist(), index.tolist()) == ([4, 7, 12], [2, 0, 2, 1])
    assert_close("time", times.time_s, [0.7, 0.85, 1.1])
    assert (times.image, times.epoch, times.said, times.whole_seconds) == ((), epoch, "", False)
    number, times, index = frames(tmp_path, NAMED, epoch, **keys)
    assert (number.tolist(), index.tolist(), times.image) == (
        [0, 1, 2],
        [1, 0, 1, 2],
        ("a", "b", "c"),
    )
    assert np.isnan(times.time_s).all() and times.epoch == epoch
    assert np.isnan(frames(tmp_path, NUMBERS)[1].time_s).tolist() == [True] * 3
    for wrong, message in (
        ({"frame_rate_hz": 0, "first_frame_t_s": 0}, "frame_rate_hz: 0 is not above 0"),
        ({"frame_rate_hz": -5, "first_frame_t_s": 0}, "frame_rate_hz: -5 is not above 0"),
        ({"frame_rate_hz": 20}, "first_frame_t_s: is needed"),
        ({"frame_rate_hz": 20, "times": "t"},
         "times: frame_rate_hz is there too: give one of them"),
    ):  # fmt: skip
        said = told(lambda wrong=wrong: frames(tmp_path, NUMBERS, **wrong))
        assert said == f"p.toml: [picks] {message}"
    both = {"frame_rate_hz": 20, "times": "t"}
    assert told(lambda: frames(tmp_path, NAMED, **both)).endswith("give one of them")


@pytest.mark.parametrize("epoch", [None, EPOCH])
def test_times_by_a_table(epoch: Any, tmp_path: Path) -> None:
    """In UTC, zero is the epoch, or the whole second of the first frame that is picked."""
    table = tmp_path / "t"
    table.write_text("image,frame,t_s\nx,12,3.5\ny,4,1.5\nb,5,2.5\na,8,2.75\n")
    _, times, _ = frames(tmp_path, NUMBERS, epoch, times="t")
    assert np.array_equal(times.time_s, [1.5, np.nan, 3.5], equal_nan=True)
    assert (times.said, times.epoch) == ("t: times of 4 frames", epoch)
    _, times, _ = frames(tmp_path, NAMED, epoch, times="t")
    assert np.array_equal(times.time_s, [2.75, 2.5, np.nan], equal_nan=True)
    utc = (
        "image,t_utc\nz,2026-05-01T12:00:00Z\na,2026-05-01T12:00:09.75Z\nb,2026-05-01T12:00:08.5Z\n"
    )
    table.write_text(utc)
    _, times, _ = frames(tmp_path, NAMED, epoch, times="t")
    zero = 0.0 if epoch else 8.0
    assert np.array_equal(times.time_s, [9.75 - zero, 8.5 - zero, np.nan], equal_nan=True)
    assert times.epoch == EPOCH + timedelta(seconds=zero)
    table.write_text("frame,t_s,t_utc\n4,7,2026-05-01T12:00:00Z\n")
    assert frames(tmp_path, NUMBERS, epoch, times="t")[1].time_s[0] == 7.0
    none = "p.toml: [picks] times: t: none of the frames is there "
    table.write_text("image,frame,t_s\nz,5,1\n")
    assert told(lambda: frames(tmp_path, NUMBERS, times="t")) == none + "(4)"
    assert told(lambda: frames(tmp_path, NAMED, times="t")) == none + "(a)"
    for header, frame in (("image", NUMBERS), ("frame", NAMED)):
        table.write_text(f"{header},t_s\n4,1\n")
        missing = "frame" if header == "image" else "image"
        said = told(lambda frame=frame: frames(tmp_path, frame, times="t"))
        assert said.startswith(f"t: line 1: no column {missing}")


@pytest.mark.parametrize(
    ("rows", "line", "later", "earlier"),
    [
        ("4,1\n5,1\n", 3, 5, 4), ("5,1\n4,2\n6,3\n", 2, 5, 4), ("4,1\n5,2\n6,1.5\n7,0\n", 4, 6, 5),
        ("9,5\n7,3\n8,2\n", 4, 8, 7),
    ],
)  # fmt: skip
def test_a_later_frame_has_a_later_time(
    rows: str, line: int, later: int, earlier: int, tmp_path: Path
) -> None:
    """The first pair in the order of the numbers is named, with the line of the later one."""
    (tmp_path / "t").write_text("frame,t_s\n" + rows)
    assert told(lambda: frames(tmp_path, NUMBERS, times="t")) == (
        f"t: line {line}, column t_s: frame {later} is not after frame {earlier}"
    )


@pytest.mark.parametrize("rows", ["5,1\n5,2\n", "5,2\n5,1\n", "5,1\n5,1\n", "4,0\n5,2\n6,3\n5,1\n"])
def test_a_frame_has_one_time(rows: str, tmp_path: Path) -> None:
    (tmp_path / "t").write_text("frame,t_s\n" + rows)
    said = told(lambda: frames(tmp_path, NUMBERS, times="t"))
    assert said == "p.toml: [picks] times: t: a frame has two times"


def test_zero_is_a_whole_second() -> None:
    start = EPOCH.timestamp()
    for given in ([0.25, 5.0], [np.nan, 0.25], [7.0, 0.999], [0.0, np.nan]):
        assert first_whole_second(start + np.array(given)) == EPOCH
    assert first_whole_second(np.array([-0.5])) == datetime(1969, 12, 31, 23, 59, 59, tzinfo=UTC)
    for wrong in (1e18, 1e300, -1e15):
        message = f"{wrong:g} s after 1970 is no date of a frame"
        assert told(lambda wrong=wrong: first_whole_second(np.array([wrong]))) == message


# Clocks of tracks


@pytest.mark.parametrize(
    ("own", "given", "ahead"),
    [
        ("utc", None, 0), ("utc", "utc", 0), ("utc", "gps", 18), ("gps", None, 18),
        ("gps", "gps", 18), ("gps", "utc", 0), ("utc-column", "utc", 0), ("utc-column", "gps", 18),
        ("seconds", None, 0), ("seconds", "seconds", 0),
        ("utc-column", None, "is needed: utc, gps"), ("utc", "seconds", "the file's times are utc"),
        ("gps", "seconds", "the file's times are gps"),
        ("seconds", "utc", "the file's times are seconds"),
        ("seconds", "gps", "the file's times are seconds"),
        ("utc-column", "seconds", "'seconds' is not known; known are utc, gps"),
        ("utc", "local", "'local' is not known; known are utc, gps, seconds"),
    ],
)  # fmt: skip
def test_the_clock_of_a_track(own: str, given: str | None, ahead: Any) -> None:
    """On the frames' clock, whose zero is the epoch; seconds stay as they are."""
    section = keys(**({} if given is None else {"clock": given}))
    start = EPOCH.timestamp()
    rows = track(own, start + 1.0, start + 2.5)
    if isinstance(ahead, str):
        said = told(lambda: track_clock(section, rows))
        assert said.startswith(f"p.toml: [track] clock: {ahead}")
        return
    assert track_clock(section, rows).tolist() == [start + 1.0 - ahead, start + 2.5 - ahead]
    times = FrameTimes(np.zeros(1), (), EPOCH)
    zero = start if own != "seconds" else 0.0
    found = track_on_clock(section, rows, times)
    assert found.tolist() == [start - zero + 1.0 - ahead, start - zero + 2.5 - ahead]
    if own != "seconds":
        assert told(lambda: track_on_clock(section, rows, times._replace(epoch=None))) == (
            "p.toml: [flight] epoch: is needed: the track is in UTC, and the frames are in seconds"
        )


@pytest.mark.parametrize(
    ("day", "ahead"),
    [
        ((2026, 5, 1), 18), ((2017, 1, 1), 18), ((2016, 12, 31), 17), ((2015, 7, 1), 17),
        ((2015, 6, 30), 16), ((2012, 7, 1), 16), ((2012, 6, 30), 15), ((2009, 1, 1), 15),
        ((2008, 12, 31), 14), ((2006, 1, 1), 14), ((2005, 12, 31), None),
    ],
)  # fmt: skip
def test_leap_seconds_are_those_of_the_first_position(day: Any, ahead: int | None) -> None:
    """A track that goes over a leap second keeps what it began with."""
    start = datetime(*day, tzinfo=UTC).timestamp()
    rows = track("gps", start, start + 4e8)
    if ahead is None:
        assert told(lambda: track_clock(keys(), rows)) == (
            "p.toml: [track] clock: GPS time before 2006 is not known: give UTC"
        )
    else:
        assert track_clock(keys(), rows).tolist() == [start - ahead, start + 4e8 - ahead]
