"""What a check of a project says of its files, of landmarks far away, and in which order."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import TOML, marks_m, write_project
from vopd.findings import Finding, VopdError
from vopd.flight import check_flight as checked
from vopd.flight.check_flight import _far, _file_messages, check_flight
from vopd.flight.flight import Flight
from vopd.flight.read import read_flight
from vopd.geometry.earth import earth_centred_m, geodetic


def flight(folder: Path, toml: str = TOML) -> Flight:
    return read_flight(str(write_project(folder, toml)))


def test_an_error_stands_behind_the_warnings_and_has_no_name_of_the_file(tmp_path: Path) -> None:
    path = write_project(tmp_path, "[flight]\n")
    assert check_flight(str(path)) == [Finding("the section [camera] is needed", str(path))]
    path = write_project(tmp_path, TOML.replace('height = "ellipsoid"\n', ""))
    (found,) = check_flight(str(path))
    assert found.message.startswith("[landmarks]: `height` is needed: ")
    assert (found.deck, found.severity) == (str(path), "error")


def test_landmarks_never_picked_are_named_in_the_order_of_the_file(tmp_path: Path) -> None:
    """Ten, and the count of the rest; the first landmark, too."""
    one = flight(tmp_path)
    names = tuple(f"m{k}" for k in range(14))
    for picked, named in (
        (range(14), None), (range(1, 14), "m0"), (range(4, 14), "m0, m1, m2, m3"),
        (range(10, 14), "m0, m1, m2, m3, m4, m5, m6, m7, m8, m9"),
        (range(11, 14), "m0, m1, m2, m3, m4, m5, m6, m7, m8, m9 and 1 more"),
        (range(3), "m3, m4, m5, m6, m7, m8, m9, m10, m11, m12 and 1 more"),
    ):  # fmt: skip
        count = len(picked)
        picks = replace(
            one.picks, frame=np.zeros(count, int), landmark=np.array(picked)[::-1],
            pixel=np.full((count, 2), 5.0), sigma_px=np.ones(count),
        )  # fmt: skip
        landmarks = replace(one.landmarks, name=names)
        found = [*_file_messages(replace(one, picks=picks, landmarks=landmarks))]
        assert found == ([] if named is None else [f"never picked: {named}"])


def test_picks_outside_the_image_are_counted_and_the_first_is_named(tmp_path: Path) -> None:
    one = flight(tmp_path)
    pixel = one.picks.pixel.copy()
    pixel[8], pixel[20] = (-7.25, 50.0), (5.0, 3000.5)
    (found,) = _file_messages(replace(one, picks=replace(one.picks, pixel=pixel)))
    assert found == (
        "2 picks outside the image of 1920 x 1080, the first bridge in frame 1 at -7.25, 50"
    )


def far(one: Flight, camera_m: Any = None, marks_m: Any = None) -> list[str]:
    path = one.path if camera_m is None else replace(one.path, position_m=camera_m)
    marks = one.landmarks if marks_m is None else replace(one.landmarks, position_m=marks_m)
    return [*_far(replace(one, path=path, landmarks=marks))]


FAR = "landmarks are more than 300 km from the camera"


@pytest.mark.parametrize(("height_km", "told"), [(297.0, False), (303.0, True)])
def test_landmarks_300_km_away_are_far(height_km: float, told: bool, tmp_path: Path) -> None:
    one = flight(tmp_path)
    camera = np.tile(earth_centred_m(47.6435, 16.4759, 1e3 * height_km), (5, 1))
    assert far(one, camera) == [FAR] * told
    camera[3:] = np.nan  # frames without a position do not count
    assert far(one, camera) == [FAR] * told
    camera[:] = np.nan
    assert far(one, camera) == []
    # half of the landmarks is near, and they decide with their count
    marks = marks_m()
    marks[:2] = earth_centred_m(-47.0, 100.0, 0.0)
    assert far(one, marks_m=marks) == []
    marks[:4] = earth_centred_m(-47.0, 100.0, 0.0)
    assert far(one, marks_m=marks) == [FAR]


def test_whose_latitude_and_longitude_are_exchanged(tmp_path: Path) -> None:
    one = flight(tmp_path)

    def turned(position: Any) -> Any:
        where = geodetic(position)
        return earth_centred_m(where.longitude_deg, where.latitude_deg, where.height_m)

    whose = "the landmarks or of the camera"
    both = f"{FAR}; with latitude and longitude of {whose} exchanged they are not"
    assert far(one, marks_m=turned(one.landmarks.position_m)) == [both]
    assert far(one, turned(one.path.position_m)) == [both]
    assert far(one, turned(one.path.position_m), turned(one.landmarks.position_m)) == []
    east = earth_centred_m([47.0] * 6, [120.0] * 6, [0.0] * 6)
    across = earth_centred_m([60.0] * 5, [-133.0] * 5, [0.0] * 5)  # 120 degrees by the pole
    assert far(one, across, east) == [FAR]
    assert far(one, earth_centred_m([47.0] * 5, [16.4759] * 5, [0.0] * 5), east) == [FAR]


def test_easting_and_northing_are_named_before_latitude_and_longitude(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = flight(tmp_path)
    where = geodetic(one.landmarks.position_m)
    turned = earth_centred_m(where.longitude_deg, where.latitude_deg, where.height_m)
    monkeypatch.setattr(checked, "_grid_exchanged", lambda flight: one.landmarks.position_m)
    assert far(one, marks_m=turned) == [
        f"{FAR}; with x and y of the landmarks exchanged they are not: x is the easting"
    ]


def test_findings_of_a_check_stand_in_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where landmarks are far no usual mistake is looked for."""
    path = str(write_project(tmp_path))
    monkeypatch.setattr(checked, "usual_mistakes", lambda project, result: ["a mistake"])
    usual = [Finding("a mistake", path, severity="warning")]
    assert check_flight(path) == usual
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([*rows, "9,mast,5,5", "0,steeple,1,1"]))
    found = check_flight(path)
    assert [(one.severity, one.message.partition(":")[0].partition(" (")[0]) for one in found] == [
        ("warning", "no landmark steeple"),
        ("warning", "frame 9"),
        ("warning", "a mistake"),
    ]
    monkeypatch.setattr(checked, "_file_messages", lambda flight: ["of the files"])
    monkeypatch.setattr(checked, "_far", lambda flight: ["far away"])
    unknown, *rest = check_flight(path)
    assert unknown.message.startswith("no landmark steeple (1 pick)")
    assert rest == [
        Finding(message, path, severity="warning") for message in ("of the files", "far away")
    ]


@pytest.mark.parametrize(("solved", "told"), [([False, False], True), ([True, False], False)])
def test_a_solve_without_an_attitude_is_an_error(
    solved: list[bool], told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = str(write_project(tmp_path))
    result = SimpleNamespace(solved=np.array(solved), findings=())
    monkeypatch.setattr(checked, "solve_flight_read", lambda flight: result)
    monkeypatch.setattr(checked, "usual_mistakes", lambda project, result: [])
    assert check_flight(path) == [Finding("no frame has an attitude", path)] * told


def test_a_solve_that_is_refused_is_an_error_without_the_file_s_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = str(write_project(tmp_path))

    def fails(flight: Flight) -> None:
        raise VopdError(f"{path}: odd")

    monkeypatch.setattr(checked, "solve_flight_read", fails)
    monkeypatch.setattr(checked, "_file_messages", lambda flight: ["of the files"])
    assert check_flight(path) == [
        Finding("of the files", path, severity="warning"), Finding("odd", path),
    ]  # fmt: skip
