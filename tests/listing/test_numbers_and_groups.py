"""Numbers as text, one by one and many at once: by hand and by Python's own formatting."""

from __future__ import annotations

import numpy as np
import pytest

from vopd.listing.formats import LINES, Field, exponential, fixed, general, line_without_numbers
from vopd.listing.pages import code_type, padded_groups, page_template, signed_groups, widths

NUMBERS = [0, 1, 9, 10, 99, 100, 999, 1000, 9999, 10000, 99999, 100000, 12345678, 10**8 - 1, 10**8]


def text(groups: list[np.ndarray | None], digits: int) -> list[str]:
    """The groups of each number side by side."""
    count = max(len(group) for group in groups if group is not None)
    made = [""] * count
    for width, group in zip(widths(digits), groups, strict=True):
        assert group is None or group.dtype == code_type(width)
        for k in range(count):
            made[k] += " " * width if group is None else group[k].tobytes().decode()
    return made


@pytest.mark.parametrize("digits", range(1, 13))
def test_groups_of_digits(digits: int) -> None:
    """At most four to a group, the short one first."""
    groups = widths(digits)
    assert sum(groups) == digits and set(groups[1:]) <= {4} and 1 <= groups[0] <= 4
    some = np.array([n for n in NUMBERS if n < 10**digits])
    assert text([*padded_groups(some, digits)], digits) == [f"{n:0{digits}d}" for n in some]


@pytest.mark.parametrize("shows_zero", [True, False])
@pytest.mark.parametrize("columns", range(1, 11))
def test_groups_with_a_sign(columns: int, shows_zero: bool) -> None:
    """The minus stands before the first digit, in whatever group that is; or it is left out."""
    cases = [(n, minus) for n in NUMBERS for minus in (False, True)]
    cases = [(n, minus) for n, minus in cases if len(str(n)) + minus <= columns]
    for some in (cases, [one for one in cases if not one[1]], cases[:4], cases[-1:]):
        numbers = np.array([n for n, _ in some], np.int64)
        negative = np.array([minus for _, minus in some], bool)
        digits = [str(n) if n or shows_zero else "" for n, _ in some]
        wanted = [("-" * m + d).rjust(columns) for (_, m), d in zip(some, digits, strict=True)]
        assert text(signed_groups(numbers, negative, columns, shows_zero), columns) == wanted


def test_a_group_that_is_blank_in_every_number_is_none() -> None:
    groups = signed_groups(np.array([1, 9999]), np.zeros(2, bool), 12, True)
    assert [group is None for group in groups] == [True, True, False]
    groups = signed_groups(np.array([1, 9999]), np.array([False, True]), 12, True)
    assert [group is None for group in groups] == [True, False, False]


F = Field("X", "time", "F", 1, 8, 3)
I = Field("L-MARK", "landmark number", "I", 1, 5)  # noqa: E741  the letter of its descriptor
FIXED = [
    (0.5, F, "    .500"), (-0.5, F, "   -.500"), (10.5, F, "  10.500"), (100.25, F, " 100.250"),
    (-0.0, F, "   -.000"), (9999.9994, F, "9999.999"), (9999.9996, F, "********"),
    (-999.9994, F, "-999.999"), (-999.9996, F, "********"), (np.nan, F, "     NaN"),
    (np.inf, F, "Infinity"), (-np.inf, F, "    -Inf"), (7.0, I, "    7"), (7.9, I, "    7"),
    (-7.9, I, "   -7"), (99999.0, I, "99999"), (100000.0, I, "*****"), (-9999.0, I, "-9999"),
    (-10000.0, I, "*****"), (np.inf, I, "  Inf"), (-np.inf, I, " -Inf"), (np.nan, I, "  NaN"),
]  # fmt: skip


@pytest.mark.parametrize(("value", "field", "expected"), FIXED)
def test_a_number_in_a_field(value: float, field: Field, expected: str) -> None:
    assert fixed(value, field) == expected


def test_a_number_with_an_exponent() -> None:
    field = Field("RX(I)", "residual", "E", 1, 21, 8)
    assert exponential(7e-10, field) == "       7.00000000E-10"
    assert exponential(-0.0, field) == "      -0.00000000E+00"
    assert exponential(1.5e-300, field) == "      1.50000000E-300"


