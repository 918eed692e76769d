"""Parameters of a flight solved with all its frames: values, what is held, what is propagated."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.clicked_flights import clicked_flight
from tests.kit.command import ROOT
from tests.kit.command import vopd as command
from tests.kit.dense_minimum import NAMES, dense_minimum, drawn, freed_problem
from tests.kit.flight_project import TOML, write_project
from tests.kit.joint_flights import FOCAL, Dense, drone, flight_of
from tests.kit.simulated_flights import Errors, Plan, write_flight
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.flight.adjust.adjustment import Adjustment, adjust
from vopd.flight.adjust.table import as_text
from vopd.flight.flight import CameraPath, Flight, FlightOptions
from vopd.flight.parameters import Parameter, residual_sizes
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.free import names_of
from vopd.geometry.lenses import Lens, LensKind


def by_name(made: Adjustment) -> dict[str, Parameter]:
    return {one.name: one for one in made.parameters}


# Values and standard deviations


@pytest.mark.parametrize("seed", range(0, 40, 4))
def test_the_table_is_that_of_a_dense_solution(seed: int) -> None:
    """All unknowns at once, with a geometry of the tests; of some nothing is stated."""
    flight, names = freed_problem(seed)
    made = adjust(flight, names)
    joint = made.result.estimates.joint
    assert joint is not None
    assert np.abs(dense_minimum(joint, np.random.default_rng(seed)).away).max() < within(
        "dense minimum"
    )
    dense = Dense(joint)
    sigma = np.sqrt(np.diag(dense.inverse))
    kept = {one.name for one in made.result.read.options.kept}
    assert set(joint.model.names) | kept >= {p for n in names for p in NAMES.get(n, (n,))}
    for name in joint.model.names:
        k = joint.model.names.index(name)
        row = by_name(made)[name]
        assert row.held
        assert_close("table value", row.after - row.before, joint.state.parameter[k])
        own = float(sigma[dense.common + k])
        if not kept:
            assert_close("sigma by differences", row.sigma_after / own, 1.0)
        else:  # what is kept with its standard deviation adds to it
            assert row.sigma_after > own * (1.0 - 1e-12)


def test_errors_that_are_not_solved_for_count() -> None:
    """The focal length with k1 uncertain: its own variance, and what k1's error moves it by."""
    flight = drawn(1, ("focal",), {"k1": 0.002})
    row = by_name(adjust(flight, ["focal"]))["focal"]
    known = replace(flight, options=replace(flight.options, parameter_sigma={"k1": 0.0}))
    alone = by_name(adjust(known, ["focal"]))["focal"]
    wrong = replace(flight.lens, k=flight.lens.k + 0.002 * (np.arange(12) == 0))
    moved = by_name(adjust(replace(known, lens=wrong), ["focal"]))["focal"]
    assert row.after == alone.after
    expected = np.hypot(alone.sigma_after, moved.after - alone.after)
    assert abs(row.sigma_after / expected - 1.0) < within("propagated by solving anew")


def test_the_lens_and_the_residuals_are_as_solved() -> None:
    flight = drawn(2, ("focal", "k1", "clock"), {"clock": 0.08}, fix_m=0.3)
    made = adjust(flight, ["focal", "k1", "clock"])
    rows, result = by_name(made), made.result
    joint = result.estimates.joint
    assert joint is not None and all(row.held for row in made.parameters)
    lens = result.flight.lens
    assert_close("table value", lens.focal_px, [rows["focal"].after] * 2)
    assert_close("table value", lens.k[0], rows["k1"].after)
    assert result.read.lens is flight.lens and result.flight.options.free == ()
    residual = result.estimate.residual  # x to the left: minus u
    expected = joint.normal.residual / joint.model.scale[:, None]
    assert_close("residual as solved", np.abs(residual).sum(), np.abs(expected).sum())
    late_m = np.array([2.4, 3.2, 0.0]) * rows["clock"].after
    own_m = joint.state.fix_m + late_m
    assert_close("table value", joint.moved_m, own_m)


