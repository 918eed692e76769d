"""Checks of a deck's cards: errors, and conditions that the original did not report."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from statistics import NormalDist, median
from typing import BinaryIO

import numpy as np

from vopd.arrays import Floats, Ints, among
from vopd.cards.deck import A_TAB, CardBlock
from vopd.cards.format import BASIC_DATA, group_of
from vopd.cards.miscount import Miscount
from vopd.cards.read import read_jobs
from vopd.errata import NO_FIXES, Fix, Fixes
from vopd.findings import Finding, InputError, Report, count_text
from vopd.geometry.linear import pseudo_inverse
from vopd.job import Job, Readings, copied_readings_text
from vopd.program.average import averages
from vopd.program.constants import factor
from vopd.program.earth import SEA_LEVEL_KFT
from vopd.program.frames import check_landmarks, frames_of
from vopd.program.ftlup import TableNotANumber, TableOutOfOrder, ftlup, ftlup_each
from vopd.program.ignored import kept
from vopd.program.positions import (
    UndefinedLandmark,
    directions,
    earth_fixed,
    group_9,
    landmarks_earth_fixed,
)
from vopd.program.vopd import run


@np.errstate(all="ignore")  # numbers punched too large overflow in what the rules compute
def check_deck(
    file: BinaryIO, name: str, *, spread_in: float | None = None, limits_1974: bool = False
) -> list[Finding]:
    """Find all errors and warnings of a deck.

    After a field that is not a number, reading goes on. It ends where the cards
    leave open where the next group or the next frame begins.

    Args:
        file: the deck, open for reading bytes
        name: the deck's name, for findings
        spread_in: how far three readings of one point may differ, inches; None takes the limit
            from the noise of the deck's own readings (`vopd.check`)
        limits_1974: whether a deck that exceeds the original's array sizes is an error

    Returns:
        The findings in the order of the deck's cards.

    Raises:
        VopdError: where the file is empty or is not a deck.
    """
    found: list[list[Finding]] = [[]]  # of each job, and behind the last
    earth = EarthOf1974()

    def earth_of_1974(job: Job, locations: CardLocations) -> Iterator[Finding]:
        earth.add(job, locations, found[-1])
        return iter(())

    spread = partial(reading_spread, spread_in=spread_in)
    rules: list[tuple[Rule, tuple[int, ...]]] = [(spread, (BASIC_DATA.number,))]
    rules += [*CARD_RULES, *RUN_RULES, (earth_of_1974, EARTH_GROUPS)]
    jobs = checked_jobs(
        file, name, lambda one: found[-1].append(one), rules, limits_1974=limits_1974
    )
    job = None
    try:
        for job in jobs:
            lost = any(_is_of_a_tab(one, 9) for one in chain.from_iterable(found))
            found += [[] if lost else _undefined_landmarks(job), []]
        if job is None and not any(one.severity == "error" for one in found[-1]):
            found[-1].append(Finding("the deck ends after group 1: it has no job", name).warned())
    except Miscount as error:
        found = [error.before(list(chain.from_iterable(found))), [error.finding]]
    except InputError as error:
        found.append([error.finding])
    earth.end()
    unique = _without_knock_ons(list(dict.fromkeys(chain.from_iterable(found))))
    return sorted(unique, key=lambda finding: (finding.card or 0, finding.columns or (0, 0)))


def _is_of_a_tab(finding: Finding, group: int | None = None) -> bool:
    """Tell whether a finding names a tab, on a card of that group."""
    return finding.message.startswith(A_TAB) and group in (None, finding.group)


def _without_knock_ons(found: list[Finding]) -> list[Finding]:
    """Leave out what else is found on a card with a tab: nothing on it is in its columns."""
    cards = {one.card for one in found if _is_of_a_tab(one)}
    return [one for one in found if one.card not in cards or _is_of_a_tab(one)]


def checked_jobs(
    file: BinaryIO,
    name: str,
    report: Report,
    rules: Iterable[tuple[Rule, tuple[int, ...]]] | None = None,
    *,
    limits_1974: bool = False,
) -> Iterator[Job]:
    """Read the jobs of a deck one by one, and report what is doubtful on the cards of each.

    Args:
        file: the deck, open for reading bytes
        name: the deck's name, for findings
        report: is given every finding of the reader, and behind those of a job those of the rules
        rules: the rules, as in `CARD_RULES`; None is those of whatever a run does not notice
            itself: the spread of readings by the deck's own noise, and `CARD_RULES`
        limits_1974: whether a deck that exceeds the original's array sizes is an error

    Raises:
        InputError: where a card cannot be read, or reading cannot go on
        VopdError: where the file is empty or is not a deck
    """
    if rules is None:
        rules = ((reading_spread, (BASIC_DATA.number,)), *CARD_RULES)
    rules, locations = tuple(rules), CardLocations()
    for job in read_jobs(file, name, report, limits_1974=limits_1974, on_cards=locations.add):
        with np.errstate(all="ignore"):  # numbers punched too large overflow in the rules
            for rule, groups in rules:
                if any(map(locations.was_read, groups)):
                    for finding in rule(job, locations):
                        report(finding)
        yield job
        locations.next_job()


def _undefined_landmarks(job: Job) -> list[Finding]:
    """Report each landmark that is used in a frame and is not defined by group 9."""
    if not job.readings.first_card:
        return []
    _, used = kept(job.readings, job.ignored)
    read = set(job.readings.points.landmark[used].tolist())
    numbers = sorted(read - set(job.landmarks.number.tolist()))
    return [job.readings.first_card[n] for n in numbers if n in job.readings.first_card]


# The cards of each group, for findings about several cards


class CardLocations:
    """The cards of each group; cards that are read again replace the old ones.

    `add` is what `read_jobs` calls with every block of cards.
    """

    def __init__(self) -> None:
        self._blocks: dict[int, list[CardBlock]] = {}
        self._read_for_this_job: set[int] = set()

    def add(self, cards: CardBlock) -> None:
        """Add a block of cards that has been read."""
        number = cards.where.group or 0
        if number not in self._read_for_this_job:
            self._blocks[number] = []
            self._read_for_this_job.add(number)
        self._blocks[number].append(cards)

    def next_job(self) -> None:
        """Note that the cards that follow belong to the next job."""
        self._read_for_this_job.clear()

    def was_read(self, group: int) -> bool:
        """Tell whether this group was read for the present job."""
        return group in self._read_for_this_job

    def now(self, group: int) -> CardLocations:
        """Keep the present cards of a group, whatever is read again for later jobs."""
        kept = CardLocations()
        kept._blocks = {group: self._blocks[group]}
        return kept

    def last(self, group: int) -> tuple[CardBlock, int]:
        """Find the last card of a group: its block, and its index in that."""
        cards = self._blocks[group][-1]
        return cards, len(cards) - 1

    def warning(self, group: int, row: int, field: str, message: str) -> Finding:
        """Make a warning about one card of a group.

        Args:
            group: number of the group
            row: index of the card within the group, from 0
            field: FORTRAN name of the field; empty for the whole card
            message: what is to be said
        """
        for cards in self._blocks[group]:
            if row < len(cards):
                layout = group_of(group).layout
                found = next((pair for pair in layout if pair[0].name == field), None)
                if found is None:
                    where, card = cards.where, cards.first + row
                    return Finding(message, where.source, card, group=group, severity="warning")
                card_field, item = found
                columns = (item.first, item.last)
                return cards.finding(row, message, card_field.meaning, columns, "warning")
            row -= len(cards)
        return Finding(message, group=group).warned()


def decimal_text(value: float, decimals: int) -> str:
    """Write a number with a fixed number of decimals; with an exponent if it is too large."""
    return f"{value:.{decimals}f}" if abs(value) < 1e8 else f"{value:.4g}"


# Basic data: readings, fiducials, frame numbers and landmarks of each frame

RECTANGLE_IN = 0.050  # by which corners' distances from their centre may differ: film shrinks
ROUNDING_IN = 1e-9  # readings are decimals of .001 in, and their differences are not exact


def reading_spread(
    job: Job, locations: CardLocations, spread_in: float | None = None
) -> Iterator[Finding]:
    """Warn where three readings of one point differ by more than the limit.

    Args:
        job: the job
        locations: the cards of its groups
        spread_in: the limit, inches; None takes it from the noise of the readings
    """
    readings = job.readings
    limit = spread_limit_in(readings) if spread_in is None else spread_in
    starts, layout = first_rows(job), readings.layout
    of_fiducials = (starts[:, None] + 3 * np.arange(4)).ravel()
    of_landmarks = starts[layout.frame] + 12
    of_landmarks += 3 * (np.arange(layout.total) - layout.start[layout.frame])
    for points, rows in (
        (readings.fiducial_in.reshape(-1, 3, 2), of_fiducials),
        (readings.points.landmark_in, of_landmarks),
    ):
        spread: Floats = np.ptp(points, axis=1)
        for k in np.flatnonzero((spread > limit + ROUNDING_IN).any(axis=1)):
            axis = int(np.nanargmax(spread[k]))
            by = decimal_text(spread[k, axis], 3)
            message = f"three readings of this point differ by {by} in (limit {limit:.3f} in)"
            field = ("XSAVE", "YSAVE")[axis]
            yield locations.warning(BASIC_DATA.number, int(rows[k]), field, message)


def copied_readings(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn where the three readings of most points are copies of each other."""
    message = copied_readings_text(job.readings)
    if message:
        yield locations.warning(BASIC_DATA.number, 0, "", message)


