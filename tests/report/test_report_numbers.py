"""The numbers of the report: the summary, and every column and cell of its tables."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import ROOT, vopd
from tests.kit.estimates import estimate
from tests.kit.histories import (
    SAID,
    WORDS,
    by_hand,
    flagged_film,
    flight,
    in_source,
    with_estimate,
    with_sigmas,
)
from tests.kit.html_page import data_of, frame_columns
from tests.tolerances import assert_close
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.flight.result import solve_flight
from vopd.geometry.earth import geodetic
from vopd.report import (
    Table,
    flag_rows,
    job_table,
    landmark_table,
    other_sigmas_text,
    summary,
    uncertainty_sentences,
)
from vopd.report import frames as report_frames
from vopd.report.answer import angle_table, doubts, not_included
from vopd.report.frames import frames_json

HILL = ROOT / "examples" / "hill" / "flight.toml"


def names(table: Table, words: bool = False) -> list[str]:
    """The names of the columns, or of those that are sorted as words."""
    return [name for name, _, of_words in table[0] if of_words or not words]


# Jobs


JOBS = [  # column, sorted as words, cell
    ("job", False, "2"),
    ("title", True, "a title"),
    ("frames", False, "3"),
    ("attitudes", False, "2"),
    ("not_converged", False, "2"),
    ("misfit", False, "1"),
    ("flagged", False, "3"),
    ("reading_sigma_mm", False, "0.123"),
    ("from", True, "as given, 7.5 degrees of freedom"),
    ("other standard deviations", True, "focal length 0.02 mm"),
]


def test_the_table_of_jobs() -> None:
    one = with_sigmas(flagged_film(reading_spread=0.0), focal_length=0.02, centre=0.0)
    columns, rows = job_table([one])
    assert [(name, words) for name, _, words in columns] == [row[:2] for row in JOBS]
    assert_approved([meaning for _, meaning, _ in columns])
    assert rows == [[row[2] for row in JOBS]]
    assert names(job_table([one, one])) == [row[0] for row in JOBS]
    columns, rows = job_table([one, in_source("b.dat", 7)])
    assert columns[1] == ("deck", "", True)
    assert [row[:3] for row in rows] == [["2", "a.dat", "a title"], ["7", "b.dat", "a title"]]


# Frames

COLUMNS = [
    "job", "frame", "image",
    "status", "time_s", "flags",
    "camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg",
    "vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg",
    "half_width_95_vehicle_yaw_deg", "half_width_95_vehicle_pitch_deg",
    "half_width_95_vehicle_roll_deg",
    "alpha_deg", "beta_deg", "eta_deg",
    "half_width_95_alpha_deg", "half_width_95_beta_deg", "eta_low_95_deg",
    "eta_high_95_deg", "airspeed_m_s", "landmarks",
    "residual_rms_px", "misfit_chance", "condition",
    "last_correction_rad",
]  # fmt: skip
OF_A_FILM = [
    {"airspeed_m_s": "airspeed_ft_s", "residual_rms_px": "residual_rms_mm"}.get(name, name)
    for name in COLUMNS
    if name != "image"
]


def columns(*made: History) -> dict[str, list[str]]:
    """The table of frames, without the columns for curves alone."""
    text = f'<script type="application/json" id="data">{frames_json(made)}</script>'
    hidden = {one["name"] for one in data_of(text)["columns"] if "hidden" in one}
    return {name: one for name, one in frame_columns(text).items() if name not in hidden}


def test_the_table_of_frames() -> None:
    """With names, an image's after its number, which stands for the frame."""
    table = columns(by_hand(3, flags={"misfit": [1], "jump": [1]}, misfit=["", "a b", ""]))
    assert list(table) == COLUMNS
    assert table["image"] == [f"DJI_000{k}.JPG" for k in range(3)]
    cells = {name: values[1] for name, values in table.items()}
    assert (cells["job"], cells["frame"], cells["image"]) == ("1", "2", "DJI_0001.JPG")
    assert (cells["status"], cells["flags"]) == ("solved", "misfit:a b;jump")
    assert (cells["landmarks"], float(cells["beta_deg"])) == ("4", 2.0)


