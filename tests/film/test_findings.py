"""Warnings about solved frames: their text, their severity, and the frames they name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.kit.jobs import film
from vopd.film.findings import solve_findings
from vopd.job import Job
from vopd.listing.pages import listing_text
from vopd.program.vopd import run
from vopd.results import Results


def with_offset(job: Job, roll_deg: float) -> Job:
    """The job with another offset of the vehicle's roll (group 3)."""
    return replace(job, camera=replace(job.camera, offset_deg=np.array([0.0, 0.0, roll_deg])))


def out_of_range(results: Results) -> list[str]:
    """The warnings of angles out of range, as text."""
    found = solve_findings(results, "flight.dat", 2)
    return [str(one) for one in found if "beyond a full circle" in one.message]


def test_angles_that_are_printed_as_asterisks_are_warned_of() -> None:
    """60 degrees of camera roll and an offset of 5000 make 5060, and 4700 less one circle."""
    results = run(with_offset(film(3), 5000.0))
    assert results.converged.all()
    (found,) = solve_findings(results, "flight.dat", 2)
    assert found.severity == "warning" and found.group is None and found.job == 2
    assert str(found) == (
        "flight.dat: job 2: frames 1-3: an angle of camera or vehicle is beyond a full circle, "
        "although the solve converged; the listing may have asterisks"
    )
    assert "*********" in listing_text(run(with_offset(film(3), 5e7)))


def test_angles_within_a_circle_are_not_warned_of() -> None:
    """60 and 299 are 359; 60 and 599 are 659, less one circle 299; 60 and 660.1 leave 360.1."""
    for offset in (0.0, 299.0, 599.0):
        assert out_of_range(run(with_offset(film(2), offset))) == []
    assert len(out_of_range(run(with_offset(film(2), 660.1)))) == 1


def test_only_the_frames_that_are_out_of_range_are_named() -> None:
    results = run(film(4))
    roll = results.vehicle_deg.copy()
    roll[[0, 2], 2] = -361.0, 1e9
    assert out_of_range(replace(results, vehicle_deg=roll)) == [
        "flight.dat: job 2: frames 1, 3: an angle of camera or vehicle is beyond a full circle, "
        "although the solve converged; the listing may have asterisks"
    ]


def test_a_frame_that_did_not_converge_is_named_once() -> None:
    results = run(film(2))
    wild = replace(
        results,
        vehicle_deg=results.vehicle_deg + 1e6,
        correction_rad=results.correction_rad + 1.0,
    )
    (found,) = solve_findings(wild, "flight.dat", 2)
    assert "not converged" in found.message