GENERAL = [  # G15.8: eight digits and four blanks, or an exponent; no zero before the point
    (0.0, "   .0000000    "), (-0.0, "  -.0000000    "), (1.0, "  1.0000000    "),
    (0.1, "  .10000000    "), (0.099, "  .99000000E-01"), (12345678.0, "  12345678.    "),
    (123456789.0, "  .12345679E+09"), (-0.5, " -.50000000    "), (1e10, "  .10000000E+11"),
    (1e98, "  .10000000E+99"), (1e99, "  .10000000+100"), (1e-100, "  .10000000E-99"),
    (1e-101, "  .10000000-100"), (np.inf, "       Infinity"), (-np.inf, "      -Infinity"),
    (0.05, "  .50000000E-01"), (100.5, "  100.50000    "), (-1e-9, " -.10000000E-08"),
]  # fmt: skip


@pytest.mark.parametrize(("value", "expected"), GENERAL)
def test_a_value_of_a_table(value: float, expected: str) -> None:
    assert general(value, 15, 8) == expected


def test_lines_without_numbers() -> None:
    """With the blank lines before them, and room for all fields."""
    assert line_without_numbers(LINES["end of job"]) == "\n\n\n END OF JOB\n"
    assert line_without_numbers(LINES["reading"]) == " " * 34 + "\n"
    ignored = "\n\n\n      FRAME    IGNORED BY USERS DIRECTION\n"
    assert line_without_numbers(LINES["frame ignored"]) == ignored


@pytest.mark.parametrize("pages", [1, 2, 15, 16, 17, 40])
@pytest.mark.parametrize("lines", [1, 3, 20])
def test_many_fields_at_once(pages: int, lines: int) -> None:
    """Few pages of many fields, or many of few: every number is as one alone, odd ones too."""
    kinds = ("film heading", *["film"] * lines, "standard deviation")
    rng = np.random.default_rng(pages * 100 + lines)
    values = np.round(rng.normal(0.0, 10.0, (pages, lines, 5)) ** 3, 6)
    numbers = [7, -9, 999, 1000, -99, -100]  # in three columns
    values[:, :, 0] = rng.choice(numbers, (pages, lines))
    odd = [0.0, -0.0, 0.5, -0.015625, 0.046875, 0.000005, 1e9, -1e8, 1e300, np.nan, np.inf, -np.inf]
    odd += [99999999.999994, -9999999.999996, 2147483.648, 4e15, 99999999.999996]
    chosen = rng.random((pages, lines, 4)) < 0.3
    values[:, :, 1:][chosen] = rng.choice(odd, int(chosen.sum()))
    last = rng.normal(0.0, 1.0, (pages, 1))
    heads = np.frombuffer(b"".join(b"HEAD%03d\n" % k for k in range(pages)), np.uint8)
    made = page_template(kinds).fill(
        np.concatenate([values.reshape(pages, -1), last], axis=1), heads.reshape(pages, -1)
    )
    fields = LINES["film"].fields
    for k, page in enumerate(made):
        wanted = [f"HEAD{k:03d}", LINES["film heading"].text]
        for row in values[k]:
            edited = [fixed(float(v), f) for v, f in zip(row, fields, strict=True)]
            wanted.append(" " + "".join(edited))
        deviation = fixed(float(last[k, 0]), LINES["standard deviation"].fields[0])
        wanted.append("0        STANDARD DEVIATION OF RESIDUALS" + deviation)
        assert page.decode() == "\n".join(wanted) + "\n"


LARGE = [21474.83647, 21474.83648, 21474.83649, 30000.0, 42949.67295, 42949.67296, 85899.34592]


@pytest.mark.parametrize("value", LARGE)
def test_numbers_about_the_largest_of_32_bits(value: float) -> None:
    """As F15.5 has them, in hundred thousandths; each alone, so that no larger one is beside it."""
    for number in (value, -value):
        (page,) = page_template(("film",)).fill(np.array([[65.0, number, 0.5, 0.5, 0.5]]))
        assert page.decode()[4:19] == f"{number:15.5f}"


def test_large_numbers_near_ties() -> None:
    """Their product with 10**5 is off by more than their distance from the tie."""
    rng = np.random.default_rng(5)
    middle = (rng.integers(10**11, 10**13, (50, 4)) + 0.5) / 1e5
    values = middle + rng.integers(-2, 3, middle.shape) * np.spacing(middle)
    made = page_template(("film",)).fill(np.column_stack([np.full(50, 65.0), values]))
    for page, row in zip(made, values.tolist(), strict=True):
        assert page.decode() == "  65" + "".join(f"{number:15.5f}" for number in row) + "\n"
