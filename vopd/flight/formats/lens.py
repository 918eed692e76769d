"""Lens files: mrcal, Metashape, OpenSfM, OpenCV, Kalibr, COLMAP, MATLAB."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from vopd.arrays import Floats
from vopd.files import optional_package, reason
from vopd.findings import VopdError, count_text, first_of, shown
from vopd.flight.formats.by_content import InputFormat
from vopd.flight.formats.files import UNEXPECTED, InputFile
from vopd.geometry.lenses import MODELS, Lens, LensKind
from vopd.inputs import (
    MOST_SETTINGS,
    MOST_SIGMA,
    check_yaml,
    is_number,
    plain_number,
    too_many_bytes,
    twice,
    whole_number,
)

# Lenses of numbers, on the grid whose (0, 0) is the first pixel's centre

GRID_TO_CENTRE = {"centre": 0.0, "corner": -0.5, "one-based": -1.0}
"""What is added to u and v of a grid, by its name, to count from the first pixel's centre."""


class LensQuestion(NamedTuple):
    """What the project says of a lens besides the file."""

    model: str | None = None  # brown or fisheye, where the file cannot say
    camera: str | None = None  # which camera of a file with several
    size_px: tuple[int, int] | None = None


class LensRead(NamedTuple):
    """A lens, and a sentence about what was read."""

    lens: Lens
    said: str
    sigma: Mapping[str, float] = {}  # standard deviations of its parameters, where the file has any


MOST_PX = 1e9  # of a focal length, centre or size; no camera has more


def make_lens(
    model: str,
    size_px: Sequence[float],
    focal: Sequence[float] | Floats,
    centre: Sequence[float] | Floats,
    k: Sequence[float] = (),
    skew_px: float = 0.0,
    table: Floats | None = None,
    error: Callable[[str], VopdError] = VopdError,
) -> Lens:
    """Build a lens from numbers, and check that they can be those of one.

    Args:
        model: one of `LensKind`
        size_px: width and height
        focal: fx, fy, pixels
        centre: cx, cy, pixels from the first pixel's centre
        k: coefficients in OpenCV's order, as many as there are
        skew_px: of u by yd
        table: of radii, where the model has one
        error: makes one of the place where the numbers stand

    Raises:
        VopdError: where they cannot
    """
    width, height = size_px
    kind, size = LensKind(model), whole_size(width, height, error)
    coefficients = np.zeros(max(MODELS[kind].counts))
    coefficients[: len(k)] = k
    numbers = np.array([*focal, *centre, *coefficients, skew_px], float)
    if not np.isfinite(numbers).all():
        raise error("the lens has a number that is not finite")
    if (largest := max(np.abs(numbers).max(), *size)) > MOST_PX:
        raise error(f"the lens has a number of {largest:g}: {MOST_PX:.0e} at most")
    if min(size) < 1:
        raise error("the image's size is {} x {} px".format(*size))
    if not min(focal) > 1.0:
        raise error(f"focal length {min(focal):g} px: is it in pixels?")
    return Lens(kind, size, numbers[:2], numbers[2:4], coefficients, skew_px, table)


def whole_size(
    width: float, height: float, error: Callable[[str], Exception] = ValueError
) -> tuple[int, int]:
    """Make the size of an image of two numbers, or an error where one is not whole."""
    if width % 1.0 != 0.0 or height % 1.0 != 0.0:  # NaN too
        raise error(f"{width:.10g} x {height:.10g} is no size of an image: whole pixels")
    return int(width), int(height)


def image_centre(size_px: Sequence[float]) -> tuple[float, float]:
    """Find the middle of the image, pixels from the first pixel's centre."""
    return (size_px[0] - 1) / 2.0, (size_px[1] - 1) / 2.0


def coefficients_said(k: Sequence[float], model: str) -> str:
    """Count the coefficients, for a sentence."""
    count = len(k)
    named = "no distortion" if not count else count_text(count, "coefficient")
    return f"{model}, {named}"


def wrong_count_text(count: int, kind: LensKind) -> str:
    """Say how many coefficients a lens of that kind can have, and in which order."""
    counts = MODELS[kind].counts
    said = f"{count_text(count, 'coefficient')}; {', '.join(map(str, counts))} are known"
    if kind is not LensKind.BROWN or count > counts[-1]:
        return said
    return f"{said}, in OpenCV's order k1, k2, p1, p2, k3, ...: write 0 for one that is not there"


def refuse_camera(file: InputFile, question: LensQuestion) -> None:
    """Refuse the name of a camera where the file has one, which has no name."""
    if question.camera is not None:
        raise file.error(f"it has one camera: leave [camera] camera, {question.camera}, out")


# mrcal's .cameramodel: a Python dict of literals, pixels from the first pixel's centre

MOST_MRCAL = 20_000  # commas, of which a model of splines has some thousand; Python takes 1 kB each
KEYS_MRCAL = "lensmodel", "lens_model", "distortion_model"  # of the model, as versions write it
COUNTS_MRCAL = {"PINHOLE": 0, "OPENCV4": 4, "OPENCV5": 5, "OPENCV8": 8, "OPENCV12": 12}