@pytest.mark.parametrize("fix_m", [0.0, 0.3])
def test_errors_that_are_not_freed_leave_the_flight_as_stated(fix_m: float) -> None:
    """The offset of the track is solved for beside the focal length, and told by no table."""
    flight = drawn(2, ("focal",), {}, fix_m=fix_m)
    path = replace(flight.path, bias_sigma_m=np.full(3, 0.5))
    made = adjust(replace(flight, path=path), ["focal"])
    joint = made.result.estimates.joint
    assert joint is not None and joint.model.names == ("focal", "east", "north", "up")
    assert (joint.state.parameter[1:] != 0.0).all()
    found = made.result.flight.path
    assert np.array_equal(found.position_m, path.position_m)
    assert np.array_equal(found.bias_sigma_m, path.bias_sigma_m)


def test_residuals_at_stated_places_take_what_is_freed_as_solved() -> None:
    """The focal length is freed, the offset of the track is not; clicks are no error of places."""
    flight = drawn(2, ("focal",), {})
    path = replace(flight.path, bias_sigma_m=np.full(3, 0.5))
    joint = solve_flight_read(replace(flight, path=path)).estimates.joint
    assert joint is not None and joint.model.names == ("focal", "east", "north", "up")
    assert (joint.state.parameter != 0.0).all()
    beside = joint.beside_free
    assert beside.parameter.tolist() == [0.0, *joint.state.parameter[1:].tolist()]
    clicked = clicked_flight(np.random.default_rng(3), 12, 5, every=6, reach=12).flight
    solved = solve_flight_read(clicked).estimates.joint
    assert solved is not None and solved.state.click_px.all()
    assert not solved.beside_free.click_px.any()


def test_the_flight_as_read_has_the_picks_as_stated() -> None:
    """Where they are four times worse than stated, and all was solved again with that."""
    flight = drawn(2, ("focal",), {"clock": 0.08})
    off_px = np.random.default_rng(0).normal(0.0, 4.0, flight.picks.pixel.shape)
    noisy = replace(flight, picks=replace(flight.picks, pixel=flight.picks.pixel + off_px))
    result = adjust(noisy, ["focal"]).result
    assert result.estimates.joint is not None and result.estimates.joint.passes > 0
    assert result.read.picks.one_sigma_px == flight.picks.one_sigma_px == 1.0


def test_a_project_that_frees_is_that_adjustment() -> None:
    flight = drawn(3, (), {"focal": 4.0}, frames=6)
    free = replace(flight, options=replace(flight.options, free=("focal", "k1")))
    one, other = adjust(flight, ["focal", "k1"]).result, solve_flight_read(free)
    assert np.array_equal(one.camera_deg, other.camera_deg)
    assert one.estimates.words.conventions == other.estimates.words.conventions
    assert "solved for" in one.estimates.words.conventions


# Held, or not


def test_what_the_picks_do_not_hold_changes_nothing() -> None:
    """A k1 that is stated ten times better than the picks know it stays, and is propagated."""
    flight = drawn(4, ("k1",), {"k1": 1e-5}, frames=4)
    made = adjust(flight, ["k1"])
    (row,) = made.parameters
    assert not row.held and row.after == row.before and row.sigma_after == row.sigma_before
    plain = solve_flight_read(replace(flight, options=replace(flight.options, free=())))
    assert np.array_equal(made.result.camera_deg, plain.camera_deg)
    ours, theirs = made.result.history(), plain.history()
    assert np.array_equal(ours.uncertainty.total, theirs.uncertainty.total)
    assert [one.message for one in made.result.findings] != [one.message for one in plain.findings]


def test_a_clock_and_the_offset_of_a_straight_track_are_one() -> None:
    """Along the track a second is four metres, exactly; across it the offset is known."""
    flight = drawn(5, ("clock", "track-offset"), {})
    made = adjust(flight, ["clock", "track-offset"])
    first = made.result.read.options.kept[0]
    assert first.name in ("clock", "east", "north") and np.isinf(first.sigma)
    others = {"clock", "track-offset east", "track-offset north"}
    assert others & set(first.trades_with)


def test_the_centre_of_a_narrow_lens_is_yaw_and_pitch() -> None:
    """A lens four times as long: the images of a shift and of a turn differ by a hundredth."""
    flight = drawn(6, ("centre",), {})
    lens = replace(flight.lens, focal_px=flight.lens.focal_px * 4.0)
    pixel = flight.lens.centre_px + 4.0 * (flight.picks.pixel - flight.lens.centre_px)
    picks = replace(flight.picks, pixel=pixel)
    made = adjust(replace(flight, lens=lens, picks=picks), ["centre"])
    rows = by_name(made)
    assert not rows["centre_u"].held and rows["centre_u"].trades_with == ("yaw",)
    assert not rows["centre_v"].held and rows["centre_v"].trades_with == ("pitch",)


