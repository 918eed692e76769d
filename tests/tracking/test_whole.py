"""All that the tracker finds out about drawn frames, number by number."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.approved.texts import assert_approved
from tests.kit.plain import EVERY, Plain
from tests.kit.whole import whole
from vopd.flight.flight import Refraction
from vopd.flight.project.keys import read_project
from vopd.tracking import follow as rooms
from vopd.tracking import tracker as runs
from vopd.tracking.follow import TrackOptions, follow
from vopd.tracking.tracker import Tracker

SIDES = np.array([25, 17, 13, 25, 31])
TURN = 0.003, -0.002, 0.01
LEVER_M = 1.0, 2.0, 3.0


def told(tracker: Tracker, pictures: list[tuple[int, Any]], done: dict[int, Any]) -> list[str]:
    """Run forward, backward and again: what is written down, and what is known at the end."""
    said = [whole(np.concatenate(list(tracker.forward(pictures, done))), "forward")]
    for start, low in tracker.gaps():
        back = list(tracker.backward(pictures[start : low - 1 if low else None : -1]))
        said.append(f"backward from {start} to {low}: {back}")
    own = tracker.attitudes
    said += [whole(own.rotation[k], f"rotation.{k}") for k in np.flatnonzero(own.known)]
    said.append(whole({"known": own.known, "segment": own.segment}))
    said.append(whole(tracker.beginnings, "beginnings"))
    said.append(whole({k: one.side for k, one in tracker.patches.items()}, "sides"))
    wanted = np.arange(len(pictures)) % 2 == 0
    for block in tracker.second(pictures, wanted):
        rows = [[*map(int, (one["landmark"], one["click"], one["status"]))] for one in block]
        said.append(f"landmarks, clicks, statuses of frame {block['frame'][0]}: {rows}")
        said.append(whole(block[block["correlation"] > 0.0]))
    return said


def test_a_run_with_a_rolling_shutter() -> None:
    """Clicks in frame 3 and later, one far off; two frames are black, and other ground changes."""
    plain = Plain(14, TURN, 0.08, lever_m=LEVER_M)
    sigma_m = 0.1 + 0.02 * np.arange(14)
    plain.scene = replace(plain.scene, place_sigma_m=sigma_m, refraction=Refraction(0.13, False))
    clicks = [(3, 0, 0.2, 0.1, 0.5), (3, 1, -0.1, 0.3), (3, 2, 0.0, 0.0), (3, 3, 0.4, -0.2, 2.0)]
    clicks += [(3, 4, 40.0, 25.0), (8, 4, 0.0, 0.0), (8, 1, 0.5, 0.5), (11, 3, 0.0, 0.3, 0.7)]
    tracker = plain.tracker(*clicks, patch_px=SIDES, reach=4)
    assert_approved("\n".join(told(tracker, plain.pictures(black=(5, 6), marks=(7,), e=(10,)), {})))


def test_a_run_that_is_lost_and_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """After four black frames, where landmarks are hidden, and where clicks contradict it.

    A run that goes on after any frame comes to the same.
    """
    monkeypatch.setattr(runs, "HIDDEN", 2)
    monkeypatch.setattr(runs, "PREDICTED", 2)
    plain = Plain(18, (0.002, -0.001, 0.006), lever_m=LEVER_M)
    clicks = [*EVERY, (7, 1, 0.0, 0.0), (7, 3, 0.0, 0.0), (7, 4, 0.3, 0.0)]
    clicks += [(15, 3, 0.0, 0.0), (15, 4, 0.0, 0.0), (17, 3, 30.0, 0.0), (17, 4, 30.0, 0.0)]
    pictures = plain.pictures(black=(2, 3, 4, 5), marks=(11, 12, 13), around=(9,))
    first = plain.tracker(*clicks, patch_px=SIDES)
    forward = list(first.forward(pictures, {}))
    assert_approved("\n".join(told(plain.tracker(*clicks, patch_px=SIDES), pictures, {})))
    for k in (4, 8, 14):
        done = {int(one["frame"][0]): one[0] for one in forward[:k]}
        again = plain.tracker(*clicks, patch_px=SIDES)
        rest = list(again.forward(pictures, done))
        assert whole(np.concatenate(rest)) == whole(np.concatenate(forward[k:]))
        assert whole(again.attitudes) == whole(first.attitudes)
        assert again.beginnings == first.beginnings


# Whole runs of the command


class Stopped(Exception):
    """What ends a run in the midst of it."""


def said(options: TrackOptions, stops_after: int = -1) -> str:
    """Follow the project of this folder, and tell all that is told, written and counted."""
    warned, told, counted = list[Any](), list[int](), list[int]()

    def tell() -> None:
        told.append(1)
        if len(told) == stops_after:
            raise Stopped

    done = follow(read_project("flight.toml"), options, tell, counted.append, warned.append)
    parts = [done.output, *map(str, warned), *done.lines, *map(str, done.findings)]
    # the running attitude, good to a millionth, is in the sixth decimals
    table = re.sub(r",(-?\d\.\d{5})\d(?=,)", r",\1", Path("tracked.csv").read_text())
    table = re.sub(r",-?0\.[0-4]\d*,occluded", ",low,occluded", table)  # of anything
    return "\n".join([*parts, f"{counted} counted, {len(told)} told", table])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(rooms, "AT_ONCE", 4)
    return tmp_path


def test_images_that_are_missing_small_or_none(folder: Path) -> None:
    """A black one, too; a click is 12 px off, one of no landmark, and one at the edge."""
    plain = Plain(13, TURN)
    clicks = [*EVERY, (4, 2, 12.0, 0.0), (6, 0, 0.0, 0.0), (6, 1, 0.0, 0.0, 0.5), (10, 3, 0.0, 0.0)]
    plain.write(folder, *clicks, black=(3,), e=(7, 11))
    (folder / "images" / "f_5.png").unlink()
    for k in (8, 11):
        Image.fromarray(np.full((80, 100), 90, np.uint8)).save(folder / "images" / f"f_{k}.png")
    (folder / "images" / "f_9.png").write_bytes(b"\x89PNG")
    with (folder / "clicks.csv").open("a") as file:
        file.write("2,x,50.0,50.0,1.0\n")
    assert_approved(said(TrackOptions()))
    assert_approved(said(TrackOptions(0.2, 1.1, 3, 2, 20, 0.7, 0.5)))
    assert_approved(said(TrackOptions(to_s=0.65, every=6)))


def test_a_cut_and_clicks_that_contradict_each_other(folder: Path) -> None:
    """Two are exchanged, and two of one landmark are far from where others have it.

    A run that was stopped goes on to the same words and rows.
    """
    plain = Plain(14, TURN)
    a, b = plain.pixel(3, 0), plain.pixel(3, 1)
    clicks = [*EVERY, (3, 0, *(b - a)), (3, 1, *(a - b)), (3, 2, 0.0, 0.0), (3, 3, 0.3, 0.0, 0.4)]
    clicks += [(2, 4, 0.0, 9.0), (3, 4, -12.0, 0.0, 0.2), (5, 4, 0.0, 0.0), (5, 3, -7.0, 0.0, 2.0)]
    clicks += [(11, 3, 0.0, 0.0), (11, 4, 0.0, 0.0)]
    plain.write(folder, *clicks, all=range(7, 14), marks=(9,))
    whole_run = said(TrackOptions())
    assert_approved(whole_run)
    for stops_after in (7, 12, 21):
        with pytest.raises(Stopped):
            said(TrackOptions(), stops_after)
        again = said(TrackOptions())
        assert [one for one in again.split("\n") if " told" not in one] == [
            one for one in whole_run.split("\n") if " told" not in one
        ]


@pytest.mark.parametrize(("clicked", "moves"), [(range(5), "e"), ((0, 1, 3, 4), "be")])
def test_landmarks_that_are_elsewhere_under_a_rolling_shutter(
    folder: Path, clicked: tuple[int, ...], moves: str
) -> None:
    """One, or half of them; places have errors of their own, the antenna is beside the lens."""
    plain = Plain(12, TURN, 0.08, lever_m=LEVER_M)
    clicks = [(2, mark, 0.1 * mark, 0.0) for mark in clicked] + [(6, 3, 0.0, 0.0), (6, 4, 0.0, 0.0)]
    plain.write(folder, *clicks, **{moves: (1, 3, 4, 5, 7)})
    project = folder / "flight.toml"
    head, track = project.read_text().split("[track]")
    track = track.replace('"exact"', "0.3", 1)
    project.write_text(f"{head}[track]{track}")
    assert_approved(said(TrackOptions()))
