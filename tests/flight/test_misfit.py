"""Flights that misfit, and errors of their inputs that the residuals speak for."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.clicked_flights import clicked_flight
from tests.kit.command import ROOT
from tests.kit.command import vopd as command
from tests.kit.flight_mistakes import MistakeRow
from tests.kit.flight_parameters import ROLLING
from tests.kit.flight_project import TOML, long_track, write_project
from tests.kit.joint_flights import axes, drone, flight_of
from tests.kit.simulated_flights import Errors, LensErrors, Plan, write_flight
from tests.tolerances import assert_close, within
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.findings import VopdError
from vopd.flight.flight import CameraPath, Flight, TrackFixes
from vopd.flight.misfits import input_errors as errors_module
from vopd.flight.misfits import misfit
from vopd.flight.misfits.input_errors import (
    REJECTED,
    SPEAK_FOR,
    even_path,
    input_errors,
    of_sampled,
    sampled,
    significant_errors,
)
from vopd.flight.misfits.misfit import frames_text, misfit_text, sizes_text, too_wide_text
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.equations import SHIFT, Priors
from vopd.flight.solve.errors import priors_of
from vopd.flight.solve.joint import JointSolution, solve_jointly, weighed
from vopd.flight.solve.sizes import cost_of_frames, size_of_residuals

SEED = 5


def solved(
    folder: Path, mistake: str = "", noticed: float = 3.0, fix_m: float = 0.02
) -> vopd.FlightResult:
    """A simulated flight with a mistake that its project does not know of."""
    row = MistakeRow(mistake, fix_m)
    write_flight(folder, row.plan, np.random.default_rng(SEED), mistake, noticed)
    return vopd.solve_flight(folder / "flight.toml")


def joint(result: vopd.FlightResult) -> JointSolution:
    assert result.estimates.joint is not None
    return result.estimates.joint


def said(result: vopd.FlightResult) -> list[str]:
    words = "misfits", "speak for", "typical frame", "stated larger"
    return [f.message for f in result.findings if any(word in f.message for word in words)]


@pytest.mark.parametrize("mistake", ["", "clock", "focal length", "landmark", "readout"])
def test_nothing_is_said_of_a_mistake_of_a_third_of_the_noticeable_size(
    mistake: str, tmp_path: Path
) -> None:
    assert said(solved(tmp_path, mistake, 1 / 3)) == []


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        ("clock", "offset_s"), ("frame rate", "frame_rate_hz"), ("focal length", "focal length"),
        ("k1", "k1 ="), ("heights", "same level"), ("readout", "readout_ms"),
    ],
)  # fmt: skip
def test_a_mistake_of_three_times_the_noticeable_size_is_named(
    mistake: str, words: str, tmp_path: Path
) -> None:
    (text,) = said(solved(tmp_path, mistake))
    assert words in text and text.startswith("the residuals speak for ")


@pytest.mark.parametrize(
    ("mistake", "fix_m", "noticed", "words"),
    [
        ("clock", 0.02, 100.0, "[track] offset_s = -1."), ("clock", 2.0, 7.0, "offset_s = -1."),
        ("heights", 0.02, 10.0, "same level"), ("heights", 2.0, 25.0, "same level"),
        ("position", 0.02, 10.0, "camera's position"), ("position", 2.0, 10.0, "camera's position"),
    ],
)  # fmt: skip
def test_an_error_of_everyday_size_is_named_alone(
    mistake: str, fix_m: float, noticed: float, words: str, tmp_path: Path
) -> None:
    """A clock is not the position, which takes three values; nor is the position a clock."""
    *_, text = said(solved(tmp_path, mistake, noticed, fix_m))
    assert words in text and " or " not in text


def test_a_landmark_that_does_not_fit_in_its_frames_is_named_once(tmp_path: Path) -> None:
    """As a landmark with wrong coordinates, and not as an error that residuals speak for, too."""
    result = solved(tmp_path, "landmark")
    texts = [one.message for one in result.findings]
    assert sum("m0 does not fit the other landmarks" in text for text in texts) == 1
    assert not any("speak for" in text and "m0" in text for text in texts)


@pytest.mark.parametrize(
    ("mistake", "words"),
    [("u and v exchanged", "u and v"), ("v upward", 'v = "up"'), ("labels exchanged", "m0 and m1")],
)
def test_an_exchange_is_named_and_the_status_is_3(mistake: str, words: str, tmp_path: Path) -> None:
    result = solved(tmp_path, mistake)
    first, text = said(result)
    assert result.misfits and first.startswith("the flight misfits: ") and words in text
    if mistake == "v upward":
        done = command("attitude", tmp_path / "flight.toml", "-o", tmp_path / "a.csv")
        assert done.status == 3 and "warning: " in done.stderr and words in done.stderr


@pytest.mark.parametrize("fix_m", [0.02, 2.0])
@pytest.mark.parametrize("stated", ["brown", "fisheye"])
def test_four_coefficients_of_the_other_model_are_named(
    stated: str, fix_m: float, tmp_path: Path
) -> None:
    """A k1 a third off mends most of it; positions of 2 m hide the rest, and it is named so."""
    true = "fisheye" if stated == "brown" else "brown"
    plan = MistakeRow("", fix_m).plan._replace(fisheye=true == "fisheye", distortion=(-0.05, 0.01))
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    project = tmp_path / "flight.toml"
    right = project.read_text()
    assert said(vopd.solve_flight(project)) == []
    project.write_text(right.replace(f'model = "{true}"', f'model = "{stated}"'))
    _, text = said(vopd.solve_flight(project))
    assert_approved(re.sub(r"\d+\.\d px", "N px", text), parts=[f'model = "{true}"'])


@pytest.mark.parametrize(
    ("stated", "true", "pick_px"), [(0.17, -0.17, 1.0), (0.3, 0.0, 1.0), (0.17, -0.17, 3.0)]
)
def test_a_k1_that_is_mistaken_by_a_third_is_that_of_the_other_model_or_what_it_is(
    stated: float, true: float, pick_px: float, tmp_path: Path
) -> None:
    """Of the other sign, or of pictures without distortion: the other model was named alone."""
    plan = MistakeRow("", 0.02).plan._replace(distortion=(true, 0.0))
    plan = plan._replace(errors=plan.errors._replace(pick_px=pick_px))
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    project = tmp_path / "flight.toml"
    project.write_text(project.read_text().replace(f"k = [{true},", f"k = [{stated},"))
    _, text = said(vopd.solve_flight(project))
    assert_approved(re.sub(r"\d+\.\d px|[\d.-]+ \+- [\d.]+", "N", text))


@pytest.mark.parametrize("order", [[1, 2, 0], [1, 0, 3, 2]])
@pytest.mark.parametrize("fix_m", [0.02, 2.0])
def test_names_of_landmarks_that_are_dealt_otherwise_are_named(
    order: list[int], fix_m: float, tmp_path: Path
) -> None:
    """Three in a ring, two pairs: each landmark was named with coordinates that are wrong."""
    write_flight(tmp_path, MistakeRow("", fix_m).plan, np.random.default_rng(SEED))
    marks = tmp_path / "landmarks.csv"
    head, *rows = (line.split(",") for line in marks.read_text().splitlines())
    name = [row[0] for row in rows]
    for k, other in enumerate(order):
        rows[k][0] = name[other]
    marks.write_text("\n".join(map(",".join, [head, *rows])) + "\n")
    *_, text = said(vopd.solve_flight(tmp_path / "flight.toml"))
    renamed = [f"{name[k]} to {name[other]}" for k, other in enumerate(order)]
    assert all(one in text for one in renamed) and " renamed in all frames: " in text
    assert text.count(" to ") == len(order)


def test_picks_in_smaller_pictures_are_named_with_the_other_cause(tmp_path: Path) -> None:
    """A lens of pictures of twice the size is the same: it was named alone."""
    write_flight(tmp_path, MistakeRow("", 0.02).plan, np.random.default_rng(SEED))
    picks = tmp_path / "picks.csv"
    head, *rows = (line.split(",") for line in picks.read_text().splitlines())
    pixel = (np.array([row[2:] for row in rows], float) + 0.5) / 2.0 - 0.5
    inside = (np.abs(pixel - [479.5, 269.5]) < [480.0, 270.0]).all(axis=1)
    halved = [[*row[:2], *map(str, two)] for row, two in zip(rows, pixel.tolist(), strict=True)]
    halved = [row for row, one in zip(halved, inside, strict=True) if one]
    picks.write_text("\n".join(map(",".join, [head, *halved])) + "\n")
    _, text = said(vopd.solve_flight(tmp_path / "flight.toml"))
    assert_approved(re.sub(r"\d+\.\d px", "N px", text), parts=["960 x 540"])


def test_another_frame_rate_of_a_path_that_weaves_is_named(tmp_path: Path) -> None:
    """By usual rates, and not by a fitted one, which on a circle was 29.52 +- .01."""
    plan = MistakeRow("", 0.02).plan._replace(frames=30, fix_hz=10.0, weave_m=40.0, weave_s=20.0)
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    project, picks = tmp_path / "flight.toml", tmp_path / "picks.csv"
    head, *rows = (line.partition(",") for line in picks.read_text().splitlines())
    lines = ["".join(head), *(f"{6 * int(frame)},{rest}" for frame, _, rest in rows)]
    picks.write_text("\n".join([*lines, ""]))  # 5 in a second are 30
    stated = f"frame_rate_hz = {plan.frame_hz}"
    project.write_text(project.read_text().replace(stated, "frame_rate_hz = 25.0"))
    _, text = said(vopd.solve_flight(project))
    assert_approved(re.sub(r"\d+\.\d px", "N px", text), parts=["25"])


def test_rows_that_are_read_the_other_way_are_named_with_a_way(tmp_path: Path) -> None:
    """A readout of less than nothing, which no project takes, is one of the other way."""
    plan = ROLLING._replace(errors=ROLLING.errors._replace(readout_ms=0.0))
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    project = tmp_path / "flight.toml"
    project.write_text(project.read_text().replace('readout = "down"', 'readout = "up"'))
    *_, text = said(vopd.solve_flight(project))
    assert ' ms and readout = "down" in the place of 10 and "up"' in text and "= -" not in text


def test_pictures_cut_off_at_their_top_move_the_principal_point(tmp_path: Path) -> None:
    """By the 140 rows that are gone: the camera is off by 5 degrees of pitch, and picks fit."""
    row = MistakeRow("", 0.02)
    write_flight(tmp_path, row.plan, np.random.default_rng(SEED))
    picks = tmp_path / "picks.csv"
    head, *rows = (line.split(",") for line in picks.read_text().splitlines())
    at = head.index("v_px")
    for one in rows:
        one[at] = str(float(one[at]) - 140.0)
    picks.write_text("".join(f"{','.join(one)}\n" for one in [head, *rows]))
    result = vopd.solve_flight(tmp_path / "flight.toml")
    text = next(one for one in said(result) if "principal point" in one)
    v, sigma = re.findall(r", ([\d.]+) \+- ([\d.]+) in the place of 959.5, 539.5", text)[0]
    assert abs(float(v) - (539.5 - 140.0)) < 3.0 * float(sigma) < 60.0


@pytest.mark.parametrize(
    ("more", "sigma", "words"),
    [
        (0.07, 0.01, "were the pictures free of distortion"), (0.06, 0.01, ""),
        (0.16, 0.01, "of the other sign"), (0.31, 0.01, ""), (-0.1, 0.01, ""), (0.16, 0.03, ""),
    ],
)  # fmt: skip
def test_a_k1_of_another_kind_than_the_stated_one(more: float, sigma: float, words: str) -> None:
    """-.1 is stated; within a third of it is near 0."""
    flight = exact_flight()
    lens = replace(flight.lens, k=np.array([-0.1, *[0.0] * 11]))
    one = solve_jointly(replace(flight, lens=lens), priors_of(flight))
    (tried,) = (e for e in input_errors(one, even_path(one))[0] if e.parameters == ("k1",))
    text = tried.text(np.array([more]), np.array([sigma]))
    assert words in text and ("(" in text) == bool(words)


@pytest.mark.parametrize(("of_position", "words"), [(True, "[position]"), (False, "[track]")])
def test_the_section_that_the_project_has_is_named(of_position: bool, words: str) -> None:
    """All frames from one place that is exact: of a track, too, whose images have one."""
    rng = np.random.default_rng(7)
    flight = flight_of(rng, drone(rng, 6, 6), 0.3, Priors())
    place_m = flight.path.position_m[:1] + np.array([0.0, 0.0, 3.0])
    path = CameraPath(np.repeat(place_m, 6, axis=0), of_position=of_position)
    solved = solve_flight_read(replace(flight, path=path))
    tried, _ = input_errors(joint(solved), even_path(joint(solved)))
    (text,) = (one.text(np.ones(3), np.ones(3)) for one in tried if one.parameters == SHIFT)
    assert words in text


@pytest.mark.parametrize(("height_m", "misfits"), [(399.7, False), (-2936.0, True)])
def test_a_camera_on_a_post_that_is_stated_too_low(
    height_m: float, misfits: bool, tmp_path: Path
) -> None:
    """All images as one: of five summits 64 m are 4 px, which may be so, and 3.4 km are 200."""
    project = tmp_path / "flight.toml"
    for file in (ROOT / "examples" / "summits").iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    project.write_text(project.read_text().replace("z_m = 463.7", f"z_m = {height_m}"))
    for strict in ((), ("--strict",)):
        done = command("attitude", project, "-o", tmp_path / "a.csv", *strict)
        assert done.status == (3 if misfits or strict else 0)
        assert ("the flight misfits: " in done.stderr) == misfits
        (said,) = (one for one in done.stderr.splitlines() if SPEAK_FOR in one)
        assert not done.stdout
        assert "[position] height" in said  # one value that explains it, not three


@pytest.mark.parametrize(
    ("key", "wrong", "right", "value"),
    [
        ("offset_s", "offset_s = -7.4", "offset_s = ", 0.0),
        ("offset_s", "offset_s = 20.0", "offset_s = ", 0.0),
        ("focal", "1.5", "a focal length of ", 1495.0),
        ("focal", "0.7", "a focal length of ", 1495.0),
        ("heights", "-45.7", "all landmarks ", 45.7),
        ("heights", "120", "all landmarks ", -120.0),
    ],
)
def test_a_large_error_is_named_with_its_value(
    key: str, wrong: str, right: str, value: float, tmp_path: Path
) -> None:
    """A clock beyond the track's rows, another lens, a geoid; positions are exact."""
    text = TOML + (f"{wrong}\n" if key == "offset_s" else "")
    if key == "focal":
        for focal in (1500.0, 1490.0):
            text = text.replace(f"_px = {focal}", f"_px = {focal * float(wrong)}")
    project = write_project(tmp_path, text, noise_px=0.3)
    if key == "offset_s":
        long_track(tmp_path)
    if key == "heights":
        file = tmp_path / "landmarks.csv"
        head, *rows = file.read_text().splitlines()
        cells = [row.rpartition(",") for row in rows]
        raised = [f"{place},{float(height) + float(wrong)}" for place, _, height in cells]
        file.write_text("\n".join([head, *raised]))
    (text,) = (one for one in said(vopd.solve_flight(project)) if SPEAK_FOR in one)
    found = float(text.partition(right)[2].split()[0])
    limit = "focal length of a mistake" if key == "focal" else "height of another level"
    assert abs(found - value) < within("clock offset" if key == "offset_s" else limit)


