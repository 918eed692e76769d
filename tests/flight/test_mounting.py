"""The mount of a camera: in a vehicle whose attitude a file has, or doubted for what comes out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import three_frames
from tests.kit.simulated_flights import Errors, Plan, body_to_ned, write_flight
from tests.tolerances import assert_close
from vopd.cli.new import write_project
from vopd.findings import VopdError
from vopd.flight.adjust.adjustment import Adjustment, adjust
from vopd.flight.adjust.project import adjusted_project
from vopd.flight.angles import doubted_angles
from vopd.flight.check import check_flight
from vopd.flight.flight import CameraPath
from vopd.flight.project.keys import read_project
from vopd.flight.project.read import read_flight
from vopd.flight.result import solve_flight
from vopd.flight.words import mount_sentence
from vopd.geometry.rotations import mount_by_angles

PLAN = Plan(Errors(0.3), frames=20, landmarks=6, sigma_px=True, frame_hz=5.0, jitter_deg=0.0)
SENSOR_DEG = 0.3


def write(
    folder: Path, turn_deg: list[float], keys: str, rng: np.random.Generator, plan: Plan = PLAN
) -> None:
    """A camera that looks forward, but for a turn about the vehicle's forward, right, down."""
    truth = write_flight(folder, plan, rng)
    mount = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    vehicle = body_to_ned(truth.angles_deg[:, 3:6]) @ mount.T
    noise = rng.normal(0.0, SENSOR_DEG, (PLAN.frames, 3))
    wrong = vehicle @ Rotation.from_rotvec(noise, degrees=True).as_matrix()
    angles = Rotation.from_matrix(wrong).as_euler("ZYX", degrees=True)
    rows = [f"{k},{k / 5.0},{y},{p},{r}" for k, (y, p, r) in enumerate(angles.tolist())]
    text = "\n".join([f"{keys},yaw_deg,pitch_deg,roll_deg", *rows, ""])
    (folder / "ins.csv").write_text(text, encoding="utf-8")
    file = folder / "flight.toml"
    more = f'[vehicle]\nattitude = "ins.csv"\nattitude_sigma_deg = {SENSOR_DEG}\n'
    file.write_text(file.read_text(encoding="utf-8") + more, encoding="utf-8")


def solved(folder: Path, seed: int, keys: str = "frame,second") -> Adjustment:
    write(folder, [1.0, -2.0, 3.0], keys, np.random.default_rng(seed))
    return adjust(folder / "flight.toml", ["mount"])


@pytest.mark.parametrize("keys", ["frame,second", "row,t_s"])
def test_the_mount_is_within_its_standard_deviations(tmp_path: Path, keys: str) -> None:
    found = solved(tmp_path, 1, keys).parameters
    assert [one.name for one in found] == ["mount forward", "mount right", "mount down"]
    sigma = np.array([one.sigma_after for one in found])
    # the mean of twenty attitudes; the camera's own error is a hundredth of theirs
    assert_close("mount", sigma, SENSOR_DEG / np.sqrt(20.0))
    off = np.array([one.after for one in found]) - [1.0, -2.0, 3.0]
    assert (np.abs(off) < 4.0 * sigma).all()


