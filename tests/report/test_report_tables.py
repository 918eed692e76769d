"""Every column and cell of the tables of jobs, frames, flags and landmarks."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from tests.kit.histories import SAID, WORDS, by_hand, flagged_film, in_source, with_sigmas
from vopd.attitude.history import History
from vopd.report import flag_rows, frame_table, job_table, landmark_table

# Jobs

JOBS = [  # column, meaning, sorted as words, cell
    ("job", "its number", False, "2"),
    ("title", "", True, "a title"),
    ("frames", "of the job", False, "3"),
    ("attitudes", "frames with an attitude", False, "2"),
    ("not_converged", "frames that did not converge", False, "2"),
    ("misfit", "frames whose residuals do not agree with the standard deviations", False, "1"),
    ("flagged", "frames with any flag", False, "3"),
    ("reading_sigma_mm", "standard deviation of a film reading", False, "0.123"),
    ("from", "where that is from, and how well it is known", True,
     "as given, 7.5 degrees of freedom"),
    ("other standard deviations", "those in force", True, "focal length 0.02 mm"),
]  # fmt: skip


def test_the_table_of_jobs() -> None:
    one = with_sigmas(flagged_film(reading_spread=0.0), focal_length=0.02, centre=0.0)
    table = job_table([one])
    assert [tuple(column) for column in table.columns] == [row[:3] for row in JOBS]
    assert table.rows == [[row[3] for row in JOBS]]
    two = job_table([one, one])
    assert [column.name for column in two.columns] == [row[0] for row in JOBS]
    other = job_table([one, in_source("b.dat", 7)])
    assert tuple(other.columns[1]) == ("deck", "", True)
    assert [row[:3] for row in other.rows] == [["2", "a.dat", "a title"], ["7", "b.dat", "a title"]]


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


def test_the_table_of_frames() -> None:
    """With names, an image's after its number, which stands for the frame."""
    table = frame_table([by_hand(3, flags={"misfit": [1], "jump": [1]}, misfit=["", "a b", ""])])
    assert [column.name for column in table.columns] == COLUMNS
    assert [column.name for column in table.columns if column.words] == ["image", "status", "flags"]
    assert all(column.meaning for column in table.columns)
    assert [row.label for row in table.rows] == [f"DJI_000{k}.JPG" for k in range(3)]
    assert [row.flags for row in table.rows] == ["", "misfit jump", ""]
    cells = dict(zip(COLUMNS, table.rows[1].cells, strict=True))
    assert (cells["job"], cells["frame"], cells["image"]) == ("1", "2", "DJI_0001.JPG")
    assert (cells["status"], cells["flags"]) == ("solved", "misfit:a b;jump")
    assert (cells["landmarks"], float(cells["beta_deg"])) == ("4", 2.0)


def test_the_table_of_frames_of_several_decks() -> None:
    """The deck stands first, which several jobs of one deck do not need."""
    one = flagged_film(frame_names=())
    table = frame_table([one, in_source("b.dat", frame_names=())])
    assert [column.name for column in table.columns] == ["deck", *OF_A_FILM]
    assert [column.name for column in table.columns if column.words] == ["deck", "status", "flags"]
    assert [row.cells[0] for row in table.rows] == ["a.dat"] * 3 + ["b.dat"] * 3
    assert [row.label for row in table.rows] == ["1", "2", "3"] * 2
    assert [column.name for column in frame_table([one, one]).columns] == OF_A_FILM


# Flags


def test_the_table_of_flags() -> None:
    """Frames of all jobs; the source's own words before the general ones."""
    words = replace(WORDS, flags={"jump": ("own meaning", "own advice")})
    one = flagged_film(said=SAID | {"words": words})
    rows = {row.name: row for row in flag_rows([one, flagged_film()])}
    assert tuple(rows["jump"]) == ("jump", 6, "own meaning", "own advice")
    assert tuple(rows["not_converged"]) == (
        "not_converged", 4, "the last correction exceeds 1e-6 rad or is not a number",
        "look at the measured coordinates and at the first estimate",
    )  # fmt: skip
    assert (rows["misfit"].frames, rows["outlier"].frames) == (2, 0)
    assert len(rows) == 12