def test_values_are_those_of_freeing_the_error(tmp_path: Path) -> None:
    """A dense weighted least squares of all columns, turns and places among them, by numpy."""
    one = joint(solved(tmp_path, "focal length"))
    errors, change = input_errors(one, even_path(one))
    square, right = weighed(one, change)
    rows = []
    for part in one.model.rows(one.state):
        for k, frame in enumerate(part.frames):
            turn, place = (np.zeros((one.model.frames, 3)) for _ in range(2))
            for by_turn, by_place, pick in zip(
                part.by_turn[k], part.by_place[k], part.picks[k], strict=True
            ):
                for axis in range(2):
                    turn[frame], place[frame] = by_turn[axis], by_place[axis] * 0.02
                    rows.append((pick, axis, np.concatenate([turn.ravel(), place.ravel()])))
    order = sorted(rows, key=lambda row: row[:2])
    known = np.stack([row[2] for row in order])
    prior = np.diag(np.repeat([0.0, 1.0], 3 * one.model.frames))
    flat = change.reshape(-1, change.shape[2])
    inverse = np.linalg.inv(known.T @ known + prior)
    dense = flat.T @ flat - flat.T @ known @ inverse @ known.T @ flat
    scale = np.sqrt(np.diag(dense))
    both = scale[:, None] * scale
    assert_close("ratio of three digits", square / both, dense / both)
    (index,) = next(e.columns for e in errors if "focal" in e.parameters)
    found = significant_errors(one, True)
    assert found[0].error.columns == (index,)
    assert_close("ratio of three digits", found[0].value[0], right[index] / square[index, index])