def recognises_mrcal(file: InputFile) -> bool:
    """Tell whether the text names a lens model of mrcal's."""
    return "LENSMODEL_" in file.text or "DISTORTION_OPENCV" in file.text


def read_mrcal(file: InputFile, question: LensQuestion) -> LensRead:
    """Read the lens of a .cameramodel."""
    refuse_camera(file, question)
    if file.text.count(",") > MOST_MRCAL:
        raise file.error(f"not a mrcal camera model: more than {MOST_MRCAL} numbers and keys")
    try:
        tree = ast.parse(file.text.strip(), mode="eval")
        found = ast.literal_eval(tree)
        names = [str(found[key]) for key in KEYS_MRCAL if key in found] or ["None"]
        kind, *kinds = (
            one.removeprefix("LENSMODEL_").removeprefix("DISTORTION_").replace("NONE", "PINHOLE")
            for one in names
        )
        values = [plain_number(str(value)) for value in found["intrinsics"]]
        width, height = (plain_number(str(value)) for value in found["imagersize"])
    except (*UNEXPECTED, SyntaxError, MemoryError) as error:  # the last by deep nesting
        raise file.error(f"not a mrcal camera model: {reason(error)}") from error
    own = tree.body.keys if isinstance(tree.body, ast.Dict) else []
    if message := twice(str(one.value) for one in own if isinstance(one, ast.Constant)):
        raise file.error(message)
    if kind not in COUNTS_MRCAL:
        raise file.error(f"model {names[0]} is not known; LENSMODEL_ {', '.join(COUNTS_MRCAL)} are")
    if {*kinds} - {kind}:
        raise file.error(f"models {' and '.join(names)} differ: leave one out")
    if len(values) != 4 + COUNTS_MRCAL[kind]:
        raise file.error(f"{names[0]} has {4 + COUNTS_MRCAL[kind]} intrinsics, not {len(values)}")
    size, k = (width, height), values[4:]
    lens = make_lens("brown", size, values[:2], values[2:4], k, error=file.error)
    said = f"{file.name}: mrcal, {coefficients_said(values[4:], 'brown')}, centre grid"
    return LensRead(lens, said)


# Agisoft Metashape's XML: a calibration file, or the cameras of a project
#
# Its centre is counted from the middle of the image, p1 and p2 are exchanged against
# OpenCV's, and b2 is a skew.


def recognises_metashape(file: InputFile) -> bool:
    """Tell whether it is XML with a calibration that is not OpenCV's."""
    return "<calibration" in file.text and "opencv" not in file.text


def read_metashape(file: InputFile, question: LensQuestion) -> LensRead:
    """Read the lens; of two calibrations of a sensor the adjusted one."""
    root = file.xml()
    inside, sensors = root, root.findall(".//sensor")
    if sensors:
        ids, names = ([one.get(key, "") for one in sensors] for key in ("id", "label"))
        names = ids if question.camera in ids else names
        inside = sensors[names.index(_chosen(file, names, question, "name one by its label"))]
    else:
        refuse_camera(file, question)
    found = inside.findall("calibration") or ([root] if root.tag == "calibration" else [])
    found = [one for one in found if one.get("class") == "adjusted"] or found[-1:]
    if not found:
        raise file.error("no calibration is in the file")
    return _calibration(file, found[0], inside)


def _calibration(
    file: InputFile, found: ElementTree.Element, inside: ElementTree.Element
) -> LensRead:
    def number(name: str) -> float:
        text = found.findtext(name)
        try:
            return plain_number(text) if text is not None else 0.0
        except ValueError as error:
            raise file.error(f"{shown(text)} is not a number", column=name) from error

    if message := twice(one.tag for one in found):
        raise file.error(message)
    kind = found.findtext("projection") or found.get("type") or inside.get("type") or "frame"
    if kind.strip() != "frame":
        raise file.error(f"projection {kind.strip()} is not known; frame is")
    if number("k4"):
        raise file.error("k4 is of the eighth power, which no model here has: calibrate without")
    for name in ("p3", "p4"):
        if number(name):
            raise file.error(f"{name} is of a model that is not here: calibrate without p3 and p4")
    for one in found:
        text = (one.text or "").strip()
        if one.tag not in OF_METASHAPE and is_number(text) and plain_number(text):
            known = ", ".join(OF_METASHAPE[:10])
            raise file.error(f"{shown(one.tag)} is not known: a calibration has {known}")
    sizes = [(number("width"), number("height"))] * (found.find("width") is not None)
    for resolution in (found.find("resolution"), inside.find("resolution")):
        if resolution is not None:
            wide, high = (plain_number(resolution.get(key, "0")) for key in ("width", "height"))
            sizes.append((wide, high))
    width, height = sizes[0] if sizes else (0.0, 0.0)
    for other in sizes:
        if other != (width, height):
            several = "{:g} x {:g} and {:g} x {:g}".format(width, height, *other)
            raise file.error(f"{several} are sizes of one camera's images: leave one out")
    if not (width and height):
        raise file.error("the image's width and height are missing")
    f = number("f")
    for name, side in (("cx", width), ("cy", height)):
        if abs(number(name)) > side / 4.0:
            raise file.error(
                f"{name} is far from the image's middle: is it counted from the corner?"
            )
    lens = make_lens(
        "brown",
        (width, height),
        (f + number("b1"), f),
        (width / 2.0 + number("cx") - 0.5, height / 2.0 + number("cy") - 0.5),
        [number("k1"), number("k2"), number("p2"), number("p1"), number("k3")],
        number("b2"),
        error=file.error,
    )
    said = f"{file.name}: Metashape, frame, p1 and p2 exchanged, corner grid"
    sigma = _calibration_sigma(file, found)
    if sigma:
        said += f"; standard deviations of {', '.join(sigma)}, without their correlations"
    return LensRead(lens, said, sigma)


