"""The project file, flight.toml: its keys, errors that name them, and the text of a new one."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from vopd.attitude.sigmas import HALF_A_TURN_DEG
from vopd.files import not_utf8, readable, reason
from vopd.findings import NeededError, VopdError, did_you_mean, raise_all, shown
from vopd.flight.coordinates import GIVE_METRES, HEIGHTS
from vopd.flight.formats.by_content import InputFormat, read_by_content
from vopd.flight.formats.files import Columns, InputFile, open_input
from vopd.flight.formats.lens import GRID_TO_CENTRE, MODELS_OPENCV
from vopd.flight.formats.tables import EXACT
from vopd.flight.solve.rotations import LOSSES
from vopd.geometry.lenses import LensKind
from vopd.inputs import (
    MOST_NUMBER,
    MOST_SETTINGS,
    beyond_sigmas,
    no_date,
    no_file,
    parse_toml,
    read_limited,
)

R = TypeVar("R")

# Every key of flight.toml, one row each

_DATUM = f"heights are above: {', '.join(HEIGHTS)}; or {{ undulation_m = -37.9 }}"
_COUNTED = "what heights are counted from, see below"
_SIGMA = "metres, or [east, north, up]: "
_ROWS = (
    'standard deviations, metres: one number, or east, north, up, or `"exact"`. Needed unless the '
    "file has them in every row; a row's own have precedence"
)
_OF_K = "standard deviation of the coefficient `{}`"
_CRS = "coordinate reference system of x and y"
_GRID = "centre: (0, 0) is the first pixel's centre; corner; one-based"
MOST_LEVEL_M = 1e5  # of what heights count from: the geoid, the ground, a balloon
MOST_DEGREES = 360.0  # of a longitude, east or west
_UNDULATION = "height of the geoid above the ellipsoid, metres"
_GROUND = (
    "height of the ground or launch pad from which heights count, metres, itself counted as the "
    "landmarks' heights are"
)
_GRIDS = tuple(GRID_TO_CENTRE)


VIDEO = "video"
"""The word of `[picks] times` that stands for the presentation times of the key `video`."""


class Key(NamedTuple):
    """A key of flight.toml: how it is read, and what new projects and the documentation say of it.

    Attributes:
        section: the section, or section.key for a key of an inline table
        name: the key
        kind: `text`, `texts`, `file`, `files`, `number`, `numbers`, `size`, `sigma`, `date`, or
            `other` for a value that has a reader of its own
        example: its value in a new project, in TOML; empty for a key that does not stand there
        comment: what stands beside it in a new project
        about: what the documentation says, in Markdown; empty for the comment
        default: what counts without the key; None if there is no such value
        choices: the texts that are known; empty for any
        above: the limit that a number exceeds
        within: the largest size of a number, above and below 0, or of a standard deviation
        size: how many numbers there are, 0 for any; one standard deviation stands for all
        option: the option of `vopd new` that gives it; empty for `--set SECTION.NAME=VALUE`
        one_line: whether it is a text without control characters, for one line of exports and cards
    """

    section: str
    name: str
    kind: str
    example: str
    comment: str
    about: str = ""
    default: Any = None
    choices: tuple[str, ...] = ()
    above: float | None = None
    within: float = MOST_NUMBER
    size: int = 1
    option: str = ""
    one_line: bool = False

    @property
    def new_option(self) -> str:
        """The option of `vopd new` that gives the key."""
        return self.option or f"--set {self.section}.{self.name}"


KEYS: tuple[Key, ...] = (
    Key("flight", "name", "text", '"my flight"', "a title", default="", one_line=True),
    Key("flight", "epoch", "date", "2026-05-01T11:58:42Z", "the moment of t = 0",
        "the moment of t = 0, with its zone. Needed if the times of the frames are in seconds and "
        "those of the track in UTC, or the reverse; 1970-01-01T00:00:00Z if the seconds count from "
        "there",
        option="--epoch"),
    Key("camera", "lens", "file", '"lens.yml"',
        'or a table: { model = "brown", fx_px = 1500.0 }', "the calibration, or a table: "
        '`{ model = "brown", fx_px = 1500, fy_px = 1490, cx_px = 959.5, cy_px = 539.5, '
        "k = [-0.1, 0.02, 0, 0] }`", option="--lens"),
    Key("camera.lens", "model", "text", "", "the family of the model, see below",
        choices=tuple(kind.value for kind in LensKind)),
    Key("camera.lens", "fx_px", "number", "", "focal length along u", above=1.0),
    Key("camera.lens", "fy_px", "number", "", "focal length along v, as `fx_px` if not given",
        above=1.0),
    Key("camera.lens", "cx_px", "number", "", "u of the principal point"),
    Key("camera.lens", "cy_px", "number", "", "v of the principal point"),
    Key("camera.lens", "k", "numbers", "", "the coefficients, see below", size=0),
    Key("camera.lens", "skew_px", "number", "", "Metashape's b2", default=0.0),
    Key("camera.lens", "focal_mm", "number", "", "in the place of `fx_px`, with `sensor_mm`",
        above=0.0),
    Key("camera.lens", "sensor_mm", "numbers", "", "width and height of the sensor", size=2),
    Key("camera.lens", "table_px", "other", "", "`[[radius, what is added to it], ...]`"),
    Key("camera", "model", "text", '"brown"', "brown or fisheye, where 4 coefficients do not say",
        "the lens model, if a file has four coefficients and does not say which model they are for",
        choices=tuple(dict.fromkeys(MODELS_OPENCV.values()))),
    Key("camera", "camera", "text", '"1"', "which camera, where the file has several"),
    Key("camera", "of_images", "file", "", "the lens of each image",
        "for images of several cameras: a CSV with `image` (or `frame`) and either `lens`, a file "
        "in one of `lens`'s formats, or `camera`, a camera in the file of `lens`; or OpenSfM's "
        "reconstruction.json"),
    Key("camera", "image_size_px", "size", "[1920, 1080]", "width and height of the images",
        "width and height of the images; needed if the lens file has no size, and otherwise "
        "compared with it", size=2, option="--image-size"),
    Key("camera", "lens_size_px", "size", "[3840, 2160]", "of the calibration, if another",
        "width and height of the images of the calibration, if they are the same pictures in "
        "another size: the lens is scaled to `image_size_px`", size=2),
    Key("camera", "pixel_grid", "text", '"centre"', f"of cx_px, cy_px; {_GRID}",
        "where `cx_px` and `cy_px` of a table count from", choices=_GRIDS, option="--pixel-grid"),
    Key("camera", "readout_ms", "number", "", "of a rolling shutter: from first row to last",
        "for a rolling shutter: milliseconds from the first row to the last. Without it all rows "
        "have the same time", above=0.0),
    Key("camera", "readout", "text", "", "the way in which rows are read: down, up, right, left",
        "the direction in which the rows (or columns) of the image, as you pick in it, are read; "
        "needed with `readout_ms`", choices=("down", "up", "right", "left")),
    Key("camera", "frame_time", "text", "", "first-row or middle",
        "the moment that a frame's time means: that of its first row, or the middle of the "
        "readout; needed with `readout_ms`", choices=("first-row", "middle")),
    Key("picks", "file", "file", '"picks.csv"',
        "columns frame,landmark,u_px,v_px, or another format", "the picks", option="--picks"),
    Key("picks", "columns", "other", "", "names of the columns of a CSV",
        "if the header of a CSV has other names: `{ landmark = \"target\" }`; if it has no "
        "header, the names of all its columns: `[\"frame\", \"landmark\", \"u_px\", \"v_px\"]`"),
    Key("picks", "pixel_grid", "text", '"centre"', _GRID,
        "for a CSV: `centre` if (0, 0) is the centre of the first pixel, `corner` if it is the "
        "corner of the image, `one-based` if the first pixel is (1, 1)", choices=_GRIDS,
        option="--pixel-grid"),
    Key("picks", "v", "text", '"down"', "down or up", "the direction in which v counts",
        default="down", choices=("down", "up")),
    Key("picks", "sigma_px", "number", "1.0", "standard deviation of a pick",
        "standard deviation of u and of v; a column `sigma_px` has precedence", default=1.0,
        above=0.0),
    Key("picks", "frame_rate_hz", "number", "25.0", "frames a second, for numbered frames",
        "frames per second, for numbered frames and for images whose names end in different "
        "numbers: `f000.png`", above=0.0, option="--fps"),
    Key("picks", "first_frame_t_s", "number", "0.0", "time of frame 0, seconds after the epoch",
        option="--first-frame"),
    Key("picks", "times", "file", '"times.csv"',
        "instead: frame or image, t_s or t_utc; or the images", "replaces both: a CSV with "
        "`frame` or `image`, and `t_s` or `t_utc`, which may be that of the picks; or the folder "
        "of the images, whose EXIF tags have the times; or `\"video\"`, for the times at which the "
        "frames of `video` are shown, after `first_frame_t_s`", option="--images"),
    Key("picks", "video", "files", '"flight.mp4"', "the video or images that were picked in",
        "the video of the picks, for `times = \"video\"` and for `vopd pick`. If the camera wrote "
        "several files, their list, `[\"GH010042.MP4\", \"GH020042.MP4\"]`: frames count on from "
        "one to the next. A `frame_rate_hz` that is not that of the video is an error"),
    Key("picks", "tracked", "file", "", "what vopd track has made of the clicks",
        "the file that `vopd track` writes: the places in the other frames of the landmarks that a "
        "person clicked (`file`). Clicks and tracks are solved together"),
    Key("picks", "tracked_from", "text", "", "clicks, or unknown: of another program",
        "`clicks`: each row of `tracked` names its click, as `vopd track` writes it. "
        "`unknown`: `tracked` has picks by another program, in any format of picks, and replaces "
        "`file`",
        default="clicks", choices=("clicks", "unknown")),
    Key("picks", "utc_offset_h", "number", "2.0",
        "hours: clock of the images in `times` less UTC", "the hours by which the clock of these "
        "images is ahead of UTC, if the tags have no zone"),
    Key("picks", "interpolated", "text", '"use"', "use or drop: points between clicked ones",
        "`drop` leaves out points that CVAT has interpolated between those that were clicked",
        default="use", choices=("use", "drop")),
    Key("landmarks", "file", "file", '"landmarks.csv"',
        "landmark,lat_deg,lon_deg,h_m, or another format", "the landmarks", option="--landmarks"),
    Key("landmarks", "columns", "other", "", "names of the columns of a CSV", "as for picks"),
    Key("landmarks", "crs", "text", '"EPSG:32633"', _CRS, "their coordinate reference system; "
        "needed with `x_m`, `y_m` if the file has none", option="--crs"),
    Key("landmarks", "height", "text", '"ellipsoid"', _DATUM, _COUNTED, choices=HEIGHTS,
        option="--height"),
    Key("landmarks.height", "undulation_m", "number", "", _UNDULATION, within=MOST_LEVEL_M),
    Key("landmarks", "sigma_m", "sigma", "0.05", f"{_SIGMA}0.05 by survey, 1 to 5 from a map",
        _ROWS, size=3, option="--sigma-landmarks"),
    Key("landmarks", "terrain", "file", "", "a GeoTIFF of heights, for vopd track",
        "a GeoTIFF of heights, for `vopd track` on ground that is not level. Its heights count "
        "from the same level as the landmarks', unless its coordinate reference system says "
        "otherwise; it is raised or lowered to go through each landmark"),
    Key("track", "file", "file", '"track.csv"', "t_utc,lat_deg,lon_deg,h_m, or another format",
        "the track of a camera that moves", option="--track"),
    Key("track", "columns", "other", "", "names of the columns of a CSV", "as for picks"),
    Key("track", "crs", "text", '"EPSG:32633"', _CRS, "as for landmarks", option="--crs"),
    Key("track", "height", "text", '"ellipsoid"', _DATUM, "as for landmarks", choices=HEIGHTS,
        option="--height"),
    Key("track.height", "undulation_m", "number", "", _UNDULATION, within=MOST_LEVEL_M),
    Key("track.height", "ground_m", "number", "", _GROUND, within=MOST_LEVEL_M),
    Key("track", "clock", "text", '"utc"', "utc, or gps, which is 18 s ahead",
        "for a column `t_utc`: utc, or gps, which is 18 s ahead since 2017 and needs no zone. "
        "Not needed if the file says it; `seconds` is the clock of a column `t_s`",
        choices=("utc", "gps", "seconds"), option="--clock"),
    Key("track", "offset_s", "number", "0.0", "added to the track's times", default=0.0),
    Key("track", "sigma_m", "sigma", "[1.0, 1.0, 2.0]",
        f"{_SIGMA}of each by itself: 1, 1, 2 by GPS, 0.02, 0.02, 0.04 by RTK",
        f"{_ROWS}. It is the error of each position by itself, besides `sigma_bias_m`", size=3,
        option="--sigma-position"),
    Key("track", "sigma_bias_m", "sigma", "[2.0, 2.0, 4.0]",
        "what all are off together: 2, 2, 4 by GPS, 0.01 by RTK; --sigma-position 2,2,4 gives both",
        "standard deviations of the error that all positions have in common, such as that of a "
        "base station, or within some minutes that of a receiver without corrections", size=3,
        option="--sigma-position"),
    Key("track", "sigma_t_s", "sigma", "0.02",
        "seconds: 0.02 half a frame of a video, 0.3 whole seconds",
        "standard deviation of a frame's time against the track, seconds, or `\"exact\"`. Needed "
        "for a track by time", option="--sigma-time"),
    Key("track", "velocity_sigma_m_s", "sigma", "0.1",
        "m/s, or [north, east, down]: of the track's velocities",
        "standard deviations of the velocities: one number, or north, east, down. Needed if the "
        "track has velocities, unless the file has columns `sigma_vn_m_s`, `sigma_ve_m_s`, "
        "`sigma_vd_m_s`", size=3),
    Key("track", "lever_arm_m", "numbers", "[0.0, 0.0, 0.0]",
        "antenna to camera: forward, right, down",
        "from the antenna to the camera, in the vehicle's forward, right, down", size=3),
    Key("track", "interpolate", "text", '"linear"', "linear or cubic",
        "the path between the track's positions", default="linear", choices=("linear", "cubic")),
    Key("position", "lat_deg", "number", "48.0", "or x_m, y_m, z_m with crs",
        "latitude of a camera that does not move; `[position]` replaces `[track]`",
        within=90.0, option="--position"),
    Key("position", "lon_deg", "number", "15.0", "positive east", "longitude, positive east",
        within=MOST_DEGREES, option="--position"),
    Key("position", "h_m", "number", "300.0", "height", option="--position"),
    Key("position", "x_m", "number", "", "in the place of latitude and longitude: east"),
    Key("position", "y_m", "number", "", "north"),
    Key("position", "z_m", "number", "", "height"),
    Key("position", "crs", "text", "", "of `x_m`, `y_m`, as for landmarks", option="--crs"),
    Key("position", "height", "text", '"ellipsoid"', _DATUM, "as for landmarks", choices=HEIGHTS,
        option="--height"),
    Key("position.height", "undulation_m", "number", "", _UNDULATION, within=MOST_LEVEL_M),
    Key("position.height", "ground_m", "number", "", _GROUND, within=MOST_LEVEL_M),
    Key("position", "sigma_m", "sigma", "0.05", f"{_SIGMA}0.05 by survey, 3 by a phone",
        "standard deviations, metres: one number, or east, north, up, or `\"exact\"`. Needed",
        size=3, option="--sigma-position"),
    Key("position", "lever_arm_m", "numbers", "", "as for a track", size=3),
    Key("vehicle", "mount", "text", '"forward"',
        "forward, down, { ypr_deg = [..] } or { matrix = [..] }",
        "the mounting of the camera: its axis forward or down, or a turn from there",
        default="forward", choices=("forward", "down")),
    Key("vehicle.mount", "ypr_deg", "numbers", "", "yaw, pitch, roll of the camera in the "
        "vehicle, from `forward` about its down, the new right and the new forward axis: "
        "`{ ypr_deg = [90, 0, 0] }` looks right, `[0, -90, 0]` is `down`", size=3),
    Key("vehicle.mount", "matrix", "other", "", "`{ matrix = [[...], [...], [...]] }`: its "
        "columns are the picture's right, the picture's down and the view, each by its parts along "
        "the vehicle's forward, right and down; `[[0, 0, 1], [1, 0, 0], [0, 1, 0]]` is `forward`"),
    Key("vehicle", "mount_sigma_deg", "sigma", "",
        "standard deviation of the mount, a turn about each of the vehicle's axes, degrees"),
    Key("vehicle", "attitude", "file", "",
        "the vehicle's attitudes, from which `free = [\"mount\"]` finds the mount: a CSV with "
        "`yaw_deg` from true north, `pitch_deg`, `roll_deg` and `frame`, `image`, `t_s` or "
        "`t_utc`, seconds or dates on the clock of the track; or a folder of images whose tags "
        "have the angles of the gimbal that carries the camera"),
    Key("vehicle", "attitude_sigma_deg", "sigma", "",
        "standard deviation of each of these attitudes by itself, degrees about each axis; needed "
        "unless the file has a column `sigma_deg`"),
    Key("wind", "file", "file", '"wind.csv"',
        "h_m,from_deg,speed_m_s; without it against the ground",
        "a sounding; without it the angles of attack are relative to the ground", option="--wind"),
    Key("wind", "columns", "other", "", "names of the columns of a CSV", "as for picks"),
    Key("wind", "sigma_m_s", "sigma", "1.0", "m/s, of the wind along north and along east",
        "standard deviation of the wind along north and along east; one error for all frames"),
    Key("atmosphere", "refraction", "text", '"standard"', "standard, off or { k = 0.13 }",
        "refraction of the lines of sight, see below", default="standard",
        choices=("standard", "off")),
    Key("atmosphere.refraction", "k", "number", "", "a constant coefficient: `{ k = 0.13 }`"),
    Key("atmosphere", "sigma_k", "sigma", "0.065", "of the coefficient of refraction",
        "standard deviation of the coefficient; half of the coefficient if not given", within=5.0),
    Key("solve", "loss", "text", '"least-squares"', "least-squares, huber or cauchy",
        "the weight of large residuals", default="least-squares", choices=tuple(LOSSES)),
    Key("solve", "blunders", "text", '"name"', "name (tell and keep) or drop",
        "`name` reports picks that do not fit and keeps them; `drop` leaves them out",
        default="name", choices=("name", "drop")),
    Key("solve", "check_landmarks", "texts", "[]", "landmarks that are not used",
        "landmarks that are left out of the solve, as a check: the answer states the distance of "
        "their picks from their computed places, and images of frames show them"),
    Key("solve", "frames", "text", '"each"', "each, or one for a camera that does not move",
        "`one` solves all frames of a camera that neither moves nor turns as one, with the "
        "picks of each landmark averaged. Only with `[position]`", default="each",
        choices=("each", "one")),
    Key("solve", "position", "text", '"solve"', "solve (within its sigma_m) or fixed",
        "`solve` solves for positions and landmarks within their standard deviations; `fixed` "
        "keeps them as stated",
        default="solve", choices=("solve", "fixed")),
    Key("solve", "free", "texts", '[]',
        'solved for too: ["focal", "k1", "clock"], vopd help adjust',
        "parameters to solve for with all frames together, by the names of "
        "[`vopd adjust`](adjust.md): `[\"focal\", \"clock\"]`"),
    Key("uncertainty", "focal_rel", "sigma", "0.001", "of the focal length, as a part of it",
        "standard deviation of the focal length, as a part of it: 0.01 is 1 %", within=0.5),
    Key("uncertainty", "principal_px", "sigma", "[1.0, 1.0]", "of the principal point",
        "standard deviations of the principal point, x and y", size=2),
    Key("uncertainty", "k1", "sigma", "0.001", "of the lens's k1", _OF_K.format("k1")),
    Key("uncertainty", "k2", "sigma", "0.001", "of the lens's k2", _OF_K.format("k2")),
    Key("uncertainty", "p1p2", "sigma", "0.0001", "of the lens's p1 and p2",
        "standard deviation of the coefficients `p1` and `p2`"),
    Key("uncertainty", "clock_rate_ppm", "sigma", "20.0", "of the frame rate, parts per million",
        "standard deviation of the rate of the frames' clock, parts per million", within=5e5),
    Key("uncertainty", "readout_ms", "sigma", "1.0", "of a rolling shutter's readout",
        "standard deviation of the readout of a rolling shutter, milliseconds"),
    Key("uncertainty", "covariance", "file", '"covariance.json"', "what vopd adjust -o has written",
        "the file that `vopd adjust -o` writes: the solve keeps the values that it names, and "
        "propagates their errors with their covariance. It belongs to the picks and the track from "
        "which it was made: with others, or with other values of the keys that read them, it is "
        "refused"),
)  # fmt: skip
"""In the order of a new project, a section's keys together."""
ROWS = {(key.section, key.name): key for key in KEYS}
REQUIRED = ("camera", "picks", "landmarks")
SECTIONS = tuple(dict.fromkeys(key.section for key in KEYS if "." not in key.section))