def test_the_table_of_frames_of_several_decks() -> None:
    """The deck stands first, which several jobs of one deck do not need."""
    one = flagged_film(frame_names=())
    table = columns(one, in_source("b.dat", frame_names=()))
    assert list(table) == ["deck", *OF_A_FILM]
    assert table["deck"] == ["a.dat"] * 3 + ["b.dat"] * 3
    assert table["frame"] == ["1", "2", "3"] * 2
    assert list(columns(one, one)) == OF_A_FILM


# Flags


def test_the_table_of_flags() -> None:
    """Frames of all jobs; the source's own words before the general ones."""
    words = replace(WORDS, flags={"jump": ("own meaning", "own advice")})
    one = flagged_film(said=SAID | {"words": words})
    rows = {row[0]: row for row in flag_rows([one, flagged_film()])}
    assert rows["jump"] == ("jump", 6, "own meaning", "own advice")
    assert_approved(rows["not_converged"])
    assert (rows["misfit"][1], rows["outlier"][1]) == (2, 0)
    assert len(rows) == 14


# Landmarks

LANDMARKS = [  # column, sorted as words
    ("landmark", True), ("job", False), ("frames", False), ("ignored", False),
    ("mean x left, µm", False), ("mean y up, µm", False), ("rms x, µm", False),
    ("rms y, µm", False),
    ("largest, µm", False), ("in frame", True), ("outlier", False),
]  # fmt: skip
USED = [[True, True, False, True], [True, False, False, True], [True, True, False, True]]
LEFT_OUT = [[False, False, True, False], [False, True, True, False], [False] * 4]
ODD = [[False, True, False, True], [False, False, False, True], [False, False, False, True]]
X = np.array([[3.0, 1.0, 9.0, 0.0], [3.0, 9.0, 9.0, np.nan], [0.0, 2.0, 9.0, 0.0]]) / 1000.0
Y = np.array([[3.0, -1.0, 9.0, 0.0], [0.0, 9.0, 9.0, 1.0], [4.0, 0.0, 9.0, 0.0]]) / 1000.0


def of_landmarks(**changes: Any) -> History:
    given = {
        "used": np.array(USED), "ignored": np.array(LEFT_OUT), "outlier": ODD,
        "residual": np.column_stack([X, Y]),
    }  # fmt: skip
    return flagged_film(**(given | changes))


ROWS = [  # lengths 3 root 2, 3 and 4; 8 is ignored in a frame, 9 in two; 10 has a bad residual
    ["church tower", "2", "3", "0", "2.000", "2.333", "2.449", "2.887", "4.243",
     "DJI_0000.JPG", "0"],
    ["bridge; north end", "2", "2", "1", "1.500", "-0.500", "1.581", "0.707", "2.000",
     "DJI_0002.JPG", "1"],
    ["=A1", "2", "0", "2", "", "", "", "", "", "", "0"],
    ["<crossing>", "2", "2", "0", *["0.000"] * 5, "DJI_0000.JPG", "3"],
]  # fmt: skip


def test_the_table_of_landmarks() -> None:
    columns, rows = landmark_table([of_landmarks()])
    assert [(name, words) for name, _, words in columns] == LANDMARKS and rows == ROWS
    assert_approved([meaning for _, meaning, _ in columns])


def test_a_landmark_that_never_has_a_residual_has_no_row() -> None:
    residual = np.column_stack([X, Y])
    residual[:, 3] = np.nan
    _, rows = landmark_table([of_landmarks(residual=residual)])
    assert [row[0] for row in rows] == ["church tower", "bridge; north end", "=A1"]


def test_landmarks_of_one_frame_name_it() -> None:
    _, rows = landmark_table([by_hand(1)])
    assert [row[2] for row in rows] == ["1"] * 4
    assert [row[-2] for row in rows] == ["DJI_0000.JPG"] * 4


