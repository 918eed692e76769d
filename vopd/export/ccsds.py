"""CCSDS attitude messages, KVN: AEM and ACM."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.history import History
from vopd.export import FileRequest, has_date, statements, title, utc
from vopd.findings import Finding, Report, VopdError

# The attitudes of a job in order of time, each time once, for formats that need dates.

LATEST_S = 1e12  # no two dates are this many seconds apart
FARTHEST_M = 1e15  # a tenth of a light year: nothing that flew


NO_TIME = (
    "; no time is known: [picks] times or frame_rate_hz bring them, and geo.txt, images.txt and "
    ".opk.csv need none"
)


class TimedAttitude(NamedTuple):
    """The frames of one job that have an attitude, a time and a position, T of them."""

    history: History
    frames: Ints  # (T,) their indices in the history
    microseconds: list[int]  # since time zero, increasing
    quaternion: Floats  # (T, 4) w x y z, local north-east-down to body
    position: Floats  # (T, 3) longitude and latitude, degrees, and altitude, metres


def timed_attitudes(
    histories: Sequence[History], epoch: datetime | None, report: Report
) -> list[TimedAttitude]:
    """Sort the attitudes of each job by time; jobs without one are left out.

    Of frames with the same time, to the microsecond, the first in the source is kept.

    Args:
        histories: the jobs
        epoch: the moment of time zero; frames that have no date then are left out
        report: is given a warning for each frame that is left out

    Raises:
        VopdError: where no frame of any job is left
    """
    found = [timed_attitude(h, epoch, report) for h in histories]
    left = [one for one in found if len(one.frames)]
    if not left:
        timeless = not any(np.isfinite(h.estimate.time_s).any() for h in histories)
        message = "no frame has an attitude, a time and a position" + NO_TIME * timeless
        raise VopdError(f"{histories[0].about.source}: {message}" if histories else message)
    return left


def timed_attitude(history: History, epoch: datetime | None, report: Report) -> TimedAttitude:
    """Sort the attitudes of one job by time, possibly none; arguments as `timed_attitudes`."""
    e = history.estimate
    time_s, here = e.time_s, e.position
    altitude_m = here.altitude * e.units.metres_per_length
    position = np.stack([here.longitude_deg, here.latitude_deg, altitude_m], axis=1)
    known = history.has_attitude & np.isfinite(time_s) & (np.abs(position) < FARTHEST_M).all(axis=1)
    known &= np.isfinite(here.north_east_down).all(axis=(1, 2))
    known &= np.isfinite(history.quaternion).all(axis=1)
    whole = np.flatnonzero(known)
    order = whole[np.argsort(time_s[whole], kind="stable")]
    kept: dict[int, int] = {}
    for k in order.tolist():
        if abs(time_s[k]) > LATEST_S or not _dated(epoch, moment := round(time_s[k] * 1e6)):
            zero = "" if epoch is None else f" after {utc(epoch, 0)[:19]}Z"
            why = f"its time of {time_s[k]:g} s{zero} is outside the years 1 to 9999"
            report(_left_out(history, k, why))
        elif kept.setdefault(moment, k) != k:
            report(_left_out(history, k, f"it has the time of row {kept[moment] + 1}"))
    frames = np.array(list(kept.values()), dtype=np.int64)
    return TimedAttitude(history, frames, list(kept), history.quaternion[frames], position[frames])


def _dated(epoch: datetime | None, microseconds: int) -> bool:
    return epoch is None or has_date(epoch, microseconds)


def _left_out(history: History, k: int, why: str) -> Finding:
    label = history.estimate.frame_label(k)
    return history.about.warning(f"frame {label}, row {k + 1}, is left out: {why}")


def continuous(quaternion: Floats) -> Floats:
    """Choose the signs of quaternions so that each is close to the one before it.

    q and -q are one attitude; a reader that interpolates components needs
    neighbours with the same sign. The first keeps its sign.

    Args:
        quaternion: w x y z, (T, 4)
    """
    turned = (quaternion[1:] * quaternion[:-1]).sum(axis=1) < 0.0
    sign = np.cumprod(np.append(1.0, np.where(turned, -1.0, 1.0))[: len(quaternion)])
    return np.asarray(quaternion * sign[:, None])


# What the two CCSDS attitude messages of 504.0-B share: AEM and ACM, in KVN.
#
# The quaternion "from frame A to frame B" carries the axes of A into those of B
# (504.0-B-2, annex F2), as `vopd.geometry.rotations` has it, with the scalar last.

FRAME_A, FRAME_B = "NED", "SC_BODY_1"  # the registries have no name for north, east, down
QUATERNION = (
    "columns Q1 Q2 Q3 QC, scalar last; it is the rotation that carries the axes of NED into those "
    "of SC_BODY_1; rotating a vector's components in SC_BODY_1 by it gives its components in NED; "
    "neighbours have signs that make them near, QC may be negative"
)
FRAMES = {"from frame": f"REF_FRAME_A, {FRAME_A}", "to frame": f"REF_FRAME_B, {FRAME_B}"}
"""What the comments call the conventions of the two frames."""

WIDTH = 120  # a line of an AEM may have 254 characters
DECIMALS = 10


def text_value(text: str) -> str:
    """Convert a text for a message, where values may not mix capitals and small letters (6.8.6).

    An empty text becomes UNKNOWN.

    Raises:
        VopdError: unless it is printable ASCII of 200 characters at most
    """
    value = " ".join(text.split()) or "UNKNOWN"
    if not (value.isascii() and value.isprintable() and len(value) <= 200):
        raise VopdError(f"{text!r}: a text in a CCSDS message has at most 200 ASCII characters")
    return value if value.islower() else value.upper()


def segments_in_order(
    histories: Sequence[History], request: FileRequest, report: Report
) -> list[TimedAttitude]:
    """Sort the attitudes of the jobs by their first times.

    Args:
        histories: the jobs
        request: has the epoch
        report: is given warnings: frames that are left out, and jobs that overlap in
            time, of which a reader cannot tell which one holds
    """
    segments = sorted(
        timed_attitudes(histories, request.epoch, report), key=lambda one: one.microseconds[0]
    )
    latest = segments[0]
    for one in segments[1:]:
        first = one.microseconds[0]
        if first < latest.microseconds[-1] or first == latest.microseconds[0]:
            label = latest.history.about.label
            message = f"overlaps {label} in time: readers cannot tell which one applies"
            report(one.history.about.warning(message))
        latest = max(latest, one, key=lambda two: two.microseconds[-1])
    return segments


def stated_comments(
    histories: Sequence[History], request: FileRequest, *more: str
) -> dict[str, str]:
    """State the conventions in the header of a message: short names and a sentence each.

    Args:
        histories: the jobs
        request: has the epoch
        more: names of conventions that this message states besides those of every message
    """
    stated = statements(histories, request, quaternion=QUATERNION)
    source = histories[0].about.words.source
    names = ("program", source, "doubtful", "fixes", *FRAMES, "vertical", "quaternion", "position")
    return {FRAMES.get(key, key): stated[key] for key in (*names, "time", *more) if key in stated}


def header(
    keyword: str, version: int, comments: dict[str, str], request: FileRequest
) -> Iterator[str]:
    """Write the lines of the header: version, statements, date and originator.

    Args:
        keyword: that of the version
        version: of the message
        comments: short names and a sentence each
        request: date and originator
    """
    yield f"{keyword} = {version}.0"
    for key, sentence in comments.items():
        yield from comment(f"{key}: {sentence}")
    yield f"CREATION_DATE = {utc(request.created, 0)[:19]}"
    yield f"ORIGINATOR = {text_value(request.originator)}"


def job_text(history: History) -> str:
    """Name a job in a comment: source, number and title."""
    return f"{history.about.words.source} {history.about.label}: {title(history)}"


def quaternions_scalar_last(quaternion: Floats) -> Floats:
    """Round to x y z w, (T, 4), with the decimals written; no -0, which the standard forbids.

    Args:
        quaternion: w x y z, (T, 4)
    """
    return np.asarray(np.round(scalar_last(quaternion), DECIMALS) + 0.0)


def comment(text: str) -> list[str]:
    """Write comment lines with this text in ASCII."""
    ascii_text = text.encode("ascii", "backslashreplace").decode()
    return [f"COMMENT {line}" for line in textwrap.wrap(ascii_text, WIDTH - 8)]


def encoded(lines: Sequence[str]) -> bytes:
    """Encode the lines of a file."""
    return ("\n".join(lines) + "\n").encode("ascii", "backslashreplace")


# CCSDS Attitude Ephemeris Message, KVN: version 2 (504.0-B-2) or version 1 (504.0-B-1).
#
# Keywords stand in the order of tables 4-2 and 4-3 of either issue.


def render_aem(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the message: one segment for each job, in the order of their first times."""
    if request.aem_version not in (1, 2):
        raise VopdError(f"AEM version {request.aem_version}: the versions are 1 and 2")
    segments = segments_in_order(histories, request, report)
    comments = stated_comments(histories, request)
    assert request.epoch is not None
    made = []
    for one in segments:
        epochs = [utc(request.epoch, moment) for moment in one.microseconds]
        made.append(
            aem_segment(job_text(one.history), (FRAME_A, FRAME_B), epochs, one.quaternion, request)
        )
    return aem_message(comments, made, request)


