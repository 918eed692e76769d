"""Attitudes of the vehicle, read from the file that a project names."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vopd.flight.flight import VehicleAttitudes
from vopd.flight.formats.columns import TIME
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.image_tags import images_in, tags_of
from vopd.flight.formats.tables import frame_names, read_csv
from vopd.flight.project.keys import Project, Section
from vopd.flight.project.times import FrameTimes, refuse_seconds
from vopd.geometry.rotations import body_axes
from vopd.inputs import gps_ahead_s

SIGMA_NEEDED = (
    "is needed, above 0: {} how well each attitude is known, degrees about each axis, as 0.2 of a "
    "small inertial sensor"
)


def read_vehicle(project: Project, offset_s: float, times: FrameTimes) -> VehicleAttitudes:
    """Read the attitudes of the vehicle from the file that a project names.

    Args:
        project: its sections
        offset_s: added to the file's times, as to the track's
        times: of the frames

    Raises:
        VopdError: where the file does not say when each attitude is, or how well it is known
    """
    section, file = project.section("vehicle"), project.open("vehicle", "attitude")
    if file.path.is_dir():
        return _of_gimbal(section, file)
    gps = project.section("track").values.get("clock") == "gps"
    table = read_csv(replace(file, clock="gps") if gps else file, ("frame", "image", *TIME))
    ways = ("image", "frame", *TIME) if times.image else ("frame", *TIME, "image")
    by = next(filter(table.has, ways), None)
    if by is None:
        raise file.error(
            "does not say when each attitude is: it needs a column frame, image, t_s or t_utc, "
            "seconds or dates on the clock of the track, beside yaw_deg, pitch_deg and roll_deg"
        )
    angles = np.stack([table.numbers(f"{one}_deg") for one in ("yaw", "pitch", "roll")], axis=1)
    body_to_ned = body_axes(np.radians(angles))
    of_all = section.sigma("attitude_sigma_deg")
    sigma_deg = np.full(len(angles), np.nan if of_all is None else of_all[0])
    if table.has("sigma_deg"):
        own = table.sigmas("sigma_deg")
        sigma_deg = np.where(np.isnan(own), sigma_deg, own)
    if not (sigma_deg > 0.0).all():
        does_not_say = f"{file.name} does not say in a column sigma_deg"
        raise section.error("attitude_sigma_deg", SIGMA_NEEDED.format(does_not_say))
    if not len(angles):
        raise file.error("no attitude is in the file")
    keys = table.column(by) if by in TIME else frame_names(table, by == "image")
    time_s = np.full(len(angles), np.nan)
    if by in TIME:
        time_s, dated = table.clock((by,))
        if not dated:
            refuse_seconds(project, times, f"{file.name} has")
        elif times.epoch is None:
            message = f"is needed: {file.name} has dates, and the frames are in seconds"
            raise project.section("flight").error("epoch", message)
        else:
            ahead_s = gps_ahead_s(float(time_s[0])) if gps else 0.0
            time_s = time_s - ahead_s - times.epoch.timestamp()
        time_s = time_s + offset_s
        back = np.flatnonzero(~(np.diff(time_s) > 0.0))
        if len(back):
            raise table.error("its time is not after the one before", int(back[0]) + 1, by)
    first = dict[str, int]()
    for row, key in enumerate(keys):
        if first.setdefault(key, row) != row:
            earlier = f"it is in line {table.line[first[key]]} already"
            raise table.error(f"{key} has two attitudes, {earlier}: remove one", row, by)
    return VehicleAttitudes(file.name, by, tuple(keys), time_s, body_to_ned, np.radians(sigma_deg))


def _of_gimbal(section: Section, folder: InputFile) -> VehicleAttitudes:
    """Read the attitudes of a gimbal from the tags of the images of a folder.

    Raises:
        VopdError: where no image has all three angles, or nothing says how well they are known
    """
    every, _ = tags_of(images_in(folder.path))
    known = {path.name: one.gimbal_deg for path, one in every.items()}
    known = {name: angles for name, angles in known.items() if np.isfinite(angles).all()}
    if not known:
        raise folder.error(
            "no image has the angles of a gimbal in its tags: name a CSV of the vehicle's "
            "attitudes, with image, yaw_deg, pitch_deg and roll_deg"
        )
    of_all = section.sigma("attitude_sigma_deg")
    if of_all is None or not of_all[0] > 0.0:
        does_not_say = f"the tags of the images in {folder.name} do not say"
        raise section.error("attitude_sigma_deg", SIGMA_NEEDED.format(does_not_say))
    return VehicleAttitudes(
        folder.name, "image", tuple(known), np.full(len(known), np.nan),
        body_axes(np.radians([*known.values()])),
        np.full(len(known), np.radians(of_all[0])), of_gimbal=True,
    )  # fmt: skip
