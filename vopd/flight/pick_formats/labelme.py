"""LabelMe's JSON: one file an image, or a folder of them; pixels are counted from the corner."""

from __future__ import annotations

import json

import numpy as np

from vopd.findings import VopdError
from vopd.flight.files import UNEXPECTED, InputFile, reason
from vopd.flight.pick_formats.pick_rows import Names, PickRows


def recognises(file: InputFile) -> bool:
    """Whether it is JSON with shapes, or a folder with JSON in it."""
    if file.path.is_dir():
        return any(file.path.glob("*.json"))
    return file.head.lstrip().startswith("{") and '"shapes"' in file.text


def read(file: InputFile) -> PickRows:
    """The points of one or more LabelMe files."""
    paths = sorted(file.path.glob("*.json")) if file.path.is_dir() else [file.path]
    found: list[tuple[str, str, float, float]] = []
    sizes = set()
    for path in paths:
        try:
            label = json.loads(path.read_text(encoding="utf-8-sig"))
            sizes.add((int(label["imageWidth"]), int(label["imageHeight"])))
            image = str(label["imagePath"]).replace("\\", "/").rpartition("/")[2]
            found += [
                (image, str(shape["label"]), float(point[0]), float(point[1]))
                for shape in label["shapes"]
                if shape.get("shape_type") == "point"
                for point in shape["points"]
            ]
        except (*UNEXPECTED, OSError) as error:
            raise VopdError(
                f"{path.name}: not a LabelMe file: {reason(error, repr(error))}"
            ) from error
    if not found:
        raise file.error("no shape is a point: landmarks are drawn as points")
    if len(sizes) > 1:
        raise file.error("the images are not all of one size: one project is one camera")
    image_names, landmark, u, v = (list(column) for column in zip(*found, strict=True))
    return PickRows(
        Names(image_names), Names(landmark), np.array([u, v]).T, np.full(len(u), np.nan),
        "corner", sizes.pop(), "LabelMe",
    )  # fmt: skip
