"""Positions that the picks do not improve, and other positions that fit as well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.flight.equations import LEAST_SIGMA_M, Priors, with_parameters
from vopd.flight.flight import TrackFixes
from vopd.flight.joint import Covariance, JointSolution, solve_jointly
from vopd.flight.solve import FlightBlocks
from vopd.geometry.earth import axes_at, geodetic


def position_ratio(found: Covariance) -> Floats:
    """Compare positions after and before the solve, (F,).

    The largest ratio of their standard deviations in any direction, 1 where the picks say
    nothing of the position; 0 where it is exact, NaN without an attitude. Coordinates that are
    exact among others do not count.

    Args:
        found: covariances of the flight
    """
    prior, after = found.place_prior_m2, found.place_m2
    own = np.einsum("fii->fi", prior) > LEAST_SIGMA_M**2
    both = own[:, :, None] & own[:, None]
    known: Bools = np.asarray(np.isfinite(after).all(axis=(1, 2)))
    root = np.linalg.inv(np.linalg.cholesky(np.where(both, prior, np.eye(3))))
    counted = np.where(both & known[:, None, None], after, 0.0)
    largest = np.linalg.eigvalsh(root @ counted @ root.swapaxes(1, 2))[:, -1]
    return np.where(known, np.sqrt(np.maximum(largest, 0.0)), np.nan)


FEW = 3  # landmarks in a frame: with more no second solution was found in 400 frames
FAR = 0.05  # standard deviation of a position over the distance of the landmarks: below, none
STARTS = 2.0 * np.concatenate([np.eye(3), -np.eye(3)])
"""Prior standard deviations east, north, up from where another solution is looked for."""

AS_WELL = 6.0  # by which the cost of picks and priors may be larger: 20 to 1
APART = 3.0  # standard deviations between positions of different solutions


def other_solutions_deg(solution: JointSolution) -> Floats:
    """Look for other positions within the priors whose picks fit as well, frame by frame.

    Frames of three landmarks are solved each by itself, from `STARTS`, if a position of their own
    is uncertain by more than `FAR` of the landmarks' distance; landmarks stay as solved.

    Args:
        solution: of the flight

    Returns:
        The angle between the attitudes of the first and the other solution, (F,) degrees; NaN
        where none is found.
    """
    turned = np.full(solution.model.frames, np.nan)
    frames = np.flatnonzero(_doubtful(solution))
    if not len(frames):
        return turned
    model, flight = solution.model, solution.model.flight
    moved_m = model.landmark_by_m(solution.state)
    marks = replace(flight.landmarks, position_m=flight.landmarks.position_m + moved_m)
    lens = with_parameters(flight.lens, model.names, solution.state.parameter)
    part = FlightBlocks(replace(flight, landmarks=marks, lens=lens)).part(frames)
    used = np.isin(part.picks, model.pick)
    covariance_m2 = solution.covariance.place_m2[frames]
    sigma = np.sqrt(np.einsum("fii->fi", solution.covariance.place_prior_m2))[frames]
    own = Priors(TrackFixes(np.arange(len(frames)), np.ones((len(frames), 1)), sigma))
    path = part.flight.path
    axes = axes_at(geodetic(path.position_m))
    best = solve_jointly(part.flight, own, used)
    least = np.full(len(frames), AS_WELL)
    for start in STARTS:
        moved = path.position_m + np.einsum("fji,fj->fi", axes, start * sigma)
        there = replace(part.flight, path=replace(path, position_m=moved))
        first = solve_jointly(there, Priors(), used).state
        begin = best.state._replace(rotation=first.rotation, fix_m=start * sigma)
        one = solve_jointly(part.flight, own, used, start=begin)
        gap = (one.state.fix_m - best.state.fix_m)[..., None]
        apart = (gap * np.linalg.solve(covariance_m2, gap)).sum(axis=(1, 2)) > APART**2
        more = one.normal.frame_cost - best.normal.frame_cost
        good = one.solved.attitudes.converged & apart & (more < least)
        between = one.state.rotation @ best.state.rotation.swapaxes(1, 2)
        cosine = (np.einsum("fii->f", between) - 1.0) / 2.0
        angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        turned[frames[good]] = angle[good]
        least = np.where(good, more, least)
    return turned


def _doubtful(solution: JointSolution) -> Bools:
    """Mark the frames that may have another solution, (F,)."""
    model, fixes = solution.model, solution.model.priors.fixes
    path, picks = model.flight.path, model.flight.picks
    known = np.isfinite(solution.solved.attitudes.rotation[:, 0, 0])
    alone = model.frames == 1
    if fixes is not None:
        alone = fixes.weight.shape[1] == 1 and len(np.unique(fixes.first)) == model.frames
    if not alone:
        return np.zeros(model.frames, bool)
    frame, landmark = picks.frame[model.pick], picks.landmark[model.pick]
    away_m = model.flight.landmarks.position_m[landmark] - path.position_m[frame]
    count = np.bincount(frame, minlength=model.frames)
    total_m = np.bincount(frame, np.linalg.norm(away_m, axis=1), model.frames)
    sigma_m = np.sqrt(np.einsum("fii->fi", solution.covariance.place_prior_m2).max(axis=1))
    return np.asarray(known & (count == FEW) & (sigma_m * count > FAR * total_m))