def aem_message(
    comments: dict[str, str], segments: Sequence[Iterable[str]], request: FileRequest
) -> bytes:
    """Make a message of any segments.

    Args:
        comments: what the header states: short names and a sentence each
        segments: the lines of each (`aem_segment`), in the order of their first times
        request: names and version
    """
    lines = [*header("CCSDS_AEM_VERS", request.aem_version, comments, request)]
    for segment in segments:
        lines += ["", *segment]
    return encoded(lines)


def aem_segment(
    title: str,
    frames: tuple[str, str],
    epochs: Sequence[str],
    quaternion: Floats,
    request: FileRequest,
) -> Iterator[str]:
    """Write the lines of one segment of a message.

    Args:
        title: what it is of, for a comment
        frames: names of the frames A and B
        epochs: times in UTC, increasing
        quaternion: of frame A to frame B, w x y z, (T, 4)
        request: names and version
    """
    yield "META_START"
    yield from comment(title)
    yield f"OBJECT_NAME = {text_value(request.object_name)}"
    yield f"OBJECT_ID = {text_value(request.object_id)}"
    yield "CENTER_NAME = EARTH"
    yield f"REF_FRAME_A = {frames[0]}"
    yield f"REF_FRAME_B = {frames[1]}"
    if request.aem_version == 1:
        yield "ATTITUDE_DIR = A2B"
    yield "TIME_SYSTEM = UTC"
    yield f"START_TIME = {epochs[0]}"
    yield f"STOP_TIME = {epochs[-1]}"
    yield "ATTITUDE_TYPE = QUATERNION"
    if request.aem_version == 1:
        yield "QUATERNION_TYPE = LAST"
    yield "META_STOP"
    yield ""
    yield "DATA_START"
    for epoch, row in zip(epochs, quaternions_scalar_last(quaternion), strict=True):
        yield epoch + "".join(f" {q:.{DECIMALS}f}" for q in row)
    yield "DATA_STOP"