def test_a_focal_length_that_is_a_height_is_said_so() -> None:
    """A camera that stands at a place known to 100 m, above level ground."""
    rng = np.random.default_rng(7)
    scene = drone(rng, 1, 10, tilt_deg=0.0)
    flight = flight_of(rng, scene, 0.3, Priors())
    flight = replace(
        flight,
        path=CameraPath(flight.path.position_m, bias_sigma_m=np.full(3, 100.0)),
        picks=replace(flight.picks, stated=True),
        options=FlightOptions(parameter_sigma={}),
    )
    (row,) = adjust(flight, ["focal"]).parameters
    assert row.held or "position up" in row.trades_with


# What cannot be freed


def test_more_unknowns_than_the_picks_leave_are_refused() -> None:
    flight = drawn(8, (), {}, frames=1, landmarks=3)
    with pytest.raises(VopdError, match="state standard deviations"):
        adjust(flight, ["focal", "aspect", "k1", "k2"])


def test_a_clock_that_moves_nothing_is_refused() -> None:
    flight = drawn(9, (), {})
    still = replace(flight, path=replace(flight.path, velocity_m_s=None))
    for name in ("clock", "clock-rate"):
        with pytest.raises(VopdError, match=f"leave {name} out"):
            adjust(still, [name])


def picked(flight: Flight, kept: Any) -> Flight:
    """The flight with some of its picks."""
    names = ("frame", "landmark", "pixel", "sigma_px")
    own = {name: getattr(flight.picks, name)[kept] for name in names}
    return replace(flight, picks=replace(flight.picks, **own))


def of_landmark_0_alone(flight: Flight) -> Flight:
    """The flight whose first landmark is picked in the first frame, and no other there."""
    frame, landmark = flight.picks.frame, flight.picks.landmark
    return picked(flight, (landmark == 0) == (frame == 0))


def refusals() -> dict[str, tuple[Flight, str]]:
    """Flights that lack what is to be free, by what they lack."""
    flight = drawn(9, (), {}, mark_m=0.3)
    lens, marks = flight.lens, flight.landmarks
    fisheye = Lens(LensKind.FISHEYE, lens.size_px, lens.focal_px, lens.centre_px, np.zeros(4))
    table = np.array([[0.0, 0.0], [1.0, 1500.0]])
    radial = Lens(
        LensKind.RADIAL_TABLE, lens.size_px, lens.focal_px, lens.centre_px, np.zeros(0), table=table
    )
    still = CameraPath(flight.path.position_m[[0] * 12], bias_sigma_m=np.full(3, 1.0))
    fixed = replace(flight.options, solve_position=False)
    used = tuple(k > 0 for k in range(len(marks.name)))
    first = f"landmark:{marks.name[0]}"
    return {
        "fisheye": (replace(flight, lens=fisheye), "p1p2"),
        "table": (replace(flight, lens=radial), "k1"),
        "one focal length": (replace(flight, lens=radial), "aspect"),
        "stands": (replace(flight, path=still), "track-offset"),
        "fixed": (replace(flight, options=fixed), "landmarks"),
        "check": (replace(flight, landmarks=replace(marks, used=used)), first),
        "never": (picked(flight, flight.picks.landmark != 0), first),
        "alone": (of_landmark_0_alone(flight), first),
    }


@pytest.mark.parametrize(
    "lack",
    ["fisheye", "table", "one focal length", "stands", "fixed", "check", "never", "alone"],
)
def test_what_a_flight_does_not_have_is_not_free(lack: str) -> None:
    flight, name = refusals()[lack]
    with refused(VopdError):
        adjust(flight, [name])