@pytest.mark.parametrize("first", [1, 3])
def test_a_gap_of_three_steps_is_interpolated_however_it_is_rounded(
    tmp_path: Path, first: int
) -> None:
    """Of the rows at k / 5 s two are missing: 3 steps are .8 - .2 s or 1.2 - .6."""
    write(tmp_path, [1.0, -2.0, 3.0], "row,t_s", np.random.default_rng(1))
    lines = (tmp_path / "ins.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    text = "".join(lines[: first + 1] + lines[first + 3 :])
    (tmp_path / "ins.csv").write_text(text, encoding="utf-8")
    found = adjust(tmp_path / "flight.toml", ["mount"]).parameters
    assert_close("mount", [one.sigma_after for one in found], SENSOR_DEG / np.sqrt(20.0))


def test_the_vehicle_has_the_error_of_the_mount_that_was_solved_for(tmp_path: Path) -> None:
    """About each axis .3 degree of twenty readings, beside hundredths of the camera's own."""
    made = solved(tmp_path, 1)
    components = made.result.history().uncertainty.components
    assert_close("mount", components["mount"][:, 3:6].min(), SENSOR_DEG / np.sqrt(20.0))
    assert not components["mount"][:, :3].any()
    *_, what_no_sigma_has = made.result.history().about.words.conventions["mount"].split("; ")
    assert_approved(what_no_sigma_has)


def test_attitudes_of_images_are_those_of_their_frames(tmp_path: Path) -> None:
    """Images that are named backward, so that their order is another than that of the rows.

    The picks alone name their folder.
    """
    by_frame = solved(tmp_path, 1).parameters
    name = {str(k): f"{90 - k}.jpg" for k in range(PLAN.frames)}
    for file in ("picks.csv", "ins.csv"):
        head, *lines = (tmp_path / file).read_text(encoding="utf-8").splitlines()
        inside = "cam/" * (file == "picks.csv")
        rows = [",".join([inside + name[one.split(",")[0]], *one.split(",")[1:]]) for one in lines]
        text = "\n".join([head.replace("frame", "image", 1), *rows, ""])
        (tmp_path / file).write_text(text, encoding="utf-8")
    times = "".join(f"{name[str(k)]},{k / 5.0}\n" for k in range(PLAN.frames))
    (tmp_path / "times.csv").write_text(f"image,t_s\n{times}", encoding="utf-8")
    project = tmp_path / "flight.toml"
    lines = project.read_text(encoding="utf-8").splitlines()
    kept = [one for one in lines if not one.startswith(("frame_rate_hz", "first_frame_t_s"))]
    kept.insert(kept.index("[picks]") + 1, 'times = "times.csv"')
    project.write_text("\n".join([*kept, ""]), encoding="utf-8")
    by_image = adjust(project, ["mount"]).parameters
    both = [[(one.after, one.sigma_after) for one in found] for found in (by_image, by_frame)]
    assert_close("symmetric flight", both[0], both[1])
    # names under `frame`, as of picks; beside numbers of the logger's own; and these alone
    head, *rows = (tmp_path / "ins.csv").read_text(encoding="utf-8").splitlines()
    counted = [f"{k},{one}" for k, one in enumerate(rows, 1)]
    for names, lines in (("file_name", rows), ("frame", rows), ("frame,image", counted)):
        text = "\n".join([head.replace("image", names, 1), *lines, ""])
        (tmp_path / "ins.csv").write_text(text, encoding="utf-8")
        assert [one.after for one in adjust(project, ["mount"]).parameters] == [
            one.after for one in by_image
        ]
    text = "\n".join([head.replace("image", "frame,was", 1), *counted, ""])
    (tmp_path / "ins.csv").write_text(text, encoding="utf-8")
    with refused():
        adjust(project, ["mount"])


def test_attitudes_of_images_with_a_frame_rate_go_by_number_or_by_name(tmp_path: Path) -> None:
    """And by either before a time, here one of another clock; so do those of numbered frames."""
    by_frame = [one.after for one in solved(tmp_path, 1).parameters]
    head, *lines = (tmp_path / "picks.csv").read_text(encoding="utf-8").splitlines()
    named = [
        f"f{int(frame):03d}.png,{rest}" for frame, _, rest in (o.partition(",") for o in lines)
    ]
    picks = "\n".join([head.replace("frame", "image", 1), *named, ""])
    head, *lines = (tmp_path / "ins.csv").read_text(encoding="utf-8").splitlines()
    cells = [one.split(",", 2) for one in lines]
    numbers = [f"{k},{float(s) + 100.0},{rest}" for k, s, rest in cells]
    names = [f"f{int(k):03d}.png,{k},{rest}" for k, _, rest in cells]
    for keys, rows, own in (
        ("frame,t_s", numbers, ""), ("frame,t_s", numbers, picks), ("image,row", names, picks),
    ):  # fmt: skip
        text = "\n".join([head.replace("frame,second", keys), *rows, ""])
        (tmp_path / "ins.csv").write_text(text, encoding="utf-8")
        if own:
            (tmp_path / "picks.csv").write_text(own, encoding="utf-8")
        found = [one.after for one in adjust(tmp_path / "flight.toml", ["mount"]).parameters]
        assert_close("symmetric flight", found, by_frame)


def with_dates(path: Path, column: int, ahead_s: int = 0) -> None:
    """Write seconds of a table as dates, 40 s after a minute and so many ahead of UTC."""
    head, *lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines]
    for row in rows:
        minutes, seconds = divmod(float(row[column]) + 40.0 + ahead_s, 60.0)
        row[column] = f"2026-05-01T11:{58 + minutes:02.0f}:{seconds:06.3f}{'' if ahead_s else 'Z'}"
    text = "\n".join([head.replace("t_s", "t_utc", 1), *map(",".join, rows), ""])
    path.write_text(text, encoding="utf-8")