OF_METASHAPE = (
    "f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "p1", "p2", "k4", "p3", "p4", "width", "height",
    "projection", "date", "resolution", "covariance",
)  # fmt: skip
"""Elements of a calibration, those of the lens first."""
METASHAPE_PARAMETERS = {
    "f": "focal", "cx": "centre_u", "cy": "centre_v", "k1": "k1", "k2": "k2", "k3": "k3",
    "p1": "p2", "p2": "p1",
}  # fmt: skip
"""Names of parameters here by those of a calibration's covariance."""


def _calibration_sigma(file: InputFile, found: ElementTree.Element) -> dict[str, float]:
    """Read the roots of the diagonal of a calibration's covariance; none if there is none."""
    names = (found.findtext("covariance/params") or "").lower().split()
    if not names:
        return {}
    try:
        coefficients = (found.findtext("covariance/coeffs") or "").split()
        values = np.array([*map(plain_number, coefficients)])
        variance = np.diagonal(values.reshape(len(names), len(names)))
    except ValueError as error:
        message = f"the covariance is not a matrix of {len(names)} rows and columns"
        raise file.error(message, column="covariance") from error
    if not (variance >= 0.0).all() or not np.isfinite(variance).all():
        raise file.error("a variance is below 0 or not finite", column="covariance")
    if (np.sqrt(variance) > MOST_SIGMA).any():
        message = f"a variance is above {MOST_SIGMA**2:g}: calibrate again, or leave it out"
        raise file.error(message, column="covariance")
    sigma = dict(zip(names, np.sqrt(variance).tolist(), strict=True))
    return {ours: sigma[own] for own, ours in METASHAPE_PARAMETERS.items() if own in sigma}


# OpenSfM's and ODM's cameras.json: numbers by the image's longer side, from its centre

MOST_FRACTION = 100.0  # of the longer side: a picture half a degree wide; more is in pixels
MOST_SHIFT = 1.0  # of the longer side from the middle: a principal point far outside the image
BROWN = ("k1", "k2", "p1", "p2", "k3")
FISHEYE = ("k1", "k2", "k3", "k4")
MODELS_OPENSFM = {  # model here, keys of the coefficients in OpenCV's order
    "perspective": ("brown", ("k1", "k2")),
    "simple_radial": ("brown", ("k1",)),
    "radial": ("brown", ("k1", "k2")),
    "brown": ("brown", BROWN),
    "fisheye": ("fisheye", ("k1", "k2")),
    "fisheye_opencv": ("fisheye", FISHEYE),
}


def recognises_opensfm(file: InputFile) -> bool:
    """Tell whether it is JSON that speaks of a focal length and a size, and not of a matrix."""
    text = file.text.lstrip()
    sized = text[:1] in "{[" and '"width"' in text and '"focal' in text
    return sized and ('"projection_type"' in text or not recognises_opencv(file))


def read_opensfm(file: InputFile, question: LensQuestion) -> LensRead:
    """Read the lens of a cameras.json, or of the cameras in a reconstruction.json."""
    found = file.json()
    parts = every = found if isinstance(found, list) else [found]
    if question.camera is None:
        parts = parts[:1]
    cameras: dict[str, Any] = {}  # the first reconstruction is the largest
    for part in reversed(parts):
        cameras |= part.get("cameras", part)
    how = "name one of its keys"
    if any("shots" in part for part in parts):
        how = f"{OF_SHOTS}, or {how}"
    name = _chosen(file, list(cameras), question, how)
    read = _camera(file, name, cameras[name])
    known = (part.get("cameras") for part in every if isinstance(part, dict))
    each = [own[name] for own in known if isinstance(own, dict) and name in own]
    if any(one != cameras[name] for one in each):
        said = f"{read.said}, as the first of {len(each)} reconstructions has it"
        return read._replace(said=said)
    return read


OF_SHOTS = "[camera] of_images in the place of lens gives each image its own"
"""Advice about a reconstruction of several cameras, which says whose shots are whose."""


def _chosen(file: InputFile, names: Sequence[str], question: LensQuestion, how: str) -> str:
    """Choose the camera that the project names, or the only one.

    Args:
        file: of the cameras
        names: of the cameras
        question: what is asked for
        how: to name one of several
    """
    if not names:
        raise file.error("it has no camera")
    if question.camera is None:
        if len(names) > 1:
            raise file.error(f"{len(names)} cameras: {how} with [camera] camera")
        return names[0]
    if names.count(question.camera) != 1:
        known = first_of([shown(name) for name in names], MOST_NAMED)
        raise file.error(f"no camera {shown(question.camera)}: it has {known}")
    return question.camera


