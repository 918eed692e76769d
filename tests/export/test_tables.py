"""CSV, JSON Lines, npz and Parquet, read back by others; what values and covariances become."""

from __future__ import annotations

import csv
import io
import json
import math
import shutil
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import refused
from tests.kit import repeated_frame
from tests.kit.attitude_files import (
    ANGLES,
    CASES_123,
    EPOCH,
    NAMES,
    VEHICLE,
    apart_deg,
    column,
    deck_text,
    printed,
    write,
)
from tests.kit.command import CASE_1, DECKS, ROOT, vopd
from tests.kit.estimates import REQUEST, estimate, level_flight
from tests.kit.histories import histories
from tests.kit.jobs import reread
from tests.tolerances import assert_close
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import FIXED, INTERVALS, MATRICES, TableColumn, columns_of, table
from vopd.export import FORMATS, FileRequest
from vopd.export import tables as csv_table
from vopd.export import tables as plain_table
from vopd.export import viewers as kml
from vopd.export.tables import arrow_column, as_text, cell_csv, dataframe
from vopd.film import film_estimate
from vopd.findings import VopdError, strict
from vopd.pipeline import run

SAID = ("program", "deck", "fixes", "from frame", "to frame", "sequence", "quaternion", "ranges")
QUATERNION = ["quaternion_x", "quaternion_y", "quaternion_z", "quaternion_w"]

Read = tuple[dict[str, str], pd.DataFrame]


def read_csv(path: Path) -> Read:
    lines = path.read_text().splitlines(keepends=True)
    head = [line for line in lines if line.startswith("# ")]
    assert lines[: len(head)] == head
    said = dict(line[2:].rstrip("\n").split(": ", 1) for line in head)
    names = next(csv.reader(lines[len(head) :]))
    table = pd.read_csv(path, comment="#", keep_default_na=False, na_values=[""])
    assert list(table.columns) == names
    return said, table


def read_jsonl(path: Path) -> Read:
    head, *rows = [json.loads(line) for line in path.read_text().splitlines()]
    table = pd.DataFrame(rows)
    assert list(table.columns) == list(head["columns"])
    assert head["columns"]["vehicle_yaw_deg"]["unit"] == "deg"
    return head["conventions"], table


def read_npz(path: Path) -> Read:
    with np.load(path, allow_pickle=False) as archive:
        arrays: dict[str, Any] = {name: archive[name] for name in archive.files}
    columns = json.loads(str(arrays.pop("columns")))
    said = json.loads(str(arrays.pop("conventions")))
    assert list(columns) == list(arrays) and columns["airspeed_ft_s"]["unit"] == "ft/s"
    return said, pd.DataFrame({name: list(array) for name, array in arrays.items()})


def read_parquet(path: Path) -> Read:
    table = pq.read_table(path)
    assert table.schema.field("airspeed_ft_s").metadata[b"unit"] == b"ft/s"
    assert b"PSI" in table.schema.field("vehicle_yaw_deg").metadata[b"meaning"]
    return json.loads(table.schema.metadata[b"conventions"]), table.to_pandas()


READERS = {"csv": read_csv, "jsonl": read_jsonl, "npz": read_npz, "parquet": read_parquet}


@pytest.mark.parametrize("form", READERS)
@pytest.mark.parametrize("name", NAMES)
def test_the_numbers_are_the_listing_s(name: str, form: str, tmp_path: Path) -> None:
    said, table = READERS[form](write(tmp_path, name, f"table.{form}"))
    assert set(SAID) <= set(said)
    assert said["deck"] == str(tmp_path / f"{name}.dat")
    rows = printed(name)
    solved = table[table["status"] == "solved"]
    assert solved["frame"].tolist() == [row["frame"] for row in rows]
    expected = column(rows, ANGLES)
    assert_close("printed angle", apart_deg(solved[ANGLES], expected), 0.0)
    assert_close("printed time", solved["time_s"], column(rows, ["time_s"])[:, 0])
    feet = solved[["vehicle_east_ft", "vehicle_north_ft", "vehicle_up_ft"]]
    assert_close("printed feet", feet, column(rows, ["east", "north", "up"]))
    euler = Rotation.from_quat(solved[QUATERNION].to_numpy()).as_euler("ZYX", degrees=True)
    assert_close("printed angle", apart_deg(euler, column(rows, VEHICLE)), 0.0)


