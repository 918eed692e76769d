"""ACM, read back by ccsds-ndm-py and held to the order of the standard's tables."""

from __future__ import annotations

import json
import re
from datetime import UTC, datetime
from pathlib import Path

import ccsds_ndm
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import refused
from tests.kit.attitude_files import (
    CASES_123,
    EPOCH,
    NAMES,
    VEHICLE,
    apart_deg,
    column,
    printed,
    write,
)
from tests.kit.command import vopd
from tests.kit.estimates import one_landmark
from tests.kit.histories import flight
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.export import FORMATS, FileRequest
from vopd.findings import Finding, VopdError

ZERO = datetime(1974, 8, 27, 17, 30, tzinfo=UTC)
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


def held_to_the_standard(text: str) -> dict[str, list[Block]]:
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
def test_another_reader_finds_the_listing_s_attitude(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, name, "a.acm", "--epoch", EPOCH)
    held_to_the_standard(path.read_text())
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
    found = held_to_the_standard(path.read_text())
    ids = [said["ATT_BASIS_ID"] for said, _ in found["ATT"]]
    assert ids == [said["COV_BASIS_ID"] for said, _ in found["COV"]]
    assert len(set(ids)) == 4
    assert found["META"][0][0]["INTERNATIONAL_DESIGNATOR"] == "1972-061A"
    assert found["ATT"][0][1][0, 0] == printed("case4")[0]["time_s"]  # filmed before the others


def test_infinite_variances_are_left_out_and_told() -> None:
    told: list[Finding] = []
    request = FileRequest(epoch=ZERO)
    text = FORMATS["acm"].render([history(one_landmark())], request, told.append).decode()
    found = held_to_the_standard(text)
    assert len(found["ATT"][0][1]) == 2 and len(found["COV"][0][1]) == 1
    assert [str(one) for one in told] == [
        "hand.toml: job 1: frame DJI_0000.JPG has no finite variances: it is left out of COV"
    ]


def test_without_any_variance_there_is_no_covariance_block() -> None:
    one = one_landmark(frames=1)
    text = FORMATS["acm"].render([history(one)], FileRequest(epoch=ZERO)).decode()
    found = held_to_the_standard(text)
    assert found["COV"] == [] and len(found["ATT"]) == 1


def test_it_needs_an_epoch_and_ascii_names() -> None:
    with refused(VopdError):
        FORMATS["acm"].render(flight(), FileRequest())
    acm = ("attitude", CASES_123, "--format", "acm", "--epoch", EPOCH)
    named = vopd(*acm, "--object-name", "\u00c4")
    assert named.status == 2 and "at most 200 ASCII characters" in named.stderr
    version = vopd(*acm, "--aem-version", "1")
    assert version.status == 2 and "--aem-version is for aem, not acm" in version.stderr