MOST_NAMED = 5  # cameras in a message


def _camera(file: InputFile, name: str, camera: dict[str, Any]) -> LensRead:
    kind = camera.get("projection_type", "perspective")
    if kind not in MODELS_OPENSFM:
        raise file.error(
            f"projection {kind} is not known; {', '.join(MODELS_OPENSFM)} are", column=name
        )

    def number(key: str, default: object = None) -> float:
        value = camera[key] if default is None else camera.get(key, default)
        return plain_number(str(value))  # JSON's true is 1 for float()

    try:
        size_px = number("width"), number("height")
        focal = number("focal_x" if "focal_x" in camera else "focal")
        focals = focal, number("focal_y", focal)
        two_focals = {"focal", "focal_x"} <= {*camera} and number("focal") not in focals
        model, keys = MODELS_OPENSFM[kind]
        k = [number(key, 0.0) for key in keys]
        foreign = [key for key in OF_OPENCV if key not in keys and number(key, 0.0)]
        shift = number("c_x", 0.0), number("c_y", 0.0)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise file.error(
            f"a camera needs width, height, focal as numbers: {reason(error)}",
            column=name,
        ) from error
    if foreign:
        has = ", ".join(keys)
        raise file.error(
            f"{foreign[0]} is of another projection than {kind}, which has {has}: name that one as "
            "projection_type",
            column=name,
        )
    if two_focals:
        raise file.error("focal and focal_x differ: leave one out", column=name)
    if max(focals) > MOST_FRACTION:
        raise file.error(
            f"focal {max(focals):g} is more than {MOST_FRACTION:g} times the image's longer side, "
            f"by which it counts: is it in pixels? write {max(focals) / max(1, *size_px):.4g}",
            column=name,
        )
    if max(map(abs, shift)) > MOST_SHIFT:
        raise file.error(
            f"c_x, c_y = {shift[0]:g}, {shift[1]:g}: they count from the image's middle by its "
            "longer side; are they in pixels?",
            column=name,
        )
    scale = max(size_px)
    middle = image_centre(size_px)
    lens = make_lens(
        model,
        size_px,
        (focals[0] * scale, focals[1] * scale),
        (shift[0] * scale + middle[0], shift[1] * scale + middle[1]),
        k,
        error=file.error,
    )
    said = f"{file.name}: OpenSfM, {kind}, from the image's centre"
    return LensRead(lens, said)


# OpenCV's FileStorage: .yml, .yaml, .xml and .json with a camera matrix and coefficients
#
# Also ROS camera_info, which has the same keys and names its model.

MATRIX = ("camera_matrix", "cameramatrix", "mtx", "k", "m1", "m", "intrinsic_matrix")
COEFFICIENTS = (
    "distortion_coefficients",
    "distcoeffs",
    "dist_coeffs",
    "dist_coeff",
    "dist",
    "d",
    "d1",
)
MODELS_OPENCV = {
    "plumb_bob": "brown",
    "rational_polynomial": "brown",
    "equidistant": "fisheye",
    "kannala_brandt": "fisheye",
    "fisheye": "fisheye",
}
COUNTS_OPENCV = MODELS[LensKind.BROWN].counts
OTHER_COEFFICIENTS = re.compile(
    r"(dist|\w*(distortion|dist_?coe|radial|tangential|coeff))(?!\w*(model|type)$)|[kp][1-6]$"
)
OTHER_FOCAL = re.compile(r"focal|f[xy]?(_|$)")
OF_OPENCV = (*BROWN, "k4", "k5", "k6", "s1", "s2", "s3", "s4")
PAIRS = ("image_width", "image_height"), ("width", "height")
SIZES = "image_size", "imagesize", "img_size", "resolution"  # width and height, or the reverse
SMALLEST_PX = 64  # fewer are the squares of a board
BINNING = "binning_x", "binning_y"
SIDES = "rows", "cols"  # how many of them a matrix has
LEVELS = 3  # of lists in lists: a matrix has two; deeper ones are refused
MOST = 100  # elements of a camera matrix or of a list of coefficients


def recognises_opencv(file: InputFile) -> bool:
    """Tell whether the text names a camera matrix."""
    return bool(
        re.search(r"camera_?matrix|opencv[-_](?:matrix|storage)|\bmtx\b[\"']?\s*:", file.text, re.I)
    )


