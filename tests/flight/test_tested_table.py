"""What `vopd adjust --test` says: what is left out, how far it is off, and what freeing helps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.flight_blunders import BlunderRow
from tests.kit.simulated_flights import write_flight
from tests.tolerances import assert_close
from vopd.attitude.sigmas import Sigmas
from vopd.flight.adjust import tested as module
from vopd.flight.adjust.tested import Prediction
from vopd.flight.adjust.tested_table import as_text, label, prediction_lines, rows
from vopd.flight.misfits.leave_out import FIX
from vopd.flight.project.read import read_flight
from vopd.flight.solve.errors import with_sigmas

SEED = 11
M_A_DEGREE = 111_200.0  # of latitude
PLAN = BlunderRow("", 0.02).plan


def moved_row(folder: Path, row: int, change: Callable[[list[str], list[str]], list[str]]) -> None:
    """Change the latitude, longitude and height of a row of the track, by itself and the last."""
    head, *lines = (folder / "track.csv").read_text(encoding="utf-8").splitlines()
    time, *place = lines[row].split(",")
    lines[row] = ",".join([time, *change(place, lines[row - 1].split(",")[1:])])
    (folder / "track.csv").write_text("\n".join([head, *lines, ""]), encoding="utf-8")


def solved(folder: Path) -> module.TestedFlight:
    return module.tested_flight(vopd.solve_flight(folder / "flight.toml"))


@pytest.mark.parametrize("row", [3, 4])
def test_a_fix_that_is_off_is_no_time(row: int, tmp_path: Path) -> None:
    """5 m north, of positions of .02 m: not along the track, whose velocity there is uncertain.

    The frame is at the time of the fix, and so the test of its time gains about as much.
    """
    write_flight(tmp_path, PLAN, np.random.default_rng(SEED))
    moved_row(tmp_path, row, lambda own, _: [f"{float(own[0]) + 5.0 / M_A_DEGREE:.12f}", *own[1:]])
    found = solved(tmp_path)
    (first, *_) = rows(found)
    (one,) = found.named
    assert one.tests.kind.tolist() == [FIX] and first["left_out"] == "fix"
    away_m = np.array([first[f"fits_{way}_m"] for way in ("east", "north", "up")], float)
    assert_close("fix that is off", away_m, [0.0, -5.0, 0.0])
    assert_approved("\n".join(as_text(found, None, ()).splitlines()[1:7]))


def test_a_fix_that_is_late_is_a_time(tmp_path: Path) -> None:
    """It is where the camera was .2 s before, and fits the time of .2 s later, as is said."""
    write_flight(tmp_path, PLAN, np.random.default_rng(SEED))
    moved_row(tmp_path, 4, lambda _, before: before)
    found = solved(tmp_path)
    first = rows(found)[0]
    assert first["left_out"] == "time" and first["frame"] == "frame 4"
    later_s = first["fits_later_s"]
    assert isinstance(later_s, float)
    assert_close("time of a late fix", later_s, 0.2)
    assert_approved("\n".join(as_text(found, None, ()).splitlines()[1:7]))


@pytest.mark.parametrize("frame_hz", [5.0, 1.25, 0.6])
def test_fixes_are_named_by_their_rows_or_the_one_frame_between(
    frame_hz: float, tmp_path: Path
) -> None:
    """A frame depends on the row before it and the row after it, of one a second."""
    plan = PLAN._replace(fix_hz=1.0, frame_hz=frame_hz, frames=8)
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    lines = (tmp_path / "track.csv").read_text(encoding="utf-8").splitlines()[1:]
    row_s = np.array([float(line.split(",")[0]) for line in lines])
    frame_s = np.arange(8) / frame_hz
    expected = set()
    for k, at_s in enumerate(row_s):
        own = np.flatnonzero((frame_s > at_s - 1.0) & (frame_s < at_s + 1.0))
        if len(own) == 1:
            way = "before" if at_s < frame_s[own[0]] else "after"
            expected.add(f"frame {own[0]}: fix {way} it")
        elif len(own):
            expected.add(f"fix {k + 1}, of frame {own[0]} to {own[-1]}")
    found = solved(tmp_path)
    told = {label(found.tests, k, found.flight) for k in np.flatnonzero(found.tests.kind == FIX)}
    assert told <= expected and len(told) > 2
    assert told == {row["frame"] for row in rows(found) if row["left_out"] == "fix"}


def test_fixes_that_count_by_velocity_alone_are_named_by_the_next_frame() -> None:
    """The first of frame 0, and the last of frame 3, are each at a fix of their own."""
    robust = Path(__file__).parents[1] / "robustness/inputs/flight_of_fixes_before_its_frames"
    found = solved(robust)
    told = {label(found.tests, k, found.flight) for k in np.flatnonzero(found.tests.kind == FIX)}
    assert_approved(sorted(told))


def test_another_sigma_of_positions_leaves_the_path_between_them(tmp_path: Path) -> None:
    write_flight(tmp_path, PLAN._replace(fix_hz=1.0), np.random.default_rng(SEED))
    flight = read_flight(str(tmp_path / "flight.toml"))
    fixes = flight.path.fixes
    given = with_sigmas(flight, Sigmas(position=3.0)).path.fixes
    assert fixes is not None and given is not None and fixes.between is not None
    assert np.array_equal(given.sigma_m[fixes.between], fixes.sigma_m[fixes.between])
    assert (given.sigma_m[~fixes.between] == 3.0).all() and fixes.between.any()


def test_labels_that_are_exchanged_are_named(tmp_path: Path) -> None:
    row = BlunderRow("labels of a frame", 0.02)
    truth = write_flight(tmp_path, row.plan, np.random.default_rng(SEED), row.blunder, 5.0)
    frame, *marks = truth.wrong
    assert_approved(as_text(solved(tmp_path), None, ()).splitlines()[2], parts=[frame, *marks])


def test_a_landmark_that_is_off_is_named_with_what_it_fits(tmp_path: Path) -> None:
    """It is 3 m too far east in the file."""
    write_flight(tmp_path, PLAN, np.random.default_rng(SEED))
    head, first, *lines = (tmp_path / "landmarks.csv").read_text(encoding="utf-8").splitlines()
    name, *place = first.split(",")
    metres = M_A_DEGREE * np.cos(np.radians(float(place[0])))
    place[1] = f"{float(place[1]) + 3.0 / metres:.12f}"
    text = "\n".join([head, ",".join([name, *place]), *lines, ""])
    (tmp_path / "landmarks.csv").write_text(text, encoding="utf-8")
    result = vopd.solve_flight(tmp_path / "flight.toml")
    (said,) = [one.message for one in result.findings if "would fit" in one.message]
    east_m = float(said.partition("it would fit ")[2].split(" m")[0])
    assert_close("landmark that is off", east_m, -3.0)
    assert_approved(said)
    found = module.tested_flight(result)
    assert rows(found)[0]["landmark"] == name
    assert_approved("\n".join(as_text(found, None, ()).splitlines()[1:7]))


PREDICTIONS = {
    "helps": Prediction(60, (2.0, 1.0), (2.5, 1.5), 9, 10),
    "unclear": Prediction(60, (2.0, 1.9), (2.5, 2.4), 6, 10),
    "worse": Prediction(60, (1.0, 2.0), (1.5, 2.5), 1, 10),
    "unclear and worse": Prediction(60, (1.0, 1.1), (1.5, 1.6), 4, 10),
}


@pytest.mark.parametrize("name", PREDICTIONS)
def test_whether_freeing_helps_is_said(name: str, tmp_path: Path) -> None:
    write_flight(tmp_path, PLAN._replace(frames=3), np.random.default_rng(SEED))
    found = solved(tmp_path)
    assert_approved(prediction_lines(found, PREDICTIONS[name], ["focal", "k1"]))


def test_that_no_pick_is_predicted_is_said(tmp_path: Path) -> None:
    write_flight(tmp_path, PLAN._replace(frames=3), np.random.default_rng(SEED))
    found = solved(tmp_path)
    none = replace(found, tests=found.tests.take(found.tests.kind == FIX))
    assert_approved(prediction_lines(none, None, ()))
