"""What a table's values become in CSV, JSON, NumPy, Parquet and pandas, each kind of value."""

from __future__ import annotations

import io
import json
import sys
import zipfile
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.estimates import REQUEST, level_flight
from vopd.attitude.table import TableColumn
from vopd.export import FORMATS
from vopd.export import tables as csv_table
from vopd.export import tables as plain_table
from vopd.export import viewers as kml
from vopd.export.tables import arrow_column, dataframe, not_a_formula
from vopd.findings import VopdError, strict

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
MATRICES = [
    [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [6.0, 7.0, 8.0]], None, [[None] * 3] * 3,
    [[None, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]],
    [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
]  # fmt: skip


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
    assert [row["matrix"] for row in found] == MATRICES


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
    assert matrix[0] == MATRICES[0] and matrix[1] is None and matrix[4] == MATRICES[4]
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
        ("", ""), ("a=", "a="), ("'=1", "'=1"), ("--", "'--"),
    ],
)  # fmt: skip
def test_no_word_is_a_formula(text: str, cell: str) -> None:
    assert not_a_formula(text) == cell


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
    placemarks = FORMATS["kml"].render([level_flight()], REQUEST)
    monkeypatch.setattr(csv_table, "row_blocks", one_by_one)
    monkeypatch.setattr(kml, "row_blocks", one_by_one)
    assert FORMATS["csv"].render_files(files) == usual
    assert FORMATS["kml"].render([level_flight()], REQUEST) == placemarks
    rows = [[row for row in file.decode().splitlines() if row[0] != "#"] for file in usual]
    assert [len(one) for one in rows] == [5, 3]
    assert [row.split(",")[:3] for row in rows[1][1:]] == [
        ["hand.toml", "3", name] for name in ("7", "8")
    ]
