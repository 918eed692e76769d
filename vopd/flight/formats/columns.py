"""Names of columns: those of other programs, units in them, and those that a project maps."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from vopd.files import TAKES_STARS
from vopd.findings import did_you_mean
from vopd.flight.formats.files import InputFile
from vopd.inputs import LATE_S, plain_number

TIME = "t_s", "t_utc", "t_unix_s", "t_unix_ms"
SYNONYMS = {
    name: (name, *others.split())
    for name, others in {
        "frame": "frame_number frame_no frame_id frame_index",
        "image": "image_name filename file_name file photo picture img",
        "landmark": "name label point point_name landmark_name marker target gcp gcp_name site "
        "station id point_id",
        "u_px": "u x px x_px pixel_x image_x image_u im_x col column",
        "v_px": "v y py y_px pixel_y image_y image_v im_y row",
        "lat_deg": "lat latitude",
        "lon_deg": "lon lng long longitude",
        "h_m": "h alt altitude height elevation elev ele gps_alt gps_altitude gps_alt_m agl "
        "ellh hae hmsl",
        "x_m": "x east easting e",
        "y_m": "y north northing n",
        "z_m": "z up height elevation elev ele alt altitude h agl ellh hae hmsl",
        "from_deg": "direction wind_direction wind_dir dir wdir direction_deg wind_direction_deg",
        "speed_m_s": "speed_ms wind_speed_m_s wind_speed_ms",
        "speed_kt": "speed_knots speed_kts speed_kn wind_speed_kt wind_speed_knots wind_speed_kn",
    }.items()
}
"""Names that columns have in other programs' tables, lower case, with _ for all that is no letter.

