"""Every column and cell of the tables of jobs, frames, flags and landmarks, and of the summary."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.histories_by_hand import by_hand
from vopd.attitude.history import History
from vopd.estimate import Units, Words
from vopd.report.summary import other_sigmas_text, summary, uncertainty_sentences
from vopd.report.tables import flag_rows, frame_table, job_table, landmark_table

FILM = Units("ft", "mm", 0.3048, "µm", 1000.0)
WORDS = Words(source="deck", landmark="its number on cards", reading="a film reading")
SAID = {"source": "a.dat", "job": 2, "title": "a title", "words": WORDS, "fixes": ""}
LOST = np.array([[1.0, 2.0, 3.0], [np.nan] * 3, [1.0, 2.0, 3.0]])
FLAGS = {"not_converged": [0, 2], "misfit": [2], "jump": [0, 1, 2]}


def film(**changes: Any) -> History:
    """Three frames, the second without an attitude."""
    given = {"units": FILM, "said": SAID, "vehicle_deg": LOST, "flags": FLAGS}
    return by_hand(3, **(given | changes))


def in_source(name: str, job: int = 1, **changes: Any) -> History:
    return film(said=SAID | {"source": name, "job": job}, **changes)


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


def with_sigmas(one: History, **sigmas: Any) -> History:
    doubt = one.uncertainty
    reading = doubt.reading._replace(sigma=0.12345, source="given", freedom=7.5)
    return replace(
        one,
        uncertainty=replace(doubt, reading=reading, sigmas=doubt.sigmas._replace(**sigmas)),
    )


def test_the_table_of_jobs() -> None:
    one = with_sigmas(film(reading_spread=0.0), focal_length=0.02, centre=0.0)
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
    one = film(frame_names=())
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
    one = film(said=SAID | {"words": words})
    rows = {row.name: row for row in flag_rows([one, film()])}
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
ODD = [[False, True, False, True], [False] * 4, [False, False, False, True]]
X = np.array([[3.0, 1.0, 9.0, 0.0], [3.0, 9.0, 9.0, np.nan], [0.0, 2.0, 9.0, 0.0]]) / 1000.0
Y = np.array([[3.0, -1.0, 9.0, 0.0], [0.0, 9.0, 9.0, 1.0], [4.0, 0.0, 9.0, 0.0]]) / 1000.0
ROWS = [  # lengths 3 root 2, 3 and 4; 8 is ignored in a frame, 9 in two; 10 has a bad residual
    ["church tower", "2", "3", "0", "2.000", "2.333", "2.449", "2.887", "4.243",
     "DJI_0000.JPG", "0"],
    ["bridge; north end", "2", "2", "1", "1.500", "-0.500", "1.581", "0.707", "2.000",
     "DJI_0002.JPG", "1"],
    ["=A1", "2", "0", "2", "", "", "", "", "", "", "0"],
    ["<crossing>", "2", "2", "0", *["0.000"] * 5, "DJI_0000.JPG", "2"],
]  # fmt: skip


def of_landmarks(**changes: Any) -> History:
    given = {
        "used": np.array(USED), "ignored": np.array(IGNORED), "outlier": ODD,
        "residual": np.column_stack([X, Y]),
    }  # fmt: skip
    return film(**(given | changes))


def test_the_table_of_landmarks() -> None:
    table = landmark_table([of_landmarks()])
    assert [tuple(column) for column in table.columns] == LANDMARKS
    assert table.rows == ROWS


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


# The summary


def test_the_rows_of_the_summary() -> None:
    """Of two jobs; frames without an attitude count in no median."""
    half = np.tile(np.arange(1.0, 10.0), (3, 1))
    eta = np.tile([1.0, 4.0], (3, 1))
    half[1], eta[1] = 1e6, [0.0, 1e6]
    status = np.array([2, 1, 0])
    one = film(half_deg=half, eta_deg=eta, status=status, time_s=np.array([9.0, 1.0, 3.0]))
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
        "Median half-width of 95 %, camera yaw, pitch, roll": "1, 2, 3 degree",
        "Median half-width of 95 %, vehicle yaw, pitch, roll": "4, 5, 6 degree",
        "Median half-width of 95 %, alpha, beta, eta": "7, 8, 1.5 degree",
    }
    assert list(summary([one, other]).items()) == list(expected.items())
    assert one.uncertainty.half_width_95[0, 8] == 9.0  # which is left as it is
    alone = summary([one])
    assert alone["a.dat, job 2"] == "a title; 3 frames" and list(alone)[:-1] == list(expected)
    assert alone["Frames that misfit"] == "1; frame DJI_0002.JPG: not searched"
    untitled = summary([film(said=SAID | {"title": ""})])
    assert untitled["a.dat, job 2"] == "no title; 3 frames"
    assert summary([by_hand(1)])["hand.toml, job 1"] == "a flight by hand; 1 frame"


def test_what_is_unknown() -> None:
    """Of some angles only, or of all three."""
    half, eta = np.full((3, 9), np.inf), np.full((3, 2), np.nan)
    half[:, 1] = 2.0
    one = film(half_deg=half, eta_deg=eta, time_s=np.full(3, np.nan))
    rows = summary([replace(one, residual_rms=np.full(3, np.nan))])
    begin = "Median half-width of 95 %, "
    assert rows[f"{begin}camera yaw, pitch, roll"] == "unknown, 2, unknown degree"
    assert rows[f"{begin}vehicle yaw, pitch, roll"] == "unknown"
    assert rows[f"{begin}alpha, beta, eta"] == "unknown"
    assert (rows["Time"], rows["Median residual (root mean square)"]) == ("unknown", "unknown")


def with_effects(*worst: str, **changes: Any) -> History:
    """The errata change the first frames by more than one sigma, and these angles most."""
    one = film(
        flags={"model_error": range(len(worst))}, slip_effect_deg=np.zeros((3, 9)), **changes
    )
    detail = one.flags.detail | {"model_error": [*worst, *["alpha"] * (3 - len(worst))]}
    return replace(one, flags=replace(one.flags, detail=detail))


ERRATA = "Frames that the errata change by more than one sigma"
EFFECTS: dict[str, tuple[list[History], str | None]] = {
    "no erratum is left": ([film()], None),
    "none": ([with_effects()], "0"),
    "one job has none to correct": ([film(), with_effects("eta")],
        "1; the angle changed most is eta in 1"),
    "the most first": ([with_effects("beta"), with_effects("camera_roll", "camera_roll", "beta")],
        "4; the angle changed most is beta in 2, camera roll in 2"),
    "more": ([with_effects("beta"), with_effects("camera_roll", "camera_roll")],
        "3; the angle changed most is camera roll in 2, beta in 1"),
}  # fmt: skip


@pytest.mark.parametrize("name", EFFECTS)
def test_effects_of_errata(name: str) -> None:
    jobs, said = EFFECTS[name]
    assert summary(jobs).get(ERRATA) == said


FIRST = (
    "Intervals are those of 95 %. Standard deviations are those of the attitude angles by the "
    "partials of the collinearity equations. The readings of a job have one standard deviation, "
    "estimated from the residuals of all its frames, and never below the spread of repeated "
    "readings or the resolution of the readings. With few degrees of freedom it has the factor of "
    "Student's t."
)


def test_sentences_about_the_uncertainty() -> None:
    one = with_sigmas(film(reading_spread=0.0), centre=0.0)
    assert uncertainty_sentences([one], 0.125) == [
        FIRST,
        "a.dat, job 2: the standard deviation of a film reading is 0.123 mm, as given, 7.5 degrees "
        "of freedom.",
        "a.dat, job 2: other standard deviations: none.",
        "Frames that turn faster than 0.125 degrees a second are jumps.",
    ]
    assert uncertainty_sentences([one, one], None) == [
        FIRST,
        "The table of jobs has the standard deviations of each job.",
        "Jumps were not looked for: no --max-rate was given.",
    ]


IN_FORCE = {  # sigma: its value, what is said of it
    "centre": (0.01, "centre by the fiducials 0.01 mm"),
    "principal_point": ((0.02, 0.0), "principal point 0.02, 0 mm"),
    "landmark": (np.array([3.0, 3.0, 40.0]), "landmark positions 3, 40 ft"),
    "position": (np.full(3, 51.234), "camera position 51.2 ft"),
    "focal_length": (0.06, "focal length 0.06 mm"),
    "time_s": (0.007, "times of frames 0.007 s"),
    "mount_deg": (0.25, "mounting 0.25 degree"),
    "velocity": (8.0, "velocity 8 ft/s"),
    "wind": (9.0, "wind 9 ft/s"),
}


def test_other_standard_deviations() -> None:
    nothing = {name: np.zeros(np.shape(value)) for name, (value, _) in IN_FORCE.items()}
    for name, (value, said) in IN_FORCE.items():
        assert other_sigmas_text(with_sigmas(film(), **(nothing | {name: value}))) == said
    every = {name: value for name, (value, _) in IN_FORCE.items()}
    told = other_sigmas_text(with_sigmas(film(), **every))
    assert told == "; ".join(said for _, said in IN_FORCE.values())
    assert other_sigmas_text(with_sigmas(film(), **nothing)) == "none"