@pytest.mark.parametrize("form", READERS)
def test_an_ignored_frame_has_a_row_without_numbers(form: str, tmp_path: Path) -> None:
    """Case 4: frame 55 is ignored, and flown all the same."""
    _, table = READERS[form](write(tmp_path, "case4", f"table.{form}"))
    first = table.iloc[0]
    assert table["frame"].tolist() == [55, 60, 65] and first["status"] == "ignored"
    assert pd.isna(first["vehicle_yaw_deg"]) and pd.isna(first["sigma_eta_deg"])
    assert first["altitude_ft"] == 120747.4 and first["landmarks"] == 0


def test_full_precision_is_the_same_in_all(tmp_path: Path) -> None:
    tables = [READERS[form](write(tmp_path, "flight", f"t.{form}"))[1] for form in READERS]
    text, *full = tables
    for other in full[1:]:
        for one in full[0].columns.difference([matrix.name for matrix in MATRICES]):
            left, right = full[0][one], other[one]
            same = (left == right) | (left.isna() & right.isna())
            assert same.all() or set(left[~same]) | set(right[~same]) <= {"", None}, one
    yaw = full[0]["vehicle_yaw_deg"]
    assert (text["vehicle_yaw_deg"] == yaw.round(6)).all() and not (yaw == yaw.round(6)).all()


def test_text_has_the_decimals_of_its_column() -> None:
    result = vopd("attitude", "-", stdin=deck_text("case1"))
    rows = [line for line in result.stdout.splitlines() if not line.startswith("#")]
    (row,) = csv.DictReader(io.StringIO("\n".join(rows)))
    assert (row["time_s"], row["frame"], row["landmarks"]) == ("70.871306", "730", "3")
    mantissa, _, exponent = row["last_correction_rad"].partition("e")
    assert len(mantissa.lstrip("-")) == 8 and exponent.lstrip("+-").isdigit()
    decimals = {name: len(row[name].partition(".")[2]) for name in row}
    assert (decimals["vehicle_yaw_deg"], decimals["quaternion_w"]) == (6, 10)
    assert (decimals["airspeed_ft_s"], decimals["residual_rms_mm"]) == (4, 8)


def test_epoch_components_and_fixes_are_stated(tmp_path: Path) -> None:
    options = ("--epoch", "1974-08-27T12:30:00-05:00", "--landmark-sigma", "30", "--fix", "earth")
    said, table = read_csv(write(tmp_path, "case1", "t.csv", *options))
    assert said["time"].endswith("zero is 1974-08-27T17:30:00.000000Z")
    assert said["fixes"] == "earth (WGS 84)" and "normal of" in said["from frame"]
    assert "; components: reading, centre, landmark; they exclude" in said["sigmas"]
    components = table[[f"sigma_{c}_eta_deg" for c in ("reading", "centre", "landmark")]].to_numpy()
    total = np.sqrt((components**2).sum())
    assert_close("six decimals", table["sigma_eta_deg"].item(), total)


def test_several_decks_and_jobs_are_one_table(tmp_path: Path) -> None:
    decks = [str(CASES_123), str(CASES_123.with_name("case1.dat"))]
    result = vopd("attitude", *decks, "-o", str(tmp_path / "t.csv"), "--epoch", EPOCH)
    assert result.status == 0, result.stderr
    said, table = read_csv(tmp_path / "t.csv")
    assert said["deck"] == ", ".join(decks)
    assert table["deck"].tolist() == [decks[0]] * 3 + [decks[1]]
    assert table["job"].tolist() == [1, 2, 3, 1]
    yaws = [printed(f"case{k}")[0]["vehicle_yaw_deg"] for k in (1, 2, 3, 1)]
    assert_close("printed angle", table["vehicle_yaw_deg"], yaws)


