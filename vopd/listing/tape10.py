"""Tape 10: seven numbers a frame, as the unformatted records FORTRAN reads today."""

from __future__ import annotations

import numpy as np

from vopd.results import Results

_RECORD = np.dtype([("before", "<i4"), ("values", "<f8", 7), ("after", "<i4")])


def tape10(results: Results) -> bytes:
    """TI, PSI, THETA, PHI, ALPHA, BETA, ETA of every frame that got so far (A 312).

    Seconds and degrees; seven little-endian float64 between two 4-byte record
    marks, as `scipy.io.FortranFile` and gfortran read them.
    """
    on_tape = results.solved
    records = np.zeros(int(on_tape.sum()), _RECORD)
    records["before"] = records["after"] = 7 * 8
    columns = [results.time_s[:, None], results.vehicle_deg]
    columns += [a[:, None] for a in (results.alpha_deg, results.beta_deg, results.eta_deg)]
    records["values"] = np.concatenate(columns, axis=1)[on_tape]
    return records.tobytes()
