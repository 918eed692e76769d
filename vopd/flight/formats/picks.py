"""Files of picks: CSV, CVAT, LabelMe, gcp_list.txt, OpenSfM, Metashape, CIRN."""

from __future__ import annotations

import csv
import re
from array import array
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.files import reason
from vopd.findings import VopdError, count_text, shown
from vopd.flight.formats.by_content import InputFormat, read_by_content
from vopd.flight.formats.files import UNEXPECTED, InputFile, open_input
from vopd.flight.formats.landmarks import (
    FALSE,
    control_points,
    is_gcp_list,
    marker_tree,
    read_gcp_list,
    recognises_control,
    recognises_markers,
)
from vopd.flight.formats.lens import GRID_TO_CENTRE, whole_size
from vopd.flight.formats.tables import (
    CsvTable,
    commented_names,
    csv_blocks,
    frames_of_column,
    has_columns,
    header_names,
    no_frame,
    read_csv,
    whole_numbers,
)
from vopd.inputs import is_number, parse_json, plain_number, whole_number

if TYPE_CHECKING:
    from vopd.flight.formats.tracked import TrackedRows

# Picks as read

Sizes = dict[str, tuple[int, int]]  # widths and heights of images by their names


class Names(Sequence[str]):
    """The names of P frames or landmarks, each of which is kept once.

    Attributes:
        known: the different names, in the order in which they come
        which: which of them each is, (P,)
    """

    def __init__(self, names: Iterable[str] = ()) -> None:
        self._number: dict[str, int] = {}
        self._which = array("i")
        self.extend(names)

    def extend(self, names: Iterable[str]) -> None:
        """Add names at the end."""
        number = self._number
        self._which.extend([number.setdefault(name, len(number)) for name in names])

    @property
    def known(self) -> list[str]:
        return list(self._number)

    @property
    def which(self) -> Ints:
        return np.asarray(self._which)

    def __len__(self) -> int:
        return len(self._which)

    def __getitem__(self, k: Any) -> Any:
        return self.known[self._which[k]]

    def __iter__(self) -> Iterator[str]:
        return map(self.known.__getitem__, self._which)


@dataclass(frozen=True, eq=False)
class PickRows:
    """The picks of a file as they stand in it, P of them."""

    frame: Ints | Names  # numbers of frames, or names of images
    landmark: Names
    pixel: Floats  # (P, 2) u, v on the file's grid
    sigma_px: Floats  # (P,) NaN where not given
    grid: str | None  # where the file counts pixels from; None where the project says it
    size_px: tuple[int, int] | Sizes | None
    # of the images, where the file says; by their names where they are of several sizes
    said: str  # the format, for a sentence
    up_from: Floats | None = (
        None  # the v of the last row, or (P,) of each pick's, where v counts upward
    )
    v_said: bool = False  # whether the file says that v counts down
    stated: bool = False  # whether the project or the file states `sigma_px`
    interpolated: Bools | None = None  # (P,) by the program that wrote the file; None: unknown
    tracks: TrackedRows | None = None  # the same picks with the clicks that they are from
    doubts: tuple[str, ...] = ()  # warnings about the file
    by_size: bool = False  # pixels are from the image's middle, by its longer side
    commented: Mapping[str, str] = field(default_factory=dict)
    # comments that may be rows, by the name they begin with: where they are

    def where(self, kept: Bools) -> PickRows:
        """Take some of the picks of numbered frames, (P,)."""
        names = Names(name for name, one in zip(self.landmark, kept.tolist(), strict=True) if one)
        return replace(
            self,
            frame=np.asarray(self.frame)[kept],
            landmark=names,
            pixel=self.pixel[kept],
            sigma_px=self.sigma_px[kept],
            interpolated=None,
        )

    def centred_px(self, picks: Ints) -> Floats:
        """Convert u and v of some picks, by their indices, to the first pixel's centre, (n, 2)."""
        assert self.grid is not None
        found = self.pixel[picks] + GRID_TO_CENTRE[self.grid]
        if self.up_from is not None:
            last = np.broadcast_to(self.up_from, len(self.pixel))
            found[:, 1] = last[picks] - found[:, 1]
        return np.asarray(found)


