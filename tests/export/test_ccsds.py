"""AEM and ACM: read by other projects, held to the order of the standard's tables, line by line."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import ccsds_ndm
import numpy as np
import pytest
from gmat_run.parsers.aem_ephemeris import parse
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.attitude_files import (
    CASES_123,
    EPOCH,
    NAMES,
    VEHICLE,
    apart_deg,
    body_axes,
    column,
    printed,
    write,
)
from tests.kit.command import vopd
from tests.kit.estimates import HALF, REQUEST, level_flight, one_landmark, text_of
from tests.kit.histories import flight
from tests.tolerances import assert_close, within
from vopd.attitude.history import history
from vopd.export import FORMATS, FileRequest
from vopd.export.ccsds import text_value
from vopd.findings import Finding, VopdError
from vopd.flight.result import solve_flight

HILL = Path(__file__).parents[2] / "examples" / "hill"

ZERO = datetime(1974, 8, 27, 17, 30, tzinfo=UTC)
HEADER = ["CCSDS_AEM_VERS", "COMMENT*", "CREATION_DATE", "ORIGINATOR"]
META = [  # 504.0-B-2, table 4-3, the mandatory ones with a !
    *("META_START!", "COMMENT*", "OBJECT_NAME!", "OBJECT_ID!", "CENTER_NAME", "REF_FRAME_A!"),
    *("REF_FRAME_B!", "TIME_SYSTEM!", "START_TIME!", "USEABLE_START_TIME", "USEABLE_STOP_TIME"),
    *("STOP_TIME!", "ATTITUDE_TYPE!", "EULER_ROT_SEQ", "ANGVEL_FRAME", "INTERPOLATION_METHOD"),
    *("INTERPOLATION_DEGREE", "META_STOP!"),
]
META_1 = [  # 504.0-B-1, table 4-3; the scalar's place goes with quaternions
    *META[:7],
    "ATTITUDE_DIR!",
    *META[7:13],
    *("QUATERNION_TYPE!", "EULER_ROT_SEQ", "RATE_FRAME"),
    *META[15:],
]
RECORD = re.compile(r"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6})((?: -?\d\.\d{1,15}){4})")


def sequence(lines: list[str]) -> str:
    """The keywords of some lines, one after the other."""
    return " ".join(line.partition(" ")[0] for line in lines) + " "


def pattern(table: list[str]) -> re.Pattern[str]:
    """A table's keywords in their order, each as often as it may stand."""
    marks = {"!": "", "*": "*"}
    one = ["(?:" + key.rstrip("!*") + " )" + marks.get(key[-1], "?") for key in table]
    return re.compile("".join(one))


def held_to_the_standard(text: str, version: int) -> list[dict[str, str]]:
    """The metadata of every segment, once all that the standard asks of text and order holds."""
    lines = [line for line in text.splitlines() if line]
    assert text.isascii() and all(len(line) <= 254 and line.isprintable() for line in lines)
    start = lines.index("META_START")
    assert lines[0] == f"CCSDS_AEM_VERS = {version}.0"
    assert re.fullmatch(r"CCSDS_AEM_VERS (COMMENT )*CREATION_DATE ORIGINATOR ",
                        sequence(lines[:start]))  # fmt: skip
    segments = []
    while start < len(lines):
        meta = lines.index("META_STOP", start)
        stop = lines.index("DATA_STOP", meta)
        head = lines[start : meta + 1]
        assert pattern(META if version == 2 else META_1).fullmatch(sequence(head)), head
        pairs = (line.split(" = ") for line in head if " = " in line and line[:7] != "COMMENT")
        said = dict(pairs)
        assert all(value in (value.upper(), value.lower()) for value in said.values())
        assert lines[meta + 1] == "DATA_START"
        records = [RECORD.fullmatch(line) for line in lines[meta + 2 : stop]]
        epochs = [record[1] for record in records if record]
        assert len(epochs) == len(records) > 0
        assert epochs == sorted(set(epochs))  # increasing, none repeated
        assert (said["START_TIME"], said["STOP_TIME"]) == (epochs[0], epochs[-1])
        assert not re.search(r" -0\.0*(?: |$)", "\n".join(lines[meta:stop]), re.M)
        segments.append(said)
        start = stop + 1
    return segments


