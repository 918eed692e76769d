"""OpenCV's FileStorage: .yml, .yaml, .xml and .json with a camera matrix and coefficients.

Also ROS camera_info, which has the same keys and names its model.
"""

from __future__ import annotations

import json
import re
from typing import Any
from xml.etree import ElementTree

from vopd.flight.files import InputFile, needed, reason, shown
from vopd.flight.lens_formats.lens_parameters import (
    LensQuestion,
    LensRead,
    checked,
    coefficients_said,
    make_lens,
)

MATRIX = ("camera_matrix", "cameramatrix", "k", "m1", "m", "intrinsic_matrix")
COEFFICIENTS = ("distortion_coefficients", "distcoeffs", "dist_coeffs", "dist_coeff", "d", "d1")
MODELS = {
    "plumb_bob": "brown",
    "rational_polynomial": "brown",
    "equidistant": "fisheye",
    "kannala_brandt": "fisheye",
    "fisheye": "fisheye",
}
COUNTS = (0, 4, 5, 8, 12)
LEVELS = 3  # of lists in lists: a matrix has two; deeper ones are refused
MOST = 100  # elements of a matrix: more are refused


def recognises(file: InputFile) -> bool:
    """Whether the text names a camera matrix."""
    return bool(re.search(r"camera_?matrix|opencv[-_](?:matrix|storage)", file.text, re.I))


def read(file: InputFile, question: LensQuestion) -> LensRead:
    """The lens of an OpenCV file."""
    values = {key.lower(): value for key, value in _mapping(file).items()}
    matrix = _numbers(file, _first(file, values, MATRIX, "camera matrix"))
    k = _numbers(file, _first(file, values, COEFFICIENTS, "distortion coefficients", needed=False))
    if len(matrix) != 9:
        raise file.error(f"the camera matrix has {len(matrix)} elements, not 9")
    model = _model(file, values, question, k)
    if model == "fisheye" and len(k) != 4:
        raise file.error(f"a fisheye has 4 coefficients, not {len(k)}")
    if len(k) not in COUNTS:
        raise file.error(
            f"{len(k)} coefficients; {', '.join(map(str, COUNTS))} are known"
            + (" (a tilted sensor is not)" if len(k) == 14 else "")
        )
    size_px = question.size_px
    if "image_width" in values and "image_height" in values:
        size_px = int(float(values["image_width"])), int(float(values["image_height"]))
    if size_px is None:
        raise file.error("the image's size is not in the file: give [camera] image_size_px")
    lens = make_lens(model, size_px, (matrix[0], matrix[4]), (matrix[2], matrix[5]), k)
    said = f"{file.name}: OpenCV, {coefficients_said(k, model)}, centre grid"
    return LensRead(checked(file, lens), said)


def _model(file: InputFile, values: dict[str, Any], question: LensQuestion, k: list[float]) -> str:
    named = values.get("distortion_model", "")
    named = named.strip() if isinstance(named, str) else shown(named)
    if named:
        if named not in MODELS:
            raise file.error(f"distortion model {named}; known are {', '.join(MODELS)}")
        return MODELS[named]
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


def _first(
    file: InputFile, values: dict[str, Any], names: tuple[str, ...], what: str, needed: bool = True
) -> Any:
    for name in names:
        if name in values:
            return values[name]
    if needed:
        raise file.error(f"no {what}: looked for {', '.join(names)}")
    return []


def _numbers(file: InputFile, value: Any) -> list[float]:
    """The elements of a matrix, row by row, from a mapping with `data`, or nested lists."""
    if isinstance(value, dict):
        value = value.get("data", [])
    flat: list[Any] = [value]
    for _ in range(LEVELS):  # YAML has lists that hold themselves
        rows = [one if isinstance(one, list | tuple) else [one] for one in flat]
        if sum(map(len, rows)) > MOST:
            raise file.error(f"a matrix has more than {MOST} elements")
        flat = [x for row in rows for x in row]
    if any(isinstance(one, list | tuple | dict) for one in flat):
        raise file.error("a matrix is a list of numbers, or of rows of numbers: one is neither")
    try:
        return [
            float(str(one).lower().replace(".nan", "nan").replace(".inf", "inf")) for one in flat
        ]
    except ValueError as error:
        raise file.error(
            f"a matrix element is not a number: {reason(error, str(error))}"
        ) from error


def _mapping(file: InputFile) -> dict[str, Any]:
    text = file.text.lstrip()
    if text.startswith("<"):
        return _xml(file)
    if text.startswith("{"):
        try:
            found = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise file.error(f"not valid JSON: {reason(error, str(error))}") from error
    else:
        found = _yaml(file)
    if not isinstance(found, dict):
        raise file.error("no keys are in the file")
    return found


def _xml(file: InputFile) -> dict[str, Any]:
    try:
        root = ElementTree.fromstring(file.text.strip())
    except ElementTree.ParseError as error:
        raise file.error(f"not valid XML: {error}") from error
    found: dict[str, Any] = {}
    for one in root:
        data = one.find("data")
        found[one.tag] = (one.text or "").strip() if data is None else (data.text or "").split()
    return found


def _yaml(file: InputFile) -> Any:
    yaml = needed("yaml", "yaml", "a lens in YAML")

    class Loader(yaml.SafeLoader):  # type: ignore[name-defined, misc]
        """Reads OpenCV's tag for matrices as a mapping, and no merge keys.

        A few lines of merge keys in each other are gigabytes; OpenCV writes none.
        """

        def flatten_mapping(self, node: object) -> None: ...

    Loader.add_constructor(
        "tag:yaml.org,2002:opencv-matrix",
        lambda loader, node: loader.construct_mapping(node, deep=True),
    )
    text = re.sub(r"\A%YAML[: ].*\n", "", file.text)
    try:
        return yaml.load(text, Loader=Loader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        why = reason(error, str(error))
        raise file.error(f"not valid YAML: {' '.join(why.split())}") from error
