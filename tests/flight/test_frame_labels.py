"""Frames that are numbered from 4001 on, or by tens, or that are images with names: the same said.

Two labels are exchanged in one of them, so that there is something to say.
"""

from __future__ import annotations

import contextlib
import csv
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.kit.clicked_flights import clicked_flight
from tests.kit.command import vopd
from tests.kit.simulated_flights import Errors, Plan, write_flight
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.adjust import tested
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.adjust.tested_table import as_text
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.project.tracked_picks import join_tracks
from vopd.flight.result import FlightResult, solve_flight, solve_flight_read
from vopd.flight.solve.next_click import next_click_texts

FRAMES, SIZE = 6, (1920, 1080)
LABELS: dict[str, Callable[[int], str]] = {
    "counted": lambda k: str(4001 + k),
    "tens": lambda k: str(4010 + 10 * k),
    "images": lambda k: f"IMG_{4001 + k}.png",
}
LABEL = re.compile(r"(?:\b[Ff]rame )?(?:IMG_400([1-6])\.png\b|\b40(?:0([1-6])|([1-6])0)\b(?!\.\d))")
TIMES = "frame_rate_hz = 2.0\nfirst_frame_t_s = 0.0\n"
COMMANDS = {
    "check": "check flight.toml",
    "adjust": "adjust flight.toml --free focal -o adjusted",
    "test": "adjust flight.toml --test",
    "punch": "punch flight.toml -o a.dat",
    "report": "report flight.toml -o report.html",
}
FILES = ("a.dat", "report.html")


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("labels")


@cache
def project(how: str, base: Path) -> Path:
    """Write the same flight with labels of one kind."""
    folder = base / how
    folder.mkdir()
    plan = Plan(Errors(fix_m=((0.02,) * 3,)), frames=FRAMES, landmarks=6, sigma_px=True)
    write_flight(folder, plan, np.random.default_rng(4), "labels of a frame", 6.0)
    label, key = LABELS[how], "image" if how == "images" else "frame"
    with (folder / "picks.csv").open(encoding="utf-8") as text:
        _, *rows = csv.reader(text)
    picks = [[label(int(frame)), *row] for frame, *row in rows]
    write(folder / "picks.csv", [[key, "landmark", "u_px", "v_px"], *picks])
    times = [[label(k), str(0.5 * k)] for k in range(FRAMES)]
    write(folder / "times.csv", [[key, "t_s"], *times])
    (folder / "images").mkdir()
    for k in range(FRAMES):
        name = label(k) if how == "images" else f"frame_{label(k)}.png"
        Image.new("L", SIZE, 100 + k).save(folder / "images" / name, compress_level=1)
    text = (folder / "flight.toml").read_text(encoding="utf-8")
    assert text.count(TIMES) == 1
    text = text.replace(TIMES, 'times = "times.csv"\nvideo = "images"\n')
    (folder / "flight.toml").write_text(text, encoding="utf-8")
    return folder


def write(file: Path, rows: list[list[str]]) -> None:
    with file.open("w", encoding="utf-8", newline="") as text:
        csv.writer(text).writerows(rows)


@cache
def solved(how: str, base: Path) -> FlightResult:
    with contextlib.chdir(project(how, base)):
        return solve_flight("flight.toml")


@cache
def said(how: str, name: str, base: Path) -> tuple[int, list[str]]:
    """Run a command; in the words that it says and writes each label is one of @1 to @6."""
    folder = project(how, base)
    with contextlib.chdir(folder):
        ran = vopd(*COMMANDS[name].split())
        written = [one for one in FILES if one in COMMANDS[name]]
        text = [ran.stdout, ran.stderr, *(Path(one).read_text("utf-8") for one in written)]
    return ran.status, without_labels("\n".join(text))


def without_labels(text: str) -> list[str]:
    return LABEL.sub(lambda one: f"@{one[one.lastindex or 0]}", text).split()


CASES = [("tens", name) for name in COMMANDS]
CASES += [("images", name) for name in ("check", "adjust", "test")]


@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize(("how", "name"), CASES)
def test_the_same_is_said(how: str, name: str, base: Path) -> None:
    """A deck has the numbers of frames alone, and a report of images a column more."""
    status, words = said("counted", name, base)
    assert status != 1 and any("@3" in word for word in words)
    assert said(how, name, base) == (status, words)


@pytest.mark.parametrize("how", ["tens", "images"])
def test_the_same_is_solved(how: str, base: Path) -> None:
    """The table of the library, and where the landmarks of each frame are computed."""
    one, other = solved("counted", base), solved(how, base)
    words, again = (without_labels(each.summary(200)) for each in (one, other))
    if how == "images":
        again[again.index("image")] = "frame"  # the heading of the first column
    assert words == again
    assert_close("table value", other.camera_deg, one.camera_deg)
    scenes = [each.estimate.scene for each in (one, other)]
    first, second = (scene() for scene in scenes if scene is not None)
    assert first.image is not None and second.image is not None
    for k in range(FRAMES):
        number, name = (k, LABELS[how](k)) if how == "images" else (int(LABELS[how](k)), "")
        image = second.image(number, name)
        assert_close("table value", image.fitted, first.image(4001 + k, "").fitted)


# Clicks and their tracks


@cache
def clicked(how: str) -> tuple[list[str], Floats]:
    """Solve a flight of clicks: what is said of it, and the angles.

    Two clicks of the fourth frame are exchanged, and the landmark that would be asked for next is
    marked as hidden in its frame.
    """
    one = clicked_flight(np.random.default_rng(5), FRAMES, 5, every=3, apart=0)
    rows, marks = one.rows, np.array(one.rows.landmark)
    first, second = ((rows.from_frame == 3) & (marks == name) for name in ("P1", "P2"))
    names = np.where(first, "P2", np.where(second, "P1", marks))
    labels = tuple(LABELS[how](k) for k in range(FRAMES))
    number = np.arange(FRAMES) if how == "images" else np.array(labels, int)
    tracks = replace(rows, landmark=Names(names.tolist()), from_frame=number[rows.from_frame])
    read = PickRows(
        rows.frame, tracks.landmark, rows.pixel, rows.sigma_px, "centre", None, "", tracks=tracks
    )
    flight = replace(one.flight, frame=number, image_name=labels if how == "images" else ())
    landmarks, hidden = flight.landmarks.name, frozenset({(labels[5], 3)})
    picks, _ = join_tracks(read, number, landmarks, flight.source, hidden)
    result = solve_flight_read(replace(flight, picks=picks))
    assert result.estimates.joint is not None
    said = [one.message for one in result.findings]
    said += next_click_texts(result.estimates.joint)
    said.append(str(adjust(result.read, "focal")))
    said.append(as_text(tested.tested_flight(result), None, ()))
    return without_labels("\n".join(said)), result.camera_deg


@pytest.mark.parametrize("how", ["tens", "images"])
def test_the_same_is_said_of_clicks(how: str) -> None:
    """Exchanged ones, the next one, free parameters, and what is left out one by one."""
    (words, camera_deg), (again, found_deg) = clicked("counted"), clicked(how)
    text = " ".join(words)
    assert "@4: the clicks of P1 and P2 are exchanged" in text
    assert "click next: " in text and "P3 in @6" not in text
    assert again == words
    assert_close("table value", found_deg, camera_deg)