def read_opencv(file: InputFile, question: LensQuestion) -> LensRead:
    """Read the lens of an OpenCV file."""
    own = [(_key(key), one) for key, one in _mapping(file).items()]
    if message := twice(key for key, _ in own):
        raise file.error(message)
    values = _of_one(file, dict(own), question)
    needed = (*MATRIX, *COEFFICIENTS, *PAIRS[0], *SIZES)
    if empty := [key for key in needed if key in values and values[key] is None]:
        raise file.error("nothing stands behind it", column=empty[0])
    matrix = _numbers(file, _first(file, values, MATRIX, "camera matrix"))
    listed = _first(file, values, COEFFICIENTS, "distortion coefficients", needed=False)
    k = _coefficients(file, listed, question)
    for key in values if not {*COEFFICIENTS} & {*values} else ():
        if OTHER_COEFFICIENTS.match(key):
            wanted = "distortion_coefficients: [k1, k2, p1, p2, k3]"
            raise file.error(f"{key} is not known: write {wanted}")
    if len(matrix) != 9:
        raise file.error(f"the camera matrix has {len(matrix)} elements, not 9")
    if matrix[6:] != [0.0, 0.0, 1.0]:
        third = "{:g} {:g} {:g}".format(*matrix[6:])
        turned = ", its third column is" * (matrix[2::3] == [0.0, 0.0, 1.0])
        message = f"the camera matrix's third row is {third}, not 0 0 1{turned}"
        raise file.error(f"{message}: write its rows as fx 0 cx, 0 fy cy, 0 0 1")
    if matrix[3]:
        raise file.error(f"the camera matrix has {matrix[3]:g} in the place of 0 before fy")
    model = _model(file, values, question, k)
    if any(_numbers(file, values.get("xi", []))):
        raise file.error(
            "xi is of the omnidirectional model, which no lens here has: calibrate as a fisheye"
        )
    if model == "fisheye" and len(k) != 4:
        raise file.error(f"a fisheye has 4 coefficients, not {len(k)}")
    if len(k) not in COUNTS_OPENCV:
        raise file.error(
            wrong_count_text(len(k), LensKind.BROWN)
            + (" (a tilted sensor is not)" if len(k) == 14 else "")
        )
    size_px = _size(file, values, question)
    if size_px is None:
        raise file.error("the image's size is not in the file: give [camera] image_size_px")
    centre, skew = (matrix[2], matrix[5]), matrix[1]
    lens = make_lens(model, size_px, (matrix[0], matrix[4]), centre, k, skew, error=file.error)
    said = f"{file.name}: OpenCV, {coefficients_said(k, model)}, centre grid"
    said += f", a skew of {skew:g} px" if skew else ""
    others = [name for names in (MATRIX, COEFFICIENTS) for name in _there(values, names)[1:]]
    for key in (*filter(OTHER_FOCAL.match, values), *(k for k in others if len(k) <= LETTERS)):
        said += f"; its {shown(key)} is not used beside the matrix"
    return LensRead(lens, said)


def _coefficients(file: InputFile, value: Any, question: LensQuestion) -> list[float]:
    """Read coefficients in OpenCV's order, or by names where they are keys."""
    if not isinstance(value, dict) or "data" in value:
        return _numbers(file, value)
    named = {str(key).lower(): one for key, one in value.items()}
    of_fisheye = {*named} == {*FISHEYE} and question.model != "brown"
    order = FISHEYE if of_fisheye else OF_OPENCV
    if other := [key for key in named if key not in order]:
        raise file.error(f"coefficient {shown(other[0])} is not known; {', '.join(order)} are")
    last = max((order.index(key) + 1 for key in named), default=0)
    count = next(one for one in COUNTS_OPENCV if one >= last)
    return _numbers(file, [named.get(key, 0.0) for key in order[:count]])


def _size(
    file: InputFile, values: dict[str, Any], question: LensQuestion
) -> Sequence[float] | None:
    """Look up the size of the images that a camera was calibrated with; None if it is not known."""
    sides = {
        wide: [plain_number(str(values[key])) for key in (wide, high)]
        for wide, high in PAIRS
        if {wide, high} <= {*values}
    }
    sides = {k: two for k, two in sides.items() if k == PAIRS[0][0] or min(two) >= SMALLEST_PX}
    lists = {key: values[key] for key in SIZES if isinstance(values.get(key), list | dict)}
    listed = {k: two for k, one in lists.items() if len(two := _numbers(file, one)) == 2}
    several = sides | {k: two for k, two in listed.items() if min(two) >= SMALLEST_PX}
    first, *others = several or [""]
    for other in others:
        if sorted(several[other]) != sorted(several[first]):
            raise file.error(f"{first} and {other} differ: leave one out")
    if sides:
        return sides[first]
    if question.size_px:
        stated = sorted(map(float, question.size_px))
        return next((two for two in listed.values() if sorted(two) != stated), question.size_px)
    return question.size_px


def _of_one(file: InputFile, values: dict[str, Any], question: LensQuestion) -> dict[str, Any]:
    """Take the values of one camera: of two, M1, D1 and M2, D2, that which the project names."""
    if "m2" not in values:
        refuse_camera(file, question)
        roi = values.get("roi")
        own = {key: values.get(key) for key in BINNING} | (roi if isinstance(roi, dict) else {})
        for key in (*BINNING, "x_offset", "y_offset"):
            if str(own.get(key)).strip() not in ("None", "0", "1" * (key in BINNING)):
                message = f"{key} {shown(own[key])}: the pictures are not what was calibrated"
                raise file.error(f"{message}: give the matrix of the pictures, and leave it out")
        return values
    if question.camera not in ("1", "2"):
        raise file.error('2 cameras, M1 and M2: name one, [camera] camera = "1" or "2"')
    rest = {key: one for key, one in values.items() if key not in ("m1", "m2", "d1", "d2")}
    chosen = ((key, f"{key}{question.camera}") for key in ("m", "d"))
    return rest | {key: values[own] for key, own in chosen if own in values}


