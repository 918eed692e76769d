"""Tables in text: separators, comments, blocks of rows, cells, and what is said of a wrong one."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import read_text
from tests.kit.tagged_images import tagged_image
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.columns import TIME
from vopd.flight.formats.files import InputFile, open_input
from vopd.flight.formats.image_tags import read_tags
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.tables import (
    CsvTable,
    csv_blocks,
    frames_of_column,
    has_columns,
    header_names,
    read_csv,
    whole_numbers,
)
from vopd.flight.formats.track import TRACK_FORMATS
from vopd.flight.formats.wind import WIND_FORMATS


def of(text: str) -> InputFile:
    return InputFile("t", Path(), text)


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refusal:
        action()
    return str(refusal.value)


@pytest.mark.parametrize("between", [",", ";", "\t"])
def test_columns_are_separated_by_what_the_header_has_most_of(between: str) -> None:
    text = f"\n # a, comment; with\t all\n a{between} B {between}c x\n1{between}2{between} 3 \n"
    assert header_names(of(text)) == ["a", "B", "c x"]
    table = read_csv(of(text))
    assert table.header == ["a", "B", "c x"] and [*table.line] == [4]
    assert [table.column(name) for name in table.header] == [["1"], ["2"], ["3"]]
    assert has_columns(of(text), (), ("z",), ("a", "B")) and not has_columns(
        of(text), (), ("a", "b")
    )
    assert not has_columns(of(text), (), ("z",), ("B", "z")) and not has_columns(of(text), ())


def test_lines_that_are_no_rows_are_counted() -> None:
    """Empty lines, blanks, and lines whose first character that is no blank is #."""
    text = '# x\n\na,b\n  # y\n1,"p # q, r"\n \n3,#4\n#5,6\n7,8'
    table = read_csv(of(text))
    assert [*table.line] == [5, 7, 9]
    assert table.column("b") == ["p # q, r", "#4", "8"]
    assert_approved(told(lambda: table.numbers("b")))
    assert [*read_csv(of("a\n1\n2\n")).line] == [2, 3]


@pytest.mark.parametrize("text", ["", "\n \n", "# a,b\n"])
def test_a_table_has_a_header(text: str) -> None:
    assert header_names(of(text)) == []
    assert_approved(told(lambda: read_csv(of(text))))


@pytest.mark.parametrize("formats", [PICK_FORMATS, LANDMARK_FORMATS, TRACK_FORMATS, WIND_FORMATS])
def test_json_of_other_programs_in_one_long_line_is_no_table(formats: Any) -> None:
    """As COCO's, which is not known; a table whose line is so long is told for its line."""
    long = ", 1" * 400_000
    said = told(lambda: read_by_content(formats, of(f'{{"annotations": [1{long}]}}')))
    assert said.startswith("t: the format is not recognised")
    assert told(lambda: read_by_content(formats, of(f"t_s{long}"))).startswith("t: line 1: ")


def test_a_comment_of_any_length_is_a_comment() -> None:
    """Also one whose cells are longer than those that Python's csv reads."""
    text = f"image,landmark,u_px,v_px\na.jpg,b,1,2\n#{200_000 * 'x'},b,1,2\n#c.jpg,b,1,2\n"
    rows = read_by_content(PICK_FORMATS, of(text))
    assert len(rows.landmark) == 1 and rows.commented == {"#c.jpg": "t: line 4"}


def test_a_header_without_rows() -> None:
    table = read_csv(of("a,b\n# none\n"))
    assert table.column("a") == table.column("b") == [] and len(table.line) == 0
    assert table.numbers("a").shape == table.sigmas("a").shape == table.sigmas("c").shape == (0,)
    assert [one.header for one in csv_blocks(of("a,b\n"))] == [["a", "b"]]
    found = whole_numbers(table, "a")
    assert found is not None and found.tolist() == [] and found.dtype == np.int64
    assert np.asarray(frames_of_column(read_csv(of("frame\n")))).tolist() == []


@pytest.mark.parametrize(
    "text",
    [
        "a,b\n1,2\n#\n1\n1,2,3\n",
        "a,b\n1,2\n\n1,2,3\n1\n",
        "#\n\na, b,a,b ,c\n",
        '# x\na,b\n1,2\n1,"2\n3,4\n',
        'a,b\n1,2\n3,4\n1,"2',
        'a,b\n1,2\n1,"2\n3"\n4,5\n',
    ],
    ids=["short", "long", "names", "quote", "last quote", "quote that closes"],
)
def test_rows_that_are_refused_are_named_by_their_lines(text: str) -> None:
    assert_approved(told(lambda: read_csv(of(text))))


def test_a_cell_that_is_too_long_is_named_by_its_line() -> None:
    said = told(lambda: read_csv(of("a,b\n1,2\n#\n1," + "x" * 131_073 + "\n3,4\n")))
    assert_approved(said)


def test_a_quoted_cell_may_have_the_separator_and_quotes() -> None:
    """Names in the header, too: R writes all texts in quotes."""
    file = of('a;"b ";"c"\n"1;2";"say ""x""";3\n')
    table = read_csv(file)
    assert table.header == header_names(file) == ["a", "b", "c"]
    assert [table.column(name) for name in "abc"] == [["1;2"], ['say "x"'], ["3"]]
    table = read_csv(of('"p;q";r\n1;2\n'))
    assert (table.header, table.column("r")) == (["p;q", "r"], ["2"])


ROWS = 4000  # of about 13 characters: three chunks of 20000