def test_positions_that_are_worse_than_stated_are_spoken_for(tmp_path: Path) -> None:
    row = MistakeRow("", 3.0)
    plan = row.plan._replace(stated=1 / 3)
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    project = tmp_path / "flight.toml"
    project.write_text(project.read_text().replace("sigma_px = 0.333333333", "sigma_px = 1.0"))
    result = vopd.solve_flight(project)
    first, text = said(result)
    assert result.misfits and "misfits" in first
    assert "positions" in text and "where 1 m is stated" in text


def test_places_solved_far_from_where_they_are_stated_are_a_misfit(tmp_path: Path) -> None:
    """Heights of the track in feet: from a kilometre above, three landmarks fit each other."""
    errors = Errors(0.7, landmark_m=(0.5,), fix_m=((2.0, 2.0, 4.0),))
    plan = Plan(
        errors, frames=10, landmarks=6, frame_hz=3.0, height_m=(200.0, 300.0), speed_m_s=20.0
    )
    write_flight(tmp_path, plan, np.random.default_rng(3))
    track = tmp_path / "track.csv"
    head, *rows = (line.split(",") for line in track.read_text().splitlines())
    at = head.index("h_m")
    feet = [[*row[:at], str(float(row[at]) / 0.3048), *row[at + 1 :]] for row in rows]
    track.write_text("".join(f"{','.join(row)}\n" for row in [head, *feet]))
    result = vopd.solve_flight(tmp_path / "flight.toml")
    assert result.misfits
    first, second = said(result)[:2]
    assert "come out" in first and "feet" in second


