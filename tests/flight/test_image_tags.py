"""Positions and gimbal angles from the tags of images."""

from __future__ import annotations

import sys
import time
import tomllib
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import ROOT
from tests.kit.command import vopd as run
from tests.kit.flight_project import (
    LENS,
    SIZE,
    TOML,
    camera_m,
    local_to_camera,
    truth_deg,
    write_project,
)
from tests.kit.tagged_images import Rational, tagged_image
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.formats import image_tags
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.image_tags import (
    ImageTags,
    clock_of_tags,
    exif_position,
    images_in,
    read_tags,
    xmp_number,
    xmp_text,
    zone_of_tags,
)
from vopd.flight.formats.picks import CLICKS
from vopd.flight.formats.track import TRACK_FORMATS, damage_text
from vopd.flight.project.camera import doubts_of_tags
from vopd.flight.project.inspect import NewProject, has_positions, look_at_focal, take_size
from vopd.flight.project.keys import Section
from vopd.flight.project.new import project_of_files
from vopd.flight.project.read import read_flight
from vopd.flight.project.times import times_of_images
from vopd.geometry.earth import geodetic
from vopd.geometry.lenses import LensKind
from vopd.video import open_frames, upright_size


def test_exif_degrees_minutes_seconds_and_references(tmp_path: Path) -> None:
    """25 36 21.73 S is 25 + 36/60 + 21.73/3600 south; altitude reference 1 is below the sea."""
    path = tmp_path / "a.jpg"
    tagged_image(path, (25, 36, 21.73), (49, 25, 17.51), "SW", 12.5, altitude_reference=1)
    tags = read_tags(path)
    expected = (-(49 + 25 / 60 + 17.51 / 3600), -(25 + 36 / 60 + 21.73 / 3600), -12.5)
    assert_close("ratio", tags.position, expected)
    assert np.isnan(tags.gimbal_deg).all() and tags.size_px == (64, 48)


@pytest.mark.parametrize("longitude", ["GpsLongitude", "GpsLongtitude"])
def test_xmp_has_more_digits_and_a_misspelt_name(tmp_path: Path, longitude: str) -> None:
    xmp = (
        f'drone-dji:GpsLatitude="+47.643500001" drone-dji:{longitude}="16.475900002" '
        'drone-dji:AbsoluteAltitude="+540.123" drone-dji:GimbalYawDegree="-5.50" '
        'drone-dji:GimbalPitchDegree="-12.1"><drone-dji:GimbalRollDegree>+0.30'
        "</drone-dji:GimbalRollDegree>"
    )
    tagged_image(tmp_path / "a.jpg", (47, 38, 36.6), (16, 28, 33.2), "NE", 500.0, xmp=xmp)
    tags = read_tags(tmp_path / "a.jpg")
    assert tags.position == (16.475900002, 47.643500001, 540.123)
    assert tags.gimbal_deg == (-5.5, -12.1, 0.3)