def test_what_does_not_print_in_a_deck_s_name_is_escaped(tmp_path: Path) -> None:
    deck = tmp_path / "two\nlines #1, \u00e9.dat"
    deck.write_text(deck_text("case1"))
    for form, reader in READERS.items():
        path = tmp_path / f"t.{form}"
        result = vopd("attitude", str(deck), "-o", str(path), "-q")
        assert result.status == 0, result.stderr
        if form != "csv":  # pandas takes every # for a comment
            said, table = reader(path)
            assert table["deck"].item() == str(deck).replace("\n", "\\n") == said["deck"]
    rows = [x for x in (tmp_path / "t.csv").read_text().splitlines() if not x.startswith("# ")]
    assert len(rows) == 2 and next(csv.reader(rows[1:]))[0] == str(deck).replace("\n", "\\n")


def test_the_page_explains_every_column() -> None:
    page = (ROOT / "docs" / "attitude-files.md").read_text()
    (one_deck,) = histories("appendix_h/case1")
    for one in (*columns_of([one_deck])[: len(FIXED)], *INTERVALS[-2:], *MATRICES):
        assert f"| `{one.name}` | {one.unit} | {one.meaning} |" in page
    for one in FORMATS.values():
        assert f"| `{one.name}` | {' '.join(one.suffixes)} |" in page


def test_a_missing_number_is_null_in_parquet(tmp_path: Path) -> None:
    """Not NaN, which a database would take for a number: frame 55 is ignored."""
    path = tmp_path / "t.parquet"
    assert vopd("attitude", DECKS / "appendix_h" / "case4.dat", "-q", "-o", path).status == 0
    found = pq.read_table(path)
    assert found["camera_yaw_deg"].to_pylist()[0] is None
    assert found["covariance_common_deg2"].null_count == 1
    for name in found.column_names:
        numbers = [value for value in found[name].to_pylist() if isinstance(value, float)]
        assert not np.isnan(numbers).any(), name


# What values become in each format

VALUES: dict[str, Any] = {
    "word": np.array(["=1", 'say "ü"', "a,b", "-", "東\n"]),
    "whole": np.array([0, -7, 1234567890123, 5, 6]),
    "mark": np.array([True, False, True, True, False]),
    "number": np.array([1.5, np.nan, np.inf, -np.inf, -0.0]),
    "matrix": np.stack([
        np.arange(9.0).reshape(3, 3), np.full((3, 3), np.nan), np.full((3, 3), np.inf),
        np.diag([np.nan, 1.0, 2.0]), -np.eye(3),
    ]),
}  # fmt: skip
STATED = {"program": "vopd ü", "time": "s"}
COLUMNS = {name: {"unit": f"{name} ü", "meaning": f"the {name}"} for name in VALUES}
MATRICES_VALUES = [
    [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 8.0]], None, [[None] * 3] * 3,
    [[None, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]],
    [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
]  # fmt: skip


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ([-0.0, 0.0, np.nan, 2.345678], ["-0.000", "0.000", "", "2.346"]),
        ([-0.0, -0.0], ["-0.000", "-0.000"]),
        ([np.nan, np.nan, np.nan], ["", "", ""]),
        ([2.5], ["2.500"]),
        ([], []),
    ],
)
def test_numbers_of_a_column_as_text(numbers: list[float], expected: list[str]) -> None:
    """One that is the same in all rows too, to the sign of zero."""
    values = np.repeat(np.array(numbers, dtype=float)[:, None], 2, axis=1)[:, 1]
    column = TableColumn("a", "m", 3, "a", "a number")
    assert as_text({"a": values}, [column]) == {"a": expected}


def test_json_lines() -> None:
    """The first line states; what is missing or infinite is null; letters are not escaped."""
    content = plain_table.render_table("jsonl", VALUES, STATED, COLUMNS)
    first, *rows = content.decode().splitlines()
    assert [*json.loads(first)] == ["conventions", "columns"] and "\\u" not in first
    assert json.loads(first) == {"conventions": STATED, "columns": COLUMNS}
    found = [json.loads(row) for row in rows]
    assert all([*row] == [*VALUES] for row in found) and content.endswith(b"}\n")
    assert [row["word"] for row in found] == VALUES["word"].tolist() and "東" in rows[4]
    assert [row["whole"] for row in found] == VALUES["whole"].tolist()
    assert [row["mark"] for row in found] == VALUES["mark"].tolist()
    assert [row["number"] for row in found] == [1.5, None, None, None, 0.0]
    assert [row["matrix"] for row in found] == MATRICES_VALUES


