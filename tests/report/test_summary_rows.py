"""Every row of the summary, and every sentence about the uncertainty, by numbers of one's own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.histories import SAID, by_hand, flagged_film, in_source, with_sigmas
from vopd.attitude.history import History
from vopd.report import other_sigmas_text, summary, uncertainty_sentences


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
        "Median half-width of 95 %, camera yaw, pitch, roll": "1, 2, 3 degree",
        "Median half-width of 95 %, vehicle yaw, pitch, roll": "4, 5, 6 degree",
        "Median half-width of 95 %, alpha, beta, eta": "7, 8, 1.5 degree",
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
    begin = "Median half-width of 95 %, "
    assert rows[f"{begin}camera yaw, pitch, roll"] == "unknown, 2, unknown degree"
    assert rows[f"{begin}vehicle yaw, pitch, roll"] == "unknown"
    assert rows[f"{begin}alpha, beta, eta"] == "unknown"
    assert (rows["Time"], rows["Median residual (root mean square)"]) == ("unknown", "unknown")


def with_effects(*worst: str, **changes: Any) -> History:
    """The errata change the first frames by more than one sigma, and these angles most."""
    one = flagged_film(
        flags={"model_error": range(len(worst))}, slip_effect_deg=np.zeros((3, 9)), **changes
    )
    detail = one.flags.detail | {"model_error": [*worst, *["alpha"] * (3 - len(worst))]}
    return replace(one, flags=replace(one.flags, detail=detail))


ERRATA = "Frames that the errata change by more than one sigma"
EFFECTS: dict[str, tuple[list[History], str | None]] = {
    "no erratum is left": ([flagged_film()], None),
    "none": ([with_effects()], "0"),
    "one job has none to correct": ([flagged_film(), with_effects("eta")],
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
    one = with_sigmas(flagged_film(reading_spread=0.0), centre=0.0)
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
        assert other_sigmas_text(with_sigmas(flagged_film(), **(nothing | {name: value}))) == said
    every = {name: value for name, (value, _) in IN_FORCE.items()}
    told = other_sigmas_text(with_sigmas(flagged_film(), **every))
    assert told == "; ".join(said for _, said in IN_FORCE.values())
    assert other_sigmas_text(with_sigmas(flagged_film(), **nothing)) == "none"