def images_project(folder: Path) -> Path:
    """The frames of the project as images with tags; the gimbal is off by 1, -2 and .5 degree."""
    project = write_project(folder, TOML[: TOML.index("[track]")])
    project.write_text(project.read_text() + '[track]\nfile = "images"\nheight = "ellipsoid"\n')
    (folder / "images").mkdir()
    where = geodetic(camera_m(2.0 + np.arange(5) / 10.0))
    gimbal = truth_deg() - [1.0, -2.0, 0.5]
    for k, (latitude, longitude, height) in enumerate(zip(*where, strict=True)):
        yaw, pitch, roll = gimbal[k]
        xmp = (
            f'drone-dji:GpsLatitude="{latitude:.12f}" drone-dji:GpsLongitude="{longitude:.12f}" '
            f'drone-dji:AbsoluteAltitude="{height:.6f}" drone-dji:GimbalYawDegree="{yaw:.2f}" '
            f'drone-dji:GimbalPitchDegree="{pitch:.2f}" drone-dji:GimbalRollDegree="{roll:.2f}">'
        )
        tagged_image(folder / "images" / f"IMG_{k}.JPG", xmp=xmp, size_px=SIZE)
    picks = folder / "picks.csv"
    rows = [f"IMG_{row[0]}.JPG{row[1:]}" for row in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    return project


def test_a_folder_of_images_is_a_track_and_the_gimbal_a_comparison(tmp_path: Path) -> None:
    flight = vopd.solve_flight(images_project(tmp_path))
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert_approved(flight.about)
    table = flight.to_dataframe()
    assert_close("flight angle", table["gimbal_yaw_deg"], truth_deg()[:, 0] - 1.0)
    turned = local_to_camera(truth_deg()[0] - [1.0, -2.0, 0.5]) @ local_to_camera(truth_deg()[0]).T
    axes = zip(
        ("right", "down", "forward"), Rotation.from_matrix(turned).as_rotvec(True), strict=True
    )
    for axis, degrees in axes:
        assert f"{axis} {degrees:+.2f} ({degrees:+.2f} to" in table.attrs["gimbal"]
    assert "gimbal" not in vopd.solve_flight(write_project(tmp_path / "other")).to_dataframe().attrs


VEHICLE = '[vehicle]\nattitude = "images"\n'


def test_the_turn_from_the_gimbal_to_the_camera_is_a_mount_with_its_sigma(tmp_path: Path) -> None:
    """Five images: the mean of their five turns, each good to .3 degree.

    The picks are exact, so that only the two digits of a tag are off: .003 degree.
    """
    project = images_project(tmp_path)
    text = project.read_text()
    project.write_text(text + VEHICLE)
    with refused():
        vopd.solve_flight(project)
    project.write_text(text + VEHICLE + "attitude_sigma_deg = 0.3\n")
    found = adjust(project, ["mount"])
    turns = [
        Rotation.from_matrix(local_to_camera(one) @ local_to_camera(one - [1.0, -2.0, 0.5]).T)
        for one in truth_deg()
    ]
    right, down, forward = -np.mean([one.as_rotvec(True) for one in turns], axis=0)
    after = [one.after for one in found.parameters]
    assert_close("gimbal digits", after, [forward, right, down])
    assert_close("mount", [one.sigma_after for one in found.parameters], 0.3 / np.sqrt(5.0))
    said = found.result.history().about.words.conventions["gimbal"]
    assert_approved(said.partition(";")[0])


def test_images_without_a_gimbal_have_no_attitude_of_the_vehicle(tmp_path: Path) -> None:
    project = images_project(tmp_path)
    (tmp_path / "bare").mkdir()
    tagged_image(tmp_path / "bare" / "IMG_0.JPG")
    text = VEHICLE.replace("images", "bare") + "attitude_sigma_deg = 0.1\n"
    project.write_text(project.read_text() + text)
    with refused():
        vopd.solve_flight(project)


def test_tables_of_flights_with_and_without_a_gimbal_join(tmp_path: Path) -> None:
    both = images_project(tmp_path / "a"), write_project(tmp_path / "b")
    ran = run("attitude", *both, "--format", "jsonl")
    assert ran.status == 0
    assert ran.stdout.count('"gimbal_yaw_deg": null') == 5


def test_a_new_project_from_images(tmp_path: Path) -> None:
    images_project(tmp_path / "a")
    ran = run("new", tmp_path / "new", "--images", tmp_path / "a" / "images")
    assert ran.status == 0
    text = (tmp_path / "new" / "flight.toml").read_text()
    assert 'file = "../a/images"' in text and "image_size_px = [1920, 1080]" in text
    assert "needed: [track] height" in ran.stdout


def test_tags_of_a_new_project_are_read_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in "ab":
        tagged_image(tmp_path / f"{name}.jpg")
    read: list[str] = []
    monkeypatch.setattr(
        image_tags, "read_tags", lambda path: read.append(path.name) or read_tags(path)
    )
    new, values = NewProject(), dict[tuple[str, str], str]()
    has_positions(new, values, tmp_path, str(tmp_path))
    take_size(new, values, tmp_path)
    look_at_focal(new, values, tmp_path)
    assert read == ["a.jpg", "b.jpg"] and values["camera", "image_size_px"] == "[64, 48]"


def test_images_without_position_and_files_that_are_none(tmp_path: Path) -> None:
    project = images_project(tmp_path)
    tagged_image(tmp_path / "images" / "IMG_2.JPG")
    flight = vopd.solve_flight(project)
    assert flight.solved.tolist() == [True, True, False, True, True]
    assert any("5 images, 1 without position" in one for one in flight.about)
    (tmp_path / "images" / "IMG_2.JPG").write_text("no image")
    flight = vopd.solve_flight(project)
    assert flight.solved.tolist() == [True, True, False, True, True]
    assert_approved([one for one in flight.about if "IMG_2.JPG" in one])
    for path in (tmp_path / "images").iterdir():
        tagged_image(path)
    with refused(VopdError):
        vopd.solve_flight(project)
    for path in (tmp_path / "images").iterdir():
        path.write_text("no image")
    with refused(VopdError):
        vopd.solve_flight(project)


def test_without_pillow_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    project = images_project(tmp_path)
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    with refused(VopdError):
        vopd.solve_flight(project)


# Values of EXIF and XMP tags one by one, and what a folder of images says as track and times


NAN = float("nan")


def same(found: Any, expected: Any) -> bool:
    return bool(np.array_equal(np.array(found, float), np.array(expected, float), equal_nan=True))


GPS = {1: "N", 2: (47, 30, 36), 3: "E", 4: (16, 15, 9), 6: 540.5}


@pytest.mark.parametrize(
    ("tags", "expected"),
    [
        ({}, (16.2525, 47.51, 540.5)), ({1: "S"}, (16.2525, -47.51, 540.5)),
        ({3: "W"}, (-16.2525, 47.51, 540.5)), ({3: "W\0", 1: " S "}, (-16.2525, -47.51, 540.5)),
        ({5: b"\x00"}, (16.2525, 47.51, 540.5)), ({5: b"\x01"}, (16.2525, 47.51, -540.5)),
        ({5: 1}, (16.2525, 47.51, -540.5)), ({5: 0}, (16.2525, 47.51, 540.5)),
        ({5: 1, 6: -7}, (16.2525, 47.51, 7.0)), ({6: None}, (16.2525, 47.51, NAN)),
        ({2: None}, (NAN, NAN, NAN)), ({4: None}, (NAN, NAN, NAN)),
    ],
)  # fmt: skip
def test_positions_of_exif(tags: dict[int, Any], expected: tuple[float, ...]) -> None:
    """15' 9" are .2525 degree, 30' 36" are .51; a tag that is None is not there."""
    given = {tag: value for tag, value in (GPS | tags).items() if value is not None}
    found = exif_position(given)
    known = np.isfinite(expected)
    assert np.isfinite(found).tolist() == known.tolist()
    assert_close("ratio", np.array(found)[known], np.array(expected)[known])


@pytest.mark.parametrize(
    "angles",
    [
        {"latitude": (99, 0, 0)}, {"latitude": (47, 99, 0)}, {"longitude": (16, 0, 61)},
        {"longitude": (361, 0, 0)}, {"references": "XE"}, {"references": "NX"},
        {"references": ("N", "")},
    ],
)  # fmt: skip
def test_no_place_on_the_earth_is_a_damaged_tag(angles: dict[str, Any], tmp_path: Path) -> None:
    given = {"latitude": (47, 30, 0), "longitude": (16, 30, 0), "references": "NE"} | angles
    tagged_image(tmp_path / "a.jpg", *given.values(), 500.0)
    tags = read_tags(tmp_path / "a.jpg")
    assert np.isnan(tags.position).all()
    assert_approved(tags.damage)


@pytest.mark.parametrize(
    "tags", [{2: (-47, 30, 36)}, {4: (16, -15, 9)}, {2: (47, 30, -36)}, {1: ""}, {3: ""}]
)
def test_degrees_below_zero_and_sides_that_are_not_given_are_refused(tags: dict[int, Any]) -> None:
    with refused(ValueError):
        exif_position(GPS | tags)


def test_tags_that_are_cut_off_are_damaged(tmp_path: Path) -> None:
    """They say that there are 65,535 of them, and there is one."""
    tags = Image.Exif()
    tags[271] = "camera"
    counted = b"MM\0*\0\0\0\x08"
    cut = tags.tobytes().replace(counted + b"\0\1", counted + b"\xff\xff")
    for name, exif in (("whole", tags.tobytes()), ("cut", cut)):
        Image.new("L", (40, 30)).save(tmp_path / f"{name}.jpg", exif=exif)
    assert not read_tags(tmp_path / "whole.jpg").damage
    assert_approved(read_tags(tmp_path / "cut.jpg").damage)


ZERO = (0, 0, 0)


@pytest.mark.parametrize("tags", [{2: ZERO, 4: ZERO}, {18: "TOKYO"}, {18: "Pulkovo 1942"}])
def test_no_fix_and_another_datum_are_no_position(tags: dict[int, Any]) -> None:
    """Tokyo is some 450 m from WGS 84 in Japan; EXIF's own example of a datum is one of both."""
    with refused(ValueError):
        exif_position(GPS | tags)


@pytest.mark.parametrize("datum", ["WGS-84", "WGS 84\0", "wgs1984", " ", "JGD2011", "ETRS89"])
def test_datums_that_are_nearly_the_same(datum: str) -> None:
    assert exif_position(GPS | {18: datum}) == exif_position(GPS)


def test_places_on_the_equator_and_on_the_meridian() -> None:
    """Each of the two may be 0."""
    assert exif_position(GPS | {2: ZERO})[:2] == (16.2525, 0.0)
    assert exif_position(GPS | {4: ZERO})[:2] == (0.0, 47.51)


TAKEN, PART, ZONE, OTHER_ZONE = 0x9003, 0x9291, 0x9011, 0x9010
NOON = datetime(2026, 5, 1, 12, tzinfo=UTC).timestamp()
AT_NOON = {TAKEN: "2026:05:01 12:00:00"}


@pytest.mark.skipif(not hasattr(time, "tzset"), reason="no time zone by environment")
@pytest.mark.parametrize(
    ("tags", "expected"),
    [
        ({}, (NAN, NAN, True)), ({PART: "5"}, (NAN, NAN, True)), (AT_NOON, (NOON, NAN, True)),
        ({TAKEN: "    :  :     :  :  "}, (NAN, NAN, True)),
        (AT_NOON | {PART: "5"}, (NOON + 0.5, NAN, False)),
        (AT_NOON | {PART: "050 "}, (NOON + 0.05, NAN, False)),
        (AT_NOON | {PART: "00"}, (NOON, NAN, False)), (AT_NOON | {PART: "x"}, (NOON, NAN, True)),
        (AT_NOON | {PART: "²"}, (NOON, NAN, True)), (AT_NOON | {PART: ""}, (NOON, NAN, True)),
        ({TAKEN: "2026:05:01 12:00:00\0 "} | {ZONE: "+02:00\0"}, (NOON, 7200.0, True)),
        (AT_NOON | {ZONE: "-01:30", OTHER_ZONE: "+05:00"}, (NOON, -5400.0, True)),
        (AT_NOON | {OTHER_ZONE: "+05:00"}, (NOON, 18000.0, True)),
        (AT_NOON | {ZONE: "Z", OTHER_ZONE: "-05:00"}, (NOON, -18000.0, True)),
    ],
)  # fmt: skip
def test_clocks_of_exif(
    tags: dict[int, Any], expected: tuple[float, float, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the computer's own zone is another."""
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    time.tzset()
    try:
        assert same(clock_of_tags(tags), expected)
    finally:
        monkeypatch.delenv("TZ")
        time.tzset()


def test_zones_go_to_14_hours() -> None:
    """Of Tonga and the Line Islands."""
    assert [zone_of_tags({ZONE: text}) for text in ("+13:00", "+14:00")] == [46_800.0, 50_400.0]


@pytest.mark.parametrize("text", ["+2:00", "02:00", "+02:00:00", "+0200", "x+02:00", "", "+14:01",
                                  "-99:00", "+01:60"])  # fmt: skip
def test_zones_that_are_none(text: str) -> None:
    assert same(zone_of_tags({ZONE: text}), NAN)


@pytest.mark.parametrize(
    ("xmp", "value"),
    [
        ("d:Height='1.5' d:Other=\"2\"", 1.5), ("d:Height = '' d:Other='+2'", 2.0),
        ('a:Height="5"', 5.0), ('a:Height = " -5.25 "', -5.25), ("<a:Height>+6</a:Height>", 6.0),
        ("<a:Height > 7 <", 7.0), ('a:Height="x" b:Other="8"', 8.0),
        ('a:Height="" b:Other="8"', 8.0),
        ('b:Other="8" a:Height="9"', 9.0), ('a:MyHeight="5"', NAN), ('a:Heights="5"', NAN),
        ("", NAN), ('a:Height="x"', NAN),
    ],
)  # fmt: skip
def test_numbers_of_xmp(xmp: str, value: float) -> None:
    """An attribute or an element; the first of the names that has a number."""
    assert same(xmp_number(f"<x {xmp} >", ("Height", "Other")), value)


def test_positions_of_xmp_stand_before_those_of_exif(tmp_path: Path) -> None:
    """Both angles or none; 0, 0 is what a receiver without a position writes."""

    def position(xmp: str) -> tuple[float, ...]:
        tagged_image(tmp_path / "a.jpg", (47, 30, 0), (16, 30, 0), "NE", 500.0, xmp=xmp)
        return read_tags(tmp_path / "a.jpg").position

    lat, lon = 'd:GpsLatitude="1.5"', 'd:GpsLongitude="2.5"'
    exif = (16.5, 47.5)
    assert position(f"{lat} {lon}>") == (2.5, 1.5, 500.0)
    assert position(f'{lat} {lon} d:AbsoluteAltitude="7">') == (2.5, 1.5, 7.0)
    assert position(f"{lat}>") == position(f"{lon}>") == (*exif, 500.0)
    assert position('d:AbsoluteAltitude="0" d:RelativeAltitude="9">') == (*exif, 0.0)
    zero = 'd:GpsLatitude="0" d:GpsLongitude="{}">'
    assert position(zero.format(0)) == (*exif, 500.0) and position(zero.format(3))[:2] == (3.0, 0.0)
    assert position('d:GpsLatitude="4" d:GpsLongitude="0">')[:2] == (0.0, 4.0)
    assert position(f'd:GpsLatitude="4700" {lon} d:AbsoluteAltitude="1e400">') == (*exif, 500.0)
    for name in ("GpsLongitude", "GpsLongtitude", "Longitude"):
        assert position(f'd:Latitude="1" d:{name}="2">')[:2] == (2.0, 1.0)
    gimbal = 'd:GimbalRollDegree="3" d:GimbalYawDegree="1" d:GimbalPitchDegree="2">'
    position(gimbal)
    assert read_tags(tmp_path / "a.jpg").gimbal_deg == (1.0, 2.0, 3.0)


def test_places_of_xmp_and_exif_that_are_far_apart(tmp_path: Path) -> None:
    """A second of latitude is 30.89 m at 47.5 degrees: told, and .95 of it, 29.3 m, is not.

    From 47.5 N, 16.5 E to 47.5 S, 16.5 E it is 2 (N (1 - e^2)) sin 47.5 degrees through the Earth.
    """
    images = tmp_path / "images"
    images.mkdir()
    sine = np.sin(np.radians(47.5))
    of_e2 = 1.0 - 0.00669437999014 * sine**2
    through_m = 2.0 * 6378137.0 * (1.0 - 0.00669437999014) / of_e2**0.5 * sine

    def place(name: str, latitude: float, exif: bool = True) -> float:
        xmp = f'd:GpsLatitude="{latitude:.9f}" d:GpsLongitude="16.5">'
        of_exif = (47, 30, 0) if exif else None
        tagged_image(images / name, of_exif, (16, 30, 0), "NE", 500.0, xmp=xmp)
        return read_tags(images / name).apart_m

    assert np.isnan(place("e.jpg", 10.0, exif=False))
    file = InputFile("images", images)
    place("a.jpg", 47.5 + 0.95 / 3600.0)
    assert read_by_content(TRACK_FORMATS, file).doubts == ()
    place("b.jpg", 47.5 - 1.0 / 3600.0)
    one = read_by_content(TRACK_FORMATS, file).doubts
    assert_close("ratio", place("c.jpg", -47.5) / through_m, 1.0)
    place("d.jpg", 48.5)
    place("f.jpg", 48.5)
    assert_approved([*one, *read_by_content(TRACK_FORMATS, file).doubts])


@pytest.mark.parametrize(
    ("xmp_m", "exif_m", "reference", "told"),
    [
        (510.5, 500.0, 0, True),
        (509.5, 500.0, 0, False),
        (67.67, 67.0, 0, False),  # EXIF in whole metres
        (50.33, 50.33, 1, False),  # XMP without the sign that EXIF has
        (-50.33, 50.33, 1, False),
        (-50.33, 50.33, 0, False),
        (531.0, 500.0, 2, False),  # above the ellipsoid, as EXIF says
        (500.0, 0.0, 0, False),  # of a receiver that has none
        (0.0, 500.0, 0, True),
        (530.0, 500.0, 1, True),  # 500 below the sea
    ],
)
def test_heights_of_xmp_and_exif_that_are_far_apart(
    tmp_path: Path, xmp_m: float, exif_m: float, reference: int, told: bool
) -> None:
    xmp = f'd:AbsoluteAltitude="{xmp_m:+}">'
    tagged_image(tmp_path / "a.jpg", (47, 30, 0), (16, 30, 0), "NE", exif_m, reference, xmp=xmp)
    doubts = read_by_content(TRACK_FORMATS, InputFile("images", tmp_path)).doubts
    assert bool(doubts) is told
    if told:
        assert_approved(doubts[0])


def test_an_image_whose_place_is_told_is_not_told_again_for_its_height(tmp_path: Path) -> None:
    xmp = 'd:GpsLatitude="48" d:GpsLongitude="16.5" d:AbsoluteAltitude="800">'
    tagged_image(tmp_path / "a.jpg", (47, 30, 0), (16, 30, 0), "NE", 500.0, xmp=xmp)
    (doubt,) = read_by_content(TRACK_FORMATS, InputFile("images", tmp_path)).doubts
    assert "GpsLatitude" in doubt


def test_doubts_of_places_are_warnings_of_the_flight(tmp_path: Path) -> None:
    project = images_project(tmp_path)
    assert not vopd.solve_flight(project).findings
    image = tmp_path / "images" / "IMG_3.JPG"
    plain = image.read_bytes()
    packet = plain[2 : 4 + int.from_bytes(plain[4:6], "big")]
    tagged_image(image, (10, 0, 0), (16, 0, 0), "NE", 500.0, size_px=SIZE)
    image.write_bytes(image.read_bytes()[:2] + packet + image.read_bytes()[2:])
    assert_approved([str(one) for one in vopd.solve_flight(project).findings])


def test_tags_of_tiff_and_images_in_a_folder(tmp_path: Path) -> None:
    """XMP is tag 700 of TIFF; letters that are not UTF-8 do no harm."""
    for name in ("d.tiff", "c.TIF", "b.JPEG", "a.jpg"):
        Image.new("RGB", (6, 4)).save(tmp_path / name)
    (tmp_path / "e.png").write_bytes(b"")
    (tmp_path / "more").mkdir()
    Image.new("RGB", (6, 4)).save(tmp_path / "more" / "f.jpg")
    assert [path.name for path in images_in(tmp_path)] == ["a.jpg", "b.JPEG", "c.TIF", "d.tiff"]
    assert images_in(tmp_path / "a.jpg") == [tmp_path / "a.jpg"]
    assert images_in(tmp_path / "e.png") == images_in(tmp_path / "none") == []
    xmp = b'\xfc d:GpsLatitude="1.5" d:GpsLongitude="2.5">'
    Image.new("RGB", (6, 4)).save(tmp_path / "d.tiff", tiffinfo={700: xmp})
    tags = read_tags(tmp_path / "d.tiff")
    assert tags.position[:2] == (2.5, 1.5) and tags.size_px == (6, 4)
    assert xmp_text(SimpleNamespace(info={"xmp": "of some readers"})) == "of some readers"
    assert xmp_text(SimpleNamespace(info={})) == ""
    for encoding in ("utf-8", "utf-16", "utf-16-le", "utf-16-be"):
        packet = "<x:xmpmeta>é</x:xmpmeta>".encode(encoding)
        assert xmp_text(SimpleNamespace(info={"xmp": packet})) == "<x:xmpmeta>é</x:xmpmeta>"
    assert xmp_text(SimpleNamespace(info={}, tag_v2={700: b"of others"})) == "of others"
    with refused(VopdError):
        read_tags(tmp_path / "e.png")


def test_images_of_another_kind_than_their_suffix_says(tmp_path: Path) -> None:
    """Of a PNG all pixels are decoded for its tags: one of more than 20 megapixels is not read."""
    for name, size in (("small", (64, 48)), ("large", (5000, 4001))):
        Image.new("1", size).save(tmp_path / f"{name}.jpg", format="PNG")
    tags = read_tags(tmp_path / "small.jpg")
    assert tags.size_px == (64, 48) and not tags.is_placed and not tags.damage
    with refused(VopdError):
        read_tags(tmp_path / "large.jpg")
    with refused(VopdError):
        read_tags(tmp_path / "a\0.jpg")


def test_a_place_without_a_height_is_no_position_and_says_so(tmp_path: Path) -> None:
    """As telephones write it where they do not know it: 0/0, or nothing."""
    gps = {1: "N", 2: (47.0, 30.0, 0.0), 3: "E", 4: (16.0, 30.0, 0.0)}
    for name, more in (("a.jpg", {}), ("b.jpg", {5: b"\0", 6: Rational(0, 0)})):
        exif = Image.Exif()
        exif[0x8825] = gps | more
        Image.new("RGB", (6, 4)).save(tmp_path / name, exif=exif)
        tags = read_tags(tmp_path / name)
        assert np.isfinite(tags.position).tolist() == [True, True, False] and not tags.is_placed
        assert_approved(tags.damage)


def test_angles_by_zero_are_no_position(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x8825] = {1: "N", 2: (Rational(1, 1), Rational(1, 1)), 3: "E", 4: (1.0, 2.0, 3.0)}
    Image.new("RGB", (6, 4)).save(tmp_path / "a.jpg", exif=exif)
    tags = read_tags(tmp_path / "a.jpg")
    assert np.isnan(tags.position).all()
    assert_approved(tags.damage)


ODD = [OSError("v"), ValueError("v"), TypeError("v"), KeyError("v"), IndexError("v"),
       ZeroDivisionError("v"), SyntaxError("v")]  # fmt: skip


@pytest.mark.parametrize("error", ODD, ids=lambda error: type(error).__name__)
def test_whatever_pillow_says_of_a_file_is_told_with_its_name(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: Any) -> None:
        raise error

    tagged_image(tmp_path / "a.jpg")
    monkeypatch.setattr(image_tags, "exif_position", fails)
    assert_approved(read_tags(tmp_path / "a.jpg").damage)
    monkeypatch.setattr(image_tags, "xmp_text", fails)
    with refused(VopdError):
        read_tags(tmp_path / "a.jpg")


# A folder of them


def folder(place: Path, *images: dict[str, Any]) -> InputFile:
    for k, one in enumerate(images):
        tagged_image(place / f"{k}.jpg", **one)
    return InputFile("images", place)


HERE = {"latitude": (47, 30, 0), "longitude": (16, 30, 0)}
YAW = 'd:GimbalYawDegree="{}" d:GimbalPitchDegree="2" d:GimbalRollDegree="3">'
CLOCK = {"taken": "2026:05:01 12:00:00", "part": "5", "zone": "+02:00"}


def test_a_folder_as_a_track(tmp_path: Path) -> None:
    """Gimbal angles and times of those that have them; no times where one lacks its zone."""
    file = folder(tmp_path, HERE | CLOCK, CLOCK, HERE | CLOCK | {"altitude_m": 7.0})
    rows = read_by_content(TRACK_FORMATS, file)
    assert rows.image == ["0.jpg", "2.jpg"]
    assert rows.coordinate.tolist() == [[16.5, 47.5, 0.0], [16.5, 47.5, 7.0]]
    assert rows.time_s.tolist() == [NOON - 7199.5] * 2 and rows.clock == "utc"
    assert_approved(rows.said)
    assert (rows.geodetic, rows.crs, rows.height, rows.gimbal_deg) == (
        True,
        "EPSG:4326",
        None,
        None,
    )
    assert not rows.whole_seconds
    folder(tmp_path, HERE)
    rows = read_by_content(TRACK_FORMATS, file)
    assert same(rows.time_s, [NAN, NOON - 7199.5]) and not rows.whole_seconds
    assert_approved(rows.said)
    folder(tmp_path, HERE | CLOCK | {"part": ""})
    assert read_by_content(TRACK_FORMATS, file).whole_seconds
    folder(tmp_path, HERE | CLOCK | {"zone": "", "xmp": YAW.format(1)})
    rows = read_by_content(TRACK_FORMATS, file)
    assert rows.time_s is None and rows.clock is None
    assert same(rows.gimbal_deg, [[1, 2, 3], [NAN] * 3])
    assert_approved(rows.said)
    folder(tmp_path, {"xmp": 'd:GpsLatitude="1.5" d:GpsLongitude="2.5">'})  # and no altitude
    assert read_by_content(TRACK_FORMATS, file).image == ["2.jpg"]
    for k in (0, 2):
        (tmp_path / f"{k}.jpg").unlink()
    with refused(VopdError):
        read_by_content(TRACK_FORMATS, file)


def test_other_files_beside_images_are_none_of_them(tmp_path: Path) -> None:
    """Notes, videos, previews and folders beside photographs."""
    file = folder(tmp_path, HERE | CLOCK, HERE | CLOCK)
    for name in ("notes.txt", "0.xmp", "0.lrf", "0.dng.lst", "flight.mp4", "Thumbs.db"):
        (tmp_path / name).write_text("47.5 16.5 0\n")
    (tmp_path / "2.jpg.d").mkdir()
    track, (taken, said, _) = read_by_content(TRACK_FORMATS, file), times(file)
    assert track.image == [*taken] == ["0.jpg", "1.jpg"]
    assert_approved([track.said, said])
    new = NewProject()
    for name in track.image:
        tagged_image(tmp_path / name, lens={0xA405: 27})
    look_at_focal(new, {}, tmp_path)
    assert_approved(new.said)


def test_a_folder_without_images_is_no_track(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(b"")
    with refused(VopdError):
        read_by_content(TRACK_FORMATS, folder(tmp_path))


def times(file: InputFile, **keys: Any) -> Any:
    return times_of_images(Section("p.toml", "picks", keys), file)


def test_a_folder_as_times(tmp_path: Path) -> None:
    file = folder(tmp_path, CLOCK, {}, CLOCK | {"zone": "-05:30", "part": "25"})
    known, sentence, whole = times(file)
    assert known == {"0.jpg": NOON - 7199.5, "2.jpg": NOON + 19800.25}
    assert_approved(sentence)
    assert not whole
    with refused(VopdError):
        times(file, utc_offset_h=2)
    folder(tmp_path, CLOCK | {"zone": "", "part": ""})
    for hours, said in ((2, "+2"), (-12, "-12"), (14, "+14"), (5.75, "+5.75"), (0, "+0")):
        known, sentence, whole = times(file, utc_offset_h=hours)
        assert known == {"0.jpg": NOON - hours * 3600.0, "2.jpg": NOON + 19800.25}
        assert_approved(sentence, parts=[said])
        assert whole
    for hours in (-12.25, 14.25):
        with refused(VopdError, parts=[f"{hours:g}"]):
            times(file, utc_offset_h=hours)
    with refused(VopdError):
        times(file)
    folder(tmp_path, {}, {}, {})
    with refused(VopdError):
        times(file)


# Times of frames that are images: from their tags, with their zone or the project's


TIMES = '\n[picks]\nfile = "picks.csv"\npixel_grid = "centre"\ntimes = "images"\n'


def project_of_images(
    folder: Path, zone: str = "+02:00", more: str = "", part: bool = True
) -> Path:
    """The frames of the project as images whose clock is 2 h ahead of UTC; a track by time.

    Frame k is of 11:58:44 UTC and k tenths, 2 s and k tenths after the epoch.
    """
    start, rest = TOML.split("[picks]")
    project = write_project(folder, start + TIMES + more + rest[rest.index("[landmarks]") :])
    (folder / "images").mkdir()
    for k in range(5):
        tagged_image(
            folder / "images" / f"IMG_{k}.JPG",
            taken="2026:05:01 13:58:44",
            part=str(k) if part else "",
            zone=zone,
        )
    picks = folder / "picks.csv"
    rows = [f"IMG_{row[0]}.JPG{row[1:]}" for row in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    return project


def test_a_time_with_part_of_a_second_and_zone(tmp_path: Path) -> None:
    """13:58:44.25 at two hours ahead is 11:58:44.25 UTC."""
    path = tmp_path / "a.jpg"
    tagged_image(path, taken="2026:05:01 13:58:44", part="250", zone="+02:00")
    tags = read_tags(path)
    expected = datetime(2026, 5, 1, 11, 58, 44, 250_000, tzinfo=UTC).timestamp()
    assert (tags.clock_s - tags.zone_s, tags.zone_s, tags.whole_second) == (expected, 7200.0, False)


@pytest.mark.parametrize("taken", ["", "    :  :     :  :  ", "2026-05-01", "0000:00:00 00:00:00"])
def test_a_clock_that_was_never_set_is_no_time(tmp_path: Path, taken: str) -> None:
    tagged_image(tmp_path / "a.jpg", taken=taken, part="25", zone="west")
    tags = read_tags(tmp_path / "a.jpg")
    assert np.isnan([tags.clock_s, tags.zone_s]).all() and tags.whole_second


def test_frames_have_the_times_of_their_images(tmp_path: Path) -> None:
    flight = vopd.solve_flight(project_of_images(tmp_path))
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert flight.estimate.time_s.round(6).tolist() == [2.0, 2.1, 2.2, 2.3, 2.4]
    assert flight.findings == ()
    assert_approved(flight.about)


def test_the_project_gives_a_zone_that_the_tags_do_not_have(tmp_path: Path) -> None:
    project = project_of_images(tmp_path, zone="")
    with refused(VopdError):
        vopd.solve_flight(project)
    text = project.read_text()
    project.write_text(text.replace('"images"', '"images"\nutc_offset_h = 2.0'))
    flight = vopd.solve_flight(project)
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    project.write_text(text.replace('"images"', '"images"\nutc_offset_h = 1.0'))
    with refused(VopdError):
        vopd.solve_flight(project)
    project.write_text(text.replace('"images"', '"images"\nutc_offset_h = 15.0'))
    with refused(VopdError):
        vopd.solve_flight(project)


def test_a_zone_that_the_tags_have_is_not_given_again(tmp_path: Path) -> None:
    project = project_of_images(tmp_path, more="utc_offset_h = 2.0\n")
    with refused(VopdError):
        vopd.solve_flight(project)


def test_whole_seconds_are_a_finding_unless_the_project_allows_for_them(tmp_path: Path) -> None:
    """The camera's velocity is 5, 20 and 2 m/s, together 20.7."""
    project = project_of_images(tmp_path, part=False)
    (finding,) = vopd.solve_flight(project).findings[:1]
    assert "whole seconds, in which the camera moves 20.7 m" in str(finding)
    text = project.read_text().replace('sigma_t_s = "exact"', "sigma_t_s = 0.3")
    project.write_text(text)
    assert not any("whole seconds" in str(one) for one in vopd.solve_flight(project).findings)


def test_images_without_times_and_a_folder_of_other_images(tmp_path: Path) -> None:
    project = project_of_images(tmp_path)
    for path in (tmp_path / "images").iterdir():
        path.rename(path.with_name(f"other_{path.name}"))
    with refused(VopdError):
        vopd.solve_flight(project)
    for path in (tmp_path / "images").iterdir():
        tagged_image(path)
    with refused(VopdError):
        vopd.solve_flight(project)
    for path in (tmp_path / "images").iterdir():
        path.unlink()
    with refused(VopdError):
        vopd.solve_flight(project)


def test_a_new_project_takes_times_from_images_beside_a_track(tmp_path: Path) -> None:
    project_of_images(tmp_path / "a", zone="")
    files = tmp_path / "a"
    ran = run(
        "new", tmp_path / "new", "--images", files / "images", "--picks", files / "picks.csv",
        "--track", files / "track.csv",
    )  # fmt: skip
    assert ran.status == 0
    assert_approved(ran.stdout)
    assert "needed: [picks] utc_offset_h" in ran.stdout
    text = (tmp_path / "new" / "flight.toml").read_text()
    assert 'times = "../a/images"' in text and 'file = "../a/track.csv"' in text


@pytest.mark.parametrize(
    "rows",
    [
        "0,2.0\n1,1.9\n",
        "1,2.0\n0,2.1\n",
        "0,2.0\n0,2.1\n",
        "0.5,2.0\n",
        "7,2.0\n",
    ],
)
def test_times_of_frames_that_cannot_be(tmp_path: Path, rows: str) -> None:
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0"
    project = write_project(tmp_path, TOML.replace(rate, 'times = "t.csv"'))
    (tmp_path / "t.csv").write_text(f"frame,t_s\n{rows}")
    with refused(VopdError):
        vopd.solve_flight(project)
    good = "".join(f"{k},{2.0 + k / 10}\n" for k in range(5))
    (tmp_path / "t.csv").write_text(f"frame,t_s\n{good}")
    assert_close(
        "flight angle", vopd.solve_flight(project).camera_deg, truth_deg() % 360.0 - [0, 360, 0]
    )


def test_a_track_of_images_with_times_gives_positions_times_and_velocity(tmp_path: Path) -> None:
    """Positions belong to the images, so that other times of the frames are not needed."""
    project = project_of_images(tmp_path)
    text = project.read_text().replace('times = "images"\n', "")
    project.write_text(text.replace('"track.csv"', '"images.csv"'))
    where = geodetic(camera_m(2.0 + np.arange(5) / 10.0))
    rows = [
        f"IMG_{k}.JPG,{2.0 + k / 10},{a:.12f},{b:.12f},{h:.6f},0.5"
        for k, (a, b, h) in enumerate(zip(*where, strict=True))
    ]
    head = "image,t_s,lat_deg,lon_deg,h_m,sigma_m"
    (tmp_path / "images.csv").write_text("\n".join([head, *rows]))
    flight = vopd.solve_flight(project)
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert flight.estimate.time_s.round(6).tolist() == [2.0, 2.1, 2.2, 2.3, 2.4]
    velocity = flight.flight.path.velocity_m_s
    assert velocity is not None and np.abs(velocity - [20.0, 5.0, -2.0]).max() < within(
        "speed of images"
    )
    fixes = flight.flight.path.fixes
    assert fixes is not None and fixes.sigma_m.tolist() == [[0.5, 0.5, 0.5]] * 5


@pytest.mark.parametrize(
    ("lens", "focal_px"),
    [
        ({0xA405: 27}, 48.0),  # 27 of 36 mm, of 64 px
        ({0x920A: Rational(45, 10), 0xA20E: Rational(2540, 1), 0xA210: 2}, 450.0),  # 100 px a mm
        ({0x920A: Rational(45, 10), 0xA20E: Rational(200, 1), 0xA210: 3}, 90.0),
        ({0xA405: 0, 0x920A: Rational(45, 10)}, np.nan),
        ({}, np.nan),
    ],
)
@pytest.mark.parametrize("size_px", [(64, 48), (48, 64)], ids=["lying", "upright"])
def test_focal_lengths_by_tags(
    lens: dict[int, object], focal_px: float, size_px: tuple[int, int], tmp_path: Path
) -> None:
    """The longer side of a film's frame is that of the image, be it held upright."""
    tagged_image(tmp_path / "a.jpg", lens=lens, size_px=size_px)
    assert_close("ratio", read_tags(tmp_path / "a.jpg").focal_px, focal_px)


def test_a_new_project_begins_with_the_focal_length_of_the_tags(tmp_path: Path) -> None:
    new, values = NewProject(needed={("camera", "lens"): "", ("camera", "image_size_px"): ""}), {}
    for name in ("a.jpg", "b.jpg"):
        tagged_image(tmp_path / name, lens={0xA405: 27})
    look_at_focal(new, values, tmp_path)
    assert values == {
        ("camera", "lens"): '{ model = "brown", fx_px = 48 }',
        ("camera", "image_size_px"): "[64, 48]",
        ("uncertainty", "focal_rel"): "0.05",
    }
    assert not new.needed and len(new.said) == 1
    assert_approved(new.said[0])
    for lens in ({0xA405: 28}, {}):  # of another zoom, and of none
        tagged_image(tmp_path / "c.jpg", lens=lens)
        other, none = NewProject(), dict[tuple[str, str], str]()
        look_at_focal(other, none, tmp_path)
        assert not none
        assert_approved(other.said[0].removeprefix(str(tmp_path)))


def test_images_of_another_size_or_focal_length_than_the_lens_are_doubted() -> None:
    """The lens has 1495 px: a zoom at 7 times that, and pictures half as large, were silent."""

    def doubts(size_px: tuple[int, int], focal_px: float, kind: LensKind = LENS.kind) -> list[str]:
        where, clock = (16.0, 47.0, 500.0), float("nan")
        one = ImageTags(where, where, size_px, clock, clock, True)
        one = one._replace(focal_px=focal_px, focal_by="FocalLengthIn35mmFilm, 28 mm")
        lens = replace(LENS, kind=kind)
        return doubts_of_tags({"A.JPG": one}, ["B.JPG", "a/A.JPG"], lens)

    half, turned = (SIZE[0] // 2, SIZE[1] // 2), (SIZE[1], SIZE[0])
    odd = [(half, 1495.0), (turned, float("nan")), (SIZE, 1495.0 * 1.31), (SIZE, 1495.0 / 1.31)]
    assert_approved([told for one in odd for told in doubts(*one)])
    for focal_px in (1495.0 * 1.29, 1495.0 / 1.29, float("nan")):
        assert not doubts(SIZE, focal_px)
    assert not doubts(SIZE, 400.0, LensKind.FISHEYE) and not doubts_of_tags({}, ["A.JPG"], LENS)


def test_a_picture_of_another_size_than_the_lens_is_a_warning_of_the_flight(tmp_path: Path) -> None:
    project = images_project(tmp_path)
    before = len(read_flight(str(project)).findings)
    place = (47, 38, 36.6), (16, 28, 33.2)
    tagged_image(tmp_path / "images" / "IMG_1.JPG", *place, altitude_m=540.0)
    assert len(read_flight(str(project)).findings) == before + 1


def test_a_lens_that_is_named_is_not_that_of_the_tags(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    tagged_image(tmp_path / "images" / "a.jpg", lens={0xA405: 27})
    lens = ROOT / "examples" / "shore" / "intrinsics.json"
    files = ("--images", tmp_path / "images", "--lens", lens)
    ran = run("new", tmp_path / "new", *files, "--position", "47.6435,16.4759,540")
    assert ran.status == 0
    given = tomllib.loads((tmp_path / "new" / "flight.toml").read_text())["camera"]["lens"]
    assert Path(given).name == lens.name


@pytest.mark.parametrize("lens", ["1500", str(ROOT / "examples" / "shore" / "intrinsics.json")])
@pytest.mark.parametrize("stated", ["", "0.05", "0.01"])
def test_a_later_lens_is_not_as_uncertain_as_that_of_the_tags(
    lens: str, stated: str, tmp_path: Path
) -> None:
    """The calibration of a second `vopd new` was to 5 %, as the focal length of EXIF's tags is."""
    (tmp_path / "images").mkdir()
    tagged_image(tmp_path / "images" / "a.jpg", lens={0xA405: 27}, size_px=(1024, 768))
    place = "--position", "47.6435,16.4759,540"
    assert run("new", tmp_path / "p", "--images", tmp_path / "images", *place).status == 0
    of_tags = tomllib.loads((tmp_path / "p" / "flight.toml").read_text())["uncertainty"]
    more = [f"--set=uncertainty.focal_rel={stated}"] if stated else []
    assert run("new", tmp_path / "p", "--lens", lens, *more).status == 0
    now = tomllib.loads((tmp_path / "p" / "flight.toml").read_text())["uncertainty"]
    assert of_tags == {"focal_rel": 0.05}
    assert now == ({"focal_rel": float(stated)} if stated else {})


@pytest.mark.parametrize("suffix", [".jpg", ".tif", ".png"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_the_size_of_an_image_is_that_of_the_upright_one(
    orientation: int, suffix: str, tmp_path: Path
) -> None:
    """Clicks on the page of a photograph in portrait were taken for those of one in landscape.

    Of a TIFF newer versions of Pillow exchange width and height by themselves.
    """
    exif, path = Image.Exif(), tmp_path / f"a{suffix}"
    exif[274] = orientation
    Image.new("RGB", (64, 48)).save(path, exif=exif)
    upright = (48, 64) if orientation > 4 else (64, 48)
    assert read_tags(path).size_px == upright_size(path) == upright
    assert [one.size for one in open_frames([str(path)]).pictures([0])] == [upright]


@pytest.mark.parametrize(("reference", "sign"), [(0, 1), (1, -1), (2, 1), (3, -1)])
def test_references_of_heights(reference: int, sign: int) -> None:
    """EXIF 3.0 has 2 and 3 for heights above and below the ellipsoid."""
    gps = {1: "N", 2: (48, 0, 0), 3: "E", 4: (15, 0, 0), 5: bytes([reference]), 6: 30.0}
    assert exif_position(gps) == (15.0, 48.0, sign * 30.0)


def test_images_of_two_sizes_have_no_size(tmp_path: Path) -> None:
    """The size of the first was that of all."""
    tagged_image(tmp_path / "a.jpg", size_px=(64, 48))
    tagged_image(tmp_path / "b.jpg", size_px=(48, 64))
    (tmp_path / "clicks.csv").write_text(f"{CLICKS}\nimage,landmark,u_px,v_px\na.jpg,x,1,2\n")
    given = {"images": str(tmp_path), "picks": str(tmp_path / "clicks.csv")}
    new = project_of_files(tmp_path / "new", given)
    assert ("camera", "image_size_px") in new.needed
    assert_approved([one.partition(": ")[2] for one in new.said if " x " in one])


@pytest.mark.parametrize("suffix", [".jpg", ".tif"])
def test_tags_of_more_pixels_than_are_decoded(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of JPEG and TIFF the header alone is read, whatever the size; others are decoded."""
    monkeypatch.setattr("vopd.flight.formats.image_tags.MOST_PIXELS", 1_000_000)
    size = 1200, 900
    Image.new("L", size).save(tmp_path / f"a{suffix}")
    assert read_tags(tmp_path / f"a{suffix}").size_px == size
    Image.new("L", size).save(tmp_path / "a.png")
    with refused(VopdError):
        read_tags(tmp_path / "a.png")


def test_the_first_of_several_images_that_cannot_be_read_is_named() -> None:
    """Whatever its position is of one that is damaged elsewhere."""
    nan, size_px = (np.nan,) * 3, (64, 48)
    placed = ImageTags((15.0, 47.0, 400.0), nan, size_px, 0.0, 0.0, False, damage="placed")
    odd = placed._replace(position=nan, damage="odd")
    every = {Path("a.jpg"): placed, Path("b.jpg"): odd, Path("c.jpg"): odd}
    assert damage_text(every, []) == " (b.jpg: odd)"
    assert damage_text(every, ["x.jpg: none", "y.jpg: none"]) == " (x.jpg: none)"
    assert damage_text({Path("a.jpg"): placed}, []) == ""
