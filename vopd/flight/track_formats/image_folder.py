"""A folder of images as a track: the positions in their tags, and times where they say a zone."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.flight.files import InputFile
from vopd.flight.image_tags import images_in, read_tags
from vopd.flight.track_formats.track_rows import TrackRows


def recognises(file: InputFile) -> bool:
    """Whether it is a folder with images."""
    return bool(images_in(file.path))


def read(file: InputFile) -> TrackRows:
    """The positions of the images of a folder that have one.

    Raises:
        VopdError: where no image has a position, or Pillow is not installed
    """
    paths = images_in(file.path)
    every = [read_tags(path) for path in paths]
    named = [(p, t) for p, t in zip(paths, every, strict=True) if np.isfinite(t.position).all()]
    if not named:
        raise file.error(f"none of the {len(paths)} images has a position in its tags")
    tags = [one for _, one in named]
    gimbal: Floats = np.array([one.gimbal_deg for one in tags])
    time_s: Floats = np.array([one.clock_s - one.zone_s for one in tags])
    without = len(paths) - len(tags)
    dated = bool(np.isfinite(time_s).all())
    said = f"EXIF and XMP tags of {len(paths)} images"
    said += f", {without} without position" if without else ""
    said += ", times with their zone" if dated else ""
    angles = np.isfinite(gimbal).any()
    return TrackRows(
        np.array([one.position for one in tags]),
        True,
        "EPSG:4326",
        "utc" if dated else None,
        time_s if dated else None,
        said + ("; gimbal angles for comparison only" if angles else ""),
        [path.name for path, _ in named],
        gimbal_deg=gimbal if angles else None,
        whole_seconds=any(one.whole_second for one in tags),
    )
