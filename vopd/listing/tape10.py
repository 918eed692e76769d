"""Tape 10: seven numbers for each frame, as unformatted FORTRAN records."""

from __future__ import annotations

import numpy as np

from vopd.results import Results

_RECORD = np.dtype([("before", "<i4"), ("values", "<f8", 7), ("after", "<i4")])


def tape10(results: Results) -> bytes:
    """Write tape 10: a record for each frame that the run solved.

    A record holds TI, PSI, THETA, PHI, ALPHA, BETA, ETA, in seconds and degrees, as
    seven little-endian float64 between two 4-byte record marks. `scipy.io.FortranFile`
    and gfortran read it.

    Source: TM X-3050, A 312.
    """
    on_tape = results.solved
    records = np.zeros(int(on_tape.sum()), _RECORD)
    records["before"] = records["after"] = 7 * 8
    columns = [results.time_s[:, None], results.vehicle_deg]
    columns += [a[:, None] for a in (results.alpha_deg, results.beta_deg, results.eta_deg)]
    records["values"] = np.concatenate(columns, axis=1)[on_tape]
    return records.tobytes()