def _model(file: InputFile, values: dict[str, Any], question: LensQuestion, k: list[float]) -> str:
    named = values.get("distortion_model", "")
    named = named.strip() if isinstance(named, str) else shown(named)
    if named:
        if named not in MODELS_OPENCV:
            raise file.error(f"distortion model {named}; known are {', '.join(MODELS_OPENCV)}")
        model = MODELS_OPENCV[named]
        if "fisheye_model" in values and (model == "fisheye") != bool(
            plain_number(str(values["fisheye_model"]))
        ):
            raise file.error(f"distortion_model {named} and fisheye_model differ: leave one out")
        return model
    if "fisheye_model" in values:
        return "fisheye" if float(values["fisheye_model"]) else "brown"
    if question.model is not None:
        return question.model
    if len(k) == 4:
        raise file.error(
            "four coefficients are k1 k2 p1 p2 or those of a fisheye, and the file does not say "
            'which: give [camera] model = "brown" or "fisheye"'
        )
    return "brown"


def _there(values: Mapping[str, Any], names: tuple[str, ...]) -> list[str]:
    """List those of some names that are keys of a file."""
    return [name for name in names if name in values]


def _first(
    file: InputFile, values: dict[str, Any], names: tuple[str, ...], what: str, needed: bool = True
) -> Any:
    there = _there(values, names)
    if needed and not there:
        raise file.error(f"no {what}: looked for {', '.join(names)}")
    for other in [name for name in there[1:] if len(name) > LETTERS]:
        if _numbers(file, values[other]) != _numbers(file, values[there[0]]):
            raise file.error(f"{there[0]} and {other} differ: leave one out")
    return values[there[0]] if there else []


LETTERS = 2  # of names that may be something else beside another


def _numbers(file: InputFile, value: Any) -> list[float]:
    """Read the elements of a matrix, row by row, from a mapping with `data`, or nested lists."""
    sides = list[int]()
    if isinstance(value, dict):
        sides = [whole_number(str(value[side])) for side in SIDES if side in value]
        value = value.get("data", [])
    flat: list[Any] = [value]
    for _ in range(LEVELS):  # YAML has lists that hold themselves
        rows = [one if isinstance(one, list | tuple) else [one] for one in flat]
        if sum(map(len, rows)) > MOST:
            raise file.error(f"a matrix has more than {MOST} elements")
        flat = [x for row in rows for x in row]
    if any(isinstance(one, list | tuple | dict) for one in flat):
        raise file.error("a matrix is a list of numbers, or of rows of numbers: one is neither")
    if len(sides) == len(SIDES) and len(flat) != prod(sides):
        message = "a matrix of {} x {} has {}".format(*sides, count_text(len(flat), "number"))
        raise file.error(f"{message}: correct rows and cols, or data")
    try:
        return [
            plain_number(str(one).lower().replace(".nan", "nan").replace(".inf", "inf"))
            for one in flat
        ]
    except ValueError as error:
        raise file.error(f"a matrix element is not a number: {reason(error)}") from error


def _key(own: object) -> str:
    """Write a key of a file in lower case, without what is unseen before and behind it."""
    return re.sub(r"^\W+|\W+$", "", str(own).lower())


def _mapping(file: InputFile) -> dict[str, Any]:
    text = file.text.lstrip()
    if text.startswith("<"):
        return _xml(file)
    found = file.json() if text.startswith("{") else _yaml(file)
    if not isinstance(found, dict):
        raise file.error("no keys are in the file")
    return found


def _xml(file: InputFile) -> dict[str, Any]:
    root = file.xml()
    if message := twice(one.tag for one in root):
        raise file.error(message)
    found: dict[str, Any] = {}
    for one in root:
        data = one.find("data")
        parts = {side: one.findtext(side) for side in SIDES if one.find(side) is not None}
        numbers = [] if data is None else (data.text or "").split()
        found[one.tag] = (one.text or "").strip() if data is None else {**parts, "data": numbers}
    return found