Of several that are there the first is taken, and of heights none.
"""
TIMES = (
    "time", "timestamp", "t", "utc", "datetime", "date_time", "utctime", "time_stamp", "time_s",
    "t_sec", "seconds", "sec", "elapsed", "elapsed_s", "unix", "unix_time", "unixtime",
    "unix_s", "posix_time",
    "t_ms", "time_ms", "timestamp_ms", "elapsed_ms", "unix_ms", "milliseconds", "ms",
)  # fmt: skip
"""Other names of a time: dates are `t_utc`, numbers `t_s`, or seconds since 1970."""
DATES = ("date", "gps_date", "utc_date", "date_utc", "day")
"""Names of a column of dates beside one of times of day."""
CLOCK = re.compile(r"(^|_)(utc|gps|gnss)(?=_|$)")
"""Words of the name of a column of times that name its clock."""
MILLISECONDS = re.compile(r"(^|_)(ms|msec|milliseconds)$")
"""Ends of names of columns of times in thousandths of a second."""
IN_FEET = re.compile(r"(^|_)(ft|feet)(?=_|$)")
IN_METRES = re.compile(r"(^|_)(m|meters?|metres?)(?=_|$)")
BESIDE = re.compile(r"(^|_)(gps|gnss|utm|wgs84|deg|degrees?|dd|decimal)(?=_|$)")
"""Words of the name of a coordinate that leave it the same: its receiver, system or unit."""
OF_ANGLE = re.compile(r"(^|_)(deg|degrees?)(_|$)")
_GROUND, _ELLIPSOID, _SEA = "rel|relative|agl", "ell|ellipsoid(al)?|hae", "asl|a?msl|orthometric"
LEVEL = re.compile(
    rf"(^|_)(baro|{_GROUND}|{_SEA}|{_ELLIPSOID}"
    r"|above(_[a-z]+){0,9}?(?=_(m|ft|feet)$|$))(?=_|$)"
)
"""Words of the name of a height alone: what it is counted from, which the project says."""
FROM_GROUND = re.compile(
    rf"(^|_)({_GROUND}|above_([a-z]+_)?(ground|take_?off|home|launch|pad))(?=_|$)"
)
FROM_ELLIPSOID = re.compile(rf"(^|_)({_ELLIPSOID}|ellh)(?=_|$)")
FROM_SEA = re.compile(rf"(^|_)({_SEA}|ha?msl|geoid|sea_?level)(?=_|$)")
"""Words of the name of a height that say its level: the ground or the place of the take-off, the
ellipsoid, or the sea."""
PLANE, GEODETIC = ("x_m", "y_m", "z_m"), ("lat_deg", "lon_deg", "h_m")
COORDINATES = (*PLANE, *GEODETIC)
DEGREES = ("lat_deg", "lon_deg")
HEIGHTS = ("h_m", "z_m")
HEIGHTS_FT = {"h_ft": "h_m", "z_ft": "z_m"}  # as a project may map them
FEET = HEIGHTS_FT | {"x_ft": "x_m", "y_ft": "y_m"}
ENOUGH = ((("frame", "image"), ("frame", "image")), (TIME, (*TIME, "image")))
"""Columns, and those that are not looked for under other names where one of the first is there."""


OTHER_UNITS = {
    "m": {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3},
    "s": {"us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "days": 86_400.0},
    "deg": {"rad": 180.0 / math.pi, "e7": 1e-7, "gon": 0.9},
    "m_s": {
        "cm_s": 1e-2, "mm_s": 1e-3, "ft_s": 0.3048, "fps": 0.3048, "mph": 0.44704,
        **dict.fromkeys(("km_h", "kmh", "kph"), 1.0 / 3.6),
        **dict.fromkeys(("kt", "kts", "kn", "knots"), 1852.0 / 3600.0),
    },
}  # fmt: skip
"""By the unit of a column, others that its name may end in, and what to multiply them by."""


def other_unit(own: str, name: str) -> str:
    """Say which unit a column seems to have in the place of that of `name`; empty for no other."""
    plain = plain_name(own).replace("timeus", "time_us")
    wanted = "deg" if name.endswith("_deg") else "m" * (name in COORDINATES)
    wanted = "s" if name == TIME[0] else "m_s" if name.endswith("_m_s") else wanted
    known = SYNONYMS.get(name, (name.removesuffix("_deg").removesuffix("_m_s"),))
    names = TIMES if wanted == "s" else known
    others = OTHER_UNITS.get(wanted, {}).items()
    found = [(unit, factor) for unit, factor in others for one in names if plain == f"{one}_{unit}"]
    if not found:
        return ""
    unit, factor = found[0]
    said = "1e-7 degree" if unit == "e7" else unit
    return f"{own} is in {said}: multiply by {factor:.12g} and call it {name}"


UPWARD = re.compile(
    r"((v|vel|velocity|speed)_?(u|up)|up_(speed|velocity)|climb(_rate)?)(_m_?s|_mps)?$"
)
"""Names of a velocity that is positive upward."""


TOWARD = re.compile(
    r"(wind_)?((dir_|direction_|blows_|blowing_)?to|towards?)(_(dir|direction|deg))*$"
)
"""Names of the direction that a wind blows to."""


MAGNETIC = re.compile(r"(^|_)mag(netic)?(_|$)")
REVERSED = {
    "lat_deg": (re.compile(r"(^|_)(s|south)(_|$)"), "south: write latitudes in the south below 0"),
    "lon_deg": (re.compile(r"(^|_)(w|west)(_|$)"), "west: write longitudes in the west below 0"),
    **dict.fromkeys(
        HEIGHTS, (re.compile(r"(^|_)(down|depth)(_|$)"), "ground: change its sign")
    ),
}  # fmt: skip
"""Words in the name of a coordinate that counts the other way, and what to do."""


def other_sense(own: str, name: str) -> str:
    """Say that a column seems to count the other way than `name` does; or nothing."""
    plain = plain_name(own)
    if name in REVERSED and REVERSED[name][0].search(plain):
        return f"{own} seems to count to the {REVERSED[name][1]} and call it {name}"
    if name in ("yaw_deg", "from_deg") and MAGNETIC.search(plain):
        return f"{own} seems to be from magnetic north: add its declination and call it {name}"
    if name == "vd_m_s" and UPWARD.match(plain):
        return f"{own} seems to count up; change its sign and call it {name}"
    if name == "from_deg" and TOWARD.match(plain):
        turned = "add 180 degrees, or take them off from 180 on, and call it"
        return f"{own} seems to be where the wind blows to; {turned} {name}"
    return ""


def coordinate_columns(geodetic: bool) -> tuple[str, str, str]:
    """Name the columns of a position, east before north."""
    return ("lon_deg", "lat_deg", "h_m") if geodetic else PLANE


def plain_name(text: str) -> str:
    """Write the name of a column in lower case, with _ for all that is no letter or digit."""
    return re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")


def _bare_name(name: str, plain: str, feet: bool = False) -> str:
    """Take the words off the plain name of a column that leave a coordinate or time the same.

    Args:
        name: what the column may be here
        plain: its plain name
        feet: whether x and y may be in feet
    """
    if name == TIME[0]:
        return CLOCK.sub("", plain).strip("_") or plain
    others = (IN_FEET, LEVEL) if name in HEIGHTS else (IN_FEET,) * (feet and name in PLANE)
    if name in HEIGHTS and OF_ANGLE.search(plain):
        return plain
    for words in (BESIDE, IN_METRES, *others):
        plain = words.sub("", plain).strip("_") or plain
    return plain


def own_names(
    file: InputFile, header: list[str], known: Sequence[str], first: Sequence[str] = ()
) -> list[str]:
    """Name the columns of a table as they are called here; others keep their names.

    Args:
        file: the table, with what the project says of its columns
        header: the names in it
        known: the names that its columns may have here
        first: the cells of the first row, which tell dates from numbers

    Raises:
        VopdError: where the project maps a column that is not there, or two may be the height
    """
    if not known:
        return header
    if isinstance(file.columns, list):
        named = {*known} - {*header}
        return [FEET[one] if FEET.get(one) in named else one for one in header]
    place = dict[int, str]()
    for given, own in (file.columns or {}).items():
        name = FEET.get(given, given)
        if name not in known:
            raise file.error(f"columns: {given} is none of this table{did_you_mean(given, known)}")
        if own not in header:
            raise file.error(f"columns: there is no column {own}{did_you_mean(own, header)}")
        if wrong := other_unit(own, name) or other_sense(own, name):
            raise file.error(f"columns: {wrong}")
        place[header.index(own)] = name
    # a column that has such a name itself, beside the one that is mapped to it, is another
    found = [place.get(k, "" if one in place.values() else one) for k, one in enumerate(header)]
    plain = [plain_name(name) for name in found]
    feet = "x_m" in known and any(map(IN_FEET.search, plain)) and _grid_in_feet(file)
    left_out = {name for some, rest in ENOUGH if {*some} & {*found} for name in rest}
    latitudes = {*SYNONYMS["lat_deg"]}
    if "lat_deg" in known and "x_m" in known:
        x = "x_m" in found or not {_bare_name("lat_deg", one) for one in plain} & latitudes
        left_out |= {*GEODETIC} if x else {*PLANE}
    for name in known:
        if name in found or name in left_out:
            continue
        others = TIMES if name == TIME[0] else SYNONYMS.get(name, (name,))
        there = [plain.index(one) for one in others if one in plain]
        if name in HEIGHTS or (name in (TIME[0], *COORDINATES) and not there):
            there = [k for k, one in enumerate(plain) if _bare_name(name, one, feet) in others]
        there = [k for k in there if found[k] not in known]
        if len(there) > 1 and name in HEIGHTS:
            message = f"{header[there[0]]} or {header[there[1]]} is the height: say which"
            raise file.error(f"{message}, {mapped(name, header[there[0]])}", 1)
        for k in there[:1]:
            cell = first[k] if k < len(first) else ""
            found[k] = _time_name(cell, plain[k]) if name == TIME[0] else name
    return found


def _grid_in_feet(file: InputFile) -> bool:
    """Tell whether the grid of a table, as the project states it, counts in feet."""
    from vopd.flight.coordinates import units_of_crs  # of few tables

    return any(one.is_foot for one in units_of_crs(file.crs, file.name)[0])


def _time_name(cell: str, own: str) -> str:
    """Name a column of times by its first cell, and by its own name if that says milliseconds."""
    try:
        value = plain_number(cell)
    except ValueError:
        return "t_utc"
    if value >= 1e3 * LATE_S:
        return "t_unix_ms"
    return "t_s" if value < LATE_S or MILLISECONDS.search(own) else "t_unix_s"


OF_STARS = f"; if these are stars, {TAKES_STARS} takes them"


def mapped(name: str, own: str) -> str:
    """Write the line of a project that maps a column."""
    return f'columns = {{ {name} = "{own}" }}'