def test_a_reading_sigma_that_is_stated_much_too_large(tmp_path: Path) -> None:
    row = MistakeRow("", 0.02)
    write_flight(tmp_path, row.plan, np.random.default_rng(SEED))
    project = tmp_path / "flight.toml"
    project.write_text(project.read_text().replace("sigma_px = 1", "sigma_px = 3"))
    result = vopd.solve_flight(project)
    (text,) = said(result)
    assert not result.misfits and text.startswith("sigma_px = 3 is stated larger than the picks")


def test_one_small_residual_does_not_say_that_a_sigma_is_too_large(tmp_path: Path) -> None:
    """Two landmarks have one degree of freedom, whose residual may be small by chance."""
    toml = TOML.replace("[landmarks]", "sigma_px = 3.0\n[landmarks]")
    project = write_project(tmp_path, toml, noise_px=0.3)
    picks = tmp_path / "picks.csv"
    lines = picks.read_text(encoding="utf-8").splitlines(keepends=True)
    picks.write_text("".join(lines[:3]), encoding="utf-8")
    assert said(vopd.solve_flight(project)) == []
    picks.write_text("".join(lines), encoding="utf-8")
    (text,) = said(vopd.solve_flight(project))
    assert "is stated larger than the picks" in text


def test_stated_errors_explain_nothing_of_a_solution_that_did_not_settle(tmp_path: Path) -> None:
    """In a straight line a focal length of 20 % explains most of what it is off by, and less so of

    a solution without convergence, which no picks are said to be better for than stated.
    """
    errors = Errors(1.0, lens=LensErrors(0.2))
    plan = MistakeRow("", 0.02).plan._replace(errors=errors)
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    solution = joint(vopd.solve_flight(tmp_path / "flight.toml"))
    every = np.ones(solution.model.frames, bool)
    settled, _ = size_of_residuals(solution, every)
    assert settled < REJECTED
    attitudes = solution.solved.attitudes._replace(converged=~every)
    last = replace(solution, solved=replace(solution.solved, attitudes=attitudes))
    freedom = 2 * len(solution.model.pick) - 3 * solution.model.frames
    size = np.sqrt(cost_of_frames(solution).sum() / freedom)
    assert size > 2.0 * REJECTED
    assert_close("ratio", size_of_residuals(last, every)[0], size)


