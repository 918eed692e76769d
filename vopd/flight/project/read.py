"""Read a project file and all files that it names into a flight."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints, in_four_bytes
from vopd.estimate import MapGrid
from vopd.files import reason
from vopd.findings import Finding, NeededError, count_text, first_of
from vopd.flight.coordinates import (
    crs_name,
    doubt_of_heights,
    earth_centred_positions,
    map_grid,
    outside_area,
)
from vopd.flight.flight import (
    CameraPath,
    Flight,
    LandmarkSet,
    Picks,
    Refraction,
    Shutter,
    VehicleAttitudes,
)
from vopd.flight.formats.files import InputFile, did_you_mean, read_by_content, shown
from vopd.flight.formats.landmarks import LANDMARK_FORMATS, LandmarkRows
from vopd.flight.formats.lens import (
    GRID_TO_CENTRE,
    IMAGE_LENS_FORMATS,
    LENS_FORMATS,
    LensQuestion,
    LensRead,
    coefficients_said,
    image_centre,
    make_lens,
)
from vopd.flight.formats.picks import LEAST_PX, PICK_FORMATS, SMALL_SIGMA, Names, PickRows
from vopd.flight.formats.wind import WIND_FORMATS
from vopd.flight.project.covariance import with_held, with_stated_offset
from vopd.flight.project.keys import ROWS, Project, Section, read_project
from vopd.flight.project.stated import (
    Notes,
    RowSigmas,
    flight_options,
    lines_to_add,
    refuse_missing,
    row_sigmas,
)
from vopd.flight.project.track import (
    FrameTimes,
    covering_text,
    frames_of,
    height_datum,
    number_frames,
    read_path,
)
from vopd.flight.project.unused import unused_keys
from vopd.flight.solve.free import check_free
from vopd.geometry.earth import geodetic
from vopd.geometry.lenses import MODELS, Lens, Lenses, LensKind
from vopd.geometry.rotations import DOWN, FORWARD, mount_by_angles
from vopd.inputs import LONGEST_NAME, MOST_NUMBER, beyond_sigmas

COPIED_PX = 1e-9  # between picks of one landmark in one frame
COPIED = (
    "picks of one landmark in one frame are the same to the last digit: if these are copies, "
    "remove them, for they make the angles look surer than they are"
)
NO_POSITION = "the track has no position for"
LONGEST_READOUT = 1.1  # of a rolling shutter, in the time from a frame to the next

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
    scaled = replace(
        lens,
        size_px=size,
        focal_px=lens.focal_px * ratio,
        centre_px=(lens.centre_px + 0.5) * ratio - 0.5,
        skew_px=lens.skew_px * ratio,
        table=None if lens.table is None else lens.table * ratio,
    )
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


def _of_model(section: Section, found: LensRead, model: str | None, name: str) -> LensRead:
    """Refuse a lens that says itself that it is of another model than is stated."""
    own = found.lens.kind.value
    if model not in (None, own):
        raise section.error("model", f"{model}, but {name} says {own} itself: leave this key out")
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
    found = _radial_table(table, size, focal, centre) if by_table else None
    for key in ("k", "skew_px") if by_table else ("table_px",):
        if table.has(key) and table.values[key] != []:
            raise table.error(key, f"a lens of the model {model} has none: leave it out")
    if found is not None:
        return LensRead(found, f"lens: radial table{assumed}")
    k = table.numbers("k") if table.has("k") and table.values["k"] != [] else ()
    counts = MODELS[LensKind(model)].counts
    if len(k) not in counts:
        raise table.error(
            "k", f"{count_text(len(k), 'coefficient')}; {', '.join(map(str, counts))} are known"
        )
    skew = table.number("skew_px")
    lens = make_lens(model, size, focal, centre, k, skew)
    return LensRead(lens, f"lens: {coefficients_said(k, model)}{assumed}")


def _focal(table: Section, size: tuple[int, int]) -> tuple[tuple[float, float], str]:
    if table.has("focal_mm"):
        width, height = table.numbers("sensor_mm")
        if min(width, height) <= 0.0:
            raise table.error("sensor_mm", "is the sensor's width and height, both above 0")
        for key in [one for one in ("fx_px", "fy_px") if table.has(one)]:
            raise table.error("focal_mm", f"{key} is there too: give one of them")
        f = table.number("focal_mm")
        return (f * size[0] / width, f * size[1] / height), ", focal length by the sensor's size"
    if not table.has("fx_px"):
        raise table.error("fx_px", "is needed, or focal_mm and sensor_mm")
    if table.has("sensor_mm"):
        raise table.error("sensor_mm", "is for focal_mm, and fx_px is in its place: leave it out")
    fx = table.number("fx_px")
    return (fx, table.number("fy_px", fx)), ""


def _radial_table(
    table: Section, size: tuple[int, int], focal: tuple[float, float], centre: tuple[float, float]
) -> Lens:
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
    return Lens(
        LensKind.RADIAL_TABLE, size, np.array(focal), np.array(centre), np.zeros(0), 0.0, values
    )


# Images of several cameras


class CameraLens(NamedTuple):
    """The lens of a flight, or those of its images."""

    read: LensRead  # of all images, or the first of several
    table: InputFile | None = None  # which lens each image has; None: no table says it
    lenses: tuple[Lens, ...] = ()  # of the table
    of_image: Mapping[str, int] = {}  # which of them

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
        missing = [name for name in names if name not in self.of_image]
        if missing:
            more = f" and {len(missing) - 1} more of the picks' images" if missing[1:] else ""
            first = f"frame {missing[0]}" if missing[0].isdigit() else missing[0]
            of_all = "" if self.several else ", or give [camera] lens, which is of all images"
            raise self.table.error(f"no row for {first}{more}: add its name and its lens{of_all}")
        if not self.several:
            return self.read.lens
        return Lenses.join(self.lenses, np.array([self.of_image[name] for name in names], np.int64))


def read_camera(project: Project) -> CameraLens:
    """Read the lens of a project, or the lenses of its images.

    Raises:
        VopdError: where one is missing, or its image size is not that of the project
    """
    section = project.section("camera")
    if not section.has("of_images"):
        return CameraLens(read_lens(project))
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
            found[own] = read_lens(of_this)
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
    return CameraLens(read, table, tuple(one.lens for one in found.values()), of_image)


def _by_first(read: LensRead, first: LensRead) -> dict[str, float]:
    """Write standard deviations of a lens for the first one: focal lengths in proportion."""
    ratio = float(first.lens.focal_px.mean() / read.lens.focal_px.mean())
    return {name: one * (ratio if name == "focal" else 1.0) for name, one in read.sigma.items()}


# Picks: on one grid, and each landmark once a frame

APART = 20.0  # standard deviations between picks of one point that cannot both be right


POINTS_AT_ONCE = 100_000
ONLY_CLICKS = (
    "only the frames with clicks are solved; vopd track follows the clicks through the video"
)


def read_pick_rows(project: Project, camera: CameraLens) -> PickRows:
    """Read all picks of a project, with their standard deviations and how pixels are counted.

    Raises:
        VopdError: where the grid is not known, a pick is not finite, or the images are not those
            of the lens
    """
    section = project.section("picks")
    if section.has("tracked_from") and not section.has("tracked"):
        raise section.error("tracked_from", "is of the key tracked, which is missing")
    tracked, not_yet = section.has("tracked"), ""
    if tracked and section.text("tracked_from") == "clicks":
        from vopd.flight.project.tracked_picks import read_tracked_picks  # of few flights

        if camera.several:
            message = "picks tracked from clicks are of one camera's video: give [camera] lens"
            raise project.section("camera").error("of_images", message)
        name = section.text("tracked")
        if (project.folder / name).exists() or not section.has("file"):
            return read_tracked_picks(project, camera.read.lens.size_px)
        tracked, not_yet = False, f"{name} is not there: {ONLY_CLICKS}"
        require_clicks(project)
    file = project.open("picks", "tracked" if tracked else "file")
    rows = project.read("picks", file, PICK_FORMATS)
    frames = rows.frame.known if isinstance(rows.frame, Names) else []
    _refuse_long(file, [*rows.landmark.known, *frames])
    if tracked:
        rows = replace(rows, interpolated=np.ones(len(rows.landmark), bool))
    elif section.text("interpolated") == "drop" and rows.interpolated is not None:
        rows = rows.where(~rows.interpolated)
    finite = np.isfinite(rows.pixel).all(axis=1)
    if not finite.all():
        k = int(np.argmin(finite))
        raise file.error(f"{rows.landmark[k]} in {rows.frame[k]}: u or v is not finite")
    far = np.abs(rows.pixel).max(axis=1, initial=0.0)
    if (far > MOST_NUMBER).any():
        k = int(np.argmax(far))
        raise file.error(f"{rows.landmark[k]} in {rows.frame[k]}: {far[k]:g} px is too large")
    size_px = _sizes_px(section, file, rows, camera)
    if rows.by_size:
        long = size_px.max(axis=-1, keepdims=True)
        rows = replace(rows, pixel=rows.pixel * long + (size_px - 1.0) / 2.0)
    grid = rows.grid or section.text("pixel_grid")
    if section.has("pixel_grid") and section.text("pixel_grid") != grid:
        raise section.error("pixel_grid", f"{rows.said} has the {grid} grid: leave the key out")
    way = section.text("v")
    up_from = size_px[..., 1] - 1.0 if way == "up" else None
    stated = section.number("sigma_px")
    if beyond := beyond_sigmas([stated]):
        raise section.error("sigma_px", beyond)
    own = np.isfinite(rows.sigma_px)
    sigma = np.where(own, rows.sigma_px, stated) if own.any() else np.broadcast_to(stated, own.size)
    said = f"{file.name}: {rows.said}, {count_text(len(sigma), 'pick')}, {grid} grid, v {way}"
    known = section.has("sigma_px") or bool(own.any())
    rows = replace(rows, grid=grid, up_from=up_from, sigma_px=sigma, stated=known, said=said)
    return replace(rows, doubts=(*rows.doubts, not_yet)) if not_yet else rows


def require_clicks(project: Project) -> None:
    """Check that the file of clicks is there.

    Raises:
        VopdError: with the command that makes the page to click on
    """
    section = project.section("picks")
    clicks = section.text("file")
    if not (project.folder / clicks).exists():
        raise section.error(
            "file",
            f"{clicks} is not there: vopd pick {project.name} -o pick.html makes the page to click "
            f"on, and your browser saves {clicks} among its downloads: move it to {project.folder}",
        )


def _sizes_px(section: Section, file: InputFile, rows: PickRows, camera: CameraLens) -> Floats:
    """Look up the size of the picks' image by its lens, (2,), or of each pick's (P, 2).

    Raises:
        VopdError: where an image has another size than its lens
    """
    if not camera.several:
        if isinstance(rows.size_px, dict):
            message = "the images are not all of one size: name the lens of each image in "
            raise file.error(f"{message}[camera] of_images")
        own, size = rows.size_px, camera.read.lens.size_px
        _check_size(section, own or size, size, f"{file.name} has images of")
        return camera.read.lens.by_rows("size_px")
    names = rows.frame if isinstance(rows.frame, Names) else Names(map(str, rows.frame.tolist()))
    every = camera.of_names(names.known).by_rows("size_px")
    for name, (width, height) in zip(names.known, every.astype(int).tolist(), strict=True):
        own = rows.size_px.get(name) if isinstance(rows.size_px, dict) else rows.size_px
        _check_size(section, own or (width, height), (width, height), f"{file.name}: {name} has")
    return np.asarray(every[names.which])


def _check_size(section: Section, own: tuple[int, int], size: tuple[int, int], where: str) -> None:
    """Compare the size of an image with that of its lens."""
    (w, h), (width, height) = own, size
    turned = ": they were turned when they were picked" if (w, h) == (height, width) else ""
    if own != size:
        message = f"{where} {w} x {h}, the lens is for {width} x {height}{turned}"
        raise section.error("file", message)


def join_picks(
    read: PickRows,
    frame_label: Callable[[int], str],
    landmarks: tuple[str, ...],
    project: str,
) -> tuple[Picks, list[Finding]]:
    """Join the picks by landmark, several of one point in one frame averaged.

    Picks of a landmark that the project does not have, and picks of one point that
    contradict each other, take no part and are told.

    Args:
        read: the picks, `frame` the index of its frame for each
        frame_label: what to call a frame, by its index
        landmarks: the names of the landmarks
        project: the project's name, for findings
    """
    frame, names = np.asarray(read.frame), read.landmark
    own_of, findings = known_landmarks(names, landmarks, project)
    rows, first = by_point(frame, own_of[names.which])
    count = np.diff(first)
    mean, sigma = _means(read, rows, first)
    own, frame = own_of[names.which[rows[first[:-1]]]], frame[rows[first[:-1]]]
    several = np.flatnonzero(count > 1)  # points picked several times
    again = rows[np.repeat(count > 1, count)]
    inverse = np.repeat(np.arange(len(several)), count[several])
    away = read.centred_px(again) - mean[several][inverse]
    expected = read.sigma_px[again]
    by_spread = not read.stated and 2 * len(several) > len(count)  # most points tell it
    if by_spread:
        variance = np.bincount(inverse, (away**2).sum(axis=1)) / (2.0 * (count[several] - 1))
        expected = np.maximum(expected, np.sqrt(np.median(variance)))
    contrary = _contrary(away, expected, inverse, len(several))
    for k in np.flatnonzero(contrary):
        point = several[k]
        label, name = frame_label(int(frame[point])), landmarks[own[point]]
        apart = 2.0 * np.hypot(*away[inverse == k].T).max()
        message = (
            f"{label}: {name} is picked {count[point]} times, up to {apart:.0f} px apart; "
            f"{NONE_USED}"
        )
        findings.append(Finding(message, project, severity="warning"))
    freedom = 2.0 * (count[several[~contrary]] - 1).sum()
    squares = (away[~contrary[inverse]] ** 2).sum()
    repeatability = float(np.sqrt(squares / freedom)) if freedom else float("nan")
    usual = _usual(read)
    if by_spread and repeatability > LARGE_SPREAD_PX:
        message = (
            f"picks of one landmark in one frame differ by {repeatability:.0f} px, root mean "
            "square: are several frames under one name, or has the camera turned between them?"
        )
        findings.append(Finding(message, project, severity="warning"))
    if by_spread and repeatability > 0.0:
        sigma *= repeatability / usual["one_sigma_px"]
        usual["one_sigma_px"] = repeatability
    followed = None
    if read.interpolated is not None:
        followed = np.logical_or.reduceat(read.interpolated[rows], first[:-1])
    absurd = np.flatnonzero((np.abs(mean) > MOST_PX).any(axis=1))
    for point in absurd:
        label, (u, v) = frame_label(int(frame[point])), mean[point]
        message = f"{label}: {landmarks[own[point]]} at {u:g}, {v:g} is in no image; not used"
        findings.append(Finding(message, project, severity="warning"))
    kept = np.ones(len(count), bool)
    kept[several[contrary]] = kept[absurd] = False
    picks = Picks(
        frame=frame[kept],
        landmark=own[kept],
        pixel=mean[kept],
        sigma_px=sigma[kept],
        repeatability_px=repeatability,
        v_up=read.up_from is not None,
        followed=None if followed is None else followed[kept],
        unused=frozenset({*own.tolist()} - {*own[kept].tolist()}),
        **usual,
    )
    return picks, findings


def known_landmarks(
    names: Names, landmarks: tuple[str, ...], project: str
) -> tuple[Ints, list[Finding]]:
    """Look up the landmarks that are picked, and warn of those that the project does not have.

    Args:
        names: of the picks
        landmarks: the names of the project's
        project: the project's name, for findings

    Returns:
        The index of each of `names.known`, -1 for one that is not known, and the warnings.
    """
    index = {name: k for k, name in enumerate(landmarks)}
    picked_of, findings = np.bincount(names.which).tolist(), []
    for name, picked in sorted(zip(names.known, picked_of, strict=True)):
        if name not in index:
            many = count_text(picked, "pick")
            message = f"{NO_LANDMARK} {name} ({many}){did_you_mean(name, landmarks[:20])}"
            findings.append(Finding(message, project, severity="warning"))
    return in_four_bytes(np.array([index.get(name, -1) for name in names.known])), findings


LARGE_SPREAD_PX = 10.0  # of picks of one landmark in one frame: no hand is so unsure
NONE_USED = "none of these picks is used"
MOST_PX = 1e6  # from the image's middle: squares of such a pick would hide all others

NO_LANDMARK = "no landmark"
"""How a warning about picks of an unknown landmark begins."""


def by_point(frame: Ints, own: Ints) -> tuple[Ints, Ints]:
    """Sort the picks of known landmarks by frame and landmark, those of one point together.

    Args:
        frame: index of each pick's frame, (P,)
        own: index of each pick's landmark, -1 where it is not known, (P,)

    Returns:
        The indices of the picks, and where in them each point begins, and the last one ends.
    """
    rows = np.lexsort((own, frame))
    rows = in_four_bytes(rows)
    if own.min(initial=0) < 0:
        rows = rows[own[rows] >= 0]
    new = np.ones(len(rows) + 1, bool)
    new[1:-1] = (np.diff(frame[rows]) != 0) | (np.diff(own[rows]) != 0)
    return rows, in_four_bytes(np.flatnonzero(new))


def _means(read: PickRows, rows: Ints, first: Ints) -> tuple[Floats, Floats]:
    """Average the picks of each point by weight, (points, 2), with their sigmas (points,)."""
    points = len(first) - 1
    mean, sigma = np.empty((points, 2)), np.empty(points)
    for k in range(0, points, POINTS_AT_ONCE):
        end = min(k + POINTS_AT_ONCE, points)
        some, start = rows[first[k] : first[end]], first[k:end] - first[k]
        weight = read.sigma_px[some] ** -2.0
        total = np.add.reduceat(weight, start)
        weighted = np.add.reduceat(weight[:, None] * read.centred_px(some), start)
        mean[k:end] = weighted / total[:, None]
        sigma[k:end] = total**-0.5
    return mean, sigma


def _usual(read: PickRows) -> dict[str, Any]:
    """Estimate the usual sigma of one pick; a smaller one than stated is not believed."""
    usual = float(np.median(read.sigma_px)) if len(read.sigma_px) else 1.0
    return {"one_sigma_px": usual} | (
        {"least_sigma_px": usual, "stated": True} if read.stated else {}
    )


def _contrary(away: Floats, sigma: Floats, inverse: Ints, points: int) -> Bools:
    """Find points with a pick that is too far from the mean of its picks, (points,)."""
    far = np.hypot(*away.T) > APART / 2.0 * sigma
    return np.asarray(np.bincount(inverse[far], minlength=points) > 0)


# The flight of a project file


def _name(section: Section) -> str:
    """Read the name of a flight, one line: exports and cards have one line for it.

    Raises:
        VopdError: where it has control characters
    """
    name = section.text("name")
    if not name.isprintable():
        raise section.error("name", f"{shown(name)} has control characters: write one line")
    return name


def read_flight(name: str, location: str | None = None) -> Flight:
    """Read the flight of a project file.

    Args:
        name: the path of the project file, `flight.toml`
        location: where it is, if not under its name

    Raises:
        VopdError: where a key or a file is not as it should be
    """
    return flight_of(read_project(name, location))


def flight_of(project: Project, rows: PickRows | None = None) -> Flight:
    """Read the files of a project whose keys have been read.

    Args:
        project: its sections
        rows: picks that take the place of its own

    Raises:
        VopdError: where a value or a file is not as it should be; all values that are missing are
            named at once
    """
    try:
        return _flight_of(project, rows)
    except NeededError as error:
        from vopd.flight.project.new import open_keys  # what no file says, as for a new project

        keys = open_keys(project)
        if len(keys) < 2 or all(ROWS[one].kind == "sigma" for one in keys):
            raise
        raise NeededError(
            f"{project.name}: {len(keys)} values are needed that no file has. Add these lines, "
            f"with values of your own:\n{lines_to_add(keys)}"
        ) from error


@np.errstate(all="ignore")
def _flight_of(project: Project, given: PickRows | None) -> Flight:
    name = project.name
    camera_lens = read_camera(project)
    lens, picks = camera_lens.read, given or read_pick_rows(project, camera_lens)
    number, times, index = frames_of(project, picks)
    one = _all_as_one(project)
    flight_name, frames = _name(project.section("flight")), len(number)
    if one:
        noun = "image" if times.image else "frame"
        flight_name += f"{', ' if flight_name else ''}{count_text(frames, noun)} solved as one"
        number, times, index = number[:1], _first(times), np.zeros_like(index)
    picks = replace(picks, frame=index)
    notes = Notes([], {})
    rows, landmarks = _landmarks(project, notes)
    path = read_path(with_stated_offset(project), times)
    times = path.times
    refuse_missing(project, notes.missing | path.missing)
    _one_datum(project)

    def label(k: int) -> str:
        return "all frames" if one else times.image[k] if times.image else f"frame {number[k]}"

    if picks.tracks is not None:
        if one:
            message = '"one" is for picks of a camera that does not turn, not for tracked ones'
            raise project.section("solve").error("frames", message)
        from vopd.flight.project.tracked_picks import hidden_marks, join_tracks  # likewise

        hidden = hidden_marks(project, landmarks.name)
        joined, findings = join_tracks(picks, number, landmarks.name, name, hidden)
        clicked, of_clicks = _join_clicks(project, camera_lens, landmarks.name)
        joined = replace(joined, unused=clicked - {*joined.landmark.tolist()})
        findings += [one for one in of_clicks if one not in findings]
    else:
        joined, findings = join_picks(picks, label, landmarks.name, name)
        if joined.repeatability_px < COPIED_PX:
            findings.append(Finding(COPIED, name, severity="warning"))
    camera, wind_said, wind_doubts = add_wind(project, path.path)
    crs = landmark_crs(project.section("landmarks"), rows)
    outside = outside_area(crs, landmarks.position_m)
    doubts = [*picks.doubts, *times.doubts, *path.doubts, *wind_doubts]
    doubts += [f"[landmarks] crs: {outside}"] if outside else []
    doubts += doubt_of_heights("landmarks", rows.said, crs)
    if (sigma_px := project.section("picks").number("sigma_px")) < LEAST_PX:
        doubts.append(f"[picks] sigma_px: {sigma_px:g} {SMALL_SIGMA}")
    if camera_lens.table is None:
        doubts += doubts_of_lens(lens.lens)
    shutter, rate_hz = shutter_of(project.section("camera")), _frame_rate_hz(project, times)
    if shutter is not None and rate_hz and shutter.readout_s * rate_hz > LONGEST_READOUT:
        frame = f"a frame of {1e3 / rate_hz:.4g} ms"
        doubts.append(
            f"[camera] readout_ms: {1e3 * shutter.readout_s:g} is longer than {frame}: write the "
            "milliseconds from the first row to the last, 10 to 30 of most cameras, or the frames' "
            "own [picks] frame_rate_hz"
        )
    findings += [Finding(doubt, name, severity="warning") for doubt in doubts]
    findings += frames_uncovered(project, camera, times, label)
    findings += [Finding(one, name, severity="warning") for one in unused_keys(project)]
    refraction = refraction_of(project.section("atmosphere"))
    offset_s = project.section("track").number("offset_s") if project.has("track") else 0.0
    flight = Flight(
        name=flight_name,
        source=name,
        lens=camera_lens.of_names(times.image or [str(one) for one in number.tolist()]),
        frame=number,
        image_name=times.image,
        time_s=times.time_s,
        epoch=times.epoch,
        picks=joined,
        landmarks=landmarks,
        path=camera,
        mount=mount_of(project.section("vehicle")),
        mount_sigma_deg=(project.section("vehicle").sigma("mount_sigma_deg") or (0.0,))[0],
        vehicle=_vehicle(project, offset_s),
        refraction=refraction,
        shutter=shutter,
        frame_rate_hz=rate_hz,
        offset_s=offset_s,
        options=flight_options(project, lens, refraction, camera, landmarks),
        own_level=project.section("landmarks").values.get("height") == "same",
        grid=landmark_grid(project, rows, camera),
        folder=project.folder,
        video=_video(project),
        about=(
            *(lens.said, picks.said),
            *filter(None, [times.said]),
            *(*notes.said, *path.said, *wind_said),
        ),
        findings=tuple(findings),
    )
    check_free(flight)
    return with_held(project, flight)


def _join_clicks(
    project: Project, camera: CameraLens, landmarks: tuple[str, ...]
) -> tuple[frozenset[int], list[Finding]]:
    """Join the clicks that a tracked file was made of, to tell which take no part.

    Returns:
        The landmarks that are clicked, by their indices, and what `vopd track` has said of clicks.
    """
    section = project.section("picks")
    if not (section.has("file") and (project.folder / section.text("file")).exists()):
        return frozenset(), []
    rows = read_pick_rows(project.without("picks", "tracked", "tracked_from"), camera)
    number, image, index = number_frames(rows.frame)

    def label(k: int) -> str:
        return image[k] if image else f"frame {number[k]}"

    joined, findings = join_picks(replace(rows, frame=index), label, landmarks, project.name)
    return joined.unused | {*joined.landmark.tolist()}, findings


def _frame_rate_hz(project: Project, times: FrameTimes) -> float | None:
    """Look up the rate by which numbered frames have times."""
    section = project.section("picks")
    if not section.has("frame_rate_hz"):
        return None
    return section.number("frame_rate_hz")


def _video(project: Project) -> tuple[Path, ...]:
    """Find the files of the video that was picked in."""
    section = project.section("picks")
    names = section.files("video") if section.has("video") else ()
    return tuple(project.folder / name for name in names)


def _all_as_one(project: Project) -> bool:
    """Tell whether all frames are one, which is so for a camera that does not move."""
    section = project.section("solve")
    one = section.text("frames") == "one"
    if one and not project.has("position"):
        raise section.error("frames", '"one" is for a camera that does not move: give [position]')
    return one


SHORT = 0.1  # of the longer side: an image without the distortion of a fisheye is 157 degrees wide


def doubts_of_lens(lens: Lens) -> Iterator[str]:
    """Doubt a principal point at pixel 0, 0, and a focal length as short as one in millimetres."""
    if (np.abs(lens.centre_px) <= 1.0).all():
        yield (
            "[camera] lens: the principal point {:g}, {:g} is in the corner of the image: was it "
            "set? Without cx_px and cy_px a table's is the image's middle"
        ).format(*lens.centre_px)
    fx_px, side_px = float(lens.focal_px[0]), max(lens.size_px)
    if lens.kind is LensKind.BROWN and fx_px < SHORT * side_px:
        wide = np.rad2deg(2.0 * np.arctan(side_px / 2.0 / fx_px))
        yield (
            f"[camera] lens: fx_px = {fx_px:g}: the image would be {wide:.0f} degrees wide; is "
            "that millimetres? focal_mm and sensor_mm take those"
        )


def _first(times: FrameTimes) -> FrameTimes:
    return times._replace(time_s=times.time_s[:1], image=times.image[:1])


def _landmarks(project: Project, notes: Notes) -> tuple[LandmarkRows, LandmarkSet]:
    section = project.section("landmarks")
    file = project.open("landmarks")
    rows = read_by_content(LANDMARK_FORMATS, file)
    if not rows.name:
        raise file.error("no landmark is in the file")
    _refuse_long(file, rows.name)
    doubled = [name for name, count in Counter(rows.name).items() if count > 1]
    if doubled:
        name = sorted(doubled)[0]
        at = [rows.line[k] for k, one in enumerate(rows.name) if one == name]
        where = f", in lines {at[0]} and {at[1]}" if at[0] else ""
        raise file.error(f"{name} has two positions{where}")
    crs = landmark_crs(section, rows)
    datum = height_datum(section)
    where = f"{section.project}: [landmarks]"
    position = earth_centred_positions(rows.coordinate, rows.geodetic, crs, datum, where)
    check = set(_known_names(project.section("solve"), "check_landmarks", rows.name))
    system = crs or "WGS 84"
    if system.startswith("+"):  # which a spreadsheet would take for a formula
        system = f"PROJ {system}"
    said = f"{file.name}: {rows.said}, {count_text(len(rows.name), 'landmark')}, {system}"
    if datum is not None:
        said += f", {datum.said}"
    notes.said.append(said)
    own = RowSigmas(file.name, rows.sigma_m, len(rows.name), rows.line, rows.sigma_by)
    sigma_m = row_sigmas(section, "sigma_m", own, notes)
    used = tuple(name not in check for name in rows.name)
    return rows, LandmarkSet(tuple(rows.name), position, sigma_m, used, rows.patch_px)


def _refuse_long(file: InputFile, names: Iterable[str]) -> None:
    """Refuse names that no message could show."""
    longest = max(names, key=len, default="")
    if len(longest) > LONGEST_NAME:
        line = file.line_of(longest)
        raise file.error(f"a name of {len(longest)} characters: {LONGEST_NAME} at most", line)


def landmark_crs(section: Section, rows: LandmarkRows) -> str | None:
    """Choose the coordinate reference system of landmarks: the file's, or the project's."""
    if rows.crs is not None:
        if section.has("crs") and crs_name(section.text("crs")) != crs_name(rows.crs):
            raise section.error("crs", f"the file says {rows.crs}: leave the key out")
        return rows.crs
    if rows.geodetic and not section.has("crs"):
        return None
    return section.text("crs")


def _known_names(section: Section, key: str, known: list[str]) -> tuple[str, ...]:
    """Check a list of names that must all be known."""
    found, there = section.texts(key), set(known)
    for name in found:
        if name not in there:
            raise section.error(key, f"there is no landmark {name}{did_you_mean(name, known[:20])}")
    return found


def _one_datum(project: Project) -> None:
    """Refuse heights of one unknown datum on one side only."""
    where = "track" if project.has("track") else "position"
    given = [project.section(name).values.get("height") for name in ("landmarks", where)]
    from_ground = isinstance(given[1], dict) and "ground_m" in given[1]
    same = [height == "same" for height in given]
    if same[0] != same[1] and not from_ground:
        raise project.section("landmarks" if same[0] else where).error(
            "height", f'"same" must stand in [landmarks] and in [{where}], or in neither'
        )


WIND_BEYOND_M = 500.0  # of the wind's levels: how far away they are is said
FASTEST_WIND_M_S = 150.0  # faster than any jet stream


def add_wind(project: Project, path: CameraPath) -> tuple[CameraPath, list[str], list[str]]:
    """Interpolate the wind at the camera's heights.

    Returns:
        The path with it, sentences about the sounding, and what is doubtful of it.
    """
    if not project.has("wind"):
        return path, [], []
    rows = read_by_content(WIND_FORMATS, project.open("wind"))
    if path.velocity_m_s is None:
        message = "is of no use: the velocity is not known without a track by time"
        raise project.section("wind").error("file", message)
    height, level = geodetic(path.position_m).height_m, rows.height_m
    wind = np.stack([np.interp(height, level, w) for w in rows.toward_m_s.T], axis=1)
    said = f"{rows.said}, linear in height, the last level held beyond the ends"
    doubts = []
    beyond = np.fmax(level[0] - height, height - level[-1])
    if (beyond > WIND_BEYOND_M).any():
        doubts.append(
            f"[wind] file: its levels are {level[0]:.0f} to {level[-1]:.0f} m high, the camera is "
            f"{np.nanmin(height):.0f} to {np.nanmax(height):.0f} m: the nearest level is taken, up "
            f"to {np.nanmax(beyond):.0f} m away"
        )
    fastest = float(np.linalg.norm(rows.toward_m_s, axis=1).max())
    if fastest > FASTEST_WIND_M_S:
        doubts.append(
            f"[wind] file: {fastest:.4g} m/s is no wind: are its speeds in the unit that is named?"
        )
    (sigma_m_s,) = project.section("wind").sigma("sigma_m_s") or (0.0,)
    return replace(path, wind_m_s=wind, wind_sigma_m_s=sigma_m_s), [said], doubts


def frames_uncovered(
    project: Project, path: CameraPath, times: FrameTimes, label: Callable[[int], str]
) -> list[Finding]:
    """Warn of frames that have no time, or for which the track has no position."""
    by_time, lost = path.row_s is not None, np.isnan(path.position_m[:, 0])
    untimed = lost & by_time & np.isnan(times.time_s)
    messages = []
    for some, what in ((untimed, "there is no time for"), (lost & ~untimed, NO_POSITION)):
        if some.any():
            labels = [label(k) for k in np.flatnonzero(some).tolist()]
            messages.append(f"{what} {first_of(labels, 3)}")
    if path.row_s is not None and (lost & ~untimed).any():
        offset_s = project.section("track").number("offset_s")
        messages[-1] += covering_text(path.row_s, times.time_s, offset_s)
    return [Finding(one, project.name, severity="warning") for one in messages]


def mount_of(section: Section) -> Floats:
    """Read the rotation from camera axes to body axes."""
    if isinstance(section.values.get("mount", ""), str):
        return {"forward": FORWARD, "down": DOWN}[section.text("mount")]
    inside = section.section("mount")
    if inside.has("ypr_deg") == inside.has("matrix"):
        raise section.error("mount", "give either ypr_deg or matrix")
    if inside.has("ypr_deg"):
        ypr_deg = inside.numbers("ypr_deg")
        if not (np.abs(ypr_deg) <= 360.0).all():
            raise inside.error("ypr_deg", "yaw, pitch and roll are -360 to 360 degrees")
        return mount_by_angles(ypr_deg)
    rows = inside.values.get("matrix")
    try:
        matrix = np.array(rows, dtype=np.float64)
        numbers = {type(one) for row in rows or [] for one in row} <= {int, float}
        square = numbers and matrix.shape == (3, 3)
        turn = square and np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6)
    except (TypeError, ValueError, OverflowError):
        turn = False
    if not turn or np.linalg.det(matrix) < 0.0:
        raise inside.error("matrix", "is not a rotation: three rows of three, right-handed")
    u, _, vt = np.linalg.svd(matrix)
    return np.asarray(u @ vt)


def _vehicle(project: Project, offset_s: float) -> VehicleAttitudes | None:
    """Read the vehicle's attitudes, as far as a file of them is named."""
    if not project.section("vehicle").has("attitude"):
        return None
    from vopd.flight.mounting import read_vehicle

    return read_vehicle(project, offset_s)


def shutter_of(section: Section) -> Shutter | None:
    """Read the rolling shutter of `[camera]`; None if there is none."""
    if not section.has("readout_ms"):
        for key in ("readout", "frame_time"):
            if section.has(key):
                raise section.error(key, "is of a rolling shutter: give readout_ms too")
        return None
    middle = section.text("frame_time") == "middle"
    return Shutter(section.number("readout_ms") * 1e-3, section.text("readout"), middle)


def refraction_of(section: Section) -> Refraction:
    """Read the refraction from `[atmosphere]`."""
    if isinstance(section.values.get("refraction"), dict):
        return Refraction(section.section("refraction").number("k"), False)
    standard = section.text("refraction") == "standard"
    return Refraction() if standard else Refraction(0.0, False)


def landmark_grid(project: Project, rows: LandmarkRows, path: CameraPath) -> MapGrid | None:
    """Project the camera's positions on the grid of the landmarks' CRS, if it has one."""
    crs = landmark_crs(project.section("landmarks"), rows)
    return None if crs is None else map_grid(crs_name(crs), path.position_m)
