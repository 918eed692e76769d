"""FTLUP against tables by hand and exact fractions (Appendix D), and where it stops a run."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.approved.texts import refused
from tests.kit.jobs import film, reread, without
from tests.tolerances import assert_close
from vopd.job import Job
from vopd.program import frames, positions
from vopd.program.ftlup import (
    TableNotANumber,
    TableOutOfOrder,
    Tables,
    ftlup,
    ftlup_each,
)
from vopd.program.vopd import run
from vopd.results import Outcome, Stage

TENT = (1.0, 2.0, 4.0), (10.0, 30.0, 20.0)
CUBIC = (0.0, 1.0, 2.0, 4.0, 5.0), (0.0, 1.0, 8.0, 64.0, 125.0)


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (1.5, 20.0),  # 10 + .5*20
        (3.0, 25.0),  # 30 + 1*(-5)
        (1.0, 10.0),
        (2.0, 30.0),
        (4.0, 20.0),
        (0.0, -10.0),  # first interval extended: 10 - 1*20
        (5.0, 15.0),  # last interval extended: 20 + 1*(-5)
    ],
)
def test_first_order(x: float, y: float) -> None:
    vari, vard = TENT
    assert ftlup(x, vari, vard) == y


def test_a_constant() -> None:
    assert ftlup(99.0, (3.0,), (7.0,)) == 7.0


@pytest.mark.parametrize(
    ("vari", "position"),
    [
        ((1.0, 2.0, 2.0, 1.0), 3),  # equal is out of order; the first such place counts
        ((3.0, 2.0, 1.0), 2),
        ((1.0, 2.0, 3.0, 2.5), 4),
    ],
)
def test_out_of_order(vari: tuple[float, ...], position: int) -> None:
    vard = np.arange(10.0, 10.0 + len(vari))
    with refused(TableOutOfOrder) as caught:
        ftlup(1.0, vari, vard)
    assert caught.value.position == position
    np.testing.assert_array_equal(caught.value.vari, vari)
    np.testing.assert_array_equal(caught.value.vard, vard)


def test_out_of_order_among_several_tables_shows_the_first() -> None:
    """VOPD looks X up before Y and Z, so X is what the message shows."""
    with pytest.raises(TableOutOfOrder) as caught:
        ftlup(0.0, (1.0, 0.0), [(5.0, 6.0), (7.0, 8.0)])
    np.testing.assert_array_equal(caught.value.vard, (5.0, 7.0))


@pytest.mark.parametrize("row", [0, 1, 2])
def test_a_nan_anywhere_is_an_error_that_names_it(row: int) -> None:
    name = (4, "altitudes")
    good, bad = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 3.0])
    bad[row] = np.nan
    for vari, vard in ((bad, good), (good, bad), (good, np.stack([good, bad], axis=1))):
        with refused(TableNotANumber):
            ftlup(1.0, vari, vard, name)


def test_a_table_without_a_name() -> None:
    with refused(TableNotANumber):
        ftlup(1.0, (1.0, np.nan), (0.0, 0.0))
    with refused(TableOutOfOrder):
        ftlup(1.0, (2.0, 1.0), (0.0, 0.0))


def test_the_order_of_operations_is_that_of_the_listing() -> None:
    """To the last bit: the product before the quotient (Appendix D)."""
    random = np.random.default_rng(4)
    x1, x2, y1, y2, x = random.uniform(-9.0, 9.0, (5, 200))
    x2 = x1 + np.abs(x2) + 0.1
    for a, b, c, d, at in np.stack([x1, x2, y1, y2, x]).T.tolist():
        assert float(ftlup(at, (a, b), (c, d))) == c + (at - a) * (d - c) / (b - a)
        tables = Tables.of(TABLE, [(np.array([a, b]), np.array([c, d]))])
        found = ftlup_each(np.array([at]), np.zeros(1, np.int64), tables)
        assert float(found[0]) == c + (at - a) * (d - c) / (b - a)


def test_out_of_order_names_its_table() -> None:
    name = (7, "times")
    with pytest.raises(TableOutOfOrder) as caught:
        ftlup(1.0, (2.0, 1.0), (0.0, 0.0), name)
    assert caught.value.table == name


def test_arrays_and_stacks_of_tables() -> None:
    x = np.array([[-1.0, 1.25, 3.0], [2.0, 3.5, 9.0]])
    vari, vard = CUBIC
    tables = np.stack([vard, np.negative(vard), np.square(vard)], axis=1)
    y = ftlup(x, vari, tables)
    assert y.shape == (2, 3, 3)
    for place in np.ndindex(x.shape):
        for k in range(3):
            assert y[(*place, k)] == ftlup(x[place], vari, tables[:, k])


def test_arguments_are_not_changed() -> None:
    x, vari, vard = np.array([1.5, 9.0]), np.array(TENT[0]), np.array(TENT[1])
    y = ftlup(x, vari, vard)
    y += 1.0  # nor is the result a part of them
    assert [x.tolist(), vari.tolist(), vard.tolist()] == [[1.5, 9.0], [*TENT[0]], [*TENT[1]]]


def exact(x: Fraction, points: list[tuple[Fraction, Fraction]]) -> Fraction:
    """Appendix D in fractions."""
    if len(points) == 1:
        return points[0][1]
    spans = [k for k, (a, b) in enumerate(pairwise(points)) if a[0] <= x < b[0]]
    k = spans[0] if spans else (0 if x < points[0][0] else len(points) - 2)
    (x1, y1), (x2, y2) = points[k : k + 2]
    return y1 + (x - x1) * (y2 - y1) / (x2 - x1)


@given(
    st.integers(-12, 52),
    st.dictionaries(st.integers(0, 20), st.integers(-50, 50), min_size=1, max_size=7),
)
def test_against_fractions(half_x: int, table: dict[int, int]) -> None:
    points = sorted(table.items())
    vari, vard = zip(*points, strict=True)
    x = Fraction(half_x, 2)
    wanted = exact(x, [(Fraction(a), Fraction(b)) for a, b in points])
    assert_close("extrapolated table value", ftlup(float(x), vari, vard), float(wanted))


TABLE = (7, "times")


def several_tables(columns: tuple[int, ...]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tables of one point to nine, each beginning below the end of the one before."""
    random = np.random.default_rng(5)
    lengths = 4, 1, 9, 2, 1
    return [
        (np.cumsum(random.uniform(0.1, 2.0, n)) - 3.0, random.normal(size=(n, *columns)))
        for n in lengths
    ]