# Landmarks

LANDMARKS = [
    ("landmark", "its number on cards", True),
    ("job", "", False),
    ("frames", "in which it takes part", False),
    ("ignored", "frames from which it is left out", False),
    ("mean x, µm", "of the residuals", False),
    ("mean y, µm", "of the residuals", False),
    ("rms x, µm", "root mean square of the residuals", False),
    ("rms y, µm", "root mean square of the residuals", False),
    ("largest, µm", "the longest residual", False),
    ("in frame", "where that is", True),
    ("outlier", "frames in which it is the outlier", False),
]
USED = [[True, True, False, True], [True, False, False, True], [True, True, False, True]]
IGNORED = [[False, False, True, False], [False, True, True, False], [False] * 4]
ODD = [[False, True, False, True], [False, False, False, True], [False, False, False, True]]
X = np.array([[3.0, 1.0, 9.0, 0.0], [3.0, 9.0, 9.0, np.nan], [0.0, 2.0, 9.0, 0.0]]) / 1000.0
Y = np.array([[3.0, -1.0, 9.0, 0.0], [0.0, 9.0, 9.0, 1.0], [4.0, 0.0, 9.0, 0.0]]) / 1000.0
ROWS = [  # lengths 3 root 2, 3 and 4; 8 is ignored in a frame, 9 in two; 10 has a bad residual
    ["church tower", "2", "3", "0", "2.000", "2.333", "2.449", "2.887", "4.243",
     "DJI_0000.JPG", "0"],
    ["bridge; north end", "2", "2", "1", "1.500", "-0.500", "1.581", "0.707", "2.000",
     "DJI_0002.JPG", "1"],
    ["=A1", "2", "0", "2", "", "", "", "", "", "", "0"],
    ["<crossing>", "2", "2", "0", *["0.000"] * 5, "DJI_0000.JPG", "3"],
]  # fmt: skip


def of_landmarks(**changes: Any) -> History:
    given = {
        "used": np.array(USED), "ignored": np.array(IGNORED), "outlier": ODD,
        "residual": np.column_stack([X, Y]),
    }  # fmt: skip
    return flagged_film(**(given | changes))


def test_the_table_of_landmarks() -> None:
    table = landmark_table([of_landmarks()])
    assert [tuple(column) for column in table.columns] == LANDMARKS
    assert table.rows == ROWS


def test_a_landmark_that_never_has_a_residual_has_no_row() -> None:
    residual = np.column_stack([X, Y])
    residual[:, 3] = np.nan
    table = landmark_table([of_landmarks(residual=residual)])
    assert [row[0] for row in table.rows] == ["church tower", "bridge; north end", "=A1"]


def test_landmarks_of_one_frame_name_it() -> None:
    rows = landmark_table([by_hand(1)]).rows
    assert [row[2] for row in rows] == ["1"] * 4
    assert [row[-2] for row in rows] == ["DJI_0000.JPG"] * 4


def test_landmarks_of_several_decks_and_without_names() -> None:
    one = of_landmarks(landmark_names={}, frame_names=())
    table = landmark_table([one, in_source("b.dat", 5)])
    assert [tuple(column) for column in table.columns[:3]] == [
        ("landmark", "its number on cards", False), ("deck", "", True), ("job", "", False)
    ]  # fmt: skip
    assert [column.words for column in table.columns if column.name == "in frame"] == [False]
    assert [row[:3] for row in table.rows[:4]] == [[str(n), "a.dat", "2"] for n in (7, 8, 9, 10)]
    assert [row[-2] for row in table.rows[:4]] == ["1", "3", "", "1"]
    assert table.rows[4][:3] == ["church tower", "b.dat", "5"]
    assert len(landmark_table([one, one]).columns) == len(LANDMARKS)
