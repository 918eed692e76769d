"""CCSDS Attitude Ephemeris Message, KVN: version 2 (504.0-B-2) or version 1 (504.0-B-1).

The quaternion "from frame A to frame B" carries the axes of A into those of B
(504.0-B-2, annex F2), as `vopd.attitude.quaternion` has it, with the scalar
last. Keywords stand in the order of tables 4-2 and 4-3 of either issue.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.export.file_request import FileRequest, statements, title, utc
from vopd.export.timed_attitude import TimedAttitude, continuous, timed_attitudes
from vopd.findings import Finding, Report, VopdError

FRAME_A, FRAME_B = "NED", "SC_BODY_1"  # the registries have no name for north, east, down
QUATERNION = (
    "NED to SC_BODY_1, Hamilton, columns Q1 Q2 Q3 QC, scalar last; components in NED are "
    "q v q* of those in SC_BODY_1; neighbours have signs that make them near, QC may be negative"
)
FRAMES = {"from frame": f"REF_FRAME_A, {FRAME_A}", "to frame": f"REF_FRAME_B, {FRAME_B}"}
"""What the comments call the conventions of the two frames."""

WIDTH = 120  # a line may have 254 characters
DECIMALS = 10


def text_value(text: str) -> str:
    """Convert a text for an AEM, where values may not mix capitals and small letters (6.8.6).

    An empty text becomes UNKNOWN.

    Raises:
        VopdError: unless it is printable ASCII of 200 characters at most
    """
    value = " ".join(text.split()) or "UNKNOWN"
    if not (value.isascii() and value.isprintable() and len(value) <= 200):
        raise VopdError(f"{text!r}: a text in an AEM has at most 200 ASCII characters")
    return value if value.islower() else value.upper()


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the message: one segment for each job, in the order of their first times.

    Args:
        histories: the jobs
        request: epoch, names, version
        report: is given warnings: frames that are left out, and jobs that overlap in
            time, of which a reader cannot tell which one holds
    """
    if request.aem_version not in (1, 2):
        raise VopdError(f"AEM version {request.aem_version}: the versions are 1 and 2")
    segments = sorted(
        timed_attitudes(histories, request.epoch, report), key=lambda one: one.microseconds[0]
    )
    latest = segments[0]
    for one in segments[1:]:
        first = one.microseconds[0]
        if first < latest.microseconds[-1] or first == latest.microseconds[0]:
            report(_overlap(latest, one))
        latest = max(latest, one, key=lambda two: two.microseconds[-1])
    lines = [*_header(histories, request)]
    for segment in segments:
        lines += ["", *_segment(segment, request)]
    return ("\n".join(lines) + "\n").encode("ascii", "backslashreplace")


def _header(histories: Sequence[History], request: FileRequest) -> Iterator[str]:
    stated = statements(histories, request, quaternion=QUATERNION)
    yield f"CCSDS_AEM_VERS = {request.aem_version}.0"
    source = histories[0].about.words.source
    for key in ("program", source, "fixes", *FRAMES, "quaternion", "position", "time"):
        if key in stated:
            yield from _comment(f"{FRAMES.get(key, key)}: {stated[key]}")
    yield f"CREATION_DATE = {utc(request.created, 0)[:19]}"
    yield f"ORIGINATOR = {text_value(request.originator)}"


def _segment(segment: TimedAttitude, request: FileRequest) -> Iterator[str]:
    assert request.epoch is not None
    epochs = [utc(request.epoch, moment) for moment in segment.microseconds]
    history = segment.history
    yield "META_START"
    yield from _comment(f"{history.about.words.source} {history.about.label}: {title(history)}")
    yield f"OBJECT_NAME = {text_value(request.object_name)}"
    yield f"OBJECT_ID = {text_value(request.object_id)}"
    yield "CENTER_NAME = EARTH"
    yield f"REF_FRAME_A = {FRAME_A}"
    yield f"REF_FRAME_B = {FRAME_B}"
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
    for epoch, row in zip(epochs, _scalar_last(segment), strict=True):
        yield epoch + "".join(f" {q:.{DECIMALS}f}" for q in row)
    yield "DATA_STOP"


def _scalar_last(segment: TimedAttitude) -> Floats:
    """(T, 4) x y z w to the decimals written, without the -0 that the standard rules out."""
    q = np.roll(continuous(segment.quaternion), -1, axis=1)
    return np.asarray(np.round(q, DECIMALS) + 0.0)


def _comment(text: str) -> list[str]:
    ascii_text = text.encode("ascii", "backslashreplace").decode()
    return [f"COMMENT {line}" for line in textwrap.wrap(ascii_text, WIDTH - 8)]


def _overlap(one: TimedAttitude, other: TimedAttitude) -> Finding:
    return Finding(
        f"overlaps {one.history.about.label} in time: readers cannot tell which one applies",
        deck=other.history.about.source,
        job=other.history.about.job,
        severity="warning",
    )
