"""Landmarks followed in a video that is mirrored, turned, or otherwise counted: the same tracks.

One frame shows nothing, one landmark is covered for a while, and one click is on another point, so
that there are tracks of each kind and something to say.
"""

from __future__ import annotations

import contextlib
import csv
import re
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import av
import numpy as np
import pytest
from PIL import Image

from tests.kit.command import vopd
from tests.tolerances import assert_close
from tools.render_video import Settings, make
from vopd.flight.result import solve_flight
from vopd.video import open_frames, presentation

FRAMES, SIZE = 6, (320, 180)
NOTHING, COVERED = 4, (5,)  # the frame of noise, and that in which L4 is covered
OFF_PX = 12.0  # of the click of L1 in frame 2


def change(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.count(old) == 1, old
    file.write_text(text.replace(old, new), encoding="utf-8")


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Render a video, with its frames as images beside it."""
    folder = tmp_path_factory.mktemp("rendered") / "base"
    make(folder, Settings(seed=4, size=SIZE, frames=FRAMES, clicks=8, key_frames=8, mbit_s=1.5))
    change(folder / "flight.toml", 'times = "video"', 'times = "video"\ntracked = "tracked.csv"')
    return folder


class Turn(NamedTuple):
    """How a picture is turned.

    Attributes:
        picture: the picture of one
        matrix: what it makes of right and down, (2, 2)
        corner: where it puts the first pixel
    """

    picture: Callable[[Any], Any]
    matrix: tuple[tuple[int, int], tuple[int, int]]
    corner: tuple[int, int]

    def pixel(self, u: float, v: float) -> Any:
        return np.array(self.matrix) @ [u, v] + self.corner


AS_IT_IS = Turn(lambda one: one, ((1, 0), (0, 1)), (0, 0))
TURNS = {
    "mirrored": Turn(np.fliplr, ((-1, 0), (0, 1)), (SIZE[0] - 1, 0)),
    "portrait": Turn(lambda one: np.rot90(one, -1), ((0, -1), (1, 0)), (SIZE[1] - 1, 0)),
}


def project(base: Path, how: str) -> Path:
    """Make images of the video, of which some are painted, and turn them with the project."""
    folder = base.parent / how
    shutil.copytree(base, folder)
    turn, tens = TURNS.get(how, AS_IT_IS), 10 if how == "recounted" else 1
    (folder / "images").mkdir()
    for k, picture in open_frames([str(folder / "video.mp4")]).decoded(0, FRAMES):
        grey = np.asarray(picture)[..., 0].copy()
        if k == NOTHING:
            grey[:] = np.random.default_rng(k).integers(90, 110, grey.shape)
        if k in COVERED:
            grey[82:122, 64:104] = 128
        Image.fromarray(turn.picture(grey)).save(folder / "images" / f"{tens * k}.png")
    change(folder / "flight.toml", '"video.mp4"', '"images"')
    change(folder / "flight.toml", 'times = "video"', f"frame_rate_hz = {30.0 * tens}")
    text = (folder / "flight.toml").read_text(encoding="utf-8")
    cx, cy = (float(text.partition(f"{name} = ")[2].split(",")[0]) for name in ("cx_px", "cy_px"))
    centre = turn.pixel(cx, cy)
    change(
        folder / "flight.toml",
        f"cx_px = {cx}, cy_px = {cy}",
        f"cx_px = {centre[0]}, cy_px = {centre[1]}",
    )
    size = np.abs(turn.matrix) @ SIZE
    change(folder / "flight.toml", f"[{SIZE[0]}, {SIZE[1]}]", f"[{size[0]}, {size[1]}]")
    clicks = table(folder / "clicks.csv")
    for row in clicks:
        wrong = OFF_PX if (row["frame"], row["landmark"]) == ("2", "L1") else 0.0
        u, v = turn.pixel(float(row["u_px"]) + wrong, float(row["v_px"]))
        row |= {
            "frame": str(tens * int(row["frame"])),
            "u_px": repr(float(u)),
            "v_px": repr(float(v)),
        }
    write(folder / "clicks.csv", clicks[::-1] if how == "recounted" else clicks)
    for name in ("landmarks.csv", "track.csv"):
        rows = table(folder / name)
        for row in rows:
            if how == "mirrored":
                row["lon_deg"] = f"-{row['lon_deg']}"
        write(folder / name, rows)
    return folder


def table(file: Path) -> list[dict[str, str]]:
    lines = file.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def write(file: Path, rows: list[dict[str, str]]) -> None:
    with file.open("w", encoding="utf-8", newline="") as text:
        writer = csv.DictWriter(text, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


class Tracked(NamedTuple):
    """What is tracked, what is said, # for its numbers, and the camera's angles in each frame."""

    rows: list[dict[str, str]]
    said: str
    camera_deg: Any


@cache
def tracked(base: Path, how: str) -> Tracked:
    folder = project(base, how)
    with contextlib.chdir(folder):
        ran = vopd("track", "flight.toml")
        solved = solve_flight("flight.toml")
    assert ran.status == 3
    said = "\n".join([ran.stderr, *(one.message for one in solved.findings)])
    tens = 10 if how == "recounted" else 1
    said = re.sub(r"(?<=frame )\d+", lambda one: f"{int(one[0]) / tens:g}", said)
    text = re.sub(r"(?<!L|\d|\.)(?<!frame )[+-]?\d[\d.]*", "#", said)
    return Tracked(table(folder / "tracked.csv"), text, solved.camera_deg)


def by_click(row: dict[str, str]) -> Any:
    return np.reshape([float(row[name]) for name in ("duu", "duv", "dvu", "dvv")], (2, 2))


@pytest.mark.parametrize("how", [*TURNS, "recounted"])
def test_the_tracks_are_the_same(how: str, base: Path) -> None:
    """Places, and how they answer to their clicks, are turned; all else stays.

    Recounted are images that are numbered by tens, with clicks in another order.
    """
    (rows, said, angles), (found, again, turned) = tracked(base, "plain"), tracked(base, how)
    turn, tens = TURNS.get(how, AS_IT_IS), 10 if how == "recounted" else 1
    assert again == said and "fewer than two" in said
    assert "L1 is clicked" in said and "the click of L1 does not fit" in said
    yaw, pitch, roll = angles.T
    expected = {"mirrored": (-yaw, pitch, -roll), "portrait": (yaw, pitch, roll - 90.0)}
    away = np.array(expected.get(how, (yaw, pitch, roll))).T - turned
    assert len(away) == FRAMES - 1
    assert_close("attitude of a turned video", (away + 180.0) % 360.0 - 180.0, 0.0 * away)
    assert {row["status"] for row in rows} == {"clicked", "tracked", "occluded", "lost"}
    of_name = {(row["frame"], row["landmark"], row["from_frame"]): row for row in found}
    assert len(of_name) == len(found) == len(rows)
    matrix = np.array(turn.matrix)
    for row in rows:
        frames = [
            str(tens * int(row[name])) if row[name] else "" for name in ("frame", "from_frame")
        ]
        other = of_name[frames[0], row["landmark"], frames[1]]
        assert other["status"] == row["status"] and (other["u_px"] == "") == (row["u_px"] == "")
        if row["u_px"]:
            pixel, seen = (
                np.array([float(one["u_px"]), float(one["v_px"])]) for one in (row, other)
            )
            assert_close("track of a turned video", seen, turn.pixel(*pixel))
            expected = matrix @ by_click(row) @ matrix.T
            assert_close("track of a turned video", by_click(other), expected)
            for name in ("sigma_px", "correlation"):
                numbers = [float(one[name] or 0.0) for one in (other, row)]
                assert_close("track of a turned video", *numbers)


def test_a_video_may_begin_at_any_time(base: Path) -> None:
    """A copy whose first frame is shown 3003 ticks of 1/90000 s later has the same tracks."""
    said = []
    for name in ("video.mp4", "later.mp4"):
        folder = base.parent / name
        shutil.copytree(base, folder)
        if name == "later.mp4":
            with (
                av.open(str(base / "video.mp4")) as first,
                av.open(str(folder / name), "w") as later,
            ):
                stream = later.add_stream_from_template(first.streams.video[0])
                for packet in first.demux(video=0):
                    if packet.dts is not None:
                        packet.pts, packet.dts = packet.pts + 3003, packet.dts + 3003
                        packet.stream = stream
                        later.mux(packet)
            change(folder / "flight.toml", '"video.mp4"', f'"{name}"')
        with contextlib.chdir(folder):
            ran = vopd("track", "flight.toml", "--to", "0.1")
        said.append((ran.status, ran.stderr.replace(name, ""), table(folder / "tracked.csv")))
    assert presentation(folder / name)[0][0] > 0
    assert said[0] == said[1] and {row["frame"] for row in said[0][2]} == {"0", "1", "2", "3"}
