"""CCSDS Attitude Comprehensive Message, KVN, of 504.0-B-2: attitudes with their variances.

Keywords stand in the order of tables 5-2, 5-3, 5-4 and 5-6. A covariance has the three
elements of its diagonal only (5.3.7.6). Of several jobs, the blocks of one have the same
identification in ATT_BASIS_ID and COV_BASIS_ID.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.history import History
from vopd.export.ccsds import (
    DECIMALS,
    FRAME_A,
    FRAME_B,
    comment,
    encoded,
    header,
    job_text,
    quaternions_scalar_last,
    segments_in_order,
    stated_comments,
    text_value,
)
from vopd.export.file_request import FileRequest, utc
from vopd.export.times import TimedAttitude
from vopd.findings import Finding, Report

STATED = ("sigmas", "common errors", "reading sigma")
VARIANCES = (
    "variances of small turns about forward, right and down of SC_BODY_1, deg2, all "
    "components together; the tables (csv, jsonl, npz, parquet) have the whole matrices, and the "
    "part whose errors are the same in all frames"
)


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the message: an attitude block and a covariance block for each job.

    Times are seconds after EPOCH_TZERO, which is time zero of the jobs.

    Args:
        histories: the jobs
        request: epoch and names
        report: is given warnings: frames that are left out, frames without finite
            variances, and jobs that overlap in time
    """
    segments = segments_in_order(histories, request, report)
    finite = [_finite(segment, report) for segment in segments]
    comments = stated_comments(histories, request, "sigmas", "common errors", "reading sigma")
    lines = [*header("CCSDS_ACM_VERS", 2, comments, request), ""]
    lines += _metadata(segments, finite, request)
    names = [f"JOB {k}" for k in range(1, len(segments) + 1)] if len(segments) > 1 else [""]
    for segment, name in zip(segments, names, strict=True):
        lines += ["", *_attitudes(segment, name)]
    for segment, known, name in zip(segments, finite, names, strict=True):
        if known.any():
            lines += ["", *_covariances(segment, known, name)]
    return encoded(lines)


def _finite(segment: TimedAttitude, report: Report) -> Bools:
    """The frames of a segment that have finite variances (T,); warns of the others."""
    known = np.isfinite(_variances(segment)).all(axis=1)
    e, about = segment.history.estimate, segment.history.about
    for k in segment.frames[~known]:
        message = f"frame {e.frame_label(k)} has no finite variances: it is left out of COV"
        report(Finding(message, about.source, job=about.job, severity="warning"))
    return np.asarray(known)


def _variances(segment: TimedAttitude) -> Floats:
    """Of small turns about forward, right, down, (T, 3) deg2."""
    covariance = segment.history.uncertainty.covariance_deg2[segment.frames]
    return np.diagonal(covariance, axis1=1, axis2=2)


def _metadata(
    segments: Sequence[TimedAttitude], finite: Sequence[Bools], request: FileRequest
) -> Iterator[str]:
    assert request.epoch is not None
    blocks = ["ATT" for _ in segments] + ["COV" for known in finite if known.any()]
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