# Picks as a CSV: frame or image, landmark, u_px, v_px and perhaps sigma_px

COLUMNS = ("frame", "image", "landmark", "u_px", "v_px", "sigma_px")
CLICKS = "# pixels: u right, v down, (0, 0) the centre of the first pixel"
"""The first line of a CSV of picks that says how they are counted."""


LEAST_PX = 1e-4  # standard deviation of a pick: less is told, for no click or match is so good
SMALL_SIGMA = "px is less than any pick has: a click has about 0.5, a match 0.05"


def doubt_of_small_sigma(block: CsvTable, sigma_px: Floats) -> tuple[str, ...]:
    """Name the first standard deviation of some rows that no pick has, for a warning.

    Args:
        block: the rows
        sigma_px: of them, (n,)
    """
    small = np.flatnonzero(sigma_px < LEAST_PX)
    if not len(small):
        return ()
    message = f"{sigma_px[small[0]]:g} {SMALL_SIGMA}"
    return (str(block.error(message, int(small[0]), "sigma_px")),)


PIX4D_COLUMNS = ["image", "landmark", "u_px", "v_px", "zoom"]  # the last in some versions
PIX4D_IMAGE = re.compile(r"\.(jpe?g|png|tiff?)$", re.IGNORECASE)


def is_pix4d(file: InputFile) -> bool:
    """Tell whether the first line is a mark of Pix4D, which writes no header: image, name, u, v."""
    cells = header_names(file)
    if file.columns is not None or len(cells) not in (4, 5):
        return False
    return bool(PIX4D_IMAGE.search(cells[0])) and all(map(is_number, cells[2:]))


def recognises_csv_picks(file: InputFile) -> bool:
    """Tell whether the header names a landmark and pixels, or is near to that."""
    return is_pix4d(file) or has_columns(file, COLUMNS, ("landmark",), ("u_px",), ("v_px",))


UNSEEN = (0, -1)  # u and v of a landmark that is not in the image, as trackers write them


def read_csv_picks(file: InputFile) -> PickRows:
    """Read the picks of a CSV, by blocks. Frames are whole numbers from 0, or names of images;
    without either column all are of one image.

    One that `vopd pick` saved says itself how pixels are counted.
    """
    if is_pix4d(file):
        found = read_csv_picks(replace(file, columns=PIX4D_COLUMNS[: len(header_names(file))]))
        return replace(found, said="Pix4D's marks")
    frame, pixel, sigma = array("q"), array("d"), array("d")
    landmark, image = Names(), Names()
    named = False
    doubts: tuple[str, ...] = ()
    for block in csv_blocks(file, COLUMNS):
        block.require(("landmark", "u_px", "v_px"))
        _add_names(landmark, block, "landmark")
        if block.has("image"):
            _add_names(image, block, "image")
        elif not block.has("frame"):
            frame.extend(np.zeros(len(block.line), int).tolist())
        elif not named:
            numbers = whole_numbers(block, "frame")
            named = numbers is None
            frame.frombytes(b"" if numbers is None else numbers.tobytes())
        both = np.stack([block.numbers("u_px"), block.numbers("v_px")], axis=1)
        for nowhere in UNSEEN:
            for row in np.flatnonzero((both == nowhere).all(axis=1))[:1].tolist():
                message = f"{nowhere}, {nowhere}: programs write that where a landmark is not seen"
                raise block.error(f"{message}: remove all such lines", row, "u_px")
        pixel.frombytes(both.tobytes())
        if block.has("sigma_px"):
            own = block.sigmas("sigma_px")
            doubts = doubts or doubt_of_small_sigma(block, own)
            sigma.frombytes(own.tobytes())
    if not len(landmark):
        raise file.error("no pick is in the file")
    one_image = "" if block.has("frame") or block.has("image") else ", all of one image"
    if one_image and len(landmark.known) < len(landmark):
        block.column("frame")  # of several images, then: it is an error that there is none
    if named:  # or a number is wrong
        table = read_csv(file, COLUMNS)
        frames_of_column(table)
        _add_names(image, table, "frame")
    return PickRows(
        image if len(image) else np.asarray(frame),
        landmark,
        np.asarray(pixel).reshape(-1, 2),
        np.asarray(sigma) if len(sigma) else np.broadcast_to(np.nan, len(landmark)),
        "centre" if file.head.startswith(CLICKS) else None,
        None,
        f"CSV{block.read_as}" + one_image,
        doubts=doubts,
        commented=commented_names(file, COLUMNS, ("image", "frame", "landmark")),
    )


