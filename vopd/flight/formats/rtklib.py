"""Solutions of RTKLIB (.pos), of its rnx2rtkp, RTKPOST and RTKNAVI, and of programs built on them.

The last line of its header that begins with % names the clock and the columns: latitude, longitude
and height, or Earth-centred x, y and z, with their standard deviations.
"""

from __future__ import annotations

import re

import numpy as np

from vopd.arrays import Floats
from vopd.files import reason
from vopd.findings import count_text, shown
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.track import POS_HEAD, WEEK_S, TrackRows
from vopd.geometry.earth import geodetic, local_axes
from vopd.inputs import GPS_ZERO_S, leap_second, plain_number, read_moment, whole_number

GEODETIC = "latitude(deg)", "longitude(deg)", "height(m)"
CENTRED = "x-ecef(m)", "y-ecef(m)", "z-ecef(m)"
SIGMAS = {
    GEODETIC: ("sde(m)", "sdn(m)", "sdu(m)"),
    CENTRED: ("sdx(m)", "sdy(m)", "sdz(m)", "sdxy(m)", "sdyz(m)", "sdzx(m)"),
}
"""By the columns of a position: east, north, up; or along the axes, and of their covariances the
roots, below 0 for a covariance below 0."""
NO_SOLUTION = 0
QUALITY = {1: "fixed", 2: "float", 3: "SBAS", 4: "DGPS", 5: "single", 6: "PPP"}
"""How a position was found, by its number in the column Q."""
OTHER_FORMAT = "write it again with positions as latitude, longitude and height in decimal degrees"


def read_pos(file: InputFile) -> TrackRows:
    """Read the positions of a .pos file by GPS time or UTC, with their standard deviations."""
    head = [*POS_HEAD.finditer(file.head)][-1]
    clock, columns = head[1].lower().replace("gpst", "gps"), re.split(r"[\s,;]+", head[2].strip())
    kind = next((one for one in SIGMAS if {*one} <= {*columns}), None)
    if kind is None or clock == "jst":
        what = "times in JST" if kind else f"positions as {', '.join(columns[:3])}"
        again = "write it again with times in GPST or UTC" if kind else OTHER_FORMAT
        raise file.error(f"{what} are not read: {again}")
    wanted = [*kind, *(one for one in SIGMAS[kind] if one in columns)]
    quality, lines, rows, found = columns.index("Q") if "Q" in columns else None, [], [], []
    for number, line in enumerate(file.text.splitlines(), 1):
        cells = re.split(r"[\s,;]+", line.strip())
        if cells == [""] or line.lstrip().startswith(("%", "#")):
            continue
        try:
            if len(cells) != 2 + len(columns):
                raise ValueError(f"{len(cells)} fields, and by the header {2 + len(columns)}")
            time_s, values = _time_s(*cells[:2]), dict(zip(columns, cells[2:], strict=True))
            own = [plain_number(values[one]) for one in wanted]
            state = 1 if quality is None else whole_number(cells[2 + quality])
            if not np.isfinite([time_s, *own]).all():
                raise ValueError("a number is not finite")
            if kind is GEODETIC and (abs(own[0]) > 90.0 or abs(own[1]) > 360.0):
                raise ValueError(f"{own[0]:g}, {own[1]:g} is no latitude and longitude")
        except ValueError as error:
            raise file.error(reason(error), number) from error
        if state != NO_SOLUTION:
            lines.append(number)
            rows.append([time_s, *own])
            found.append(QUALITY.get(state, f"Q = {state}"))
    if not rows:
        raise file.error("no position is in the file")
    table: Floats = np.array(rows)
    place, sigma = table[:, 1:4], table[:, 4:] if len(wanted) == 3 + len(SIGMAS[kind]) else None
    if kind is CENTRED:
        at = geodetic(place)
        sigma = None if sigma is None else _east_north_up(place, sigma)
        place = np.stack([at.latitude_deg, at.longitude_deg, at.height_m], axis=1)
    ellipsoidal = kind is CENTRED or bool(re.search(r"^%.*WGS84/ellipsoidal", file.head, re.M))
    said, above = f"RTKLIB, {count_text(len(rows), 'position')}", ", heights above the ellipsoid"
    if quality is not None:
        states = {one: found.count(one) for one in dict.fromkeys(found)}
        said += f" ({', '.join(f'{count} {one}' for one, count in states.items())})"
    return TrackRows(
        place[:, [1, 0, 2]],
        True,
        "EPSG:4326",
        clock,
        table[:, 0],
        f"{said}, {'GPS time' if clock == 'gps' else 'UTC'}{above * ellipsoidal}",
        line=lines,
        sigma_m=sigma if sigma is None else np.where(sigma > 0.0, sigma, np.nan),
        sigma_by="RTKLIB",
        height="ellipsoid" if ellipsoidal else None,
    )


def _time_s(first: str, second: str) -> float:
    """Read a date and a time of day, or a GPS week and its second, since 1970 on its clock."""
    if "/" not in first:
        return GPS_ZERO_S + whole_number(first) * WEEK_S + plain_number(second)
    text = f"{first.replace('/', '-')}T{second}Z"
    try:
        return read_moment(text).timestamp()
    except ValueError:
        raise ValueError(leap_second(text) or f"{shown(f'{first} {second}')} is no time") from None


def _east_north_up(position_m: Floats, root: Floats) -> Floats:
    """Turn the covariances of Earth-centred positions: standard deviations east, north, up, (T, 3).

    Args:
        position_m: (T, 3)
        root: of their covariances xx, yy, zz, xy, yz, zx, each with its sign, (T, 6)
    """
    whole = (root * np.abs(root))[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    axes = local_axes(position_m)
    variance = np.einsum("tij,tjk,tik->ti", axes, whole, axes)
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)))
