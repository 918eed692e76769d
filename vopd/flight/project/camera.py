"""The lens of a project, inline or from a file, and the lens that each image has."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.files import reason
from vopd.findings import VopdError, count_text, shown
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.image_lenses import IMAGE_LENS_FORMATS
from vopd.flight.formats.lens import (
    GRID_TO_CENTRE,
    LENS_FORMATS,
    LensQuestion,
    LensRead,
    coefficients_said,
    image_centre,
    make_lens,
    wrong_count_text,
)
from vopd.flight.project.keys import Project, Section
from vopd.geometry.lenses import MODELS, Lens, Lenses, LensKind
from vopd.video import find_images

if TYPE_CHECKING:
    from vopd.flight.formats.image_tags import ImageTags

# The lens: an inline table, or a file


def read_lens(project: Project) -> LensRead:
    """Read the lens of a project.

    Raises:
        VopdError: where it is missing, or its image size is not that of the project
    """
    section = project.section("camera")
    if section.has("camera") and isinstance(section.values.get("lens"), dict):
        raise section.error("camera", "is of a file with several cameras, and lens is a table")
    size = section.size("image_size_px")
    made_of = section.size("lens_size_px")
    if made_of is None:
        return _lens_of(project, section, size)
    if size is None:
        raise section.error("image_size_px", "is needed with lens_size_px")
    return _scaled(section, _lens_of(project, section, made_of), size)


def _one_shape(one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Tell whether two sizes are those of one picture, but for rounding to whole pixels."""
    ratio = one[0] / other[0]
    return abs(one[1] - other[1] * ratio) <= 0.6 * max(1.0, ratio)


def _scaled(section: Section, read: LensRead, size: tuple[int, int]) -> LensRead:
    """Scale a lens to images of another size: the distortion is of angles and stays."""
    lens = read.lens
    ratio = size[0] / lens.size_px[0]
    if not _one_shape(size, lens.size_px):
        (w, h), (width, height) = lens.size_px, size
        message = f"{w} x {h} is no larger or smaller picture of {width} x {height}: it was cropped"
        raise section.error("lens_size_px", message)
    scaled = replace(lens.scaled(ratio), size_px=size)
    in_px = ("focal", "centre_u", "centre_v")
    sigma = {name: one * (ratio if name in in_px else 1.0) for name, one in read.sigma.items()}
    w, h = lens.size_px
    said = f"{read.said}; a calibration of {w} x {h}, scaled by {ratio:.6g}"
    return LensRead(scaled, said, sigma)


def _lens_of(project: Project, section: Section, size: tuple[int, int] | None) -> LensRead:
    """Read a lens as it was calibrated, for images of this size."""
    model = section.text("model") if section.has("model") else None
    if isinstance(section.values.get("lens"), dict):
        inline = _inline(section, section.section("lens"), size)
        return _of_model(section, inline, model, "[camera] lens")
    file = project.open("camera", "lens")
    name = file.name
    camera = section.text("camera") if section.has("camera") else None
    found = read_by_content(LENS_FORMATS, file, LensQuestion(model, camera, size))
    if size is not None and found.lens.size_px != size:
        w, h = found.lens.size_px
        turned = " (turned by 90 degrees)" if (h, w) == size else ""
        key = "lens_size_px" if section.has("lens_size_px") else "image_size_px"
        scale = ""
        if key == "image_size_px" and size[0] != w and _one_shape(size, (w, h)):
            scale = f"; if yours are the same pictures in another size, lens_size_px = [{w}, {h}]"
        raise section.error(
            key,
            f"{size[0]} x {size[1]}, but {name} is a calibration for {w} x {h}{turned}; "
            f"a calibration serves the pictures that it was made of{scale}",
        )
    return _of_model(section, found, model, name)


OWN_MODEL = "leave this key out, and write the other one there if that is right"


def _of_model(section: Section, found: LensRead, model: str | None, name: str) -> LensRead:
    """Refuse a lens that says itself that it is of another model than is stated."""
    own = found.lens.kind.value
    if model not in (None, own):
        raise section.error("model", f"{model}, but {name} says {own} itself: {OWN_MODEL}")
    return found


