"""How much the known errata of the 1974 program change the angles of each frame of a run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.errata import Fix, Fixes
from vopd.findings import VopdError
from vopd.program.vopd import run_jobs
from vopd.results import Results


@np.errstate(all="ignore")
def slip_effects_deg(
    results: Sequence[Results], determined: Sequence[Bools]
) -> list[Floats | None]:
    """The nine angles with all errata corrected minus those of a run, (F, 9) degrees for each job.

    They are camera yaw, pitch, roll, vehicle yaw, pitch, roll, alpha, beta, eta. Each frame
    is solved once more, starting from its solution. With the fix `earth` the vertical
    is that of an ellipsoid, without it that of a sphere. Both solves are relative to the
    vertical of their own Earth, and that is what is compared: the landmarks, group 7's
    axes and the vertical turn together from one Earth to the other, so that the angle
    between the two verticals is not a part of the difference.

    Args:
        results: jobs as they were solved, all with the same fixes; they are solved together
        determined: of each job the frames whose attitude the landmarks determine, (F,)

    Returns:
        The differences, -180 to 180; NaN for frames that are not determined or do not
        converge with the fixes. None where the run has all fixes.
    """
    if not results or results[0].fixes.chosen == frozenset(Fix):
        return [None] * len(results)
    starts = [_start_deg(one, known) for one, known in zip(results, determined, strict=True)]
    fixes = Fixes(frozenset(Fix), results[0].fixes.ellipsoid)
    corrected = run_jobs([one.job for one in results], fixes, starts)
    solved = [_without_error(one) for one in corrected]
    counts = [min(len(a.frame), len(b.frame)) for a, b in zip(results, solved, strict=True)]
    run, fixed = _first_frames(results, counts), _first_frames(solved, counts)
    known = np.concatenate([one[:n] for one, n in zip(determined, counts, strict=True)])
    known &= fixed.solved & fixed.converged
    change = (_angles_deg(fixed) - _angles_deg(run) + 180.0) % 360.0 - 180.0
    effects = np.split(np.where(known[:, None], change, np.nan), np.cumsum(counts)[:-1])
    return [_for_all_frames(*both) for both in zip(effects, results, strict=True)]


def _start_deg(results: Results, determined: Bools) -> Floats:
    frames = len(results.frame)
    start = np.full((len(results.job.readings.frame), 3), results.job.camera.initial_deg)
    start[:frames] = np.where(determined[:, None], results.camera_deg, start[:frames])
    return start


def _without_error(fixed: Results | VopdError) -> Results:
    if isinstance(fixed, VopdError):
        raise fixed
    return fixed


def _first_frames(jobs: Sequence[Results], counts: Sequence[int]) -> Results:
    """The first frames of each job, one job after the other; a run may have ended early."""
    each = zip(jobs, counts, strict=True)
    return Results.joined([one if len(one.frame) == n else one.only(slice(n)) for one, n in each])


def _for_all_frames(effect: Floats, results: Results) -> Floats:
    """The effect for all frames of a job, NaN where the run with all fixes did not come to."""
    missing = len(results.frame) - len(effect)
    return np.concatenate([effect, np.full((missing, 9), np.nan)]) if missing else effect


def _angles_deg(results: Results) -> Floats:
    """The nine angles of every frame, (F, 9) degrees."""
    attack = results.alpha_deg, results.beta_deg, results.eta_deg
    return np.column_stack([results.camera_deg, results.vehicle_deg, *attack])
