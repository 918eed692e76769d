"""OpenSfM's and ODM's cameras.json: numbers by the image's longer side, from its centre."""

from __future__ import annotations

import json
from typing import Any

from vopd.flight.files import InputFile, reason
from vopd.flight.lens_formats.lens_parameters import (
    LensQuestion,
    LensRead,
    checked,
    image_centre,
    make_lens,
)

BROWN = ("k1", "k2", "p1", "p2", "k3")
FISHEYE = ("k1", "k2", "k3", "k4")
MODELS = {  # model here, keys of the coefficients in OpenCV's order
    "perspective": ("brown", ("k1", "k2")),
    "simple_radial": ("brown", ("k1",)),
    "radial": ("brown", ("k1", "k2")),
    "brown": ("brown", BROWN),
    "fisheye": ("fisheye", ("k1", "k2")),
    "fisheye_opencv": ("fisheye", FISHEYE),
}


def recognises(file: InputFile) -> bool:
    """Whether it is JSON that speaks of a focal length and a projection or a size."""
    text = file.text.lstrip()
    return text[:1] in "{[" and '"width"' in text and '"focal' in text


def read(file: InputFile, question: LensQuestion) -> LensRead:
    """The lens of a cameras.json, or of the cameras in a reconstruction.json."""
    try:
        found = json.loads(file.text)
    except (ValueError, RecursionError) as error:
        raise file.error(f"not valid JSON: {reason(error, str(error))}") from error
    if isinstance(found, list):
        found = found[0]
    cameras = found.get("cameras", found)
    if question.camera is not None:
        cameras = {name: one for name, one in cameras.items() if name == question.camera}
    if len(cameras) != 1:
        raise file.error(f"{len(cameras)} cameras: name one of its keys with [camera] camera")
    ((name, camera),) = cameras.items()
    return _camera(file, name, camera)


def _camera(file: InputFile, name: str, camera: dict[str, Any]) -> LensRead:
    kind = camera.get("projection_type", "perspective")
    if kind not in MODELS:
        raise file.error(f"projection {kind} is not known; {', '.join(MODELS)} are", column=name)
    try:
        size_px = int(camera["width"]), int(camera["height"])
        focal = float(camera["focal_x" if "focal_x" in camera else "focal"])
        focals = focal, float(camera.get("focal_y", focal))
        model, keys = MODELS[kind]
        k = [float(camera.get(key, 0.0)) for key in keys]
        shift = float(camera.get("c_x", 0.0)), float(camera.get("c_y", 0.0))
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise file.error(
            f"a camera needs width, height, focal as numbers: {reason(error, str(error))}",
            column=name,
        ) from error
    scale = float(max(size_px))
    middle = image_centre(size_px)
    lens = make_lens(
        model,
        size_px,
        (focals[0] * scale, focals[1] * scale),
        (shift[0] * scale + middle[0], shift[1] * scale + middle[1]),
        k,
    )
    said = f"{file.name}: OpenSfM, {kind}, from the image's centre"
    return LensRead(checked(file, lens), said)