def test_landmarks_of_several_decks_and_without_names() -> None:
    one = of_landmarks(landmark_names={}, frame_names=())
    columns, rows = landmark_table([one, in_source("b.dat", 5)])
    assert columns[:3] == [
        ("landmark", "its number on cards", False), ("deck", "", True), ("job", "", False)
    ]  # fmt: skip
    assert [words for name, _, words in columns if name == "in frame"] == [False]
    assert [row[:3] for row in rows[:4]] == [[str(n), "a.dat", "2"] for n in (7, 8, 9, 10)]
    assert [row[-2] for row in rows[:4]] == ["1", "3", "", "1"]
    assert rows[4][:3] == ["church tower", "b.dat", "5"]
    assert len(landmark_table([one, one])[0]) == len(LANDMARKS)


# The summary

FRAMES, IGNORED = 9, 7
"""Frames of the flight, and the index of the one that is ignored."""


@cache
def made() -> History:
    """Nine frames, of which frame 8 has no attitude, with numbers whose mean is not their median.

    The frames are not in the order of time.
    """
    (history,) = flight(FRAMES)
    assert np.flatnonzero(~history.has_attitude).tolist() == [IGNORED]
    values = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 70.0, 1e6, 800.0])  # median 4.5 without 1e6
    doubt = history.uncertainty
    half = np.outer(values, np.arange(1.0, 10.0))
    eta = np.stack([100.0 - values, 100.0 + 2.0 * values], axis=1)
    raised = {name: np.zeros(FRAMES, bool) for name in history.flags.raised}
    raised["jump"][[1, 2]] = raised["pitch_near_90"][[2, 3]] = True
    raised["not_converged"][[4, 5]] = True
    timed = with_estimate(
        history, time_s=np.array([5.0, 3.25, 9.0, 4.0, 12.5, 7.0, 6.0, 99.0, 8.0])
    )
    return replace(
        timed,
        residual_rms=values / 1000.0,
        uncertainty=replace(doubt, half_width_95=half, eta_interval_95_deg=eta),
        flags=replace(history.flags, raised=raised),
    )


def test_the_numbers_of_frames() -> None:
    rows = summary([made()])
    assert rows["Jobs"] == "1" and rows["Frames"] == "9: 8 solved, 1 ignored"
    assert rows["Frames with an attitude"] == "8"
    assert rows["Frames with a flag"] == "5" and rows["Frames that did not converge"] == "2"
    twice = summary([made(), made()])
    assert twice["Jobs"] == "2" and twice["Frames with a flag"] == "10"


def test_the_span_of_time_is_that_of_frames_with_an_attitude() -> None:
    assert summary([made()])["Time"] == "3.250 to 12.500 s"


def test_the_median_residual_of_frames_with_an_attitude() -> None:
    assert summary([made()])["Median residual (root mean square)"] == "4.5 µm on the film"


def test_the_angles_of_frames_with_an_attitude() -> None:
    """Half-widths of 1 to 8 times the values: median 4.5, largest 800; eta's is half of 3 times."""
    head, rows = angle_table([made()])
    assert head[0] == "angle" and head[3:] == ["± (95 %), median", "± (95 %), largest"]
    widths = {row[0]: row[3:] for row in rows}
    assert widths["camera yaw"] == ["4.5", "800"] and widths["camera pitch"] == ["9.0", "1600"]
    assert widths["vehicle yaw"] == ["18", "3200"] and widths["vehicle roll"] == ["27", "4800"]
    assert widths["alpha"] == ["32", "5600"] and widths["eta"] == ["6.8", "1200"]


def test_angles_of_one_frame_and_about_north() -> None:
    """Yaw from 350 to 10 is not 10 to 350; one frame has its angles with their half-widths."""
    angles = np.tile([10.0, -60.0, 20.0], (3, 3))
    angles[:, 3] = [355.0, 350.0, 10.0]
    half = np.full((3, 9), 0.05)
    half[2, 3] = np.inf
    rows = angle_table([by_hand(3, angles_deg=angles, half_deg=half)])[1]
    assert rows[0] == ["vehicle yaw", "350.000", "10.000", "0.050", "0.050; unknown in 1 frame"]
    head, rows = angle_table([by_hand(1, angles_deg=angles[:1], half_deg=half[:1])])
    assert head == ["angle", "degrees", "± (95 %)"] and rows[0] == [
        "vehicle yaw",
        "355.000",
        "0.050",
    ]
    for width, shown in ((1e-9, ["355.000000", "1.0e-09"]), (9.97, ["355.00", "10"])):
        sure = np.full((1, 9), width)
        rows = angle_table([by_hand(1, angles_deg=angles[:1], half_deg=sure)])[1]
        assert rows[0] == ["vehicle yaw", *shown]
    both = angle_table([by_hand(3), by_hand(1, angles_deg=angles[:1])])[1]
    assert [row[0] for row in both][3] == "camera yaw"  # which is turned in one of them