def test_landmarks_that_take_no_part_and_exact_heights_have_no_row() -> None:
    """The first one is alone in the first frame; the second one's height is exact."""
    flight = of_landmark_0_alone(drawn(9, (), {}, mark_m=0.3))
    marks = flight.landmarks
    sigma_m = marks.sigma_m.copy()
    sigma_m[1, 2] = 0.0
    uncertain = replace(flight, landmarks=replace(marks, sigma_m=sigma_m))
    rows = by_name(adjust(uncertain, ["landmarks"]))
    axes = ("east", "north", "up")
    wanted = {f"landmark:{name} {axis}" for name in marks.name[1:] for axis in axes}
    assert set(rows) == wanted - {f"landmark:{marks.name[1]} up"}
    left = [row.sigma_after / row.sigma_before for row in rows.values()]
    assert [row.held for row in rows.values()] == [part <= 0.7 for part in left]
    assert min(left) < 0.7 < max(left) < 1.0


def test_an_adjustment_draws_the_flight_as_it_is_solved() -> None:
    made = adjust(drawn(3, (), {"focal": 4.0}, frames=6), ["focal"])
    for name in ("attitude", "residuals"):
        own, other = made.plot(name), made.result.plot(name)
        assert [one.get_ylabel() for one in own.axes] == [one.get_ylabel() for one in other.axes]
    assert made.plot().axes[0].get_ylabel() == made.plot("attitude").axes[0].get_ylabel()


def test_the_focal_lengths_that_two_parameters_make_are_told() -> None:
    """Both after `focal`, then fy by `aspect`: the mean in the table is before that."""
    made = adjust(drawn(3, (), {"focal": 4.0}, frames=6), ["focal", "aspect"])
    mean, ratio = (one.after for one in made.parameters)
    before, after = (one.lens.focal_px for one in (made.result.estimates.read, made.result.flight))
    fx_px = before[0] * mean / before.mean()
    assert_close("ratio", after / [fx_px, fx_px * ratio], [1.0, 1.0])
    assert (
        as_text(made, correlations=False)
        .splitlines()[-1]
        .endswith(f"fx is {after[0]:.2f} px and fy {after[1]:.2f} px")
    )
    assert "fx is" not in str(adjust(drawn(3, (), {"focal": 4.0}, frames=6), ["focal"]))


def test_parameters_that_are_hardly_correlated_are_told_as_such() -> None:
    made = adjust(drawn(3, (), {"focal": 4.0}, frames=6), ["focal"])
    assert_approved(as_text(made, correlations=True).splitlines()[-1])


def test_the_library_takes_a_project() -> None:
    made = vopd.adjust("examples/summits/flight.toml", ["focal"])
    (row,) = made.parameters
    assert row.held and abs(row.after - 3900.0) < FOCAL * 1e-3


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("focal", ["focal"]),
        ("focal, k1 clock,", ["focal", "k1", "clock"]),
        ("focal,landmark:old mill", ["focal", "landmark:old mill"]),
    ],
)
def test_names_of_one_text(text: str, names: list[str]) -> None:
    assert names_of(text) == names


def test_a_frame_that_cannot_be_solved_is_none_that_does_not_converge(tmp_path: Path) -> None:
    """It has one pick: the status is that of the others, and a warning names it."""
    project = write_project(tmp_path)
    head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
    kept = [row for k, row in enumerate(rows) if k == 0 or not row.startswith("0,")]
    (tmp_path / "picks.csv").write_text("\n".join([head, *kept, ""]))
    done = command("adjust", project, "--free", "focal")
    assert done.status == 0 and "frame 0" in done.stderr


def test_a_comma_in_the_name_of_a_known_landmark_splits_nothing(tmp_path: Path) -> None:
    known = ["a", "a,b", "old mill, north (1)"]
    text = "focal, landmark:old mill, north (1) ,k1,landmark:a,b,landmark:a,bc"
    marks = ["landmark:old mill, north (1)", "k1", "landmark:a,b", "landmark:a", "bc"]
    assert names_of(text, known) == ["focal", *marks]
    shutil.copytree(ROOT / "examples" / "summits", tmp_path / "p")
    for path in (tmp_path / "p").glob("*.csv"):
        path.write_text(path.read_text().replace("Rotmoos", '"Rotmoos, N"'))
    done = command("adjust", tmp_path / "p", "--free", "landmark:Rotmoos, N,focal")
    assert done.status == 0
    assert "landmark:Rotmoos, N east" in done.stdout


