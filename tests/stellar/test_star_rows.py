"""The lines of a star file as cells: numbers of lines, separators, and what is no line of stars."""

from __future__ import annotations

import pytest

from vopd.findings import InputError
from vopd.stellar.files.read import read_rows


def rows(text: str) -> list[tuple[int, list[str]]]:
    return [(row.number, row.cells) for row in read_rows(text, "a.csv")]


SEPARATED = {
    "a,b\n1,2\n": [(1, ["a", "b"]), (2, ["1", "2"])],
    "a;b\n1,5;2\n": [(1, ["a", "b"]), (2, ["1,5", "2"])],
    "a\tb\n1\t\n": [(1, ["a", "b"]), (2, ["1", ""])],
    "a,b;c;d\n1;2;3\n": [(1, ["a,b", "c", "d"]), (2, ["1", "2", "3"])],
    "\ufeffa,b\n": [(1, ["a", "b"])],
    "\ufeff# first\r\na,b\r\n": [(2, ["a", "b"])],
    "# a comment, with; separators\n\n  # another\na,b\n , \n;\n1,2": [
        (4, ["a", "b"]), (6, [";"]), (7, ["1", "2"]),
    ],
    "a,b\r1,2\r": [(1, ["a", "b"]), (2, ["1", "2"])],
    'a,b\n"1,5","say ""x"""\n': [(1, ["a", "b"]), (2, ["1,5", 'say "x"'])],
    "\n \t\n# a, comment\na;b\n1;2\n": [(4, ["a", "b"]), (5, ["1", "2"])],
    "a,b;c\n1,2;3\n": [(1, ["a", "b;c"]), (2, ["1", "2;3"])],  # as many: the comma
    "a;b\tc\n1;2\t3\n": [(1, ["a", "b\tc"]), (2, ["1", "2\t3"])],
    "a;b\n1,2,3;4\n": [(1, ["a", "b"]), (2, ["1,2,3", "4"])],
    "a,b\n1\r2,3\r\n": [(1, ["a", "b"]), (2, ["1"]), (3, ["2", "3"])],
    "%a,b\n//1,2\n": [(1, ["%a", "b"]), (2, ["//1", "2"])],
    "": [],
    "\n# only\n": [],
}  # fmt: skip


@pytest.mark.parametrize("text", SEPARATED, ids=repr)
def test_cells_and_numbers_of_lines(text: str) -> None:
    """The separator is that of the header; lines are counted from 1, those left out too."""
    assert rows(text) == SEPARATED[text]


@pytest.mark.parametrize("before", [0, 1, 5])
def test_a_line_that_is_not_csv_is_named(before: int) -> None:
    with pytest.raises(InputError) as caught:
        rows("a,b\n" + "1,2\n" * before + '3,"4\n')
    assert str(caught.value).startswith(f"a.csv: line {before + 2}: not CSV: ")
