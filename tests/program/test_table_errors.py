"""What is said of a table that cannot be looked up in: which one it is, and at which point."""

from __future__ import annotations

import numpy as np
import pytest

from vopd.program import frames, positions
from vopd.program.ftlup import (
    TableName,
    TableNotANumber,
    TableOutOfOrder,
    Tables,
    ftlup,
    ftlup_each,
)

NAME = TableName(4, "altitudes")
WHICH = np.array([0, 0, 1, 2, 2])


def tables(columns: tuple[int, ...] = ()) -> list[tuple[np.ndarray, np.ndarray]]:
    """Three that are in order, of 3, 1 and 4 points; each begins below the end of the last."""
    made = []
    for size in (3, 1, 4):
        vard = np.arange(float(size * int(np.prod(columns)))).reshape(size, *columns)
        made.append((np.arange(float(size)) - 1.0, vard))
    return made


POINTS = [(0, 0), (0, 1), (0, 2), (1, 0), (2, 0), (2, 3)]


@pytest.mark.parametrize(("table", "point"), POINTS)
def test_a_nan_among_several_tables(table: int, point: int) -> None:
    """In the independent variable, or in any column of the dependent one alone."""
    wanted = rf"^the table of altitudes \(group 4\) holds NaN at position {point + 1}$"
    for columns, index in (((), ()), ((2,), (0,)), ((2,), (1,))):
        bad = tables(columns)
        bad[table][1][(point, *index)] = np.nan
        with pytest.raises(TableNotANumber, match=wanted):
            ftlup_each(np.zeros(5), WHICH, Tables.of(NAME, bad))
    bad = tables()
    bad[table][0][point] = np.nan
    with pytest.raises(TableNotANumber, match=wanted):
        ftlup_each(np.zeros(5), WHICH, Tables.of(NAME, bad))


@pytest.mark.parametrize(("table", "point"), [(0, 1), (0, 2), (2, 1), (2, 2), (2, 3)])
@pytest.mark.parametrize("below", [0.0, 0.5])
def test_a_point_that_is_not_beyond_the_one_before(table: int, point: int, below: float) -> None:
    """Equal, or below; the error has the table as it was given, and of two columns the first.

    So too where each table begins beyond the end of the last one.
    """
    for columns, apart in (((), 0.0), ((2,), 0.0), ((), 9.0)):
        bad = [(one + k * apart, other) for k, (one, other) in enumerate(tables(columns))]
        vari, vard = bad[table]
        vari[point] = vari[point - 1] - below
        with pytest.raises(TableOutOfOrder) as caught:
            ftlup_each(np.zeros(5), WHICH, Tables.of(NAME, bad))
        assert str(caught.value) == f"table out of order for FTLUP at position {point + 1}"
        assert (caught.value.position, caught.value.table) == (point + 1, NAME)
        assert caught.value.vari.tolist() == vari.tolist()
        first = vard if not columns else vard[:, 0]
        assert caught.value.vard.tolist() == first.tolist()


def test_a_nan_is_named_before_a_wrong_order_of_the_same_table_and_after_one_before() -> None:
    both = tables()
    both[2][0][1], both[2][1][3] = -9.0, np.nan
    with pytest.raises(TableNotANumber, match="position 4"):
        ftlup_each(np.zeros(5), WHICH, Tables.of(NAME, both))
    with pytest.raises(TableNotANumber, match="position 4"):
        ftlup(0.0, 1, *both[2], NAME)
    both[0][0][2] = -9.0
    with pytest.raises(TableOutOfOrder, match="position 3"):
        ftlup_each(np.zeros(5), WHICH, Tables.of(NAME, both))


def test_tables_side_by_side_need_no_order_among_them() -> None:
    """At -1, 9 and so on; the second table has one point, whatever is looked up."""
    x = np.array([-1.0, 9.0, 7.0, 0.5, 4.0])
    assert ftlup_each(x, WHICH, Tables.of(NAME, tables())).tolist() == [0.0, 10.0, 0.0, 1.5, 5.0]
    up = ftlup_each(x, WHICH, Tables.of(NAME, tables((2,))))
    assert up.tolist() == [[0.0, 1.0], [20.0, 21.0], [0.0, 1.0], [3.0, 4.0], [10.0, 11.0]]


def test_the_names_of_the_tables_of_a_deck() -> None:
    """The group of the cards, and the variable that the table is looked up by."""
    assert positions.FRAME_NUMBERS == (6, "frame numbers")
    assert positions.TRAJECTORY_TIMES == (7, "times")
    assert frames.WIND_ALTITUDES == (4, "altitudes")
    assert frames.LENS_RADII == (1, "radial distances")


def test_an_undefined_landmark_is_named_with_its_frame() -> None:
    error = positions.UndefinedLandmark(730, 12)
    assert str(error) == "frame 730: landmark 12 is not defined in group 9"
    assert (error.frame, error.landmark) == (730, 12)
