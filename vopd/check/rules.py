"""What a careful person would question in a job that the original accepted.

Each rule looks at one job and yields warnings at the cards they are about.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.groups import BASIC_DATA
from vopd.check.trace import Trace
from vopd.findings import Finding
from vopd.job import Job
from vopd.program.average import averages
from vopd.program.constants import factor
from vopd.program.earth import SEA_LEVEL_KFT
from vopd.program.ftlup import TableNotANumber, TableOutOfOrder, check_order, ftlup
from vopd.program.ignored import kept

SPREAD_IN = 0.010  # readings of one point: a few thousandths of an inch are a reader's care
RECTANGLE_IN = 0.050  # corners of a frame from their centre: film shrinks and tears
ALTITUDE_FT = 500.0  # H against Z: maps, geoid and a round Earth agree to less

Rule = Callable[[Job, Trace, float], Iterator[Finding]]


def reading_spread(job: Job, trace: Trace, spread_in: float) -> Iterator[Finding]:
    """Three readings of one point that differ by more than `spread_in` inches."""
    readings = job.readings
    per_frame = 12 + 3 * readings.present.sum(axis=1)
    starts = np.cumsum(per_frame) - per_frame
    for points, first in ((readings.fiducial_in, 0), (readings.landmark_in, 12)):
        spread = np.ptp(points, axis=2)
        for k, point in zip(*np.nonzero((spread > spread_in + 1e-9).any(axis=2)), strict=True):
            axis = int(spread[k, point].argmax())
            message = f"three readings of this point spread by {spread[k, point, axis]:.3f} in"
            row = int(starts[k] + first + 3 * point)
            yield trace.remark(BASIC_DATA.number, row, ("XSAVE", "YSAVE")[axis], message)


def fiducials(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """Four fiducials that form no rectangle: they are not equally far from their centre."""
    corners = job.readings.fiducial_in.mean(axis=2)
    away = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2)
    per_frame = 12 + 3 * job.readings.present.sum(axis=1)
    starts = np.cumsum(per_frame) - per_frame
    for k in np.flatnonzero(np.ptp(away, axis=1) > RECTANGLE_IN):
        message = (
            f"the fiducials of frame {job.readings.frame[k]} form no rectangle: "
            f"{away[k].min():.3f} to {away[k].max():.3f} in from their centre"
        )
        yield trace.remark(BASIC_DATA.number, int(starts[k]), "", message)


def frame_order(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """Frames that come twice, or before one with a smaller number."""
    frame = job.readings.frame
    per_frame = 12 + 3 * job.readings.present.sum(axis=1)
    starts = np.cumsum(per_frame) - per_frame
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
            yield trace.remark(BASIC_DATA.number, int(starts[k]), "IFRAM", message)


def unused_landmarks(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """Landmarks of group 9 that no frame shows."""
    given = len(job.ignored.everywhere)
    shown = np.unique(job.readings.landmark[job.readings.present])
    for row, number in enumerate(job.landmarks.number[-given:]):
        if number not in shown:
            yield trace.remark(9, row, "ITGT", f"landmark {number} is on no frame")


def signs(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """Degrees and minutes of a landmark that differ in sign."""
    given, marks = len(job.ignored.everywhere), job.landmarks
    for field, degrees, minutes in (
        ("THJMI", marks.longitude_deg, marks.longitude_min),
        ("PHIJMI", marks.latitude_deg, marks.latitude_min),
    ):
        for row in np.flatnonzero((degrees * minutes)[-given:] < 0):
            d, m = degrees[-given:][row], minutes[-given:][row]
            message = f"minutes {m:g} and degrees {d:g} differ in sign: read as {d + m / 60:.5f}"
            yield trace.remark(9, int(row), field, message)


def tables_in_order(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """Tables whose disorder would stop the run: these are errors."""
    tables: tuple[tuple[int, str, Floats | Ints], ...] = (
        (6, "IFRM", job.clock.frame),
        (7, "TX", job.trajectory.time_s),
        (1, "XRR", job.camera.lens_radius_mm),
        (4, "ALT", job.wind.altitude_ft),
    )
    for label, field, table in tables:
        values = np.asarray(table, dtype=np.float64)
        if len(values) < 2 or not np.isfinite(values).all():
            continue
        try:
            check_order(1, values, values)
        except TableOutOfOrder as error:
            row = error.position - 1
            message = (
                f"{values[row]:g} does not exceed {values[row - 1]:g}: the run would stop here"
            )
            yield replace(trace.remark(label, row, field, message), severity="error")


def tables_span(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """Time, trajectory and wind tables that end before the frames do: the rest is extrapolated."""
    clock, path = job.clock, job.trajectory
    frame = job.readings.frame.astype(np.float64)
    tables = (
        (6, "IFRM", "frame", clock.frame.astype(np.float64), frame),
        (7, "TX", "time", path.time_s, _look_up(frame, clock.frame, clock.time_s)),
    )
    time_s = tables[1][4]
    altitude = _look_up(time_s, path.time_s, path.altitude_ft)
    for label, field, what, table, values in (
        *tables,
        (4, "ALT", "altitude", job.wind.altitude_ft, altitude),
    ):
        if len(table) < 2 or not np.isfinite(values).all():
            continue
        for row, beyond, extreme in (
            (0, values < table[0], values.min()),
            (len(table) - 1, values > table[-1], values.max()),
        ):
            if beyond.any():
                message = f"{beyond.sum()} frames lie beyond: {what} {extreme:.8g}"
                yield trace.remark(label, row, field, message)


def _look_up(x: Floats, table: Floats | Ints, values: Floats) -> Floats:
    try:
        return ftlup(x, 1, table, values)
    except (TableOutOfOrder, TableNotANumber):  # said elsewhere
        return np.full_like(x, np.nan)


def altitudes(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """Altitudes of group 7 that disagree with the positions on a round Earth."""
    path = job.trajectory
    x, y, z = path.position_ft.T
    radius = path.origin_radius_kft * 1000.0
    above = np.sqrt((radius + z) ** 2 + x**2 + y**2) - SEA_LEVEL_KFT * 1000.0
    for row in np.flatnonzero(np.abs(path.altitude_ft - above) > ALTITUDE_FT):
        message = f"altitude {path.altitude_ft[row]:.1f} ft; X, Y, Z make it {above[row]:.1f} ft"
        yield trace.remark(7, int(row), "H", message)


def lens_reach(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """A lens table that does not reach the outermost landmark."""
    centre, point = averages(job.readings)
    used = kept(job.readings, job.ignored).used
    radius = np.linalg.norm((point - centre[:, None]) * factor, axis=2)
    table = job.camera.lens_radius_mm
    if used.any() and radius[used].max() > table.max():
        message = f"a landmark lies {radius[used].max():.2f} mm from the centre: extrapolated"
        yield trace.remark(1, int(table.argmax()), "XRR", message)


def ignored_all(job: Job, trace: Trace, _: float) -> Iterator[Finding]:
    """A group 12 that names so many landmarks that the program refuses to ignore them all."""
    everywhere = job.ignored.everywhere[job.ignored.everywhere > 0]
    named = np.isin(job.readings.landmark, everywhere) & job.readings.present
    left = (job.readings.present & ~named).sum(axis=1)
    if len(everywhere) and (left == 0).all():
        message = "every landmark is to be ignored: the last two of each frame are kept"
        yield trace.remark(12, 0, "IOUT", message)


RULES: tuple[tuple[Rule, tuple[int, ...]], ...] = (
    (reading_spread, (BASIC_DATA.number,)),
    (fiducials, (BASIC_DATA.number,)),
    (frame_order, (BASIC_DATA.number,)),
    (unused_landmarks, (9,)),
    (signs, (9,)),
    (tables_in_order, (1, 4, 6, 7)),
    (tables_span, (4, 6, 7)),
    (altitudes, (7,)),
    (lens_reach, (1, BASIC_DATA.number)),
    (ignored_all, (12,)),
)
"""Every rule, and the groups whose reading makes it worth asking again."""