def _inline(section: Section, table: Section, size: tuple[int, int] | None) -> LensRead:
    if size is None:
        raise section.error("image_size_px", "is needed with an inline lens")
    model = table.text("model")
    focal, assumed = _focal(table, size)
    middle = image_centre(size)
    centre = middle
    if table.has("cx_px") or table.has("cy_px"):
        grid = section.text("pixel_grid")
        shift = GRID_TO_CENTRE[grid]
        centre = table.number("cx_px") + shift, table.number("cy_px") + shift
        assumed += f", {grid} grid"
    else:
        assumed += ", principal point in the image's middle as none is given"
    by_table = model == LensKind.RADIAL_TABLE.value
    rows = _radial_table(table, focal) if by_table else None
    for key in ("k", "skew_px") if by_table else ("table_px",):
        if table.has(key) and table.values[key] != []:
            raise table.error(key, f"a lens of the model {model} has none: leave it out")
    k = table.numbers("k") if table.has("k") and table.values["k"] != [] else ()
    if len(k) not in MODELS[LensKind(model)].counts:
        raise table.error("k", wrong_count_text(len(k), LensKind(model)))
    skew, error = table.number("skew_px"), partial(section.error, "lens")
    lens = make_lens(model, size, focal, centre, k, skew, rows, error)
    what = "radial table" if by_table else coefficients_said(k, model)
    return LensRead(lens, f"lens: {what}{assumed}")


def _focal(table: Section, size: tuple[int, int]) -> tuple[tuple[float, float], str]:
    if table.has("focal_mm"):
        width, height = table.numbers("sensor_mm")
        if min(width, height) <= 0.0:
            raise table.error("sensor_mm", "is the sensor's width and height, both above 0")
        for key in [one for one in ("fx_px", "fy_px") if table.has(one)]:
            raise table.error("focal_mm", f"{key} is there too: give one of them")
        f = table.number("focal_mm")
        px = f * size[0] / width, f * size[1] / height
        if min(px) <= 1.0:
            message = f"{f:g} is {min(px):.3g} px of this sensor: are both in millimetres?"
            raise table.error("focal_mm", message)
        return px, ", focal length by the sensor's size"
    if not table.has("fx_px"):
        raise table.error("fx_px", "is needed, or focal_mm and sensor_mm")
    if table.has("sensor_mm"):
        raise table.error("sensor_mm", "is for focal_mm, and fx_px is in its place: leave it out")
    fx = table.number("fx_px")
    return (fx, table.number("fy_px", fx)), ""


def _radial_table(table: Section, focal: tuple[float, float]) -> Floats:
    """Read the table of radius and what is added to it; it begins at the centre with nothing."""
    rows = table.values.get("table_px")
    if (
        not isinstance(rows, list)
        or len(rows) < 2
        or not all(isinstance(row, list) and len(row) == 2 for row in rows)
    ):
        raise table.error("table_px", "is a list of [radius, what is added to it], two at least")
    try:
        values = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise table.error(
            "table_px", f"has something that is not a number: {reason(error)}"
        ) from error
    if not np.isfinite(values).all():
        raise table.error("table_px", "has a number that is not finite")
    if values[0, 0] > 0.0:
        values = np.vstack([[0.0, 0.0], values])
    if focal[0] != focal[1]:
        raise table.error("fy_px", "a radial table has one focal length: leave fy_px out")
    grow = np.diff(values, axis=0)
    if values[0].any() or not (grow[:, 0] > 0.0).all() or not (grow.sum(axis=1) > 0.0).all():
        raise table.error(
            "table_px", "begins with nothing at radius 0, and both radius and what comes out grow"
        )
    return values


# Images of several cameras


