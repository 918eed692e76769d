"""Every line of an AEM and an ACM of two frames, whose attitudes are worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.estimates import HALF, REQUEST, level_flight, text_of


def without_head(text: str) -> list[str]:
    """The lines but the comments before the date of making, which tests/export/test_statements.py
    holds."""
    before, _, after = text.partition("CREATION_DATE")
    return [before.splitlines()[0], *("CREATION_DATE" + after).splitlines()]


AEM_META = [
    "META_START", "COMMENT flight hand.toml, job 1: a flight by hand", "OBJECT_NAME = THE KITE",
    "OBJECT_ID = 2026-001A", "CENTER_NAME = EARTH", "REF_FRAME_A = NED",
    "REF_FRAME_B = SC_BODY_1", "TIME_SYSTEM = UTC", "START_TIME = 2026-05-01T09:00:10.000000",
    "STOP_TIME = 2026-05-01T09:00:12.500000", "ATTITUDE_TYPE = QUATERNION", "META_STOP",
]  # fmt: skip
AEM_DATA = [
    "", "DATA_START",
    "2026-05-01T09:00:10.000000 0.0000000000 0.0000000000 0.0000000000 1.0000000000",
    f"2026-05-01T09:00:12.500000 0.0000000000 0.0000000000 {HALF} {HALF}", "DATA_STOP",
]  # fmt: skip


@pytest.mark.parametrize("version", [1, 2])
def test_an_aem(version: int) -> None:
    """Version 1 has two lines more: the direction, and where the scalar is."""
    text, said = text_of("aem", request=replace(REQUEST, aem_version=version))
    meta = list(AEM_META)
    if version == 1:
        meta.insert(meta.index("TIME_SYSTEM = UTC"), "ATTITUDE_DIR = A2B")
        meta.insert(-1, "QUATERNION_TYPE = LAST")
    assert without_head(text) == [
        f"CCSDS_AEM_VERS = {version}.0", "CREATION_DATE = 2027-06-05T04:03:02",
        "ORIGINATOR = WHO MADE IT", "", *meta, *AEM_DATA,
    ]  # fmt: skip
    assert said == [] and text.endswith("DATA_STOP\n")
    assert max(map(len, text.splitlines())) <= 120


def test_segments_of_an_aem_are_parted_and_in_order_of_time() -> None:
    text, said = text_of("aem", level_flight(1, 50.0), level_flight(2, 10.0))
    named = [line for line in text.splitlines() if line.startswith("COMMENT flight hand.toml, job")]
    assert named == [f"COMMENT flight hand.toml, job {job}: a flight by hand" for job in (2, 1)]
    assert text.count("\n\nMETA_START\n") == 2 and said == []


OVERLAP = "hand.toml: job {}: overlaps hand.toml, job {} in time: readers cannot tell which one "


@pytest.mark.parametrize(
    ("starts", "told"),
    [
        ((0.0, 2.5), []), ((0.0, 2.499999), [(2, 1)]), ((0.0, 0.0), [(2, 1)]),
        ((2.499999, 0.0), [(1, 2)]), ((0.0, 1.0, 2.5), [(2, 1), (3, 2)]),
        ((0.0, 3.0, 6.0), []), ((6.0, 3.0, 4.0), [(3, 2), (1, 3)]),
    ],
)  # fmt: skip
@pytest.mark.parametrize("form", ["aem", "acm"])
def test_jobs_that_overlap_are_told(
    form: str, starts: tuple[float, ...], told: list[tuple[int, int]]
) -> None:
    """Each by the job that lasts longest before it; to end where the next begins is no overlap."""
    _, said = text_of(form, *(level_flight(job, start) for job, start in enumerate(starts, 1)))
    overlaps = [one for one in said if "overlaps" in one]
    assert overlaps == [OVERLAP.format(*pair) + "applies" for pair in told]


ACM = [
    "CREATION_DATE = 2027-06-05T04:03:02", "ORIGINATOR = WHO MADE IT", "",
    "META_START", "OBJECT_NAME = THE KITE", "INTERNATIONAL_DESIGNATOR = 2026-001A",
    "TIME_SYSTEM = UTC", "EPOCH_TZERO = 2026-05-01T09:00:00.000000",
    "ACM_DATA_ELEMENTS = ATT, COV", "START_TIME = 10.000000", "STOP_TIME = 12.500000",
    "META_STOP", "",
    "ATT_START", "COMMENT flight hand.toml, job 1: a flight by hand",
    "ATT_BASIS = DETERMINED_GND", "REF_FRAME_A = NED", "REF_FRAME_B = SC_BODY_1",
    "NUMBER_STATES = 4", "ATT_TYPE = QUATERNION",
    "10.000000 0.0000000000 0.0000000000 0.0000000000 1.0000000000",
    f"12.500000 0.0000000000 0.0000000000 {HALF} {HALF}", "ATT_STOP", "",
    "COV_START",
    "COMMENT variances of small turns about forward, right and down of SC_BODY_1, deg2, all "
    "components together; the tables",
    "COMMENT (csv, jsonl, npz, parquet) have the whole matrices, and the part whose errors are the "
    "same in all frames",
    "COV_BASIS = DETERMINED_GND", "COV_REF_FRAME = SC_BODY_1", "COV_TYPE = ANGLE",
    "10.000000 2.500000000e-01 4.000000000e-06 9.000000000e+02", "COV_STOP",
]  # fmt: skip


def test_an_acm() -> None:
    """The frame with an infinite variance is told, and left out of the variances only."""
    text, said = text_of("acm")
    assert without_head(text) == ["CCSDS_ACM_VERS = 2.0", *ACM]
    told = "hand.toml: job 1: frame DJI_0001.JPG has no finite variances: it is left out of COV"
    assert said == [told]
    for name in ("sigmas", "common errors", "reading sigma"):
        assert f"COMMENT {name}: " in text


def test_an_acm_of_several_jobs() -> None:
    """From the first start to the last stop, in whatever order the jobs are given."""
    none = level_flight(3, 30.0)
    wide = replace(none.uncertainty, covariance_deg2=np.full((2, 3, 3), np.nan))
    text, said = text_of(
        "acm", level_flight(1, 50.0), replace(none, uncertainty=wide), level_flight(2, 10.0)
    )
    lines = text.splitlines()
    assert "ACM_DATA_ELEMENTS = ATT, ATT, ATT, COV, COV" in lines
    assert "START_TIME = 10.000000" in lines and "STOP_TIME = 52.500000" in lines
    named = [line for line in lines if "_ID = JOB" in line]
    assert named == [
        *(f"ATT_BASIS_ID = JOB {k}" for k in (1, 2, 3)), "COV_BASIS_ID = JOB 1",
        "COV_BASIS_ID = JOB 3",
    ]  # fmt: skip
    assert len(said) == 4 and text.count("\n\nATT_START\n") == 3


def test_frames_in_another_order_keep_their_variances_and_turns() -> None:
    """The second frame comes 2.5 s before the first."""
    lines = text_of("acm", level_flight(time_s=np.array([12.5, 10.0])))[0].splitlines()
    rows = [line for line in lines if line.startswith("1")]
    assert rows == [
        f"10.000000 0.0000000000 0.0000000000 {HALF} {HALF}",
        "12.500000 0.0000000000 0.0000000000 0.0000000000 1.0000000000",
        "12.500000 2.500000000e-01 4.000000000e-06 9.000000000e+02",
    ]


@pytest.mark.parametrize("form", ["aem", "acm"])
def test_what_a_message_states_of_its_frames(form: str) -> None:
    lines = text_of(form)[0].splitlines()
    words = " ".join(line.removeprefix("COMMENT ") for line in lines)
    for sentence in (
        "REF_FRAME_A, NED: north, east, down at the vehicle; down along the ellipsoid's normal",
        "REF_FRAME_B, SC_BODY_1: vehicle body: x forward, y right, z down",
        "quaternion: columns Q1 Q2 Q3 QC, scalar last; it is the rotation that carries the axes of "
        "NED into those of SC_BODY_1; rotating a vector's components in SC_BODY_1 by it gives its "
        "components in NED; neighbours have signs that make them near, QC may be negative",
    ):
        assert sentence in words
