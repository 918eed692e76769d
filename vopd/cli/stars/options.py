"""Options of `vopd stars solve` about methods and stars, and which of them exclude each other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from vopd.cli.stars.number_options import (
    camera_parameters,
    initial_angles,
    numbers,
    positive,
    star_pair,
)

METHODS = (
    "collinearity",
    "svd",
    "church",
    "church-weighted",
    "church-weighted-r",
    "two-star",
    "single-rotation",
    "all",
)

ONLY_FOR = {
    "initial": ("collinearity",),
    "weights": ("collinearity",),
    "corrections": ("collinearity",),
    "listing": ("collinearity",),
    "cross_products": ("two-star",),
    "rotation_angle": ("single-rotation",),
}
"""Options that do nothing with other methods than these."""

_OPTIONS = (
    click.option(
        "--method",
        type=click.Choice(METHODS),
        default="collinearity",
        show_default=True,
        help="How to solve; all: every method that can.",
    ),
    click.option(
        "--pair",
        metavar="I,J",
        callback=star_pair,
        help="Solve these two stars only, counted from 1.",
    ),
    click.option("--all-pairs", is_flag=True, help="Solve every pair, and compare the stars."),
    click.option("--reject", is_flag=True, help="Leave out stars that do not fit the others."),
    click.option(
        "--edit-by-pairs",
        is_flag=True,
        help="The same, beginning with the attitudes of all pairs (the report's recommendation 4).",
    ),
    click.option(
        "--magnitude-limit",
        metavar="MAG",
        callback=numbers(1),
        help="Weigh stars by column mag: at this magnitude the noise of a star's light is as large "
        "as all other reading errors.",
    ),
    click.option(
        "--weigh-elongation",
        is_flag=True,
        help="Weigh stars by column elongation, the length of an image over its width.",
    ),
    click.option(
        "--rotation",
        type=click.Choice(["nearest", "as-solved"]),
        default="nearest",
        show_default=True,
        help="Attitude of a matrix that is not quite a rotation: the nearest rotation, or the "
        "elements as solved, as the report's programs print them.",
    ),
    click.option(
        "--initial",
        metavar="svd|two-star|O,P,K",
        default="svd",
        show_default=True,
        callback=initial_angles,
        help="Where collinearity starts: from --method svd, from the widest pair as in the report, "
        "or from these omega, phi, kappa.",
    ),
    click.option(
        "--weights",
        type=click.Choice(["uniform", "listed", "robust"]),
        default="uniform",
        show_default=True,
        help="Weights of collinearity: listed follows RESWTS to the letter, robust is Huber's.",
    ),
    click.option(
        "--corrections",
        type=click.IntRange(1, 1000),
        metavar="N",
        help="Make exactly this many corrections of collinearity (STARS makes 4). "
        "Default: to convergence.",
    ),
    click.option(
        "--listing",
        is_flag=True,
        help="Print what program STARS prints: angles and residuals before each correction.",
    ),
    click.option(
        "--cross-products",
        type=click.Choice(["unit", "raw"]),
        default="unit",
        show_default=True,
        help="The fictitious star of two-star: as in eqs. 3.21, 3.22, or as listed.",
    ),
    click.option(
        "--rotation-angle",
        type=click.Choice(["farther", "mean"]),
        default="farther",
        show_default=True,
        help="The angle of single-rotation: of the star farther from the axis, or the mean of "
        "both.",
    ),
    click.option(
        "--reading-sigma",
        metavar="SIGMA",
        callback=positive,
        help="Standard deviation of an image coordinate, in the file's unit: for the stated "
        "uncertainty, the test of the residuals, robust weights and church-weighted. Default: from "
        "the residuals, and for their test from the interstar angles.",
    ),
    click.option(
        "--camera", metavar="X,Y,Z", callback=numbers(3), help="Camera position, for ground points."
    ),
    click.option(
        "--free",
        metavar="focal,centre,k1",
        callback=camera_parameters,
        help="Solve these with the attitude: principal distance, principal point, radial "
        "distortion.",
    ),
    click.option(
        "--resection",
        is_flag=True,
        help="Solve the camera's position too, from four ground points or more.",
    ),
)


def method_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options to a command, which is given them by their names."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def refuse_idle_options(ctx: click.Context, given: dict[str, Any], form: str) -> None:
    """Refuse options that exclude each other or would do nothing."""
    method, pairs = given["method"], given["pair"] or given["all_pairs"]
    if given["pair"] and given["all_pairs"]:
        raise click.UsageError("--pair and --all-pairs exclude each other.")
    if pairs and method.startswith("church"):
        raise click.UsageError(f"--method {method} takes three stars at least, not a pair.")
    if given["listing"] and (pairs or form != "text" or method == "all"):
        raise click.UsageError("--listing is for text output of collinearity with all stars.")
    if given["reject"] and given["edit_by_pairs"]:
        raise click.UsageError("--reject and --edit-by-pairs exclude each other.")
    for option in ("reject", "edit_by_pairs"):
        if pairs and given[option]:
            name = "--" + option.replace("_", "-")
            raise click.UsageError(f"{name} is for all stars at once, not for pairs.")
    if given["k1"] and "k1" in given["free"]:
        raise click.UsageError("--k1 and --free k1 exclude each other.")
    for one in ("resection", "free"):
        if given[one]:
            _refuse_with(f"--{one}", ctx)
    for name, methods in ONLY_FOR.items():
        source = ctx.get_parameter_source(name)
        if source == click.core.ParameterSource.COMMANDLINE and method not in (*methods, "all"):
            option = "--" + name.replace("_", "-")
            raise click.UsageError(f"{option} is for {' and '.join(methods)}, not {method}.")


ALONE = {
    "--resection": (*ONLY_FOR, "method", "pair", "all_pairs", "camera", "reject",
                    "edit_by_pairs", "rotation", "free"),
    "--free": (*ONLY_FOR, "method", "pair", "all_pairs", "rotation", "resection"),
}  # fmt: skip
"""Options that solve in a way of their own, and those that they have no use for."""


def _refuse_with(own: str, ctx: click.Context) -> None:
    """Refuse options that another one has no use for."""
    for name in ALONE[own]:
        if ctx.get_parameter_source(name) == click.core.ParameterSource.COMMANDLINE:
            option = "--" + name.replace("_", "-")
            raise click.UsageError(f"{own} and {option} exclude each other.")
