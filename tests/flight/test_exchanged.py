"""Labels of two landmarks, or more, that are exchanged in a frame."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.command import peak
from tests.kit.flight_blunders import BlunderRow
from tests.kit.flight_project import uneven_flight, write_project
from tests.kit.simulated_flights import write_flight
from tests.tolerances import assert_close
from vopd.flight.flight import FlightOptions, Picks
from vopd.flight.misfits import exchanged
from vopd.flight.misfits.blunders import ARE_EXCHANGED
from vopd.flight.misfits.unsolved import picks_outside
from vopd.flight.project.read import read_flight
from vopd.flight.result import FlightResult, solve_flight_read
from vopd.flight.solve.rotations import FlightBlocks
from vopd.geometry.earth import local_axes
from vopd.geometry.lenses import ray_of_pixel

SEED = 12
HELD = FlightOptions(solve_position=False)


def messages(result: FlightResult) -> list[str]:
    """What is said, but for picks that are drawn outside their images."""
    outside = picks_outside(result.read)
    return [one.message for one in result.findings if one not in outside]


@pytest.mark.parametrize("landmarks", [4, 6])
@pytest.mark.parametrize("fisheye", [False, True])
@pytest.mark.parametrize("fix_m", [0.02, 2.0])
def test_labels_of_a_frame_are_named_whatever_the_position(
    landmarks: int, fisheye: bool, fix_m: float, tmp_path: Path
) -> None:
    """In a frame of four no three others agree, and the place may follow one of the two."""
    plan = BlunderRow("", fix_m).plan._replace(landmarks=landmarks)
    plan = plan._replace(focal_px=600.0, fisheye=True) if fisheye else plan
    truth = write_flight(tmp_path, plan, np.random.default_rng(SEED), "labels of a frame")
    result = vopd.solve_flight(tmp_path / "flight.toml")
    frame, *marks = truth.wrong
    one, other = (f"m{k}" for k in sorted(marks))
    (text,) = messages(result)
    assert text.startswith(f"frame {frame}: {one} and {other} {ARE_EXCHANGED}: ")
    flags = result.history().flags
    assert np.flatnonzero(flags.raised["misfit"]).tolist() == [frame]
    assert flags.detail["misfit"][frame].startswith(f"exchange {one}+{other} (chance 0.")
    assert flags.detail["outlier"][frame] == f"{one}+{other}"


TWO_PAIRS, THREE, ALL = "two pairs", "three in a ring", "all a row on"


@pytest.mark.parametrize(
    ("landmarks", "dealt", "fix_m"),
    [
        (4, TWO_PAIRS, 0.02), (4, ALL, 2.0), (5, THREE, 2.0), (8, TWO_PAIRS, 2.0),
        (8, ALL, 0.02), (12, THREE, 0.02),
    ],
)  # fmt: skip
def test_more_labels_of_a_frame_are_named_with_what_they_rather_are(
    landmarks: int, dealt: str, fix_m: float, tmp_path: Path
) -> None:
    """Picks were named that fit, or a flight that misfits without a word of the frame."""
    plan = BlunderRow("", fix_m).plan._replace(landmarks=landmarks)
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    head, *rows = (line.split(",") for line in (tmp_path / "picks.csv").read_text().splitlines())
    own = [row for row in rows if row[0] == "4"]
    true = [row[1] for row in own]
    first = {TWO_PAIRS: [1, 0, 3, 2], THREE: [1, 2, 0], ALL: [*range(1, landmarks), 0]}[dealt]
    wrong = [true[k] for k in [*first, *range(len(first), landmarks)]]
    for row, label in zip(own, wrong, strict=True):
        row[1] = label
    (tmp_path / "picks.csv").write_text("\n".join(map(",".join, [head, *rows])) + "\n")
    result = vopd.solve_flight(tmp_path / "flight.toml")
    (text,) = (one for one in messages(result) if one.startswith("frame 4: "))
    moved = sorted(
        (int(one[1:]), int(other[1:]))
        for one, other in zip(wrong, true, strict=True)
        if one != other
    )
    names, rather = [f"m{one}" for one, _ in moved], [f"m{one} to m{other}" for one, other in moved]
    assert text.startswith(f"frame 4: {', '.join(names[:-1])} and {names[-1]} {ARE_EXCHANGED}: ")
    assert f"px with {', '.join(rather[:-1])} and {rather[-1]} renamed; " in text
    assert not result.misfits


def test_a_frame_whose_labels_are_all_exchanged_keeps_them_and_spoils_no_other(
    tmp_path: Path,
) -> None:
    """With blunders = "drop" its picks were left in what all frames have in common."""
    write_flight(tmp_path, BlunderRow("", 2.0).plan, np.random.default_rng(SEED))
    flight = read_flight(str(tmp_path / "flight.toml"))
    label = flight.picks.landmark.copy()
    own = flight.picks.frame == 4
    label[own] = np.roll(label[own], 1)
    wrong = replace(flight, picks=replace(flight.picks, landmark=label))
    options = replace(flight.options, drop_blunders=True)
    named, dropped = (solve_flight_read(one) for one in (wrong, replace(wrong, options=options)))
    assert not dropped.misfits and np.array_equal(dropped.estimate.used, named.estimate.used)
    assert_close("table value", named.camera_deg, dropped.camera_deg)
    assert_approved([re.sub(r"\d+\.\d px", "N px", one) for one in messages(dropped)])


@pytest.mark.parametrize(("limit", "named"), [("MOST_DEALT", 8), ("LEAST_DEALT", 8)])
def test_labels_are_dealt_anew_in_frames_of_so_many_landmarks(
    limit: str, named: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocks = FlightBlocks(uneven_flight([named]))
    plain = exchanged._plain(blocks, 0)
    plain = plain._replace(label=np.roll(plain.label, 1))
    monkeypatch.setattr(exchanged, limit, named)
    assert exchanged._dealt_anew(blocks.flight, plain)
    monkeypatch.setattr(exchanged, limit, named + (1 if limit == "LEAST_DEALT" else -1))
    assert exchanged._dealt_anew(blocks.flight, plain) == []


def test_labels_of_all_frames_are_dealt_in_memory_by_those_that_are_asked() -> None:
    """Each of all landmarks was counted for each other: 30 GB for 60,000."""
    flight = uneven_flight([6, 6, 6])
    marks, more, label = flight.landmarks, 4000, flight.picks.landmark
    many = replace(
        marks,
        name=(*(f"other {k}" for k in range(more)), *marks.name),
        position_m=np.vstack([np.tile(marks.position_m[:1], (more, 1)), marks.position_m]),
        sigma_m=np.vstack([np.tile(marks.sigma_m[:1], (more, 1)), marks.sigma_m]),
    )
    ring = np.array([1, 2, 3, 4, 5, 0])
    wrong = replace(
        flight, landmarks=many, picks=replace(flight.picks, landmark=more + ring[label])
    )
    rather = [*range(more), *(more + np.argsort(ring))]
    assert exchanged.labels_of_all_frames(wrong).tolist() == rather
    assert peak(lambda: exchanged.labels_of_all_frames(wrong), begun=True) < 30e6


def test_layouts_that_can_be_dealt_in_several_ways_are_not_dealt_in_one() -> None:
    """A regular hexagon about the optical axis looks the same when it is turned by 60 degrees."""
    flight = uneven_flight([6])
    at = np.radians(60.0 * np.arange(6))
    centre_px = flight.lens.by_rows("centre_px")
    pixel = centre_px + 300.0 * np.stack([np.cos(at), np.sin(at)], axis=1)
    camera_m = flight.path.position_m[0]
    seen = ray_of_pixel(flight.lens, pixel) @ local_axes(camera_m)
    marks = replace(flight.landmarks, position_m=camera_m + 500.0 * seen)
    own = replace(flight, picks=replace(flight.picks, pixel=pixel), landmarks=marks)
    plain = exchanged._plain(FlightBlocks(own), 0)
    dealt = {tuple(np.argsort(one).tolist()) for one in exchanged._dealings(own, plain)}
    assert dealt == {tuple(np.roll(range(6), k).tolist()) for k in range(6)}


@pytest.mark.parametrize("count", [1, 2])
def test_gross_picks_of_a_frame_are_no_labels(count: int, tmp_path: Path) -> None:
    """12 frames, each with one or two picks 40 to 400 px off: named, and nothing is exchanged."""
    plan = BlunderRow("", 0.02).plan._replace(landmarks=6, frames=24)
    rng = np.random.default_rng(SEED)
    write_flight(tmp_path, plan, rng)
    head, *rows = (line.split(",") for line in (tmp_path / "picks.csv").read_text().splitlines())
    for frame in range(0, 24, 2):
        own = [row for row in rows if row[0] == str(frame)]
        for k in rng.choice(6, count, replace=False):
            size, way = rng.uniform(40.0, 400.0), rng.uniform(0.0, 2.0 * np.pi)
            own[k][2] = str(float(own[k][2]) + size * np.cos(way))
            own[k][3] = str(float(own[k][3]) + size * np.sin(way))
    (tmp_path / "picks.csv").write_text("\n".join(map(",".join, [head, *rows])) + "\n")
    result = vopd.solve_flight(tmp_path / "flight.toml")
    assert not any(ARE_EXCHANGED in one for one in messages(result))
    assert (result.estimate.outlier is not None) and result.estimate.outlier.sum() >= 12


def test_labels_that_are_dropped_leave_the_flight_without_them(tmp_path: Path) -> None:
    plan = BlunderRow("", 2.0).plan._replace(landmarks=4)
    truth = write_flight(tmp_path, plan, np.random.default_rng(SEED), "labels of a frame")
    flight = read_flight(str(tmp_path / "flight.toml"))
    named = solve_flight_read(flight)
    dropped = solve_flight_read(
        replace(flight, options=replace(flight.options, drop_blunders=True))
    )
    assert_approved([*messages(named), *messages(dropped)])
    others = np.arange(plan.frames) != truth.wrong[0]
    assert_close("table value", named.camera_deg[others], dropped.camera_deg[others])
    assert dropped.estimate.used.sum(axis=1).tolist() == [4 - 2 * (not one) for one in others]


@pytest.mark.parametrize("frame", [0, 3])
def test_labels_that_turn_a_frame_upside_down_are_named(frame: int, tmp_path: Path) -> None:
    """The two lie on either side of all others: upside down they fit, and three others do not."""
    project = write_project(tmp_path, noise_px=0.5)
    head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
    other = {"church": "bridge", "bridge": "church"}
    parts = [row.split(",") for row in rows]
    for part in parts:
        if part[0] == parts[6 * frame][0]:
            part[1] = other.get(part[1], part[1])
    lines = [head, *(",".join(part) for part in parts), ""]
    (tmp_path / "picks.csv").write_text("\n".join(lines))
    texts = messages(vopd.solve_flight(project))
    assert [one for one in texts if f"church and bridge {ARE_EXCHANGED}" in one] == texts[:1]
    assert not any("does not fit" in one for one in texts)


@pytest.mark.parametrize("gross", [0, 2, 3, 5])
@pytest.mark.parametrize("landmarks", [3, 4, 24, 26])
def test_trials_of_a_frame_are_counted_before_they_are_made(landmarks: int, gross: int) -> None:
    picks, used = np.arange(landmarks + 1) + 7, np.arange(landmarks + 1) > 0
    plain = exchanged._Trial(0, picks, picks, used)
    out = np.isin(np.arange(50), picks[1 : 1 + gross])
    groups = exchanged._groups_of_frame(plain, out, np.full((50, 2), np.nan))
    made = sum(len(one.picks) for group in groups for one in group)
    assert exchanged._picks_of_trials(plain, out) == made > 0


def told(
    counts: list[int], frames: list[int], drop: bool = False, together: int = 99, checks: int = 0
) -> list[str]:
    """Findings of a flight in some of whose frames the first two landmarks are exchanged.

    Args:
        counts: of landmarks of each frame
        frames: those with exchanged ones
        drop: whether blunders are left out
        together: from which frame on the first landmark is not picked
        checks: how many landmarks are checks, the first ones
    """
    flight = replace(uneven_flight(counts), options=replace(HELD, drop_blunders=drop))
    landmark = flight.picks.landmark.copy()
    for frame in frames:
        first = np.flatnonzero(flight.picks.frame == frame)[:2]
        landmark[first] = landmark[first[::-1]]
    picks = flight.picks
    kept = (picks.frame < together) | (landmark != landmark[0])
    picks = Picks(picks.frame[kept], landmark[kept], picks.pixel[kept], picks.sigma_px[kept])
    used = tuple(k >= checks for k in range(len(flight.landmarks.name)))
    marks = replace(flight.landmarks, used=used)
    return messages(solve_flight_read(replace(flight, picks=picks, landmarks=marks)))


def test_frames_are_named_in_order() -> None:
    """Two landmarks fit as well when they are exchanged, and say nothing; of three one is left."""
    texts = told([4, 9, 5, 2, 3, *[4] * 12], [1, 2, 3, 4])
    named = [one.partition(":")[0] for one in texts if ARE_EXCHANGED in one]
    assert named == ["1.jpg", "2.jpg", "4.jpg"]
    (text,) = (one for one in told([3, *[4] * 12], [0], drop=True) if ARE_EXCHANGED in one)
    assert_approved(text)


def test_of_exchanges_with_a_pick_in_common_the_likeliest_is_kept() -> None:
    def likely(gain: float, *pair: int) -> Any:
        return SimpleNamespace(gain=gain, trial=SimpleNamespace(moved=pair))

    found = [likely(3.0, 1, 2), likely(5.0, 2, 3), likely(4.0, 3, 4), likely(1.0, 0, 5)]
    assert [one.trial.moved for one in exchanged._disjoint(found)] == [(0, 5), (2, 3)]


def test_labels_exchanged_in_most_frames_are_the_flight_s() -> None:
    assert not any(ARE_EXCHANGED in one for one in told([5] * 12, list(range(9))))


@pytest.mark.parametrize(("checks", "named"), [(0, True), (1, False), (2, False)])
def test_labels_of_check_landmarks_take_no_part(checks: int, named: bool) -> None:
    """They are of no weight: nothing tells which picks are theirs."""
    texts = told([7] * 12, [1], checks=checks)
    assert any(ARE_EXCHANGED in one for one in texts) == named


@pytest.mark.parametrize(("together", "named"), [(5, False), (12, True)])
def test_most_frames_are_counted_of_those_that_show_both(together: int, named: bool) -> None:
    """Exchanged in the first four, of five or of all twelve frames that show both landmarks."""
    texts = told([6] * 12, [0, 1, 2, 3], together=together)
    assert any(ARE_EXCHANGED in one for one in texts) == named


def test_frames_that_are_not_searched_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four landmarks are 6 pairs and the labels as they are: 28 picks."""
    monkeypatch.setattr(exchanged, "SEARCHED_PICKS", 30)
    assert_approved(told([4] * 30, [3, 7]))
