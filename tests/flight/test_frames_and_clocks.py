"""Times of frames by rate, table or track; clocks; the path at images that have positions."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.frame_times import FrameTimes, first_whole_second, frames_of
from vopd.flight.path_by_image import _rows_of_images, path_by_image, times_of_track
from vopd.flight.pick_formats.pick_rows import Names, PickRows
from vopd.flight.project_file import Project, Section
from vopd.flight.track_clock import track_clock, track_on_clock
from vopd.flight.track_formats.dji_mrk import photo_number
from vopd.flight.track_formats.track_rows import TrackRows
from vopd.geometry.geodetic import earth_centred_m

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


def test_zero_is_a_whole_second() -> None:
    start = EPOCH.timestamp()
    for given in ([0.25, 5.0], [np.nan, 0.25], [7.0, 0.999], [0.0, np.nan]):
        assert first_whole_second(start + np.array(given)) == EPOCH
    assert first_whole_second(np.array([-0.5])) == datetime(1969, 12, 31, 23, 59, 59, tzinfo=UTC)
    for wrong in (1e18, 1e300, -1e15):
        message = f"{wrong:g} s after 1970 is no date of a frame"
        assert told(lambda wrong=wrong: first_whole_second(np.array([wrong]))) == message


# Clocks of tracks


def track(clock: str | None, *time_s: float, image: tuple[str, ...] = (), **more: Any) -> TrackRows:
    position = np.zeros((len(time_s), 3))
    times = None if clock is None else np.array(time_s)
    return TrackRows(position, True, None, clock, times, "", [*image], **more)


def keys(**values: Any) -> Section:
    return Section("p.toml", "track", values)


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


# Positions of images


def test_rows_of_images_by_name() -> None:
    """By the whole name, and else by what stands behind its last slash."""
    rows = track(None, 0, 0, 0, image=("b.jpg", "x/a.jpg", "a.jpg"))
    found = _rows_of_images(keys(), rows, ("x/a.jpg", "y/a.jpg", "b.jpg", "z/b.jpg", "c.jpg"))
    assert found.tolist() == [1, 2, 0, 0, -1]
    photos = track(None, 0, 0, image=("29", "7"), image_key=photo_number)
    found = _rows_of_images(keys(), photos, ("MAX_0007.JPG", "d/MAX_0029.JPG", "MAX_0030.JPG"))
    assert found.tolist() == [1, 0, -1]
    assert told(lambda: _rows_of_images(keys(), rows, ())) == (
        "p.toml: [track] file: has positions by image, and the picks have frame numbers"
    )
    doubled = track(None, 0, 0, 0, 0, image=("a", "c", "b", "c"))
    assert told(lambda: _rows_of_images(keys(), doubled, ("a",))) == (
        "p.toml: [track] file: c has two positions"
    )


@pytest.mark.parametrize(
    ("clock", "given", "late", "zero"),
    [("utc", None, 1.75, 3), ("utc", EPOCH, 4.75, 0), ("gps", EPOCH, -13.25, 0),
     ("utc-column", EPOCH, 4.75, 0), ("utc-column", None, 1.75, 3), ("gps", None, 1.75, -15)],
)  # fmt: skip
def test_frames_have_the_times_of_their_images(
    clock: str, given: Any, late: float, zero: int
) -> None:
    """Images at 4.75 and 3.25 s past the epoch: zero is 3 s past it, or the epoch."""
    start = EPOCH.timestamp()
    rows = track(clock, start + 4.25, start + 2.75, image=("b", "a"))
    section = keys(offset_s=0.5, **({"clock": "utc"} if clock == "utc-column" else {}))
    unknown = FrameTimes(np.full(3, np.nan), ("a", "b", "c"), given)
    times, own = times_of_track(section, rows, unknown)
    assert own is not None and own.tolist() == [late, late - 1.5]
    assert np.array_equal(times.time_s, [late - 1.5, late, np.nan], equal_nan=True)
    assert times.epoch == EPOCH + timedelta(seconds=zero)
    some = unknown._replace(time_s=np.array([np.nan, 5.0, np.nan]))
    assert times_of_track(section, rows, some)[0].time_s[1] == 5.0
    assert np.isnan(times_of_track(section, rows, some)[0].time_s[0])
    assert times_of_track(keys(), track(None, 0.0, image=("a",)), unknown) == (unknown, None)


def test_the_path_at_images() -> None:
    """Rows by their names; what is not there is NaN in all columns; the file's own speed counts."""
    position = earth_centred_m([47.0, 48.0, 49.0], [16.0] * 3, [0.0] * 3)
    more = {
        "velocity_m_s": np.arange(9.0).reshape(3, 3),
        "gimbal_deg": 10.0 + np.arange(9.0).reshape(3, 3),
        "sigma_m": np.array([[3.0, 4.0, 5.0]] * 3),
    }  # fmt: skip
    rows = track(None, 0, 0, 0, image=("c", "a", "b"), **more)
    times = FrameTimes(np.zeros(3), ("a", "x", "c"), None)
    said: list[str] = []
    section = keys(lever_arm_m=[1, 2, 3])
    path = path_by_image(section, rows, position, times, np.array([0.0, 1.0, 2.0]), said)
    assert np.array_equal(
        path.position_m, position[[1, 0, 0]] * [[1], [np.nan], [1]], equal_nan=True
    )
    assert path.velocity_m_s is not None and path.gimbal_deg is not None
    assert np.array_equal(path.velocity_m_s, [[3, 4, 5], [np.nan] * 3, [0, 1, 2]], equal_nan=True)
    gimbal = [[13, 14, 15], [np.nan] * 3, [10, 11, 12]]
    assert np.array_equal(path.gimbal_deg, gimbal, equal_nan=True) and said == []
    assert_close("ratio", path.sigma_m, [3.0, 4.0, 5.0])
    assert path.lever_arm_m is not None and path.lever_arm_m.tolist() == [1.0, 2.0, 3.0]
    plain = path_by_image(keys(sigma_m=2), track(None, 0, 0, 0, image=("c", "a", "b")), position,
                          times, None, said)  # fmt: skip
    assert plain.velocity_m_s is None and plain.gimbal_deg is None and plain.lever_arm_m is None
    assert plain.sigma_m.tolist() == [2.0] * 3 and said == []


def test_speeds_of_images_are_north_east_down_at_the_image() -> None:
    """20 m north, 10 m east and 5 m up in 2 s, in the order of time and not of the file."""
    start = earth_centred_m(0.0, 0.0, 0.0)  # x up, y east, z north
    step = np.array([5.0, 10.0, 20.0])
    position = start + np.outer([2.0, 0.0, 1.0], step)
    rows = track("utc", 0.0, 0.0, 0.0, image=("c", "a", "b"))
    times = FrameTimes(np.zeros(4), ("a", "b", "c", "d"), None)
    said: list[str] = []
    path = path_by_image(keys(), rows, position, times, np.array([4.0, 0.0, 2.0]), said)
    assert path.velocity_m_s is not None
    assert_close("flight speed", path.velocity_m_s[:3], [[10.0, 5.0, -2.5]] * 3)
    assert np.isnan(path.velocity_m_s[3]).all()
    assert said == ["velocity by the differences of the images' positions"]
    whole = track("utc", 0.0, 0.0, 0.0, image=("c", "a", "b"), whole_seconds=True)
    path = path_by_image(keys(), whole, position, times, np.array([4.0, 0.0, 2.0]), said)
    assert path.velocity_m_s is None
    assert said[1:] == ["no velocity: the images' times are whole seconds, or too few, or alike"]