def _add_names(names: Names, table: CsvTable, column: str) -> None:
    """Add the names of a column, none of which may be empty."""
    row = 0
    for block in table.blocks(column):
        if "" in block:
            raise table.error("the cell is empty", row + block.index(""), column)
        names.extend(block)
        row += len(block)


# Shapes of annotations that are no points

NO_POINTS = {
    "box", "circle", "cuboid", "ellipse", "line", "linestrip", "mask", "polygon", "polyline",
    "rectangle", "skeleton",
}  # fmt: skip
NO_PLACE = "empty point"


def _left_out(file: InputFile, kinds: Iterable[str]) -> tuple[str, ...]:
    """Count the shapes of a file that are no picks, for a warning.

    Args:
        file: the file
        kinds: of the shapes, as those of `NO_POINTS`
    """
    count = sorted(Counter(kinds).items())
    several = [count_text(n, kind, f"{kind}es" * kind.endswith("x")) for kind, n in count]
    are = "is no pick" if sum(n for _, n in count) == 1 else "are no picks"
    message = f"{file.name}: {', '.join(several)} {are}: mark landmarks as points"
    return (message,) if several else ()


# CVAT's XML, for images 1.1 and for video 1.1; pixels are counted from the corner


def recognises_cvat(file: InputFile) -> bool:
    """Tell whether it is XML of annotations."""
    return "<annotations" in file.head


def read_cvat(file: InputFile) -> PickRows:
    """Read the points of a CVAT file that are inside the image and not of a track that ended.

    A label with one point is a landmark; of several points in one shape each is a
    pick of it.
    """
    root = file.xml()
    found: list[tuple[int | str, str, float, float]] = []
    between: list[bool] = []
    others: list[str] = []
    images = root.findall("image")
    for image in images:
        others += [one.tag for one in image if one.tag in NO_POINTS]
        for points in image.findall("points"):
            pixels = _pixels(file, points.get("points", ""))
            others += [NO_PLACE] * (not pixels)
            found += [(image.get("name", ""), points.get("label", ""), *xy) for xy in pixels]
    for track in root.findall("track"):
        seen = (one.tag for one in track if one.get("outside") != "1")
        others += [kind for kind in seen if kind in NO_POINTS]
        for points in track.findall("points"):
            if points.get("outside") != "1":
                pixels = _pixels(file, points.get("points", ""))
                others += [NO_PLACE] * (not pixels)
                frame, label = points.get("frame", ""), track.get("label", "")
                if message := no_frame(frame):
                    raise file.error(message, column=f"track {shown(label)}, frame")
                between += [points.get("keyframe") == "0"] * len(pixels)
                found += [(int(frame), label, *xy) for xy in pixels]
    if not found:
        raise file.error("no points are in the file: landmarks are drawn as points")
    if not all(one[1] for one in found):
        raise file.error("some points have no label: the label is the name of the landmark")
    if images and any(isinstance(one[0], int) for one in found):
        raise file.error("images and video tracks are in one file: give them one by one")
    tasks = [*dict.fromkeys(one.get("task_id", "") for one in images or root.findall("track"))]
    twice_named = len({one.get("name") for one in images}) < len(images)
    if len(tasks) > 1 and (twice_named or not images):
        raise file.error(
            f"{count_text(len(tasks), 'task')} are in the file, whose frames have the same "
            f"{'names' if images else 'numbers'}: export one task"
        )
    own = [(one.get("name", ""), one.get("width"), one.get("height")) for one in images]
    own += [
        (f"task {k}", one.findtext("width"), one.findtext("height"))
        for k, one in enumerate(() if images else root.iter("original_size"))
    ]
    sizes: Sizes = {}
    for name, width, height in own:
        if width is not None and height is not None:
            _add_size(file, sizes, name, (whole_number(width), whole_number(height)))
    frames: list[Any] = [one[0] for one in found]
    by_image = isinstance(frames[0], str)
    landmark = Names(one[1] for one in found)
    pixel = np.array([one[2:] for one in found])
    unknown = np.full(len(found), np.nan)
    count = sum(between)
    said = "CVAT images" if images else "CVAT video"
    said += f", {len(found) - count} clicked, {count} interpolated" if count else ""
    return PickRows(
        Names(frames) if by_image else np.array(frames), landmark, pixel, unknown, "corner",
        _one_size(sizes), said,
        interpolated=np.array(between) if count else None, doubts=_left_out(file, others),
    )  # fmt: skip


