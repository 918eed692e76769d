"""A flight's solve: what is handed to the rotations, which frames are solved anew, its parts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit.flight_project import MARK, TIME_S, camera_m, three_frames, truth_deg, uneven_flight
from tests.tolerances import assert_close
from vopd.findings import Finding
from vopd.flight.estimate import flight_estimate
from vopd.flight.flight import frame_label
from vopd.flight.misfits.unsolved import frames_unsolved
from vopd.flight.solve import rotations as solve_module
from vopd.flight.solve.rotations import FlightBlocks, no_attitudes, solve, solve_rotations
from vopd.geometry.earth import NED_FROM_ENU, local_axes

CHECK = np.arange(3 * MARK) % MARK == 3


def recorded(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """What is handed to each solve of rotations from now on."""
    given: list[tuple[Any, ...]] = []

    def solved(*args: Any) -> Any:
        given.append(args)
        return solve_rotations(*args)

    monkeypatch.setattr(solve_module, "solve_rotations", solved)
    return given


def test_what_the_rotations_are_solved_from(monkeypatch: pytest.MonkeyPatch) -> None:
    base = three_frames()
    flight = replace(base, options=replace(base.options, loss="cauchy"))
    given = recorded(monkeypatch)
    found = solve(flight, passes=7)
    ((lens, frames, frame, pixel, sigma, direction, used, loss, passes, picks),) = given
    assert (lens, frames, loss, passes, picks) == (flight.lens, 3, "cauchy", 7, 12)
    assert frame.tolist() == flight.picks.frame.tolist()
    assert np.array_equal(pixel, flight.picks.pixel)
    assert np.array_equal(sigma, flight.picks.sigma_px)
    assert np.array_equal(direction, found.lines.direction, equal_nan=True)
    assert used.tolist() == (~CHECK).tolist() == found.used.tolist()
    assert solve(flight).camera_m is not flight.path.position_m
    assert given[1][8] == 500


def test_picks_that_are_left_out_and_all_picks_of_a_flight_in_blocks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("vopd.flight.solve.rotations.AT_ONCE", 4)
    monkeypatch.setattr("vopd.landmark_layout.FEW", 1)
    given = recorded(monkeypatch)
    left_out = np.zeros(12, bool)
    left_out[[1, 10]] = True
    found = solve(three_frames(), left_out)
    assert np.flatnonzero(~found.used).tolist() == [1, 3, 7, 10, 11]
    assert {args[9] for args in given} == {12} and len(given) > 1


def test_frames_without_picks_have_no_attitude_and_cost_no_other() -> None:
    """In the middle, and the last, which no pick has the index of."""
    flight = three_frames()
    every = solve(flight).attitudes.rotation
    for frames in ([1, 2], [2], [0]):
        kept, own = ~np.isin(flight.picks.frame, frames), flight.picks
        columns = ("frame", "landmark", "pixel", "sigma_px")
        picks = replace(own, **{name: getattr(own, name)[kept] for name in columns})
        found = solve(replace(flight, picks=picks)).attitudes.rotation
        assert np.isnan(found[frames]).all()
        left = np.setdiff1d(np.arange(3), frames)
        assert np.array_equal(found[left], every[left], equal_nan=True)


def test_frames_with_other_picks_are_solved_anew_and_the_record_before_stays(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    flight = uneven_flight([5, 4, 6, 5])
    before = solve(flight)
    kept, place = before.attitudes.rotation.copy(), before.camera_m.copy()
    given = recorded(monkeypatch)
    left_out = np.zeros(20, bool)
    left_out[11] = True  # of the third frame
    after = solve(flight, left_out, before=before)
    assert {args[1] for args in given} == {1}
    assert np.array_equal(before.attitudes.rotation, kept)
    assert np.array_equal(before.camera_m, place)
    same = [np.array_equal(kept[k], after.attitudes.rotation[k]) for k in range(4)]
    assert same == [True, True, False, True]
    whole = solve(flight, left_out)
    assert np.array_equal(after.attitudes.rotation, whole.attitudes.rotation)
    assert after.raised_most_rad >= before.raised_most_rad > 0.0
    taken_back = solve(flight, before=after)
    assert np.array_equal(taken_back.attitudes.rotation, kept)


def test_the_most_that_any_line_is_raised_is_that_of_all_blocks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("vopd.flight.solve.rotations.AT_ONCE", 5)
    monkeypatch.setattr("vopd.landmark_layout.FEW", 1)
    found = solve(uneven_flight([3, 6, 2, 5]))
    assert found.raised_most_rad == np.nanmax(found.lines.raised_rad) > 0.0


def test_a_part_has_what_belongs_to_its_frames() -> None:
    flight = uneven_flight([4, 3, 5])
    base = solve(flight)
    marks = np.arange(12)
    attitudes = base.attitudes._replace(
        converged=np.array([True, False, True]),
        correction_rad=np.arange(9.0).reshape(3, 3),
        set_aside=(marks % 3).astype(np.int8),
        weight=marks / 2.0,
    )
    whole = replace(base, attitudes=attitudes, used=marks % 2 == 0)
    blocks = FlightBlocks(flight)
    part = whole.part(blocks.part(np.array([2, 1])))
    rows = [7, 8, 9, 10, 11, 4, 5, 6]
    assert part.attitudes.converged.tolist() == [True, False]
    assert part.attitudes.correction_rad.tolist() == [[6, 7, 8], [3, 4, 5]]
    assert part.attitudes.set_aside.tolist() == [k % 3 for k in rows]
    assert part.attitudes.weight.tolist() == [k / 2 for k in rows]
    assert part.used.tolist() == [k % 2 == 0 for k in rows]
    assert np.array_equal(part.camera_m, base.camera_m[[2, 1]])
    assert np.array_equal(part.attitudes.rotation, base.attitudes.rotation[[2, 1]])
    assert part.raised_most_rad == base.raised_most_rad
    assert whole.part(blocks.part(np.arange(3))) is whole


def test_a_long_lever_arm_is_iterated_until_the_camera_stays() -> None:
    """Of 5.4 m at 300 m a correction leaves a fiftieth: the fourth a hundred-millionth."""
    flight, arm = three_frames(), np.array([4.0, -3.0, 2.0])
    body = Rotation.from_euler("ZYX", truth_deg()[:3], degrees=True)
    away = body.apply(arm) @ NED_FROM_ENU  # from the antenna to the camera, east, north, up
    camera = camera_m(TIME_S)
    antenna = camera - np.einsum("fi,fij->fj", away, local_axes(camera))
    path = replace(flight.path, position_m=antenna, lever_arm_m=arm)
    found = solve(replace(flight, path=path))
    truth = truth_deg()[:3] % 360.0 - [0, 360, 0]
    assert_close("flight angle", flight_estimate(found).camera_deg, truth)
    assert_close("flight position", found.camera_m, camera)


def test_attitudes_before_any_solve() -> None:
    none = no_attitudes(2, 3)
    assert np.isnan(none.rotation).all() and np.isnan(none.correction_rad).all()
    assert none.converged.tolist() == [False, False]
    assert none.weight.tolist() == none.set_aside.tolist() == [0, 0, 0]


# Frames without an attitude by reason, picks that are set aside, and labels of frames


def told(
    picks: list[int], lost: list[bool], unknown: tuple[int, ...] = (), names: bool = False,
    stray: int = -1,
) -> list[Finding]:  # fmt: skip
    """What is said of frames with so many picks, some without an attitude or a position."""
    frames = len(picks)
    rotation, position = np.ones((frames, 3, 3)), np.ones((frames, 3))
    rotation[lost] = np.nan
    position[list(unknown)] = np.nan
    flight: Any = SimpleNamespace(
        frame=10 + np.arange(frames),
        image_name=tuple(f"{k}.jpg" for k in range(frames)) if names else (),
        picks=SimpleNamespace(frame=np.repeat(np.arange(frames), picks)),
        path=SimpleNamespace(position_m=position),
        source="flight.toml",
    )
    converged = np.arange(frames) != stray
    attitudes = SimpleNamespace(rotation=rotation, converged=converged)
    solved: Any = SimpleNamespace(attitudes=attitudes)
    return frames_unsolved(flight, solved)


@pytest.mark.parametrize("picks", [0, 1, 2, 3, 40])
def test_fewer_than_two_picks_are_one_reason_and_others_are_the_other(picks: int) -> None:
    assert_approved(told([5, picks], [False, True]))


def test_frames_with_an_attitude_or_without_a_position_are_not_named() -> None:
    assert told([3, 1, 0], [False] * 3) == []
    assert told([3, 1, 0], [True] * 3, unknown=(0, 1, 2)) == []
    assert_approved(told([3, 1, 2], [True] * 3, unknown=(0,)))


def test_a_frame_that_did_not_converge_is_named() -> None:
    assert_approved(told([3, 1, 4], [False, True, False], stray=2))
    assert len(told([3], [True], stray=0)) == 1  # it has no attitude to converge


@pytest.mark.parametrize("count", [4, 5, 6, 12])
@pytest.mark.parametrize("picks", [1, 2])
def test_five_frames_are_named(count: int, picks: int) -> None:
    assert_approved(told([picks] * count, [True] * count, names=True))


def test_a_frame_is_called_by_its_image_or_its_own_number() -> None:
    flight: Any = SimpleNamespace(frame=np.array([7, 5]), image_name=())
    assert [frame_label(flight, k) for k in (0, 1)] == ["frame 7", "frame 5"]
    flight.image_name = ("a.jpg", "b.jpg")
    assert [frame_label(flight, k) for k in (0, 1)] == ["a.jpg", "b.jpg"]
