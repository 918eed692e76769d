"""The summary of the report, by numbers that were put into a history by hand."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from tests.kit.estimates import estimate
from tests.kit.histories import flight, with_estimate
from vopd import report as batch_page
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.report import flag_rows, frame_table, landmark_table, summary, uncertainty_sentences

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


def test_medians_of_frames_with_an_attitude() -> None:
    """4.5 um of residual; half-widths of 4.5 times 1 to 8 degrees; eta's is half of 3 times 4.5."""
    rows = summary([made()])
    assert rows["Median residual (root mean square)"] == "4.5 µm on the film"
    half = "Median half-width of 95 %, "
    assert rows[f"{half}camera yaw, pitch, roll"] == "4.5, 9, 13.5 degree"
    assert rows[f"{half}vehicle yaw, pitch, roll"] == "18, 22.5, 27 degree"
    assert rows[f"{half}alpha, beta, eta"] == "31.5, 36, 6.75 degree"


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
    assert rows["seven"][0] == "8" and rows["seven"][7:] == ["others: see the table of frames"]


def test_every_standard_deviation_is_said_in_its_unit() -> None:
    given = Sigmas(
        reading=0.6, fiducial=0.2, landmark=0.5, position=1.5, focal_length=2.5, time_s=0.01,
        velocity=3.5, wind=4.5, mount_deg=0.25,
    )  # fmt: skip
    flown = history(estimate([[10.0, -60.0, 20.0]] * 3), sigmas=given)
    first, reading, others, jumps = uncertainty_sentences([flown], 12.5)
    label = flown.about.label
    assert first.startswith("Intervals are those of 95 %.")
    assert reading == (
        f"{label}: the standard deviation of a pick is 0.6 px, as given, 2 times the "
        "spread of repeated readings."
    )
    assert others == (
        f"{label}: other standard deviations: centre by the fiducials 0.1 px; landmark positions "
        "0.5 m; camera position 1.5 m; focal length 2.5 px; times of frames 0.01 s; mounting "
        "0.25 degree; velocity 3.5 m/s; wind 4.5 m/s."
    )
    assert jumps == "Frames that turn faster than 12.5 degrees a second are jumps."
    plain = uncertainty_sentences([history(estimate([[10.0, -60.0, 20.0]] * 3))], None)
    assert plain[2] == f"{label}: other standard deviations: none."
    assert plain[3] == "Jumps were not looked for: no --max-rate was given."


def test_columns_of_words_are_sorted_as_words() -> None:
    made_by_hand = history(estimate([[10.0, -60.0, 20.0]] * 2))
    columns = frame_table([made_by_hand]).columns
    assert [one.name for one in columns if one.words] == ["image", "status", "flags"]
    of_batch = [one.name for one in batch_page.COLUMNS if one.words]
    assert of_batch == ["source", "status", "flags", "error"]


def test_every_flag_has_its_own_count() -> None:
    counts = {row.name: row.frames for row in flag_rows([made(), made()]) if row.frames}
    assert counts == {"jump": 4, "pitch_near_90": 4, "not_converged": 4}


def test_a_landmark_s_row() -> None:
    """Residuals 1, 2, 6 in x and 0, -8, 1 in y: the longest is in the second frame."""
    residual = np.zeros((3, 8))
    residual[:, 0], residual[:, 4] = [1.0, 2.0, 6.0], [0.0, -8.0, 1.0]
    table = landmark_table([history(estimate([[10.0, -60.0, 20.0]] * 3, residual=residual))])
    row = dict(zip([column.name for column in table.columns], table.rows[0], strict=True))
    assert row["landmark"] == "church tower" and row["frames"] == "3" and row["ignored"] == "0"
    assert (row["mean x, px"], row["mean y, px"]) == ("3.000", "-2.333")
    assert (row["rms x, px"], row["rms y, px"]) == ("3.697", "4.655")  # of 41 / 3 and 65 / 3
    assert (row["largest, px"], row["in frame"]) == ("8.246", "DJI_0001.JPG")
