"""A plain with five landmarks, and a camera that flies over it, drawn frame by frame."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from tests.kit.drawn_ground import EARTH_M, LENS, NADIR, SIZE, drawn
from tools.render_video import geodetic
from vopd.arrays import Floats
from vopd.flight.flight import CameraPath, LandmarkSet, Refraction, Shutter
from vopd.tracking.scene import Scene, turn_between
from vopd.tracking.tracker import ClickedPixels, Tracker

PLACES = {
    "a": (-60.0, 40.0), "b": (55.0, 45.0), "c": (-50.0, -45.0), "d": (60.0, -40.0), "e": (5.0, 0.0)
}  # fmt: skip
EVERY = [(0, mark, 0.0, 0.0) for mark in range(len(PLACES))]

READOUT = 'readout = "down"\nframe_time = "first-row"\n'
PROJECT = """[flight]
name = "plain"
[camera]
image_size_px = {size}
lens = {{ model = "brown", fx_px = 1000.0, fy_px = 1000.0, cx_px = 100.0, cy_px = 80.0 }}
pixel_grid = "centre"
{readout}[picks]
file = "clicks.csv"
pixel_grid = "centre"
video = "images"
tracked = "tracked.csv"
frame_rate_hz = 10.0
first_frame_t_s = 0.0
[landmarks]
file = "landmarks.csv"
height = "ellipsoid"
sigma_m = "exact"
[track]
file = "track.csv"
height = "ellipsoid"
clock = "seconds"
sigma_m = "exact"
sigma_t_s = "exact"
{arm}[atmosphere]
refraction = "off"
"""


class Plain:
    """F frames of a camera 1000 m above a plain with five landmarks, which turns as it goes on.

    Between frames it goes 4 m to the east; by frame n it has turned by `turn` times a power of n,
    radians about its own axes. Rows of a rolling shutter are drawn each by its own place and
    attitude. The antenna is `lever_m` from the camera, along its own axes.
    """

    def __init__(
        self,
        frames: int,
        turn: tuple[float, float, float],
        readout_s: float = 0.0,
        power: float = 1.0,
        lever_m: tuple[float, float, float] | None = None,
    ) -> None:
        self.turn, self.readout_s, self.power = np.array(turn), readout_s, power
        own = np.array(list(PLACES.values()))
        marks = np.column_stack([np.full(len(own), EARTH_M), own - own.mean(axis=0)])
        self.mark_m = np.column_stack([marks[:, 1:], np.zeros(len(own))])
        self.time_s = np.arange(frames) / 10.0
        rotation, place = self.at(self.time_s)
        arm = None if lever_m is None else np.array(lever_m)
        if arm is not None:  # it leads from the antenna to the camera
            place = place - arm @ rotation
        place = place[:, [2, 0, 1]] + [EARTH_M, 0.0, 0.0]
        speed = np.tile([0.0, 40.0, 0.0], (frames, 1))
        shutter = Shutter(readout_s, "down", False) if readout_s else None
        landmarks = LandmarkSet(tuple(PLACES), marks, np.zeros((len(own), 3)))
        path = CameraPath(place, velocity_m_s=speed, lever_arm_m=arm)
        self.scene = Scene(LENS, path, landmarks, Refraction(0.0, False), np.eye(3), shutter)

    def at(self, time_s: Floats) -> tuple[Floats, Floats]:
        """Attitudes (..., 3, 3) and places (..., 3) at some times."""
        angle = np.multiply.outer((np.asarray(time_s) * 10.0) ** self.power, self.turn)
        turned = Rotation.from_rotvec(angle.reshape(-1, 3)).as_matrix().reshape(*angle.shape, 3)
        place = np.zeros(angle.shape)
        place[..., 0], place[..., 2] = 40.0 * np.asarray(time_s), 1000.0
        return turned @ NADIR, place

    def grey(self, frame: int, change: str = "") -> Floats:
        """Draw a frame: as it is, black, or with another ground at the landmarks or around them.

        The names of landmarks change the ground there alone; all: everywhere.
        """
        rotation, place = self.at(self.time_s[frame] + self.readout_s * np.arange(161) / 160.0)
        v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
        ray = np.stack([(u - 100.0) / 1000.0, (v - 80.0) / 1000.0, np.ones_like(u)], axis=-1)
        ray = np.einsum("rij,rci->rcj", rotation, ray)
        on_it = place[:, None] - ray * (place[:, None, 2:] / ray[..., 2:])
        each = np.linalg.norm(on_it[:, :, None] - self.mark_m, axis=-1)
        away = each.min(axis=-1)
        other = {"marks": away < 18.0, "around": away > 20.0, "black": away >= 0.0}
        other["all"] = other["black"]
        grey = drawn(100.0 + on_it[..., 0], 80.0 - on_it[..., 1])
        if change:
            ground = drawn(400.0 - on_it[..., 1], 300.0 + on_it[..., 0]) * (change != "black")
            own = each[..., [name in change for name in PLACES]].min(axis=-1, initial=99.0) < 18.0
            grey = np.where(other.get(change, own), ground, grey)
        return grey

    def pixel(self, frame: int, mark: int) -> Floats:
        """Find where a frame has a landmark, (2,)."""
        late = 0.0
        for _ in range(6):
            rotation, place = self.at(self.time_s[frame] + late)
            ray = rotation @ (self.mark_m[mark] - place)
            found = 1000.0 * ray[:2] / ray[2] + [100.0, 80.0]
            late = self.readout_s * found[1] / 160.0
        return np.asarray(found)

    def tracker(self, *clicks: tuple[float, ...], **options: Any) -> Tracker:
        """Make a tracker of clicks: frame, landmark, by how much they are off, and their sigma."""
        frame, mark = (np.array([int(one[k]) for one in clicks]) for k in (0, 1))
        pixel = np.array([self.pixel(int(f), int(m)) + off[:2] for f, m, *off in clicks])
        sigma_px = np.array([(*one, 1.0)[4] for one in clicks])
        own = ClickedPixels(frame, mark, pixel, sigma_px)
        return Tracker(
            self.scene, own, self.time_s, **{"patch_px": np.full(len(PLACES), 25)} | options
        )

    def pictures(self, **changed: Collection[int]) -> list[tuple[int, Floats]]:
        """Draw all frames, those of each change that are given by its name."""
        of = {k: change for change, frames in changed.items() for k in frames}
        return [(k, self.grey(k, of.get(k, ""))) for k in range(len(self.time_s))]

    def run(self, *clicks: tuple[float, ...], **changed: Collection[int]) -> Tracker:
        """Run forward from clicks, as those of `tracker`, through `pictures`."""
        tracker = self.tracker(*clicks)
        assert len(list(tracker.forward(self.pictures(**changed), {}))) == len(self.time_s)
        return tracker

    def write(self, folder: Path, *clicks: tuple[float, ...], **changed: Collection[int]) -> Path:
        """Write a project with the frames as images, and clicks as those of `tracker`.

        A sixth landmark, which nobody clicks, is 10 m north of the fifth.
        """
        (folder / "images").mkdir()
        for k, grey in self.pictures(**changed):
            Image.fromarray(np.round(grey).astype(np.uint8)).save(folder / "images" / f"f_{k}.png")
        names, scene = [*PLACES, "f"], self.scene
        marks_m = scene.landmarks.position_m
        marks = geodetic(np.vstack([marks_m, marks_m[4] + np.array([0.0, 0.0, 10.0])]))
        table = ["landmark,lat_deg,lon_deg,h_m,patch_px"]
        for name, (lat, lon, h), side in zip(names, marks, ("", 17, "", 13, "", ""), strict=True):
            table.append(f"{name},{lat:.11f},{lon + 9.0:.11f},{h:.5f},{side}")
        (folder / "landmarks.csv").write_text("\n".join([*table, ""]))
        table = ["t_s,lat_deg,lon_deg,h_m"]
        for time_s, place in zip(self.time_s, geodetic(scene.path.position_m), strict=True):
            table.append(f"{time_s},{place[0]:.11f},{place[1] + 9.0:.11f},{place[2]:.5f}")
        (folder / "track.csv").write_text("\n".join([*table, ""]))
        table = ["frame,landmark,u_px,v_px,sigma_px"]
        for frame, mark, right, down, *sigma in clicks:
            u, v = self.pixel(int(frame), int(mark)) + np.array([right, down])
            table.append(f"{frame},{names[int(mark)]},{u:.3f},{v:.3f},{[*sigma, 1.0][0]}")
        (folder / "clicks.csv").write_text("\n".join([*table, ""]))
        shutter, arm = f"{READOUT}readout_ms = {1000.0 * self.readout_s}\n", scene.path.lever_arm_m
        text = PROJECT.format(
            size=list(SIZE), readout=shutter * bool(self.readout_s),
            arm="" if arm is None else f"lever_arm_m = {arm.tolist()}\n",
        )  # fmt: skip
        (folder / "flight.toml").write_text(text)
        return folder / "flight.toml"

    def off_px(self, tracker: Tracker) -> Floats:
        """By how many pixels attitudes are off, rotations about the lens at 100 px from it (F,)."""
        true, _ = self.at(self.time_s)
        off = [turn_between(*pair) for pair in zip(tracker.attitudes.rotation, true, strict=True)]
        return np.linalg.norm(np.array(off) * [1000.0, 1000.0, 100.0], axis=1)