@pytest.mark.parametrize(
    ("rolls", "ends"),
    [
        ((179.0, 181.0), ("179.000", "181.000")),
        ((358.0, 2.0), ("-2.000", "2.000")),
        ((190.0, 192.0), ("-170.000", "-168.000")),
        ((90.0, 180.0), ("90.000", "180.000")),
        ((0.0, 359.99996), ("0.000", "0.000")),
    ],
)
def test_a_range_of_roll_goes_on_beyond_180_and_rounds_to_its_range(
    rolls: tuple[float, float], ends: tuple[str, str]
) -> None:
    """A yaw of the same 359.99996 rounds to 0, and not to 360."""
    angles = np.tile([10.0, -60.0, 20.0], (2, 3))
    angles[:, 5], angles[:, 3] = rolls, 359.99996
    rows = angle_table([by_hand(2, angles_deg=angles, half_deg=np.full((2, 9), 0.05))])[1]
    assert {row[0]: tuple(row[1:3]) for row in rows}["vehicle roll"] == ends
    assert {row[0]: tuple(row[1:3]) for row in rows}["vehicle yaw"] == ("0.000", "0.000")


def test_what_is_doubtful_and_what_no_sigma_includes() -> None:
    """A fact is told once: a second solution that two landmarks bring is no doubt of its own."""
    flags = {"jump": [0], "two_landmarks": [0, 1], "second_solution": [0, 1]}
    found = doubts([flagged_film(flags=flags)])
    assert [(one.flag, one.text.split(":")[0]) for one in found] == [
        ("", "1 of 3 frames"), ("two_landmarks", "2 of 3 frames"), ("jump", "1 of 3 frames")
    ]  # fmt: skip
    assert doubts([by_hand(3)]) == []
    assert_approved(not_included([flagged_film()]), parts=[])
    assert_approved(not_included([with_effect(2.0)] * 6))
    everything = {name: np.full(np.shape(value), 0.5) for name, (value, _) in IN_FORCE.items()}
    assert not_included([with_sigmas(flagged_film(), **everything)]) == []


def misfits(*told: str) -> History:
    """The same flight, in which the first frames misfit, each with what explains it."""
    one = made()
    raised = one.flags.raised | {"misfit": np.arange(FRAMES) < len(told)}
    detail = one.flags.detail | {"misfit": [*told, *[""] * (FRAMES - len(told))]}
    return replace(one, flags=replace(one.flags, raised=raised, detail=detail))


def test_misfits_of_all_jobs_are_counted_and_six_explanations_told() -> None:
    """Three explanations of a job at most, and six in all; "others" only where there are more."""
    three = misfits("without 1 (chance 0.25)", "without 2 (chance 0.50)", "without 3 (chance 0.75)")
    two = misfits("without 4 (chance 0.50)", "without 4 (chance 0.25)")
    rows = {n: summary(some)["Frames that misfit"].split("; ") for n, some in (
        ("one", [two]), ("two", [three, two, made()]), ("six", [three, three]),
        ("seven", [three, two, three]),
    )}  # fmt: skip
    frames = two.estimate.frame[:2].tolist()
    label = two.about.label
    last = f"frames {frames[0]}-{frames[1]}: without 4 (chance 0.25 or more)"
    assert rows["one"] == ["2", last]
    assert rows["two"][0] == "5" and rows["two"][4:] == [f"{label}, {last}"]
    assert rows["six"][0] == "6" and len(rows["six"]) == 7 and "others" not in rows["six"][-1]
    assert rows["seven"][0] == "8"
    assert_approved(rows["seven"][7:])


