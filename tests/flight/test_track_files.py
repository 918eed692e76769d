"""Every field and line of files of tracks: MRK, RTKLIB, geo.txt, GPX, and tables."""

from __future__ import annotations

import json
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit import flight_files
from tests.kit.command import vopd as run
from tests.kit.flight_project import TOML, camera_m, read_text, text_told, truth_deg, write_project
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import InputFile, open_input
from vopd.flight.formats.track import (
    TRACK_FORMATS,
    new_positions,
    photo_number,
    read_mrk,
)
from vopd.flight.project.read import read_flight
from vopd.geometry.earth import geodetic


def read(text: str) -> Any:
    return read_text(TRACK_FORMATS, "t", text)


def told(text: str) -> str:
    return text_told(TRACK_FORMATS, "t", text)


# The file of a drone's receiver

MARK = (
    "{photo}\t{second}\t[{week}]\t{n},N\t{e},E\t{v},V\t{lat},Lat\t{lon},Lon\t{h},Ellh\t{sigmas}"
    "\t{q},Q\n"
)
USUAL = {
    "photo": "7", "second": "1.5", "week": "2300", "n": "300", "e": "-400", "v": "1200",
    "lat": "47.6", "lon": "16.4", "h": "540", "sigmas": "1.0, 2.0, 3.0", "q": "50",
}  # fmt: skip


def mark(**fields: Any) -> str:
    return MARK.format(**(USUAL | {name: str(value) for name, value in fields.items()}))


def test_a_photo_of_a_drone() -> None:
    """Week 2300 began on 2024-02-04; (.3, -.4, 1.2) is 1.3 m long."""
    rows = read("\n" + mark() + "\n" + mark(photo="009", second=0, n=0, e=-60, v=0, lon=-16.5))
    assert rows.image == ["7", "9"] and [*rows.line] == [2, 4]
    assert rows.coordinate.tolist() == [[16.4, 47.6, 540.0], [-16.5, 47.6, 540.0]]
    week = datetime(2024, 2, 4, tzinfo=UTC).timestamp()
    assert rows.time_s.tolist() == [week + 1.5, week] and rows.clock == "gps"
    assert rows.sigma_m.tolist() == [[2.0, 1.0, 3.0]] * 2
    assert (rows.geodetic, rows.crs, rows.height) == (True, "EPSG:4326", "ellipsoid")
    assert_approved(rows.said)
    assert rows.velocity_m_s is None and rows.gimbal_deg is None and not rows.whole_seconds
    assert rows.image_key("a/MAX_0029.JPG") == "29"


def test_photos_without_a_fix_are_counted_and_without_a_position_left_out() -> None:
    marks = [mark(photo=k, q=q) for k, q in enumerate((50, 16, 0, 34, 1, 51, 50), 1)]
    rows = read("".join(marks))
    assert rows.image == ["1", "2", "4", "5", "6", "7"] and [*rows.line] == [1, 2, 4, 5, 6, 7]
    assert_approved(rows.said)
    assert_approved(read(mark(q=16)).said)
    assert_approved(told(mark(q=0)))


NUMBERS = ("second", "n", "e", "v", "lat", "lon", "h", "q")


@pytest.mark.parametrize(
    "first",
    [
        b"\x0e\x20\xe8\x03\x50\x00\x00\x00.FIT\x7c\x9d",  # the header of FIT, 14 bytes
        b"\xa3\x95\x80\x80\x59FMT\0BBnNZ",
        b"ULog\x01\x12\x35\x01\0",
    ],
)
def test_logs_without_text_are_named_with_what_makes_a_track_of_them(
    first: bytes, tmp_path: Path
) -> None:
    (tmp_path / "log").write_bytes(first)
    assert_approved(run("new", tmp_path / "p", "--track", tmp_path / "log").stderr)


NOT_LOGS = {
    "an own header": "$TIME,lat,lon\n",
    "an own header of five letters": "$TIMES,lat,lon\n1,47.1,8.2\n",
    "landmarks of a currency": "$POINT,47.1,8.2,400\n$TOWER,47.1,8.2,400\n",
    "a landmark": "$LAND1,47.1,8.2,400\n",
    "a landmark of another log": "FMT, 128, 89, 400\n",
    "landmarks": "ANTENNA,47.1,8.2,400\nHFDTE1,47.2,8.2,400\n",
    "an image of FITS": "IMG_0012.FIT,m1,3,4\n",
}


@pytest.mark.parametrize("name", NOT_LOGS)
def test_tables_that_begin_as_logs_nearly_do_are_none(name: str) -> None:
    assert not InputFile("x", Path("x"), NOT_LOGS[name]).logs