class CameraLens(NamedTuple):
    """The lens of a flight, or those of its images."""

    read: LensRead  # of all images, or the first of several
    table: InputFile | None = None  # which lens each image has; None: no table says it
    lenses: Mapping[str, Lens] = {}  # that, or all of the table, by what a sentence calls them
    of_image: Mapping[str, int] = {}  # which of them
    leaves_out: bool = False  # whether the table takes no lens from [camera] lens

    @property
    def lens(self) -> Lens:
        """The lens, or all of several."""
        if not self.several:
            return self.read.lens
        return Lenses.join(
            tuple(self.lenses.values()), np.array([*self.of_image.values()], np.int64)
        )

    @property
    def several(self) -> bool:
        """Whether not all images have the same lens."""
        return len(self.lenses) > 1

    def of_names(self, names: Sequence[str]) -> Lens:
        """Look up the lenses of images.

        Args:
            names: of images, or numbers of frames

        Raises:
            VopdError: where the table does not have one
        """
        if self.table is None:
            return self.read.lens
        found = find_images([*self.of_image], names)
        missing = [names[k] for k in np.flatnonzero(found < 0).tolist()]
        if missing:
            more = f" and {len(missing) - 1} more of the picks' images" if missing[1:] else ""
            first = f"frame {missing[0]}" if missing[0].isdigit() else missing[0]
            of_all = "" if self.several else ", or give [camera] lens, which is of all images"
            raise self.table.error(f"no row for {first}{more}: add its name and its lens{of_all}")
        return self.lens.of(found)


def read_camera(project: Project) -> CameraLens:
    """Read the lens of a project, or the lenses of its images.

    Raises:
        VopdError: where one is missing, or its image size is not that of the project
    """
    section = project.section("camera")
    if not section.has("of_images"):
        read = read_lens(project)
        return CameraLens(read, None, {"[camera] lens": read.lens})
    if project.section("solve").text("frames") == "one":
        raise section.error(
            "of_images", 'several cameras: [solve] frames = "one" is of one; leave it out'
        )
    table = project.open("camera", "of_images")
    rows = read_by_content(IMAGE_LENS_FORMATS, table)
    found: dict[tuple[str, str], LensRead] = {}
    of_image: dict[str, int] = {}
    for image, file, camera in zip(rows.image, rows.file, rows.camera, strict=True):
        own = file, camera
        if own not in found:
            if not file and not section.has("lens"):
                raise table.error(f"{shown(image)} has no file in lens, nor has [camera] lens one")
            lens = (Path(table.name).parent / file).as_posix() if file else ""
            of_this = project
            for key, one in (("lens", lens), ("camera", camera)):
                of_this = of_this.changed("camera", key, one) if one else of_this
            try:
                found[own] = read_lens(of_this)
            except VopdError as error:  # of a key that the project does not have
                text = str(error).removeprefix(f"{project.name}: [camera] lens: ")
                raise table.error(text) if file and text != str(error) else error from error
        if of_image.setdefault(image, [*found].index(own)) != [*found].index(own):
            raise table.error(f"{shown(image)} has two lenses")
    if not found:
        raise table.error("no image is in the file")
    first = next(iter(found.values()))
    said = f"{table.name}: {rows.said}, {count_text(len(of_image), 'image')}, " + (
        f"{count_text(len(found), 'lens', 'lenses')}; the first: {first.said}"
    )
    sigma = {
        name: max(_by_first(one, first).get(name, 0.0) for one in found.values())
        for name in dict.fromkeys(name for one in found.values() for name in one.sigma)
    }
    read = LensRead(first.lens, said, sigma)
    lenses = {
        f"{table.name}: {' '.join(filter(None, own))}": one.lens for own, one in found.items()
    }
    return CameraLens(read, table, lenses, of_image, all(rows.file))


def _by_first(read: LensRead, first: LensRead) -> dict[str, float]:
    """Write standard deviations of a lens for the first one: focal lengths in proportion."""
    ratio = float(first.lens.focal_px.mean() / read.lens.focal_px.mean())
    return {name: one * (ratio if name == "focal" else 1.0) for name, one in read.sigma.items()}


def check_size(section: Section, own: tuple[int, int], size: tuple[int, int], where: str) -> None:
    """Compare the size of an image with that of its lens."""
    (w, h), (width, height) = own, size
    turned = ": they were turned when they were picked" if (w, h) == (height, width) else ""
    if own != size:
        message = f"{where} {w} x {h}, the lens is for {width} x {height}{turned}"
        raise section.error("file", message)