def read(path: Path, version: int) -> tuple[dict[str, Any], list[datetime], np.ndarray]:
    """What the other project's reader finds: metadata, epochs, quaternions in the file's order."""
    if version == 1:
        table = parse(path)
        epochs = [moment.to_pydatetime().replace(tzinfo=UTC) for moment in table["Epoch"]]
        return table.attrs, epochs, table[["Q1", "Q2", "Q3", "Q4"]].to_numpy()
    message = ccsds_ndm.Aem.from_file(str(path))
    message.validate(strict=True)
    (segment,) = message.segments
    names = [name for name in dir(segment.metadata) if not name.startswith("_")]
    epochs = [
        datetime.fromisoformat(text).replace(tzinfo=UTC)
        for text in segment.data.attitude_states_epochs
    ]
    found = {name: getattr(segment.metadata, name) for name in names}
    return found, epochs, np.asarray(segment.data.attitude_states_numpy)


@pytest.mark.parametrize("version", [2, 1])
@pytest.mark.parametrize("name", NAMES)
def test_another_reader_finds_the_listing_s_attitude(
    name: str, version: int, tmp_path: Path
) -> None:
    path = write(tmp_path, name, "a.aem", "--epoch", EPOCH, "--aem-version", str(version))
    held_to_the_standard(path.read_text(), version)
    said, epochs, quaternion = read(path, version)
    assert (said["ref_frame_a"], said["ref_frame_b"]) == ("NED", "SC_BODY_1")
    assert said["attitude_type"] == "QUATERNION"
    if version == 1:
        assert (said["attitude_dir"], said["quaternion_type"]) == ("A2B", "LAST")
    rows = sorted(printed(name), key=lambda row: row["time_s"])
    flown = [(epoch - ZERO).total_seconds() for epoch in epochs]
    assert_close("printed time", flown, column(rows, ["time_s"])[:, 0])
    euler = Rotation.from_quat(quaternion).as_euler("ZYX", degrees=True)
    assert_close("printed angle", apart_deg(euler, column(rows, VEHICLE)), 0.0)


def test_the_quaternion_is_the_standard_s_from_a_to_b(tmp_path: Path) -> None:
    """Annex F2's matrix takes components in A to those in B: its rows are B's axes in A."""
    _, _, quaternion = read(write(tmp_path, "flight", "a.aem", "--epoch", EPOCH), 2)
    q1, q2, q3, qc = quaternion.T
    rows = [
        [q1**2 - q2**2 - q3**2 + qc**2, 2 * (q1 * q2 + q3 * qc), 2 * (q1 * q3 - q2 * qc)],
        [2 * (q1 * q2 - q3 * qc), q2**2 - q1**2 - q3**2 + qc**2, 2 * (q2 * q3 + q1 * qc)],
        [2 * (q1 * q3 + q2 * qc), 2 * (q2 * q3 - q1 * qc), q3**2 - q1**2 - q2**2 + qc**2],
    ]
    matrix = np.moveaxis(np.array(rows), -1, 0)
    assert_close("axis by printed angles", matrix, body_axes(column(printed("flight"), VEHICLE)))


def test_neighbours_are_near(tmp_path: Path) -> None:
    """So that components may be interpolated; the table keeps w above 0 instead."""
    _, _, quaternion = read(write(tmp_path, "flight", "a.aem", "--epoch", EPOCH), 2)
    assert ((quaternion[1:] * quaternion[:-1]).sum(axis=1) > 0.0).all()
    assert quaternion[0, 3] >= 0.0
    assert (np.abs(np.linalg.norm(quaternion, axis=1) - 1.0) < within("ten decimals")).all()