def frames_with_dates(folder: Path, ahead_s: int = 0) -> Path:
    """Write a flight whose frames and track have dates, the track's on the clock of GPS or UTC."""
    write(folder, [1.0, -2.0, 3.0], "row,t_s", np.random.default_rng(1))
    times = "".join(f"{k},2026-05-01T11:58:{k / 5.0 + 40:06.3f}Z\n" for k in range(PLAN.frames))
    (folder / "times.csv").write_text(f"frame,t_utc\n{times}", encoding="utf-8")
    with_dates(folder / "track.csv", 0, ahead_s)
    project = folder / "flight.toml"
    lines = project.read_text(encoding="utf-8").splitlines()
    kept = [one for one in lines if not one.startswith(("frame_rate_hz", "first_frame_t_s"))]
    kept.insert(kept.index("[picks]") + 1, 'times = "times.csv"')
    kept.insert(kept.index("[track]") + 1, f'clock = "{"gps" if ahead_s else "utc"}"')
    project.write_text("\n".join([*kept, ""]), encoding="utf-8")
    return project


def test_attitudes_in_seconds_need_the_date_of_their_zero_beside_frames_with_dates(
    tmp_path: Path,
) -> None:
    project = frames_with_dates(tmp_path)
    with refused():
        adjust(project, ["mount"])


@pytest.mark.parametrize("ahead_s", [0, 18])
def test_attitudes_may_have_dates_on_the_clock_of_the_track(ahead_s: int, tmp_path: Path) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "dated").mkdir()
    by_seconds = solved(tmp_path / "own", 1, "row,t_s").parameters
    project = frames_with_dates(tmp_path / "dated", ahead_s)
    with_dates(tmp_path / "dated" / "ins.csv", 1, ahead_s)
    found = adjust(project, ["mount"]).parameters
    assert_close("mount", [one.after for one in found], [one.after for one in by_seconds])


def test_attitudes_with_dates_need_the_date_of_frames_in_seconds(tmp_path: Path) -> None:
    write(tmp_path, [1.0, -2.0, 3.0], "row,t_s", np.random.default_rng(1))
    with_dates(tmp_path / "ins.csv", 1)
    with refused():
        adjust(tmp_path / "flight.toml", ["mount"])


def test_attitudes_are_on_the_clock_of_the_track(tmp_path: Path) -> None:
    """Of a track and attitudes that begin 7 s later by their clock, which the project says."""
    (tmp_path / "own").mkdir()
    (tmp_path / "late").mkdir()
    found = solved(tmp_path / "own", 1, "row,t_s").parameters
    write(tmp_path / "late", [1.0, -2.0, 3.0], "row,t_s", np.random.default_rng(1))
    for name, column in (("track.csv", 0), ("ins.csv", 1)):
        head, *lines = (tmp_path / "late" / name).read_text(encoding="utf-8").splitlines()
        assert head.split(",")[column] == "t_s"
        rows = [line.split(",") for line in lines]
        for row in rows:
            row[column] = repr(float(row[column]) + 7.0)
        text = "\n".join([head, *map(",".join, rows), ""])
        (tmp_path / "late" / name).write_text(text, encoding="utf-8")
    project = tmp_path / "late" / "flight.toml"
    text = project.read_text(encoding="utf-8").replace("[track]", "[track]\noffset_s = -7.0")
    project.write_text(text, encoding="utf-8")
    late = adjust(project, ["mount"]).parameters
    assert_close("mount", [one.after for one in late], [one.after for one in found])