def _yaml(file: InputFile) -> Any:
    yaml = optional_package("yaml", "yaml", "a lens in YAML")

    safe: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

    class Loader(safe):  # type: ignore[misc]
        """Reads OpenCV's tag for matrices as a mapping, and no merge keys.

        A few lines of merge keys in each other are gigabytes; OpenCV writes none.
        """

        def flatten_mapping(self, node: object) -> None: ...

        def construct_mapping(self, node: Any, deep: bool = False) -> Any:
            """Read a mapping, each key of which stands there once."""
            keys = (str(key.value) for key, _ in node.value if isinstance(key, yaml.ScalarNode))
            if message := twice(keys):
                raise yaml.constructor.ConstructorError(None, None, message, node.start_mark)
            return super().construct_mapping(node, deep)

        def construct_yaml_int(self, node: Any) -> Any:
            """Read a whole number, of which YAML takes 0640 and 10:40 for others."""
            text = self.construct_scalar(node)
            return int(text) if re.fullmatch(r"[-+]?\d+", text, re.ASCII) else text

        def construct_yaml_float(self, node: Any) -> Any:
            """Read a number, of which YAML takes 10:40.5 for another."""
            text = self.construct_scalar(node)
            return text if {*"_:"} & {*text} else super().construct_yaml_float(node)

    Loader.add_constructor("tag:yaml.org,2002:int", Loader.construct_yaml_int)
    Loader.add_constructor("tag:yaml.org,2002:float", Loader.construct_yaml_float)
    Loader.add_constructor(
        "tag:yaml.org,2002:opencv-matrix",
        lambda loader, node: loader.construct_mapping(node, deep=True),
    )
    text = re.sub(r"\A%YAML[: ].*\n", "", file.text)
    if len(text) > MOST_SETTINGS:
        raise file.error(too_many_bytes(MOST_SETTINGS))
    try:
        check_yaml(yaml.parse(text, Loader=safe))
        return yaml.load(text, Loader=Loader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise file.error(f"not valid YAML: {reason(error)}") from error


# Kalibr's camchain.yaml: cameras by name, pixels from the first pixel's centre

MODELS_KALIBR = {"radtan": "brown", "equidistant": "fisheye", "none": "brown"}


def recognises_kalibr(file: InputFile) -> bool:
    """Tell whether a line has the key of distortion coefficients, and the text intrinsics."""
    return bool(re.search(r"^[ \t]+distortion_coeffs[ \t]*:", file.text, re.M)) and (
        "intrinsics" in file.text
    )


def read_kalibr(file: InputFile, question: LensQuestion) -> LensRead:
    """Read the lens of a camchain.yaml; of several cameras that which the project names."""
    cameras = {str(name): one for name, one in _mapping(file).items() if isinstance(one, dict)}
    name = _chosen(file, [*cameras], question, "name one, as cam0,")
    camera = cameras[name]
    models = [shown(camera.get(key, "none")) for key in ("camera_model", "distortion_model")]
    bent = str(camera.get("distortion_model", "none"))
    if camera.get("camera_model") != "pinhole" or bent not in MODELS_KALIBR:
        message = f"camera model {models[0]} with distortion {models[1]} is not read"
        known = "pinhole-radtan or pinhole-equi"
        raise file.error(f"{message}: let Kalibr calibrate the camera as {known}", column=name)
    focal_and_centre = _numbers(file, camera.get("intrinsics", []))
    k = _numbers(file, camera.get("distortion_coeffs", []))
    size = _numbers(file, camera.get("resolution", []))
    for key, found, count in (
        ("intrinsics", focal_and_centre, 4),
        ("distortion_coeffs", k, 0 if bent == "none" else 4),
        ("resolution", size, 2),
    ):
        if len(found) != count:
            raise file.error(
                f"{key} has {count_text(len(found), 'number')}, not {count}", column=name
            )
    focal, centre = focal_and_centre[:2], focal_and_centre[2:]
    lens = make_lens(MODELS_KALIBR[bent], size, focal, centre, k, error=file.error)
    return LensRead(lens, f"{file.name}: Kalibr, {name}, pinhole, {bent}, centre grid")


# COLMAP's cameras.txt: one camera a line, pixels counted from the image's corner

MODELS_COLMAP = {  # model here, number of focal lengths, OpenCV positions of the coefficients
    "SIMPLE_PINHOLE": ("brown", 1, ()),
    "PINHOLE": ("brown", 2, ()),
    "SIMPLE_RADIAL": ("brown", 1, (0,)),
    "RADIAL": ("brown", 1, (0, 1)),
    "OPENCV": ("brown", 2, (0, 1, 2, 3)),
    "FULL_OPENCV": ("brown", 2, (0, 1, 2, 3, 4, 5, 6, 7)),
    "OPENCV_FISHEYE": ("fisheye", 2, (0, 1, 2, 3)),
    "SIMPLE_RADIAL_FISHEYE": ("fisheye", 1, (0,)),
    "RADIAL_FISHEYE": ("fisheye", 1, (0, 1)),
    "SIMPLE_FISHEYE": ("fisheye", 1, ()),
    "FISHEYE": ("fisheye", 2, ()),
}
NOT_READ_COLMAP = {
    "FOV": "OPENCV_FISHEYE",
    "THIN_PRISM_FISHEYE": "OPENCV_FISHEYE",
    "RAD_TAN_THIN_PRISM_FISHEYE": "OPENCV_FISHEYE",
    "SIMPLE_DIVISION": "OPENCV",
    "DIVISION": "OPENCV",
}
"""Models of COLMAP that no lens here has, and the one to calibrate in their place."""
LINE = re.compile(r"^[ \t]*(\d+)[ \t]+([A-Z][A-Z_]+)[ \t]+(\d+)[ \t]+(\d+)[ \t]+\S", re.M)


def recognises_colmap(file: InputFile) -> bool:
    """Tell whether a line has a number, a model's name, and the image's size."""
    return bool(LINE.search(file.text))


def read_colmap(file: InputFile, question: LensQuestion) -> LensRead:
    """Read the lens of a cameras.txt; of several that whose CAMERA_ID the project names."""
    rows = [
        (number, line.split())
        for number, line in enumerate(file.text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    names = [fields[0] for _, fields in rows]
    own = _chosen(file, names, question, "name one by its number")
    number, (_, name, *fields) = rows[names.index(own)]
    if name in NOT_READ_COLMAP:
        raise file.error(
            f"COLMAP's model {name} is not read: let COLMAP calibrate the camera as "
            f"{NOT_READ_COLMAP[name]}",
            number,
        )
    if name not in MODELS_COLMAP:
        raise file.error(f"model {name} is not known; {', '.join(MODELS_COLMAP)} are", number)
    model, focals, places = MODELS_COLMAP[name]
    try:
        width, height, *values = map(plain_number, fields)
    except ValueError as error:
        raise file.error(reason(error), number) from error
    if len(values) != focals + 2 + len(places):
        raise file.error(
            f"{name} has {focals + 2 + len(places)} parameters, not {len(values)}", number
        )
    k = [0.0] * (max(places, default=-1) + 1)
    for place, value in zip(places, values[focals + 2 :], strict=True):
        k[place] = value
    centre = values[focals] - 0.5, values[focals + 1] - 0.5
    focal = values[0], values[focals - 1]
    lens = make_lens(model, (width, height), focal, centre, k, error=file.error)
    said = f"{file.name}: COLMAP, {name}, corner grid, half a pixel taken off"
    return LensRead(lens, said)


# MATLAB files of the Caltech calibration toolbox and of CIRN's, which begins from it
#
# Caltech's manual counts the principal point from the first pixel's centre, (0, 0). CIRN's
# equations take the same number beside clicks that MATLAB counts from (1, 1): its own results
# come out if both are counted so.

CALTECH = ("fc", "cc", "kc", "alpha_c", "nx", "ny")
CIRN = "intrinsics"


def recognises_matlab_lens(file: InputFile) -> bool:
    """Tell whether it is a file of MATLAB's."""
    return file.is_matlab


def read_matlab_lens(file: InputFile, question: LensQuestion) -> LensRead:
    """Read CIRN's 11 intrinsics, NU NV c0U c0V fx fy d1 d2 d3 t1 t2, or Caltech's fc, cc, kc."""
    return _toolbox_lens(file, file.matlab(CIRN, *CALTECH), question)


def recognises_json_intrinsics(file: InputFile) -> bool:
    """Tell whether it is an object in JSON with CIRN's intrinsics."""
    return file.head.lstrip().startswith("{") and f'"{CIRN}"' in file.head


def read_json_intrinsics(file: InputFile, question: LensQuestion) -> LensRead:
    """Read CIRN's 11 intrinsics, as its MATLAB file has them, from JSON."""
    found = file.json()
    values = found.get(CIRN) if isinstance(found, dict) else None
    numbers = isinstance(values, list) and all(type(one) in (int, float) for one in values)
    if not numbers:
        raise file.error(f"{CIRN} is not a list of 11 numbers")
    return _toolbox_lens(file, {CIRN: values}, question)


def _toolbox_lens(file: InputFile, found: Mapping[str, Any], question: LensQuestion) -> LensRead:
    """Make the lens of CIRN's intrinsics or of Caltech's values."""
    refuse_camera(file, question)
    if CIRN in found:
        said, shift, corner = "CIRN's intrinsics", GRID_TO_CENTRE["one-based"], "(1, 1)"
        values = np.asarray(found[CIRN], dtype=np.float64).ravel()
        if len(values) != 11:
            raise file.error(f"{CIRN} has {len(values)} numbers, not 11")
        (width, height), centre, focal = values[:2], values[2:4], values[4:6]
        (k1, k2, k3), (p1, p2), skew = values[6:9], values[9:11], 0.0
    elif {*CALTECH} - {"alpha_c"} <= {*found}:
        said, shift, corner = "Caltech's calibration", 0.0, "(0, 0)"
        width, height = float(found["nx"]), float(found["ny"])
        focal, centre, kc = (np.asarray(found[one], float).ravel() for one in ("fc", "cc", "kc"))
        if (len(focal), len(centre), len(kc)) != (2, 2, 5):
            raise file.error("fc and cc have 2 numbers and kc has 5")
        k1, k2, p1, p2, k3 = kc.tolist()
        skew = float(found.get("alpha_c", 0.0)) * float(focal[0])
    else:
        raise file.error(f"it has neither {CIRN} nor {', '.join(CALTECH)}")
    k = [float(one) for one in (k1, k2, p1, p2, k3)]
    size = float(width), float(height)
    lens = make_lens("brown", size, focal, centre + shift, k, skew, error=file.error)
    said = f"{file.name}: {said}, 5 coefficients, principal point from {corner}"
    return LensRead(lens, said)


# Formats of lens files, one row each; the next format is one more row

LENS_FORMATS: tuple[InputFormat[LensRead], ...] = (
    InputFormat("mrcal", recognises_mrcal, read_mrcal),
    InputFormat("Metashape XML", recognises_metashape, read_metashape),
    InputFormat("OpenSfM or ODM cameras.json", recognises_opensfm, read_opensfm),
    InputFormat("JSON of CIRN's intrinsics", recognises_json_intrinsics, read_json_intrinsics),
    InputFormat("OpenCV yml, xml or json", recognises_opencv, read_opencv),
    InputFormat("Kalibr camchain.yaml", recognises_kalibr, read_kalibr),
    InputFormat("COLMAP cameras.txt", recognises_colmap, read_colmap),
    InputFormat("MATLAB file of Caltech or CIRN", recognises_matlab_lens, read_matlab_lens),
)
