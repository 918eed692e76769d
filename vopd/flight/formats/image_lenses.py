"""The lens of each image: a CSV, or the shots of OpenSfM's reconstruction.json."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from vopd.findings import VopdError
from vopd.flight.formats.by_content import InputFormat
from vopd.flight.formats.files import InputFile, open_input
from vopd.flight.formats.tables import frame_names, has_columns, read_csv


class ImageLenses(NamedTuple):
    """The lens of each of R images, by the file and the name in it."""

    image: list[str]  # or the number of a frame
    file: list[str]  # empty: that of `[camera] lens`
    camera: list[str]  # which camera of the file; empty: that of `[camera] camera`
    said: str


OF_IMAGE = ("image", "frame", "lens", "camera")


def recognises_csv_lenses(file: InputFile) -> bool:
    """Tell whether the header names an image or a frame, and a lens or a camera."""
    ways = [(one, other) for one in ("image", "frame") for other in ("lens", "camera")]
    return has_columns(file, OF_IMAGE, *ways)


def read_csv_lenses(file: InputFile) -> ImageLenses:
    """Read the table: `lens` is a file, from its own folder; `camera` one of that file's."""
    table = read_csv(file, OF_IMAGE)
    name = frame_names(table, table.has("image"))
    lens, camera = (
        table.column(one) if table.has(one) else [""] * len(name) for one in ("lens", "camera")
    )
    return ImageLenses(name, lens, camera, f"CSV{table.read_as}")


def lens_files(table: Path) -> list[tuple[str, Path]]:
    """List the files that such a table names, as far as they are there, by the names it has.

    Args:
        table: its path, which need not be one that can be read: reading it says what is wrong
    """
    try:
        file = open_input(table.name, table.parent)
        names = {*read_csv_lenses(file).file} - {""} if recognises_csv_lenses(file) else set()
    except (VopdError, OSError):
        return []
    found = []
    for name in sorted(names):
        with suppress(OSError, ValueError):  # a name that cannot be a path
            if (table.parent / name).is_file():
                found.append((name, table.parent / name))
    return found


def recognises_reconstruction(file: InputFile) -> bool:
    """Tell whether it is a list in JSON whose elements have shots."""
    return file.head.lstrip().startswith("[") and '"shots"' in file.text


def read_shots(file: InputFile) -> list[dict[str, Any]]:
    """Read the reconstructions of a reconstruction.json.

    Raises:
        VopdError: where it is no JSON of that kind
    """
    found = file.json()
    if not all(isinstance(one, dict) and isinstance(one.get("shots"), dict) for one in found):
        raise file.error("not a list of reconstructions with shots")
    return list(found)


def read_reconstruction_lenses(file: InputFile) -> ImageLenses:
    """Read which camera took each shot; the cameras are those of the same file."""
    shots = [one for part in read_shots(file) for one in part["shots"].items()]
    camera = [str(one["camera"]) for _, one in shots]
    names = [name for name, _ in shots]
    return ImageLenses(names, [file.path.name] * len(shots), camera, "OpenSfM reconstruction")


IMAGE_LENS_FORMATS: tuple[InputFormat[ImageLenses], ...] = (
    InputFormat(
        "OpenSfM reconstruction.json", recognises_reconstruction, read_reconstruction_lenses
    ),
    InputFormat(
        "a CSV with image (or frame) and lens (or camera)", recognises_csv_lenses, read_csv_lenses
    ),
)