def sections_of(key: str) -> list[str]:
    """List the sections that have a key of this name, as they are written."""
    return [f"[{section}]" for section in SECTIONS if (section, key) in ROWS]


def with_common_error(needed: Mapping[tuple[str, str], str]) -> dict[tuple[str, str], str]:
    """Ask for the error that a track's positions have in common beside that of each by itself.

    Args:
        needed: keys that are missing, and why
    """
    found = dict[tuple[str, str], str]()
    for key, why in needed.items():
        found[key] = why
        if key == ("track", "sigma_m"):
            common = "track", "sigma_bias_m"
            found[common] = ROWS[common].comment
    return found


def keys_of(section: str) -> list[str]:
    """List the keys of a section, or of an inline table by `section.key`."""
    return [key.name for key in KEYS if key.section == section]


# A project file that has been read


@dataclass(frozen=True)
class Section:
    """One section of a project, with a getter for each kind of value; `KEYS` has what is valid."""

    project: str
    name: str
    values: dict[str, Any]

    def error(self, key: str, message: str) -> VopdError:
        """An error about one key."""
        kind = NeededError if message.startswith("is needed") else VopdError
        return kind(f"{self.project}: [{self.name}] {key}: {message}")

    def has(self, key: str) -> bool:
        """Tell whether the key is given."""
        return key in self.values

    def text(self, key: str, choices: Sequence[str] = ()) -> str:
        """Read a text or the name of a file.

        Args:
            key: the key
            choices: the texts that are known here, where they are not those of the key's row

        Raises:
            VopdError: where it is missing, or is another
        """
        row = self._row(key, "text", "file")
        value, choices = self.values.get(key, row.default), choices or row.choices
        if value is None:
            known = f": {', '.join(choices)}" if choices else ""
            raise self.error(key, f"is needed{known}")
        if not isinstance(value, str):
            known = f": {row.comment}" if row.choices else ""
            raise self.error(key, f"{shown(value)} is not a text in quotes{known}")
        if choices and value not in choices:
            raise self.error(key, f"{shown(value)} is not known{did_you_mean(value, choices)}")
        if row.one_line and not value.isprintable():
            raise self.error(key, f"{shown(value)} has control characters: write one line")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """Read a finite number.

        Args:
            key: the key
            default: what counts without it, where the key's row has none
        """
        row = self._row(key, "number")
        value = self.values.get(key, row.default if default is None else default)
        if value is None:
            raise self.error(key, "is needed")
        found = self._number(key, value, row.above)
        if abs(found) > row.within:
            degrees = row.within <= MOST_DEGREES < abs(found)
            metres = f"; metres of a grid? {GIVE_METRES}" * degrees
            message = f"must be {-row.within:g} to {row.within:g}, not {found:g}{metres}"
            raise self.error(key, message)
        return found

    def sigma(self, key: str) -> tuple[float, ...] | None:
        """Read standard deviations, none below 0, or one that stands for all; None if not given.

        `"exact"` is 0.
        """
        row = self._row(key, "sigma")
        if not self.has(key):
            return None
        value = self.values[key]
        if isinstance(value, str):
            if value != EXACT:
                message = f'{shown(value)} is not known: a number, or "{EXACT}"'
                raise self.error(key, message)
            return (0.0,) * row.size
        if isinstance(value, list | tuple):
            if EXACT in value:
                message = f'{shown(value)}: "{EXACT}" stands for all: in a list, 0 is exact'
                raise self.error(key, message)
            found = self._list(key, value, row.size)
        else:
            found = (self._number(key, value),) * row.size
        if min(found) < 0.0:
            raise self.error(key, f"{min(found):g}: a standard deviation is not below 0")
        if beyond := beyond_sigmas(found):
            raise self.error(key, f"{beyond}, or 0")
        if max(found) > row.within:
            raise self.error(key, f"{max(found):g}: {row.within:g} at most, {row.about}")
        if key.endswith("_deg") and max(found) > HALF_A_TURN_DEG:
            raise self.error(
                key, f"{max(found):g} degrees: {HALF_A_TURN_DEG:g} at most, half a turn"
            )
        return found

    def numbers(self, key: str) -> tuple[float, ...]:
        """Read a list of finite numbers."""
        count = self._row(key, "numbers").size
        if not self.has(key):
            raise self.error(key, f"is needed, {count} numbers")
        return self._list(key, self.values[key], count)

    def size(self, key: str) -> tuple[int, int] | None:
        """Read the width and height of an image, pixels; None if not given."""
        row = self._row(key, "size")
        if not self.has(key):
            return None
        width, height = self._list(key, self.values[key], row.size)
        if min(width, height) < 1 or width % 1 or height % 1:
            raise self.error(key, "is width and height, whole numbers of pixels")
        return int(width), int(height)

    def texts(self, key: str) -> tuple[str, ...]:
        """Read a list of texts; none if the key is not given."""
        self._row(key, "texts")
        value = self.values.get(key, [])
        if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
            raise self.error(key, f"{shown(value)} is not a list of texts in quotes")
        return tuple(value)

    def files(self, key: str) -> tuple[str, ...]:
        """Read the name of a file, or a list of such names.

        Raises:
            VopdError: where it is missing, or is another
        """
        self._row(key, "files")
        value = self.values.get(key)
        if value is None:
            raise self.error(key, "is needed")
        names = [value] if isinstance(value, str) else value
        if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
            raise self.error(key, f"{shown(value)} is no name of a file in quotes, nor several")
        return tuple(names)

    def columns(self) -> Columns | None:
        """Read what is said of the columns of a CSV; None if nothing is."""
        value = self.values.get("columns")
        if value is None:
            return None
        self._row("columns", "other")
        texts = value.values() if isinstance(value, dict) else value
        if not isinstance(value, dict | list) or not all(isinstance(one, str) for one in texts):
            message = 'is a table, { h_m = "alt" }, or the list of all columns of a file without'
            raise self.error("columns", f"{message} a header")
        return value

    def date(self, key: str) -> datetime | None:
        """Read a date and time, UTC; None if not given.

        Raises:
            VopdError: where it does not say its zone
        """
        row, value = self._row(key, "date"), self.values.get(key)
        if value is None:
            return None
        try:
            if isinstance(value, datetime) and value.tzinfo is not None:
                return value.astimezone(UTC)
        except OverflowError:  # before the year 1 or after 9999 once it is in UTC
            pass
        unquoted = ", without quotes" * isinstance(value, str)
        raise self.error(key, f"is a date and time with its zone, as {row.example}{unquoted}")

    def section(self, key: str) -> Section:
        """Read an inline table, whose keys are all known."""
        value = self.values[key]
        found = Section(self.project, f"{self.name}.{key}", value)
        if not isinstance(value, dict):
            first = keys_of(found.name)[0]
            raise self.error(key, f"{shown(value)} is not a table, {{ {first} = ... }}")
        found.check()
        return found

    def check(self) -> None:
        """Refuse keys that are not known, and values of another kind, also where none is read."""
        for error in self.errors():
            raise error

    def errors(self) -> Iterator[VopdError]:
        """Find keys that are not known, and values of another kind."""
        known = keys_of(self.name)
        for key, value in self.values.items():
            if key not in known:
                of = sections_of(key)
                hint = did_you_mean(key, known) if len(of) != 1 else f"; it is one of {of[0]}"
                yield self.error(key, f"there is no such key{hint}")
                continue
            kind = ROWS[self.name, key].kind
            if isinstance(value, dict) and keys_of(f"{self.name}.{key}"):
                yield from Section(self.project, f"{self.name}.{key}", value).errors()
            elif kind != "other":
                try:
                    getattr(self, "text" if kind == "file" else kind)(key)
                except VopdError as error:
                    yield error

    def _row(self, key: str, *kinds: str) -> Key:
        """Look up the row of a key, which is of one of these kinds."""
        row = ROWS[self.name, key]
        assert row.kind in kinds, (row, kinds)
        return row

    def _list(self, key: str, value: Any, count: int) -> tuple[float, ...]:
        if not isinstance(value, list | tuple) or len(value) != (count or len(value)):
            several = f"{count} numbers" if count else "numbers"
            wanted = "one number" if count == 1 else f"a list of {several}"
            raise self.error(key, f"{shown(value)} is not {wanted}")
        return tuple(self._number(key, one) for one in value)

    def _number(self, key: str, value: Any, above: float | None = None) -> float:
        try:
            finite = not isinstance(value, bool) and isfinite(value)
        except (TypeError, OverflowError):  # another kind of value, a whole number beyond 1e308
            finite = False
        if not finite:
            raise self.error(key, f"{shown(value)} is not a finite number")
        if above is not None and not value > above:
            raise self.error(key, f"must be above {above:g}, not {value:g}")
        if abs(value) > MOST_NUMBER:
            raise self.error(key, f"{value:g} is too large: {MOST_NUMBER:.0e} at most")
        return float(value)


