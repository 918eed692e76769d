"""Files for viewers: CZML and KML."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from html import escape
from io import BytesIO
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.conventions import report_own_position
from vopd.attitude.history import History
from vopd.attitude.table import column_name, columns_of, row_blocks, table_values
from vopd.export import FileRequest, html, name, printable, statements, title, utc
from vopd.export.ccsds import (
    DatedAttitudes,
    TimedAttitude,
    in_order,
    scalar_last,
    timed_attitudes,
)
from vopd.export.tables import as_text
from vopd.findings import Report, VopdError, angle_in_range
from vopd.geometry.rotations import from_axes, product

# CZML: one packet a job with its position and orientation on the Earth, for Cesium.
#
# The orientation turns components in the body (x forward, y right, z down) into
# Earth-fixed ones, with the scalar last, as Cesium has it.

ORIENTATION = (
    "unitQuaternion x y z w, scalar last: rotating a vector's components in the vehicle body by it "
    "gives its Earth-fixed components (WGS 84); neighbours have signs that make them near"
)
STATED = (
    *("program", "doubtful", "fixes", "from frame", "vertical", "to frame"),
    *("orientation", "position", "time"),
)
POSITION = "cartographicDegrees, degrees and metres; a viewer takes altitude as above the ellipsoid"
BOX_M = (300.0, 100.0, 30.0)  # forward, right, down; large enough to be seen, not to scale
GOLD, WHITE = [255, 196, 0, 255], [255, 255, 255, 255]


def render_czml(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the document, one packet a line; times are seconds after the epoch."""
    assert request.epoch is not None
    found = timed_attitudes(histories, request.epoch, report)
    report_own_position(histories, report)
    stated = statements(histories, request, orientation=ORIENTATION)
    stated["position"] += f"; {POSITION}"
    source = histories[0].about.words.source
    about = {key: stated[key] for key in (source, *STATED) if key in stated}
    packets = [_document(found, request, about)]
    packets += [_vehicle(k, one, request, about) for k, one in enumerate(found, 1)]
    return _page(packets)


def _page(packets: Sequence[dict[str, Any]]) -> bytes:
    lines = ",\n".join(json.dumps(packet, allow_nan=False) for packet in packets)
    return f"[\n{lines}\n]\n".encode()


def _document(
    found: Sequence[TimedAttitude], request: FileRequest, about: dict[str, str]
) -> dict[str, Any]:
    first = min(one.microseconds[0] for one in found)
    last = max(one.microseconds[-1] for one in found)
    return {
        "id": "document",
        "name": name(request, found[0].history),
        "version": "1.0",
        "description": html(about),
        "clock": {
            "interval": _interval(request, first, last),
            "currentTime": _interval(request, first, last).partition("/")[0],
            "multiplier": 1,
            "range": "LOOP_STOP",
            "step": "SYSTEM_CLOCK_MULTIPLIER",
        },
    }


def _vehicle(
    k: int, one: TimedAttitude, request: FileRequest, about: dict[str, str]
) -> dict[str, Any]:
    assert request.epoch is not None
    epoch = utc(request.epoch, 0) + "Z"
    called = name(request, one.history)
    where = f"{one.history.about.label}: {called}"
    sampled = {"epoch": epoch, "interpolationAlgorithm": "LINEAR", "interpolationDegree": 1}
    return {
        "id": f"vehicle-{k}",
        "name": called,
        "description": f"<p>{escape(where)}</p>" + html(about),
        "availability": _interval(request, one.microseconds[0], one.microseconds[-1]),
        "position": sampled | {"cartographicDegrees": _samples(one, one.position, 9)},
        "orientation": sampled | {"unitQuaternion": _samples(one, earth_fixed(one), 12)},
        "path": {"width": 2, "material": {"solidColor": {"color": {"rgba": GOLD}}}},
        "point": {"pixelSize": 6, "color": {"rgba": GOLD}},
        "label": {
            "text": called,
            "font": "14px sans-serif",
            "fillColor": {"rgba": WHITE},
            "horizontalOrigin": "LEFT",
            "pixelOffset": {"cartesian2": [12, 0]},
        },
        "box": {
            "dimensions": {"cartesian": list(BOX_M)},
            "material": {"solidColor": {"color": {"rgba": GOLD}}},
        },
    }


def earth_fixed(one: TimedAttitude) -> Floats:
    """Convert to quaternions from body to Earth-fixed axes, x y z w, (T, 4)."""
    local = from_axes(one.history.estimate.position.north_east_down[one.frames])
    return scalar_last(product(local, one.quaternion))


