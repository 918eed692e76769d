"""AEM, read back by two readers of other projects and held to the order of the standard's tables.

ccsds-ndm-py reads version 2, gmat-run version 1 (it only looks for what it needs).
"""

from __future__ import annotations

import re
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import ccsds_ndm
import numpy as np
import pytest
from gmat_run.parsers.aem_ephemeris import parse
from scipy.spatial.transform import Rotation

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
from tests.tolerances import assert_close, within

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
    assert "COMMENT fixes: none; these are the original's numbers\n" in text
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
    assert len(result.stderr.splitlines()) == 1  # of the sigmas


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