@cache
def exact_flight() -> Flight:
    """Forty frames of which nothing is uncertain but the picks, by half a pixel."""
    rng = np.random.default_rng(SEED)
    flight = flight_of(rng, drone(rng, 40, 8), 0.5, Priors())
    return replace(flight, picks=replace(flight.picks, one_sigma_px=0.5))


def misfit_of(source: str, sigma_px: float, stated_px: float | None = None) -> str:
    """What is said of picks of which a reading sigma is stated, given, or found."""
    flight = exact_flight()
    joint = solve_jointly(
        replace(flight, picks=flight.picks.with_sigma(sigma_px)), priors_of(flight)
    )
    freedom = np.inf if source in ("stated", "given") else 520.0
    reading = JobReadingSigma(sigma_px, freedom, source, np.ones(40), sigma_px)
    return misfit_text(joint, reading, stated_px) or too_wide_text(joint, reading)


@pytest.mark.parametrize("source", ["stated", "given"])
def test_residuals_of_one_and_a_half_times_what_is_known_of_picks_misfit(source: str) -> None:
    """2N - 3F degrees of freedom; with fewer residuals a stated sigma is too large, not a given."""
    flight = exact_flight()
    residual_px = 0.5 * solve_jointly(flight, priors_of(flight)).normal.residual
    size_px = float(np.sqrt((residual_px**2).sum() / (2 * len(residual_px) - 3 * 40)))
    assert misfit_of(source, size_px / 1.49) == ""
    assert misfit_of(source, size_px / 1.51).startswith("the flight misfits: ")
    assert misfit_of(source, size_px * 1.49) == ""
    assert bool(misfit_of(source, size_px * 1.51)) == (source == "stated")