def test_names_and_dates(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    options = ("--originator", "nasa larc", "--object-name", "Viking BLDT  AV-4")
    ids = ("--object-id", "1972-061A", "--epoch", EPOCH)
    text = write(tmp_path, "case4", "a.aem", *options, *ids).read_text()
    again = write(tmp_path, "case4", "b.aem", *options, *ids).read_text()
    assert text == again
    (said,) = held_to_the_standard(text, 2)
    assert "\nCREATION_DATE = 1970-01-02T00:00:00\nORIGINATOR = nasa larc\n" in text
    assert (said["OBJECT_NAME"], said["OBJECT_ID"]) == ("VIKING BLDT AV-4", "1972-061A")
    assert said["START_TIME"] == "1974-08-27T17:29:59.303000"  # the epoch less .697 s
    assert_approved([line for line in text.splitlines() if line.startswith("COMMENT fixes: ")])
    comments = text.replace("\nCOMMENT ", " ")  # a long file name breaks the line elsewhere
    assert "job 1: VIKING BLDT LOAD BAR CAMERA AV-4\n" in comments
    plain = write(tmp_path, "case4", "c.aem", "--epoch", EPOCH).read_text()
    assert "\nORIGINATOR = VOPD\n" in plain
    assert "\nOBJECT_NAME = UNKNOWN\nOBJECT_ID = UNKNOWN\n" in plain


def test_a_segment_a_job_in_order_of_time(tmp_path: Path) -> None:
    """Case 4 was filmed before case 1; the deck of case 1 is given first."""
    path = tmp_path / "a.aem"
    decks = [str(CASES_123.with_name(f"case{k}.dat")) for k in (1, 4)]
    result = vopd("attitude", *decks, "-o", str(path), "--epoch", EPOCH)
    assert result.status == 0, result.stderr
    times = [printed("case4")[0]["time_s"], printed("case1")[0]["time_s"]]
    found = held_to_the_standard(path.read_text(), 2)
    starts = [datetime.fromisoformat(one["START_TIME"] + "Z") - ZERO for one in found]
    assert_close("printed time", [start.total_seconds() for start in starts], times)
    assert len(ccsds_ndm.Aem.from_file(str(path)).segments) == 2
    assert result.stderr.count("card 59") == 1 and len(result.stderr.splitlines()) == 6


def test_jobs_that_overlap_are_told(tmp_path: Path) -> None:
    deck = tmp_path / "two.dat"
    vopd("demo", "--frames", "5", "--jobs", "2", "-o", str(deck))
    result = vopd("attitude", str(deck), "-o", str(tmp_path / "a.aem"), "--epoch", EPOCH)
    assert result.status == 0
    assert "cannot tell which one applies" in result.stderr
    assert len(held_to_the_standard((tmp_path / "a.aem").read_text(), 2)) == 2
    one_frame = vopd("attitude", str(CASES_123), "--format", "aem", "--epoch", EPOCH)
    assert one_frame.stderr.count("cannot tell which one applies") == 2  # three jobs of one instant
    quiet = vopd("attitude", str(deck), "--format", "aem", "--epoch", EPOCH, "-q")
    assert quiet.stderr == "" and quiet.stdout.startswith("CCSDS_AEM_VERS = 2.0\n")


# ACM

BLOCKS = {  # 504.0-B-2, tables 5-3, 5-4 and 5-6, in order; the mandatory ones with a !
    "META": "COMMENT* CLASSIFICATION OBJECT_NAME! INTERNATIONAL_DESIGNATOR CATALOG_NAME "
    "OBJECT_DESIGNATOR ORIGINATOR_POC ORIGINATOR_POSITION ORIGINATOR_PHONE ORIGINATOR_EMAIL "
    "ORIGINATOR_ADDRESS ODM_MSG_LINK CENTER_NAME TIME_SYSTEM! EPOCH_TZERO! ACM_DATA_ELEMENTS "
    "START_TIME STOP_TIME TAIMUTC_AT_TZERO NEXT_LEAP_EPOCH NEXT_LEAP_TAIMUTC",
    "ATT": "COMMENT* ATT_ID ATT_PREV_ID ATT_BASIS ATT_BASIS_ID REF_FRAME_A! REF_FRAME_B! "
    "NUMBER_STATES! ATT_TYPE! EULER_ROT_SEQ RATE_TYPE",
    "COV": "COMMENT* COV_ID COV_PREV_ID COV_BASIS COV_BASIS_ID COV_REF_FRAME COV_TYPE!",
}
NUMBER = re.compile(r"-?\d\.\d{1,15}e[+-]\d\d|-?\d+\.\d+")  # 6.8.4: at most 16 digits

Block = tuple[dict[str, str], np.ndarray]


def held_to_the_standard_acm(text: str) -> dict[str, list[Block]]:
    """The keywords and the numbers of all blocks, once what the standard asks of them holds."""
    assert text.isascii() and not re.search(r"[^\x20-\x7e\n]", text)
    head, *rest = re.split(r"^(META|ATT|COV)_START\n", text, flags=re.M)
    assert re.fullmatch(
        r"CCSDS_ACM_VERS = 2\.0\n(COMMENT .*\n)*CREATION_DATE = .*\nORIGINATOR = .*\n\n", head
    )
    found: dict[str, list[Block]] = {name: [] for name in BLOCKS}
    names = rest[::2]
    assert names == sorted(names, key=("META", "ATT", "COV").index) and names.count("META") == 1
    for name, content in zip(names, rest[1::2], strict=True):
        lines = content.rstrip("\n").split("\n")
        assert lines.pop() == f"{name}_STOP"
        data = [line for line in lines if NUMBER.match(line)]
        keys = lines[: len(lines) - len(data)]
        pattern = "".join(
            f"(?:{key.rstrip('!*')} )" + {"!": "", "*": "*"}.get(key[-1], "?")
            for key in BLOCKS[name].split()
        )
        assert re.fullmatch(pattern, "".join(line.split(" ")[0] + " " for line in keys)), keys
        said = dict(line.split(" = ") for line in keys if not line.startswith("COMMENT"))
        assert all(value and value in (value.upper(), value.lower()) for value in said.values())
        for part in " ".join(data).split():
            assert NUMBER.fullmatch(part) and not re.fullmatch(r"-0\.0*", part), part
            assert len(re.sub(r"e.*|\D", "", part)) <= 16, part
        rows = np.array([line.split(" ") for line in data], dtype=float)
        if name != "META":
            assert (np.diff(rows[:, 0]) > 0.0).all()
        found[name].append((said, rows))
    (said, _) = found["META"][0]
    assert said["ACM_DATA_ELEMENTS"].split(", ") == names[1:]
    first, last = (
        pick(rows[k, 0] for _, rows in found["ATT"]) for pick, k in ((min, 0), (max, -1))
    )
    assert (float(said["START_TIME"]), float(said["STOP_TIME"])) == (first, last)
    return found


@pytest.mark.parametrize("name", NAMES)
def test_another_reader_finds_the_listing_s_attitude_acm(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, name, "a.acm", "--epoch", EPOCH)
    held_to_the_standard_acm(path.read_text())
    message = ccsds_ndm.Acm.from_file(str(path))
    about, data = message.segment.metadata, message.segment.data
    assert datetime.fromisoformat(about.epoch_tzero).replace(tzinfo=UTC) == ZERO
    (block,) = data.att
    assert (block.ref_frame_a, block.ref_frame_b) == ("NED", "SC_BODY_1")
    assert (block.att_type, block.number_states) == ("QUATERNION", 4)
    lines = np.array(block.att_lines)
    rows = sorted(printed(name), key=lambda row: row["time_s"])
    assert_close("printed time", lines[:, 0], column(rows, ["time_s"])[:, 0])
    euler = Rotation.from_quat(lines[:, 1:]).as_euler("ZYX", degrees=True)
    assert_close("printed angle", apart_deg(euler, column(rows, VEHICLE)), 0.0)


def test_another_reader_finds_the_variances(tmp_path: Path) -> None:
    """The diagonal of the covariance of small turns about the body's axes, degrees squared."""
    path = write(tmp_path, "flight", "a.acm", "--epoch", EPOCH, "--landmark-sigma", "20")
    table = write(tmp_path, "flight", "a.jsonl", "--landmark-sigma", "20").read_text()
    (block,) = ccsds_ndm.Acm.from_file(str(path)).segment.data.cov
    assert (block.cov_ref_frame, block.cov_type) == ("SC_BODY_1", "ANGLE")
    assert block.cov_basis == "DETERMINED_GND"
    lines = np.array(block.cov_lines)
    rows = [json.loads(line) for line in table.splitlines()[1:]]
    diagonal = np.array([np.diag(row["covariance_deg2"]) for row in rows])
    assert lines.shape == (40, 4)
    assert_close("ten digits", lines[:, 1:] / diagonal, np.ones((40, 3)))


def test_several_jobs_are_blocks_that_belong_together(tmp_path: Path) -> None:
    path = tmp_path / "a.acm"
    decks = [str(CASES_123), str(CASES_123.with_name("case4.dat"))]
    ran = vopd("attitude", *decks, "-o", str(path), "--epoch", EPOCH, "--object-id", "1972-061A")
    assert ran.status == 0 and ran.stderr.count("cannot tell which one applies") == 2
    found = held_to_the_standard_acm(path.read_text())
    ids = [said["ATT_BASIS_ID"] for said, _ in found["ATT"]]
    assert ids == [said["COV_BASIS_ID"] for said, _ in found["COV"]]
    assert len(set(ids)) == 4
    assert found["META"][0][0]["INTERNATIONAL_DESIGNATOR"] == "1972-061A"
    assert found["ATT"][0][1][0, 0] == printed("case4")[0]["time_s"]  # filmed before the others


def test_infinite_variances_are_left_out_and_told() -> None:
    told: list[Finding] = []
    request = FileRequest(epoch=ZERO)
    text = FORMATS["acm"].render([history(one_landmark())], request, told.append).decode()
    found = held_to_the_standard_acm(text)
    assert len(found["ATT"][0][1]) == 2 and len(found["COV"][0][1]) == 1
    assert_approved(told, parts=["DJI_0000.JPG"])


def test_variances_that_the_residuals_contradict_are_left_out_and_told(tmp_path: Path) -> None:
    """Clicks of one frame that are those of another moment: its angles stay, its variances go."""
    picks = shutil.copytree(HILL, tmp_path / "p") / "picks.csv"
    picks.write_text(picks.read_text().replace("\n4,", "\n14,"))
    told: list[Finding] = []
    one = solve_flight(tmp_path / "p").history()
    turn = one.quaternion.copy()
    turn[0] = np.nan  # which leaves a frame out before them
    one = replace(one, quaternion=turn)
    text = FORMATS["acm"].render([one], FileRequest(epoch=ZERO), told.append).decode()
    found = held_to_the_standard_acm(text)
    assert len(found["ATT"][0][1]) == 4
    assert found["COV"][0][1][:, 0].tolist() == [2.1, 2.2, 2.3]
    assert_approved([finding.message for finding in told])


def test_without_any_variance_there_is_no_covariance_block() -> None:
    one = one_landmark(frames=1)
    text = FORMATS["acm"].render([history(one)], FileRequest(epoch=ZERO)).decode()
    found = held_to_the_standard_acm(text)
    assert found["COV"] == [] and len(found["ATT"]) == 1


def test_texts_and_versions_that_the_standard_has() -> None:
    assert text_value("a" * 200) == "a" * 200
    with refused(VopdError):
        text_value("a" * 201)
    for version in (0, 3):
        with refused(VopdError):
            text_of("aem", request=replace(REQUEST, aem_version=version))


def test_it_needs_an_epoch_and_ascii_names() -> None:
    with refused(VopdError):
        FORMATS["acm"].render(flight(), FileRequest())
    acm = ("attitude", CASES_123, "--format", "acm", "--epoch", EPOCH)
    named = vopd(*acm, "--object-name", "\u00c4")
    assert named.status == 2 and "at most 200 ASCII characters" in named.stderr
    version = vopd(*acm, "--aem-version", "1")
    assert version.status == 2 and "--aem-version is for aem, not acm" in version.stderr


# Every line of an AEM and an ACM


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
def test_jobs_that_overlap_are_told_lines(
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
    assert_approved(said, parts=["DJI_0001.JPG"])
    for name in ("sigmas", "common errors", "reading sigma"):
        assert f"COMMENT {name}: " in text


def test_an_acm_of_several_jobs() -> None:
    """From the first start to the last stop, in whatever order the jobs are given."""
    none = level_flight(3, 30.0)
    wide = replace(none.uncertainty, covariance_deg2=np.full((2, 3, 3), np.nan))
    long = level_flight(2, time_s=np.array([10.0, 60.0]))
    text, said = text_of("acm", level_flight(1, 50.0), replace(none, uncertainty=wide), long)
    lines = text.splitlines()
    assert "ACM_DATA_ELEMENTS = ATT, ATT, ATT, COV, COV" in lines
    assert "START_TIME = 10.000000" in lines and "STOP_TIME = 60.000000" in lines
    named = [line for line in lines if "_ID = JOB" in line]
    assert named == [
        *(f"ATT_BASIS_ID = JOB {k}" for k in (1, 2, 3)), "COV_BASIS_ID = JOB 1",
        "COV_BASIS_ID = JOB 3",
    ]  # fmt: skip
    assert len(said) == 6 and text.count("\n\nATT_START\n") == 3


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
    names = "REF_FRAME_A, NED|REF_FRAME_B, SC_BODY_1|quaternion"
    assert_approved(re.findall(rf"(?:{names}): .*?(?= (?:{names}|vertical|position): )", words))