def test_a_long_table_is_read_in_blocks_with_the_numbers_of_its_lines(tmp_path: Path) -> None:
    """A comment stands in the first chunk; nothing is lost where a chunk ends within a line."""
    rows = [f"{k},{k + 0.25},{'x' * (k % 7)}" for k in range(ROWS)]
    (tmp_path / "t").write_text("\n".join(["frame,v,name", "# comment", *rows, ""]))
    file = InputFile("t", tmp_path / "t")
    blocks = [*csv_blocks(file)]
    assert len(blocks) > 2 and all(one.header == ["frame", "v", "name"] for one in blocks)
    table = read_csv(file)
    assert [*table.line] == [n for one in blocks for n in one.line] == [*range(3, ROWS + 3)]
    assert table.numbers("v").tolist() == [k + 0.25 for k in range(ROWS)]
    assert np.asarray(frames_of_column(table)).tolist() == [*range(ROWS)]
    assert table.column("name") == ["x" * (k % 7) for k in range(ROWS)]
    for wrong in (f"{ROWS - 2},", f"{ROWS - 2}"):
        text = file.text.replace(f"\n{ROWS - 2},{ROWS - 2}.25", f"\n{wrong}")
        found = InputFile("t", Path(), text)
        message = told(lambda found=found: read_csv(found).numbers("v"))
        assert_approved(message, parts=[f"line {ROWS + 1}"])
    negative = InputFile("t", Path(), file.text.replace(f",{ROWS - 2}.25", ",-1"))
    assert_approved(told(lambda: read_csv(negative).sigmas("v")), parts=[f"line {ROWS + 1}"])


# Cells


@pytest.mark.parametrize("cell", ["1.5", "-2e-3"])
def test_numbers_in_cells(cell: str) -> None:
    table = read_csv(of(f"a;b\n3;4\n5;{cell}\n6;7\n"))
    assert table.numbers("b").tolist() == table.numbers("b", {"": 0.0}).tolist()
    assert table.numbers("b").tolist() == [4.0, float(cell), 7.0]


@pytest.mark.parametrize("cell", ["", "x", "1,5", "nan", "-inf", "1e999", "0x10"])
def test_cells_without_a_number(cell: str) -> None:
    """The other rows are right; an empty cell may mean something."""
    table = read_csv(of(f"a;b\n3;4\n5;{cell}\n6;7\n"))
    assert_approved(told(lambda: table.numbers("b")))
    for empty in (np.nan, 0.0, 9.0):
        if not cell:
            assert str(table.numbers("b", {"": empty}).tolist()) == str([4.0, empty, 7.0])
        else:
            assert_approved(told(lambda empty=empty: table.numbers("b", {"": empty})))


def test_standard_deviations_in_cells() -> None:
    table = read_csv(of("s\n0.5\n1e-9\n"))
    assert table.sigmas("s").tolist() == [0.5, 1e-9] and np.isnan(table.sigmas("t")).all()
    table = read_csv(of("s,t\n,1\n2,1\n"))
    assert np.isnan(table.sigmas("s")[0]) and table.sigmas("s")[1] == 2.0
    for wrong in ("0", "-0.25", "1e-300", "1e+10"):
        table = read_csv(of(f"s\n1\n{wrong}\n-7\n"))
        assert_approved(told(lambda table=table: table.sigmas("s")), parts=[wrong])
    assert_approved(told(lambda: table.numbers("S")))
    assert_approved(told(lambda: read_csv(of("speed,s\n")).column("sped")))


@pytest.mark.parametrize("text", ["2026-05-01T12:00:00", "noon", "", "5", "2026-05-01"])
def test_dates_in_cells(text: str) -> None:
    table = read_csv(of(f"a,t\n1,1970-01-01T00:00:10.25+00:00\n2,{text}\n"))
    assert_approved(told(lambda: table.times("t")))
    good = read_csv(of("t\n1970-01-01T00:00:10.25Z\n1970-01-01T02:00:01+02:00\n"))
    assert good.times("t").tolist() == [10.25, 1.0]


@pytest.mark.parametrize(
    "text",
    ["t\n1970-01-01T00:00:10.25\n1970-01-01T00:00:11Z\n", "utc\n1970-01-01 00:00:10.25\n",
     "day,t\n1970/01/01,00:00:10.25\n", "x;utc\n1;1970-01-01 00:00:10,25\n",
     "utc\n19700101T000010.25\n"],
)  # fmt: skip
def test_gps_time_has_no_zone(text: str) -> None:
    """Nor does a column whose name says that it is UTC need one, in whatever form of ISO 8601."""
    file = replace(of(text), clock="gps")
    name = read_csv(file).header[-1]
    assert read_csv(file).times(name)[0] == 10.25
    if "utc" in text:
        assert read_csv(of(text), TIME).times("t_utc")[0] == 10.25
    assert_approved(told(lambda: read_csv(of(text.replace("utc", "t"))).times("t")))


@pytest.mark.parametrize("zone", ["+00:00", "+02:00", "-05:30"])
def test_a_zone_may_stand_where_none_is_needed(zone: str) -> None:
    """1970-01-01T12:00 there, of GPS time and of a logger's column of UTC."""
    seconds = 43200.0 - (int(zone[:3]) * 3600.0 + int(zone[0] + zone[4:]) * 60.0)
    for column, clock in (("t", "gps"), ("utc", None)):
        file = replace(of(f"{column}\n1970-01-01T12:00:00{zone}\n"), clock=clock)
        table = read_csv(file)
        assert table.times(table.header[0])[0] == seconds


def frames(cells: list[str]) -> CsvTable:
    return read_csv(of("\n".join(["frame,a", *(f"{cell},1" for cell in cells)])))


@pytest.mark.parametrize(
    ("cells", "found"),
    [
        (["0", "007", "12"], [0, 7, 12]), (["123456789012345"], [123456789012345]),
        (["a", "b 2", ""], ["a", "b 2", ""]),
    ],
)  # fmt: skip
def test_frames_in_cells(cells: list[str], found: Any) -> None:
    assert np.asarray(frames_of_column(frames(cells))).tolist() == found