def test_one_text_or_any_names_of_a_project_or_its_folder_free_the_same() -> None:
    path = "examples/summits/flight.toml"
    text = str(adjust(path, "focal,k1"))
    assert text == str(adjust(path, ["focal", "k1"]))
    assert text == str(adjust(path, (name for name in ("focal", "k1"))))
    assert text == str(adjust(Path(path).parent, ["focal", "k1"]))


def test_what_is_no_project_is_refused() -> None:
    solved = vopd.solve_flight("examples/summits/flight.toml")
    for wrong in (solved, "decks/appendix_h/case1.dat"):
        with refused(VopdError):
            adjust(wrong, ["focal"])  # type: ignore[arg-type]


def test_an_adjustment_shows_the_table_of_the_command() -> None:
    path = "examples/summits/flight.toml"
    made, ran = adjust(path, ["focal"]), command("adjust", path, "--free", "focal")
    assert str(made) == ran.stdout and made._repr_html_() == f"<pre>{ran.stdout}</pre>"


def test_a_name_is_no_markup_in_a_notebook() -> None:
    flight, _ = freed_problem(0)
    names = ("A<b>", *flight.landmarks.name[1:])
    named = replace(flight, landmarks=replace(flight.landmarks, name=names))
    made = adjust(named, ["landmarks"])
    assert "A<b>" in str(made)
    assert "A&lt;b&gt;" in made._repr_html_() and "<b>" not in made._repr_html_()


# Solved, and doubtful


def said(made: Adjustment) -> list[str]:
    return [one.message for one in made.result.findings if one.message.startswith("free")]


def test_a_clock_beyond_the_track_is_said() -> None:
    """The first frame comes before the first row, and all are moved past the next one."""
    flight = drawn(2, ("clock",), {"clock": 0.08})
    row_s = np.arange(flight.time_s[0] - 0.02, flight.time_s[-1] + 0.01, 0.02)
    flight = replace(flight, path=replace(flight.path, row_s=row_s))
    for text in said(adjust(flight, ["clock"])):
        assert_approved(text)


def test_a_clock_that_puts_the_last_frame_beyond_the_track_is_said() -> None:
    flight = drawn(2, ("clock",), {"clock": 0.08})
    row_s = np.linspace(flight.time_s[0] - 1.0, flight.time_s[-1] - 0.05, 9)
    flight = replace(flight, path=replace(flight.path, row_s=row_s))
    (text,) = said(adjust(flight, ["clock"]))
    assert_approved(text)


def test_what_an_error_spoils_that_is_not_free_is_said() -> None:
    """The picks hold the focal length beside a known k1, and beside a k1 that is free."""
    stated = {"focal": 4.0, "k1": 0.2}
    flight = drawn(7, (), stated, frames=40)
    (text,) = said(adjust(flight, ["focal"]))
    assert_approved(text)
    assert not said(adjust(flight, ["focal", "k1"]))


def test_a_landmark_on_one_line_of_sight_is_said() -> None:
    """Seen in one frame, with 100 m that nobody knows; the others are held by their .3 m."""
    flight = drawn(5, (), {}, mark_m=0.3)
    picks, sigma_m = flight.picks, flight.landmarks.sigma_m.copy()
    sigma_m[2] = 100.0
    kept = (picks.landmark != 2) | (picks.frame == picks.frame[picks.landmark == 2][0])
    own = {name: getattr(picks, name)[kept] for name in ("frame", "landmark", "pixel", "sigma_px")}
    marks = replace(flight.landmarks, sigma_m=sigma_m)
    flight = replace(flight, picks=replace(picks, **own), landmarks=marks)
    (text,) = said(adjust(flight, [f"landmark:{marks.name[2]}"]))
    assert_approved(text)


def test_a_landmark_whose_distance_its_picks_do_not_tell_is_said(tmp_path: Path) -> None:
    """Its sigma is below the 1e8 m that are stated, and far above its distance."""
    path = write_project(tmp_path, TOML.replace('sigma_m = "exact"\n[track]', "[track]"))
    head, *rows = (tmp_path / "landmarks.csv").read_text().split()
    rows = [f"{row},{1e8 if row.startswith('church') else 0.5}" for row in rows]
    (tmp_path / "landmarks.csv").write_text("\n".join([f"{head},sigma_m", *rows, ""]))
    assert not said(adjust(path, ["landmark:church"]))  # in five frames
    picks = [row.split(",") for row in (tmp_path / "picks.csv").read_text().split()]
    picks = [row for row in picks if row[1] != "church" or row[0] in "01"]
    for row in picks:  # its two lines of sight meet behind the camera
        if row[:2] == ["1", "church"]:
            row[2] = str(float(row[2]) + 6.0)
    (tmp_path / "picks.csv").write_text("\n".join([*map(",".join, picks), ""]))
    (text,) = said(adjust(path, ["landmark:church"]))
    assert_approved(re.sub(r"[\d.]+(e\+\d+)? m", "N m", text))


