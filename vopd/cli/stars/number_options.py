"""Options that the commands of `vopd stars` share, and how their numbers are read."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

FORMATS = click.Choice(["text", "json", "csv"])

Callback = Callable[[click.Context, click.Parameter, Any], Any]


def numbers(count: int) -> Callback:
    """A callback that reads several numbers separated by commas; None without the option."""

    def convert(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
        from vopd.geometry.sexagesimal import parse_number

        if value is None or isinstance(value, tuple):
            return tuple(convert(ctx, param, one) for one in value) if value else value
        try:
            found = tuple(parse_number(part) for part in value.split(","))
        except ValueError as error:
            raise click.BadParameter(f"{value!r} is not {param.metavar}: {error}.") from None
        if len(found) != count or max(map(abs, found)) > 1e12:
            raise click.BadParameter(f"{value!r} is not {param.metavar}, numbers up to 1e12.")
        return found

    return convert


def positive(ctx: click.Context, param: click.Parameter, value: Any) -> float | None:
    """A callback that reads one number above 0."""
    found = numbers(1)(ctx, param, value)
    if found and found[0] <= 0.0:
        raise click.BadParameter("must be more than 0.")
    return found and float(found[0])


def initial_angles(ctx: click.Context, param: click.Parameter, value: str) -> Any:
    """A callback that reads the start of a solve: the name of a method, or three angles."""
    return value if value in ("svd", "two-star") else numbers(3)(ctx, param, value)


def camera_parameters(ctx: click.Context, param: click.Parameter, value: Any) -> tuple[str, ...]:
    """A callback that reads names of what is solved of the camera."""
    names = tuple(name.strip() for name in value.split(",")) if value else ()
    for name in names:
        if name not in ("focal", "centre", "k1"):
            raise click.BadParameter(f"{name!r} is not one of focal, centre, k1.")
    return names


def star_pair(ctx: click.Context, param: click.Parameter, value: Any) -> tuple[int, int] | None:
    """A callback that reads the numbers of two different stars, counted from 1."""
    found = numbers(2)(ctx, param, value)
    if found is None:
        return None
    first, second = map(int, found)
    if (first, second) != found or min(found) < 1:
        raise click.BadParameter(f"{value!r} does not name two stars, counted from 1.")
    if first == second:
        raise click.BadParameter("names the same star twice.")
    return first, second
