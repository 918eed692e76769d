"""A solved flight, from its project file to arrays, findings and tables."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.long_history import sampled_reading_sigma
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.attitude.sigmas import AS_SIGMAS, Sigmas
from vopd.estimate import Estimate
from vopd.findings import Finding, VopdError, count_text, first_of, refuse_other_kind
from vopd.flight.estimate import (
    FlightEstimates,
    attack_angles,
    camera_angles,
    vehicle_angles,
)
from vopd.flight.flight import Flight, HeldParameters, frame_label, pick_label
from vopd.flight.misfits.blunders import (
    NO_EXCHANGE,
    Blunders,
    Exchanges,
    blunder_findings,
    exchange_findings,
    find_blunders,
    gross_picks,
    suspected_frames,
)
from vopd.flight.misfits.misfit import OF_LANDMARK, SPEAK_FOR, flight_findings
from vopd.flight.project.keys import Project, read_project
from vopd.flight.project.read import NO_LANDMARK, flight_of, read_flight
from vopd.flight.project.track import LEAPS
from vopd.flight.solve.errors import SOLVED_WITH, priors_of, with_sigmas
from vopd.flight.solve.free import (
    MOUNT,
    as_solved,
    free_parameters,
    not_held_findings,
    without_parameter,
)
from vopd.flight.solve.held import least_held, solved_findings, undetermined
from vopd.flight.solve.joint import JointSolution, ranges_m, solve_jointly, widened
from vopd.flight.solve.readout import ROUNDS as ROUNDS_OF_ROWS
from vopd.flight.solve.readout import SETTLED as ROWS_SETTLED
from vopd.flight.solve.readout import picks_at_frame_times, readout_findings
from vopd.flight.solve.rotations import SolvedFlight, solve
from vopd.flight.solve.sizes import (
    lasting,
    residual_freedom,
    sigma_freedom,
    size_of_residuals,
)
from vopd.geometry.lenses import UNSEEN_MEANING, Unseen
from vopd.shown import Shown

if TYPE_CHECKING:
    import pandas as pd

    from vopd.attitude.history import History, HistoryOptions
    from vopd.attitude.long_history import HistoryParts


# A solved flight


@dataclass(frozen=True, eq=False, repr=False)
class FlightResult(Shown):
    """A solved flight: what was read, the angles of every frame, and what is doubtful.

    `print` shows it in short, a notebook too.

    Args:
        estimates: the result of the solve, from which `estimate` is made
        findings: the warnings about files and solution
        misfits: whether the residuals are larger than all that is stated explains, or speak for
            a stabilised video, or the picks of a frame do not fit its position
    """

    estimates: FlightEstimates
    findings: tuple[Finding, ...]
    misfits: bool = False

    @property
    def mistaken(self) -> bool:
        """Whether residuals or a leap of the track speak for an error that `findings` name."""
        return any(
            one.message.startswith(SPEAK_FOR) or one.message.endswith(LEAPS)
            for one in self.findings
        )

    @property
    def flight(self) -> Flight:
        """The flight as read from the project's files; freed parameters have the values solved."""
        return self.estimates.flight

    @property
    def read(self) -> Flight:
        """The flight with all parameters as they are stated."""
        joint = self.estimates.joint
        if joint is None or not (joint.model.flight.options.free or joint.model.clicks):
            return self.flight
        stated = joint.model.flight
        picks = stated.picks.with_sigma(self.flight.picks.one_sigma_px)
        return replace(stated, picks=picks)

    @cached_property
    def estimate(self) -> Estimate:
        """The estimate of all frames, with residuals and partials; made when it is asked for."""
        return self.estimates.whole()

    @property
    def frame(self) -> Ints:
        """Frame numbers (F,), from 0 where images have names; `image_name` has those."""
        return self.flight.frame

    @property
    def image_name(self) -> tuple[str, ...]:
        """File names of the images (F,); empty where frames have numbers."""
        return self.flight.image_name

    @property
    def time_s(self) -> Floats:
        """Time of every frame (F,), seconds after the project's epoch; NaN where not known."""
        return self.flight.time_s

    @property
    def solved(self) -> Bools:
        """Frames that have an attitude (F,)."""
        return np.asarray(np.isfinite(self.estimates.solved.attitudes.rotation[:, 0, 0]))

    @cached_property
    def camera_deg(self) -> Floats:
        """Camera yaw, pitch, roll (F, 3), degrees; NaN in frames without an attitude."""
        return camera_angles(self.estimates.solved)

    @cached_property
    def vehicle_deg(self) -> Floats:
        """Vehicle yaw, pitch, roll (F, 3), degrees; those of the camera without a `[vehicle]`."""
        return vehicle_angles(self.estimates.solved)

    @cached_property
    def attack_deg(self) -> Floats:
        """Alpha, beta, eta (F, 3), degrees; NaN where the velocity is not known."""
        return attack_angles(self.estimates.solved).angle_deg

    @property
    def about(self) -> tuple[str, ...]:
        """What was read, a sentence for each file."""
        return self.flight.about

    def history(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> History:
        """The attitude history of the flight, with uncertainty and flags.

        Args:
            sigmas: standard deviations in the place of those that the project states
            max_rate_deg_s: frames that turn faster against a neighbour are flagged
            vertical: "geodetic" or "geocentric" axes for angles and quaternion; None is
                geodetic

        Raises:
            VopdError: where there is no such vertical
        """
        from vopd.attitude.history import HistoryOptions

        options = HistoryOptions(sigmas or Sigmas(), max_rate_deg_s, vertical)
        return self.history_parts(options).whole

    def history_parts(self, options: HistoryOptions) -> HistoryParts:
        """Iterate over the history in parts of about 10,000 frames.

        Args:
            options: sigmas, maximum rate and vertical

        Raises:
            VopdError: as `history` does
        """
        from vopd.attitude.long_history import history_of_long_job

        flight = with_sigmas(self.read, options.sigmas)
        if flight.options.given != self.flight.options.given:
            return solve_flight_read(flight).history_parts(options)
        rest = replace(options.sigmas, **dict.fromkeys(SOLVED_WITH, 0.0), reading=None)
        made, own = self.estimates, replace(options, sigmas=rest)
        return history_of_long_job(made.layout, made.of, own, made.reading, made.sum_errors)

    def _shown(self) -> tuple[list[HistoryParts], Sequence[Finding]]:
        from vopd.attitude.history import HistoryOptions

        return [self.history_parts(HistoryOptions())], self.findings

    def to_dataframe(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> pd.DataFrame:
        """Tabulate the attitude as a pandas DataFrame, one row for each frame.

        The columns are those of `vopd attitude`, with units in their names; the
        conventions are in `attrs`.

        Args:
            sigmas: as `history` takes it
            max_rate_deg_s: as `history` takes it
            vertical: as `history` takes it

        Raises:
            VopdError: where pandas is not installed
        """
        from vopd.export.tables import dataframe

        return dataframe([self.history(sigmas, max_rate_deg_s, vertical)])

    @property
    def next_clicks(self) -> list[str]:
        """Where to click next in a flight that is tracked from clicks: one line.

        None in an adjusted project, which takes no other clicks: its source is to be asked.
        """
        joint = self.estimates.joint
        if joint is None or joint.model.clicks is None or self.flight.options.held is not None:
            return []
        from vopd.flight.solve.next_click import next_click_texts  # of few flights

        return [f"{self.flight.source}: {text}" for text in next_click_texts(joint)]

    def __repr__(self) -> str:
        return f"FlightResult({self.flight.source}, {count_text(len(self.frame), 'frame')})"


def unused_options(result: FlightResult, options: HistoryOptions) -> list[Finding]:
    """Warn of options of a history that change nothing in it.

    Args:
        result: of a flight
        options: as `history_parts` takes them
    """
    sigmas, velocity, found = options.sigmas, result.flight.path.velocity_m_s, list[str]()
    untimed = np.isfinite(result.time_s).sum() < 2
    stands = velocity is None or not np.nan_to_num(velocity).any()
    no_times = "fewer than two frames have times, of [picks] frame_rate_hz or times"
    still = no_times if untimed else "the camera stands, or its velocity is not known"
    if options.max_rate_deg_s is not None and untimed:
        found.append(f"maximum rate: is not used: {no_times}")
    if sigmas.time_s > 0.0 and stands:
        found.append(f"time sigma: is not used: {still}")
    attack = [name for name in ("velocity", "wind") if getattr(sigmas, name) > 0.0]
    if attack and not np.isfinite(result.attack_deg).any():
        found += [f"{name} sigma: is not used: {still}" for name in attack]
    return [Finding(one, result.flight.source, severity="warning") for one in found]


# From a project file to a solved flight, with its findings


def solve_flight(
    source: str | PathLike[str] | Project | Flight,
    location: str | None = None,
    sigmas: Sigmas | None = None,
) -> FlightResult:
    """Find the attitude of every frame of a flight project.

    Nothing is printed: what is doubtful is in the `findings` of the result.

    Args:
        source: the path of the project file, `flight.toml`, or of its folder; or what
            `read_project` or `read_flight` has read
        location: where the file is, if not under its name
        sigmas: standard deviations in the place of those that the project states

    Returns:
        The angles of all frames, what was read, and the findings; `to_dataframe()` has the
        table with uncertainty and flags.

    Raises:
        VopdError: where a file cannot be read, no frame has two landmarks, or it is a deck
    """
    sigmas = Sigmas() if sigmas is None else sigmas
    refuse_other_kind(sigmas, Sigmas, "vopd.solve_flight", AS_SIGMAS)
    if isinstance(source, Flight):
        return solve_flight_read(with_sigmas(source, sigmas))
    if isinstance(source, Project):
        return solve_flight_read(with_sigmas(flight_of(source), sigmas), project=lambda: source)
    if not isinstance(source, str | PathLike):
        raise VopdError(
            f"a {type(source).__name__} is no flight project: vopd.run solves the jobs of a deck"
        )
    name = str(source)
    refuse_other_kind(location or "", (str, PathLike), "vopd.solve_flight", "a path as location")
    path = Path(location or name)
    if os.path.isdir(path):  # noqa: PTH112 (a path that is too long for the system is none)
        name, location = str(Path(name) / NAME), str(path / NAME)
    elif path.suffix.lower() != ".toml" and os.path.isfile(path):  # noqa: PTH113
        raise VopdError(
            f"{name}: a flight project is a .toml that names its files; vopd.run({name!r}) solves "
            "a deck of 80-column cards"
        )
    return solve_flight_read(
        with_sigmas(read_flight(name, location), sigmas),
        project=lambda: read_project(name, location),
    )


NAME = "flight.toml"  # the project in a folder


@np.errstate(all="ignore")
def solve_flight_read(
    flight: Flight, tell: Callable[[], object] = lambda: None,
    project: Callable[[], Project] | None = None,
) -> FlightResult:  # fmt: skip
    """Find the attitude of every frame of a flight whose project has been read.

    Args:
        flight: what the project holds
        tell: is called before each solve of all frames
        project: gives the project, for mistakes that take another reading of its files, if the
            flight misfits; None: these are not tried

    Raises:
        VopdError: where no frame has two landmarks
    """
    require_two_landmarks(flight)
    stated, outside, of_clicks = flight, picks_outside(flight), list[Finding]()
    if flight.picks.clicks is not None:
        from vopd.flight.misfits.click_tests import without_wrong_clicks  # of few flights

        flight, of_clicks = without_wrong_clicks(flight)
    by_themselves = replace(flight, picks=flight.picks.with_clicks_as_own)
    first = solve(by_themselves)
    suspected = suspected_frames(first)
    gross, lost = gross_picks(first, suspected)
    swaps = _gross_exchanges(first, suspected, gross)
    swapped = swaps.marked(len(gross))
    lost[flight.picks.frame[swapped]] = False
    if lost.any() and 2 * lost.sum() < len(lost):  # of most it is a mistake of the flight
        rest = solve_flight_read(without_places(stated, lost), tell, project)
        return replace(rest, misfits=True)
    read, out = flight, gross | swapped
    robust = flight.options.loss != "least-squares"  # looks at places' standard deviations, too
    same = None if robust else solve(by_themselves, out, before=first)
    flight, estimates = settled_as_held(read, out, tell, same)
    if read.shutter is not None and read.path.turning_rad_s is None:
        for round_ in range(ROUNDS_OF_ROWS):
            read = replace(read, options=flight.options)
            shifted = picks_at_frame_times(read, estimates.solved)
            moved = np.abs(shifted.picks.pixel - flight.picks.pixel).max(axis=1)
            if round_ > 1 and (moved < ROWS_SETTLED * flight.picks.sigma_px).all():
                break
            flight, estimates = settled_as_held(shifted, out, tell)
    read = replace(read, options=flight.options)

    def solve_without(left_out: Bools, before: FlightEstimates) -> FlightEstimates:
        tell()
        return settled(flight, left_out, before.joint)

    for _ in range(ROUNDS_OF_LABELS):
        found, without = find_blunders(estimates, gross, solve_without, swapped)
        try:
            without = without or settled(flight, found.left_out | swapped, estimates.joint)
        except VopdError:  # too little is left that could tell
            break
        if without.joint is not None and not without.joint.settles:
            break
        swaps = _exchanges(without, found, swapped)
        before, swapped = swapped, swaps.marked(len(gross))
        if np.array_equal(swapped, before):
            break
        estimates = settled(flight, gross | swapped)
    else:
        without = None
    apart = found.left_out | swapped
    if flight.options.drop_blunders:
        apart &= found.left_out | _two_left(flight, apart)
    else:
        few = (found.pick | swapped).sum() <= FEW * len(found.pick)
        apart = (found.pick | swapped) & few
    if without is None or not np.array_equal(apart, found.left_out | swapped):
        without = settled(flight, apart, estimates.joint)
    dropped = flight.options.drop_blunders
    estimates = without if dropped else with_named_picks(flight, without, estimates)
    more = least_held(without.joint)
    if more is not None:
        stated = replace(stated, options=read.options)
        return solve_flight_read(without_parameter(stated, more), tell, project)
    if MOUNT in read.options.free and read.vehicle is not None:
        from vopd.flight.mounting import mounted  # of few flights

        estimates = mounted(estimates)
    solved = estimates.solved
    estimates.mark_outliers((found.pick | swapped) & solved.used, swaps.chances(len(swapped)))

    def usual(named: bool) -> list[str]:
        from vopd.flight.mistakes import usual_mistakes  # which takes results

        return (
            [] if project is None else usual_mistakes(project(), FlightResult(without, ()), named)
        )

    blunders = found.pick | swapped
    doubts = flight_findings(flight, without, apart, found.landmark, usual, blunders)
    estimates.contradict(doubts.sentence)
    if doubts.misfits:  # of a flight as a whole it is not said which frames are not searched
        swaps = swaps._replace(not_searched=0)
        from vopd.flight.check import far_landmarks  # which takes results

        far = [Finding(one, flight.source, severity="warning") for one in far_landmarks(flight)]
        doubts = doubts._replace(findings=[*far, *doubts.findings])
    findings = [*doubts.findings, *not_held_findings(flight), *solved_findings(without.joint)]
    if flight.vehicle is not None:
        from vopd.flight.mounting import mount_findings  # of few flights

        findings += mount_findings(estimates.flight)
    findings += exchange_findings(swaps, flight, apart)
    findings += blunder_findings(found, flight, doubts.misfits, doubts.explained)
    if flight.picks.followed is not None and without.joint is not None:
        from vopd.flight.project.tracked_picks import followed_findings  # of few flights

        findings += followed_findings(flight, without.joint)
    every = found._replace(pick=found.pick | swapped)
    findings += freed_beside_blunders(flight, every, apart)
    findings += readout_findings(flight)
    findings += [*picks_set_aside(flight, solved), *frames_unsolved(flight, solved)]
    told = (*flight.findings, *outside, *of_clicks, *findings)
    return FlightResult(estimates, told, doubts.misfits)


def without_places(flight: Flight, lost: Bools) -> Flight:
    """Take the places of frames whose camera is far from all landmarks, (F,), and say so.

    Such a frame has no attitude; one that were solved for would carry away the whole flight.
    """
    position_m = np.where(lost[:, None], np.nan, flight.path.position_m)
    labels = [frame_label(flight, int(k)) for k in np.flatnonzero(lost)]
    away_km = float(np.nanmax(ranges_m(flight)[lost[flight.picks.frame]])) / 1000.0
    told = (
        f"{first_of(labels, 5)}: the camera is {away_km:,.4g} km from the landmarks there, and "
        "hardly one fits: no attitude; look at the position, and at the times of frames and track"
    )
    found = Finding(told, flight.source, severity="warning")
    path = replace(flight.path, position_m=position_m)
    return replace(flight, path=path, findings=(*flight.findings, found))


ROUNDS_OF_LABELS = 3  # of solving without exchanged labels, and testing all frames again


def _gross_exchanges(first: SolvedFlight, suspected: Bools, gross: Bools) -> Exchanges:
    """Find exchanged labels in frames with residuals far larger than most have."""
    if not suspected.any():
        return NO_EXCHANGE
    from vopd.flight.misfits.exchanged import gross_exchanges

    return gross_exchanges(first, suspected, gross)


def _exchanges(estimates: FlightEstimates, found: Blunders, swapped: Bools) -> Exchanges:
    """Find exchanged labels in frames with picks that do not fit, that misfit, or are unsolved."""
    solved, reading = estimates.solved, estimates.reading
    assert reading is not None
    frames = np.asarray(reading.chance < SIGNIFICANCE)
    odd = found.pick | found.unclear | swapped | (solved.attitudes.set_aside > 0)
    frames[solved.flight.picks.frame[odd]] = True
    if not frames.any():
        return NO_EXCHANGE
    from vopd.flight.misfits.exchanged import exchanges

    return exchanges(estimates, frames, found.pick)


def _two_left(flight: Flight, out: Bools) -> Bools:
    """Mark the picks of frames that have two others, or more, without some picks, (P,)."""
    used = flight.landmarks.takes_part
    left = used[flight.picks.landmark] & ~out
    count = np.bincount(flight.picks.frame[left], minlength=len(flight.frame))
    return np.asarray((count > 1)[flight.picks.frame])


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


FEW = 0.1  # of the picks: more that do not fit their frames are a mistake of the flight
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
    flight: Flight, clean: FlightEstimates, earlier: FlightEstimates
) -> FlightEstimates:
    """Take blunders that are named and used back into their own frames' rotations.

    A pick that is a thousand pixels off would carry away the positions and landmarks of the whole
    flight: what its frames have in common is solved without it, and stays.

    Args:
        flight: the flight
        clean: solved without the blunders
        earlier: solved before that, without gross picks
    """
    joint = clean.joint
    assert joint is not None and clean.reading is not None
    if not joint.passes:
        every = flight.landmarks.takes_part[flight.picks.landmark]
        for known in (clean, earlier):
            if np.array_equal(known.solved.used, every):
                return known
        return settled(flight, np.zeros(len(every), bool), joint)
    scaled, places, marks = joint.model.flight, flight.path, flight.landmarks
    path = replace(places, position_m=clean.solved.camera_m, lever_arm_m=None)
    if clean.solved.landmark_m is not None:
        marks = replace(marks, position_m=clean.solved.landmark_m)
    own = replace(as_solved(scaled, joint), path=path, landmarks=marks)
    found, first = solve(own, before=clean.solved), clean.solved.attitudes
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


def require_two_landmarks(flight: Flight) -> None:
    """Refuse a flight in which no frame has two landmarks."""
    used = flight.landmarks.takes_part
    takes_part = used[flight.picks.landmark]
    count = np.bincount(flight.picks.frame[takes_part], minlength=len(flight.frame))
    if count.max(initial=0) < 2:
        unknown = [f.message for f in flight.findings if f.message.startswith(NO_LANDMARK)]
        if unknown:
            more = f"; {len(unknown) - 3} more like these" if len(unknown) > 3 else ""
            raise VopdError(
                f"{flight.source}: no frame has two landmarks that the project knows: "
                f"{'; '.join(unknown[:3])}{more}"
            )
        raise VopdError(
            f"{flight.source}: no frame has two landmarks (frames: {len(count)}, one at most in "
            "each). One landmark gives the direction of its line of sight alone: the turn about "
            "it stays free, so that of three angles two are tied together and none is known by "
            "itself. Pick a second landmark in each image, the farther from the first the better."
        )


def freed_beside_blunders(flight: Flight, found: Blunders, apart: Bools) -> list[Finding]:
    """Say how picks that are named took part in free parameters.

    Args:
        flight: as it was solved
        found: its blunders
        apart: picks that took no part in what the frames have in common, (P,)
    """
    named, free = int(found.pick.sum()), flight.options.free
    if not free or not named or flight.options.drop_blunders:
        return []
    names, does = ", ".join(free), count_text(named, "pick that does", "picks that do")
    told = f"free {names}: solved for without {does} not fit"
    if not apart.any():
        told = (
            f"free {names}: {named} of {len(found.pick)} picks do not fit, too many to be left "
            "out by themselves, and what was solved for is doubtful: vopd adjust --test names what "
            "is wrong"
        )
    return [Finding(told, flight.source, severity="warning")]


def picks_outside(flight: Flight) -> list[Finding]:
    """Count the picks that lie outside their images, and name the first."""
    picks = flight.picks
    width, height = flight.lens.of(picks.frame).by_rows("size_px").T
    u, v = picks.pixel.T
    outside = (u < -0.5) | (u > width - 0.5) | (v < -0.5) | (v > height - 0.5)
    if not outside.any():
        return []
    first = int(np.flatnonzero(outside)[0])
    wide, high = (int(np.broadcast_to(one, u.shape)[first]) for one in (width, height))
    hint = '; does v point up? then give [picks] v = "up"' if (v < 0).mean() > 0.5 else ""
    text = (
        f"{count_text(int(outside.sum()), 'pick')} outside the image of {wide} x {high}, the first "
        f"{flight.landmarks.name[picks.landmark[first]]} in "
        f"{frame_label(flight, int(picks.frame[first]))} at {u[first]:g}, {v[first]:g}{hint}"
    )
    return [Finding(text, flight.source, severity="warning")]


def picks_set_aside(flight: Flight, solved: SolvedFlight) -> list[Finding]:
    """Name picks whose landmark has no image; a landmark that has none in all its frames once."""
    aside, landmark, texts = solved.attitudes.set_aside, flight.picks.landmark, []
    if not aside.any():
        return []
    known, first, own, count = np.unique(
        landmark, return_index=True, return_inverse=True, return_counts=True
    )
    alike = np.bincount(own[aside == aside[first][own]], minlength=len(known)) == count
    for k in np.flatnonzero(aside).tolist():
        why, one = UNSEEN_MEANING[Unseen(int(aside[k]))], own[k]
        if count[one] == 1 or not alike[one]:
            texts.append(
                f"{pick_label(flight, k)} {why} as the others have it; its pick is not used"
            )
        elif k == first[one]:
            name = flight.landmarks.name[landmark[k]]
            texts.append(
                f"{name} {why} in all {count[one]} frames that show it, as the others have it, and "
                "is not used" + f": {OF_LANDMARK}" * bool(aside[k] == Unseen.BEHIND_CAMERA)
            )
    return [Finding(text, flight.source, severity="warning") for text in texts]


NOT_CONVERGED = (
    "the solve did not converge, and the angles are those of its last step; look at the positions, "
    "the picks and their stated standard deviations"
)


def frames_unsolved(flight: Flight, solved: SolvedFlight) -> list[Finding]:
    """List frames without an attitude, by reason, and those that did not converge."""
    unknown = np.isnan(solved.attitudes.rotation[:, 0, 0])
    lost = unknown & np.isfinite(flight.path.position_m[:, 0])
    picked = np.bincount(flight.picks.frame, minlength=len(flight.frame))
    reasons = (
        (lost & (picked < 2), "fewer than two landmarks: two of three angles at most, no attitude"),
        (lost & (picked >= 2), "its landmarks lie on one line of sight, or too few can be used"),
        (~unknown & ~solved.attitudes.converged, NOT_CONVERGED),
    )
    tell = []
    for which, why in reasons:
        labels = [frame_label(flight, int(k)) for k in np.flatnonzero(which)]
        if labels:
            told = f"{first_of(labels, 5)}: {why}"
            tell.append(Finding(told, flight.source, severity="warning"))
    return tell