def test_a_named_blunder_moves_no_free_parameter() -> None:
    """The focal length is that without the pick, which 300 px would have carried away."""
    flight = drawn(6, (), {})
    picks, pixel = flight.picks, flight.picks.pixel.copy()
    pixel[10] += 300.0
    kept = np.arange(len(pixel)) != 10
    own = {name: getattr(picks, name)[kept] for name in ("frame", "landmark", "pixel", "sigma_px")}
    without = adjust(replace(flight, picks=replace(picks, **own)), ["focal"])
    made = adjust(replace(flight, picks=replace(picks, pixel=pixel)), ["focal"])
    assert_close("table value", made.parameters[0].after, without.parameters[0].after)
    (text,) = said(made)
    assert_approved(text)


def test_the_command_counts_the_warnings_that_it_does_not_show(tmp_path: Path) -> None:
    """Landmarks 0 to 3 lie behind the camera."""
    path = write_project(tmp_path, noise_px=0.3)
    with (tmp_path / "landmarks.csv").open("a") as file:
        file.writelines(f"{k},47.6{k},16.4759,460\n" for k in range(4))
    with (tmp_path / "picks.csv").open("a") as file:
        file.writelines(f"0,{k},900,500\n" for k in range(4))
    assert_approved(command("adjust", path, "--free", "focal").stderr)


@pytest.mark.parametrize("position", ["solve", "fixed"])
def test_a_stated_offset_of_a_track_holds_it_as_well_as_that(position: str, tmp_path: Path) -> None:
    """Half a metre by the picks, and a millimetre as stated."""
    plan = Plan(Errors(landmark_m=(0.1,), bias_m=(0.5, 0.5, 0.5)), frames=6, landmarks=6)
    write_flight(tmp_path, plan, np.random.default_rng(1))
    project = tmp_path / "flight.toml"
    text = project.read_text(encoding="utf-8") + f'[solve]\nposition = "{position}"\n'
    for stated_m, least, most in ((0.5, 0.1, 0.8), (0.001, 0.0, 0.004)):
        stated = text.replace("sigma_bias_m = 0.5", f"sigma_bias_m = {stated_m}")
        project.write_text(stated, encoding="utf-8")
        found = adjust(project, ["track-offset"]).parameters
        assert [one.sigma_before for one in found] == [stated_m] * 3
        assert all(one.sigma_after <= stated_m * (1.0 + 1e-9) for one in found)
        assert least <= max(abs(one.after) for one in found) < most
    level = text.replace("sigma_bias_m = 0.5", "sigma_bias_m = [0.5, 0.5, 0]")
    project.write_text(level, encoding="utf-8")
    *free, exact = adjust(project, ["track-offset"]).parameters
    assert max(abs(one.after) for one in free) > 0.1
    assert (exact.held, exact.after, exact.sigma_before) == (False, 0.0, 0.0)


def test_a_last_landmark_that_is_never_picked_has_no_residual(tmp_path: Path) -> None:
    project = write_project(tmp_path, noise_px=0.3)
    made = adjust(project, ["focal"])
    sizes = residual_sizes(made.result.estimates, made.parameters)
    marks = tmp_path / "landmarks.csv"
    last = marks.read_text(encoding="utf-8").splitlines()[-1].partition(",")[2]
    marks.write_text(f"{marks.read_text(encoding='utf-8').rstrip()}\nzz,{last}\n", "utf-8")
    more = adjust(project, ["focal"])
    found = residual_sizes(more.result.estimates, more.parameters)
    assert np.isnan(found[-2]).all() and len(found) == len(sizes) + 1
    assert_close("table value", np.delete(found, -2, axis=0), sizes)
