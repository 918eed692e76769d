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
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.attitude.sigmas import AS_SIGMAS, Sigmas
from vopd.estimate import Estimate
from vopd.findings import (
    Finding,
    VopdError,
    count_text,
    first_of,
    numbers,
    refuse_other_kind,
    shown,
)
from vopd.flight.angles import attack_angles, camera_angles, doubted_angles, vehicle_angles
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import LEAPS, Flight, frame_label
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
from vopd.flight.misfits.input_errors import SPEAK_FOR
from vopd.flight.misfits.misfit import flight_findings
from vopd.flight.misfits.unsolved import (
    frames_unsolved,
    picks_outside,
    picks_set_aside,
    require_two_landmarks,
)
from vopd.flight.project.keys import Project, read_project
from vopd.flight.project.read import flight_or_errors, read_flight
from vopd.flight.settled import settled, settled_as_held, with_named_picks
from vopd.flight.solve.errors import (
    SOLVED_WITH,
    is_solved_again,
    with_places_solved_for,
    with_sigmas,
)
from vopd.flight.solve.free import (
    MOUNT,
    free_parameters,
    not_held_findings,
    without_parameter,
)
from vopd.flight.solve.held import least_held, solved_findings
from vopd.flight.solve.readout import ROUNDS as ROUNDS_OF_ROWS
from vopd.flight.solve.readout import SETTLED as ROWS_SETTLED
from vopd.flight.solve.readout import picks_at_frame_times, readout_findings
from vopd.flight.solve.rotations import SolvedFlight, solve
from vopd.shown import Shown

if TYPE_CHECKING:
    import pandas as pd

    from vopd.attitude.history import History, HistoryOptions
    from vopd.attitude.long_history import HistoryParts
    from vopd.flight.direction import Direction


# A solved flight


