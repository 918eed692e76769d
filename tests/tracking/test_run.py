"""Runs of the tracker over drawn frames of a plain: wrong clicks, clicks anew, and losses."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.drawn_ground import EARTH_M, LENS, NADIR, SIZE, drawn
from tests.tolerances import within
from vopd.arrays import Floats
from vopd.flight.flight import CameraPath, LandmarkSet, Refraction, Shutter
from vopd.tracking import tracker as rooms
from vopd.tracking.scene import Scene, turn_between
from vopd.tracking.tracker import (
    AMBIGUOUS,
    CLICKED,
    EDGE,
    FOUND,
    LOST,
    TRACKED,
    UNKNOWN,
    Beginning,
    ClickedPixels,
    Tracker,
)

PLACES = {
    "a": (-60.0, 40.0), "b": (55.0, 45.0), "c": (-50.0, -45.0), "d": (60.0, -40.0), "e": (5.0, 0.0)
}  # fmt: skip
EVERY = [(0, mark, 0.0, 0.0) for mark in range(len(PLACES))]


class Plain:
    """F frames of a camera 1000 m above a plain with five landmarks, which turns as it goes on.

    Between frames it goes 4 m to the east; by frame n it has turned by `turn` times a power of n,
    radians about its own axes. Rows of a rolling shutter are drawn each by its own place and
    attitude.
    """

    def __init__(
        self,
        frames: int,
        turn: tuple[float, float, float],
        readout_s: float = 0.0,
        power: float = 1.0,
    ) -> None:
        self.turn, self.readout_s, self.power = np.array(turn), readout_s, power
        own = np.array(list(PLACES.values()))
        marks = np.column_stack([np.full(len(own), EARTH_M), own - own.mean(axis=0)])
        self.mark_m = np.column_stack([marks[:, 1:], np.zeros(len(own))])
        place = np.array([[EARTH_M + 1000.0, 4.0 * k, 0.0] for k in range(frames)])
        speed = np.tile([0.0, 40.0, 0.0], (frames, 1))
        shutter = Shutter(readout_s, "down", False) if readout_s else None
        landmarks = LandmarkSet(tuple(PLACES), marks, np.zeros((len(own), 3)))
        path = CameraPath(place, velocity_m_s=speed)
        self.scene = Scene(LENS, path, landmarks, Refraction(0.0, False), np.eye(3), shutter)
        self.time_s = np.arange(frames) / 10.0

    def at(self, time_s: Floats) -> tuple[Floats, Floats]:
        """Attitudes (..., 3, 3) and places (..., 3) at some times."""
        angle = np.multiply.outer((np.asarray(time_s) * 10.0) ** self.power, self.turn)
        turned = Rotation.from_rotvec(angle.reshape(-1, 3)).as_matrix().reshape(*angle.shape, 3)
        place = np.zeros(angle.shape)
        place[..., 0], place[..., 2] = 40.0 * np.asarray(time_s), 1000.0
        return turned @ NADIR, place

    def grey(self, frame: int, change: str = "") -> Floats:
        """Draw a frame: as it is, black, or with another ground at the landmarks or around them."""
        rotation, place = self.at(self.time_s[frame] + self.readout_s * np.arange(161) / 160.0)
        v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
        ray = np.stack([(u - 100.0) / 1000.0, (v - 80.0) / 1000.0, np.ones_like(u)], axis=-1)
        ray = np.einsum("rij,rci->rcj", rotation, ray)
        on_it = place[:, None] - ray * (place[:, None, 2:] / ray[..., 2:])
        away = np.linalg.norm(on_it[:, :, None] - self.mark_m, axis=-1).min(axis=-1)
        other = {"marks": away < 18.0, "around": away > 20.0, "black": away >= 0.0}
        grey = drawn(100.0 + on_it[..., 0], 80.0 - on_it[..., 1])
        if change:
            ground = drawn(400.0 - on_it[..., 1], 300.0 + on_it[..., 0]) * (change != "black")
            grey = np.where(other[change], ground, grey)
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

    def run(self, *clicks: tuple[int, int, float, float], **changed: Collection[int]) -> Tracker:
        """Run forward from clicks: frame, landmark, and by how much they are off, right and down.

        Frames of each change are given by its name.
        """
        frame, mark = (np.array([one[k] for one in clicks]) for k in (0, 1))
        pixel = np.array([self.pixel(f, m) + off for f, m, *off in clicks])
        own = ClickedPixels(frame, mark, pixel, np.ones(len(clicks)))
        tracker = Tracker(self.scene, own, self.time_s, np.full(len(PLACES), 25))
        of = {k: change for change, frames in changed.items() for k in frames}
        pictures = ((k, self.grey(k, of.get(k, ""))) for k in range(len(self.time_s)))
        assert len(list(tracker.forward(pictures, {}))) == len(self.time_s)
        return tracker

    def off_px(self, tracker: Tracker) -> Floats:
        """By how many pixels attitudes are off, rotations about the lens at 100 px from it (F,)."""
        true, _ = self.at(self.time_s)
        off = [turn_between(*pair) for pair in zip(tracker.attitudes.rotation, true, strict=True)]
        return np.linalg.norm(np.array(off) * [1000.0, 1000.0, 100.0], axis=1)


@pytest.mark.parametrize("readout_s", [0.0, 0.08])
def test_a_wrong_click_spoils_no_frame(readout_s: float) -> None:
    """The fifth of the first frame is 47 px off."""
    plain = Plain(4, (0.003, -0.002, 0.01), readout_s)
    for last in (EVERY[4], (0, 4, 40.0, 25.0)):
        tracker = plain.run(*EVERY[:4], last)
        assert tracker.attitudes.known.tolist() == [TRACKED] * 4
        assert plain.off_px(tracker).max() < within("running attitude")


def test_clicks_that_agree_with_each_other_alone_begin_anew() -> None:
    """Those of frame 3 are all 30 px to the right; or each elsewhere, which tells nothing."""
    plain = Plain(5, (0.003, -0.002, 0.01))
    tracker = plain.run(*EVERY, *((3, mark, 30.0, 0.0) for mark in range(5)))
    assert tracker.beginnings == [Beginning(0, -1), Beginning(3, 3)]
    apart = [(30.0, 0.0), (-30.0, 5.0), (0.0, 30.0), (5.0, -30.0), (20.0, 20.0)]
    tracker = plain.run(*EVERY, *((3, mark, *off) for mark, off in enumerate(apart)))
    assert tracker.beginnings == [Beginning(0, -1)]
    assert plain.off_px(tracker).max() < within("running attitude")


def test_from_where_a_track_was_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Black frames are hidden, and no cut before there are too many; so is ground that changes."""
    plain = Plain(9, (0.003, -0.002, 0.01))
    again = [(8, mark, 0.0, 0.0) for mark in range(5)]
    tracker = plain.run(*EVERY, *again, black=(2, 3))
    assert tracker.beginnings == [Beginning(0, -1)]
    assert tracker.attitudes.known[[1, 2, 3, 4]].tolist() == [TRACKED, UNKNOWN, UNKNOWN, TRACKED]
    monkeypatch.setattr(rooms, "HIDDEN", 2)
    tracker = plain.run(*EVERY, *again, black=range(3, 8))
    assert tracker.beginnings == [Beginning(0, -1), Beginning(8, 3)]
    monkeypatch.setattr(rooms, "PREDICTED", 3)
    tracker = plain.run(*EVERY, *again, marks=range(2, 8))
    assert tracker.beginnings == [Beginning(0, -1), Beginning(8, 2)]


