"""The text of a project file with all keys, what each is for, and what is still to be said."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import NamedTuple

from vopd.flight.coordinates import HEIGHTS

WIDTH = 44  # columns before a comment
OPTIONAL = ("vehicle", "wind", "atmosphere", "solve", "uncertainty")
"""Sections that stand in the file as comments where nothing is said of them."""


LANDMARK_SIGMAS = "0.05 by survey, 1 to 5 from a map"
TRACK_SIGMAS = "3 for a usual receiver, 0.02 for RTK"


class KeyText(NamedTuple):
    """A key as it stands in a new project: an example of its value, and a comment."""

    section: str
    key: str
    example: str
    comment: str


_DATUM = f"heights are above: {', '.join(HEIGHTS)}; or {{ undulation_m = -37.9 }}"
_SIGMA = "metres, or [east, north, up]: "
_CRS = "coordinate reference system of x and y"
_GRID = "centre: (0, 0) is the first pixel's centre; corner; one-based"

KEY_TEXTS = tuple(
    KeyText(*row)
    for row in (
        ("flight", "name", '"my flight"', "a title"),
        ("flight", "epoch", "2026-05-01T11:58:42Z", "the moment of t = 0"),
        ("camera", "lens", '"lens.yml"', 'or a table: { model = "brown", fx_px = 1500.0 }'),
        ("camera", "model", '"brown"', "brown or fisheye, where 4 coefficients do not say"),
        ("camera", "camera", '"1"', "which camera, where the file has several"),
        ("camera", "image_size_px", "[1920, 1080]", "width and height of the images"),
        ("camera", "pixel_grid", '"centre"', f"of cx_px, cy_px; {_GRID}"),
        ("picks", "file", '"picks.csv"', "columns frame,landmark,u_px,v_px, or another format"),
        ("picks", "pixel_grid", '"centre"', _GRID),
        ("picks", "v", '"down"', "down or up"),
        ("picks", "sigma_px", "1.0", "standard deviation of a pick"),
        ("picks", "frame_rate_hz", "25.0", "frames a second, for numbered frames"),
        ("picks", "first_frame_t_s", "0.0", "time of frame 0, seconds after the epoch"),
        ("picks", "times", '"times.csv"', "instead: frame or image, t_s or t_utc; or the images"),
        ("picks", "utc_offset_h", "2.0", "hours: clock of the images in `times` less UTC"),
        ("landmarks", "file", '"landmarks.csv"', "landmark,lat_deg,lon_deg,h_m, or another format"),
        ("landmarks", "crs", '"EPSG:32633"', _CRS),
        ("landmarks", "height", '"ellipsoid"', _DATUM),
        ("landmarks", "sigma_m", "0.1", f"{_SIGMA}{LANDMARK_SIGMAS}"),
        ("track", "file", '"track.csv"', "t_utc,lat_deg,lon_deg,h_m, or another format"),
        ("track", "crs", '"EPSG:32633"', _CRS),
        ("track", "height", '"ellipsoid"', _DATUM),
        ("track", "clock", '"utc"', "utc, or gps, which is 18 s ahead"),
        ("track", "offset_s", "0.0", "added to the track's times"),
        ("track", "sigma_m", "3.0", f"{_SIGMA}{TRACK_SIGMAS}"),
        ("track", "sigma_t_s", "0.02", "of a frame's time against the track"),
        ("track", "lever_arm_m", "[0.0, 0.0, 0.0]", "antenna to camera: forward, right, down"),
        ("track", "interpolate", '"linear"', "linear or cubic"),
        ("position", "lat_deg", "48.0", "or x_m, y_m, z_m with crs"),
        ("position", "lon_deg", "15.0", "positive east"),
        ("position", "h_m", "300.0", "height"),
        ("position", "height", '"ellipsoid"', _DATUM),
        ("position", "sigma_m", "0.1", f"{_SIGMA}{LANDMARK_SIGMAS}"),
        ("vehicle", "mount", '"forward"', "forward, down, { ypr_deg = [..] } or { matrix = [..] }"),
        ("wind", "file", '"wind.csv"', "h_m,from_deg,speed_m_s; without it against the ground"),
        ("atmosphere", "refraction", '"standard"', "standard, off or { k = 0.13 }"),
        ("solve", "loss", '"least-squares"', "least-squares, huber or cauchy"),
        ("solve", "blunders", '"name"', "name (tell and keep) or drop"),
        ("solve", "check_landmarks", "[]", "landmarks that are not used"),
        ("solve", "frames", '"each"', "each, or one for a camera that does not move"),
        ("uncertainty", "focal_rel", "0.001", "of the focal length, as a part of it"),
        ("uncertainty", "principal_px", "[1.0, 1.0]", "of the principal point"),
    )
)
"""Every key of a new project in its order."""

KeyValues = dict[tuple[str, str], str]
"""TOML texts of values by section and key."""


def toml_text(text: str) -> str:
    """A text in quotes, as TOML has it."""
    return json.dumps(text, ensure_ascii=False)


def toml_numbers(*numbers: float) -> str:
    """A list of numbers, as TOML has it."""
    return "[" + ", ".join(f"{number:.12g}" for number in numbers) + "]"


def project_text(values: KeyValues, needed: Mapping[tuple[str, str], str], head: str) -> str:
    """The text of a project file.

    Keys without a value stand as comments with an example. Sections that stand
    for others, and have no value, are left out: `[track]` beside `[position]`. Where
    neither is known both are there, `[position]` as a comment, which needs what `[track]` does.

    Args:
        values: the values that are known
        needed: keys that the user must give, and why; they are marked
        head: sentences for the beginning
    """
    fixed = any(section == "position" for section, _ in values)
    either = ("track", "file") in needed
    left_out = ("track",) if fixed else () if either else ("position",)
    comments = OPTIONAL if fixed else (*OPTIONAL, "position")
    lines = [f"# {line}".rstrip() for line in head.splitlines()]
    section = ""
    for row in KEY_TEXTS:
        if row.section in left_out:
            continue
        said = any(name == row.section for name, _ in [*values, *needed])
        if row.section != section:
            section = row.section
            out = section in comments and not said
            lines += ["", f"{'# ' * out}[{section}]"]
        lines.append(_line(row, values.get((row.section, row.key)), needed))
    return "\n".join(lines) + "\n"


def _line(row: KeyText, value: str | None, needed: Mapping[tuple[str, str], str]) -> str:
    section = "track" if row.section == "position" else row.section
    mark = "NEEDED, " if (section, row.key) in needed and value is None else ""
    text = f"# {row.key} = {row.example}" if value is None else f"{row.key} = {value}"
    return f"{text:{WIDTH - 1}} # {mark}{row.comment}"