@dataclass(frozen=True, eq=False, repr=False)
class FlightResult(Shown):
    """A solved flight: the angles of every frame, the flight as read, and warnings.

    `print` shows a short table, and so does a notebook. Arrays by frame: `frame`, `image_name`,
    `time_s`, `solved`, `camera_deg`, `vehicle_deg`, `attack_deg`. Tables and figures:
    `to_dataframe()`, `history()`, `summary()`, `plot()`. The direction of a point of a picture:
    `direction()`.

    Args:
        estimates: the result of the solve, from which `estimate` is made
        findings: warnings about files and solution
        misfits: whether the residuals are larger than everything stated explains, or show a
            stabilised video, or the picks of a frame do not fit its position
    """

    estimates: FlightEstimates
    findings: tuple[Finding, ...]
    misfits: bool = False

    @property
    def mistaken(self) -> bool:
        """Whether residuals, or a leap of the track, show an error of the inputs (`findings`)."""
        return any(
            one.message.startswith(SPEAK_FOR) or one.message.endswith(LEAPS)
            for one in self.findings
        )

    @property
    def flight(self) -> Flight:
        """The flight as read from the project's files; freed parameters have solved values."""
        return self.estimates.flight

    @property
    def read(self) -> Flight:
        """The flight as read, with all parameters as stated."""
        return self.estimates.read

    @cached_property
    def estimate(self) -> Estimate:
        """The estimate of all frames, with residuals and partials; made when it is asked for."""
        return self.estimates.whole()

    @property
    def frame(self) -> Ints:
        """Frame numbers (F,), from 0 where images have names; `image_name` has those."""
        return self.flight.frame.copy()

    @property
    def image_name(self) -> tuple[str, ...]:
        """File names of the images (F,); empty where frames have numbers."""
        return self.flight.image_name

    @property
    def time_s(self) -> Floats:
        """Time of every frame (F,), seconds after the project's epoch; NaN where not known."""
        return self.flight.time_s.copy()

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
        given = flight.options.given
        if is_solved_again(self.flight.options.given, given):
            return solve_flight_read(flight).history_parts(options)
        rest = replace(given, **dict.fromkeys(SOLVED_WITH, 0.0), reading=None)
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

    def direction(
        self, frame: int | str, u_px: float, v_px: float, sigma_px: float | None = None
    ) -> Direction:
        """Find the direction in which a point of a picture is seen, with its uncertainty.

        Args:
            frame: number, or name of the image
            u_px: to the right from the centre of the first pixel, in the picture as it was taken
            v_px: downward
            sigma_px: standard deviation of either; None: that of the picks, or of the clicks

        Raises:
            VopdError: where there is no such frame, it has no attitude, or the lens's model does
                not reach the pixel
        """
        from vopd.flight.direction import direction_of

        labels = [*self.image_name] or [str(one) for one in self.frame.tolist()]
        if str(frame) not in labels:
            raise VopdError(
                f"{self.flight.source}: no frame {shown(frame)}: there are {labels[0]} to "
                f"{labels[-1]}"
            )
        pixel = numbers([u_px, v_px], "[u_px, v_px]")
        if pixel.shape != (2,):
            raise VopdError(f"[u_px, v_px] has the shape {pixel.shape}, not (2,): give one point")
        if sigma_px is not None:
            sigma_px = Sigmas(reading=sigma_px).reading
        return direction_of(self.estimates, labels.index(str(frame)), pixel, sigma_px)

    @property
    def next_clicks(self) -> list[str]:
        """Where to click next in a flight that is tracked from clicks: one line.

        Empty for an adjusted project, which takes no other clicks; ask its source.
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

    Nothing is printed: warnings are in the `findings` of the result.

    Args:
        source: the path of the project file, `flight.toml`, or of its folder; or the project or
            flight as `read_project` or `read_flight` returns it
        location: the location of the file, if it is not under its name
        sigmas: standard deviations that replace those stated by the project

    Returns:
        The angles of all frames, the flight as read, and the findings; `to_dataframe()` makes
        the table with uncertainty and flags.

    Raises:
        VopdError: if a file cannot be read, no frame has two landmarks, or the source is a deck
    """
    sigmas = Sigmas() if sigmas is None else sigmas
    refuse_other_kind(sigmas, Sigmas, "vopd.solve_flight", AS_SIGMAS)
    if isinstance(source, Flight):
        return solve_flight_read(with_sigmas(source, sigmas))
    if isinstance(source, Project):
        return solve_flight_read(
            with_sigmas(flight_or_errors(source), sigmas), project=lambda: source
        )
    name, location = project_file(source, location, "vopd.solve_flight")
    return solve_flight_read(
        with_sigmas(read_flight(name, location), sigmas),
        project=lambda: read_project(name, location),
    )


def project_file(
    source: object, location: str | PathLike[str] | None, function: str
) -> tuple[str, str | None]:
    """Name the project file that a public function is given, itself or by its folder.

    Args:
        source: what it was given
        location: where the file is, if not under its name
        function: that was called

    Returns:
        The name, and where the file is, if not under it.

    Raises:
        VopdError: where it is no path, or a file that is no project
    """
    takes = "the path of a flight project (vopd.run solves the jobs of a deck)"
    refuse_other_kind(source, (str, PathLike), function, takes)
    refuse_other_kind(location or "", (str, PathLike), function, "a path as location")
    name = str(source)
    path = Path(location or name)
    if os.path.isdir(path):  # noqa: PTH112 (a path that is too long for the system is none)
        return str(Path(name) / NAME), str(path / NAME)
    if path.suffix.lower() != ".toml" and os.path.isfile(path):  # noqa: PTH113
        raise VopdError(
            f"{name}: a flight project is a .toml that names its files; vopd.run({name!r}) solves "
            "a deck of 80-column cards"
        )
    return name, None if location is None else str(location)


NAME = "flight.toml"  # the project in a folder


