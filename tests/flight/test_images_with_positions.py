"""The path and the times of frames by a track that has positions of images."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import keys, track
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.track import photo_number
from vopd.flight.track import FrameTimes, _rows_of_images, path_by_image, times_of_track
from vopd.geometry.earth import earth_centred_m

EPOCH = datetime(2026, 5, 1, 12, tzinfo=UTC)


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refused:
        action()
    return str(refused.value)


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
    doubled = track(None, 0, 0, 0, 0, image=("b", "c", "b", "c"))
    assert told(lambda: _rows_of_images(keys(), doubled, ("c",))) == (
        "p.toml: [track] file: b has two positions"
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
    two = track("utc", 0.0, 0.0, image=("c", "a"))
    path = path_by_image(keys(), two, position[:2], times, np.array([4.0, 0.0]), [])
    assert path.velocity_m_s is not None
    assert_close("flight speed", path.velocity_m_s[[0, 2]], [[10.0, 5.0, -2.5]] * 2)
    whole = track("utc", 0.0, 0.0, 0.0, image=("c", "a", "b"), whole_seconds=True)
    path = path_by_image(keys(), whole, position, times, np.array([4.0, 0.0, 2.0]), said)
    assert path.velocity_m_s is None
    assert said[1:] == ["no velocity: the images' times are whole seconds, or too few, or alike"]
