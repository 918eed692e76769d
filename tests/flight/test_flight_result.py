"""What the library returns for a flight project."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd as run
from tests.kit.flight_project import (
    FRAMES,
    MARK,
    TOML,
    camera_m,
    three_frames,
    truth_deg,
    uneven_flight,
    write_project,
)
from tests.kit.joint_flights import drone, flight_of
from tests.tolerances import assert_close, within
from vopd.attitude.sigmas import Sigmas
from vopd.findings import VopdError
from vopd.flight import result as result_module
from vopd.flight.flight import (
    CameraPath,
    FlightOptions,
    LandmarkSet,
    Picks,
    Refraction,
    TrackFixes,
)
from vopd.flight.misfits.blunders import Blunders
from vopd.flight.misfits.unsolved import require_two_landmarks
from vopd.flight.result import freed_beside_blunders, solve_flight, solve_flight_read
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.rotations import FlightBlocks


def test_a_flight_is_solved_by_one_call(tmp_path: Path) -> None:
    flight = vopd.solve_flight(write_project(tmp_path))
    assert isinstance(flight, vopd.FlightResult)
    truth = truth_deg() % 360.0 - [0, 360, 0]
    assert_close("flight angle", flight.camera_deg, truth)
    assert_close("flight angle", flight.vehicle_deg, truth)
    assert flight.frame.tolist() == list(range(FRAMES)) and flight.image_name == ()
    assert flight.solved.all() and flight.findings == ()
    assert flight.about[0] == "lens: brown, 5 coefficients, centre grid"
    assert np.isfinite(flight.attack_deg).all()
    assert repr(flight).endswith("flight.toml, 5 frames)")


def test_between_exact_positions_a_held_path_is_as_uncertain_as_positions_of_its_sigma() -> None:
    """2 m of every frame, as of positions that are good to 2 m; neither is solved for."""
    rng = np.random.default_rng(7)
    flight = flight_of(rng, drone(rng, 6, 6), 0.3, Priors())
    frames = len(flight.frame)
    flight = replace(flight, options=FlightOptions(solve_position=False))
    stated = solve_flight_read(flight).history(Sigmas(position=2.0)).uncertainty.components
    two_m = np.full((frames, 3), 2.0)
    fixes = TrackFixes(np.arange(frames), np.ones((frames, 1)), two_m, np.ones(frames, bool))
    between = solve_flight_read(replace(flight, path=replace(flight.path, fixes=fixes)))
    found = between.history().uncertainty.components
    assert (found["interpolation"][:, :3] > 0.0).all() and "position" not in found
    assert_close("ratio", found["interpolation"], stated["position"])


def test_its_table_has_the_columns_of_the_command(tmp_path: Path) -> None:
    flight = vopd.solve_flight(write_project(tmp_path, noise_px=0.3))
    table = flight.to_dataframe()
    assert len(table) == FRAMES
    assert np.abs(table["camera_yaw_deg"] - flight.camera_deg[:, 0]).max() < within("six decimals")
    assert (table["sigma_camera_yaw_deg"] > 0.0).all()
    assert table.attrs["project"].endswith("flight.toml")
    assert "jump" in " ".join(flight.to_dataframe(max_rate_deg_s=1.0)["flags"])


def test_its_angles_against_the_vertical_that_is_asked_for(tmp_path: Path) -> None:
    """Pitch is the elevation of the forward axis above the plane across the Earth's radius."""
    flight = vopd.solve_flight(write_project(tmp_path))
    up = camera_m(flight.time_s)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    position = flight.estimate.position
    yaw, pitch, _ = np.radians(flight.vehicle_deg.T)
    forward = np.stack([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
    earth_fixed = np.einsum("kf,fki->fi", forward, position.north_east_down)
    expected = np.degrees(np.arcsin((earth_fixed * up).sum(axis=1)))
    turned = flight.history(vertical="geocentric").estimate.vehicle_deg[:, 1]
    assert_close("flight angle", turned, expected)
    assert np.abs(turned - flight.vehicle_deg[:, 1]).min() > within("flight angle")
    table = flight.to_dataframe(vertical="geocentric")
    assert np.abs(table["vehicle_pitch_deg"] - expected).max() < within("six decimals")


def test_frames_and_times_are_the_callers_own(tmp_path: Path) -> None:
    """Counted from the first frame in place, they leave the flight and its table as they are."""
    result = solve_flight(write_project(tmp_path))
    before = result.to_dataframe()[["frame", "time_s"]]
    times, frames = result.time_s, result.frame
    times -= 1.0
    frames += 7
    assert result.to_dataframe()[["frame", "time_s"]].equals(before)


def test_a_frame_with_one_landmark_is_not_solved(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([*rows[:26]]))
    flight = vopd.solve_flight(path)
    assert flight.solved.tolist() == [True, True, True, True, False]
    assert np.isnan(flight.camera_deg[4]).all()
    assert "frame 4: fewer than two landmarks" in str(flight.findings[0])


def test_a_project_is_read_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[Any] = []
    monkeypatch.setattr(result_module, "read_flight", lambda *a: given.append(a) or three_frames())
    monkeypatch.setattr(result_module, "solve_flight_read", lambda flight, project: flight)
    solve_flight("a.toml")
    solve_flight("b.toml", "/elsewhere/c.toml")
    assert given == [("a.toml", None), ("b.toml", "/elsewhere/c.toml")]


def test_findings_are_of_files_and_then_of_picks_and_then_of_frames(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(result_module, "blunder_findings", lambda *_: ["blunder"])
    monkeypatch.setattr(result_module, "picks_set_aside", lambda *_: ["set aside"])
    monkeypatch.setattr(result_module, "frames_unsolved", lambda *_: ["unsolved"])
    of_file: Any = "of a file"
    flight = replace(three_frames(), findings=(of_file,))
    found = solve_flight_read(flight).findings
    assert list(found) == ["of a file", "blunder", "set aside", "unsolved"]


@pytest.mark.parametrize(("frames", "enough"), [([0, 0, 1], True), ([0, 1, 2], False)])
def test_a_flight_is_refused_where_no_frame_has_two_landmarks_that_are_used(
    frames: list[int], enough: bool
) -> None:
    """The last pick of each is of a check landmark, and does not count."""
    base = three_frames()
    frame, mark = np.array([*frames, 0, 1, 2]), np.array([0, 1, 2, 3, 3, 3])
    picks = replace(
        base.picks, frame=frame, landmark=mark, pixel=np.ones((6, 2)), sigma_px=np.ones(6)
    )
    flight = replace(base, picks=picks)
    if enough:
        require_two_landmarks(flight)
        return
    with refused(VopdError):
        require_two_landmarks(flight)


# What a flight's records hold where nothing is given, its landmarks' numbers, and its parts


NONE = np.zeros(0)


def test_what_is_usual() -> None:
    """Documented in docs/flight-project.md: least squares, blunders kept, k = .13 that decays."""
    assert FlightOptions() == FlightOptions("least-squares", False, True, {}, ())
    assert Refraction() == Refraction(0.13, True)
    picks = Picks(NONE, NONE, NONE, NONE)
    assert np.isnan(picks.repeatability_px)
    assert (picks.one_sigma_px, picks.least_sigma_px) == (1.0, 0.3)
    path = CameraPath(NONE)
    assert path.bias_sigma_m.tolist() == [0.0] * 3 and path.wind_sigma_m_s == 0.0
    for name in (
        "fixes",
        "velocity_sigma_m_s",
        "velocity_m_s",
        "acceleration_m_s2",
        "wind_m_s",
        "lever_arm_m",
        "gimbal_deg",
    ):
        assert getattr(path, name) is None
    flight = three_frames()
    assert flight.refraction == Refraction() and (flight.about, flight.findings) == ((), ())
    assert LandmarkSet((), NONE, NONE).used == ()


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (("7", "3", "12"), [7, 3, 12]),
        (("007", "3"), [7, 3]),
        (("7", "07"), [1, 2]),
        (("7", "b"), [1, 2]),
        (("7", "-3"), [1, 2]),
        (("7", "²"), [1, 2]),
        (("7", "٣"), [1, 2]),
        (("7", ""), [1, 2]),
        (("9" * 17, "1"), [99999999999999999, 1]),
        (("9" * 18, "1"), [1, 2]),
    ],
)  # fmt: skip
def test_names_that_are_whole_numbers_are_numbers(names: Any, numbers: list[int]) -> None:
    assert LandmarkSet(names, NONE, NONE).number.tolist() == numbers


@pytest.mark.parametrize(
    ("angles", "first"),
    [([1.5, 2.5, 3.0], 1.5), ([np.nan, 2.5, 3.0], 2.5), ([np.nan] * 3, np.nan)],
)
def test_the_convergence_is_that_of_the_first_position(angles: Any, first: float) -> None:
    flight = three_frames()
    assert flight.grid is not None
    grid = replace(flight.grid, convergence_deg=np.array(angles))
    found = replace(flight, grid=grid).grid_convergence_deg
    assert found == first or np.isnan([found, first]).all()
    assert np.isnan(replace(flight, grid=None).grid_convergence_deg)


@pytest.mark.parametrize("order", [np.arange(12), np.arange(12)[::-1]])
def test_a_part_has_every_field_of_its_frames(order: Any) -> None:
    """Frames c and b of three, whose picks stand in the file in order or backward."""
    base = three_frames()
    picks = replace(
        base.picks,
        frame=base.picks.frame[order], landmark=base.picks.landmark[order],
        pixel=np.arange(24.0).reshape(12, 2)[order], sigma_px=np.arange(12.0)[order],
    )  # fmt: skip
    flight = replace(base, picks=picks)
    whole = FlightBlocks(flight)
    chosen, rows, part = whole.part(np.array([2, 1]))
    assert chosen.tolist() == [2, 1]
    pick = picks.sigma_px[rows].astype(int)  # its number in the order of frames
    assert sorted(pick[:4]) == [8, 9, 10, 11] and sorted(pick[4:]) == [4, 5, 6, 7]
    assert part.picks.sigma_px.tolist() == pick.tolist()
    assert part.picks.pixel.tolist() == [[2 * k, 2 * k + 1] for k in pick]
    assert part.picks.landmark.tolist() == [k % MARK for k in pick]
    assert part.picks.frame.tolist() == [0] * 4 + [1] * 4
    assert (part.picks.repeatability_px, part.picks.one_sigma_px) == (0.7, 2.0)
    assert part.frame.tolist() == [12, 9] and part.image_name == ("c.jpg", "b.jpg")
    assert part.time_s.tolist() == base.time_s[[2, 1]].tolist()
    assert part.grid is not None and part.grid.crs == "EPSG:32633"
    assert (part.grid.easting.tolist(), part.grid.northing.tolist()) == ([2, 1], [7, 6])
    assert len(part.grid.convergence_deg) == 2
    for name in ("position_m", "velocity_m_s", "acceleration_m_s2", "wind_m_s", "gimbal_deg"):
        ours, all_frames = getattr(part.path, name), getattr(base.path, name)
        assert np.array_equal(ours, all_frames[[2, 1]], equal_nan=True)
    assert part.path.fixes is not None and base.path.fixes is not None
    own = part.path.fixes  # of the two fixes that these frames depend on
    assert own.first.tolist() == [1, 0] and own.weight.tolist() == [[1], [1]]
    assert np.array_equal(own.sigma_m, base.path.fixes.sigma_m[[1, 2]])
    numbered = FlightBlocks(replace(flight, image_name=(), grid=None)).part(np.array([1])).flight
    assert numbered.image_name == () and numbered.grid is None
    every = whole.part(np.arange(3))
    assert every.flight is flight and every.picks.tolist() == list(range(12))


def test_blocks_have_all_chosen_frames_and_no_block_without_one() -> None:
    blocks = FlightBlocks(uneven_flight([4, 3, 5, 2, 1]))
    assert sorted(k for part in blocks for k in part.frames.tolist()) == [0, 1, 2, 3, 4]
    chosen = np.array([False, True, False, True, False])
    assert sorted(k for p in blocks.parts(chosen) for k in p.frames.tolist()) == [1, 3]
    assert [*blocks.parts(np.zeros(5, bool))] == []


# The epoch of a flight project in the files that have dates


def test_a_project_states_its_own_epoch(tmp_path: Path) -> None:
    """2 s after 11:58:42; the option has precedence."""
    project = write_project(tmp_path)
    aem, czml = (run("attitude", project, "--format", form).stdout for form in ("aem", "czml"))
    assert "START_TIME = 2026-05-01T11:58:44.000000" in aem
    assert '"epoch": "2026-05-01T11:58:42.000000Z"' in czml
    given = ("--epoch", "2020-01-01T00:00:00Z")
    aem = run("attitude", project, "--format", "aem", *given).stdout
    assert "START_TIME = 2020-01-01T00:00:02.000000" in aem
    assert "zero is 2020-01-01T00:00:00.000000Z" in aem and "2026-05-01T11" not in aem


START_S = 1_777_636_722  # 2026-05-01T11:58:42Z, since 1970


def test_times_since_1970_have_no_other_zero(tmp_path: Path) -> None:
    """Frames whose times a CSV has beside a project without epoch, and the option."""
    text = "frame,t_s\n" + "".join(f"{k},{START_S + 2.0 + k / 10}\n" for k in range(5))
    (tmp_path / "times.csv").write_text(text)
    toml = TOML.replace("epoch = 2026-05-01T11:58:42Z\n", "")
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n"
    toml = toml.replace(rate, 'times = "times.csv"\n')
    path = write_project(tmp_path, toml.replace("sigma_t_s", f"offset_s = {START_S}\nsigma_t_s"))
    ran = run("attitude", path, "--format", "aem", "--epoch", "2026-05-01T11:58:42Z")
    assert ran.status == 1
    assert_approved(ran.stderr)
    aem = run("attitude", path, "--format", "aem", "--epoch", "1970-01-01T00:00:00Z").stdout
    assert "START_TIME = 2026-05-01T11:58:44.000000" in aem


GPS_S = START_S - 315_964_800 + 18  # since 1980-01-06, without leap seconds


def test_gps_seconds_are_named_with_the_line_that_brings_them_to_the_flights(
    tmp_path: Path,
) -> None:
    """In a column t_s, and in one that is taken for seconds since 1970; and of the frames."""
    path = write_project(tmp_path)
    rows = [one.partition(",") for one in (tmp_path / "track.csv").read_text().splitlines()[1:]]
    for name, more in (("t_s", ""), ("time", 'clock = "gps"\n')):
        text = "".join(f"{float(t) + GPS_S},{rest}\n" for t, _, rest in rows)
        (tmp_path / "track.csv").write_text(f"{name},lat_deg,lon_deg,h_m\n{text}")
        path.write_text(TOML.replace("[track]\n", f"[track]\n{more}"))
        with refused(VopdError, parts=[tmp_path]):
            vopd.solve_flight(path)
    cure = f'columns = {{ t_s = "time" }}\noffset_s = {-GPS_S}\n'
    path.write_text(TOML.replace("[track]\n", f"[track]\n{cure}"))
    truth = truth_deg() % 360.0 - [0, 360, 0]
    assert_close("flight angle", vopd.solve_flight(path).camera_deg, truth)
    frames = "".join(f"{k},{GPS_S + 2.0 + k / 10}\n" for k in range(5))
    (tmp_path / "times.csv").write_text("frame,t_s\n" + frames)
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n"
    path.write_text(TOML.replace(rate, 'times = "times.csv"\n'))
    with refused(VopdError, parts=[tmp_path]):
        vopd.solve_flight(path)


def test_frames_with_dates_on_a_track_in_seconds_need_the_date_of_its_zero(tmp_path: Path) -> None:
    """Or that of the frames' own first second would be taken for it, 2 s after the track's."""
    text = "frame,t_utc\n" + "".join(f"{k},2026-05-01T11:58:44.{k}Z\n" for k in range(5))
    (tmp_path / "times.csv").write_text(text)
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n"
    toml = TOML.replace(rate, 'times = "times.csv"\n')
    found = solve_flight(write_project(tmp_path, toml)).camera_deg
    assert_close("flight angle", found, truth_deg() % 360.0 - [0, 360, 0])
    path = write_project(tmp_path, toml.replace("epoch = 2026-05-01T11:58:42Z\n", ""))
    ran = run("attitude", path)
    assert ran.status == 1
    assert_approved(ran.stderr, parts=[path])


def test_projects_without_one_epoch_have_no_dates(tmp_path: Path) -> None:
    dated = write_project(tmp_path / "dated")
    toml = TOML.replace("epoch = 2026-05-01T11:58:42Z\n", "")
    undated = write_project(tmp_path / "undated", toml)
    ran = run("attitude", undated, "--format", "aem")
    assert ran.status == 1
    assert_approved(ran.stderr)
    ran = run("attitude", dated, undated, "--format", "czml")
    assert ran.status == 1
    assert_approved(ran.stderr)
    ran = run("attitude", dated, undated)
    assert ran.status == 0 and "zero is each source's own epoch" in ran.stdout


@pytest.mark.parametrize("apart", [True, False])
def test_what_named_picks_did_to_free_parameters_is_said(apart: bool) -> None:
    """They are left out of what frames have in common, or are too many for that."""
    flight = three_frames()
    flight = replace(flight, options=replace(flight.options, free=("focal", "k1")))
    pick = np.arange(len(flight.picks.frame)) < 3
    none, marks = np.zeros_like(pick), np.zeros(len(flight.landmarks.name), bool)
    found = Blunders(
        pick, none, marks, marks, np.full((len(marks), 3), np.nan), pick, np.zeros(len(pick))
    )
    (said,) = freed_beside_blunders(flight, found, pick if apart else none)
    assert_approved(said)
    for fixed in (replace(flight.options, free=()), replace(flight.options, drop_blunders=True)):
        assert freed_beside_blunders(replace(flight, options=fixed), found, pick) == []


@pytest.mark.parametrize("drop", [True, False])
@pytest.mark.parametrize("seed", [30, 57])
def test_a_wild_pick_of_the_only_frame_costs_no_flight(seed: int, drop: bool) -> None:
    """With it the free parameters have no solution; without it four landmarks are three."""
    rng, speed_m_s = np.random.default_rng(seed), (3.0, 4.0, 0.5)
    exact = Priors(None, np.zeros((4, 3)))
    flight = flight_of(rng, drone(rng, 1, 4), 1.0, exact, velocity_m_s=speed_m_s)
    pixel = flight.picks.pixel + np.array([[0.0, 0.0]] * 3 + [[4000.0, 1000.0]])
    options = replace(flight.options, free=("clock", "focal"), drop_blunders=drop)
    solved = solve_flight_read(
        replace(flight, picks=replace(flight.picks, pixel=pixel), options=options)
    )
    assert solved.estimates.solved.attitudes.converged.all()
    assert_approved([str(one) for one in solved.findings if "P3 does" in str(one)])