@pytest.mark.parametrize(
    ("cells", "row"),
    [
        (["1234567890123456"], 2), (["1", "12345678901234567890"], 3),
        (["1", "1234567890123456"], 3), (["a", "7"], 2), (["7", "a"], 3), (["7", ""], 3),
        (["7", "1.0"], 3), (["-1", "a"], 2), (["1", "²"], 3), (["1", "٣"], 3), (["nan", "b"], 2),
        (["", "3", "x"], 2),
    ],
)  # fmt: skip
def test_cells_that_are_no_frame(cells: list[str], row: int) -> None:
    assert_approved(told(lambda: frames_of_column(frames(cells))), parts=[f"line {row}"])


# Every column and variant of the tables that a project names: what is read and what refused


FORMATS: dict[str, Any] = {
    "landmarks": LANDMARK_FORMATS, "picks": PICK_FORMATS, "track": TRACK_FORMATS,
    "wind": WIND_FORMATS,
}  # fmt: skip


def read(folder: Path, kind: str, text: str) -> Any:
    (folder / kind).write_text(text)
    return read_by_content(FORMATS[kind], open_input(kind, folder))


def told_of(folder: Path, kind: str, text: str) -> str:
    with pytest.raises(VopdError) as refusal:
        read(folder, kind, text)
    return str(refusal.value)


# Landmarks


@pytest.mark.parametrize(
    ("crs", "cells"),
    [
        ("EPSG:32633", ["UTM 33N,WGS84", "33,WGS 84", "33T,ETRS89", "33S,", "A,local"]),
        ("EPSG:32733", ["33S,ITRF2014", "33M,WGS 84 (G1762)"]),
        ("EPSG:31468", ["4,DHDN"]),
        (None, ["33S,WGS84", ",wgs-84"]),
    ],
)
def test_a_datum_or_zone_beside_the_same_system(
    crs: str | None, cells: list[str], tmp_path: Path
) -> None:
    place = "x_m,y_m,z_m" if crs else "lat_deg,lon_deg,h_m"
    rows = "".join(f"{k},2,3,4,{one}\n" for k, one in enumerate(cells))
    (tmp_path / "a.csv").write_text(f"landmark,{place},Zone,datum\n{rows}")
    file = open_input("a.csv", tmp_path, crs=crs)
    assert len(read_by_content(LANDMARK_FORMATS, file).name) == len(cells)


@pytest.mark.parametrize(
    ("crs", "kind", "cells"),
    [
        ("EPSG:32633", "landmarks", "34N,"),
        ("EPSG:32633", "track", "33M,"),
        ("EPSG:32733", "landmarks", "33T,"),
        ("EPSG:32633", "landmarks", "33N,NAD27"),
        (None, "track", "33N,NAD83"),
    ],
)
def test_a_datum_or_zone_of_another_system_is_refused(
    crs: str | None, kind: str, cells: str, tmp_path: Path
) -> None:
    place = "x_m,y_m,z_m" if crs else "lat_deg,lon_deg,h_m"
    first = "landmark" if kind == "landmarks" else "t_s"
    (tmp_path / kind).write_text(f"{first},{place},utm_zone,Datum\n1,2,3,4,,\n2,2,3,5,{cells}\n")
    with refused(VopdError):
        read_by_content(FORMATS[kind], open_input(kind, tmp_path, crs=crs))


@pytest.mark.parametrize(("kind", "first"), [("landmarks", "landmark"), ("track", "t_s")])
def test_a_latitude_is_90_degrees_at_most(kind: str, first: str, tmp_path: Path) -> None:
    head = f"{first},h_m,lon_deg,lat_deg\n1,5,181,90\n"
    rows = read(tmp_path, kind, head + "2,6,-360,-90\n")
    assert rows.coordinate.tolist() == [[181.0, 90.0, 5.0], [-360.0, -90.0, 6.0]]
    for latitude in ("91", "-91"):
        said = told_of(tmp_path, kind, f"{head}# no row\n2,6,3,{latitude}\n")
        assert_approved(said, parts=[latitude])


@pytest.mark.parametrize(
    ("header", "geodetic", "missing"),
    [
        ("landmark,lat_deg,lon_deg,h_m", True, ""), ("landmark,x_m,y_m,z_m", False, ""),
        ("landmark,lat_deg,h_m", True, "lon_deg"), ("landmark,lat_deg,lon_deg", True, "h_m"),
        ("landmark,x_m,z_m", False, "y_m"), ("landmark,y_m,z_m", False, "x_m"),
        ("landmark,x_m,y_m", False, "z_m"), ("landmark,lon_deg,h_m", True, "lat_deg"),
        ("lat_deg,lon_deg,h_m", True, "landmark"), ("landmark,x_ft,y_m,z_m", False, "x_m"),
    ],
)  # fmt: skip
def test_columns_of_landmarks(header: str, geodetic: bool, missing: str, tmp_path: Path) -> None:
    cells = ["1", "2", "3", "4"][: header.count(",") + 1]
    text = f"{header}\n{','.join(cells)}\n"
    if missing:
        assert_approved(told_of(tmp_path, "landmarks", text), parts=[missing])
    else:
        rows = read(tmp_path, "landmarks", text)
        expected = [3.0, 2.0, 4.0] if geodetic else [2.0, 3.0, 4.0]
        assert rows.geodetic is geodetic and rows.coordinate.tolist() == [expected]
        assert (rows.crs, rows.said, rows.name) == (None, "CSV", ["1"])


@pytest.mark.parametrize(
    ("header", "height_m"),
    [
        ("Site,GPS Lat,GPS Lng,Elev (m AGL)", 4.0),
        ("Station,Latitude (deg),Longitude (deg),Alt AGL (ft)", 4.0 * 0.3048),
        ("name,latitude_wgs84,lon_deg,Altitude (ft MSL)", 4.0 * 0.3048),
        ("id,gnss_lat,gnss_long,height above sea level (m)", 4.0),
        ("label,lat,lon,altitude_above_takeoff(feet)", 4.0 * 0.3048),
    ],
)
def test_names_of_coordinates_with_receiver_level_and_unit(
    header: str, height_m: float, tmp_path: Path
) -> None:
    rows = read(tmp_path, "landmarks", f"{header}\na,2,3,4\n")
    assert rows.name == ["a"] and rows.coordinate.tolist() == [[3.0, 2.0, height_m]]


