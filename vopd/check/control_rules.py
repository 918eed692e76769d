"""Checks of the control cards: tables, landmarks and what is ignored.

Every rule is given a job, the locations of its cards, and the limit of the
spread of readings that was asked for; it yields findings.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vopd.arrays import Floats, Ints, among
from vopd.check.card_locations import CardLocations, decimal_text
from vopd.findings import Finding
from vopd.job import Job
from vopd.program.earth import SEA_LEVEL_KFT
from vopd.program.ftlup import TableNotANumber, TableOutOfOrder, check_order, ftlup
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run

ALTITUDE_FT = 500.0  # H against Z: maps, the geoid and a round Earth agree to less


def unused_landmarks(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn of landmarks of group 9 that are in no frame."""
    given = len(job.ignored.everywhere)
    shown = set(job.readings.points.landmark.tolist())
    for row, number in enumerate(job.landmarks.number[-given:].tolist()):
        if number not in shown:
            yield locations.warning(9, row, "ITGT", f"landmark {number} is in no frame")


def signs(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
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


def tables_in_order(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
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
        what = f"{table[row]:g} does not exceed {table[row - 1]:g}"
        stops = _stops_a_run(job, label)
        words = "the run would stop here" if stops else "no frame uses this table"
        finding = locations.warning(label, row, field, f"{what}: {words}")
        yield replace(finding, severity="error" if stops else "warning")


def _first_out_of_order(table: Floats | Ints) -> int | None:
    """Index of the first value that does not exceed the one before; None where there is none."""
    values = np.asarray(table, dtype=np.float64)
    if len(values) < 2 or not np.isfinite(values).all():
        return None
    try:
        check_order(1, values, values)
    except TableOutOfOrder as error:
        return error.position - 1
    return None


def _stops_a_run(job: Job, group: int) -> bool:
    """Whether a run of the job stops at the table of this group, were the others in order."""
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
        stop = run(others).stop
    except (UndefinedLandmark, TableNotANumber):  # errors of their own, which end a run before
        return True
    return stop is not None and stop.group == group


def tables_span(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
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
                frames = "1 frame is" if count == 1 else f"{count} frames are"
                message = f"{frames} outside this table, which is extrapolated: "
                yield locations.warning(label, row, field, f"{message}{what} {extreme:.8g}")


def _look_up(x: Floats, table: Floats | Ints, values: Floats) -> Floats:
    """Interpolated values; NaN where the table cannot be used, which is reported elsewhere."""
    try:
        return ftlup(x, 1, table, values)
    except (TableOutOfOrder, TableNotANumber):
        return np.full_like(x, np.nan)


def altitudes(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
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


def ignored_all(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn where group 12 names every landmark, because the program then does not ignore all."""
    everywhere = job.ignored.everywhere[job.ignored.everywhere > 0]
    if len(everywhere) and among(job.readings.points.landmark, everywhere).all():
        message = "every landmark is to be ignored: the last two of each frame are kept"
        yield locations.warning(12, 0, "IOUT", message)
