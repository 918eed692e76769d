"""The table of usual mistakes: what is left without each, and which is chosen."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from vopd.mistakes import Explanation, Mistake, explanations, likeliest

INF = float("inf")


def test_each_mistake_is_corrected_as_often_as_the_data_may_have_it() -> None:
    def shifted(number: float, unit: str) -> Iterator[tuple[float, tuple[object, ...]]]:
        yield number - 1.0, (1, unit)
        yield number + 1.0, (-1, unit)

    table = [
        Mistake("a shift", shifted, "with {:+d} {}: shifted?"),
        Mistake("none", lambda *_: [], "never"),
        Mistake("a sign", lambda number, _: [(-number, ())], "is its sign right?"),
    ]
    assert explanations(table, lambda number: number**2, 3.0, "m") == [
        (4.0, "with +1 m: shifted?", (), "a shift", (1, "m")),
        (16.0, "with -1 m: shifted?", (), "a shift", (-1, "m")),
        (9.0, "is its sign right?", (), "a sign", ()),
    ]


@pytest.mark.parametrize(
    ("residuals", "best"),
    [
        ([1.29, 1.0], 0), ([1.3, 1.0], 0), ([1.31, 1.0], 1), ([1.0, 0.9], 0),
        ([9.0, 1.0, 0.99], 1), ([INF, 2.0], 1), ([INF, INF], None), ([], None),
    ],
)  # fmt: skip
def test_the_first_of_those_that_explain_alike_is_chosen(
    residuals: list[float], best: int | None
) -> None:
    found = [Explanation(one, str(k)) for k, one in enumerate(residuals)]
    assert likeliest(found, 1.3) == (None if best is None else found[best])


@pytest.mark.parametrize(("below", "chosen"), [(1.0, False), (1.01, True), (0.99, False)])
def test_the_least_residuals_are_below_a_limit(below: float, chosen: bool) -> None:
    """The one that is chosen may be above it."""
    found = [Explanation(1.2, "first"), Explanation(1.0, "second")]
    assert likeliest(found, 1.3, below) == (found[0] if chosen else None)


def test_of_those_that_explain_alike_an_order_may_decide() -> None:
    """About all points before some, then the least; of equal ones the first."""
    found = [
        Explanation(1.0, "of two", (3, 4)), Explanation(2.5, "a"), Explanation(2.0, "b"),
        Explanation(2.0, "c"), Explanation(0.5, "of one", (1,)), Explanation(4.0, "far"),
    ]  # fmt: skip
    order = {"order": lambda one: (bool(one.points), one.residual)}
    assert likeliest(found, 6.0, **order) == found[2]
    assert likeliest(found, 3.0, **order) == found[4]