@pytest.mark.parametrize("stated_px", [None, 0.8])
def test_a_reading_sigma_of_one_and_a_half_times_what_picks_have_misfits(
    stated_px: float | None,
) -> None:
    """Picks of which nothing is stated have 3 px."""
    expected_px = stated_px or 3.0
    assert misfit_of("residuals", 1.49 * expected_px, stated_px) == ""
    assert misfit_of("residuals", 1.51 * expected_px, stated_px).startswith("the flight misfits: ")


def test_names_exchanged_in_a_long_flight_are_named(tmp_path: Path) -> None:
    """Landmarks and positions that are stated to metres follow, and take most of the residuals."""
    errors = Errors(0.5, landmark_m=(1.5,), fix_m=((2.0, 2.0, 3.0),), bias_m=(1.5, 1.5, 2.0))
    plan = MistakeRow("", 2.0).plan._replace(
        errors=errors, frames=250, landmarks=10, frame_hz=50.0, fix_hz=1.0
    )
    write_flight(tmp_path, plan, np.random.default_rng(SEED), "labels exchanged")
    result = vopd.solve_flight(tmp_path / "flight.toml")
    assert result.misfits
    assert any("m0 and m1 exchanged in all frames" in str(one) for one in result.findings)


@pytest.mark.parametrize("seed", [0, 1])
def test_an_error_that_moves_angles_by_a_standard_deviation_is_named(
    seed: int, tmp_path: Path
) -> None:
    """Frames 1.5 s later than they say, 9 m of the way, of which the positions explain a part."""
    errors = Errors(0.5, (1.0,), ((2.0, 2.0, 3.0),), bias_m=(1.5, 1.5, 2.0), clock_s=0.02)
    plan = MistakeRow("", 2.0).plan._replace(
        errors=errors, frames=60, frame_hz=4.0, fix_hz=1.0, speed_m_s=6.0
    )
    write_flight(tmp_path, plan, np.random.default_rng(seed))
    project = tmp_path / "flight.toml"
    project.write_text(project.read_text().replace("frame_t_s = 0.0", "frame_t_s = 1.5"))
    found = [str(one) for one in vopd.solve_flight(project).findings]
    assert any("residuals speak for clocks of track and frames that differ" in one for one in found)


@pytest.mark.parametrize(("times", "said"), [(4.7, False), (5.1, True)])
def test_cameras_that_come_out_5_times_as_far_as_is_stated(times: float, said: bool) -> None:
    """Of fixes of 1, 2 and 2 m in nine frames, and what they share, of 4 m along each axis.

    All are as far off east as north, and the picks say nine tenths of 27 and 3 errors. The least
    sum of squares of a common shift is its square over 4 m squared and a ninth of a fix's.
    """
    rng = np.random.default_rng(SEED)
    fixes = TrackFixes(np.arange(9), np.ones((9, 1)), np.tile([1.0, 2.0, 2.0], (9, 1)))
    priors = Priors(fixes, None, dict.fromkeys(SHIFT, 4.0))
    scene = drone(rng, 9, 8)
    flight = flight_of(rng, scene, 0.5, Priors())
    away_m = times * np.sqrt(30.0 / (1.0 / (16.0 + 1.0 / 9.0) + 1.0 / (16.0 + 4.0 / 9.0)))
    north_east = axes(scene.camera_m)[:, :2].sum(axis=1)
    path = replace(flight.path, position_m=scene.camera_m + away_m * north_east)
    joint = solve_jointly(replace(flight, path=path), priors)
    text = misfit_text(joint, JobReadingSigma(0.5, 100.0, "residuals", np.ones(9), 0.5), None)
    assert bool(text) == said
    if said:
        assert_approved(text)


@pytest.mark.parametrize(("times", "misfits"), [(2.5, False), (12.0, True)])
def test_a_stated_error_of_the_lens_moves_exact_positions_far(times: float, misfits: bool) -> None:
    """.75 % of the focal length, stated as .3 %, moves cameras of .02 m by .2 m: it explains that.

    Cameras came out 14 times as far as is stated, and the flight was called doubtful.
    """
    rng = np.random.default_rng(1)
    fixes = TrackFixes(np.arange(12), np.ones((12, 1)), np.full((12, 3), 0.02))
    flight = flight_of(rng, drone(rng, 12, 6, spacing_m=3.0), 0.7, Priors(fixes))
    focal_px = flight.lens.focal_px * (1.0 + times * 0.003)
    result = solve_flight_read(
        replace(
            flight,
            picks=replace(flight.picks, stated=True),
            lens=replace(flight.lens, focal_px=focal_px),
            options=replace(flight.options, parameter_sigma={"focal": 0.003 * focal_px[0]}),
        )
    )
    assert result.misfits == misfits


