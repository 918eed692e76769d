"""CCSDS Attitude Ephemeris Message, KVN: version 2 (504.0-B-2) or version 1 (504.0-B-1).

Keywords stand in the order of tables 4-2 and 4-3 of either issue.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from vopd.attitude.history import History
from vopd.export.ccsds_message import (
    DECIMALS,
    FRAME_A,
    FRAME_B,
    encoded,
    header,
    job_comment,
    quaternions_scalar_last,
    segments_in_order,
    text_value,
)
from vopd.export.file_request import FileRequest, utc
from vopd.export.timed_attitude import TimedAttitude
from vopd.findings import Report, VopdError


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
    segments = segments_in_order(histories, request, report)
    lines = [*header("CCSDS_AEM_VERS", request.aem_version, histories, request)]
    for segment in segments:
        lines += ["", *_segment(segment, request)]
    return encoded(lines)


def _segment(segment: TimedAttitude, request: FileRequest) -> Iterator[str]:
    assert request.epoch is not None
    epochs = [utc(request.epoch, moment) for moment in segment.microseconds]
    yield "META_START"
    yield from job_comment(segment.history)
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
    for epoch, row in zip(epochs, quaternions_scalar_last(segment), strict=True):
        yield epoch + "".join(f" {q:.{DECIMALS}f}" for q in row)
    yield "DATA_STOP"