def test_every_standard_deviation_is_said_in_its_unit() -> None:
    given = Sigmas(
        reading=0.6, fiducial=0.2, landmark=0.5, position=1.5, focal_length=2.5, time_s=0.01,
        velocity=3.5, wind=4.5, mount_deg=0.25,
    )  # fmt: skip
    flown = history(estimate([[10.0, -60.0, 20.0]] * 3), sigmas=given)
    first, reading, others, jumps = uncertainty_sentences([flown], 12.5)
    label = flown.about.label
    assert_approved(first)
    assert_approved(reading, parts=[label, "0.6 px", "2 times"])
    assert_approved(others, parts=[label, 0.1, 0.5, 1.5, 2.5, 0.01, 0.25, 3.5, 4.5])
    assert_approved(jumps, parts=[12.5])
    plain = uncertainty_sentences([history(estimate([[10.0, -60.0, 20.0]] * 3))], None)
    assert_approved(plain[2], parts=[label])
    assert_approved(plain[3])


def test_every_flag_has_its_own_count() -> None:
    counts = {name: count for name, count, _, _ in flag_rows([made(), made()]) if count}
    assert counts == {"jump": 4, "pitch_near_90": 4, "not_converged": 4}


def test_a_landmark_s_row() -> None:
    """Residuals 1, 2, 6 in x and 0, -8, 1 in y: the longest is in the second frame."""
    residual = np.zeros((3, 8))
    residual[:, 0], residual[:, 4] = [1.0, 2.0, 6.0], [0.0, -8.0, 1.0]
    table = landmark_table([history(estimate([[10.0, -60.0, 20.0]] * 3, residual=residual))])
    row = dict(zip(names(table), table[1][0], strict=True))
    assert row["landmark"] == "church tower" and row["frames"] == "3" and row["ignored"] == "0"
    assert (row["mean u right, px"], row["mean v down, px"]) == ("-3.000", "2.333")
    assert (row["rms u, px"], row["rms v, px"]) == ("3.697", "4.655")  # of 41 / 3 and 65 / 3
    assert (row["largest, px"], row["in frame"]) == ("8.246", "DJI_0001.JPG")


# Every row of the summary, and every sentence about the uncertainty


def test_the_rows_of_the_summary() -> None:
    """Of two jobs; frames without an attitude count in no median."""
    half = np.tile(np.arange(1.0, 10.0), (3, 1))
    eta = np.tile([1.0, 4.0], (3, 1))
    half[1], eta[1] = 1e6, [0.0, 1e6]
    status = np.array([2, 1, 0])
    one = flagged_film(half_deg=half, eta_deg=eta, status=status, time_s=np.array([9.0, 1.0, 3.0]))
    one = replace(one, residual_rms=np.array([0.001234567, 9.0, 0.001234567]))
    other = in_source("b.dat", half_deg=half, eta_deg=eta, flags={}, time_s=np.full(3, np.nan))
    other = replace(other, residual_rms=np.full(3, np.nan))
    expected = {
        "Jobs": "2",
        "Frames": "6: 1 exact, 1 ignored, 4 solved",
        "Frames with an attitude": "4",
        "Frames with a flag": "3",
        "Frames that did not converge": "2",
        "Frames that misfit": "1; a.dat, job 2, frame DJI_0002.JPG: not searched",
        "Time": "3.000 to 9.000 s",
        "Median residual (root mean square)": "1.235 µm in the image",
    }
    assert list(summary([one, other]).items()) == list(expected.items())
    assert one.uncertainty.half_width_95[0, 8] == 9.0  # which is left as it is
    alone = summary([one])
    assert alone["a.dat, job 2"] == "a title; 3 frames" and list(alone)[:-1] == list(expected)
    assert alone["Frames that misfit"] == "1; frame DJI_0002.JPG: not searched"
    untitled = summary([flagged_film(said=SAID | {"title": ""})])
    assert untitled["a.dat, job 2"] == "no title; 3 frames"
    assert summary([by_hand(1)])["hand.toml, job 1"] == "a flight by hand; 1 frame"


