"""Usual mistakes: each corrected in turn, to name the one that would explain the residuals."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Generic, NamedTuple, TypeVar

Data = TypeVar("Data")


class Mistake(NamedTuple, Generic[Data]):
    """A mistake that users make: one row of a table of usual mistakes."""

    name: str  # the mistake in a few words
    # correct the data: yields them without the mistake, each time with the values that the advice
    # names; nothing for data that cannot have it
    change: Callable[..., Iterable[tuple[Data, tuple[object, ...]]]]
    advice: str  # what seems to be wrong and what to do about it, as `str.format` takes it


class Explanation(NamedTuple):
    """A mistake that would explain the residuals."""

    residual: float  # the residuals that remain without it; infinite if it explains nothing
    advice: str  # what seems to be wrong and what to do about it
    points: tuple[int, ...] = ()  # indices of the landmarks or stars it is about; empty for all
    name: str = ""  # of the mistake
    values: tuple[object, ...] = ()  # of the advice


def explanations(
    mistakes: Iterable[Mistake[Data]],
    residual: Callable[[Data], float],
    *given: object,
    points: Callable[[Data], tuple[int, ...]] = lambda _: (),
) -> list[Explanation]:
    """Measure the residuals of data with each usual mistake corrected.

    Args:
        mistakes: the table, the simplest mistake first
        residual: the residuals of corrected data; infinite if they are not to be believed
        given: the data as they are, for the changes of the table
        points: indices of the landmarks or stars that corrected data leave out
    """
    return [
        Explanation(
            residual(corrected), mistake.advice.format(*values), points(corrected), mistake.name,
            values,
        )
        for mistake in mistakes
        for corrected, values in mistake.change(*given)
    ]  # fmt: skip


def likeliest(
    found: Iterable[Explanation],
    alike: float,
    below: float = float("inf"),
    order: Callable[[Explanation], tuple[float, ...]] = lambda _: (),
) -> Explanation | None:
    """Choose among the explanations whose residuals are nearly as small as any.

    Args:
        found: the explanations, the simplest first
        alike: ratio of residuals up to which two explain the data alike
        below: limit of the least residuals, without which nothing is explained
        order: numbers by which those that are alike are sorted; by default the first is chosen
    """
    known = [one for one in found if one.residual < float("inf")]
    least = min((one.residual for one in known), default=float("inf"))
    if not least < below:
        return None
    return min((one for one in known if one.residual <= alike * least), key=order)