@pytest.mark.parametrize("columns", [(), (3,)])
@pytest.mark.parametrize("more", [(), (2,)])
def test_several_tables_at_once_as_one_after_the_other(
    columns: tuple[int, ...], more: tuple[int, ...]
) -> None:
    """To the last bit, inside the tables, outside, at their points, and at NaN."""
    tables = several_tables(columns)
    x = np.random.default_rng(6).uniform(-5.0, 9.0, (30, *more))
    rows = [slice(0, 7), slice(7, 12), slice(12, 26), slice(26, 26), slice(26, 30)]
    x.reshape(30, -1)[[3, 14], 0] = tables[0][0][2], tables[2][0][8]
    x.reshape(30, -1)[[5, 9], 0] = np.nan
    which = np.repeat(np.arange(5), [some.stop - some.start for some in rows])
    found = ftlup_each(x, which, Tables.of(TABLE, tables))
    alone = [ftlup(x[some], *table) for some, table in zip(rows, tables, strict=True)]
    assert found.shape == (30, *more, *columns)
    assert found.tobytes() == np.concatenate(alone).tobytes()


def test_the_first_of_several_tables_that_is_not_right_is_named() -> None:
    tables, none = several_tables((2,)), np.zeros(0, np.int64)
    tables[2][0][3] = tables[2][0][2]
    with refused(TableOutOfOrder) as caught:
        ftlup_each(np.zeros(0), none, Tables.of(TABLE, tables))
    assert caught.value.table == TABLE
    np.testing.assert_array_equal(caught.value.vari, tables[2][0])
    np.testing.assert_array_equal(caught.value.vard, tables[2][1][:, 0])
    tables[1][0][0] = np.nan  # of a single point, before it
    with refused(TableNotANumber):
        ftlup_each(np.zeros(0), none, Tables.of(TABLE, tables))
    tables[1][0][0], tables[0][1][3, 1] = 1.0, np.nan
    with refused(TableNotANumber):
        ftlup_each(np.zeros(0), none, Tables.of(TABLE, tables))