def test_what_is_unknown() -> None:
    """Of some angles only, or of all three."""
    half, eta = np.full((3, 9), np.inf), np.full((3, 2), np.nan)
    half[:, 1] = 2.0
    one = flagged_film(half_deg=half, eta_deg=eta, time_s=np.full(3, np.nan))
    rows = summary([replace(one, residual_rms=np.full(3, np.nan))])
    widths = {row[0]: row[3] for row in angle_table([one])[1]}
    assert widths["camera yaw"] == widths["eta"] == "unknown" and widths["camera pitch"] == "2.0"
    assert (rows["Time"], rows["Median residual (root mean square)"]) == ("unknown", "unknown")


def with_effect(degrees: float, **changes: Any) -> History:
    """A film of which the errata change the camera's roll in one frame by so much."""
    effect = np.zeros((3, 9))
    effect[1, 2] = degrees
    one = flagged_film(slip_effect_deg=effect, **changes)
    return replace(one, uncertainty=replace(one.uncertainty, total=np.full((3, 9), 0.5)))


EFFECTS: dict[str, list[History]] = {
    "no erratum is left": [flagged_film()],
    "none": [with_effect(1e-9)],
    "one job has none to correct": [flagged_film(), with_effect(2.0)],
    "of six jobs": [with_effect(2.0)] * 6,
    "of eight jobs, and none of another": [with_effect(1e-9), *[with_effect(2.0)] * 8],
}


@pytest.mark.parametrize("name", EFFECTS)
def test_effects_of_errata(name: str) -> None:
    assert_approved(summary(EFFECTS[name]).get("Errata of the original program", ""))


def test_sentences_about_the_uncertainty() -> None:
    one = with_sigmas(flagged_film(reading_spread=0.0), centre=0.0)
    assert_approved(uncertainty_sentences([one], 0.125), parts=["0.123 mm", "7.5 degrees", 0.125])
    assert_approved(uncertainty_sentences([one, one], None))


IN_FORCE = {  # sigma: its value, how that stands in the text
    "centre": (0.01, "0.01 mm"),
    "principal_point": ((0.02, 0.0), "0.02, 0 mm"),
    "landmark": (np.array([3.0, 3.0, 40.0]), "3, 40 ft"),
    "position": (np.full(3, 51.234), "51.2 ft"),
    "place": (np.array([1.0, 1.0, 2.0]), "1, 2 ft"),  # common to all positions
    "focal_length": (0.06, "0.06 mm"),
    "time_s": (0.007, "0.007 s"),
    "mount_deg": (0.25, "0.25 degree"),
    "velocity": (np.array([[8.0, 8.0, 0.0], [9.5, 9.5, 0.0]]), "8 to 9.5 ft/s"),
    "wind": (9.0, "9 ft/s"),
}


def test_other_standard_deviations() -> None:
    nothing = {name: np.zeros(np.shape(value)) for name, (value, _) in IN_FORCE.items()}
    for name, (value, part) in IN_FORCE.items():
        told = other_sigmas_text(with_sigmas(flagged_film(), **(nothing | {name: value})))
        assert_approved(told, parts=[part])
    every = {name: value for name, (value, _) in IN_FORCE.items()}
    told = other_sigmas_text(with_sigmas(flagged_film(), **every))
    assert_approved(told)
    assert other_sigmas_text(with_sigmas(flagged_film(), **nothing)) == "none stated"


# Horizon and north of the frames' images


def test_the_horizon_of_every_frame() -> None:
    """As the frame's own scene projects it; the azimuths along it are whole steps."""
    solved = solve_flight(HILL).history()
    (job,) = json.loads(frames_json([solved]))["jobs"]
    assert solved.estimate.scene is not None
    scene, start = solved.estimate.scene(), 0
    horizon = job["horizon"]
    for k, count in enumerate(horizon["count"]):
        view = scene.image(k, "") if scene.image else None
        assert view is not None and count > 10
        pixel = np.transpose([horizon[one][start : start + count] for one in "uv"])
        start += count
        seen = view.direction_of(pixel.astype(float))
        azimuth = np.degrees(np.arctan2(seen[:, 0], seen[:, 1])) % 360.0
        along = (horizon["first"][k] + horizon["step"][k] / 2.0 * np.arange(count)) % 360.0
        assert horizon["first"][k] % horizon["step"][k] == 0.0
        assert_close("azimuth of whole pixels", (azimuth - along + 180.0) % 360.0, 180.0)
        height_m = geodetic(scene.camera_m[k]).height_m - geodetic(scene.landmark_m).height_m.min()
        dip = np.sqrt(2.0 * height_m * 0.87 / 6371e3)  # a plain, and standard refraction
        assert_close("azimuth of whole pixels", np.degrees(np.arcsin(seen[:, 2]) + dip), 0.0)
    assert set(job["north"]["u"]) == {None}