@pytest.mark.parametrize(
    "text",
    [
        "$GNRMC,091200,A\n", "$PUBX,00,1\n", "$PSRF103,0\n", "AFLA7AB\nHFDTE010124\n",
        "AXCC001\nHFFXA035\nHFDTEDATE:010124,01\n", "$SDDBT,7.8,f,2.4,M,1.3,F*0D\r\n$",
        '<?xml version="1.0"?>\n<!-- of <a> logger -->\n<!-- 2 --><kml xmlns="x">',
        "<!-- TCX --> <TrainingCenterDatabase>", "FMT, 128, 89, FMT, BBnNZ, Type\n",
    ],
)  # fmt: skip
def test_logs_are_recognised_by_their_first_lines(text: str) -> None:
    assert len(InputFile("x", Path("x"), text).logs) == 1


def test_marks_whose_fields_are_not_as_known() -> None:
    lines = [
        *(mark().replace(f",{name}", f",{name}x")
          for name in ("N", "E", "V", "Lat", "Lon", "Ellh", "Q")),
        mark().replace("3.0\t", ""), mark().replace("\n", "\t5\n"),
    ]  # fmt: skip
    (said,) = {told(mark() + "\n" + line) for line in lines}
    assert_approved(said)


def test_marks_whose_numbers_are_impossible() -> None:
    fields = [
        *({name: value} for name in NUMBERS for value in ("nan", "inf")),
        {"sigmas": "1, nan, 3"}, {"lat": 90.5}, {"lat": -90.5}, {"week": 0}, {"week": 10_000},
        {"week": -1},
    ]  # fmt: skip
    (said,) = {told(mark() + "\n" + mark(**one)) for one in fields}
    assert_approved(said)


@pytest.mark.parametrize("name", [*NUMBERS, "photo", "week"])
def test_marks_with_a_text_for_a_number(name: str) -> None:
    assert_approved(told(mark() + "\n" + mark(**{name: "x"})))


def test_marks_at_their_limits() -> None:
    for fields in ({"lat": 90}, {"lat": -90}, {"lon": 181}, {"week": 1}, {"week": 9999}):
        assert len(read(mark() + mark(**fields)).coordinate) == 2
    assert read(" " + mark().replace("\t", "  ")).image == ["7"]


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("MAX_0029.JPG", "29"), ("DJI_20230101120000_0029_V.JPG", "29"), ("12/IMG_0007.JPG", "7"),
        ("DJI_20230101120000_0031.JPG", "31"), ("DJI_20230101120000_00315.JPG", "315"),
        ("DJI_0042_W.JPG", "42"), ("DJI_0042_W2.JPG", "42"), ("DJI_0042_W2_.JPG", "42"),
        ("DJI_0042-2.jpg", "42"), ("DJI_0042 (2).jpg", "42"), ("MAX_42_2.JPG", "2"),
        ("100_0001_0042_edit.tif", "42"),
        ("a.b_05.tif", "5"), ("0000.jpg", "0"), ("DJI_20230101120000_0029_V_12.JPG", "29"),
        ("DJI_20230101120000_031_V_12.JPG", "12"), ("church.JPG", "church.JPG"), ("7", "7"),
        ("a_7_W/x.jpg", "a_7_W/x.jpg"),
        ("DJI_202301011200_0029_0031.JPG", "31"),
    ],
)  # fmt: skip
def test_numbers_in_names_of_photos(name: str, number: str) -> None:
    assert photo_number(name) == number


# geo.txt


def test_lines_of_a_geo_txt() -> None:
    text = (
        "  EPSG:32633 \n# A 1 2 3\n\nB.JPG 600000.5 5277000 500.25 1 2 3 0.1 0.2\n  C.JPG 1 2 3\n"
    )
    rows = read(text)
    assert rows.coordinate.tolist() == [[600000.5, 5277000.0, 500.25], [1.0, 2.0, 3.0]]
    assert (rows.image, [*rows.line], rows.crs) == (["B.JPG", "C.JPG"], [4, 5], "EPSG:32633")
    assert_approved(rows.said)
    assert (rows.geodetic, rows.clock, rows.time_s, rows.height) == (False, None, None, None)
    assert rows.velocity_m_s is None and rows.gimbal_deg is None
    assert rows.sigma_m[0].tolist() == [0.1, 0.1, 0.2] and np.isnan(rows.sigma_m[1]).all()
    assert [*read("EPSG:4326\nA 1 2 3\n").line] == [2]
    below = read("\n \nEPSG:4326\nA 1 2 3\n")  # ODM takes them too
    assert ([*below.line], below.crs) == ([4], "EPSG:4326")


@pytest.mark.parametrize(
    "line",
    ["A.JPG 1 2", "A.JPG nan 2 3", "A.JPG 1 inf 3", "A.JPG 1 2 nan", "#"],
)
def test_geo_txt_that_is_refused(line: str) -> None:
    assert_approved(told(f"EPSG:4326\n\n{line}\n"))


