"""Decks whose three readings of a point are copies: the check and the commands say so once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.kit.command import vopd
from tests.kit.jobs import case, reread
from vopd.cards.write import write_deck
from vopd.copied_readings import copied_readings_text
from vopd.job import Job

SAID = "their spread says nothing about how well the points were read"


def copies(points: int) -> Job:
    """Case 1, four fiducials and three landmarks, the first of which are read once and copied."""
    job = case(1)
    fiducial, landmark = job.readings.fiducial_in.copy(), job.readings.landmark_in.copy()
    for k in range(points):
        point = fiducial[0, k] if k < 4 else landmark[0, k - 4]
        point[:] = point[0]
    readings = reread(job.readings, fiducial_in=fiducial, landmark_in=landmark)
    return replace(job, readings=readings)


@pytest.mark.parametrize(("points", "told"), [(0, 0), (3, 0), (4, 4), (7, 7)])
def test_more_than_half_of_the_points(points: int, told: int) -> None:
    text = copied_readings_text(copies(points).readings)
    expected = f"all three readings are the same in {told} of 7 points: {SAID}"
    assert text == (expected if told else "")


def test_a_point_that_agrees_in_x_alone_is_no_copy() -> None:
    job = copies(7)
    landmark = job.readings.landmark_in.copy()
    landmark[0, :, 1, 1] += 0.001
    readings = reread(job.readings, landmark_in=landmark)
    assert "in 4 of 7 points" in copied_readings_text(readings)


def test_points_that_are_not_on_the_film_do_not_count() -> None:
    """A frame with fewer landmarks than another has zeros in their place."""
    job = case(1)
    wider = reread(
        job.readings,
        landmark=np.pad(job.readings.landmark, ((0, 0), (0, 30))),
        present=np.pad(job.readings.present, ((0, 0), (0, 30))),
        landmark_in=np.pad(job.readings.landmark_in, ((0, 0), (0, 30), (0, 0), (0, 0))),
    )
    assert copied_readings_text(wider) == ""


@pytest.mark.parametrize("command", ["check", "attitude", "report", "plot"])
def test_the_commands_say_so_once(
    command: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    if command == "report":
        request.getfixturevalue("no_figures")
    deck = tmp_path / "copies.dat"
    deck.write_text(write_deck([copies(7)]))
    suffix = {"check": ".txt", "attitude": ".csv", "report": ".html", "plot": ".png"}[command]
    figure = ("--figure", "image") if command == "plot" else ()
    out = tmp_path / f"out{suffix}"
    done = vopd(command, deck, "-o", out, *figure)
    assert done.status == 0
    text = out.read_text() if command == "check" else done.stderr
    assert text.count(SAID) == 1 and "basic data" in text


def test_a_clean_deck_has_no_such_warning(tmp_path: Path) -> None:
    deck = tmp_path / "case1.dat"
    deck.write_text(write_deck([case(1)]))
    assert SAID not in vopd("check", deck).stdout + vopd("attitude", deck).stderr
