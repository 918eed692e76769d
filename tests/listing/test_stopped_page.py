"""A table out of order: how far the page goes, and what FTLUP prints (Appendix D)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fortranformat import FortranRecordWriter
from hypothesis import given
from hypothesis import strategies as st

from tests.kit.jobs import film, without
from tests.kit.page_by_fortranformat import no_leading_zeros
from vopd.job import Clock, Job, Wind
from vopd.listing.pages import end_of_case, listing_text, pages_of_jobs
from vopd.program.vopd import run

MESSAGE = (
    "1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION     2\n TABLE IS STORED IN LOCATION 000000\n\n"
)
WIND = Wind(np.array([3.0, 2.0]), np.array([[-0.25, 9.0], [1e6, 9.0]]))
WIND_TABLE = (
    "   3.0000000      2.0000000    \n"  # one blank, then 15 columns each
    "  -.25000000      1000000.0    \n"
)


def test_in_the_time_table() -> None:
    """Before group 1: no page at all, not even the title."""
    job = replace(film(1), clock=Clock(np.array([2, 1]), np.array([0.0, 12.5])))
    table = (
        "   2.0000000      1.0000000    \n"  # one blank, then 15 columns each
        "    .0000000      12.500000    \n"
    )
    assert listing_text(run(job)) == MESSAGE + table


def whole_page(job: Job) -> list[str]:
    return listing_text(run(job)).split("\n")


def up_to(page: list[str], heading: str) -> str:
    """The page's lines before that heading."""
    return "\n".join(page[: next(k for k, line in enumerate(page) if heading in line)]) + "\n"


def test_in_the_lens_table() -> None:
    """After group 3, in the first pass of the first frame that is not dropped."""
    job = without(film(2), 1)
    lens = replace(job.camera, lens_radius_mm=job.camera.lens_radius_mm[::-1])
    text = listing_text(run(replace(job, camera=lens)))
    first = "\n\n\n      FRAME   1IGNORED BY USERS DIRECTION\n"
    assert text.startswith(first)
    page, table = text.removeprefix(first).split(MESSAGE)
    wanted = up_to(whole_page(job)[4:], "0L-MARK        X")
    assert page == wanted
    assert [len(line) for line in table.split("\n")] == [121, 121, 121, 16] * 2 + [0]


def test_in_the_wind_table() -> None:
    """After group 4, in pass 22; the title is not printed again."""
    text = listing_text(run(replace(film(1), wind=WIND)))
    page, table = text.split(MESSAGE)
    assert page == up_to(whole_page(film(1)), "0 FRAME   TIME")
    assert table == WIND_TABLE


@pytest.mark.parametrize(
    ("value", "field"),
    [
        # eight digits and four blanks from .1 to 1E8, otherwise an exponent
        (65.0, "  65.000000    "),
        (0.1, "  .10000000    "),
        (-0.12345678, " -.12345678    "),
        (12345678.0, "  12345678.    "),
        (99999999.4, "  99999999.    "),
        (99999999.6, "  .10000000E+09"),  # rounds up to nine digits before the point
        (9999999.96, "  10000000.    "),
        (0.09999999999, "  .10000000    "),  # rounds up to .1
        (0.0999, "  .99900000E-01"),
        (-123456789.0, " -.12345679E+09"),
        (1e99, "  .10000000+100"),  # the letter makes room
        (-1e-101, " -.10000000-100"),
        (0.0, "   .0000000    "),
        (np.inf, "       Infinity"),
    ],
)
def test_a_table_value_by_hand(value: float, field: str) -> None:
    """G15.8; the first value of VARD stands in columns 2 to 16 of the last line."""
    wind = replace(WIND, velocity_ft_s=np.array([[value, 0.0], [1.0, 0.0]]))
    text = listing_text(run(replace(film(1), wind=wind)))
    assert text.split("\n")[-2] == " " + field + "  1.0000000    "


@given(st.lists(st.floats(-1e12, 1e12), min_size=2, max_size=20))
def test_tables_by_fortranformat(values: list[float]) -> None:
    """Format 8G15.8, but for a lost carry (`1000000 .`), zero and ties."""
    wind = Wind(np.full(len(values), 7.0), np.array(values)[:, None] * [1.0, 0.0])
    table = listing_text(run(replace(film(1), wind=wind))).split(MESSAGE)[1]
    writer = FortranRecordWriter("(1X,8G15.8)")
    rows = [values[k : k + 8] for k in range(0, len(values), 8)]
    wanted = [no_leading_zeros(writer.write(row)) for row in rows]
    got = table.split("\n")[len(rows) : -1]
    for ours, theirs, row in zip(got, wanted, rows, strict=True):
        for k, value in enumerate(row):
            digits = f"{abs(value):.30e}".split("e")[0].replace(".", "")
            tie = digits[8:].rstrip("0") == "5"
            field = theirs[1 + 15 * k : 16 + 15 * k]
            if value and not tie and " ." not in field.strip():
                assert ours[1 + 15 * k : 16 + 15 * k] == field


@pytest.mark.parametrize("stopped", [(), (0,), (1,), (2,), (0, 1, 2)])
def test_a_run_of_several_jobs_ends_where_its_last_job_stops(stopped: tuple[int, ...]) -> None:
    """The lines that end a run are printed unless a table stopped the last of its jobs."""
    jobs = [replace(film(1), title=f"1 JOB {k}".ljust(80)) for k in range(3)]
    results = [run(replace(job, wind=WIND) if k in stopped else job) for k, job in enumerate(jobs)]
    alone = [listing_text(one) for one in results]
    end = "" if 2 in stopped else end_of_case().decode()
    assert listing_text(results) == "".join(alone) + end
    assert [one.endswith(WIND_TABLE) for one in alone] == [k in stopped for k in range(3)]
    together = [b"".join(pages).decode() for pages in pages_of_jobs(results)]
    assert together == alone


def test_a_run_without_jobs() -> None:
    assert listing_text([]) == end_of_case().decode()