def test_names_of_grid_coordinates_with_units(tmp_path: Path) -> None:
    """Feet along a grid are not metres, whatever stands before them."""
    rows = read(
        tmp_path, "landmarks", "Point,UTM Easting (m),Northing [m],Elevation (ft)\na,2,3,4\n"
    )
    assert rows.coordinate.tolist() == [[2.0, 3.0, 4.0 * 0.3048]]
    assert_approved(told_of(tmp_path, "landmarks", "Point,E (ft),N (m),h\na,2,3,4\n"))


UNITS = {
    "landmarks": ["lat_deg,lon_deg,h_mm", "lat_rad,lon_rad,alt_km", "Lat[E7],lon_deg,z",
                  "lat_deg,lon_deg,gps_alt (cm)", "lat_deg,lon_deg,reach_cm",
                  "lat_gon,lon_gon,h_m"],
    "track": ["t_us,lat_deg,lon_deg,h_m", "TimeUS,lat_deg,lon_deg,h_m", "time (min),lat,lon,h",
              "time_us,p,q", "time_days,lat,lon,h", "t_s,lat_deg,lon_W,h_m",
              "t_s,lat_south,West longitude,h_m", "t_s,lat_deg,lon_deg,z_down_m",
              "t_s,lat_deg,lon_deg,h_m,vn_m_s,ve_m_s,vd_kt"],
    "wind": ["h_m,wind_dir_magnetic,speed_m_s", "h_km,from_deg,speed_m_s,rh",
             "h_m,direction_rad,speed_m_s"],
}  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "header"), [(k, one) for k, some in UNITS.items() for one in some]
)
def test_columns_in_other_units_are_not_to_be_renamed(
    kind: str, header: str, tmp_path: Path
) -> None:
    """It was "rename h_mm to h_m"; a column that only ends in a unit is none in it."""
    first, n = "landmark," * (kind == "landmarks"), max(3, header.count(","))
    assert_approved(told_of(tmp_path, kind, f"{first}{header}\n{'1,' * n}4\n{'2,' * n}4\n"))


@pytest.mark.parametrize("date", ["2026-05-01T12:00:00Z", "01/05/2026 12:00", "12:00:01", "17.5"])
def test_a_column_of_dates_is_to_be_called_so(date: str, tmp_path: Path) -> None:
    """It was to be renamed to t_s, which holds seconds."""
    assert_approved(told_of(tmp_path, "track", f"logged,lat_deg,lon_deg,h_m\n{date},2,3,4\n"))


def test_columns_in_other_units_are_not_mapped(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("t_s,lat_deg,lon_deg,alt_mm\n1,2,3,4\n")
    with refused(VopdError):
        read_by_content(TRACK_FORMATS, open_input("t.csv", tmp_path, {"h_m": "alt_mm"}))


def test_knots_may_be_kn(tmp_path: Path) -> None:
    text = "h_m,from_deg,Wind Speed (kn)\n0,180,10\n9,180,10\n"
    assert_close("ratio", read(tmp_path, "wind", text).toward_m_s[0, 0], 10.0 * 1852.0 / 3600.0)


@pytest.mark.parametrize("nowhere", ["0,0", "-1,-1.0"])
def test_landmarks_that_a_tracker_has_not_seen_are_no_picks(nowhere: str, tmp_path: Path) -> None:
    """Of a frame with two landmarks such a pick turned the camera, and nothing told."""
    text = f"frame,landmark,u,v\n0,a,5,0\n0,b,0,5\n1,a,{nowhere}\n1,b,3,4\n"
    assert_approved(told_of(tmp_path, "picks", text))
    assert len(read(tmp_path, "picks", text.replace(nowhere, "0,1")).landmark) == 4


@pytest.mark.parametrize("word", ["sep", "SEP"])
def test_the_line_that_names_a_separator_is_to_be_removed(word: str, tmp_path: Path) -> None:
    text = f"{word}=,\nlandmark,lat_deg,lon_deg,h_m\na,2,3,4\n"
    assert_approved(told_of(tmp_path, "landmarks", text))


@pytest.mark.parametrize("heights", [
    "alt,alt_msl", "gps_alt,baro_alt", "height (m),h", "Elevation,Ellipsoidal height",
    "altitude_msl_m,altitude_ellipsoid_m", "height,hMSL", "alt,HAE", "Orthometric height,ellh",
])  # fmt: skip
def test_two_heights_of_two_names_are_asked_for(heights: str, tmp_path: Path) -> None:
    """Of a usual name and one with its level the first was taken."""
    assert_approved(told_of(tmp_path, "landmarks", f"name,lat,lon,{heights}\na,2,3,4,5\n"))


def test_an_elevation_in_degrees_is_no_height(tmp_path: Path) -> None:
    text = "name,lat,lon,{}elevation_deg\na,2,3,{}5\n"
    assert read(tmp_path, "landmarks", text.format("alt,", "4,")).coordinate[0, 2] == 4.0
    assert_approved(told_of(tmp_path, "landmarks", text.format("", "")))


def test_two_heights_of_two_levels_are_asked_for(tmp_path: Path) -> None:
    header = "name,lat,lon,altitude_above_takeoff(feet),altitude_above_seaLevel(feet)"
    assert_approved(told_of(tmp_path, "landmarks", f"{header}\na,2,3,4,5\n"))


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("landmarks", "name,lat,Laenge,Hoehe\na,1,2,3\n"),
        ("track", "t_s,x,Hochwert,Hoehe\n1,2,3,4\n"),
        ("picks", "frame,mark it,u,down\n1,a,2,3\n"),
        ("picks", "frame,star,x_mm,y_mm\n1,a,2,3\n"),
        ("picks", "frame,star,u_px,v_px,ra_deg,dec_deg\n1,a,2,3,4,5\n"),
    ],
)
def test_all_missing_columns_are_named_at_once(kind: str, text: str, tmp_path: Path) -> None:
    assert_approved(told_of(tmp_path, kind, text))


