"""Where the camera was in each frame by a track that has positions of images."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.flight.flight import CameraPath
from vopd.flight.frame_times import FrameTimes, first_whole_second
from vopd.flight.path_keys import lever_arm, path_sigma
from vopd.flight.project import Section
from vopd.flight.track_clock import track_clock
from vopd.flight.track_formats.track_rows import TrackRows
from vopd.geometry.earth import local_axes
from vopd.geometry.local_axes import NED_FROM_ENU


def times_of_track(
    section: Section, rows: TrackRows, times: FrameTimes
) -> tuple[FrameTimes, Floats | None]:
    """The frames' times, by the track where nothing else has them, and the track's own (T,)."""
    if rows.time_s is None:
        return times, None
    time_s = track_clock(section, rows) + section.number("offset_s", 0.0)
    if rows.clock != "seconds":
        times = times._replace(epoch=times.epoch or first_whole_second(time_s))
        assert times.epoch is not None
        time_s = time_s - times.epoch.timestamp()
    if not np.isfinite(times.time_s).any():
        row = _rows_of_images(section, rows, times.image)
        times = times._replace(time_s=np.where(row >= 0, time_s[row], np.nan))
    return times, time_s


def _rows_of_images(section: Section, rows: TrackRows, image: tuple[str, ...]) -> Ints:
    """The index of each image's row, -1 where there is none; folders in names do not count."""
    if not image:
        raise section.error("file", "has positions by image, and the picks have frame numbers")
    index = {name: k for k, name in enumerate(rows.image)}
    if len(index) < len(rows.image):
        doubled = next(name for name in rows.image if rows.image.count(name) > 1)
        raise section.error("file", f"{doubled} has two positions")
    keys = [(rows.image_key(name), rows.image_key(name.rpartition("/")[2])) for name in image]
    return np.array([index.get(name, index.get(last, -1)) for name, last in keys])


def path_by_image(
    section: Section,
    rows: TrackRows,
    position: Floats,
    times: FrameTimes,
    time_s: Floats | None,
    said: list[str],
) -> CameraPath:
    """The camera's path at the images that were picked.

    Args:
        section: `[track]`
        rows: the track
        position: its positions, Earth-centred, (T, 3)
        times: of the frames, with the names of their images
        time_s: of the track's positions on the frames' clock, (T,), where it has times
        said: sentences about what was read, to be added to
    """
    found = _rows_of_images(section, rows, times.image)
    missing = (found < 0)[:, None]
    here = np.where(missing, np.nan, position[found])
    velocity = None if rows.velocity_m_s is None else rows.velocity_m_s[found]
    if velocity is None and time_s is not None:
        speed = _speed(rows, position, time_s, said)
        if speed is not None:
            velocity = np.einsum("fij,fj->fi", NED_FROM_ENU @ local_axes(here), speed[found])
    gimbal = None
    if rows.gimbal_deg is not None:
        gimbal = np.where(missing, np.nan, rows.gimbal_deg[found])
    return CameraPath(
        here,
        path_sigma(section, rows),
        velocity_m_s=None if velocity is None else np.where(missing, np.nan, velocity),
        lever_arm_m=lever_arm(section),
        gimbal_deg=gimbal,
    )


def _speed(rows: TrackRows, position: Floats, time_s: Floats, said: list[str]) -> Floats | None:
    """Velocity (T, 3), Earth-centred, at images that have times; none by whole seconds."""
    order = np.argsort(time_s, kind="stable")
    if rows.whole_seconds or len(order) < 2 or not (np.diff(time_s[order]) > 0.0).all():
        said.append("no velocity: the images' times are whole seconds, or too few, or alike")
        return None
    speed = np.empty_like(position)
    speed[order] = np.gradient(position[order], time_s[order], axis=0)
    said.append("velocity by the differences of the images' positions")
    return speed