def test_words_behind_the_angles_of_a_geo_txt_are_no_accuracies() -> None:
    rows = read("EPSG:4326\nA.JPG 1 2 3 4 5 6 north wall\nB.JPG 1 2 3 4 5 6 0.1 wall\n")
    assert rows.sigma_m is None and rows.coordinate.tolist() == [[1.0, 2.0, 3.0]] * 2


def test_geo_txt_with_a_text_for_a_number() -> None:
    assert_approved(told("EPSG:4326\n\nA.JPG 1 x 3\n"))


# GPX


@pytest.mark.parametrize(
    ("geoid", "height"),
    [
        (45.2, '"ellipsoid"'), (45.2, "{ undulation_m = -45.2 }"), (45.2, "{ undulation_m = 44 }"),
        (1.9, '"ellipsoid"'), (0, "{ undulation_m = 45 }"),
    ],
)  # fmt: skip
def test_the_geoid_of_a_gpx_is_that_of_its_heights(
    geoid: float, height: str, tmp_path: Path
) -> None:
    """45 m too low, and nothing told; 0 stands for none."""
    files = flight_files.project(
        flight_files.LENSES["inline"], flight_files.PICKS["CSV of frames"],
        flight_files.LANDMARKS["CSV, geodetic"], flight_files.TRACKS["GPX"],
    )  # fmt: skip
    start, track = files["flight.toml"].split("[track]")
    files["flight.toml"] = start + "[track]" + track.replace('"ellipsoid"', height)
    files["track.gpx"] = files["track.gpx"].replace(
        "</ele>", f"</ele><geoidheight>{geoid}</geoidheight>"
    )
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    found = read_flight(str(tmp_path / "flight.toml")).findings
    assert_approved([one.message for one in found])


def gpx(*points: str) -> str:
    inside = "".join(f"<trkpt {point}</trkpt>" for point in points)
    return f'<gpx version="1.1" creator="x"><trk><trkseg>{inside}</trkseg></trk></gpx>'


def point(lat: str = "47.5", lon: str = "16.5", ele: str = "500", second: str = "00") -> str:
    height = f"<ele>{ele}</ele>" if ele else ""
    time = f"<time>2026-05-01T12:00:{second}Z</time>" if second else ""
    return f'lat="{lat}" lon="{lon}">{height}{time}'


@pytest.mark.parametrize(
    "wrong",
    [
        point(ele=""), point(second=""), point(ele="", second=""), point(lat="90.5"),
        point(lat="-90.5"), point(lat="nan"), point(lon="nan"), point(lon="inf"), point(ele="nan"),
    ],
)  # fmt: skip
def test_points_of_gpx_that_are_refused(wrong: str) -> None:
    assert_approved(told(gpx(point(), wrong, point(), wrong)), parts=["track point 2"])


@pytest.mark.skipif(not hasattr(time, "tzset"), reason="the zone of a process is not changed there")
def test_times_of_gpx_without_a_zone_are_utc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "America/New_York")
    time.tzset()
    try:
        zoned, bare = (
            read(gpx(point(), one)).time_s for one in (point(), point().replace("Z", ""))
        )
    finally:
        monkeypatch.undo()
        time.tzset()
    assert np.array_equal(zoned, bare)


def test_blanks_around_a_time_of_gpx_are_none() -> None:
    wide = point().replace("<time>", "<time>\n ").replace("</time>", "\t</time>")
    assert np.array_equal(read(gpx(wide, wide)).time_s, read(gpx(point(), point())).time_s)