# Errors of tables


NAME = (4, "altitudes")
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
    for columns, index in (((), ()), ((2,), (0,)), ((2,), (1,))):
        bad = tables(columns)
        bad[table][1][(point, *index)] = np.nan
        with refused(TableNotANumber):
            ftlup_each(np.zeros(5), WHICH, Tables.of(NAME, bad))
    bad = tables()
    bad[table][0][point] = np.nan
    with refused(TableNotANumber):
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
    with refused(TableNotANumber):
        ftlup_each(np.zeros(5), WHICH, Tables.of(NAME, both))
    with refused(TableNotANumber):
        ftlup(0.0, *both[2], NAME)
    both[0][0][2] = -9.0
    with refused(TableOutOfOrder):
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


# Stops


def reversed_table(job: Job, *names: str) -> Job:
    """The job with these tables in decreasing order."""
    path, wind, clock, camera = job.trajectory, job.wind, job.clock, job.camera
    new = {
        "clock": {"clock": replace(clock, frame=clock.frame[::-1])},
        "trajectory": {"trajectory": replace(path, time_s=path.time_s[::-1])},
        "lens": {"camera": replace(camera, lens_radius_mm=camera.lens_radius_mm[::-1])},
        "wind": {"wind": replace(wind, altitude_ft=wind.altitude_ft[::-1])},
    }
    for name in names:
        job = replace(job, **new[name])
    return job


@pytest.mark.parametrize(
    ("tables", "dropped", "at", "stage", "vard"),
    [
        # the time and trajectory tables are used before a frame is dropped
        (("clock",), (), 0, Stage.TIME, "clock"),
        (("trajectory",), (1,), 0, Stage.TIME, "trajectory"),
        (("clock", "trajectory", "lens", "wind"), (), 0, Stage.TIME, "clock"),
        # the lens table by the first frame that is not, in its first pass
        (("lens",), (), 0, Stage.LENS, "lens"),
        (("lens", "wind"), (1, 2), 2, Stage.LENS, "lens"),
        # the wind in pass 22
        (("wind",), (1,), 1, Stage.WIND, "wind"),
    ],
)
def test_a_table_out_of_order_stops_the_run(
    tables: tuple[str, ...], dropped: tuple[int, ...], at: int, stage: Stage, vard: str
) -> None:
    job = without(reversed_table(film(4), *tables), *dropped)
    stop = run(job).stop
    assert stop is not None
    assert (stop.frame_index, stop.stage, stop.position) == (at, stage, 2)
    named = {
        "clock": (6, "frame numbers"),
        "trajectory": (7, "times"),
        "lens": (1, "radial distances"),
        "wind": (4, "altitudes"),
    }
    assert (stop.group, stop.table) == named[vard]
    wanted = {
        "clock": (job.clock.frame, job.clock.time_s),
        "trajectory": (job.trajectory.time_s, job.trajectory.position_ft[:, 0]),
        "lens": (job.camera.lens_radius_mm, job.camera.lens_distortion_um),
        "wind": (job.wind.altitude_ft, job.wind.velocity_ft_s[:, 0]),
    }[vard]
    np.testing.assert_array_equal(stop.vari, wanted[0])
    np.testing.assert_array_equal(stop.vard, wanted[1])
    outcome = run(job).outcome.tolist()
    assert outcome == [Outcome.DROPPED] * at + [Outcome.STOPPED]


def test_a_table_that_is_not_used_goes_unnoticed() -> None:
    """Lens and wind, where all frames are dropped; the wind, where all residuals vanish."""
    idle = without(reversed_table(film(2), "lens", "wind"), 1, 2)
    assert run(idle).stop is None
    job = reversed_table(film(2), "wind")
    points = reread(job.readings, landmark_in=np.full_like(job.readings.landmark_in, 5.0),
                     fiducial_in=np.full_like(job.readings.fiducial_in, 5.0))  # fmt: skip
    camera = replace(job.camera, focal_length_mm=0.0)
    exact = run(replace(job, readings=points, camera=camera))
    assert exact.stop is None
    assert exact.outcome.tolist() == [Outcome.EXACT] * 2