def fiducials(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn where the four fiducials are not equally far from their centre, as corners should be."""
    corners = job.readings.fiducial_in.mean(axis=2)
    away = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2)
    starts = first_rows(job)
    for k in np.flatnonzero(np.ptp(away, axis=1) > RECTANGLE_IN):
        nearest, farthest = decimal_text(away[k].min(), 3), decimal_text(away[k].max(), 3)
        message = (
            f"the fiducials of frame {job.readings.frame[k]} form no rectangle: "
            f"{nearest} to {farthest} in from their centre"
        )
        yield locations.warning(BASIC_DATA.number, int(starts[k]), "", message)


def frame_order(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn of frames that occur twice, or that come after a frame with a larger number."""
    frame = job.readings.frame
    starts = first_rows(job)
    seen: set[int] = set()
    for k, number in enumerate(frame.tolist()):
        if number in seen:
            message = f"frame {number} has been read before"
        elif k and number < frame[k - 1]:
            message = f"frame {number} comes after frame {frame[k - 1]}"
        else:
            message = ""
        seen.add(number)
        if message:
            yield locations.warning(BASIC_DATA.number, int(starts[k]), "IFRAM", message)


def too_few_landmarks(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn of frames in which fewer than two different landmarks take part."""
    readings = job.readings
    dropped, used = kept(readings, job.ignored)
    starts = first_rows(job)
    layout, landmark = readings.layout, readings.points.landmark
    for k in np.flatnonzero((layout.distinct(landmark, used) < 2) & ~dropped):
        which = landmark[layout.span(k)][used[layout.span(k)]]
        message = (
            f"frame {readings.frame[k]} has only landmark {which[0]}; "
            "an attitude needs two different landmarks"
        )
        yield locations.warning(BASIC_DATA.number, int(starts[k]), "", message)


def lens_reach(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn where the lens table does not reach the outermost landmark, or the innermost."""
    centre, point = averages(job.readings)
    _, used = kept(job.readings, job.ignored)
    radius = np.linalg.norm((point - centre[job.readings.layout.frame]) * factor, axis=1)
    table = job.camera.lens_radius_mm
    if not used.any():
        return
    nearest, farthest = radius[used].min(), radius[used].max()
    for row, distance, beyond in (
        (int(table.argmin()), nearest, nearest < table.min()),
        (int(table.argmax()), farthest, farthest > table.max()),
    ):
        if beyond:
            message = (
                f"a landmark is {decimal_text(distance, 2)} mm from the centre: "
                "the lens table is extrapolated"
            )
            yield locations.warning(1, row, "XRR", message)


def first_rows(job: Job) -> Ints:
    """Count the cards before each frame within the basic data (F,)."""
    cards = 12 + 3 * job.readings.layout.count
    return np.asarray(np.cumsum(cards) - cards)


# The limit of three readings of one point
#
# The limit comes from the noise of the deck's own readings. A deck of n points
# has 2n triples of readings (x and y). If all readings have the same normal noise
# of standard deviation s, the difference of two has the deviation s sqrt(2), and
# a triple has three differences. So, by Bonferroni's inequality, no triple of the
# deck exceeds
#
#     limit = s sqrt(2) z(1 - p / (6 * 2n)),    z: quantile of the normal distribution,
#
# but with probability p. The noise s is estimated from the median of the triples'
# variances, which a few bad triples do not move: a triple's variance is
# exponentially distributed about s squared, so its median is s squared ln 2. A
# short film has too few triples for that, so the usual care of a film reader
# counts as much as `USUAL_WEIGHT` triples.

USUAL_NOISE_IN = 0.003  # standard deviation of one reading by a careful film reader, inches
USUAL_WEIGHT = 50
NEVER_BELOW_IN = 0.010  # readings of one point that differ by this much or less are not questioned
CHANCE = 0.001  # probability that a deck without a bad reading draws a finding


def noise_in(readings: Readings) -> float:
    """Estimate the standard deviation of one reading, inches, from the triples of all points."""
    variance = _triples(readings).var(axis=1, ddof=1)
    variance = variance[~np.isnan(variance)]  # NaN where a reading is no number
    from_deck = median(variance.tolist()) / np.log(2.0) if len(variance) else 0.0
    total = USUAL_WEIGHT * USUAL_NOISE_IN**2 + len(variance) * from_deck
    return float(np.sqrt(total / (USUAL_WEIGHT + len(variance))))


def spread_limit_in(readings: Readings) -> float:
    """Estimate how far three readings of one point of this film may differ, inches."""
    tails = 6 * max(len(_triples(readings)), 1)
    quantile = -NormalDist().inv_cdf(CHANCE / tails)
    return max(NEVER_BELOW_IN, float(np.sqrt(2.0)) * quantile * noise_in(readings))


def _triples(readings: Readings) -> Floats:
    """List the three readings of every coordinate of every point (2n, 3)."""
    fiducials = readings.fiducial_in.swapaxes(2, 3).reshape(-1, 3)
    landmarks = readings.points.landmark_in.swapaxes(1, 2).reshape(-1, 3)
    return np.concatenate([fiducials, landmarks])


# Control cards: tables, landmarks and ignored landmarks

ALTITUDE_FT = 500.0  # H against Z: maps, the geoid and a round Earth agree to less


def unused_landmarks(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn of landmarks of group 9 that are in no frame."""
    given = len(job.ignored.everywhere)
    shown = set(job.readings.points.landmark.tolist())
    for row, number in enumerate(job.landmarks.number[-given:].tolist()):
        if number not in shown:
            yield locations.warning(9, row, "ITGT", f"landmark {number} is in no frame")


ON_A_CARD, COLUMNS, SEQUENCE = 16, 5, 72  # numbers of a list, their columns; the last before 73


def behind_lists(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn of what stands behind the last number of group 5, 10 or 12, and is not read."""
    frames, landmarks = len(job.readings.frame), len(job.ignored.everywhere)
    for group, count, by in (
        (5, 3 + frames, ": NFR counts the frames"),
        (10, 1, ""),
        (12, 1 + landmarks, ": NT of group 5 counts the landmarks"),
    ):
        cards, row = locations.last(group)
        read = COLUMNS * ((count - 1) % ON_A_CARD + 1)
        behind = cards.image(row)[read:SEQUENCE].rstrip()
        text = behind.strip()
        if text and locations.was_read(group):
            columns = read + len(behind) - len(text) + 1, read + len(behind)
            message = f"{text!r} stands behind the last number of the group and is not read{by}"
            yield cards.finding(row, message, "", columns, "warning")


def signs(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn where the degrees and the minutes of a landmark have different signs."""
    given, marks = len(job.ignored.everywhere), job.landmarks
    for field, degrees, minutes in (
        ("THJMI", marks.longitude_deg, marks.longitude_min),
        ("PHIJMI", marks.latitude_deg, marks.latitude_min),
    ):
        for row in np.flatnonzero((degrees * minutes)[-given:] < 0):
            d, m = degrees[-given:][row], minutes[-given:][row]
            total = decimal_text(d + m / 60, 5)
            message = f"minutes {m:g} and degrees {d:g} differ in sign: read as {total}"
            yield locations.warning(9, int(row), field, message)


def tables_in_order(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Report tables that are out of order: errors where a run stops there, else warnings."""
    for label, field, table in (
        (6, "IFRM", job.clock.frame),
        (7, "TX", job.trajectory.time_s),
        (1, "XRR", job.camera.lens_radius_mm),
        (4, "ALT", job.wind.altitude_ft),
    ):
        row = _first_out_of_order(table)
        if row is None:
            continue
        what = f"{table[row]:g} after {table[row - 1]:g}, where values must ascend"
        stops = _stops_a_run(job, label)
        words = "the run would stop here" if stops else "no frame uses this table"
        finding = locations.warning(label, row, field, f"{what}: {words}")
        yield replace(finding, severity="error" if stops else "warning")


def _first_out_of_order(table: Floats | Ints) -> int | None:
    """Find the first value that does not exceed the one before; None if there is none."""
    falls = np.flatnonzero(np.diff(table) <= 0)
    return int(falls[0]) + 1 if len(falls) and np.isfinite(table).all() else None


def _stops_a_run(job: Job, group: int) -> bool:
    """Run the job with all other tables in order: does it stop at the table of this group?"""
    clock, path, camera, wind = job.clock, job.trajectory, job.camera, job.wind

    def mended(number: int, table: Floats) -> Floats:
        if number == group or _first_out_of_order(table) is None:
            return table
        return np.arange(len(table), dtype=np.float64)

    others = replace(
        job,
        clock=replace(clock, frame=mended(6, clock.frame.astype(np.float64)).astype(np.int64)),
        trajectory=replace(path, time_s=mended(7, path.time_s)),
        camera=replace(camera, lens_radius_mm=mended(1, camera.lens_radius_mm)),
        wind=replace(wind, altitude_ft=mended(4, wind.altitude_ft)),
    )
    try:
        return run(others).stop is not None
    except (UndefinedLandmark, TableNotANumber):  # errors of their own, which end a run before
        return True


def tables_span(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn where time, trajectory or wind end before the frames do and are extrapolated."""
    clock, path = job.clock, job.trajectory
    frame = job.readings.frame.astype(np.float64)
    time_s = _look_up(frame, clock.frame, clock.time_s)
    altitude_ft = _look_up(time_s, path.time_s, path.altitude_ft)
    for label, field, what, table, values in (
        (6, "IFRM", "frame", clock.frame.astype(np.float64), frame),
        (7, "TX", "time", path.time_s, time_s),
        (4, "ALT", "altitude", job.wind.altitude_ft, altitude_ft),
    ):
        if len(table) < 2 or not np.isfinite(values).all() or _first_out_of_order(table):
            continue
        for row, beyond, extreme in (
            (0, values < table[0], values.min()),
            (len(table) - 1, values > table[-1], values.max()),
        ):
            count = int(beyond.sum())
            if count:
                frames = count_text(count, "frame is", "frames are")
                message = f"{frames} outside this table, which is extrapolated: "
                yield locations.warning(label, row, field, f"{message}{what} {extreme:.8g}")


def _look_up(x: Floats, table: Floats | Ints, values: Floats) -> Floats:
    """Interpolate values; NaN where the table cannot be used, which is reported elsewhere."""
    try:
        return ftlup(x, table, values)
    except (TableOutOfOrder, TableNotANumber):
        return np.full_like(x, np.nan)


def altitudes(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn where an altitude of group 7 contradicts the position on a spherical Earth."""
    path = job.trajectory
    x, y, z = path.position_ft.T
    radius = path.origin_radius_kft * 1000.0
    above = np.sqrt((radius + z) ** 2 + x**2 + y**2) - SEA_LEVEL_KFT * 1000.0
    for row in np.flatnonzero(np.abs(path.altitude_ft - above) > ALTITUDE_FT):
        message = (
            f"altitude {decimal_text(path.altitude_ft[row], 1)} ft; "
            f"X, Y, Z give {decimal_text(above[row], 1)} ft on a spherical Earth"
        )
        yield locations.warning(7, int(row), "H", message)


def focal_length(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn of a focal length that is not positive: no image has one."""
    if job.camera.focal_length_mm <= 0.0:  # NaN is an error that is told already
        message = (
            f"a focal length of {job.camera.focal_length_mm:g} mm: that of a camera is above 0"
        )
        yield locations.warning(8, 0, "CC", message)


def ignored_all(job: Job, locations: CardLocations) -> Iterator[Finding]:
    """Warn where group 12 names every landmark, because the program then does not ignore all."""
    everywhere = job.ignored.everywhere[job.ignored.everywhere > 0]
    if len(everywhere) and among(job.readings.points.landmark, everywhere).all():
        message = "every landmark is to be ignored: the last two of each frame are kept"
        yield locations.warning(12, 0, "IOUT", message)


# The Earth of 1974: is it good enough for a deck's distances and heights?
#
# The program's Earth is a sphere, its landmarks are up to 33 m beside their latitude,
# and its vertical is perpendicular to the sphere. So a landmark is seen from the
# camera in a slightly wrong direction relative to the local axes, the more so the nearer it is.
# Let d be the unit vector to a landmark on that Earth, and d + e the one on the
# ellipsoid, each in the local axes of its own Earth. The small rotation w that
# brings all d of a frame as near to d + e as it can, by least squares, is
#
#     sum(1 - d d') w = sum(d x e),
#
# and its length is the angle that the 1974 Earth costs the frame's attitude. It depends on
# the cards' positions alone, not on the readings.

EARTH_GROUPS = (5, 6, 7, 8, 9, 11, 12, BASIC_DATA.number)
"""The groups that must have been read to ask again what the Earth of 1974 costs."""

TOGETHER = 1000  # frames whose jobs are asked together
LANDMARKS_AS_A_FRAME = 16  # a job holds the landmarks of all earlier jobs too
LIMIT_DEG = 0.1
"""Twice what the original's Earth costs in the flights of its report, .01 to .05 degree."""

ELLIPSOID = Fixes(frozenset({Fix.EARTH}))


class EarthOf1974:
    """Warnings where the program's Earth turns the attitude by more than `LIMIT_DEG`.

    Short jobs are gathered: together they take a tenth of the time.
    """

    def __init__(self) -> None:
        self._jobs: list[tuple[Job, CardLocations, list[Finding]]] = []
        self._frames = 0

    def add(self, job: Job, locations: CardLocations, found: list[Finding]) -> None:
        """Check a job, now or with later ones; `found` takes the warning."""
        self._jobs.append((job, locations.now(BASIC_DATA.number), found))
        self._frames += len(job.readings.frame) + len(job.landmarks.number) // LANDMARKS_AS_A_FRAME
        if self._frames >= TOGETHER:
            self.end()

    def end(self) -> None:
        """Check all jobs that have been gathered."""
        jobs, self._jobs, self._frames = self._jobs, [], 0
        texts = earth_texts([job for job, _, _ in jobs]) if jobs else []
        for (job, locations, found), (message, frame) in zip(jobs, texts, strict=True):
            if message:
                row = int(first_rows(job)[frame])
                found.append(locations.warning(BASIC_DATA.number, row, "", message))


def earth_texts(jobs: Sequence[Job]) -> list[tuple[str, int]]:
    """Warn of each job whose attitude the program's Earth turns by more than `LIMIT_DEG`.

    Returns:
        Of each the warning, empty if there is none, and the index of the frame turned most.
    """
    try:
        cost = earth_cost(*jobs)
    except (TableOutOfOrder, TableNotANumber, UndefinedLandmark):  # errors of their own
        return [("", 0)] if len(jobs) == 1 else [earth_texts([one])[0] for one in jobs]
    ends = np.cumsum([len(one.readings.frame) for one in jobs])[:-1]
    each = zip(*(np.split(one, ends) for one in cost), strict=True)
    return [_earth_text(job, *own) for job, own in zip(jobs, each, strict=True)]


def _earth_text(
    job: Job, angle_deg: Floats, shift_m: Floats, distance_km: Floats
) -> tuple[str, int]:
    angle = np.nan_to_num(angle_deg, posinf=0.0)
    k, count = int(angle.argmax()), int((angle > LIMIT_DEG).sum())
    if not count:
        return "", 0
    which = f"frame {job.readings.frame[k]}"
    frames = which if count == 1 else f"{count} frames, most of all in {which}"
    message = (
        f"the spherical Earth of 1974 turns the attitude by {decimal_text(angle[k], 2)} degrees in "
        f"{frames}: it displaces the landmarks by {decimal_text(shift_m[k], 1)} m against the "
        f"camera, {decimal_text(distance_km[k], 2)} km away; run the deck with --fix earth"
    )
    return message, k


@np.errstate(all="ignore")
def earth_cost(*jobs: Job) -> tuple[Floats, Floats, Floats]:
    """Estimate the attitude error of every frame from the program's Earth in the place of WGS 84.

    Returns:
        The rotation of each frame's attitude (F,), degrees, the frames of all jobs one after the
        other; how far its landmarks are displaced against the camera, on average (F,), m; and
        their distance from it, on average (F,), km. NaN where that cannot be computed.

    Raises:
        VopdError: where a table is out of order, or a landmark is not defined
    """
    film = frames_of(jobs)
    frame, count = film.of, film.nj
    time_s = ftlup_each(film.readings.frame.astype(np.float64), film.table, film.clock)
    there_ft = ftlup_each(time_s, film.table, film.position)[frame]
    check_landmarks(film)

    origin = film.origin[:, frame]
    thj, phij, rj = (part[film.card] for part in group_9(film.landmarks, NO_FIXES))
    old = directions(origin, NO_FIXES, there_ft, thj, phij, rj)
    thj, phij, rj = (part[film.card] for part in group_9(film.landmarks, ELLIPSOID))
    change = directions(origin, ELLIPSOID, there_ft, thj, phij, rj) - old

    def summed(values: Floats) -> Floats:
        """Add up values of the landmarks (N, ...) in each frame."""
        columns = values.reshape(len(values), int(np.prod(values.shape[1:]))).T
        total = [np.bincount(frame, one, len(count)) for one in columns]
        return np.asarray(np.stack(total, axis=1).reshape(len(count), *values.shape[1:]), float)

    normal = summed(np.eye(3) - old[:, :, None] * old[:, None, :])
    rotation = (pseudo_inverse(normal) @ summed(np.cross(old, change))[..., None])[..., 0]
    away_km = landmarks_earth_fixed(thj, phij, rj) - earth_fixed(origin, ELLIPSOID, there_ft)
    distance = np.linalg.norm(away_km, axis=1)
    shift = np.linalg.norm(change, axis=1) * distance * 1000.0
    angle_deg = np.degrees(np.linalg.norm(rotation, axis=1))
    return angle_deg, summed(shift) / count, summed(distance) / count


# The rules: conditions in a job that the original did not report

Rule = Callable[[Job, CardLocations], Iterator[Finding]]
"""Takes a job and the locations of its cards, and yields findings at the cards concerned."""

CARD_RULES: tuple[tuple[Rule, tuple[int, ...]], ...] = (
    (fiducials, (BASIC_DATA.number,)),
    (frame_order, (BASIC_DATA.number,)),
    (unused_landmarks, (9,)),
    (signs, (9,)),
    (altitudes, (7, 8)),
    (focal_length, (8,)),
    (ignored_all, (12,)),
    (behind_lists, (5, 10, 12)),
)
"""Rules about cards, beside `reading_spread`, and the groups that must have been read to ask
each again. A run asks them too."""

RUN_RULES: tuple[tuple[Rule, tuple[int, ...]], ...] = (
    (copied_readings, (BASIC_DATA.number,)),
    (too_few_landmarks, (5, 12, BASIC_DATA.number)),
    (lens_reach, (1, BASIC_DATA.number)),
    (tables_in_order, (1, 4, 6, 7, 11, 12)),
    (tables_span, (4, 6, 7)),
)
"""Rules about conditions that a run notices in its results, by frames and with its fixes."""
