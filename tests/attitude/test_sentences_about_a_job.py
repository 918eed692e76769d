"""What is said of a whole job: how far its positions are off, and what misfits."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.estimates import ABOUT, WORDS
from vopd.attitude.conventions import farthest_from_own_text, report_own_position
from vopd.attitude.findings import HistorySummary, findings_of
from vopd.findings import Finding

NONE = float("nan")


def off(*east_north: tuple[float, float], source: str = "a.dat", job: int = 1) -> Any:
    """A job whose own coordinates put the vehicle so many metres east and north of the file's."""
    about = ABOUT._replace(
        source=source, job=job, words=replace(WORDS, own_position=f"where {source} has it")
    )
    to_own = np.array(east_north).reshape(-1, 2) if east_north != ((),) else None
    position = SimpleNamespace(to_own_m=to_own)
    return SimpleNamespace(about=about, estimate=SimpleNamespace(position=position))


@pytest.mark.parametrize(
    ("east_north", "said"),
    [
        ((0.0, 5.0), "5 m south"), ((0.0, -5.0), "5 m north"), ((5.0, 0.0), "5 m west"),
        ((-5.0, 0.0), "5 m east"), ((3.0, 40.0), "40 m south and 3 m west"),
        ((-3.0, -40.0), "40 m north and 3 m east"), ((0.49, 7.0), "7 m south"),
        ((0.51, 7.0), "7 m south and 1 m west"), ((7.0, 0.49), "7 m west"),
        ((7.0, -0.5), "7 m west"), ((0.0, 1.0), "1 m south"), ((0.0, 0.999), ""),
        ((0.6, 0.8), "1 m south and 1 m west"), ((0.6, 0.79), ""), ((NONE, 9.0), ""),
        ((0.0, 12345.6), "12346 m south"), ((0.0, np.inf), ""),
    ],
)  # fmt: skip
def test_how_far_the_farthest_position_is_off(east_north: tuple[float, float], said: str) -> None:
    """The file's position is on the other side; less than a metre, or half of one, is not said."""
    found = farthest_from_own_text([off(east_north)])
    assert bool(found) == bool(said)
    assert_approved(found, parts=[said] if said else [])
    near = off((0.3, 0.3), (NONE, NONE))
    for several in ([near, off(east_north)], [off((0.1, 0.1), east_north, (0.2, 0.0))]):
        found = farthest_from_own_text(several)
        assert bool(found) == bool(said)
        assert_approved(found, parts=[said] if said else [])
    found = farthest_from_own_text([off(()), off(east_north)])
    assert bool(found) == bool(said)
    assert_approved(found, parts=[said] if said else [])


def test_no_frame_and_no_own_coordinates() -> None:
    assert farthest_from_own_text([off(())]) == ""
    empty = off((0.0, 0.0))
    empty.estimate.position.to_own_m = np.zeros((0, 2))
    assert farthest_from_own_text([empty]) == ""


def test_a_warning_for_every_job_that_is_off() -> None:
    told: list[Finding] = []
    jobs = [off((0.0, 5.0)), off((0.0, 0.1), job=2), off((7.0, 0.0), source="b.dat", job=3)]
    report_own_position(jobs, told.append)
    assert_approved(told, parts=["5 m south", "a.dat", "7 m west", "b.dat"])


def misfits(*told: str) -> list[Finding]:
    labels = [(str(10 * k), text) for k, text in enumerate(told, 1)]
    return findings_of(ABOUT._replace(job=4), HistorySummary(misfits=labels))


@pytest.mark.parametrize(
    "told",
    [
        ["a (chance 0.50)"],
        [""],
        ["a (chance 0.50)", "b (chance 0.40)", "a (chance 0.07)"],
        ["c", "b", "a"],
        ["a", "b", "c", "d"],
        ["a", "b", "c", "d", "e", "d"],
        ["a", "b", "c", "d"] * 2,
        [],
    ],
)  # fmt: skip
def test_warnings_about_frames_that_misfit(told: list[str]) -> None:
    """Three repairs at most, those of the most frames first, in the order of the frames; each
    with the least of its chances.
    """
    assert_approved(misfits(*told))