@pytest.mark.parametrize("library", ["lxml.etree", "xml.etree.ElementTree"])
@pytest.mark.parametrize("within", ["<?a 3?>", "<!-- 3 -->", "<!-- <ele>3</ele>\n -->", "<?a?> "])
def test_what_xml_has_for_programs_and_people_is_no_part_of_a_number(
    within: str, library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Gpxpy takes lxml where it is; it read 5 of a height of `5<?a?>00`, without a word."""
    monkeypatch.setattr("gpxpy.parser.mod_etree", pytest.importorskip(library))
    plain = point().replace("<ele>", "<![CDATA[<!--]]><name><![CDATA[<?]]></name><ele>")
    one = plain.replace("<ele>5", f"<ele>5{within.strip()}").replace("<time>", f"<time>{within}")
    rows = read('<?xml version="1.0" encoding="ascii"?>' + gpx(plain, one))
    assert rows.coordinate.tolist() == [[16.5, 47.5, 500.0]] * 2
    assert rows.time_s[0] == rows.time_s[1]


def test_a_point_of_gpx_in_a_leap_second() -> None:
    assert_approved(told(gpx(point(), point().replace("12:00:00", "23:59:60"))))


@pytest.mark.parametrize("wrong", [point(lat="x"), point() + "<"])
def test_what_is_no_gpx(wrong: str) -> None:
    said = told(gpx(point(), wrong, point(), wrong))
    assert_approved(said, others_after="not valid GPX:")
    assert "\n" not in said


@pytest.mark.parametrize("number", ["4_7.5", "\u0664\u0667"])
def test_numbers_of_gpx_are_those_of_other_files(number: str) -> None:
    """Python takes separators and the digits of other scripts, and so does gpxpy."""
    dilution = point() + f"<hdop>{number}</hdop>"
    for wrong in (point(number), point(lon=number), point(ele=number), dilution):
        assert_approved(told(gpx(point(), wrong)))


def test_points_of_gpx_without_a_fix() -> None:
    """They are refused where others have one; points on the equator or on Greenwich are places."""
    zero = point("0", "-0.0")
    assert_approved(told(gpx(point(), zero)), parts=["track point 2"])
    assert_approved(told(gpx(zero, point(), zero)), parts=["track point 1"])
    assert read(gpx(zero, zero)).coordinate.tolist() == [[0.0, 0.0, 500.0]] * 2
    assert len(read(gpx(point(), point("0"), point(lon="0"))).coordinate) == 3


def test_points_that_gpx_says_have_no_fix_are_left_out() -> None:
    """They counted as places; one of two dimensions has a height that nobody measured."""
    without = (point(lat="11") + f"<fix>{fix}</fix>" for fix in ("none", "2d"))
    rows = read(gpx(*without, *(point() + f"<fix>{fix}</fix>" for fix in ("3d", "dgps", "pps"))))
    assert rows.coordinate.tolist() == [[16.5, 47.5, 500.0]] * 3
    assert_approved(rows.said)
    assert_approved(told(gpx(point() + "<fix>none</fix>")))


@pytest.mark.parametrize("again", ["<ele>3</ele>", "<time>2026-05-01T12:00:09Z</time>"])
def test_a_point_of_gpx_has_one_height_and_one_time(again: str) -> None:
    """Of two the first was taken in silence."""
    assert_approved(told(gpx(point() + again)))


def test_points_of_gpx_at_their_limits() -> None:
    rows = read(gpx(point("90", "-180"), point("-90", "361", "-5", "00.125")))
    assert rows.coordinate.tolist() == [[-180.0, 90.0, 500.0], [361.0, -90.0, -5.0]]
    noon = datetime(2026, 5, 1, 12, tzinfo=UTC).timestamp()
    assert rows.time_s.tolist() == [noon, noon + 0.125]
    assert (rows.geodetic, rows.crs, rows.height, rows.image) == (True, "EPSG:4326", None, [])
    assert rows.sigma_m is None and rows.velocity_m_s is None


# shots.geojson


def shots(*coordinates: list[float], **more: Any) -> str:
    """Shots of ODM with these coordinates."""
    features = [
        {
            "type": "Feature",
            "properties": {"filename": f"{k}.jpg", "rotation": [0, 0, 0]},
            "geometry": {"type": "Point", "coordinates": one},
        }
        for k, one in enumerate(coordinates)
    ]
    return json.dumps({"type": "FeatureCollection", "features": features, **more})


def test_shots_of_geojson() -> None:
    rows = read(shots([8.25, 47.5, 500.5], [8.5, 47.75, 510.0]))
    assert rows.coordinate.tolist() == [[8.25, 47.5, 500.5], [8.5, 47.75, 510.0]]
    assert (rows.image, rows.geodetic, rows.crs) == (["0.jpg", "1.jpg"], True, "EPSG:4326")
    assert_approved(rows.said)


@pytest.mark.parametrize("place", [[8, 47], [8, 47, 5, 12], [8, "x", 5], [8, None, 5], [8, 95, 5]])
def test_shots_of_geojson_that_are_refused(place: list[Any]) -> None:
    """Be they of one shot, or of all."""
    assert_approved([told(shots([8.0, 47.0, 500.0], place)), told(shots(place, place))])


# Tables


def test_what_a_table_says_besides_positions() -> None:
    text = "# x\nt_utc,image,lat_deg,lon_deg,h_m,x_m,y_m,sigma_m\n1970-01-01T00:00:09Z,a,2,3,4,5,6,"
    rows = read(text + "\n\n1970-01-01T00:00:10Z,b,-90,360,4,5,6,0.5\n")
    assert rows.coordinate.tolist() == [[3.0, 2.0, 4.0], [360.0, -90.0, 4.0]] and rows.geodetic
    assert (rows.clock, rows.time_s.tolist(), rows.image) == ("utc-column", [9.0, 10.0], ["a", "b"])
    assert np.isnan(rows.sigma_m[0]).all() and rows.sigma_m[1].tolist() == [0.5] * 3
    assert [*rows.line] == [3, 5]
    assert_approved(rows.said)
    assert rows.crs is None
    assert (rows.height, rows.gimbal_deg, rows.whole_seconds) == (None, None, False)
    assert rows.image_key("a/b.jpg") == "a/b.jpg"
    plane = read("t_s,x_m,y_m,z_m\n1.5,2,3,4\n")
    assert plane.coordinate.tolist() == [[2.0, 3.0, 4.0]] and not plane.geodetic
    assert (plane.clock, plane.time_s.tolist()) == ("seconds", [1.5])
    assert plane.sigma_m is None and plane.image == [] and plane.velocity_m_s is None


@pytest.mark.parametrize(
    ("header", "missing"),
    [
        ("t_s", "lon_deg"), ("t_utc,h_m", "lon_deg"), ("image,lat_deg,h_m", "lon_deg"),
        ("lat_deg,lon_deg", "h_m"), ("lat_deg,lon_deg,h_m", "t_s"), ("x_m,y_m", "z_m"),
        ("x_m,y_m,z_m", "t_s"), ("t_s,x_m,z_m", "y_m"), ("t_s,y_m,z_m", "x_m"),
        ("t_s,lon_deg,h_m", "lat_deg"), ("t_s,x_m,y_m,z_m,ve_m_s", "vn_m_s"),
        ("t_s,x_m,y_m,z_m,vn_m_s,vd_m_s", "ve_m_s"),
    ],
)  # fmt: skip
def test_a_table_that_has_part_of_a_track_is_told_what_is_missing(
    header: str, missing: str
) -> None:
    cells = ",".join("1" * (header.count(",") + 1))
    if header.startswith("t_utc"):
        cells = "1970-01-01T00:00:09Z" + cells[1:]
    assert_approved(told(f"{header}\n{cells}\n"), parts=[missing])


@pytest.mark.parametrize("header", ["t_s,x_m,y_m,z_m", "image,lat_deg,lon_deg,h_m"])
def test_a_header_alone_is_no_track(header: str) -> None:
    """Of images it ended in Python's own error."""
    assert_approved(told(f"{header}\n# none\n"))


@pytest.mark.parametrize(
    "header", ["t_s,lat_deg,lon_deg,h_m", "t_s,x_m,y_m,z_m,vn_m_s,ve_m_s,vd_m_s"]
)
def test_no_cell_of_a_track_is_empty(header: str) -> None:
    names = header.split(",")
    for empty in names:
        cells = ",".join("" if name == empty else "5" for name in names)
        text = f"{header}\n{','.join('4' for _ in names)}\n{cells}\n"
        assert_approved(told(text), parts=[empty])


def test_velocities_of_a_table_are_north_east_down() -> None:
    rows = read("ve_m_s,vd_m_s,vn_m_s,image,x_m,y_m,z_m\n2,3,1,a,5,6,7\n")
    assert_close("ratio", rows.velocity_m_s, [[1.0, 2.0, 3.0]])
    assert rows.clock is None and rows.time_s is None


@pytest.mark.parametrize("up", ["vu_m_s", "V Up (m/s)", "climb_rate", "up_velocity"])
def test_a_velocity_upward_is_not_to_be_renamed_as_one_downward(up: str) -> None:
    assert_approved(told(f"t_s,x_m,y_m,z_m,vn_m_s,ve_m_s,{up}\n4,5,6,7,1,2,3\n"), parts=[up])
    text = f"t_s,x_m,y_m,z_m,vn_m_s,ve_m_s,{up}\n4,5,6,7,1,2,3\n"
    with refused(VopdError, parts=[up]):
        read_by_content(TRACK_FORMATS, InputFile("t", Path("t"), text, columns={"vd_m_s": up}))


STAIRS = """t_s,lat_deg,lon_deg,h_m,vn_m_s,ve_m_s,vd_m_s
0.0,48.0,15.0,300,0,0,0
0.5,48.0,15.0,300,0,0,1
1.0,48.0,15.0,300,0,0,2
1.5,48.0,15.0,300,0,0,3
2.0,48.0,15.0,301,0,0,4
2.5,48.0,15.0,301,0,0,5
3.0,48.1,15.0,301,0,0,6
3.5,48.1,15.0,301,0,0,7
4.0,48.1,15.2,301,0,0,8
4.5,48.1,15.2,301,0,0,9
5.0,48.1,15.2,309,0,0,10
5.5,48.1,15.2,309,0,0,11
"""


def test_a_log_that_is_faster_than_its_receiver_has_each_position_once() -> None:
    """Two rows a position; that of a camera that stands for two seconds counts twice."""
    rows = read(STAIRS)
    assert rows.time_s is not None and rows.velocity_m_s is not None
    assert rows.time_s.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert rows.velocity_m_s[:, 2].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    assert rows.coordinate[:, 2].tolist() == [300.0, 300.0, 301.0, 301.0, 301.0, 309.0]
    assert [*rows.line] == [2, 4, 6, 8, 10, 12]
    assert_approved(rows.said)


def test_rows_of_a_log_without_a_position_are_left_out() -> None:
    """Before the first fix, and between two; one that lacks a coordinate alone is an error."""
    blank = "0.1,,,\n0.2,,,\n0.3,48,15,300\n0.4,,,\n0.5,48.1,15,301\n"
    rows = read(f"t_s,lat_deg,lon_deg,h_m\n{blank}")
    assert rows.time_s is not None and rows.time_s.tolist() == [0.3, 0.5]
    assert rows.coordinate.tolist() == [[15.0, 48.0, 300.0], [15.0, 48.1, 301.0]]
    assert [*rows.line] == [4, 6]
    assert_approved(rows.said)
    for wrong in (blank.replace("301", ""), "0.1,,,\n"):
        assert_approved(told(f"t_s,lat_deg,lon_deg,h_m\n{wrong}"))


def test_positions_that_repeat_now_and_then_stay() -> None:
    """Of a camera that stands at four places; and where most rows differ from the one before."""
    stands = STAIRS.replace("15.2,309", "15.2,301")
    lines = STAIRS.splitlines()
    moves = [line.replace(",301,", f",{300 + k},") for k, line in enumerate(lines)]
    for text in (stands, "\n".join(moves)):
        rows = read(text)
        assert len(rows.coordinate) == 12 and "repeat" not in rows.said


def test_a_grid_beside_latitudes_is_said_not_to_be_used() -> None:
    rows = read("t_s,x_m,y_m,lat_deg,lon_deg,h_m,z_m\n4,5,6,7,8,9,10\n")
    assert rows.coordinate.tolist() == [[8.0, 7.0, 9.0]]
    assert_approved(rows.said)


# Solutions of RTKLIB

LEVEL = "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,5:single,ns=# of satellites)\n"
POS = "%  GPST  latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) age(s)\n"
XYZ = "%  UTC  x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m)\n"
FIX = "2024/02/04 00:00:01.500 47.6 -16.4 540.0 1 9 1.0 2.0 3.0 -0.1 0.0\n"


def test_a_solution_of_rtklib() -> None:
    """Week 2300 of GPS began on 2024-02-04."""
    rows = read(f"% program : RTKLIB\n{LEVEL}{POS}{FIX}\n{FIX.replace(' 1 9', ' 5 9')}")
    assert rows.coordinate.tolist() == [[-16.4, 47.6, 540.0]] * 2 and [*rows.line] == [4, 6]
    at_s = datetime(2024, 2, 4, 0, 0, 1, 500_000, UTC).timestamp()
    assert rows.time_s.tolist() == [at_s, at_s] and rows.clock == "gps"
    assert rows.sigma_m.tolist() == [[2.0, 1.0, 3.0]] * 2
    assert (rows.geodetic, rows.crs, rows.height) == (True, "EPSG:4326", "ellipsoid")
    assert_approved([rows.said, rows.sigma_by])
    week = FIX.replace("2024/02/04 00:00:01.500", "2300 1.5").replace(" ", ",")
    for other in (LEVEL + POS + week, LEVEL + POS.replace("GPST", "UTC") + FIX):
        assert read(other).time_s.tolist() == [at_s]
    assert read(LEVEL + POS.replace("GPST", "UTC") + FIX).clock == "utc"


def test_heights_of_rtklib_that_it_does_not_say_are_asked_for() -> None:
    assert read(LEVEL.replace("ellipsoidal", "geodetic") + POS + FIX).height is None
    assert read(POS + FIX).height is None


def test_places_of_rtklib_without_a_solution_or_sigmas() -> None:
    rows = read(POS + FIX.replace(" 1 9", " 0 9") + FIX.replace(" 1.0 2.0 3.0", " 0.0 2.0 3.0"))
    assert [*rows.line] == [3]
    np.testing.assert_array_equal(rows.sigma_m, [[2.0, np.nan, 3.0]])
    short = read(POS.partition(" Q")[0] + "\n" + FIX.partition(" 1 9")[0] + "\n")
    assert short.sigma_m is None and short.said != rows.said


def test_earth_centred_places_of_rtklib() -> None:
    """At latitude 0 and longitude 45 east is (y - x) / sqrt(2), up (x + y) / sqrt(2), north z.

    Of variances 4 and 4 and the covariance -1 these are 5 and 3 for east and up.
    """
    x = 6_378_137.0 * np.sqrt(0.5)
    rows = read(f"{XYZ}2024/02/04 00:00:01 {x} {x} 0.0 2 9 2.0 2.0 7.0 -1.0 0.0 0.0\n")
    assert_close("flight position", rows.coordinate, [[45.0, 0.0, 0.0]])
    assert_close("flight position", rows.sigma_m, [[np.sqrt(5.0), 7.0, np.sqrt(3.0)]])
    assert (rows.clock, rows.height) == ("utc", "ellipsoid")


@pytest.mark.parametrize(
    "text",
    [
        POS.replace("GPST", "JST") + FIX,
        POS.replace("latitude(deg)", "latitude(d'\")") + FIX,
        "% GPST e-baseline(m) n-baseline(m) u-baseline(m) Q ns\n2300 1.5 1.0 2.0 3.0 1 9\n",
        POS,
        POS + FIX[:40] + "\n",
        POS + FIX.replace("47.6", "97.6"),
        POS + FIX.replace("540.0", "nan"),
        POS + FIX.replace("/02/", "/13/"),
        POS + FIX.replace("00:00:01.500", "23:59:60.000"),
        POS + FIX.replace("540.0", "54O.0"),
    ],
    ids=["JST", "minutes", "baseline", "empty", "cut", "latitude", "nan", "date", "leap", "O"],
)
def test_what_is_wrong_in_a_solution_of_rtklib_is_named(text: str) -> None:
    assert_approved(told(text))


# .MRK files of drones: photos by number, with GPS time, position and standard deviations


LINE = (
    "{number}\t{seconds:.6f}\t[{week}]\t     3,N\t     0,E\t    40,V\t"
    "{lat:.10f},Lat\t{lon:.10f},Lon\t{h:.4f},Ellh\t0.03, 0.01, 0.05\t{quality},Q\n"
)


def photo_line(number: int, week: int, seconds: float, quality: int = 50, **where: float) -> str:
    position = {"lat": 47.0, "lon": 16.0, "h": 500.0} | where
    return LINE.format(number=number, week=week, seconds=seconds, quality=quality, **position)


def marks_project(folder: Path) -> Path:
    """The project with a .MRK file in the place of its track, and photos 17 to 21."""
    toml = TOML[: TOML.index("[track]")].replace("frame_rate_hz", "# frame_rate_hz")
    project = write_project(folder, toml + '[track]\nfile = "a.MRK"\n')
    where = geodetic(camera_m(2.0 + np.arange(5) / 10.0))
    lines = []
    for k in range(5):
        taken = datetime(2026, 5, 1, 11, 58, 44, 100_000 * k, tzinfo=UTC) + timedelta(seconds=18)
        days = (taken - datetime(1980, 1, 6, tzinfo=UTC)).total_seconds()
        position = {"lat": where[0][k], "lon": where[1][k], "h": where[2][k]}
        lines.append(photo_line(17 + k, int(days // 604800), days % 604800, **position))
    (folder / "a.MRK").write_text("".join(lines))
    picks = folder / "picks.csv"
    rows = [f"a/DJI_{17 + int(r[0]):04d}.JPG{r[1:]}" for r in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    return project


def test_gps_week_and_seconds(tmp_path: Path) -> None:
    """Week 2211 and 296289.777625 s are 2022-05-25, 10:18:09.777625 of GPS time."""
    (tmp_path / "a.mrk").write_text(photo_line(29, 2211, 296289.777625))
    rows = read_mrk(open_input("a.mrk", tmp_path))
    assert rows.time_s is not None and rows.sigma_m is not None
    assert datetime.fromtimestamp(rows.time_s[0], UTC).isoformat(timespec="milliseconds") == (
        "2022-05-25T10:18:09.777+00:00"
    )
    assert (rows.clock, rows.height, rows.image) == ("gps", "ellipsoid", ["29"])
    assert rows.coordinate.tolist() == [[16.0, 47.0, 500.0]]
    assert rows.sigma_m.tolist() == [[0.01, 0.03, 0.05]]  # the file has north first


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("MAX_0029.JPG", "29"),
        ("DJI_0029.JPG", "29"),
        ("100_0001_0029.JPG", "29"),
        ("DJI_20230101120000_0029_V.JPG", "29"),
        ("DJI_20220525101809_0029_Zenmuse-P1-mission.JPG", "29"),
        ("DCIM/100MEDIA/DJI_0029.JPG", "29"),
        ("front.jpg", "front.jpg"),
    ],
)
def test_the_number_of_a_photo_in_its_name(name: str, number: str) -> None:
    assert photo_number(name) == number


def test_a_flight_by_marks_has_positions_times_and_velocity(tmp_path: Path) -> None:
    """The clock is 18 s ahead of UTC; 20 m/s north, 5 east, climbing 2."""
    flight = vopd.solve_flight(marks_project(tmp_path))
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert flight.estimate.time_s.round(6).tolist() == [2.0, 2.1, 2.2, 2.3, 2.4]
    velocity = flight.flight.path.velocity_m_s
    assert velocity is not None
    assert np.abs(velocity - [20.0, 5.0, -2.0]).max() < within("speed of images")
    fixes = flight.flight.path.fixes
    assert fixes is not None and fixes.sigma_m.tolist() == [[0.01, 0.03, 0.05]] * 5
    said, sigmas = (one for one in flight.about if one.startswith("a.MRK"))
    assert "its antenna offsets of up to 0.04 m are not added" in said
    assert sigmas.endswith(" by the receiver")


def test_without_an_epoch_time_begins_at_the_first_second_of_the_marks(tmp_path: Path) -> None:
    project = marks_project(tmp_path)
    project.write_text(project.read_text().replace("epoch =", "# epoch ="))
    flight = vopd.solve_flight(project)
    assert flight.estimate.time_s.round(6).tolist() == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert flight.estimate.about.epoch == datetime(2026, 5, 1, 11, 58, 44, tzinfo=UTC)


def test_photos_without_position_are_left_out_and_loose_ones_counted(tmp_path: Path) -> None:
    path = tmp_path / "a.mrk"
    path.write_text(
        photo_line(1, 2211, 10.0)
        + photo_line(2, 2211, 12.0, 16)
        + photo_line(3, 2211, 14.0, 0, lat=0.0, lon=0.0)
    )
    rows = read_mrk(open_input("a.mrk", tmp_path))
    assert rows.image == ["1", "2"]
    assert_approved(rows.said)


@pytest.mark.parametrize(
    "wrong",
    [
        ("47.0000000000,Lat", "47.0000000000"),
        ("47.0000000000,Lat", "nan,Lat"),
        ("47.0000000000,Lat", "147.0,Lat"),
        ("[2211]", "[99999999]"),
        ("\t12.0", "\t1e308"),
        ("0.03, 0.01", "0.03, -0.01"),
        ("\t50,Q", ""),
    ],
)
def test_lines_that_are_wrong_are_named(tmp_path: Path, wrong: tuple[str, str]) -> None:
    path = tmp_path / "a.mrk"
    path.write_text(photo_line(1, 2211, 10.0) + photo_line(2, 2211, 12.0).replace(*wrong))
    with refused(VopdError):
        read_mrk(open_input("a.mrk", tmp_path))


def test_heights_of_marks_are_known_and_not_asked(tmp_path: Path) -> None:
    project = marks_project(tmp_path / "a")
    ran = run("new", tmp_path / "new", "--track", tmp_path / "a" / "a.MRK")
    assert ran.status == 0 and "needed: [track] height" not in ran.stdout
    assert "needed: [track] sigma_m" not in ran.stdout
    project.write_text(project.read_text() + 'height = "egm96"\n')
    with refused(VopdError):
        vopd.solve_flight(project)


def test_photos_that_the_marks_do_not_have(tmp_path: Path) -> None:
    project = marks_project(tmp_path)
    marks = tmp_path / "a.MRK"
    text = marks.read_text()
    marks.write_text(text.replace("19\t", "99\t", 1))
    flight = vopd.solve_flight(project)
    assert flight.solved.tolist() == [True, True, False, True, True]
    assert "no position for a/DJI_0019.JPG" in str(flight.findings[0])
    marks.write_text(text.splitlines()[0] + "\n" + text)
    with refused(VopdError):
        vopd.solve_flight(project)
    marks.write_text(photo_line(1, 2211, 10.0))
    with refused(VopdError):
        vopd.solve_flight(project)


def test_an_offset_that_leaves_no_date(tmp_path: Path) -> None:
    project = marks_project(tmp_path)
    text = project.read_text().replace("epoch =", "# epoch =")
    project.write_text(text + "offset_s = 1e12\n")
    with refused(VopdError):
        vopd.solve_flight(project)


def test_a_run_of_a_log_that_is_a_row_longer_is_one_position() -> None:
    """Where the clocks of log and receiver beat; of a camera that stands each usual run is one."""
    lengths = [10, 11, 9, 10, 14, 10, 20]
    own = np.repeat(np.arange(len(lengths)), lengths)
    kept = new_positions(np.stack([own, own, own], axis=1).astype(float))
    assert np.flatnonzero(kept).tolist() == [0, 10, 21, 30, 40, 54, 64, 74]
