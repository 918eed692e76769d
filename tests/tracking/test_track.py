"""`vopd track` on a rendered video with truth: rows, statuses, resumption, and bad input."""

from __future__ import annotations

import csv
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from tests.tolerances import within
from tools.render_video import Settings, make
from vopd.flight.project import read_project
from vopd.tracking import follow as rooms
from vopd.tracking.follow import TrackOptions, follow
from vopd.video import grey_frames

FRAMES, SIZE = 24, (320, 180)


@pytest.fixture(scope="session")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rendered")
    make(folder, Settings(seed=4, size=SIZE, frames=FRAMES, clicks=6, key_frames=8, mbit_s=1.5))
    project = folder / "flight.toml"
    text = project.read_text(encoding="utf-8").replace(
        'times = "video"', 'times = "video"\ntracked = "tracked.csv"'
    )
    project.write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def flight(rendered: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(rendered, tmp_path / "f")
    monkeypatch.chdir(tmp_path / "f")
    return tmp_path / "f"


def rows(path: Path) -> list[dict[str, str]]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def change(name: str, old: str, new: str) -> None:
    text = Path(name).read_text(encoding="utf-8")
    assert old in text
    Path(name).write_text(text.replace(old, new, 1), encoding="utf-8")


def clicks(*wanted: tuple[int, str, float, float]) -> None:
    head = Path("clicks.csv").read_text(encoding="utf-8").splitlines()[:2]
    lines = [f"{frame},{mark},{u},{v}" for frame, mark, u, v in wanted]
    Path("clicks.csv").write_text("\n".join([*head, *lines, ""]), encoding="utf-8")


def truth() -> dict[tuple[int, str], np.ndarray[Any, Any]]:
    return {
        (int(row["frame"]), row["landmark"]): np.array([float(row["u_px"]), float(row["v_px"])])
        for row in rows(Path("truth_picks.csv"))
    }


def test_tracks_against_the_truth(flight: Path) -> None:
    """Less its click's error a tracked pick is where the landmark is, in every frame."""
    done = vopd("track", "flight.toml")
    assert (done.status, done.stdout) == (0, "")
    true, found = truth(), rows(flight / "tracked.csv")
    own = {(int(r["frame"]), r["landmark"]): r for r in found if r["status"] == "clicked"}
    assert len(own) == 6
    off = []
    for row in found:
        assert (row["u_px"] == "") == (row["status"] not in ("clicked", "tracked"))
        if row["status"] == "tracked":
            click = int(row["from_frame"]), row["landmark"]
            at = np.array([float(own[click]["u_px"]), float(own[click]["v_px"])])
            matrix = np.array([float(row[name]) for name in ("duu", "duv", "dvu", "dvv")])
            place = np.array([float(row["u_px"]), float(row["v_px"])])
            carried = matrix.reshape(2, 2) @ (at - true[click])
            off.append(place - true[int(row["frame"]), row["landmark"]] - carried)
    assert len(off) > 80
    assert np.sqrt(np.mean(np.square(off))) < within("tracked pick")
    seen = {int(row["frame"]) for row in found}
    assert seen == set(range(FRAMES))
    assert not list(flight.glob("*.part"))
    asked = vopd("attitude", "flight.toml", "-o", "a.csv").stderr.splitlines()[-3:]
    assert all("flight.toml: click next: L" in line for line in asked)
    drawn = vopd("plot", "flight.toml", "--figure", "map", "-o", "a.svg")
    assert drawn.stderr.splitlines() == asked
    assert vopd("track", "flight.toml", "--every", "5", "--to", ".5").status == 0
    assert {int(row["frame"]) for row in rows(flight / "tracked.csv")} == {0, 5, 10, 15}


def test_a_lens_of_another_camera_is_doubtful(flight: Path) -> None:
    """With half the focal length landmarks are not where others have them."""
    text = Path("flight.toml").read_text(encoding="utf-8")
    change("flight.toml", re.findall(r"fx_px = [\d.]+", text)[0], "fx_px = 90.0")
    change("flight.toml", re.findall(r"fy_px = [\d.]+", text)[0], "fy_px = 90.0")
    done = vopd("track", "flight.toml")
    assert done.status == 3
    (told,) = [line for line in done.stderr.splitlines() if line.startswith("warning: ")]
    assert_approved(told.rpartition("L")[2].partition(": ")[2])  # after the landmarks' names


class Stopped(Exception):
    """What ends a run in the midst of it."""


def stopping_after(count: int) -> Callable[[], None]:
    left = iter(range(count))

    def tell() -> None:
        if next(left, None) is None:
            raise Stopped

    return tell


@pytest.mark.parametrize("at", [9, 17, 33])
def test_the_same_command_goes_on(flight: Path, at: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the first run and in the second one: the same bytes, from backward frames as well."""
    monkeypatch.setattr(rooms, "AT_ONCE", 4)
    true = truth()
    both = [(8, mark, *true[8, mark]) for mark in ("L1", "L2", "L4", "L5")]
    clicks(*both)
    project = read_project("flight.toml")
    follow(project, TrackOptions())
    whole = (flight / "tracked.csv").read_bytes()
    (flight / "tracked.csv").unlink()
    with pytest.raises(Stopped):
        follow(project, TrackOptions(), stopping_after(at))
    assert not (flight / "tracked.csv").exists()
    assert (flight / "tracked.csv.part").stat().st_size > 700  # blocks, and not the head alone
    follow(project, TrackOptions())
    assert (flight / "tracked.csv").read_bytes() == whole
    assert {int(row["frame"]) for row in rows(flight / "tracked.csv")} == set(range(FRAMES))


def frames_where(change_it: Callable[[int, Any], Any]) -> Callable[..., Iterator[tuple[int, Any]]]:
    """Frames of which some are changed."""

    def changed(*arguments: Any) -> Iterator[tuple[int, Any]]:
        for k, grey in grey_frames(*arguments):
            yield k, change_it(k, grey)

    return changed


def test_hidden_frames_and_a_hidden_landmark(flight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three frames of nothing are lost, and found again after them; one landmark is covered."""
    true = truth()

    def cover(k: int, grey: Any) -> Any:
        if 9 <= k < 12:
            return np.random.default_rng(k).integers(90, 110, grey.shape).astype(np.uint8)
        if 14 <= k < 20:
            u, v = np.round(true[k, "L1"]).astype(int)
            grey = grey.copy()
            grey[max(v - 20, 0) : v + 20, max(u - 20, 0) : u + 20] = 128
        return grey

    monkeypatch.setattr(rooms, "grey_frames", frames_where(cover))
    follow(read_project("flight.toml"), TrackOptions())
    status: dict[tuple[int, str], str] = {}
    for row in rows(flight / "tracked.csv"):
        status.setdefault((int(row["frame"]), row["landmark"]), row["status"])
    marks = {"L1", "L2", "L4", "L5"}
    for k in range(9, 12):
        assert {status[k, mark] for mark in marks} == {"lost"}
    assert [status[12, mark] for mark in sorted(marks)].count("tracked") >= 3
    assert {status[k, "L1"] for k in range(14, 20)} == {"occluded"}
    assert {status[k, "L2"] for k in range(14, 20)} == {"tracked"}


def test_a_cut(flight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From frame 9 on the picture is turned round: it begins anew with the clicks of frame 14."""
    true = truth()
    own = [(0, mark, *true[0, mark]) for mark in ("L1", "L2", "L4", "L5")]
    names = [mark for mark in ("L1", "L2", "L3", "L4", "L5", "L6") if (14, mark) in true]
    last = [(14, mark, 319 - true[14, mark][0], 179 - true[14, mark][1]) for mark in names]
    clicks(*own, *last)
    monkeypatch.setattr(
        rooms, "grey_frames", frames_where(lambda k, g: g if k < 9 else g[::-1, ::-1])
    )
    monkeypatch.setattr(
        rooms, "grey_frames_backward",
        lambda frames, end, low: ((k, g) for k, g in reversed(list(
            frames_where(lambda k, g: g if k < 9 else g[::-1, ::-1])(frames, low, end)))),
    )  # fmt: skip
    done = follow(read_project("flight.toml"), TrackOptions())
    assert "lost from frame 9: tracking begins anew with the clicks of frame 14" in done.lines
    assert not any("fewer than two" in line for line in done.lines)


BAD = {
    "no tracked": ("flight.toml", 'tracked = "tracked.csv"\n', ""),
    "no video": ("flight.toml", 'video = "video.mp4"\ntimes = "video"', "frame_rate_hz = 30.0"),
    "tracked over clicks": ("flight.toml", '"tracked.csv"', '"clicks.csv"'),
    "tracked over the project": ("flight.toml", '"tracked.csv"', '"flight.toml"'),
    "another size": ("flight.toml", "[320, 180]", "[640, 360]"),
    "no number of a patch": ("landmarks.csv", "h_m", "h_m,patch_px"),
    "not a video": ("video.mp4", "", ""),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(flight: Path, name: str) -> None:
    file, old, new = BAD[name]
    if name == "not a video":
        (flight / file).write_bytes(b"frames\n" * 40)
    elif name == "no number of a patch":
        lines = (flight / file).read_text().splitlines()
        lines = [lines[0] + ",patch_px", *(line + ",6" for line in lines[1:])]
        (flight / file).write_text("\n".join(lines))
    else:
        change(file, old, new)
    done = vopd("track", "flight.toml")
    assert done.status == 1
    assert "Traceback" not in done.stderr
    assert_approved(done.stderr)
    assert not list(flight.glob("tracked.csv*"))


def test_bad_clicks(flight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """None in the range, one landmark alone, no two in a frame, a frame beyond the end."""
    true = truth()
    cases: list[tuple[tuple[tuple[int, str], ...], tuple[str, ...]]] = [
        (((0, "L1"), (0, "L2")), ("--from", ".5")),
        (((0, "L1"), (5, "L1")), ()),
        (((0, "L1"), (5, "L2")), ()),
        (((0, "L1"), (0, "L2")), ("--from", "30")),
    ]
    told = []
    for wanted, options in cases:
        clicks(*((k, mark, *true[k, mark]) for k, mark in wanted))
        done = vopd("track", "flight.toml", *options)
        assert done.status == 1
        told.append(done.stderr)
    clicks((0, "L1", *true[0, "L1"]), (99, "L2", 50.0, 50.0))
    told.append(vopd("track", "flight.toml").stderr)
    assert_approved("".join(told))


def test_a_click_on_another_point(flight: Path) -> None:
    """The click of frame 10 lies 12 px off; those of frames 0 and 20 agree, and it is named."""
    true = truth()
    marks = [
        m for m in ("L1", "L2", "L3", "L4", "L5", "L6") if all((k, m) in true for k in (0, 10, 20))
    ]
    every = [(k, mark, *true[k, mark]) for k in (0, 10, 20) for mark in marks]
    odd = next(i for i, one in enumerate(every) if one[:2] == (10, "L1"))
    every[odd] = (10, "L1", every[odd][2] + 12.0, every[odd][3])
    clicks(*every)
    done = vopd("track", "flight.toml")
    assert done.status == 3
    assert_approved("".join(line + "\n" for line in done.stderr.splitlines() if "warning" in line))


def test_a_video_that_ends_too_early(flight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        rooms, "grey_frames", lambda frames, low, end: grey_frames(frames, low, min(end, 11))
    )
    done = vopd("track", "flight.toml")
    assert done.status == 3
    assert_approved("".join(line + "\n" for line in done.stderr.splitlines() if "warning" in line))
    assert {int(row["frame"]) for row in rows(flight / "tracked.csv")} == set(range(12))
