"""Keys that a project has and nothing of it uses: they are warned of."""

from __future__ import annotations

from collections.abc import Iterator

from vopd.flight.formats.track import TrackRows
from vopd.flight.project.keys import VIDEO, Project

SQUARE = 0.03  # of a side: by so much the sizes of a sensor are rounded


def unused_keys(project: Project, by_table: bool) -> Iterator[str]:
    """Name the keys that have no effect, and why, for warnings.

    Args:
        project: whose keys have been read
        by_table: whether `[camera] of_images` has the lenses of all images
    """
    for (section, key), why in _reasons(project, by_table).items():
        if project.section(section).has(key):
            yield f"[{section}] {key}: is not used: {why}"
    yield from _doubt_of_sensor(project)


def _reasons(project: Project, by_table: bool) -> dict[tuple[str, str], str]:
    """Say of keys that may be there why nothing would use them."""
    picks, found = project.section("picks"), {}
    times = picks.values.get("times")
    if not isinstance(project.section("camera").values.get("lens"), dict):
        why = "it is of cx_px and cy_px of a table, and a lens file says it itself"
        found["camera", "pixel_grid"] = why
    if by_table:
        found["camera", "lens"] = "the table of [camera] of_images has a lens for each image"
    if not isinstance(times, str) or times == VIDEO or not (project.folder / times).is_dir():
        found["picks", "utc_offset_h"] = "[picks] times names no folder of images"
    if not picks.has("frame_rate_hz") and times != VIDEO:
        why = f'it takes frame_rate_hz or times = "{VIDEO}"'
        found["picks", "first_frame_t_s"] = why
    if project.has("position"):
        found["uncertainty", "clock_rate_ppm"] = "a camera in one place is there at every time"
    if not project.section("vehicle").has("attitude"):
        found["vehicle", "attitude_sigma_deg"] = "[vehicle] attitude names no file"
    return found


def unused_by_image(project: Project, rows: TrackRows) -> Iterator[str]:
    """Name the keys of a track by time that have no effect on one whose positions are images'.

    Args:
        project: whose track it is
        rows: its positions
    """
    keys = [("track", "interpolate")]
    if rows.time_s is None:
        keys += [("track", "clock"), ("track", "offset_s"), ("uncertainty", "clock_rate_ppm")]
    for section, key in keys:
        if project.section(section).has(key):
            yield f"[{section}] {key}: is not used: the track's positions are those of images"


def _doubt_of_sensor(project: Project) -> Iterator[str]:
    """Doubt a sensor of another shape than the image, whose pixels would not be square."""
    camera = project.section("camera")
    lens, size = camera.values.get("lens"), camera.size("image_size_px")
    if not isinstance(lens, dict) or "sensor_mm" not in lens or size is None:
        return
    across, down = (mm / px for mm, px in zip(lens["sensor_mm"], size, strict=True))
    if abs(down / across - 1.0) > SQUARE:
        (width, height), high = size, lens["sensor_mm"][0] * size[1] / size[0]
        yield (
            f"[camera.lens] sensor_mm: by it a pixel is {down / across:.3g} times as high as wide: "
            f"an image of {width} x {height} that is cropped to this shape has the part "
            f"[{lens['sensor_mm'][0]:g}, {high:.4g}] of the sensor"
        )