@dataclass(frozen=True)
class Project:
    """A project file that has been read: its sections, all keys known."""

    name: str  # as the user gave it
    folder: Path
    sections: dict[str, Section]
    held: dict[tuple[str, str], Any] = field(default_factory=dict, repr=False, compare=False)

    def section(self, name: str) -> Section:
        """Look up a section, empty where the project has none."""
        return self.sections.get(name, Section(self.name, name, {}))

    def has(self, name: str) -> bool:
        """Tell whether the project has that section."""
        return name in self.sections

    def lacking(self, keys: Mapping[tuple[str, str], str]) -> dict[tuple[str, str], str]:
        """Select keys that the project does not have."""
        return {key: why for key, why in keys.items() if not self.section(key[0]).has(key[1])}

    def names_file(self, section: str, key: str) -> bool:
        """Tell whether the value of a key names a file or files; `times = "video"` is a word."""
        value = self.section(section).values.get(key)
        if ROWS[section, key].kind == "files":
            return True
        is_word = (section, key, value) == ("picks", "times", VIDEO)
        return ROWS[section, key].kind == "file" and isinstance(value, str) and not is_word

    def awaits_tracks(self) -> bool:
        """Tell whether `vopd track` is yet to write the tracked file: clicks alone are solved."""
        picks = self.section("picks")
        if not (picks.has("tracked") and picks.has("file")):
            return False
        from_clicks = picks.text("tracked_from") == "clicks"
        return from_clicks and not (self.folder / picks.text("tracked")).exists()

    def changed(self, section: str, key: str, value: Any) -> Project:
        """Change the value of one key."""
        before = self.section(section)
        new = replace(before, values=before.values | {key: value})
        return replace(self, sections=self.sections | {section: new})

    def without(self, section: str, *keys: str) -> Project:
        """Leave keys of one section out."""
        before = self.section(section)
        left = {key: value for key, value in before.values.items() if key not in keys}
        return replace(self, sections=self.sections | {section: replace(before, values=left)})

    def read(self, section: str, file: InputFile, formats: Sequence[InputFormat[R]]) -> R:
        """Read the file of a section; copies made by `changed` do not read it again."""
        key = section, file.name
        if key not in self.held:
            self.held[key] = read_by_content(formats, file)
        rows: R = self.held[key]
        return rows

    def open(self, section: str, key: str = "file") -> InputFile:
        """Open the file that a key names."""
        where = self.section(section)
        try:
            columns = where.columns() if key == "file" else None
            known = where.values if key == "file" else {}
            crs, clock = (
                one if isinstance(one := known.get(name), str) else None
                for name in ("crs", "clock")
            )
            file = open_input(where.text(key), self.folder, columns, crs, clock)
            return file if key == "file" else replace(file, mappable=False)
        except VopdError as error:
            raise error if where.project in str(error) else where.error(key, str(error)) from error