def _add_size(file: InputFile, sizes: Sizes, name: str, size: tuple[int, int]) -> None:
    """Keep the size of an image.

    Raises:
        VopdError: where it has another already
    """
    other = sizes.setdefault(name, size)
    if other != size:
        has = "{} x {} and {} x {}".format(*other, *size)
        raise file.error(f"{shown(name)} has two sizes, {has}: they are two images")


def _one_size(sizes: Sizes) -> tuple[int, int] | Sizes | None:
    """Take the size of images that are all of one; their sizes by name where they are not."""
    different = {*sizes.values()}
    return sizes if len(different) > 1 else different.pop() if different else None


MOST_POINTS = 10_000  # of one shape, each of them a pick of one landmark in one image


def _pixels(file: InputFile, text: str) -> list[tuple[float, float]]:
    if (count := text.count(";") + 1) > MOST_POINTS:
        raise file.error(
            f"a shape of {count} points: {MOST_POINTS} at most are picks of a landmark"
        )
    try:
        pairs = [pair.split(",") for pair in text.split(";") if pair]
        return [(plain_number(u), plain_number(v)) for u, v in pairs]
    except ValueError as error:
        raise file.error(f"points {shown(text)}: {reason(error)}") from error


# LabelMe's JSON: one file an image, or a folder of them; pixels are counted from the corner


def recognises_labelme(file: InputFile) -> bool:
    """Tell whether it is JSON with shapes, or a folder with JSON in it."""
    if file.path.is_dir():
        return any(file.path.glob("*.json"))
    return file.head.lstrip().startswith("{") and '"shapes"' in file.text


def read_labelme(file: InputFile) -> PickRows:
    """Read the points of one or more LabelMe files."""
    paths = sorted(file.path.glob("*.json")) if file.path.is_dir() else [file.path]
    found: list[tuple[str, str, float, float]] = []
    others: list[str] = []
    sizes: Sizes = {}
    for path in paths:
        where = ""
        try:
            label = parse_json(open_input(path.name, path.parent).text)
            image = PurePosixPath(str(label["imagePath"]).replace("\\", "/")).as_posix()
            width, height = (plain_number(str(label[f"image{one}"])) for one in ("Width", "Height"))
            _add_size(file, sizes, image, whole_size(width, height))
            where = "shapes: "
            for k, shape in enumerate(label["shapes"], 1):
                where = f"shape {k}: "
                kind = shape.get("shape_type", "polygon")  # as LabelMe itself takes it
                if kind not in ("point", "points"):
                    others.append(kind if kind in NO_POINTS else "other shape")
                    continue
                others += [NO_PLACE] * (not shape["points"])
                name = _label(shape["label"])
                found += [(image, name, *_pair(point)) for point in shape["points"]]
        except (*UNEXPECTED, OSError) as error:
            text = f"{path.name}: not a LabelMe file: {where}{reason(error)}"
            raise VopdError(text) from error
    if not all(name for _, name, *_ in found):
        raise file.error("some points have no label: the label is the name of the landmark")
    if not found:
        raise file.error("no shape is a point: landmarks are drawn as points")
    short = _short_names(sizes)
    found = [(short[image], name, u, v) for image, name, u, v in found]
    sizes = {short[image]: size for image, size in sizes.items()}
    rows = _rows(found, "corner", _one_size(sizes), "LabelMe")
    return replace(rows, doubts=_left_out(file, others))