def test_a_camera_that_turns_faster_and_faster_is_followed() -> None:
    """By 2 to 19 degrees from a frame to the next, which turns as before and a little more.

    In frame 4 the ground around the landmarks is another: three that agree are enough.
    """
    plain = Plain(7, (0.0, 0.0, 0.03), power=2.0)
    for around in ((), (4,)):
        tracker = plain.run(*EVERY, around=around)
        assert tracker.attitudes.known.tolist() == [TRACKED] * 7
        assert plain.off_px(tracker).max() < within("running attitude")
    plain = Plain(6, (0.0, 0.0, 0.12))  # 7 degrees a frame, and 21 behind two that are black
    tracker = plain.run(*EVERY, black=(3, 4))
    assert tracker.attitudes.known[5] == TRACKED
    assert plain.off_px(tracker)[5] < within("running attitude")


def statuses(plain: Plain, tracker: Tracker, *frames: int) -> list[list[int]]:
    """Match some frames with all clicks: the statuses of their rows."""
    wanted = np.isin(np.arange(len(plain.time_s)), frames)
    pictures = ((k, plain.grey(k)) for k in range(len(plain.time_s)))
    return [block["status"].tolist() for block in tracker.second(pictures, wanted)]


def test_the_rows_of_a_frame() -> None:
    """One for each landmark; two that come within 12 px of the edge, one that is not clicked."""
    plain = Plain(10, (0.0, 0.0, 0.005))
    tracker = plain.run(*EVERY[:4])
    first, *others = statuses(plain, tracker, 0, 5, 9)
    assert first == [CLICKED] * 4 + [LOST]
    assert others == [[FOUND] * 4 + [LOST], [EDGE, FOUND, EDGE, FOUND, LOST]]


def test_patches_may_be_off_by_the_error_of_either_place() -> None:
    """The clicked frame was 15 m higher than is known: at its corners .9 px."""
    plain = Plain(2, (0.0, 0.0, 0.005))
    plain.scene.path.position_m[0, 0] -= 15.0
    for sigma_m, expected in ((None, {FOUND, AMBIGUOUS}), (np.array([15.0, 0.01]), {FOUND})):
        plain.scene = replace(plain.scene, place_sigma_m=sigma_m)
        assert {*statuses(plain, plain.run(*EVERY), 1)[0]} == expected