def _samples(one: TimedAttitude, values: Floats, decimals: int) -> list[float]:
    seconds = np.array(one.microseconds)[:, None] / 1e6
    flat: list[float] = np.hstack([seconds, np.round(values, decimals)]).ravel().tolist()
    return flat


def _interval(request: FileRequest, first: int, last: int) -> str:
    assert request.epoch is not None
    return f"{utc(request.epoch, first)}Z/{utc(request.epoch, last)}Z"


# Write KML 2.2: a path of each job, with times if the epoch is known, and a placemark a frame.
#
# Heading, tilt and roll are those of KML's Model: clockwise about up, right and
# forward, each as seen from the end of that axis. So they are yaw, minus pitch, minus roll.

FRAMES = b"<?frames?>"  # stands for the placemarks of the frames of a job until they are written
LEVEL = 4  # of these placemarks: in the folder of frames, in that of the job, in the document
KML, GX = "http://www.opengis.net/kml/2.2", "http://www.google.com/kml/ext/2.2"
ANGLES = (
    "heading, tilt, roll: vehicle yaw, minus pitch, minus roll, degrees, against the frame named "
    "above; a viewer takes them against the ellipsoid's normal, which differs by up to 0.2 from "
    "the direction to the Earth's centre"
)
KML_POSITION = "degrees and metres; a viewer takes altitude as above sea level"
SHOWN = (
    *("frame", "status", "time_s", "camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("alpha_deg", "beta_deg", "eta_deg", "airspeed_{length}_s", "altitude_{length}"),
    *("quaternion_w", "quaternion_x", "quaternion_y", "quaternion_z"),
    *("landmarks", "residual_rms_{image}", "flags"),
    *("sigma_vehicle_yaw_deg", "sigma_vehicle_pitch_deg", "sigma_vehicle_roll_deg"),
)
"""The columns of the attitude table that a frame's placemark shows."""


def render_kml(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Write KML in UTF-8, with a folder for each job."""
    found = timed_attitudes(histories, request.epoch, report)
    report_own_position(histories, report)
    root = ET.Element("kml", {"xmlns": KML, "xmlns:gx": GX})
    document = ET.SubElement(root, "Document")
    _leaf(document, "name", name(request, found[0].history))
    about = statements(histories, request, **{"gx:angles": ANGLES})
    about["position"] += f"; {KML_POSITION}"
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
    """Write the styles: a line for the path, small pins without names for the frames."""
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
    """Write the placemark of each frame, indented as it stands in the file."""
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
        heading, *others = three.tolist()
        angles_deg = angle_in_range(heading, 6), *others
        _leaf(track, "gx:angles", " ".join(f"{angle:.6f}" for angle in angles_deg))


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
    ET.SubElement(parent, tag).text = printable(text)  # XML has no control characters


# CZML of a camera that stands at one place: its position and orientation on the Earth.

STAR_BOX_M = (3.0, 1.0, 1.0)  # forward, right, down; large enough to be seen


def dated_czml(attitudes: DatedAttitudes, request: FileRequest, report: Report) -> bytes:
    """Make the document, one packet a line; times are seconds after the first attitude.

    Raises:
        VopdError: the place is not known
    """
    ordered = in_order(attitudes, report)
    if ordered.place is None or ordered.earth_fixed is None:
        raise VopdError("czml needs the place of the camera")
    first, last = (utc(ordered.moments[k], 0) + "Z" for k in (0, -1))
    interval = f"{first}/{last}"
    called = printable(request.object_name.strip()) or printable(ordered.title)
    rows = scalar_last(ordered.earth_fixed).round(12).tolist()
    samples: list[float] = []
    for moment, row in zip(ordered.moments, rows, strict=True):
        samples += [(moment - ordered.moments[0]).total_seconds(), *row]
    clock = {"interval": interval, "currentTime": first, "multiplier": 1}
    packets: list[dict[str, Any]] = [
        {
            "id": "document",
            "name": called,
            "version": "1.0",
            "description": html(ordered.stated),
            "clock": clock,
        },
        {
            "id": "camera",
            "name": called,
            "description": f"<p>{escape(ordered.title)}</p>" + html(ordered.stated),
            "availability": interval,
            "position": {"cartographicDegrees": list(ordered.place)},
            "orientation": {
                "epoch": first,
                "interpolationAlgorithm": "LINEAR",
                "interpolationDegree": 1,
                "unitQuaternion": samples,
            },
            "point": {"pixelSize": 6, "color": {"rgba": GOLD}},
            "box": {"dimensions": {"cartesian": list(STAR_BOX_M)}},
        },
    ]
    return _page(packets)