def _short_names(paths: Iterable[str]) -> dict[str, str]:
    """Name images without their folders, but those that these alone tell apart."""
    ends = {one: PurePosixPath(one).name for one in paths}
    count = Counter(ends.values())
    return {one: end if count[end] == 1 else one for one, end in ends.items()}


def _pair(point: object) -> tuple[float, float]:
    """Read u and v of a point of JSON, where a decimal comma makes one number of two.

    Raises:
        ValueError: if it has not two
    """
    if not isinstance(point, list) or len(point) != 2:
        raise ValueError(f"{shown(point)} is not a point, [u, v]; decimals take a point")
    return plain_number(str(point[0])), plain_number(str(point[1]))  # true is 1 for float()


def _label(value: object) -> str:
    """Read a label of JSON, a text or a number; empty for anything else."""
    return str(value) if isinstance(value, str | int | float) else ""


# The picks in a gcp_list.txt

recognises_gcp_picks = is_gcp_list


def read_gcp_picks(file: InputFile) -> PickRows:
    """Read the picks of a gcp_list.txt; pixels are counted from the first pixel's centre."""
    rows = read_gcp_list(file)
    sigma = np.full(len(rows.line), np.nan)
    return PickRows(
        Names(rows.image), Names(rows.name), rows.pixel, sigma, "centre", None,
        "gcp_list.txt",
    )  # fmt: skip


# The picks in OpenSfM's ground_control_points.json, by the image's longer side from its middle


MOST_PARTS = 5.0  # of the longer side, half of which is the image


def read_control_picks(file: InputFile) -> PickRows:
    """Read the observations of the points."""
    found = []
    for point in control_points(file):
        for one in point.get("observations", []):
            u, v = _pair(one["projection"])
            if max(abs(u), abs(v)) > MOST_PARTS:
                parts = "it counts from the image's middle by its longer side; is it in pixels?"
                raise file.error(f"{point['id']} in {one['shot_id']} at {u:g}, {v:g}: {parts}")
            found.append((str(one["shot_id"]), str(point["id"]), u, v))
    if not found:
        raise file.error("no point has observations")
    rows = _rows(found, "centre", None, "OpenSfM ground control")
    return replace(rows, by_size=True)


def _rows(
    found: list[Any], grid: str, size_px: tuple[int, int] | Sizes | None, said: str
) -> PickRows:
    """Make the rows of picks by image, landmark, u and v."""
    image, landmark, u, v = zip(*found, strict=True)
    unknown = np.full(len(u), np.nan)
    return PickRows(Names(image), Names(landmark), np.array([u, v]).T, unknown, grid, size_px, said)


# The picks in Metashape's XML of markers; pixels are counted from the corner


def read_marker_picks(file: InputFile) -> PickRows:
    """Read the projections that a person has set, which are pinned."""
    root, names = marker_tree(file)
    for chunk in root.iter("frames"):
        if (count := sum(one.find(".//location") is not None for one in chunk)) > 1:
            message = f"{count} frames have marks, of pictures under one camera's name"
            raise file.error(f"{message}: export a chunk of one frame")
    images = dict[str, str]()
    for one in root.findall(".//camera[@label]"):
        number, label = one.get("id", one.get("camera_id", "")), one.get("label", "")
        if images.setdefault(number, label) != label:
            raise file.error(f"camera {number} is {images[number]} and {label}: export one chunk")
    found, own = list[Any](), 0
    for marker in root.findall(".//marker[@marker_id]"):
        for place in marker.findall("location"):
            if {place.get("pinned"), place.get("valid")} & {*FALSE}:
                own += 1
                continue
            camera, name = place.get("camera_id", ""), names.get(marker.get("marker_id", ""))
            if camera not in images or name is None:
                raise file.error(f"camera {camera} or marker {name} has no label in the file")
            found.append((images[camera], name, *(plain_number(place.get(a, "")) for a in "xy")))
    if not found:
        raise file.error("no marker has a pinned projection")
    said = "Metashape markers" + (f", {own} that are not pinned left out" if own else "")
    return _rows(found, "corner", None, said)