def test_numpy() -> None:
    content = plain_table.render_table("npz", VALUES, STATED, COLUMNS)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert {one.compress_type for one in archive.infolist()} == {zipfile.ZIP_DEFLATED}
    with np.load(io.BytesIO(content)) as found:
        assert [*found] == ["conventions", "columns", *VALUES]
        for name, values in VALUES.items():
            np.testing.assert_array_equal(found[name], values)
        assert json.loads(str(found["conventions"])) == STATED
        assert json.loads(str(found["columns"])) == COLUMNS
        assert "\\u" not in str(found["conventions"]) + str(found["columns"])


def test_parquet() -> None:
    """NaN is null, and a matrix that is NaN altogether; infinite numbers stay."""
    parquet = pytest.importorskip("pyarrow.parquet")
    content = plain_table.render_table("parquet", VALUES, STATED, COLUMNS)
    table = parquet.read_table(io.BytesIO(content))
    assert table.column_names == [*VALUES]
    assert json.loads(table.schema.metadata[b"conventions"]) == STATED
    assert b"\\u" not in table.schema.metadata[b"conventions"]
    for field in table.schema:
        about = {key.decode(): text.decode() for key, text in field.metadata.items()}
        assert about == COLUMNS[field.name]
    found = table.to_pydict()
    assert found["word"] == VALUES["word"].tolist()
    assert found["whole"] == VALUES["whole"].tolist() and found["mark"] == VALUES["mark"].tolist()
    assert found["number"] == [1.5, None, np.inf, -np.inf, 0.0]
    matrix = found["matrix"]
    assert matrix[0] == MATRICES_VALUES[0] and matrix[1] is None and matrix[4] == MATRICES_VALUES[4]
    assert matrix[2] == [[np.inf] * 3] * 3
    assert np.isnan(matrix[3][0][0]) and matrix[3][1] == [0.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (np.array(["a", "\udcff", ""]), ["a", "\\udcff", ""]),
        (np.array([True] * 9 + [False] * 2), [True] * 9 + [False] * 2),
        (np.array([], float), []), (np.array([np.nan] * 9), [None] * 9),
        (np.array([1, 2], np.int32), [1, 2]), (np.array([0.1], np.float32), [np.float32(0.1)]),
        (np.full((2, 3, 3), np.nan), [None, None]),
    ],
)  # fmt: skip
def test_columns_of_arrow(values: Any, expected: list[Any]) -> None:
    pytest.importorskip("pyarrow")
    column = arrow_column(values)
    assert column.to_pylist() == expected
    assert column.null_count == sum(one is None for one in expected)


@pytest.mark.parametrize(
    ("text", "cell"),
    [
        ("=1", "'=1"), ("+1", "'+1"), ("-1", "'-1"), ("@a", "'@a"), ("=", "="), ("-", "-"),
        ("", ""), ("a=", "a="), ("'=1", "'=1"), ("--", "'--"), ("a#1", '"a#1"'), ("#", '"#"'),
        ('a,"#', '"a,""#"'), ("=#", '"\'=#"'),
    ],
)  # fmt: skip
def test_no_word_is_a_formula_or_a_comment(text: str, cell: str) -> None:
    assert cell_csv(text) == cell


def test_pandas_reads_a_name_with_a_number_sign(tmp_path: Path) -> None:
    """By the line of the documentation: all behind the sign was a comment, and the row empty."""
    shutil.copy(CASE_1, tmp_path / "film #3.dat")
    assert vopd("attitude", tmp_path / "film #3.dat", "-o", tmp_path / "a.csv").status == 0
    read = pd.read_csv(tmp_path / "a.csv", comment="#")
    assert read["deck"][0].endswith("film #3.dat") and list(read["frame"]) == [730]
    assert not read["vehicle_yaw_deg"].isna().any()


WORDS = (
    TableColumn("word", "", None, "x", ""), TableColumn("whole", "", None, "x", ""),
    TableColumn("number", "", 2, "x", ""), TableColumn("small", "", None, "x", ""),
    TableColumn("mark", "", None, "x", ""),
)  # fmt: skip


