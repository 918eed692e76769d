"""Tables in text: separators, comments, blocks of rows, cells, and what is said of a wrong one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vopd.findings import VopdError
from vopd.flight.files import (
    InputFile,
    csv_blocks,
    frames_of_column,
    has_columns,
    header_names,
    read_csv,
    whole_numbers,
)


def of(text: str) -> InputFile:
    return InputFile("t", Path(), text)


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refused:
        action()
    return str(refused.value)


@pytest.mark.parametrize("between", [",", ";", "\t"])
def test_columns_are_separated_by_what_the_header_has_most_of(between: str) -> None:
    text = f"\n # a, comment; with\t all\n a{between} B {between}c x\n1{between}2{between} 3 \n"
    assert header_names(of(text)) == ["a", "B", "c x"]
    table = read_csv(of(text))
    assert table.header == ["a", "B", "c x"] and [*table.line] == [4]
    assert [table.column(name) for name in table.header] == [["1"], ["2"], ["3"]]
    assert has_columns(of(text), ("z",), ("a", "B")) and not has_columns(of(text), ("a", "b"))
    assert not has_columns(of(text), ("z",), ("B", "z")) and not has_columns(of(text))


def test_lines_that_are_no_rows_are_counted() -> None:
    """Empty lines, blanks, and lines whose first character that is no blank is #."""
    text = '# x\n\na,b\n  # y\n1,"p # q, r"\n \n3,#4\n#5,6\n7,8'
    table = read_csv(of(text))
    assert [*table.line] == [5, 7, 9]
    assert table.column("b") == ["p # q, r", "#4", "8"]
    assert told(lambda: table.numbers("b")) == "t: line 5, column b: 'p # q, r' is not a number; " \
        "decimals take a point"  # fmt: skip
    assert [*read_csv(of("a\n1\n2\n")).line] == [2, 3]


@pytest.mark.parametrize("text", ["", "\n \n", "# a,b\n"])
def test_a_table_has_a_header(text: str) -> None:
    assert header_names(of(text)) == []
    assert told(lambda: read_csv(of(text))) == "t: the file is empty"


def test_a_header_without_rows() -> None:
    table = read_csv(of("a,b\n# none\n"))
    assert table.column("a") == table.column("b") == [] and len(table.line) == 0
    assert table.numbers("a").shape == table.sigmas("a").shape == table.sigmas("c").shape == (0,)
    assert [one.header for one in csv_blocks(of("a,b\n"))] == [["a", "b"]]
    found = whole_numbers(table, "a")
    assert found is not None and found.tolist() == [] and found.dtype == np.int64
    assert np.asarray(frames_of_column(read_csv(of("frame\n")))).tolist() == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n1,2\n#\n1\n1,2,3\n", "t: line 4: 1 cells, the header has 2"),
        ("a,b\n1,2\n\n1,2,3\n1\n", "t: line 4: 3 cells, the header has 2; decimals take a point"),
        ("#\n\na, b,a,b ,c\n", "t: line 3: two columns are called a, b"),
        ("# x\na,b\n1,2\n1,\"2\n3,4\n", "t: line 4: a quoted cell goes over the end of the line"),
        ("a,b\n1,2\n3,4\n1,\"2", "t: line 4: a quoted cell goes over the end of the line"),
        ("a,b\n1,2\n#\n1," + "x" * 131_073 + "\n3,4\n",
         "t: line 4: field larger than field limit (131072)"),
    ],
)  # fmt: skip
def test_rows_that_are_refused_are_named_by_their_lines(text: str, message: str) -> None:
    assert told(lambda: read_csv(of(text))) == message


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
    for wrong, message in (
        (f"{ROWS - 2},", f"t: line {ROWS + 1}, column v: the cell is empty"),
        (f"{ROWS - 2},-1", ""),
        (f"{ROWS - 2}", f"t: line {ROWS + 1}: 2 cells, the header has 3"),
    ):
        text = file.text.replace(f"\n{ROWS - 2},{ROWS - 2}.25", f"\n{wrong}")
        found = InputFile("t", Path(), text)
        if message:
            assert told(lambda found=found: read_csv(found).numbers("v")) == message
        else:
            said = told(lambda found=found: read_csv(found).sigmas("v"))
            assert said.startswith(f"t: line {ROWS + 1}, column v: -1 is not a standard deviation")


# Cells


KNOWN = "; leave the cell empty where it is not known"