# Clicks of CIRN's toolbox: gcp in a MATLAB file, UVd from (1, 1)


def recognises_cirn_picks(file: InputFile) -> bool:
    """Tell whether it is a file of MATLAB's."""
    return file.is_matlab


def read_cirn_picks(file: InputFile) -> PickRows:
    """Read the clicks of one image; a landmark's name is its number."""
    points = file.matlab("gcp").get("gcp")
    if points is None:
        raise file.error("it has no variable gcp, the clicks of CIRN's toolbox")
    found = [
        (
            str(one["imagePath"]).replace("\\", "/").rpartition("/")[2],
            f"{float(one['num']):g}",
            *map(float, one["UVd"]),
        )
        for one in (points if isinstance(points, list) else [points])
    ]
    return _rows(found, "one-based", None, "CIRN's clicks")


# Formats of files of picks, one row each; the next format is one more row

PICK_FORMATS: tuple[InputFormat[PickRows], ...] = (
    InputFormat("CVAT XML", recognises_cvat, read_cvat),
    InputFormat("LabelMe JSON or a folder of it", recognises_labelme, read_labelme),
    InputFormat("gcp_list.txt", recognises_gcp_picks, read_gcp_picks),
    InputFormat("OpenSfM ground_control_points.json", recognises_control, read_control_picks),
    InputFormat("Metashape XML of markers", recognises_markers, read_marker_picks),
    InputFormat("MATLAB file of CIRN's clicks", recognises_cirn_picks, read_cirn_picks),
    InputFormat("CSV (frame,landmark,u_px,v_px)", recognises_csv_picks, read_csv_picks, True),
)


HIDDEN = "# hidden: "
"""The beginning of a line that says of a frame and a landmark that it is not to be seen there."""

Click = tuple[str, str, float, float]
"""Frame or image, landmark, u and v in pixels from the centre of the first pixel."""


def read_clicks(file: InputFile) -> list[Click]:
    """Read picks that `vopd pick` goes on with.

    Raises:
        VopdError: where the file does not say how pixels are counted, or in parts of images
    """
    rows = read_by_content(PICK_FORMATS, file)
    if rows.by_size:
        raise file.error(
            "it counts in parts of the images' longer side: name it in [picks] file of a project, "
            "which says how large they are, and give that as FRAMES"
        )
    if rows.grid is None:
        raise file.error(
            "it does not say from where pixels are counted; if u and v are 0 at the centre of the "
            f"first pixel and v counts down, write as its first line: {CLICKS}"
        )
    return clicks_of(rows)


def clicks_of(rows: PickRows) -> list[Click]:
    """List the picks of a person, without those that a program interpolated."""
    kept = np.arange(len(rows.landmark))
    if rows.interpolated is not None:
        kept = kept[~rows.interpolated]
    frame, landmark = list(map(str, rows.frame)), list(rows.landmark)
    at = zip(kept.tolist(), rows.centred_px(kept).tolist(), strict=True)
    return [(frame[k], landmark[k], u, v) for k, (u, v) in at]


def read_hidden(file: InputFile) -> list[tuple[str, str]]:
    """Read which landmarks are marked as not to be seen: frame or image, and landmark."""
    lines = [one.removeprefix(HIDDEN) for one in file.text.splitlines() if one.startswith(HIDDEN)]
    return [(row[0], row[1]) for row in csv.reader(lines) if len(row) == 2]