# CCSDS Attitude Comprehensive Message, KVN, of 504.0-B-2: attitudes with their variances.
#
# Keywords stand in the order of tables 5-2, 5-3, 5-4 and 5-6. A covariance has the three
# elements of its diagonal only (5.3.7.6). Of several jobs, the blocks of one have the same
# identification in ATT_BASIS_ID and COV_BASIS_ID.

STATED = ("sigmas", "common errors", "reading sigma")
VARIANCES = (
    "variances of small turns about forward, right and down of SC_BODY_1, deg2, all "
    "components together; the tables (csv, jsonl, npz, parquet) have the whole matrices, and the "
    "part whose errors are the same in all frames"
)


def render_acm(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the message: an attitude block and a covariance block for each job.

    Times are seconds after EPOCH_TZERO, which is time zero of the jobs.
    """
    segments = segments_in_order(histories, request, report)
    stated = [_stated(segment, report) for segment in segments]
    comments = stated_comments(histories, request, "sigmas", "common errors", "reading sigma")
    lines = [*header("CCSDS_ACM_VERS", 2, comments, request), ""]
    lines += _metadata(segments, stated, request)
    names = [f"JOB {k}" for k in range(1, len(segments) + 1)] if len(segments) > 1 else [""]
    for segment, name in zip(segments, names, strict=True):
        lines += ["", *_attitudes(segment, name)]
    for segment, known, name in zip(segments, stated, names, strict=True):
        if known.any():
            lines += ["", *_covariances(segment, known, name)]
    return encoded(lines)


def _stated(segment: TimedAttitude, report: Report) -> Bools:
    """Find the frames of a segment whose variances hold (T,), and warn of the others."""
    finite = np.isfinite(_variances(segment)).all(axis=1)
    misfit = segment.history.flags.raised["misfit"][segment.frames]
    e = segment.history.estimate
    for left, why in (
        (~finite, "has no finite variances"),
        (finite & misfit, "has the flag misfit, its residuals contradict its variances"),
    ):
        for k in segment.frames[left]:
            message = f"frame {e.frame_label(k)} {why}: it is left out of COV"
            report(e.about.warning(message))
    return np.asarray(finite & ~misfit)


def _variances(segment: TimedAttitude) -> Floats:
    """Take the variances of small turns about forward, right, down, (T, 3) deg2."""
    covariance = segment.history.uncertainty.covariance_deg2[segment.frames]
    return np.diagonal(covariance, axis1=1, axis2=2)


def _metadata(
    segments: Sequence[TimedAttitude], stated: Sequence[Bools], request: FileRequest
) -> Iterator[str]:
    assert request.epoch is not None
    blocks = ["ATT" for _ in segments] + ["COV" for known in stated if known.any()]
    yield "META_START"
    yield f"OBJECT_NAME = {text_value(request.object_name)}"
    yield f"INTERNATIONAL_DESIGNATOR = {text_value(request.object_id)}"
    yield "TIME_SYSTEM = UTC"
    yield f"EPOCH_TZERO = {utc(request.epoch, 0)}"
    yield f"ACM_DATA_ELEMENTS = {', '.join(blocks)}"
    yield f"START_TIME = {_seconds(min(one.microseconds[0] for one in segments))}"
    yield f"STOP_TIME = {_seconds(max(one.microseconds[-1] for one in segments))}"
    yield "META_STOP"


def _attitudes(segment: TimedAttitude, name: str) -> Iterator[str]:
    yield "ATT_START"
    yield from comment(job_text(segment.history))
    yield "ATT_BASIS = DETERMINED_GND"
    if name:
        yield f"ATT_BASIS_ID = {name}"
    yield f"REF_FRAME_A = {FRAME_A}"
    yield f"REF_FRAME_B = {FRAME_B}"
    yield "NUMBER_STATES = 4"
    yield "ATT_TYPE = QUATERNION"
    rows = quaternions_scalar_last(segment.quaternion)
    for moment, row in zip(segment.microseconds, rows, strict=True):
        yield _seconds(moment) + "".join(f" {q:.{DECIMALS}f}" for q in row)
    yield "ATT_STOP"


def _covariances(segment: TimedAttitude, known: Bools, name: str) -> Iterator[str]:
    yield "COV_START"
    yield from comment(VARIANCES)
    yield "COV_BASIS = DETERMINED_GND"
    if name:
        yield f"COV_BASIS_ID = {name}"
    yield f"COV_REF_FRAME = {FRAME_B}"
    yield "COV_TYPE = ANGLE"
    rows = zip(segment.microseconds, known.tolist(), _variances(segment), strict=True)
    for moment, finite, row in rows:
        if finite:
            yield _seconds(moment) + "".join(f" {variance:.9e}" for variance in row)
    yield "COV_STOP"


def _seconds(microseconds: int) -> str:
    return f"{microseconds / 1e6:.6f}"


# Attitudes with dates that come from no attitude history, such as those of star photographs.


class DatedAttitudes(NamedTuple):
    """T attitudes."""

    title: str  # what they are of
    moments: tuple[datetime, ...]  # their times, with time zone
    quaternion: Floats  # of frame A to frame B, w x y z, (T, 4), as in `vopd.geometry.rotations`
    frame_a: str  # its name in an AEM, such as ICRF
    frame_b: str  # its name in an AEM, such as SC_BODY_1
    stated: dict[str, str]  # what a file states about them: short names and a sentence each
    # longitude and latitude in degrees, height in metres; None: unknown
    place: tuple[float, float, float] | None = None
    # quaternion of Earth-fixed axes to the body, w x y z, (T, 4); None: unknown
    earth_fixed: Floats | None = None


def in_order(attitudes: DatedAttitudes, report: Report) -> DatedAttitudes:
    """Sort attitudes by time, each time once; the first of several is kept.

    Raises:
        VopdError: there is none
    """
    kept: dict[datetime, int] = {}
    for k, moment in enumerate(attitudes.moments):
        if moment in kept:
            text = f"attitude {k + 1} is left out: it has the time of {kept[moment] + 1}"
            report(Finding(text, source=attitudes.title, severity="warning"))
        else:
            kept[moment] = k
    if not kept:
        raise VopdError("there is no attitude with a date")
    order = [kept[moment] for moment in sorted(kept)]
    fixed = attitudes.earth_fixed
    return attitudes._replace(
        moments=tuple(sorted(kept)),
        quaternion=attitudes.quaternion[order],
        earth_fixed=None if fixed is None else fixed[order],
    )


def dated_aem(attitudes: DatedAttitudes, request: FileRequest, report: Report) -> bytes:
    """Make an AEM of one segment; arguments as `in_order`, and `request` for the names."""
    ordered = in_order(attitudes, report)
    stamps = [utc(moment, 0) for moment in ordered.moments]
    frames = ordered.frame_a, ordered.frame_b
    segment = aem_segment(ordered.title, frames, stamps, ordered.quaternion, request)
    return aem_message(ordered.stated, [segment], request)


def scalar_last(quaternion: Floats) -> Floats:
    """Convert to quaternions x y z w with signs that make neighbours near, (T, 4)."""
    return np.asarray(np.roll(continuous(quaternion), -1, axis=1))