def test_picks_of_a_check_landmark_are_no_misfits(tmp_path: Path) -> None:
    """State 0: they take part; 1: they do not; 2: they do not fit."""
    shutil.copytree(HILL.parent, tmp_path / "hill")
    project = tmp_path / "hill" / "flight.toml"
    project.write_text(project.read_text() + '[solve]\ncheck_landmarks = ["tower"]\n')
    solved = solve_flight(project).history()
    (job,) = json.loads(frames_json([solved]))["jobs"]
    mark, state = (np.array(job["picks"][one]) for one in ("landmark", "state"))
    (check,) = np.unique(mark[state != 0])
    assert set(state[mark == check]) == {1} and job["names"][check] == "tower"
    assert not any(job["others"]["count"])  # all are picked
    assert any(one % 1.0 for one in job["camera"]["east_m"])  # near places are to a centimetre


def test_a_pick_that_is_left_out_does_not_fit(tmp_path: Path) -> None:
    """It takes no part either, which is not what is to be seen of it."""
    shutil.copytree(HILL.parent, tmp_path / "hill")
    project, picks = (tmp_path / "hill" / name for name in ("flight.toml", "picks.csv"))
    project.write_text(project.read_text() + '[solve]\nblunders = "drop"\n')
    head, first, *others = picks.read_text().splitlines()
    frame, name, u, *rest = first.split(",")
    wrong = ",".join([frame, name, str(float(u) + 200.0), *rest])
    picks.write_text("\n".join([head, wrong, *others, ""]))
    (job,) = json.loads(frames_json([solve_flight(project).history()]))["jobs"]
    state = np.array(job["picks"]["state"])
    assert sorted(state.tolist())[-2:] == [0, 2]
    assert job["names"][int(np.array(job["picks"]["landmark"])[state == 2][0])] == name


def test_the_way_north_where_no_horizon_is_seen(tmp_path: Path) -> None:
    """In a camera that looks down by 35 degrees, as far to the left as its yaw says."""
    vopd("new", tmp_path / "example")
    solved = solve_flight(tmp_path / "example" / "flight.toml").history()
    (job,) = json.loads(frames_json([solved]))["jobs"]
    assert set(job["horizon"]["count"]) == {0}
    yaw, pitch, roll = np.radians(solved.estimate.camera_deg[0])
    level = np.array([np.cos(yaw), -np.sin(yaw), 0.0])  # north: forward, right, down, level
    across = np.array([level[1], level[0] * np.sin(pitch)])  # turned by pitch: right, down
    turned = [
        across[0] * np.cos(roll) + across[1] * np.sin(roll),
        across[1] * np.cos(roll) - across[0] * np.sin(roll),
    ]
    shown = np.array([job["north"]["u"][0], job["north"]["v"][0]])
    assert_close("way north", shown, turned / np.hypot(*turned))


def test_distances_are_from_nine_places_of_the_whole_way() -> None:
    """The first and the last that are known among them; of fewer places from all."""
    camera_m = np.stack([np.arange(101.0), np.zeros(101), np.zeros(101)], axis=1)
    camera_m[[0, 100]] = np.nan
    scene: Any = SimpleNamespace(landmark_m=np.array([[0.0, 0.0, 0.0], [200.0, 0.0, 0.0]]))
    found = report_frames._distances(scene, camera_m)
    assert found[[0, -1]].tolist() == [[1.0, 199.0], [99.0, 101.0]] and len(found) == 9
    assert report_frames._distances(scene, camera_m[:3]).tolist() == [[1.0, 199.0], [2.0, 198.0]]
    assert report_frames._distances(scene, camera_m[:1]).size == 0
