"""Options that say how the image coordinates of a star file are to be read."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from vopd.cli.stars.number_options import numbers, positive

if TYPE_CHECKING:
    from vopd.stellar.files.images import ImageAxes

_OPTIONS = (
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
    click.option("--y-down", is_flag=True, help="The file's y axis points down."),
)


def image_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options to a command, which is given them by their names."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def image_axes(given: dict[str, Any]) -> ImageAxes:
    """What the options say.

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