def test_landmarks_of_one_frame_each_do_not_make_picks_look_better(tmp_path: Path) -> None:
    """Their own errors take up nearly all residuals, and are a part of what is tested."""
    plan = MistakeRow("", 0.02).plan
    plan = plan._replace(own=True, errors=plan.errors._replace(landmark_m=(2.0,)))
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    assert said(vopd.solve_flight(tmp_path / "flight.toml")) == []


@pytest.mark.parametrize(("wrong", "misfits"), [(1, False), (3, True)])
def test_a_flight_of_which_many_picks_do_not_fit_misfits(wrong: int, misfits: bool) -> None:
    """One pick of 8 in each frame is a blunder of it; of three in each, nothing tells who is right.

    The others fit each other in both: their residuals alone say nothing.
    """
    scene = drone(np.random.default_rng(3), 12, 8)
    flight = flight_of(np.random.default_rng(4), scene, 0.5, Priors())
    picks = flight.picks
    rank = (picks.landmark + picks.frame) % 8
    off = np.random.default_rng(5).uniform(200.0, 400.0, (len(rank), 2))
    pixel = picks.pixel + np.where((rank < wrong)[:, None], off, 0.0)
    options = replace(flight.options, drop_blunders=True)
    read = replace(flight, picks=replace(picks, pixel=pixel), options=options)
    result = solve_flight_read(read)
    assert result.misfits == misfits
    assert_approved([f.message for f in result.findings if "of its" in f.message])