@pytest.mark.parametrize(("sigma_deg", "said"), [(0.12, False), (0.05, True)])
def test_attitudes_that_are_not_one_mount_apart_are_told(
    sigma_deg: float, said: bool, tmp_path: Path
) -> None:
    """They are .3 degree off: twice what is stated, or six times."""
    write(tmp_path, [1.0, -2.0, 3.0], "frame,second", np.random.default_rng(1))
    file = tmp_path / "flight.toml"
    stated = f"attitude_sigma_deg = {SENSOR_DEG}"
    text = file.read_text(encoding="utf-8")
    assert stated in text
    text = text.replace(stated, f"attitude_sigma_deg = {sigma_deg}")
    file.write_text(text, encoding="utf-8")
    findings = adjust(file, ["mount"]).result.findings
    found = [one.message for one in findings if one.message.startswith("free mount:")]
    assert len(found) == said
    assert_approved(found)


def test_attitudes_that_are_not_used_are_told(tmp_path: Path) -> None:
    """The mount is not free: nobody heard that the file had no part."""
    write(tmp_path, [1.0, -2.0, 3.0], "frame,second", np.random.default_rng(1))
    file = tmp_path / "flight.toml"
    for found in (solve_flight(file).findings, check_flight(str(file))):
        assert_approved([one for one in found if "ins.csv" in one.message])
    with file.open("a", encoding="utf-8") as more:
        more.write('[solve]\nfree = ["mount"]\n')
    for found in (solve_flight(file).findings, check_flight(str(file))):
        assert not any("ins.csv" in one.message for one in found)


def test_late_frames_have_the_attitude_of_their_own_moment(tmp_path: Path) -> None:
    """The vehicle turns by degrees in the .4 s that the frames' clock is fast."""
    plan = PLAN._replace(swing_deg=15.0, speed_m_s=30.0)
    write(tmp_path, [1.0, -2.0, 3.0], "row,t_s", np.random.default_rng(1), plan)
    file = tmp_path / "flight.toml"
    text = file.read_text(encoding="utf-8").replace('sigma_t_s = "exact"', "sigma_t_s = 1.0")
    file.write_text(text.replace("first_frame_t_s = 0.0", "first_frame_t_s = 0.4"))
    clock, *mount = adjust(file, ["mount", "clock"]).parameters
    assert abs(clock.after + 0.4) < 4.0 * clock.sigma_after
    off = np.array([one.after for one in mount]) - [1.0, -2.0, 3.0]
    assert (np.abs(off) < 4.0 * np.array([one.sigma_after for one in mount])).all()


def test_a_stated_mount_counts_by_its_standard_deviation(tmp_path: Path) -> None:
    """Known as well as by the file, it is met half way, and both together know it better."""
    alone, sigma_deg = solved(tmp_path, 1).parameters, SENSOR_DEG / np.sqrt(20.0)
    with (tmp_path / "flight.toml").open("a", encoding="utf-8") as file:
        file.write(f"mount_sigma_deg = {sigma_deg}\n")
    both = adjust(tmp_path / "flight.toml", ["mount"]).parameters
    for one, own in zip(both, alone, strict=True):
        assert one.sigma_before == sigma_deg
        assert_close("mount", one.after, own.after / 2.0)
        assert_close("mount", one.sigma_after, sigma_deg / np.sqrt(2.0))


def test_the_adjusted_project_has_the_mount(tmp_path: Path) -> None:
    joint = solved(tmp_path, 1)
    project, new = read_project(str(tmp_path / "flight.toml")), tmp_path / "new"
    made = adjusted_project(project, joint, new)
    assert_approved([one for one in made.said if "[vehicle]" in one])
    write_project(new, made)
    again, before = solve_flight(new / "flight.toml").history(), joint.result.history()
    assert_close("mount", again.estimate.vehicle_deg, before.estimate.vehicle_deg)
    assert_close("mount", again.uncertainty.total, before.uncertainty.total)
    stated = read_project(str(tmp_path / "flight.toml"))
    assert "attitude" in stated.section("vehicle").values
    assert "attitude" not in read_project(str(new / "flight.toml")).section("vehicle").values


@pytest.mark.parametrize("what", ["no times", "no sigmas", "no frame", "no file", "no yaw"])
def test_what_is_missing_is_said(tmp_path: Path, what: str) -> None:
    write(tmp_path, [0.0] * 3, "row,second" if what == "no times" else "frame,second",
          np.random.default_rng(1))  # fmt: skip
    file, rows = tmp_path / "flight.toml", tmp_path / "ins.csv"
    text = file.read_text(encoding="utf-8")
    if what == "no sigmas":
        text = text.replace(f"attitude_sigma_deg = {SENSOR_DEG}\n", "")
    if what == "no file":
        text = text.partition("[vehicle]")[0]
    file.write_text(text, encoding="utf-8")
    if what == "no frame":
        head, *lines = rows.read_text(encoding="utf-8").splitlines()
        rows.write_text("\n".join([head, *(f"9{one}" for one in lines)]), encoding="utf-8")
    if what == "no yaw":  # and no key that would map it
        named = rows.read_text(encoding="utf-8").replace("yaw_deg", "gimbal_yaw_deg", 1)
        rows.write_text(named, encoding="utf-8")
    with refused():
        adjust(file, ["mount"])


