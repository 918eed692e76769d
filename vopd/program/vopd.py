"""Program VOPD beside its listing (A 84 to A 455), for all frames at once.

The steps stand in the order of the listing but for six. The landmarks that are ignored (A 129
to A 161) are left out at the beginning, when the frames are put together; the origin (A 49 to
A 61, and the lost card before them) is converted with TGTCAM; the lens table (A 343 to A 348)
depends on no angle, and stands before the 22 passes; the start (A 109 to A 111, A 449 to A 454)
stands with them; in a pass the residuals are looked at for zeros (A 364 to A 375) after the partial
derivatives (A 386 to A 404), not before; the vehicle's angles and ALPBET (A 296 to A 304, A 308),
done in pass 22 there, stand after them. Group 9 is converted once (A 174 to A 199), and not in each
frame.

Beside the report: a comment names the cards that the lines below it stand for. A name of the
listing has its meaning here, but x and y stand in one array: `x` holds X and Y, `xco` XCO and
YCO, `xpc` XPC and YPC. docs/names.md has all names, and under "The three angles" the many that yaw,
pitch and roll have from step to step. Arrays are by frame (F, ...), or by landmark
that takes part (N, ...), frame after frame; `of` (N,) is the frame of each landmark. The control
cards and basic data (A 26 to A 82, A 87) are read by `vopd.cards`. The page (all WRITE, with the
loops and jumps around them, such as A 305 to A 307 and A 354 to A 358) is written by
`vopd.listing`, tape 10 (A 312) by `vopd.listing.tape10`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import NO_FIXES, Fix, Fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.alpbet import alpbet
from vopd.program.average import averages
from vopd.program.constants import factor, ftpkm, twopi
from vopd.program.frames import Frames, check_landmarks, frames_of, stopping_jobs
from vopd.program.ftlup import TableOutOfOrder, ftlup_each, outside
from vopd.program.orient import PASSES, FilmSight, Orientation, orient
from vopd.program.positions import directions, geodetic_latitude_deg, group_9
from vopd.results import CONVERGED_RAD, LandmarkResults, Outcome, Results, Stage, Stop

SAME_START_DEG = 1e-10
"""A converged frame is not solved again for a start that differs by this much or less."""
AT_A_TIME = 12_000
"""Landmarks of the frames that are solved at a time: fewer calls, and still in the cache."""

FirstEstimate = Callable[[FilmSight], Floats]
"""Makes first estimates (F, 3), degrees, from the input of the solve; NaN where there is none."""


def run(job: Job, fixes: Fixes = NO_FIXES, start_deg: Floats | None = None) -> Results:
    """Solve a job for all its frames.

    Args:
        job: the job.
        fixes: errata to correct; none for the original.
        start_deg: first estimates (F, 3) of the camera's yaw, pitch, roll, degrees, to
            start each frame from, instead of group 8 and the frame before.

    Returns:
        The results. A table out of order ends the job at the frame that first uses
        it: the results go that far and say so in `stop`.

    Raises:
        UndefinedLandmark: if a landmark takes part that group 9 does not define.
        TableNotANumber: if a table that is used holds a NaN.

    Source: TM X-3050, A 84 to A 455.
    """
    (results,) = run_jobs([job], fixes, [start_deg])
    if isinstance(results, VopdError):
        raise results
    return results


def run_jobs(
    jobs: Sequence[Job],
    fixes: Fixes = NO_FIXES,
    start_deg: Sequence[Floats | None] | None = None,
    first_estimate: FirstEstimate | None = None,
) -> list[Results | VopdError]:
    """Solve many jobs at once; each result is the same, bit for bit, as that of the job alone.

    The jobs whose run goes to its end are solved as one film, which for jobs of few frames is
    many times faster than one after the other. Memory grows with the frames of all jobs: a few
    thousand at a time are enough.

    Args:
        jobs: the jobs.
        fixes: errata to correct in all of them.
        start_deg: for each job what `run` takes under this name.
        first_estimate: makes first estimates to start each frame from, in place of group 8 and
            the frame before.

    Returns:
        For each job, in order, its results, or the error that `run` would raise.
    """
    if not jobs:
        return []
    film = frames_of(jobs, start_deg)
    alone = stopping_jobs(film)
    if len(jobs) > 1 and alone.any():
        together = np.flatnonzero(~alone).tolist()
        done: dict[int, Results | VopdError] = {}
        for some in (together, *([k] for k in np.flatnonzero(alone).tolist())):
            starts = [start_deg[k] for k in some] if start_deg else None
            part = run_jobs([jobs[k] for k in some], fixes, starts, first_estimate)
            done |= zip(some, part, strict=True)
        return [done[k] for k in range(len(jobs))]
    try:
        results = vopd(film, jobs[0], fixes, first_estimate)
    except VopdError as error:
        return [error]
    return [*results.divided(jobs)] if len(jobs) > 1 else [results]


@np.errstate(all="ignore")
def vopd(
    film: Frames, job: Job, fixes: Fixes = NO_FIXES, first_estimate: FirstEstimate | None = None
) -> Results:
    """Solve frames.

    Args:
        film: the frames.
        job: their job, or the first of them.
        fixes: the errata to correct.
        first_estimate: as `run_jobs` takes it.

    Raises:
        UndefinedLandmark, TableNotANumber: as `run` raises them.

    Source: TM X-3050, A 84 to A 455.
    """
    readings, layout = film.readings, film.readings.layout
    dropped, of, nj, table, cc = film.dropped, film.of, film.nj, film.table, film.cc
    frames, landmarks = len(nj), len(of)
    stop: Stop | None = None

    def reached(values: Floats) -> Floats:
        """Spread values of landmarks that take part among all landmarks, NaN for the others."""
        if landmarks == layout.total:
            return values
        every = np.full((layout.total, *values.shape[1:]), np.nan)
        every[film.slot] = values
        return every

    # A table out of order stops the run of 1974 in mid-page, in FTLUP (A 122, A 345, A 308); what
    # was printed until then is kept. `stage` is the part of the page that is being computed and
    # `going` are the frames that reach it; what is not reached, or not solved, stays NaN.
    ti = alfa = beta = eta = cvp = deviation = np.full(frames, np.nan)
    xyztab = start = camera = sigma = correction = np.full((frames, 3), np.nan)
    centre_in = centre = np.full((frames, 2), np.nan)
    point_in = x = np.full((layout.total, 2), np.nan)
    thj = phij = rj = geodetic = altitude = rr = drr = np.full(landmarks, np.nan)
    dircos, eps = np.full((landmarks, 3), np.nan), np.full((landmarks, 2), np.nan)
    outside_clock = outside_path = outside_wind = singular = np.zeros(frames, bool)
    at_centre, last_pass = np.zeros(landmarks, bool), np.zeros(frames, np.int64)

    # A 84 to A 104: averages of the readings
    # A 105 to A 118: the loop over frames, of which all are taken at once, and NGO, by which
    # `vopd.cards.read` goes on to the next job
    xpc, xco = averages(readings, rounded=Fix.EIGHT_DIGITS not in fixes)

    stage, going = Stage.TIME, np.ones(frames, bool)
    try:
        # A 121 to A 128: time, and the vehicle's position at that time; no time is printed where
        # the second look-up stops the run, so that `ti` waits for it
        xfram = readings.frame.astype(np.float64)
        at = ftlup_each(xfram, table, film.clock)
        ti, xyztab = at, ftlup_each(at, table, film.position)
        outside_clock = outside(xfram, table, film.clock)
        outside_path = outside(ti, table, film.position)

        # A 165 to A 199: the landmarks; those that are ignored (A 129 to A 161) are out already,
        # by `vopd.program.ignored.kept`, which `frames_of` calls. One without a card of group 9
        # is an error here; there it had what the tables held
        check_landmarks(film)
        thj, phij, rj = (one[film.card] for one in group_9(film.landmarks, fixes))
        geodetic = geodetic_latitude_deg(film.landmarks)[film.card]
        altitude = film.landmarks.altitude_ft[film.card]

        # A 213 to A 217: direction cosines XLAM, XMU, XNU, by TGTCAM, of NJ (A 201, A 202)
        dircos = directions(film.origin, fixes, xyztab, thj, phij, rj, of)

        # The loop over runs and what it saves (A 204 to A 208, A 221 to A 228, A 255 to A 272),
        # unused values (A 282 to A 287, A 290, A 291, A 351 to A 353, A 359, A 362, A 363, A 416,
        # A 422 to A 428: XNTEMP counts twice), the rejection of landmarks by NG, which holds none
        # (A 364, A 367 to A 369, A 381, A 383 to A 385), and
        # the random errors (A 176, A 180, A 184, A 209 to A 212, A 222, A 231, A 232, A 246,
        # A 248), which are times RN = 0, do nothing here. Passes are counted and tested (A 288,
        # A 289, A 292 to A 295, A 441 to A 443) by the loop in `vopd.program.orient`.

        # A 233 to A 254: centres and landmarks in millimetres on the film. There XPC and X keep
        # their names; here they are `centre_in`, `point_in` before, and `centre`, `x` from here on.
        # The page has both centres: XPC, YPC in inches, and as XP, YP in millimetres
        centre_in, centre, point_in, x = xpc, xpc * factor, xco, xco * factor

        stage, going = Stage.LENS, ~dropped
        if going.any():
            # A 343 to A 348: the lens; here because no angle changes it from pass to pass
            away = x[film.slot] - centre[of]  # X - XPC, Y - YPC
            xx1 = np.sqrt(away[:, 0] ** 2 + away[:, 1] ** 2)
            rr, drr = xx1, -ftlup_each(xx1, table[of], film.lens) / 1000.0
            at_centre = rr == 0.0
            # DISTR = 1 - DRR / RR; at the centre 1, where the listing divides zero by zero
            away *= radial_factor(rr, drr)[:, None]

            # A 274 to A 443: the camera's angles; A 109 to A 111, A 449 to A 454: their start
            xmu1 = dircos[:, 1]
            if Fix.FIRST_LANDMARK not in fixes:  # A 394
                xmu1 = xmu1[(np.cumsum(nj) - nj)[of]]  # XMU(1) of the frame
            seen = FilmSight(nj, dircos, away, xmu1, cc)
            initial, first = film.initial, film.first
            if first_estimate is not None:
                estimate = first_estimate(seen)
                kept = film.given | np.isnan(estimate).any(axis=1)
                initial, first = np.where(kept[:, None], initial, estimate), np.arange(frames)
            turn = 360.0 if Fix.RESTART in fixes else twopi
            done, start = orient_frames(initial.T, seen, dropped, turn, first)
            start, correction, eps = start.T, done.correction.T, done.eps
            last_pass, singular = done.last_pass, done.singular
            exact = (last_pass > 0) & (last_pass < PASSES)  # ended at A 375, before the last page

            # A 296 to A 304: the vehicle's angles SIG1, SIG2, SIG3; there in pass 22. The page has
            # them under PSI, THETA, PHI, and under SIG1, SIG2, SIG3 the camera's ALPHA, XOMEG, XKAP
            camera = np.where(dropped, np.nan, done.angles).T
            sigma = film.multiplier * camera + film.offset
            low, high = np.array([0.0, -180.0, 0.0]), np.array([360.0, 180.0, 360.0])
            sigma = np.where(sigma < low, sigma + 360.0, sigma)
            sigma = np.where(sigma > high, sigma - 360.0, sigma)

            # A 308, with the look-ups of ALPBET (C 6 to C 12): angles of attack; there in pass 22
            stage, going = Stage.WIND, going & ~exact
            height = ftlup_each(ti, table, film.altitude)
            wind = ftlup_each(height, table, film.wind)
            velocity = ftlup_each(ti, table, film.velocity)
            outside_wind = outside(height, table, film.wind)
            psi, theta, phi = sigma.T
            alfa, beta, eta, cvp = alpbet(velocity, wind, theta, psi, phi)

            # A 444 to A 447: the root mean square of the residuals, x and y by turns; the page
            # calls it their standard deviation
            squares = np.bincount(np.repeat(of, 2), (eps**2).ravel(), frames)
            fitted = 3 if Fix.STANDARD_DEVIATION in fixes else 0
            deviation = np.sqrt(squares / (2.0 * nj - fitted))
    except TableOutOfOrder as error:
        if going.any():
            assert error.table is not None  # all of these look-ups are named
            frame, name = int(going.argmax()), error.table
            stop = Stop(frame, stage, *name, error.position, error.vari, error.vard)

    # All residuals zero (A 373 to A 375): before pass 22 the page lacks its groups 4 to 7, and tape
    # 10 the record; in pass 22 the page lacks its last group alone, the standard deviation
    outcome = np.where((last_pass > 0) & (last_pass < PASSES), Outcome.EXACT, Outcome.SOLVED)
    outcome = np.where(last_pass == PASSES, Outcome.EXACT_LATE, outcome)
    outcome = np.where(dropped, Outcome.DROPPED, outcome)
    used, centred = np.zeros((2, layout.total), bool)
    used[film.slot], centred[film.slot] = True, at_centre
    results = Results(
        layout,
        LandmarkResults(
            landmark=readings.points.landmark,
            used=used,
            ignored=~used & ~dropped[layout.frame],
            longitude_deg=reached(thj),
            latitude_deg=reached(geodetic),
            geocentric_latitude_deg=reached(phij),
            altitude_ft=reached(altitude),
            radius_km=reached(rj),
            radius_kft=reached(rj) * ftpkm / 1000.0,
            direction=reached(dircos),
            point_in=point_in,
            point_mm=x,
            radius_mm=reached(rr),
            distortion_mm=reached(drr),
            residual_mm=reached(eps),
            at_centre=centred,
        ),
        job=job,
        fixes=fixes,
        frame=readings.frame,
        outcome=outcome,
        time_s=ti,
        vehicle_ft=xyztab,
        centre_in=centre_in,
        centre_mm=centre,
        start_deg=start,
        camera_deg=camera,
        vehicle_deg=sigma,
        alpha_deg=alfa,
        beta_deg=beta,
        eta_deg=eta,
        airspeed_ft_s=cvp,
        residual_deviation_mm=deviation,
        correction_rad=correction,
        last_pass=last_pass,
        singular=singular,
        outside_clock=outside_clock,
        outside_trajectory=outside_path,
        outside_wind=outside_wind,
        stop=stop,
    )
    if stop is None:
        return results
    outcome[stop.frame_index] = Outcome.STOPPED
    return results.take(slice(stop.frame_index + 1))


def orient_frames(
    initial: Floats, seen: FilmSight, dropped: Bools, turn: float = twopi, first: Ints | int = 0
) -> tuple[Orientation, Floats]:
    """Solve frames of which each starts from the angles of the one before.

    The result is the same, bit for bit, as if the frames were solved one after the
    other; but frames are solved together, because few results depend on their start
    to the last bit. First every frame is solved from `initial`. Then the start that
    each frame should have had is known, and the frames that were solved from a
    different one are solved again, until there are none. A frame that converged is
    not solved again if its start differs by at most `SAME_START_DEG`; any other
    frame is solved again for a difference in the last bit.

    Args:
        initial: first estimates (3, 1) or (3, F) of the camera's yaw, pitch, roll, degrees:
            where a film starts, and where an angle starts that is not carried on.
        seen: what the solve is given.
        dropped: frames that leave no angles to the next (F,).
        turn: the full circle with which carried angles, in degrees, are compared:
            2 pi in the program, where 360 is meant.
        first: index of the first frame of each frame's film (F,), or of all.

    Returns:
        The solve, its residuals `eps` (N, 2), and the start (3, F) that each frame was solved from.

    Source: TM X-3050, A 109 to A 111 and A 449 to A 454.
    """
    frames = len(seen.nj)
    initial = np.broadcast_to(initial, (3, frames))
    start = initial.copy()
    done = Orientation(
        angles=np.zeros((3, frames)),
        eps=np.zeros((len(seen.xmu1), 2)),
        next=np.zeros((3, frames)),
        correction=np.zeros((3, frames)),
        last_pass=np.zeros(frames, np.int64),
        singular=np.zeros(frames, bool),
    )
    again = np.arange(frames)
    while len(again):
        for which in seen.alike(again, AT_A_TIME):
            part = orient(start[:, which], seen.of(which))
            slot, used = seen.slots(which)
            done.eps[slot[used]] = part.eps[:, used].T
            for mine, theirs in zip(done, part, strict=True):
                if mine is not done.eps:
                    mine[..., which] = theirs
        due = starts_due(initial, done, dropped, turn, first)
        again = np.flatnonzero(to_be_solved(due, start, done, seen.nj))
        start[:, again] = due[:, again]
    return done, start


def to_be_solved(due: Floats, start: Floats, done: Orientation, nj: Ints) -> Bools:
    """Mark frames that are to be solved again from the start that is due to them (F,).

    A start may differ in its last digits where the frame has an answer of its own. It has
    none with fewer than two landmarks, a singular matrix, or residuals that vanished, so that
    it passes on its start as it is.

    Args:
        due: the start that each frame should have (3, F), degrees.
        start: the start it was solved from (3, F).
        done: the solve.
        nj: how many landmarks each frame has (F,).
    """
    same = ((due == start) | (np.isnan(due) & np.isnan(start))).all(axis=0)
    answered = (np.abs(done.correction) <= CONVERGED_RAD).all(axis=0)
    answered &= (done.last_pass == 0) & ~done.singular & (nj >= 2)
    near = (np.abs(due - start) <= SAME_START_DEG).all(axis=0)
    return np.asarray(~same & ~(answered & near))


def radial_factor(radius: Floats, correction: Floats) -> Floats:
    """Find the factor that removes radial distortion from image coordinates.

    It is 1 - correction / radius.

    A point at the frame's centre has the factor 1; the listing divides zero by zero there.

    Args:
        radius: distance of the image point from the frame's centre, mm, (...)
        correction: DELTA R, minus the lens table's distortion at that radius, mm, (...)

    Source: TM X-3050, DISTR, A 348.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(radius == 0, 1.0, 1.0 - correction / radius))


def starts_due(
    initial: Floats, done: Orientation, dropped: Bools, turn: float, first: Ints | int
) -> Floats:
    """Find the start (3, F) that each frame should have, given how all frames ended.

    They are ALPHAP, XOMEGP, XKAPP of A 449 to A 454, or ALPHAI, XOMEGI, XKAPI of group 8.

    A frame that was dropped, or whose residuals vanished, passes no angles on: the
    next frame starts where that frame did. Carried angles are in degrees and the
    limits in radians, as in the listing: each angle starts from `initial` unless it
    lies in 0 to 6.283 degrees (pitch: -3.1416 to 3.1416). If a frame's angles are
    NaN, the next frame starts from `initial` in all three.
    """
    leaves = ~dropped & (done.last_pass == 0)
    frames = np.arange(len(leaves))
    before = np.maximum.accumulate(np.where(leaves, frames, -1))
    before = np.concatenate([[-1], before[:-1]])
    low = np.array([[0.0], [-turn / 2.0], [0.0]])
    stays = (done.next >= low) & (done.next <= low + turn)
    stays &= ~np.isnan(done.next).any(axis=0)
    carried = (before >= first) & stays[:, before]
    return np.where(carried, done.next[:, before], initial)
