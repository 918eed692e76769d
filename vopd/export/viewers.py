"""Write KML 2.2: a path of each job, with times if the epoch is known, and a placemark a frame.

Heading, tilt and roll are those of KML's Model: clockwise about up, right and
forward, each as seen from the end of that axis. So they are yaw, minus pitch, minus roll.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import BytesIO
from xml.etree import ElementTree as ET

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.own_position import report_own_position
from vopd.attitude.table_columns import column_name, columns_of
from vopd.attitude.table_values import row_blocks, table_values
from vopd.export.file_request import FileRequest, html, name, statements, title, utc
from vopd.export.tables import as_text
from vopd.export.times import TimedAttitude, timed_attitudes
from vopd.findings import Report

FRAMES = b"<?frames?>"  # stands for the placemarks of the frames of a job until they are written
LEVEL = 4  # of these placemarks: in the folder of frames, in that of the job, in the document
KML, GX = "http://www.opengis.net/kml/2.2", "http://www.google.com/kml/ext/2.2"
ANGLES = (
    "heading, tilt, roll: vehicle yaw, minus pitch, minus roll, degrees, against the frame named "
    "above; a viewer takes them against the ellipsoid's normal, which differs by up to 0.2 from "
    "the direction to the Earth's centre"
)
POSITION = "degrees and metres; a viewer takes altitude as above sea level"
SHOWN = (
    *("frame", "status", "time_s", "camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("alpha_deg", "beta_deg", "eta_deg", "airspeed_{length}_s", "altitude_{length}"),
    *("quaternion_w", "quaternion_x", "quaternion_y", "quaternion_z"),
    *("landmarks", "residual_rms_{image}", "flags"),
    *("sigma_vehicle_yaw_deg", "sigma_vehicle_pitch_deg", "sigma_vehicle_roll_deg"),
)
"""The columns of the attitude table that a frame's placemark shows."""


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """The file, UTF-8: a folder for each job.

    Args:
        histories: the jobs
        request: epoch and name
        report: is given warnings about frames that are left out
    """
    found = timed_attitudes(histories, request.epoch, report)
    report_own_position(histories, report)
    root = ET.Element("kml", {"xmlns": KML, "xmlns:gx": GX})
    document = ET.SubElement(root, "Document")
    _leaf(document, "name", name(request, found[0].history))
    about = statements(histories, request, **{"gx:angles": ANGLES})
    about["position"] += f"; {POSITION}"
    _leaf(document, "description", html(about))
    _styles(document)
    for one in found:
        _folder(document, one, request)
    ET.indent(root)
    content: bytes = ET.tostring(root, encoding="UTF-8", xml_declaration=True)
    page = BytesIO()
    # the elements of thousands of frames would take ten times the memory of their text
    *before, end = content.split(FRAMES)
    for text, one in zip(before, found, strict=True):
        page.write(text)
        page.writelines(_frames(one, request))
    page.write(end + b"\n")
    return page.getvalue()


def _styles(document: ET.Element) -> None:
    """Styles: a line for the path; small pins without names for the frames, often thousands."""
    path = ET.SubElement(document, "Style", {"id": "path"})
    line = ET.SubElement(path, "LineStyle")
    _leaf(line, "color", "ff00c4ff")
    _leaf(line, "width", "2")
    frame = ET.SubElement(document, "Style", {"id": "frame"})
    for part, scale in (("IconStyle", "0.4"), ("LabelStyle", "0")):
        _leaf(ET.SubElement(frame, part), "scale", scale)


def _folder(document: ET.Element, one: TimedAttitude, request: FileRequest) -> None:
    history = one.history
    folder = ET.SubElement(document, "Folder")
    _leaf(folder, "name", f"{history.about.label}: {title(history)}")
    when = [] if request.epoch is None else [utc(request.epoch, t) for t in one.microseconds]
    if when:
        _track(_placemark(folder, "attitude", "#path"), one, when)
    elif len(one.frames) > 1:  # a line has two points at least
        path = ET.SubElement(_placemark(folder, "path", "#path"), "LineString")
        _leaf(path, "altitudeMode", "absolute")
        _leaf(path, "coordinates", " ".join(map(_coordinates, one.position)))
    frames = ET.SubElement(folder, "Folder")
    _leaf(frames, "name", "frames")
    frames.append(ET.ProcessingInstruction("frames"))


def _frames(one: TimedAttitude, request: FileRequest) -> Iterator[bytes]:
    """The placemark of each frame, indented as it stands in the file."""
    history = one.history
    names = [column_name(name, history.estimate) for name in SHOWN]
    columns = {column.name: column for column in columns_of([history])}
    found = table_values([columns[name] for name in names], [history])
    values = {name: found[name][one.frames] for name in names}
    first, between = 0, b""
    for some in row_blocks(values):
        shown = as_text(some, [columns[name] for name in names])
        for k, row in enumerate(zip(*shown.values(), strict=True), first):
            said = {
                key: "" if cell == "inf" else cell for key, cell in zip(names, row, strict=True)
            }
            said["frame"] = history.estimate.frame_label(one.frames[k])
            when = "" if request.epoch is None else utc(request.epoch, one.microseconds[k])
            placemark = _frame(said, _coordinates(one.position[k]), when)
            ET.indent(placemark, level=LEVEL)
            yield between + ET.tostring(placemark, encoding="UTF-8")
            between = b"\n" + LEVEL * b"  "
        first += len(shown["frame"])


def _track(placemark: ET.Element, one: TimedAttitude, when: list[str]) -> None:
    track = ET.SubElement(placemark, "gx:Track")
    _leaf(track, "altitudeMode", "absolute")
    for moment in when:
        _leaf(track, "when", moment + "Z")
    for position in one.position:
        _leaf(track, "gx:coord", _coordinates(position).replace(",", " "))
    angles = one.history.estimate.vehicle_deg[one.frames] * [1.0, -1.0, -1.0]
    angles[:, 2] = np.where(angles[:, 2] < -180.0, angles[:, 2] + 360.0, angles[:, 2])
    for three in angles + 0.0:
        _leaf(track, "gx:angles", " ".join(f"{angle:.6f}" for angle in three))


def _frame(row: dict[str, str], coordinates: str, when: str) -> ET.Element:
    placemark = ET.Element("Placemark")
    _leaf(placemark, "name", row["frame"])
    if when:
        _leaf(ET.SubElement(placemark, "TimeStamp"), "when", when + "Z")
    _leaf(placemark, "styleUrl", "#frame")
    data = ET.SubElement(placemark, "ExtendedData")
    for key, text in row.items():
        _leaf(ET.SubElement(data, "Data", {"name": key}), "value", text)
    point = ET.SubElement(placemark, "Point")
    _leaf(point, "altitudeMode", "absolute")
    _leaf(point, "coordinates", coordinates)
    return placemark


def _placemark(parent: ET.Element, called: str, style: str) -> ET.Element:
    placemark = ET.SubElement(parent, "Placemark")
    _leaf(placemark, "name", called)
    _leaf(placemark, "styleUrl", style)
    return placemark


def _coordinates(position: Floats) -> str:
    longitude, latitude, altitude = position
    return f"{longitude:.8f},{latitude:.8f},{altitude:.3f}"


def _leaf(parent: ET.Element, tag: str, text: str) -> None:
    ET.SubElement(parent, tag).text = text
