"""CVAT's XML, for images 1.1 and for video 1.1; pixels are counted from the corner."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import numpy as np

from vopd.flight.files import InputFile
from vopd.flight.pick_formats.pick_rows import Names, PickRows


def recognises(file: InputFile) -> bool:
    """Whether it is XML of annotations."""
    return "<annotations" in file.head


def read(file: InputFile) -> PickRows:
    """The points of a CVAT file; those outside the image, or drawn by tracks that ended, are not.

    A label with one point is a landmark; of several points in one shape each is a
    pick of it.
    """
    try:
        root = ElementTree.fromstring(file.text.strip())
    except ElementTree.ParseError as error:
        raise file.error(f"not valid XML: {error}") from error
    found: list[tuple[int | str, str, float, float]] = []
    images = root.findall("image")
    for image in images:
        for points in image.findall("points"):
            pixels = _pixels(file, points.get("points", ""))
            found += [(image.get("name", ""), points.get("label", ""), *xy) for xy in pixels]
    for track in root.findall("track"):
        for points in track.findall("points"):
            if points.get("outside") != "1":
                pixels = _pixels(file, points.get("points", ""))
                frame = int(points.get("frame", "0"))
                found += [(frame, track.get("label", ""), *xy) for xy in pixels]
    if not found:
        raise file.error("no points are in the file: landmarks are drawn as points")
    if not all(one[1] for one in found):
        raise file.error("some points have no label: the label is the name of the landmark")
    if images and any(isinstance(one[0], int) for one in found):
        raise file.error("images and video tracks are in one file: give them one by one")
    sizes = {(int(i.get("width", 0)), int(i.get("height", 0))) for i in images}
    if not images:
        sizes = {
            (int(s.findtext("width", "0")), int(s.findtext("height", "0")))
            for s in root.iter("original_size")
        }
    if len(sizes) > 1:
        raise file.error("the images are not all of one size: one project is one camera")
    frames: list[Any] = [one[0] for one in found]
    by_image = isinstance(frames[0], str)
    landmark = Names(one[1] for one in found)
    pixel = np.array([one[2:] for one in found])
    unknown = np.full(len(found), np.nan)
    return PickRows(
        Names(frames) if by_image else np.array(frames), landmark, pixel, unknown, "corner",
        sizes.pop() if sizes else None, "CVAT images" if images else "CVAT video",
    )  # fmt: skip


def _pixels(file: InputFile, text: str) -> list[tuple[float, float]]:
    try:
        pairs = [pair.split(",") for pair in text.split(";") if pair]
        return [(float(u), float(v)) for u, v in pairs]
    except ValueError as error:
        raise file.error(f"points {text!r}: {error}") from error