@pytest.mark.parametrize(
    ("cell", "value", "message"),
    [
        ("1.5", 1.5, ""), ("-2e-3", -0.002, ""), ("", None, "the cell is empty"),
        ("x", None, "'x' is not a number{}"), ("1,5", None, "'1,5' is not a number; decimals take"),
        ("nan", None, "nan is not a finite number{}"), ("-inf", None, "-inf is not a finite numb"),
        ("1e999", None, "1e999 is not a finite number{}"), ("0x10", None, "'0x10' is not a num"),
    ],
)  # fmt: skip
def test_numbers_in_cells(cell: str, value: float | None, message: str) -> None:
    """The other rows are right; an empty cell may mean something."""
    table = read_csv(of(f"a;b\n3;4\n5;{cell}\n6;7\n"))
    if value is not None:
        assert table.numbers("b").tolist() == table.numbers("b", empty=0.0).tolist()
        assert table.numbers("b").tolist() == [4.0, value, 7.0]
        return
    where = "t: line 3, column b: "
    assert told(lambda: table.numbers("b")).startswith(where + message.format(""))
    assert told(lambda: table.numbers("b")).endswith(KNOWN) is False
    for empty in (np.nan, 0.0, 9.0):
        if not cell:
            assert str(table.numbers("b", empty=empty).tolist()) == str([4.0, empty, 7.0])
        else:
            hint = told(lambda empty=empty: table.numbers("b", empty=empty))
            assert hint.startswith(where + message.format(KNOWN))
            assert hint.endswith("; decimals take a point" if "," in cell else KNOWN)


def test_standard_deviations_in_cells() -> None:
    table = read_csv(of("s\n0.5\n1e-300\n"))
    assert table.sigmas("s").tolist() == [0.5, 1e-300] and np.isnan(table.sigmas("t")).all()
    table = read_csv(of("s,t\n,1\n2,1\n"))
    assert np.isnan(table.sigmas("s")[0]) and table.sigmas("s")[1] == 2.0
    for wrong in ("0", "-0.25"):
        table = read_csv(of(f"s\n1\n{wrong}\n-7\n"))
        above = "is not a standard deviation, which is above 0"
        assert told(lambda table=table: table.sigmas("s")) == (
            f"t: line 3, column s: {wrong} {above}{KNOWN}"
        )
    assert told(lambda: table.numbers("S")) == "t: line 1: no column S; known are s"
    assert told(lambda: read_csv(of("speed,s\n")).column("sped")).endswith("did you mean speed?")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("2026-05-01T12:00:00", "2026-05-01T12:00:00 does not say its zone: add Z for UTC"),
        ("noon", "'noon' is not a date and time as 2026-05-01T11:58:42.25Z"),
        ("", "'' is not a date and time as 2026-05-01T11:58:42.25Z"),
        ("5", "'5' is not a date and time as 2026-05-01T11:58:42.25Z"),
    ],
)
def test_dates_in_cells(text: str, message: str) -> None:
    table = read_csv(of(f"a,t\n1,1970-01-01T00:00:10.25+00:00\n2,{text}\n"))
    assert told(lambda: table.times("t")) == f"t: line 3, column t: {message}"
    good = read_csv(of("t\n1970-01-01T00:00:10.25Z\n1970-01-01T02:00:01+02:00\n"))
    assert good.times("t").tolist() == [10.25, 1.0]


@pytest.mark.parametrize(
    ("cells", "found"),
    [
        (["0", "007", "12"], [0, 7, 12]), (["123456789012345"], [123456789012345]),
        (["1234567890123456"], "1234567890123456 is not the number of a frame, a whole number fr"),
        (["1", "12345678901234567890"], "12345678901234567890 is not the number of a frame, a w"),
        (["1", "1234567890123456"], "1234567890123456 is not the number of a frame, a whole"),
        (["a", "b 2", ""], ["a", "b 2", ""]), (["a", "7"], "'a' is not the number of a frame, and"),
        (["7", "a"], "'a' is not the number of a frame, and other rows have numbers"),
        (["7", ""], "'' is not the number of a frame, and other rows have numbers"),
        (["7", "1.0"], "1.0 is not the number of a frame, a whole number from 0"),
        (["-1", "a"], "-1 is not the number of a frame, a whole number from 0"),
        (["1", "²"], "'²' is not the number of a frame, and other rows have numbers"),
        (["1", "٣"], "٣ is not the number of a frame, a whole number from 0"),
        (["nan", "b"], "nan is not the number of a frame, a whole number from 0"),
        (["", "3", "x"], "'' is not the number of a frame, and other rows have numbers"),
    ],
)  # fmt: skip
def test_frames_in_cells(cells: list[str], found: Any) -> None:
    text = "\n".join(["frame,a", *(f"{cell},1" for cell in cells)])
    table = read_csv(of(text))
    if isinstance(found, str):
        said = told(lambda: frames_of_column(table))
        row = 2 + cells.index(found.partition(" is ")[0].strip("'"))
        assert said.startswith(f"t: line {row}, column frame: {found}")
    else:
        assert np.asarray(frames_of_column(table)).tolist() == found