def test_columns_as_text() -> None:
    """Decimals of the column, or an exponent; words as they are; NaN is empty."""
    values = {name: VALUES[name] for name in ("word", "whole", "number", "mark")}
    values["small"] = np.array([1.25e-7, 0.0, -3.0, np.nan, 1e100])
    assert csv_table.as_text(values, WORDS) == {
        "word": VALUES["word"].tolist(),
        "whole": ["0", "-7", "1234567890123", "5", "6"],
        "number": ["1.50", "", "inf", "-inf", "-0.00"],
        "small": ["1.250000e-07", "0.000000e+00", "-3.000000e+00", "", "1.000000e+100"],
        "mark": ["True", "False", "True", "True", "False"],
    }


def test_hostile_numbers_as_text() -> None:
    """Ties by the exact value, carries, and the largest and smallest numbers there are."""
    number = np.array([0.125, 0.375, 2.675, 9.995, 99.996, -0.004, 1e300, 5e-324, np.inf])
    small = np.array([9.9999995e-7, 1234566.5, 5e-324, 1e300, -0.0, 1e-100, -np.inf, 1.0, 9.5])
    text = csv_table.as_text({"number": number, "small": small}, [WORDS[2], WORDS[3]])
    assert text["number"] == [
        "0.12", "0.38", "2.67", "9.99", "100.00", "-0.00", str(int(1e300)) + ".00", "0.00", "inf",
    ]  # fmt: skip
    assert text["small"] == [
        "9.999999e-07", "1.234566e+06", "4.940656e-324", "1.000000e+300", "-0.000000e+00",
        "1.000000e-100", "-inf", "1.000000e+00", "9.500000e+00",
    ]  # fmt: skip


def test_an_azimuth_that_is_rounded_to_a_whole_turn_is_0() -> None:
    (yaw,) = [one for one in FIXED if one.name == "camera_yaw_deg"]
    other = replace(yaw, name="altitude_ft")
    near = np.array([359.9999996, 359.9999994, 360.0, 36.0, np.nan])
    text = csv_table.as_text({yaw.name: near, other.name: near}, [yaw, other])
    assert text[yaw.name] == ["0.000000", "359.999999", "0.000000", "36.000000", ""]
    assert text[other.name][0] == "360.000000"
    whole = ["360", "3600.0", "360.01", "360.00"]
    assert csv_table.below_360(whole) == ["0", "3600.0", "360.01", "0.00"]


def test_rows_of_a_csv() -> None:
    """Cells in quotes where they need them, and no cell a formula."""
    values = {name: VALUES[name] for name in ("word", "whole", "number")}
    rows = "".join(csv_table._rows_csv(values, WORDS[:3]))
    assert rows == (
        '\'=1,0,1.50\n"say ""ü""",-7,\n"a,b",1234567890123,inf\n-,5,-inf\n"東\n",6,-0.00\n'
    )


@pytest.mark.parametrize(
    ("sentence", "line"),
    [
        ("a, =b", "# k: a, '=b\n"), ("a;-b", "# k: a;'-b\n"), ("a,  @b; +c", "# k: a,  '@b; '+c\n"),
        ("=a, b", "# k: =a, b\n"), ("a = b, c-d", "# k: a = b, c-d\n"),
    ],
)  # fmt: skip
def test_no_cell_of_a_comment_is_a_formula(sentence: str, line: str) -> None:
    assert csv_table._comment("k", sentence) == line


def test_a_csv_is_comments_then_names_then_rows() -> None:
    lines = FORMATS["csv"].render([level_flight()], REQUEST).decode().split("\n")
    comments = [line for line in lines if line.startswith("#")]
    assert lines[: len(comments)] == comments and comments[0].startswith("# program: vopd ")
    assert lines[len(comments)].startswith("flight,job,frame,") and lines[-1] == ""
    assert len(lines) == len(comments) + 4
    first = json.loads(FORMATS["jsonl"].render([level_flight()], REQUEST).splitlines()[0])
    assert first["conventions"]["time"].endswith("zero is 2026-05-01T09:00:00.000000Z")
    assert [*first["columns"]][-2:] == ["covariance_deg2", "covariance_common_deg2"]
    assert first["columns"]["time_s"]["unit"] == "s"