def read_project(name: str, location: str | None = None) -> Project:
    """Read a project file and refuse what is not known.

    Args:
        name: its path
        location: where it is, if not under its name

    Raises:
        VopdError: where it cannot be read, or has an unknown section or key
    """
    path = Path(location or name)
    try:
        if kind := no_file(path):
            raise VopdError(f"{name}: {kind}")
        with path.open("rb") as file:
            values = parse_toml(read_limited(file, MOST_SETTINGS))
    except OSError as error:
        raise VopdError(f"{name}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise VopdError(f"{name}: {not_utf8(error.object, error.start)}") from error
    except (ValueError, RecursionError) as error:
        why = reason(error)
        line = re.match(r"line (\d+)", why)
        if line and (wrong := no_date(path.read_text("utf-8-sig").splitlines()[int(line[1]) - 1])):
            raise VopdError(f"{name}: line {line[1]}: {wrong}") from error
        raise VopdError(f"{name}: not valid TOML: {why}") from error
    sections, errors = dict[str, Section](), list[VopdError]()
    for section, inside in values.items():
        if section not in SECTIONS:
            message = f"[{section}] is not known{did_you_mean(section, SECTIONS)}"
            of = " or ".join(sections_of(section))
            if of and not isinstance(inside, dict):
                message = f"{section} is in no section: write it below {of}"
            errors.append(VopdError(f"{name}: {message}"))
        elif not isinstance(inside, dict):
            errors.append(VopdError(f"{name}: {section} is a section: write [{section}]"))
        else:
            sections[section] = Section(name, section, inside)
            errors += sections[section].errors()
    raise_all(errors)
    missing = [f"[{section}]" for section in REQUIRED if section not in sections]
    if missing:
        if not {"track", "position"} & {*sections}:
            missing.append("[track] (or [position], if the camera does not move)")
        are = (
            f"sections {', '.join(missing)} are" if len(missing) > 1 else f"section {missing[0]} is"
        )
        raise VopdError(f"{name}: the {are} needed")
    for section in ("wind", "position", "track"):  # a header alone, whose keys are comments
        alone = section in sections and not sections[section].values
        if alone and (section == "wind" or {"track", "position"} <= {*sections}):
            del sections[section]
    if ("track" in sections) == ("position" in sections):
        which = "both are there" if "track" in sections else "neither is there"
        raise VopdError(
            f"{name}: [track] for a camera that moves, or [position] for one that does not: {which}"
        )
    return Project(name, path.parent, sections)


def mount_moves(sections: Mapping[str, Mapping[str, Any]]) -> bool:
    """Tell whether the camera's place depends on its mount, by a lever arm in the vehicle's axes.

    Args:
        sections: the values of keys by section
    """
    return any(sections.get(name, {}).get("lever_arm_m") for name in ("track", "position"))


# The text of a new project file

WIDTH = 44  # columns before a comment

KeyValues = dict[tuple[str, str], str]
"""TOML texts of values by section and key."""


def toml_text(text: str) -> str:
    """Quote a text, as TOML has it.

    Raises:
        VopdError: for the name of a file that is not UTF-8, which TOML is
    """
    quoted = json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
    if any("\ud800" <= one <= "\udfff" for one in quoted):
        raise VopdError(f"{shown(text)}: is not UTF-8, and has no place in a project: rename it")
    return quoted


def from_toml(text: str) -> Any:
    """Read a value that is written as TOML."""
    return tomllib.loads(f"x = {text}")["x"]


def toml_numbers(*numbers: float) -> str:
    """Write a list of numbers, as TOML has it."""
    return "[" + ", ".join(f"{number:.12g}" for number in numbers) + "]"


NO_OPTIONS: Mapping[tuple[str, str], str] = {}


def project_text(
    values: KeyValues,
    needed: Mapping[tuple[str, str], str],
    head: str,
    options: Mapping[tuple[str, str], str] = NO_OPTIONS,
) -> str:
    """Write the text of a project file.

    Keys without a value stand as comments with an example; the headers above them do not, so that
    a key is put in force by itself. Sections that stand for others, and have no value, are left
    out: `[track]` beside `[position]`. Where neither is known both are there.

    Args:
        values: the values that are known
        needed: keys that the user must give, and why; they are marked
        head: sentences for the beginning
        options: those of `vopd new` that give keys, where they are not the usual ones
    """
    either = ("track", "file") in needed
    fixed = any(section == "position" for section, _ in (values if either else [*values, *needed]))
    left_out = ("track",) if fixed else () if either else ("position",)
    lines = [f"# {readable(line)}".rstrip() for line in head.splitlines()]
    section = ""
    for row in KEYS:
        given = (row.section, row.name) in values
        if row.section in left_out or not (row.example or given):
            continue
        if row.section != section:
            section = row.section
            lines += ["", f"[{section}]"]
        lines.append(_line(row, values.get((row.section, row.name)), needed, options))
    return "\n".join(lines) + "\n"


def written_keys(text: str, head: str) -> KeyValues | None:
    """Read the values of a project file that `project_text` wrote; None if anybody edited it.

    Args:
        text: what the file has
        head: as for `project_text`
    """
    values, needed, section = KeyValues(), dict[tuple[str, str], str](), ""
    options = dict[tuple[str, str], str]()
    for line in text.splitlines():
        if header := re.fullmatch(r"\[(\w+)\]", line):
            section = header[1]
        named = re.match(r"(# )?(\w+) = ", line)
        if not named or (row := ROWS.get((section, named[2]))) is None:
            continue
        if named[1] and (asked := re.search(r" # NEEDED \((.*?)\), ", line)):
            needed[section, row.name], options[section, row.name] = "", asked[1]
        elif not named[1]:
            values[section, row.name] = line[named.end() :].removesuffix(f"# {row.comment}").strip()
    return values if project_text(values, needed, head, options) == text else None


def _line(
    row: Key,
    value: str | None,
    needed: Mapping[tuple[str, str], str],
    options: Mapping[tuple[str, str], str],
) -> str:
    sections = ("position", "track") if row.section == "position" else (row.section,)
    asked = value is None and any((section, row.name) in needed for section in sections)
    option = options.get((row.section, row.name), row.new_option)
    mark = f"NEEDED ({option}), " if asked else ""
    text = f"# {row.name} = {row.example}" if value is None else f"{row.name} = {value}"
    return f"{text:{WIDTH - 1}} # {mark}{row.comment}"