def test_a_height_that_is_missing_may_be_one_that_is_like_it(tmp_path: Path) -> None:
    """And not the first column without a use."""
    told = told_of(tmp_path, "track", "t_s,lat_deg,lon_deg,foo,bar_alt_x\n1,2,3,4,5\n")
    assert "rename bar_alt_x to h_m" in told
    told = told_of(tmp_path, "track", "t_s,lat_deg,lon_deg,foo,bar\n1,2,3,4,5\n")
    assert "rename one of foo, bar to h_m" in told


def test_a_column_in_feet_is_read_where_none_is_in_metres(tmp_path: Path) -> None:
    """Of columns that the project names."""
    for columns, height_m in (
        (["landmark", "lat_deg", "lon_deg", "h_ft", "other"], 304.8),
        (["landmark", "lat_deg", "lon_deg", "h_ft", "h_m"], 7.0),
    ):
        file = InputFile("t", Path(), "a,1,2,1000,7\n", columns=columns)
        (own,) = read_by_content(LANDMARK_FORMATS, file).coordinate[:, 2].tolist()
        assert_close("table value", own, height_m)


@pytest.mark.parametrize("key", ["landmark", "name", "Name", "NAME", "label", "id"])
def test_names_in_geojson(key: str, tmp_path: Path) -> None:
    """A property of these names, the first of them; or the feature's own id."""
    point = {"type": "Point", "coordinates": [16, 47.5, 300]}
    feature = {"type": "Feature", "geometry": point, "properties": {"other": "x", key: "A"}}
    line = {"type": "Feature", "geometry": {"type": "LineString", "coordinates": []}}
    own = {"type": "Feature", "geometry": point, "properties": None, "id": 7}
    text = json.dumps({"type": "FeatureCollection", "features": [line, feature, own]})
    rows = read(tmp_path, "landmarks", text)
    assert rows.name == ["A", "7"] and rows.coordinate.tolist() == [[16.0, 47.5, 300.0]] * 2
    assert (rows.crs, rows.geodetic) == ("EPSG:4326", True)
    assert read(tmp_path, "landmarks", json.dumps(feature)).name == ["A"]
    both = feature | {"properties": {"id": "last", "label": "B", "landmark": "first"}}
    assert read(tmp_path, "landmarks", json.dumps(both)).name == ["first"]
    nameless = {key: own[key] for key in own if key != "id"}
    features = json.dumps({"type": "FeatureCollection", "features": [line, nameless]})
    assert_approved(told_of(tmp_path, "landmarks", features))


def test_a_gcp_list_without_names(tmp_path: Path) -> None:
    """A point is then known by its coordinates as they stand; more than a name is not read."""
    text = (
        "WGS84 UTM 33N\n# x y z u v image\n\n600.5 700 30.0 5 6 a.jpg\n600.5 700 30.0 7 8 b.jpg\n"
    )
    picks = read(tmp_path, "picks", text)
    assert [*picks.landmark] == ["600.5 700 30.0"] * 2 and [*picks.frame] == ["a.jpg", "b.jpg"]
    assert picks.pixel.tolist() == [[5.0, 6.0], [7.0, 8.0]] and np.isnan(picks.sigma_px).all()
    marks = read(tmp_path, "landmarks", text)
    assert marks.name == ["600.5 700 30.0"] and marks.coordinate.tolist() == [[600.5, 700.0, 30.0]]
    assert (marks.crs, marks.geodetic, marks.line) == ("WGS84 UTM 33N", False, [4])
    named = text.replace("a.jpg", "a.jpg one more")
    assert [*read(tmp_path, "picks", named).landmark] == ["one", "600.5 700 30.0"]
    assert_approved(told_of(tmp_path, "picks", text.replace("7 8 b", "x 8 b")))


# Tracks


VELOCITY = ("vn_m_s", "ve_m_s", "vd_m_s")


@pytest.mark.parametrize("missing", [*VELOCITY, None])
def test_a_velocity_has_three_columns(missing: str | None, tmp_path: Path) -> None:
    given = [name for name in VELOCITY if name != missing]
    values = ",".join(str(10 + VELOCITY.index(name)) for name in given)
    text = f"t_s,x_m,y_m,z_m,{','.join(given)}\n1,2,3,4,{values}\n"
    if missing is None:
        assert read(tmp_path, "track", text).velocity_m_s.tolist() == [[10.0, 11.0, 12.0]]
    else:
        assert_approved(told_of(tmp_path, "track", text), parts=[missing])


NOON = datetime(2026, 5, 1, 12, tzinfo=UTC).timestamp()


@pytest.mark.parametrize(
    ("columns", "cells", "clock", "time", "image"),
    [
        ("t_s", "1.5", "seconds", 1.5, []),
        ("t_utc", "2026-05-01T12:00:01.5Z", "utc-column", NOON + 1.5, []),
        ("t_utc", "2026-05-01T14:00:00+02:00", "utc-column", NOON, []),
        ("t_utc", "2026-05-01T06:30:00-05:30", "utc-column", NOON, []),
        ("image", "a.jpg", None, None, ["a.jpg"]),
        ("image,t_s", "a.jpg,2", "seconds", 2.0, ["a.jpg"]),
        ("image,t_utc", "a.jpg,2026-05-01T12:00:00Z", "utc-column", NOON, ["a.jpg"]),
        ("t_s,t_utc", "2,2026-05-01T12:00:00Z", "utc-column", NOON, []),
    ],
)
def test_times_and_images_of_a_track(
    columns: str, cells: str, clock: str | None, time: float | None, image: list[str],
    tmp_path: Path,
) -> None:  # fmt: skip
    rows = read(tmp_path, "track", f"{columns},lat_deg,lon_deg,h_m,sigma_m\n{cells},2,3,4,0.5\n")
    assert (rows.clock, rows.image) == (clock, image)
    assert rows.time_s is None if time is None else rows.time_s.tolist() == [time]
    assert rows.coordinate.tolist() == [[3.0, 2.0, 4.0]] and rows.geodetic
    assert rows.sigma_m.tolist() == [[0.5] * 3] and [*rows.line] == [2]
    unused = " (not used: t_s)" if columns == "t_s,t_utc" else ""
    assert rows.said == f"CSV{unused}, 1 position" and rows.velocity_m_s is None


