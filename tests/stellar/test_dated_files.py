"""Star attitudes with dates as AEM and CZML, read by others."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import ccsds_ndm
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.command import DECKS, Ran, vopd
from tests.tolerances import within

pytest.importorskip("skyfield")

ORION = DECKS / "stars" / "orion.csv"
PLACE = ("--place", "48,11,500")
FIRST, SECOND = "2020-01-15T21:00:00", "2020-01-15T21:00:30.500000"


def two_photographs() -> str:
    """Orion at two moments, the later one first."""
    lines = [line for line in ORION.read_text().splitlines() if not line.startswith("#")]
    rows = ["utc,image," + lines[0]]
    for name, moment in (("late", SECOND), ("early", FIRST)):
        rows += [f"{moment}Z,{name},{line}" for line in lines[1:]]
    return "\n".join(rows) + "\n"


def solve(*arguments: str | Path, text: str | None = None) -> Ran:
    given = ["-"] if text is not None else []
    return vopd("stars", "solve", *given, "--focal", "76", *arguments, stdin=text)


def table(*arguments: str) -> list[dict[str, Any]]:
    result = solve("--format", "json", *arguments, text=two_photographs())
    assert result.status == 0, result.stderr
    return json.loads(result.stdout)  # type: ignore[no-any-return]


def apart(one: Rotation, other: Rotation) -> float:
    return float((one.inv() * other).magnitude())


def test_an_aem_read_by_ccsds_ndm(tmp_path: Path) -> None:
    """The quaternion turns camera components (x right, y down, z forward) into ICRF ones."""
    file = tmp_path / "stars.aem"
    result = solve("-o", file, *PLACE, text=two_photographs())
    assert result.status == 0, result.stderr
    message = ccsds_ndm.Aem.from_file(str(file))
    message.validate(strict=True)
    (segment,) = message.segments
    assert list(segment.data.attitude_states_epochs) == [FIRST + ".000000", SECOND]
    lines = file.read_text().splitlines()
    assert "REF_FRAME_A = ICRF" in lines and "REF_FRAME_B = SENSOR_1" in lines
    data = lines[lines.index("DATA_START") + 1 : lines.index("DATA_STOP")]
    rows = {row["image"]: row for row in table(*PLACE)}
    for line, name in zip(data, ("early", "late"), strict=True):
        found = Rotation.from_quat([float(part) for part in line.split()[1:]])
        photograph = np.array(rows[name]["matrix"])  # x right, y up, z backward as rows
        camera = np.column_stack([photograph[0], -photograph[1], -photograph[2]])
        assert apart(found, Rotation.from_matrix(camera)) < within("quaternion of ten digits")


def test_an_aem_of_a_vehicle() -> None:
    mounted = solve("--format", "aem", *PLACE, "--mount", "down", text=two_photographs()).stdout
    assert "REF_FRAME_B = SC_BODY_1" in mounted


def test_czml_has_the_vehicle_on_the_earth() -> None:
    """Forward, right, down from yaw, pitch, roll and the place, by hand."""
    options = (*PLACE, "--mount", "10,20,30")
    document = json.loads(solve("--format", "czml", *options, text=two_photographs()).stdout)
    packet = document[1]
    assert packet["position"]["cartographicDegrees"] == [11.0, 48.0, 500.0]
    samples = np.reshape(packet["orientation"]["unitQuaternion"], (-1, 5))
    assert samples[:, 0].tolist() == [0.0, 30.5]
    lat, lon = np.radians([48.0, 11.0])
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    east = [-np.sin(lon), np.cos(lon), 0.0]
    ned = np.column_stack([north, east, np.cross(north, east)])
    rows = {row["image"]: row for row in table(*options)}
    for sample, name in zip(samples, ("early", "late"), strict=True):
        angles = [rows[name][f"vehicle_{one}_deg"] for one in ("yaw", "pitch", "roll")]
        body = Rotation.from_euler("ZYX", angles, degrees=True)
        expected = Rotation.from_matrix(ned) * body
        found = Rotation.from_quat(sample[1:])
        assert apart(found, expected) < within("quaternion of ten digits")


def test_what_a_dated_file_needs() -> None:
    undated = solve("--format", "aem", ORION)
    assert undated.status == 1 and "needs dates: --date, or a column utc" in undated.stderr
    nowhere = solve("--format", "czml", ORION, "--date", FIRST)
    assert nowhere.status == 1 and "--place" in nowhere.stderr


def test_a_date_twice_is_left_out_with_a_warning() -> None:
    text = two_photographs().replace(SECOND, FIRST)
    result = solve("--format", "aem", text=text)
    assert result.status == 0 and "it has the time of 1" in result.stderr


@pytest.mark.parametrize(("date", "said"), [("soon", "not an ISO 8601"), (SECOND, "two dates")])
def test_bad_dates_name_their_line(date: str, said: str) -> None:
    lines = two_photographs().splitlines()
    lines[12] = date + lines[12][lines[12].index(",") :]
    result = solve(text="\n".join(lines) + "\n")
    assert result.status == 1 and "line 13: utc: " in result.stderr and said in result.stderr