@np.errstate(all="ignore")
def solve_flight_read(
    flight: Flight, tell: Callable[[], object] = lambda: None,
    project: Callable[[], Project] | None = None, doubted: bool = True,
) -> FlightResult:  # fmt: skip
    """Find the attitude of every frame of a flight whose project has been read.

    Args:
        flight: what the project holds
        tell: is called before each solve of all frames
        project: gives the project, for mistakes that take another reading of its files, if the
            flight misfits; None: these are not tried
        doubted: whether it is said what is doubtful, which takes as long as the solve, or longer

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
        rest = solve_flight_read(without_places(stated, lost), tell, project, doubted)
        return replace(rest, misfits=True)
    out = gross | swapped
    robust = flight.options.loss != "least-squares"  # looks at places' standard deviations, too
    same = None if robust else solve(by_themselves, out, before=first)
    read, flight, estimates = _settled_by_rows(flight, out, tell, same)
    found, swaps, without, estimates = _search_blunders(flight, estimates, gross, swaps, tell)
    swapped = swaps.marked(len(gross))
    apart = found.left_out | swapped
    dropped = found.left_out | (swapped & _two_left(flight, apart))
    if not flight.options.drop_blunders:
        dropped = np.zeros_like(apart)
        few = (found.pick | swapped).sum() <= FEW * len(found.pick)
        apart = (found.pick | swapped) & few
    if without is None or not np.array_equal(apart, found.left_out | swapped):
        try:
            without = settled(flight, apart, estimates.joint)
        except VopdError:  # too little is left: they are named, and take part
            without, apart = estimates, gross | swapped
            dropped &= apart
    estimates = with_named_picks(flight, without, estimates, dropped)
    more = least_held(without.joint)
    if more is not None:
        stated = replace(stated, options=read.options)
        return solve_flight_read(without_parameter(stated, more), tell, project, doubted)
    if MOUNT in read.options.free and read.vehicle is not None:
        from vopd.flight.mounting import mounted  # of few flights

        estimates = mounted(estimates)
    named = (found.pick | swapped) & estimates.solved.used
    estimates.mark_outliers(named, swaps.chances(len(swapped)))
    findings, misfits = list[Finding](), False
    if doubted:
        findings, misfits = _findings_of(
            flight, estimates, without, (found, swaps), (apart, dropped), project
        )
    if read.options.free:
        from vopd.flight.parameters import before_and_after  # of few flights

        estimates.before_and_after = before_and_after
    told = (*flight.findings, *outside, *of_clicks, *findings)
    return FlightResult(estimates, told, misfits)


def _settled_by_rows(
    read: Flight, out: Bools, tell: Callable[[], object], same: SolvedFlight | None
) -> tuple[Flight, Flight, FlightEstimates]:
    """Solve a flight, its rows brought to the times of their frames where its shutter rolls.

    Args:
        read: the flight
        out: picks that take no part, (P,)
        tell: is called before each solve
        same: its rotations with everything as it is stated

    Returns:
        The flight as read, and with the picks that were solved, both with the parameters that are
        kept; and its estimates.
    """
    flight, estimates = settled_as_held(read, out, tell, same)
    if read.shutter is not None and read.path.turning_rad_s is None:
        for round_ in range(ROUNDS_OF_ROWS):
            read = replace(read, options=flight.options)
            shifted = picks_at_frame_times(read, estimates.solved)
            moved = np.abs(shifted.picks.pixel - flight.picks.pixel).max(axis=1)
            if round_ > 1 and (moved < ROWS_SETTLED * flight.picks.sigma_px).all():
                break
            flight, estimates = settled_as_held(shifted, out, tell)
    return replace(read, options=flight.options), flight, estimates


def _search_blunders(
    flight: Flight, estimates: FlightEstimates, gross: Bools, swaps: Exchanges,
    tell: Callable[[], object],
) -> tuple[Blunders, Exchanges, FlightEstimates | None, FlightEstimates]:  # fmt: skip
    """Search a flight for picks that do not fit and for exchanged labels, one after the other.

    Args:
        flight: the flight
        estimates: solved without gross picks and exchanged labels
        gross: picks that are far off, (P,)
        swaps: labels that are exchanged, as its rotations alone show
        tell: is called before each solve

    Returns:
        Both; its solution without them, None where it is to be solved; and that without gross
        picks and exchanged labels alone.
    """

    def solve_without(left_out: Bools, before: FlightEstimates) -> FlightEstimates:
        tell()
        return settled(flight, left_out, before.joint)

    swapped = swaps.marked(len(gross))
    tested = with_places_solved_for(flight) if free_parameters(flight) else None
    if tested is not None:  # parameters follow errors of held places, which then look like picks'
        try:
            found, swaps, *_ = _search_blunders(
                tested, settled(tested, gross | swapped), gross, swaps, tell
            )
        except VopdError:  # as a landmark that is far from its place
            pass
        else:
            return found, swaps, None, estimates
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
    return found, swaps, without, estimates


def _findings_of(
    flight: Flight, estimates: FlightEstimates, without: FlightEstimates,
    search: tuple[Blunders, Exchanges], out: tuple[Bools, Bools],
    project: Callable[[], Project] | None,
) -> tuple[list[Finding], bool]:  # fmt: skip
    """Warn of all that is doubtful in a solved flight.

    Args:
        flight: the flight
        estimates: those that are given out
        without: those without the picks that do not fit
        search: what was found not to fit
        out: picks that took no part in what the frames have in common, and those of them that are
            left out of their own frames, too, (P,)
        project: gives the project; None: mistakes that take another reading are not tried

    Returns:
        The warnings, and whether the flight misfits.
    """
    (found, swaps), (apart, dropped) = search, out
    every = found._replace(pick=found.pick | swaps.marked(len(found.pick)))

    def usual(named: bool, exchanged: bool) -> list[str]:
        from vopd.flight.misfits.mistakes import usual_mistakes  # of few flights

        return [] if project is None else usual_mistakes(project(), without, named, exchanged)

    doubts = flight_findings(flight, without, apart, found.landmark, usual, every.pick)
    estimates.contradict(doubts.sentence)
    if doubts.misfits:  # of a flight as a whole it is not said which frames are not searched
        swaps = swaps._replace(not_searched=0)
        from vopd.flight.misfits.far_landmarks import far_landmarks  # of few flights

        far = [Finding(one, flight.source, severity="warning") for one in far_landmarks(flight)]
        doubts = doubts._replace(findings=[*far, *doubts.findings])
    findings = [*doubts.findings, *not_held_findings(flight), *solved_findings(without.joint)]
    if flight.vehicle is not None:
        from vopd.flight.mounting import mount_findings  # of few flights

        findings += mount_findings(estimates.flight)
    if not doubts.misfits:  # the angles of one that does are not believed
        turned = doubted_angles(estimates.flight, vehicle_angles(estimates.solved))
        findings += [Finding(one, flight.source, severity="warning") for one in turned]
    findings += exchange_findings(swaps, flight, dropped)
    findings += blunder_findings(found, flight, doubts.misfits, doubts.explained)
    if flight.picks.followed is not None and without.joint is not None:
        from vopd.flight.project.tracked_picks import followed_findings  # of few flights

        findings += followed_findings(flight, without.joint)
    findings += freed_beside_blunders(flight, every, apart)
    findings += readout_findings(flight)
    findings += picks_set_aside(flight, estimates.solved)
    findings += frames_unsolved(flight, estimates.solved)
    return findings, doubts.misfits


def without_places(flight: Flight, lost: Bools) -> Flight:
    """Take the places of frames whose camera is far from all landmarks, (F,), and say so.

    Such a frame has no attitude; one that were solved for would carry away the whole flight.
    """
    position_m = np.where(lost[:, None], np.nan, flight.path.position_m)
    labels = [frame_label(flight, int(k)) for k in np.flatnonzero(lost)]
    away_km = float(np.nanmax(flight.pick_range_m[lost[flight.picks.frame]])) / 1000.0
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


FEW = 0.1  # of the picks: more that do not fit their frames are a mistake of the flight


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