@pytest.mark.parametrize("cell", ["1777636801500", "1777636801.5"])
def test_times_since_1970_in_a_column_of_another_name(cell: str, tmp_path: Path) -> None:
    """By their size they are milliseconds, or seconds; NOON is 1777636800 s."""
    rows = read(tmp_path, "track", f"time,lat_deg,lon_deg,h_m\n{cell},2,3,4\n")
    assert NOON == 1777636800.0
    assert rows.time_s is not None and rows.time_s.tolist() == [NOON + 1.5]
    assert rows.clock == "utc-column"
    assert_approved(rows.said)


def test_sigmas_of_a_drone_s_marks_are_east_north_up(tmp_path: Path) -> None:
    """The file has north, east, up."""
    text = "1\t1.5\t[2300]\t3,N\t4,E\t12,V\t47.6,Lat\t16.4,Lon\t540,Ellh\t1.0, 2.0, 3.0\t50,Q\n"
    rows = read(tmp_path, "track", text)
    assert rows.sigma_m.tolist() == [[2.0, 1.0, 3.0]]
    assert rows.coordinate.tolist() == [[16.4, 47.6, 540.0]]
    assert "antenna offsets of up to 0.01 m are not added" in rows.said  # 13 mm
    assert (rows.clock, rows.height, rows.crs) == ("gps", "ellipsoid", "EPSG:4326")


def test_gpx_has_all_points_of_all_tracks(tmp_path: Path) -> None:
    def point(k: int) -> str:
        time = f"<time>2026-05-01T12:00:0{k}Z</time>"
        return f'<trkpt lat="4{k}" lon="1{k}"><ele>{k}</ele>{time}</trkpt>'

    def segment(*numbers: int) -> str:
        return f"<trkseg>{''.join(map(point, numbers))}</trkseg>"

    inside = f"<trk>{segment(1, 2)}{segment(3)}</trk><trk>{segment(4)}</trk>"
    body = (
        f'<gpx version="1.1" creator="x" xmlns="http://www.topografix.com/GPX/1/1">{inside}</gpx>'
    )
    for head in ("", '<?xml version="1.0"?>\n<!-- a comment -->\n'):
        rows = read(tmp_path, "track", head + body)
        assert rows.coordinate.tolist() == [[10.0 + k, 40.0 + k, k] for k in (1, 2, 3, 4)]
        assert (rows.time_s - NOON).tolist() == [1.0, 2.0, 3.0, 4.0] and rows.clock == "utc"
        assert rows.said == "GPX, 4 positions, UTC"
    assert_approved(told_of(tmp_path, "track", body.replace(inside, "")))


# Winds


def test_heights_of_winds_are_geometric(tmp_path: Path) -> None:
    """z = r h / (r - h), r 6356766 m: 30000 geopotential metres are 30142.3; a CSV's are metres."""
    listed = (
        "   PRES   HGHT   TEMP   DRCT   {}\n"
        "    hPa     m      C    deg   unit\n"
        "   10.0  30000   -5.0    270     20\n"
        "   20.0  20000   -5.0      0     10\n"
    )
    wyoming = (
        "time,geopotential height_m,wind direction_degree,wind speed_m/s\n"
        "x,30000,270,20\nx,20000,0,10\n"
    )
    expected = [6356766.0 * h / (6356766.0 - h) for h in (20000.0, 30000.0)]
    assert 30142.2 < expected[1] < 30142.3
    knot = 1852.0 / 3600.0
    for text, scale, said in (
        (listed.format("SKNT"), knot, "wind: Wyoming text, knots, 2 levels"),
        (listed.format("SPED"), 1.0, "wind: Wyoming text, m/s, 2 levels"),
        (wyoming, 1.0, "wind: Wyoming CSV, m/s, 2 levels"),
    ):
        rows = read(tmp_path, "wind", text)
        assert_close("flight height", rows.height_m, expected)
        assert_close("ratio", rows.toward_m_s, scale * np.array([[-10.0, 0.0], [0.0, 20.0]]))
        assert rows.said == said
    for unit, scale in (("m_s", 1.0), ("kt", knot)):
        text = f"h_m,from_deg,speed_{unit}\n30000,270,20\n20000,360,10\n"
        rows = read(tmp_path, "wind", text)
        assert rows.height_m.tolist() == [20000.0, 30000.0]
        assert_close("ratio", rows.toward_m_s, scale * np.array([[-10.0, 0.0], [0.0, 20.0]]))
        name = "knots" if unit == "kt" else "m/s"
        assert rows.said == f"wind: CSV, {name}, 2 levels"


@pytest.mark.parametrize("wrong", ["height_feet", "direction_rad", "speed_knot"])
def test_the_units_of_a_sounding_are_looked_at(wrong: str, tmp_path: Path) -> None:
    names = ["geopotential height_m", "wind direction_degree", "wind speed_m/s"]
    what, unit = wrong.split("_")
    given = [f"{n.rpartition('_')[0]}_{unit}" if what in n else n for n in names]
    known = next(name.rpartition("_")[2] for name in names if what in name)
    said = told_of(tmp_path, "wind", f"{','.join(given)}\n1,2,3\n2,3,4\n")
    assert said.startswith("wind: line 1: ") and f"is in {unit}, {known} is known" in said


# Picks


