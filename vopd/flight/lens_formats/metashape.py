"""Agisoft Metashape's XML: a calibration file, or the cameras of a project.

Its centre is counted from the middle of the image, p1 and p2 are exchanged against
OpenCV's, and b2 is a skew.
"""

from __future__ import annotations

from xml.etree import ElementTree

from vopd.flight.files import InputFile
from vopd.flight.lens_formats.lens_parameters import LensQuestion, LensRead, checked, make_lens


def recognises(file: InputFile) -> bool:
    """Whether it is XML with a calibration that has a projection, or a sensor's calibration."""
    return "<calibration" in file.text and "opencv" not in file.text


def read(file: InputFile, question: LensQuestion) -> LensRead:
    """The lens; of two calibrations of a sensor the adjusted one."""
    try:
        root = ElementTree.fromstring(file.text.strip())
    except ElementTree.ParseError as error:
        raise file.error(f"not valid XML: {error}") from error
    sensors = root.findall(".//sensor")
    if question.camera is not None:
        sensors = [one for one in sensors if question.camera in (one.get("id"), one.get("label"))]
    if len(sensors) > 1 or (question.camera is not None and not sensors):
        raise file.error(f"{len(sensors)} sensors: name one by its label with [camera] camera")
    inside = sensors[0] if sensors else root
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
            return float(text) if text is not None else 0.0
        except ValueError as error:
            raise file.error(f"{text!r} is not a number", column=name) from error

    kind = found.findtext("projection") or found.get("type") or inside.get("type") or "frame"
    if kind.strip() != "frame":
        raise file.error(f"projection {kind.strip()} is not known; frame is")
    if number("k4"):
        raise file.error("k4 is of the eighth power, which no model here has: calibrate without")
    resolution = found.find("resolution")
    if resolution is None:
        resolution = inside.find("resolution")
    width, height = number("width"), number("height")
    if resolution is not None and not width:
        width, height = float(resolution.get("width", 0)), float(resolution.get("height", 0))
    if not (width and height):
        raise file.error("the image's width and height are missing")
    f = number("f")
    if abs(number("cx")) > width / 4.0:
        raise file.error("cx is far from the image's middle: is it counted from the corner?")
    lens = make_lens(
        "brown",
        (int(width), int(height)),
        (f + number("b1"), f),
        (width / 2.0 + number("cx") - 0.5, height / 2.0 + number("cy") - 0.5),
        [number("k1"), number("k2"), number("p2"), number("p1"), number("k3")],
        number("b2"),
    )
    said = f"{file.name}: Metashape, frame, p1 and p2 exchanged, corner grid"
    return LensRead(checked(file, lens), said)
