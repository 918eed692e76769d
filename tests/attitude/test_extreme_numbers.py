"""Readings and tables with absurd numbers: one bad frame is flagged, the others come out.

The damaged decks go through the command line, the arrays through the library.
"""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.command import vopd
from tests.kit.jobs import film
from tests.tolerances import assert_close, within
from vopd.attitude.flags import MEANING
from vopd.attitude.history import History
from vopd.attitude.sigmas import Sigmas
from vopd.export import FORMATS, FileRequest
from vopd.figures import draw
from vopd.job import Job, Readings
from vopd.pipeline import run

EVERY_SIGMA = Sigmas(None, 0.01, 30.0, 60.0, 0.01, 0.1, 10.0, 10.0, 0.1)
EPOCH = datetime(1974, 1, 1, tzinfo=UTC)
HUGE = (1e30, 1e150, 1e300, np.nan, np.inf, -np.inf)
BAD = 2  # the index of the frame that is damaged


def damaged(part: str, field: str, where: Any, value: float) -> Job:
    """Five good frames of five landmarks, with one number replaced."""
    job = film(5)
    record = getattr(job, part)
    array = np.array(getattr(record, field), float)
    array[where] = value
    if field == "landmark_in":
        changed = Readings.of(
            record.frame, record.fiducial_in, record.landmark, record.present, array
        )
        return replace(job, readings=changed)
    return replace(job, **{part: replace(record, **{field: array})})


def history_of(job: Job) -> History:
    (one,) = run(job).histories(EVERY_SIGMA, 10.0)
    return one


@pytest.mark.parametrize("value", HUGE, ids=str)
@pytest.mark.parametrize(
    ("field", "where"),
    [("fiducial_in", (BAD, 0, 0, 0)), ("landmark_in", (BAD, 1)), ("landmark_in", BAD)],
    ids=["fiducial", "landmark", "all landmarks"],
)
def test_one_bad_reading_costs_one_frame(field: str, where: Any, value: float) -> None:
    good, one = history_of(film(5)), history_of(damaged("readings", field, where, value))
    assert one.flags.raised["not_converged"][BAD] or one.flags.raised["out_of_range"][BAD]
    before = slice(0, BAD)
    np.testing.assert_array_equal(one.estimate.camera_deg[before], good.estimate.camera_deg[before])
    np.testing.assert_array_equal(one.geometry.condition[before], good.geometry.condition[before])
    if not np.isfinite(value) or value > 1e200:  # NaN: the next frame starts from group 8 again
        np.testing.assert_array_equal(one.has_attitude, [True, True, False, True, True])
        np.testing.assert_array_equal(one.estimate.camera_deg[3:], good.estimate.camera_deg[3:])
        assert np.isfinite(one.quaternion[3:]).all()


@pytest.mark.parametrize("value", HUGE, ids=str)
def test_one_bad_reading_is_not_the_noise_of_all_frames(value: float) -> None:
    """One of three readings of one landmark: the deviations of the other frames do not grow."""
    good = history_of(film(5))
    one = history_of(damaged("readings", "landmark_in", (BAD, 1, 0, 0), value))
    ratio = one.uncertainty.reading.sigma / good.uncertainty.reading.sigma
    assert abs(ratio - 1.0) < within("ratio")
    first = one.uncertainty.total[:BAD] / good.uncertainty.total[:BAD]
    assert_close("ratio", first, 1.0)
    assert one.flags.text()[:BAD] == good.flags.text()[:BAD]


MAY_BE_INFINITE = ("sigma_", "half_width_95_", "covariance_", "status", "deck", "flags")

CASES = {
    "position": damaged("trajectory", "position_ft", (BAD, 0), 1e300),
    "altitude": damaged("trajectory", "altitude_ft", BAD, 1e300),
    "velocity": damaged("trajectory", "velocity_ft_s", (BAD, 0), np.inf),
    "no velocity": damaged("trajectory", "velocity_ft_s", slice(None), 0.0),
    "landmark": damaged("landmarks", "altitude_ft", BAD, 1e30),
    "multiplier": damaged("camera", "multiplier", 0, 1e30),
    "first estimate": damaged("camera", "initial_deg", 0, 1e300),
    "focal length": damaged("camera", "focal_length_mm", (), 1e30),
    "no focal length": damaged("camera", "focal_length_mm", (), 0.0),
    "short focal length": damaged("camera", "focal_length_mm", (), 1e-30),
    "time": damaged("clock", "time_s", 1, 1e300),
}


@pytest.mark.parametrize("name", CASES)
def test_every_format_takes_absurd_numbers(name: str) -> None:
    """No exception, no numpy warning, and no number that is not finite, but sigmas in a CSV."""
    one = history_of(CASES[name])
    for form in FORMATS:
        content = FORMATS[form].render([one], FileRequest(epoch=EPOCH), lambda _: None)
        if not FORMATS[form].binary:
            text = content.decode()
            for wrong in (">inf<", ">nan<", ",nan,", "Infinity", ": NaN", " nan", " inf "):
                assert wrong not in text, (form, wrong)
        if form == "csv":
            rows = [line for line in content.decode().splitlines() if not line.startswith("#")]
            for row in csv.DictReader(rows):
                infinite = {column for column, cell in row.items() if "inf" in cell}
                assert all(column.startswith(MAY_BE_INFINITE) for column in infinite)
        if form in ("czml",):
            json.loads(content)


@pytest.mark.parametrize("name", ["image", "residuals", "attack"])
def test_figures_take_absurd_numbers(name: str) -> None:
    for job in (CASES["position"], damaged("readings", "landmark_in", (BAD, 1), 1e30)):
        draw(name, [history_of(job)]).draw_without_rendering()


def test_angles_that_the_listing_cannot_print_are_flagged() -> None:
    """A frame that converges, to a vehicle yaw that is printed as asterisks."""
    one = history_of(CASES["multiplier"])
    assert one.estimate.converged.all()
    assert (np.abs(one.estimate.vehicle_deg[:, 0]) > 1e5).all()
    assert one.flags.raised["out_of_range"].all() and "out_of_range" in MEANING


@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize("command", ["attitude", "report"])
def test_a_deck_with_a_fiducial_reading_of_1e30(command: str, tmp_path: Path) -> None:
    """The frame is flagged, the exit status says so, and the rest comes out."""
    cards = vopd("demo", "--frames", "4", "--landmarks", "3", "--seed", "3").stdout.splitlines()
    k = next(k for k, card in enumerate(cards) if card.startswith("10000") and card[-4:] == "0003")
    cards[k] = cards[k][:40] + "  1.E30" + cards[k][47:]
    deck = tmp_path / "damaged.dat"
    deck.write_text("\n".join(cards) + "\n")
    suffix = {"attitude": "csv", "report": "html"}[command]
    done = vopd(command, deck, "-o", tmp_path / f"out.{suffix}", "-q")
    assert done.status == 3, done.stderr
    if command == "attitude":
        lines = (tmp_path / "out.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        assert [row["status"] for row in rows] == ["solved"] * 4
        assert "not_converged" in rows[2]["flags"]
        assert "not_converged" not in rows[0]["flags"] + rows[1]["flags"]