@pytest.mark.parametrize("rows", ["", "0,1,2,3\n1,1,2,3\n0,9,2,3\n", "1.7,1,2,3\n", "-1,1,2,3\n"])
@pytest.mark.parametrize("by", ["frame", "image"])
def test_attitudes_that_are_of_no_frame_or_twice_of_one(by: str, rows: str, tmp_path: Path) -> None:
    """None at all, twice of one frame, and numbers that are no frame's: 1.7 was frame 1."""
    write(tmp_path, [1.0, -2.0, 3.0], "frame,second", np.random.default_rng(1))
    (tmp_path / "ins.csv").write_text(f"{by},yaw_deg,pitch_deg,roll_deg\n{rows}")
    with refused(VopdError):
        adjust(tmp_path / "flight.toml", ["mount"])


def test_attitudes_with_sigmas_of_their_own(tmp_path: Path) -> None:
    """Half of them are known ten times as well; an empty cell has that of the project."""
    write(tmp_path, [1.0, -2.0, 3.0], "frame,second", np.random.default_rng(1))
    rows = tmp_path / "ins.csv"
    head, *lines = rows.read_text(encoding="utf-8").splitlines()
    lines = [f"{one},{'0.03' if k % 2 else ''}" for k, one in enumerate(lines)]
    rows.write_text("\n".join([f"{head},sigma_deg", *lines, ""]), encoding="utf-8")
    read = read_flight(str(tmp_path / "flight.toml")).vehicle
    assert read is not None
    assert_close("ratio", np.degrees(read.sigma_rad), [SENSOR_DEG, 0.03] * 10)


def _with_rows(folder: Path, change: Callable[[int, str], str | None], more: str = "") -> float:
    """Write other rows of attitudes by time: the standard deviation of the mount, degrees."""
    folder.mkdir(exist_ok=True)
    write(folder, [1.0, -2.0, 3.0], "row,t_s", np.random.default_rng(1))
    file = folder / "ins.csv"
    head, *lines = file.read_text(encoding="utf-8").splitlines()
    rows = filter(None, (change(k, one) for k, one in enumerate(lines)))
    file.write_text("\n".join([head + more, *rows, ""]), encoding="utf-8")
    return adjust(folder / "flight.toml", ["mount"]).parameters[0].sigma_after


def test_frames_in_a_gap_of_the_attitudes_have_none(tmp_path: Path) -> None:
    """Of rows every .2 s: up to three such steps are interpolated over, four are not."""
    short = _with_rows(tmp_path / "a", lambda k, row: None if k in (9, 10) else row)
    long = _with_rows(tmp_path / "b", lambda k, row: None if 8 < k < 12 else row)
    frames = [(SENSOR_DEG / sigma_deg) ** 2 for sigma_deg in (short, long)]
    assert 19.0 < frames[0] < 20.1 and 15.0 < frames[1] < 17.1


def test_attitudes_count_by_the_sigmas_of_their_own_moments(tmp_path: Path) -> None:
    sigma_deg = _with_rows(
        tmp_path, lambda k, row: f"{row},{SENSOR_DEG if k % 2 else 10 * SENSOR_DEG}", ",sigma_deg"
    )
    assert_close("mount", sigma_deg, SENSOR_DEG / np.sqrt(10.0 + 10.0 / 100.0))


def test_attitudes_are_in_order_of_their_times(tmp_path: Path) -> None:
    write(tmp_path, [1.0, -2.0, 3.0], "row,t_s", np.random.default_rng(1))
    rows = tmp_path / "ins.csv"
    lines = rows.read_text(encoding="utf-8").splitlines()
    lines[3:5] = lines[4:2:-1]
    rows.write_text("\n".join(lines), encoding="utf-8")
    with refused(VopdError):
        read_flight(str(tmp_path / "flight.toml"))