def test_labels_of_tools_on_windows(tmp_path: Path) -> None:
    label = {
        "imagePath": "C:\\photos\\day 1\\a.png", "imageWidth": 40, "imageHeight": 30,
        "shapes": [
            {"label": "mast", "points": [[1.5, 2.5]], "shape_type": "point"},
            {"label": "roof", "points": [[1, 1], [2, 2]], "shape_type": "line"},
        ],
    }  # fmt: skip
    rows = read(tmp_path, "picks", json.dumps(label))
    assert ([*rows.frame], [*rows.landmark]) == (["a.png"], ["mast"])
    assert rows.pixel.tolist() == [[1.5, 2.5]]
    assert (rows.grid, rows.size_px, rows.said) == ("corner", (40, 30), "LabelMe")
    other = label | {"imagePath": "../b.png", "imageWidth": 41}
    (tmp_path / "labels").mkdir()
    for name, one in (("a", label), ("b", other)):
        (tmp_path / "labels" / f"{name}.json").write_text(json.dumps(one))
    both = read_by_content(PICK_FORMATS, open_input("labels", tmp_path))
    assert both.size_px == {"a.png": (40, 30), "b.png": (41, 30)}


def cvat(*images: str, tracks: str = "", size: str = "") -> str:
    return f"<annotations>{size}{''.join(images)}{tracks}</annotations>"


def image(name: str, width: int = 40, points: str = "1,2", label: str = "mast") -> str:
    inside = f'<points label="{label}" points="{points}"/>'
    return f'<image name="{name}" width="{width}" height="30">{inside}</image>'


def test_annotations_of_cvat(tmp_path: Path) -> None:
    rows = read(tmp_path, "picks", cvat(image("b"), image("a", points="3,4;5,6.5")))
    assert ([*rows.frame], [*rows.landmark]) == (["b", "a", "a"], ["mast"] * 3)
    assert rows.pixel.tolist() == [[1.0, 2.0], [3.0, 4.0], [5.0, 6.5]]
    assert (rows.grid, rows.size_px, rows.said) == ("corner", (40, 30), "CVAT images")
    size = "<meta><original_size><width>64</width><height>48</height></original_size></meta>"
    points = '<points frame="{}" outside="{}" points="7,8"/>'
    track = f'<track label="well">{points.format(9, 0)}{points.format(10, 1)}</track>'
    rows = read(tmp_path, "picks", cvat(tracks=track, size=size))
    assert (rows.frame.tolist(), [*rows.landmark]) == ([9], ["well"])
    assert (rows.size_px, rows.said) == ((64, 48), "CVAT video")


# Lenses of mrcal, and tags of images


@pytest.mark.parametrize(
    ("model", "count"),
    [("LENSMODEL_PINHOLE", 0), ("LENSMODEL_OPENCV4", 4), ("LENSMODEL_OPENCV5", 5),
     ("LENSMODEL_OPENCV8", 8), ("LENSMODEL_OPENCV12", 12), ("DISTORTION_NONE", 0),
     ("DISTORTION_OPENCV4", 4)],
)  # fmt: skip
def test_lenses_of_mrcal(model: str, count: int, tmp_path: Path) -> None:
    key = "distortion_model" if model[0] == "D" else "lensmodel"
    k = [0.125 * (one + 1) for one in range(count)]
    values = [900.0, 800.0, 45.0, 35.0, *k]
    text = str({key: model, "intrinsics": values, "imagersize": [90, 70]})
    if model == "DISTORTION_NONE":
        text += " # LENSMODEL_"
    (tmp_path / "lens").write_text(text)
    found = read_by_content(LENS_FORMATS, open_input("lens", tmp_path), LensQuestion()).lens
    assert found.focal_px.tolist() == [900.0, 800.0] and found.centre_px.tolist() == [45.0, 35.0]
    assert found.k[:count].tolist() == k and not found.k[count:].any()
    (tmp_path / "lens").write_text(text.replace("[900.0, ", "["))
    with refused(VopdError):
        read_by_content(LENS_FORMATS, open_input("lens", tmp_path), LensQuestion())


@pytest.mark.parametrize(
    ("zone", "seconds"),
    [("+02:00", 7200.0), ("-03:30", -12600.0), ("+05:45", 20700.0), ("+00:00", 0.0),
     ("2:00", np.nan), ("", np.nan), ("Z", np.nan)],
)  # fmt: skip
def test_zones_of_images_have_hours_and_minutes(zone: str, seconds: float, tmp_path: Path) -> None:
    tagged_image(tmp_path / "a.jpg", taken="2026:05:01 12:00:00", part="125", zone=zone)
    tags = read_tags(tmp_path / "a.jpg")
    assert tags.clock_s == NOON + 0.125 and not tags.whole_second
    assert tags.zone_s == seconds or np.isnan([tags.zone_s, seconds]).all()


@pytest.mark.parametrize("header", ["date,time_utc", "UTC date,time", "Date,Time (UTC)"])
def test_a_date_and_a_time_in_two_columns(header: str) -> None:
    rows = f"{header},lat,lon,alt\n2026/05/01,9:58:42.5,48,15,300\n2026-05-02,00:00:00,48,15,300\n"
    found = read_text(TRACK_FORMATS, "track", rows)
    first = datetime(2026, 5, 1, 9, 58, 42, 500000, UTC).timestamp()
    assert_close("time", found.time_s - first, [0.0, 50477.5])
    with refused(VopdError):
        read_text(TRACK_FORMATS, "track", rows.replace(header, "date,time"))


def test_of_two_dates_that_of_the_clock_of_the_times_counts() -> None:
    """The first counted: west of Greenwich it is a day behind in the evening."""
    rows = "date,date_utc,time_utc,lat,lon,alt\n2026-04-30,2026-05-01,00:00:05,48,15,300\n"
    found = read_text(TRACK_FORMATS, "track", rows)
    assert found.time_s.tolist() == [datetime(2026, 5, 1, 0, 0, 5, tzinfo=UTC).timestamp()]