def test_a_data_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    """The columns of the table, a matrix in each row, the conventions in `attrs`."""
    pytest.importorskip("pandas")
    found = dataframe([level_flight(), level_flight(2)])
    assert len(found) == 4 and found["job"].tolist() == [1, 1, 2, 2]
    assert found["time_s"].tolist() == [10.0, 12.5] * 2
    assert found["covariance_deg2"][2].tolist()[0] == [0.25, 5.0, 0.0]
    assert found.attrs["position"] and found.attrs["program"].startswith("vopd ")
    with refused(VopdError):
        dataframe([])
    monkeypatch.setitem(sys.modules, "pandas", None)
    with refused(VopdError):
        dataframe([level_flight()])


def test_a_table_needs_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with refused(VopdError):
        plain_table.render_table("parquet", VALUES, STATED, COLUMNS)


def one_by_one(values: dict[str, Any], *_: object) -> Iterator[dict[str, Any]]:
    """A table in blocks of one row."""
    for k in range(len(next(iter(values.values())))):
        yield {name: column[k : k + 1] for name, column in values.items()}


def test_files_are_the_same_in_blocks_of_one_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows that are made together with those of other files, and the placemarks of frames."""
    files = [
        ([level_flight(1), level_flight(2)], REQUEST, strict),
        ([level_flight(3)], REQUEST, strict),
    ]
    usual = FORMATS["csv"].render_files(files)
    three = [history(estimate(np.tile([140.0, -60.0, 20.0], (3, 1))))]
    placemarks = FORMATS["kml"].render(three, REQUEST)
    monkeypatch.setattr(csv_table, "row_blocks", one_by_one)
    monkeypatch.setattr(kml, "row_blocks", one_by_one)
    assert FORMATS["csv"].render_files(files) == usual
    assert FORMATS["kml"].render(three, REQUEST) == placemarks
    rows = [[row for row in file.decode().splitlines() if row[0] != "#"] for file in usual]
    assert [len(one) for one in rows] == [5, 3]
    assert [row.split(",")[:3] for row in rows[1][1:]] == [
        ["hand.toml", "3", name] for name in ("7", "8")
    ]


# Covariances

EPOCH_COVARIANCE = datetime(1974, 8, 27, 17, 30, tzinfo=UTC)
AXES = ("forward", "right", "down")
READERS_COVARIANCE = ("csv", "jsonl", "npz", "parquet", "dataframe")


@cache
def made() -> tuple[History, ...]:
    """A deck of two frames; in the first one landmark, twice, in the second four; 30 ft each."""
    job = repeated_frame.repeated(landmarks=[0, 1, 2, 3], draws=3)
    present = job.readings.present.copy()
    present[0, 1:] = False
    ignored = replace(job.ignored, frame=np.array([3]), landmark=np.array([[100, 0, 0, 0, 0, 0]]))
    readings = reread(job.readings, present=present)
    (solved,) = run(replace(job, readings=readings, ignored=ignored)).jobs
    return (history(film_estimate(solved.results, "two.dat"), sigmas=Sigmas(landmark=30.0)),)


def content(form: str) -> bytes:
    return FORMATS[form].render(made(), FileRequest(epoch=EPOCH_COVARIANCE))


def rows_of(form: str) -> list[dict[str, Any]]:
    """What each reader finds, a row a frame; missing is None or NaN."""
    if form == "csv":
        lines = [line for line in content(form).decode().splitlines() if line[0] != "#"]
        return list(csv.DictReader(io.StringIO("\n".join(lines))))
    if form == "jsonl":

        def refuse(name: str) -> float:
            raise AssertionError(f"{name} is not JSON")

        text = content(form).decode().splitlines()[1:]
        return [json.loads(line, parse_constant=refuse) for line in text]
    if form == "npz":
        with np.load(io.BytesIO(content(form)), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files if archive[name].ndim}
        return [{name: array[k] for name, array in arrays.items()} for k in range(3)]
    if form == "parquet":
        return pq.read_table(io.BytesIO(content(form))).to_pylist()
    return dataframe(made()).to_dict("records")


def number(value: Any) -> float:
    return math.nan if value in ("", None) else float(value)


@pytest.mark.parametrize("form", READERS_COVARIANCE)
def test_six_columns_of_each_part(form: str) -> None:
    """Infinite where two axes have a part in the free turn; in JSON that is null."""
    first, second, ignored = rows_of(form)
    (one,) = made()
    for part in ("", "common_"):
        whole = getattr(one.uncertainty, f"covariance_{part}deg2")
        for i in range(3):
            for j in range(i, 3):
                name = f"covariance_{part}{AXES[i]}_{AXES[j]}_deg2"
                undetermined = number(first[name])
                assert math.isnan(undetermined) if form == "jsonl" else math.isinf(undetermined)
                if form not in ("jsonl", "csv"):
                    assert undetermined == whole[0, i, j]
                assert_close("seven digits", number(second[name]) / whole[1, i, j], 1.0)
                assert math.isnan(number(ignored[name]))
    assert math.isnan(number(ignored["sigma_vehicle_yaw_deg"]))
    sigma = number(first["sigma_vehicle_yaw_deg"])
    assert math.isnan(sigma) if form == "jsonl" else sigma == math.inf


@pytest.mark.parametrize("form", READERS_COVARIANCE[1:])
@pytest.mark.parametrize("part", ["", "common_"])
def test_a_matrix_a_frame(form: str, part: str) -> None:
    first, second, ignored = (row[f"covariance_{part}deg2"] for row in rows_of(form))
    (one,) = made()
    whole = getattr(one.uncertainty, f"covariance_{part}deg2")
    assert_close("ratio", np.array(second, float) / whole[1], np.ones((3, 3)))
    if form == "jsonl":
        assert first == [[None] * 3] * 3 and ignored is None
    else:
        assert (np.array(first, float) == whole[0]).all() and np.isinf(whole[0]).all()
        assert ignored is None if form == "parquet" else np.isnan(ignored).all()


def test_the_matrix_has_the_columns_elements() -> None:
    (_, row, _) = rows_of("jsonl")
    matrix = np.array(row["covariance_deg2"])
    assert (matrix == matrix.T).all()
    for i, one in enumerate(AXES):
        for j, other in enumerate(AXES[i:], i):
            assert matrix[i, j] == row[f"covariance_{one}_{other}_deg2"]


def test_the_common_part_is_that_of_the_landmarks() -> None:
    """The rest is the covariance of the same job without errors of the landmarks."""
    (one,) = made()
    given = Sigmas(reading=0.01, fiducial=0.01)
    without = history(one.estimate, sigmas=given).uncertainty
    both = history(one.estimate, sigmas=replace(given, landmark=30.0)).uncertainty
    assert (without.covariance_common_deg2[1] == 0.0).all()
    rest = both.covariance_deg2[1] - both.covariance_common_deg2[1]
    assert_close("ratio", rest / without.covariance_deg2[1], np.ones((3, 3)))
    assert_close("ratio", both.covariance_independent_deg2[1] / rest, np.ones((3, 3)))
    assert np.isinf(both.covariance_independent_deg2[0]).all()


def test_matrices_are_described() -> None:
    head = json.loads(content("jsonl").decode().splitlines()[0])
    for part in ("", "common_"):
        told = head["columns"][f"covariance_{part}deg2"]
        assert told["unit"] == "deg2" and "forward, right and down" in told["meaning"]
    schema = pq.read_schema(io.BytesIO(content("parquet")))
    assert schema.field("covariance_deg2").metadata[b"unit"] == b"deg2"


@pytest.mark.parametrize("form", ["kml", "czml", "aem"])
def test_a_viewer_is_never_given_an_infinite_number(form: str) -> None:
    text = content(form).decode()
    described = text.replace("infinite where", "")
    assert "Infinity" not in described and ">inf<" not in described and " inf" not in described
    assert "nan" not in described.lower()


def test_a_spreadsheet_reads_inf() -> None:
    """As pandas does, which the documentation shows."""
    frame = pd.read_csv(io.BytesIO(content("csv")), comment="#")
    found = frame["sigma_vehicle_yaw_deg"]
    assert found[0] == np.inf and np.isfinite(found[1]) and np.isnan(found[2])
    assert table(made())["sigma_vehicle_yaw_deg"][0] == np.inf