@pytest.mark.parametrize(
    ("reading", "position", "landmark"),
    [
        (0.0, 13.0, 18.9), (0.0, 13.0, 19.1), (13.0, 0.0, 18.9), (13.0, 0.0, 19.1),
        (18.9, 13.0, 0.0), (19.1, 13.0, 0.0), (0.0, 0.0, 10.7), (0.0, 0.0, 10.9),
        (0.0, 10.9, 0.0), (10.9, 0.0, 0.0), (20.0, 20.0, 20.0),
    ],
)  # fmt: skip
def test_sizes_that_explain_as_well_are_named_together(
    reading: float, position: float, landmark: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As well is within 6 of chi-square, and what is named has 10.8; not the picks alone."""
    gain = {"reading": reading, "position": position, "landmark": landmark}
    monkeypatch.setattr(misfit, "size_spoken_for", lambda first, name: (2.0, gain[name]))
    rng = np.random.default_rng(3)
    fixes = TrackFixes(np.arange(3), np.ones((3, 1)), np.full((3, 3), 2.0))
    priors = Priors(fixes, np.full((5, 3), 0.1))
    flight = flight_of(rng, drone(rng, 3, 5), 0.5, priors)
    best = max(gain.values())
    expected = [name for name in gain if gain[name] > best - 6.0]
    said = sizes_text(flight)
    assert bool(said) == (best > 10.8 and expected != ["reading"])
    if said:
        assert_approved(said)


def test_no_size_is_named_of_a_flight_that_does_not_come_to_its_least_cost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Which is so where its solve ends by the number of its passes."""
    monkeypatch.setattr(misfit, "size_spoken_for", lambda first, name: (2.0, 99.0))
    rng = np.random.default_rng(3)
    flight = flight_of(rng, drone(rng, 3, 5), 0.5, Priors(landmark_m=np.full((5, 3), 0.1)))
    assert sizes_text(flight)
    monkeypatch.setattr(misfit, "PASSES", 1)
    assert not sizes_text(flight)


@pytest.mark.parametrize("stands", [True, False])
def test_the_size_of_an_error_that_all_frames_share(
    stands: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the place of a camera that stands, or of all positions of a track, east, north, up."""
    monkeypatch.setattr(
        misfit, "size_spoken_for", lambda _, name: (3.0, 11.0 * (name != "reading"))
    )
    rng = np.random.default_rng(3)
    flight = flight_of(rng, drone(rng, 3, 5), 0.5, Priors())
    place = flight.path.position_m[[0] * 3] if stands else flight.path.position_m
    path = CameraPath(place, bias_sigma_m=np.array([1.0, 2.0, 4.0]))
    assert path.stands == stands
    assert_approved(sizes_text(replace(flight, path=path)))


def test_a_long_flight_is_looked_at_by_its_drawn_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A focal length that is 3 % off is named as by all frames, with its larger sigma."""
    every = [one for one in said(solved(tmp_path, "focal length", 30.0)) if "focal" in one]
    monkeypatch.setattr(errors_module, "MOST_PICKS", 60)
    some = [one for one in said(solved(tmp_path, "focal length", 30.0)) if "focal" in one]
    assert_approved([*every, *some])


@pytest.mark.parametrize("kind", ["own fixes", "shared fixes", "clicks"])
def test_drawn_frames_are_solved_from_where_all_frames_are(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the solution that they have by themselves."""
    monkeypatch.setattr(errors_module, "MOST_PICKS", 60)
    rng = np.random.default_rng(SEED)
    if kind == "clicks":
        flight = clicked_flight(rng, 30, 6, every=10).flight
    else:
        first, weight = np.arange(30), np.ones((30, 1))
        if kind == "shared fixes":
            first, weight = np.sort(rng.integers(0, 12, 30)), rng.dirichlet(np.ones(3), 30)
        fixes = TrackFixes(first, weight, np.ones((first[-1] + weight.shape[1], 3)))
        priors = Priors(fixes, np.full((6, 3), 0.3))
        flight = flight_of(rng, drone(rng, 30, 6), 0.5, priors)
    every = solve_jointly(flight, priors_of(flight))
    found, part = of_sampled(every), sampled(flight).flight
    alone = solve_jointly(part, priors_of(part))
    assert len(found.model.pick) <= 60 < len(every.model.pick)
    for one, other in zip(found.state, alone.state, strict=True):
        assert np.abs(one - other).max(initial=0.0) < within("joint minimum")


def test_angles_stand_where_no_explanation_has_a_solution(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object) -> None:
        raise VopdError("no solution within rounding")

    monkeypatch.setattr(misfit, "significant_errors", refused)
    result = solved(tmp_path, "clock", 30.0)
    assert result.misfits and result.solved.all()
    assert misfit.UNTRIED in [one.message for one in result.findings]


def test_frames_are_drawn_over_the_whole_flight(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flight = solved(tmp_path).flight
    assert sampled(flight).flight is flight
    monkeypatch.setattr(errors_module, "MOST_PICKS", 60)
    some = sampled(flight).flight
    assert len(some.picks.frame) == 60 and np.ptp(some.frame) >= 9


def test_sentences(tmp_path: Path) -> None:
    one = joint(solved(tmp_path))
    errors, _ = input_errors(one, even_path(one))
    tenth = [0.1 * np.ones(len(each.columns)) for each in errors]
    assert_approved([each.text(v, v / 7.0) for each, v in zip(errors, tenth, strict=True)])


def test_a_clock_rate_of_stated_times_is_in_parts_of_a_million(tmp_path: Path) -> None:
    one = joint(solved(tmp_path))
    one.model.flight = replace(one.model.flight, frame_rate_hz=None)
    (rate,) = (e for e in input_errors(one, even_path(one))[0] if e.parameters == ("clock_rate",))
    assert_approved(rate.text(np.array([2e-4]), np.array([3e-5])))


@pytest.mark.parametrize(
    ("name", "error", "words"),
    [("k1", 0.004, "k1 = -0.1"), ("focal", 9.0, "of 15"), ("focal", -3012.0, "of 15")],
)
def test_values_to_write_are_those_stated_plus_the_errors(
    name: str, error: float, words: str
) -> None:
    """Of the lens that the flight has, whose coefficients are unlike; a focal length above 0.

    One of the other sign is the same image, turned by half a turn.
    """
    rng = np.random.default_rng(7)
    flight = flight_of(rng, drone(rng, 6, 6), 0.3, Priors())
    k = np.array([-0.104, 0.02, *[0.0] * 10])
    lens = replace(flight.lens, focal_px=np.array([1500.0, 1482.0]), k=k)
    solved = solve_flight_read(replace(flight, lens=lens))
    tried, _ = input_errors(joint(solved), even_path(joint(solved)))
    (one,) = (one for one in tried if one.parameters == (name,))
    assert_approved(one.text(np.array([error]), np.array([abs(error) / 100.0])), parts=[words])


@pytest.mark.parametrize(
    ("odd", "fitting", "unknown", "said"),
    [(6, 5, 4, True), (5, 5, 9, False), (0, 0, 3, False), (1, 0, 0, True)],
)
def test_most_frames_that_misfit_by_themselves_are_the_flights_misfit(
    odd: int, fitting: int, unknown: int, said: bool
) -> None:
    """Tracked places agree from frame to frame: 300 frames 3 px off left .06 px."""
    chance = np.array([9e-4] * odd + [1.1e-3] * fitting + [np.nan] * unknown)
    reading = JobReadingSigma(0.06, 500.0, "residuals", chance, 0.06)
    told = frames_text(reading)
    assert bool(told) == said
    if said:
        assert_approved(told)