def test_columns_of_angles_in_radians_are_not_to_be_renamed() -> None:
    table = read_csv(InputFile("t", Path(), "frame,yaw_rad\n0,1\n"), ("frame",))
    with refused(VopdError):
        table.numbers("yaw_deg")


def test_a_log_whose_header_says_utc() -> None:
    """As trackers of rockets write it; the number of seconds beside it is the same time."""
    header = "UTCTIME,UNIXTIME,ALT,LAT,LON,#SATS,FIX"
    row = "2026-05-02 18:04:05.250,1777745045.25,681.3,35.3,-117.8,14,3"
    found = read_text(TRACK_FORMATS, "track", f"{header}\n{row}\n{row.replace(':05', ':06')}\n")
    assert_close("time", found.time_s, [1777745045.25, 1777745046.25])
    assert found.coordinate[0].tolist() == [-117.8, 35.3, 681.3]


@pytest.mark.parametrize(
    "name", ["timestamp_utc", "Datetime (UTC)", "UTC timestamp", "GPS time (UTC)", "time_utc"]
)
def test_times_whose_names_say_the_clock(name: str) -> None:
    found = read_text(
        TRACK_FORMATS, "track", f"{name},lat,lon,alt\n2026-05-01 09:58:42.5,48,15,3\n"
    )
    first = datetime(2026, 5, 1, 9, 58, 42, 500000, UTC).timestamp()
    assert_close("time", found.time_s - first, [0.0])


def track_at(name: str, times: str) -> InputFile:
    rows = "\n".join(f"{one},47.6,16.4,{k}" for k, one in enumerate(times.split()))
    return of(f"{name},lat,lon,alt\n{rows}\n")


@pytest.mark.parametrize(
    "times", ["115858 115859 115900 115901", "115859.6 115859.8 115900 115900.2", "55 58 101 104",
              "95958 95959 100000 100001", "115859 115858 115901 115900"],
)  # fmt: skip
def test_times_of_day_without_colons_are_no_seconds(times: str) -> None:
    # 40 s, or 4040, are skipped where a minute, or an hour, is full
    for name in ("utc", "GPS time", "t"):
        with refused(VopdError):
            read_by_content(TRACK_FORMATS, track_at(name, times))
    rows = read_by_content(TRACK_FORMATS, track_at("t_s", times))
    assert rows.time_s is not None and rows.time_s.tolist() == [*map(float, times.split())]


@pytest.mark.parametrize(
    "times", ["115856 115857 115858 115859", "58 59 60 61", "58 59 100 260", "0 50 100 150",
              "100 200 300 400", "58 59 105 106", "0 30 59 99.5 100", "245958 245959 250000"],
)  # fmt: skip
def test_seconds_that_are_no_times_of_day(times: str) -> None:
    rows = read_by_content(TRACK_FORMATS, track_at("utc", times))
    assert rows.time_s is not None and rows.time_s.tolist() == [*map(float, times.split())]


def test_an_elapsed_time_counts_before_one_of_the_receiver() -> None:
    rows = "gps_time,elapsed,lat,lon,alt\n471522.0,2.5,48,15,3\n"
    assert read_text(TRACK_FORMATS, "track", rows).time_s.tolist() == [2.5]


@pytest.mark.parametrize("zoom", ["", ",1.00"])
def test_marks_without_a_header_as_pix4d_writes_them(zoom: str) -> None:
    rows = f"DJI_1.JPG,gcp1,10.5,20{zoom}\nDJI_2.jpg,gcp2,3,4{zoom}\n"
    found = read_text(PICK_FORMATS, "picks", rows)
    assert [*found.frame] == ["DJI_1.JPG", "DJI_2.jpg"] and [*found.landmark] == ["gcp1", "gcp2"]
    assert found.pixel.tolist() == [[10.5, 20.0], [3.0, 4.0]] and found.grid is None


def test_tie_points_of_opensfm_are_no_picks() -> None:
    rows = "IMG_1.jpg\t0\t12\t0.1\t0.2\t0.003\t1\t2\t3\t-1\t-1\n"
    with refused(VopdError):
        read_text(PICK_FORMATS, "picks", f"OPENSFM_TRACKS_VERSION_v2\n{rows}")


def test_heights_may_be_mapped_as_feet() -> None:
    """A foot is .3048 m; the column's own name does not say which it is."""
    file = InputFile(
        "track", Path("nowhere"), "t_s,lat,lon,Alt\n0,48,15,1000\n", columns={"h_ft": "Alt"}
    )
    found = read_by_content(TRACK_FORMATS, file)
    assert_close("feet", found.coordinate[0], [15.0, 48.0, 304.8])


@pytest.mark.parametrize(
    ("columns", "place"),
    [
        ({}, [15.0, 48.0, 300.0]),
        ({"h_m": "baro"}, [15.0, 48.0, 7.0]),
        ({"h_m": "baro", "lat_deg": "lon_deg", "lon_deg": "lat_deg"}, [48.0, 15.0, 7.0]),
    ],
)
def test_a_mapped_column_counts_and_not_one_that_has_the_name(
    columns: dict[str, str], place: list[float]
) -> None:
    """The other was read, and the answer said that the mapped one was."""
    text = "t_s,lat_deg,lon_deg,h_m,baro\n0,48,15,300,7\n"
    found = read_by_content(TRACK_FORMATS, InputFile("t", Path(), text, columns=columns))
    assert found.coordinate[0].tolist() == place
    assert_approved(found.said)


@pytest.mark.parametrize(
    "text", ['{"images": [1, 2], "annotations": []}', '[{"u": 1, "v": 2}]', "<a>,b"]
)
def test_json_and_xml_of_other_programs_have_no_columns(text: str) -> None:
    """It was advised to rename the columns `{"images": [1` and `2]`."""
    with refused(VopdError):
        read_text(PICK_FORMATS, "t", text)