OTHER_FOCAL = 1.3  # times that of a lens: tags are within a tenth of it


def doubts_of_tags(tags: Mapping[str, ImageTags], image: Sequence[str], lens: Lens) -> list[str]:
    """Warn of the first picked image that has another size, or focal length, than the lens.

    Args:
        tags: of the images that are the track, by their names
        image: the picked ones, perhaps with their folders
        lens: of all of them
    """
    for name in (PurePosixPath(one).name for one in image if tags):
        one = tags.get(name)
        if one is None:
            continue
        if one.size_px != lens.size_px:
            from vopd.flight.formats.photographs import other_size_text  # of few flights

            return [other_size_text("[track] file", name, one.size_px, lens.size_px)]
        ratio = one.focal_px / float(lens.focal_px.mean())  # NaN where no tag says it
        if max(ratio, 1.0 / ratio) > OTHER_FOCAL and lens.kind is not LensKind.FISHEYE:
            return [
                f"[track] file: {name} has a focal length of {one.focal_px:.0f} px by its "
                f"{one.focal_by}, and the lens has {lens.focal_px.mean():.0f}: is it the "
                "calibration of this camera, and of its zoom?"
            ]
    return []


OBLONG = 1.5  # fx_px by fy_px: pixels of 1440 x 1080 that are shown in 16:9 have 1.33
ASIDE = 0.1  # of a side: principal points are within some hundredths of the middle
ALIKE = 0.05  # of a side, by which the two parts of it differ in a smaller picture
TANGENTIAL = 0.03  # of p1 and p2: a lens has some thousandths, off its axis as it may be
SHORT = 0.1  # of the longer side: an image without the distortion of a fisheye is 157 degrees wide


def doubts_of_lens(lens: Lens, where: str) -> Iterator[str]:
    """Doubt a principal point far from the middle, oblong pixels, p1 and p2, a focal length in mm.

    Args:
        lens: one lens
        where: what a sentence calls it
    """
    wide, high = lens.size_px
    aside = np.abs(lens.centre_px + 0.5 - np.array(lens.size_px) / 2.0) / lens.size_px
    if (np.abs(lens.centre_px) <= 1.0).all():
        yield (
            "{}: the principal point {:g}, {:g} is in the corner of the image: was it "
            "set? Without cx_px and cy_px a table's is the image's middle"
        ).format(where, *lens.centre_px)
    elif (aside > ASIDE).any():
        (part, other), of = 2.0 * (lens.centre_px + 0.5) / lens.size_px, ""
        if abs(part - other) < ALIKE:
            part = (part + other) / 2.0
            of = f" It is the middle of {part * wide:.0f} x {part * high:.0f}."
        yield (
            f"{where}: the principal point {lens.centre_px[0]:g}, {lens.centre_px[1]:g} is "
            f"{aside.max():.0%} of the side from the middle of an image of {wide} x {high}: is it "
            f"of images of another size (lens_size_px), or cut off at a side?{of}"
        )
    (fx_px, fy_px), side_px = lens.focal_px.tolist(), max(lens.size_px)
    if max(fx_px, fy_px) > OBLONG * min(fx_px, fy_px):
        yield (
            f"{where}: fx_px = {fx_px:g} and fy_px = {fy_px:g}: pixels of most cameras are "
            "square; is one of the two something else? Numbers are FX,FY,CX,CY,K1,K2,P1,P2"
        )
    if lens.kind is LensKind.BROWN and (np.abs(lens.k[2:4]) > TANGENTIAL).any():
        yield (
            f"{where}: p1 = {lens.k[2]:g} and p2 = {lens.k[3]:g} are larger than those of lenses: "
            "the coefficients are k1, k2, p1, p2, k3, in this order"
        )
    if lens.kind is LensKind.BROWN and fx_px < SHORT * side_px:
        wide = np.rad2deg(2.0 * np.arctan(side_px / 2.0 / fx_px))
        yield (
            f"{where}: fx_px = {fx_px:g}: the image would be {wide:.0f} degrees wide; is "
            "that in pixels? focal_mm and sensor_mm take millimetres"
        )