AHEAD = Plan(
    Errors(0.3), frames=4, landmarks=5, sigma_px=True, ahead=True, speed_m_s=10.0,
    pitch_deg=(-40.0, -25.0),
)  # fmt: skip


@pytest.mark.parametrize(
    ("mount", "turned", "said"),
    [
        (None, False, []), (None, True, ["upside down"]), ([0, 0, 180], True, []),
        ([0, 0, 180], False, ["upside down"]), ([180, 0, 0], False, ["backward"]),
    ],
)  # fmt: skip
def test_what_turns_the_vehicle_over_or_backward_is_doubted(
    mount: list[float] | None, turned: bool, said: list[str], tmp_path: Path
) -> None:
    """Pictures of 1920 x 1080 that are turned by half a turn, and mounts: no residual tells."""
    write_flight(tmp_path, AHEAD, np.random.default_rng(4))
    file, picks = tmp_path / "flight.toml", tmp_path / "picks.csv"
    if mount is not None:
        file.write_text(f"{file.read_text()}\n[vehicle]\nmount = {{ ypr_deg = {mount} }}\n")
    head, *rows = (line.split(",") for line in picks.read_text().splitlines())
    at = head.index("u_px"), head.index("v_px")
    for row in rows * turned:
        for column, last in zip(at, (1919.0, 1079.0), strict=True):
            row[column] = str(last - float(row[column]))
    picks.write_text("".join(f"{','.join(row)}\n" for row in [head, *rows]))
    result = solve_flight(file)
    assert not result.misfits
    found = [one.message for one in result.findings if " in all frames" in one.message]
    assert len(found) == len(said) and all(a in b for a, b in zip(said, found, strict=True))


@pytest.mark.parametrize(
    ("frames", "stands", "roll_deg", "pitch_deg", "told"),
    [
        (3, False, 180.0, 0.0, True), (2, False, 180.0, 0.0, False), (1, True, 180.0, 0.0, True),
        (3, False, -151.0, 0.0, True), (3, False, 149.0, 0.0, False),
        (3, False, 180.0, 61.0, False),
    ],
)  # fmt: skip
def test_what_is_upside_down(
    frames: int, stands: bool, roll_deg: float, pitch_deg: float, told: bool
) -> None:
    flight = three_frames()
    if stands:
        flight = replace(flight, path=CameraPath(flight.path.position_m[1:2]))
    angles = np.tile([10.0, pitch_deg, roll_deg], (frames, 1))
    assert bool(doubted_angles(flight, np.append(angles, [[np.nan] * 3], axis=0))) == told
    angles[0, 2] = 0.0
    assert doubted_angles(flight, angles) == []


@pytest.mark.parametrize(
    ("speed_m_s", "course_deg", "mounted", "told"),
    [
        (3.1, 60.0, True, True), (3.1, -60.0, True, False), (2.9, 60.0, True, False),
        (3.1, 60.0, False, False), (3.1, 35.0, True, True), (3.1, 85.0, True, True),
        (3.1, 25.0, True, False), (3.1, 95.0, True, False),
    ],
)  # fmt: skip
def test_what_flies_backward(
    speed_m_s: float, course_deg: float, mounted: bool, told: bool
) -> None:
    """Its nose to the southwest; one that hovers drifts any way, and a camera looks so."""
    flight, course = three_frames(), np.radians(course_deg)
    north_east_down = speed_m_s * np.array([np.cos(course), np.sin(course), 0.0])
    path = replace(flight.path, velocity_m_s=np.tile(north_east_down, (3, 1)))
    flight = replace(flight, path=path, mount=flight.mount[[1, 2, 0]] if mounted else flight.mount)
    angles = np.tile([240.0, 0.0, 0.0], (3, 1))
    assert bool(doubted_angles(flight, angles)) == told


@pytest.mark.parametrize(
    "turn", [(1.3, -0.7, 0.4), (0.0, -89.0, 0.0), (30.0, -87.0, 0.0), (30.0, -84.0, 0.0)]
)
def test_a_direction_that_is_nearly_up_or_down_has_no_azimuth(
    turn: tuple[float, float, float],
) -> None:
    """The top of a picture .7 degree from up looked 30 degrees right of forward."""
    assert_approved(mount_sentence(mount_by_angles(turn)))
