"""Tape 10: the records byte for byte, and which frames have one."""

from __future__ import annotations

import struct
from dataclasses import replace

import numpy as np

from tests.kit.jobs import case, film
from vopd.listing.tape10 import tape10
from vopd.program.vopd import run
from vopd.results import Outcome

RECORD = struct.Struct("<i7di")
"""What a FORTRAN program writes: the length, seven numbers, the length."""


def test_case_4_has_two_records_of_the_printed_numbers() -> None:
    """Frame 55 is ignored; the report prints frames 60 and 65."""
    records = list(RECORD.iter_unpack(tape10(run(case(4)))))
    assert [(first, last) for first, *_, last in records] == [(56, 56), (56, 56)]
    assert [[f"{number:.3f}" for number in record[1:-1]] for record in records] == [
        ["-0.697", "225.133", "-86.339", "181.954", "112.219", "-156.597", "111.912"],
        ["-0.612", "225.465", "-86.386", "181.407", "112.175", "-158.836", "111.930"],
    ]


def test_only_frames_that_reach_the_end_of_pass_22_are_on_it() -> None:
    """A frame whose residuals vanish earlier is not, one whose residuals vanish in pass 22 is."""
    results = run(film(5))
    outcome = np.array(
        [Outcome.SOLVED, Outcome.DROPPED, Outcome.EXACT, Outcome.EXACT_LATE, Outcome.STOPPED]
    )
    records = RECORD.iter_unpack(tape10(replace(results, outcome=outcome)))
    assert [record[1] for record in records] == results.time_s[[0, 3]].tolist()


def test_the_seven_numbers_of_a_record() -> None:
    """Time, vehicle yaw, pitch, roll, alpha, beta, eta; not the camera's angles."""
    results = run(film(2))
    numbers = np.arange(14.0).reshape(2, 7) / 3.0
    alpha, beta, eta = numbers[:, 4:].T
    changed = replace(
        results, time_s=numbers[:, 0], vehicle_deg=numbers[:, 1:4], alpha_deg=alpha,
        beta_deg=beta, eta_deg=eta, camera_deg=np.full((2, 3), 99.0),
    )  # fmt: skip
    assert tape10(changed) == b"".join(RECORD.pack(56, *row, 56) for row in numbers.tolist())
