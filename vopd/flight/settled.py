"""A flight solved with its reading sigma: the one that is stated, or that of its residuals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vopd.arrays import Bools
from vopd.attitude.long_history import sampled_reading_sigma
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.attitude.sigmas import Sigmas
from vopd.findings import VopdError
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight, HeldParameters
from vopd.flight.solve.errors import priors_of, with_places_solved_for
from vopd.flight.solve.free import as_solved, free_parameters, without_parameter
from vopd.flight.solve.held import least_held, undetermined
from vopd.flight.solve.joint import JointSolution, solve_jointly, widened
from vopd.flight.solve.rotations import SolvedFlight, solve
from vopd.flight.solve.sizes import lasting, residual_freedom, sigma_freedom, size_of_residuals


def settled_as_held(
    flight: Flight, left_out: Bools, tell: Callable[[], object], first: SolvedFlight | None = None
) -> tuple[Flight, FlightEstimates]:
    """Solve a flight for those of its free parameters that the picks hold.

    The one that is held least is kept as it is stated, and the flight solved again, until all that
    are left are held.

    Args:
        flight: the flight
        left_out: picks that take no part, (P,)
        tell: is called before each solve
        first: its rotations with everything as it is stated

    Returns:
        The flight with the parameters that are kept, and its solution.
    """
    if free_parameters(flight):
        first = first or solve(widened(flight, priors_of(flight)), left_out)
        while (lost := undetermined(flight, left_out, first)) is not None:
            flight = without_parameter(flight, lost)
    tell()
    estimates = settled(flight, left_out, first=first)
    while (worst := least_held(estimates.joint)) is not None:
        flight = without_parameter(flight, worst)
        tell()
        estimates = settled(flight, left_out)
    return flight, estimates


ROUNDS = 12  # of a solve with another reading sigma
SETTLED = 1e-3  # relative change of the reading sigma that is none
LEAST_FREEDOM = 0.1  # of a reading sigma of which the residuals say nothing
REJECTED = 1.5  # times the stated reading sigma, from where on that is not believed


def settled(
    flight: Flight, left_out: Bools, before: JointSolution | None = None,
    first: SolvedFlight | None = None,
) -> FlightEstimates:  # fmt: skip
    """Solve a flight, with its positions and landmarks as far as they are uncertain.

    They have the more weight the larger the reading sigma is. One that is not stated is estimated
    from the residuals, and the flight solved again until it no longer changes.

    Args:
        flight: the flight
        left_out: picks that take no part, (P,)
        before: the solution with fewer picks left out
        first: its rotations with everything as it is stated
    """
    held = flight.options.held
    if held is not None and flight.options.given.reading is None:
        return _settled_before(flight, left_out, held, before)
    reading = _reading_beside_held_places(flight, left_out)
    if reading is not None:
        scaled = replace(flight, picks=flight.picks.with_sigma(reading.sigma))
        joint = solve_jointly(scaled, priors_of(flight), ~left_out, first=first)
        return estimates_of(joint, flight).with_reading(reading)
    priors, robust = priors_of(flight), flight.options.loss != "least-squares"
    start = before.state if before is not None and before.passes else None
    same = first
    if before is not None and not before.passes:
        same = solve(flight, left_out, before=before.solved)
    begun = flight
    unknown = flight.options.given.reading is None and not flight.picks.stated
    if unknown and before is not None and before.passes:  # its sigma is nearer than any
        begun = replace(
            flight, picks=flight.picks.with_sigma(before.model.flight.picks.one_sigma_px)
        )
    joint = solve_jointly(begun, priors, ~left_out, start, first=same)
    estimates = estimates_of(joint, flight)
    reading = stated_reading(estimates)
    if reading is None:
        said: JobReadingSigma | None
        tried, settles = np.zeros(0), True
        for _ in range(ROUNDS):
            said = reading
            reading = residual_reading(estimates)
            sigma = joint.model.flight.picks.one_sigma_px
            weighs = joint.passes > 0 or robust
            if not weighs or abs(reading.sigma / sigma - 1.0) < SETTLED:
                break
            if not (settles or joint.settles):  # nor will it with a third sigma
                break
            back = (np.abs(reading.sigma / tried - 1.0) < SETTLED).any()
            if said is not None and back and reading.sigma < sigma:
                reading = said  # one makes the other, back and forth: the larger stays
                break
            tried = np.append(tried, sigma)
            start = joint.state if joint.passes else None
            same = joint.solved if joint.passes and not robust else None
            settles = joint.settles
            scaled = replace(flight, picks=flight.picks.with_sigma(reading.sigma))
            joint = solve_jointly(scaled, priors, ~left_out, start, first=same)
            estimates = estimates_of(joint, flight)
    assert reading is not None  # there is one round at least
    return estimates.with_reading(reading)


def _reading_beside_held_places(flight: Flight, left_out: Bools) -> JobReadingSigma | None:
    """Find the reading sigma of a flight with free parameters that holds uncertain places.

    Parameters follow errors of held places as if these were the picks' own, and so leave residuals
    in which no such errors are seen: it is that of the flight with its places solved for.

    Returns:
        None for any other flight, or where it has no such solution.
    """
    own = with_places_solved_for(flight) if free_parameters(flight) else None
    if own is None:
        return None
    try:
        found = settled(own, left_out)
    except VopdError:
        return None
    return found.reading if found.joint is not None and found.joint.settles else None


def _settled_before(
    flight: Flight, left_out: Bools, held: HeldParameters, before: JointSolution | None
) -> FlightEstimates:
    """Solve a flight with the reading sigma that `vopd adjust` found with what is held now.

    The residuals are less than those of other picks would be: what is held was fitted to them.
    """
    start = before.state if before is not None and before.passes else None
    scaled = replace(flight, picks=flight.picks.with_sigma(held.sigma_px))
    estimates = estimates_of(solve_jointly(scaled, priors_of(flight), ~left_out, start), flight)
    sigmas = Sigmas(reading=held.sigma_px)
    found = sampled_reading_sigma(estimates.layout, estimates.of, sigmas)
    reading = replace(found, sigma=held.reading_sigma_px, freedom=held.freedom, source=held.source)
    return estimates.with_reading(reading)


def estimates_of(joint: JointSolution, flight: Flight) -> FlightEstimates:
    """Estimate a flight, whose picks are not scaled, from its solution."""
    return FlightEstimates(replace(joint.solved, flight=as_solved(flight, joint)), joint)


def with_named_picks(
    flight: Flight, clean: FlightEstimates, earlier: FlightEstimates, dropped: Bools | None = None
) -> FlightEstimates:
    """Take blunders that are named and used back into their own frames' rotations.

    A pick that is a thousand pixels off would carry away the positions and landmarks of the whole
    flight: what its frames have in common is solved without it, and stays.

    Args:
        flight: the flight
        clean: solved without the blunders
        earlier: solved before that, without gross picks
        dropped: blunders that stay out, (P,); None: none
    """
    joint = clean.joint
    if dropped is None:
        dropped = np.zeros(len(flight.picks.frame), bool)
    assert joint is not None and clean.reading is not None
    if not joint.passes:
        every = flight.landmarks.takes_part[flight.picks.landmark] & ~dropped
        for known in (clean, earlier):
            if np.array_equal(known.solved.used, every):
                return known
        return settled(flight, dropped, joint)
    scaled, places, marks = joint.model.flight, flight.path, flight.landmarks
    path = replace(places, position_m=clean.solved.camera_m, lever_arm_m=None)
    if clean.solved.landmark_m is not None:
        marks = replace(marks, position_m=clean.solved.landmark_m)
    own = replace(as_solved(scaled, joint), path=path, landmarks=marks)
    found, first = solve(own, dropped, before=clean.solved), clean.solved.attitudes
    lost = np.isfinite(first.rotation[:, 0, 0]) & ~first.converged  # its place is no solution
    converged = found.attitudes.converged & ~lost
    found = replace(found, attitudes=found.attitudes._replace(converged=converged))
    changed = np.zeros(len(flight.frame), bool)
    changed[flight.picks.frame[found.used != clean.solved.used]] = True
    if not changed.any():
        return clean
    estimates = estimates_of(joint.with_rotations(found, scaled), flight)
    tested = sampled_reading_sigma(
        estimates.layout, estimates.of, Sigmas(reading=clean.reading.test_sigma)
    )
    chance = np.where(changed, tested.chance, clean.reading.chance)
    return estimates.with_reading(replace(clean.reading, chance=chance))


def stated_reading(estimates: FlightEstimates) -> JobReadingSigma | None:
    """Take the reading sigma that is given or stated; None where there is none, or it is rejected.

    It is rejected where the residuals of all frames together are larger than what is stated
    allows, which happens by chance once in a thousand flights, and those of the frames that agree
    with each other speak for more than `REJECTED` times as much.

    Args:
        estimates: of a flight solved with it
    """
    flight, joint = estimates.flight, estimates.joint
    assert joint is not None
    given, stated = flight.options.given.reading, flight.picks.one_sigma_px
    if given is None and not flight.picks.stated:
        return None
    sigmas = Sigmas(reading=stated if given is None else given)
    found = sampled_reading_sigma(estimates.layout, estimates.of, sigmas)
    if given is not None:
        return found
    _, chance = size_of_residuals(joint, np.ones(len(found.chance), bool))
    if chance < SIGNIFICANCE and residual_reading(estimates).sigma > REJECTED * stated:
        return None
    return replace(found, source="stated")


def residual_reading(estimates: FlightEstimates) -> JobReadingSigma:
    """Estimate the reading sigma from the residuals of all frames."""
    joint = estimates.joint
    assert joint is not None
    if joint.model.clicks is not None:
        return _with_clicks(joint, estimates)
    found = sampled_reading_sigma(estimates.layout, estimates.of, Sigmas())
    if found.source == "repeated":
        return found
    freedom = max(sigma_freedom(joint), LEAST_FREEDOM)
    return replace(found, freedom=min(found.freedom, freedom))


def _with_clicks(joint: JointSolution, estimates: FlightEstimates) -> JobReadingSigma:
    """Estimate the sigma of a match from the residuals, the errors of clicks being solved for.

    It is as much larger than they are as they last from frame to frame.
    """
    picks, (freedom, _) = joint.model.flight.picks, residual_freedom(joint)
    ratio = float((joint.normal.residual**2).sum()) / max(freedom, LEAST_FREEDOM)
    ratio *= lasting(joint)
    sigma = max(picks.one_sigma_px * float(np.sqrt(ratio)), picks.least_sigma_px)
    found = sampled_reading_sigma(estimates.layout, estimates.of, Sigmas(reading=sigma))
    known = max(sigma_freedom(joint), LEAST_FREEDOM)
    return replace(found, sigma=sigma, freedom=known, source="residuals")
