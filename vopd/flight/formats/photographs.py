"""Photographs of frames: the images that picks name, where they are, and which are missing."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

import numpy as np

from vopd.findings import VopdError, first_of
from vopd.flight.flight import Flight

if TYPE_CHECKING:
    from PIL.Image import Image


def photograph(flight: Flight, number: int, name: str) -> Image:
    """Read the photograph of a frame of a flight: its image, or a frame of its video.

    Args:
        flight: whose project says where they are
        number: of the frame
        name: of its image; empty for the frame of a video

    Raises:
        VopdError: if there is none, or it cannot be read
    """
    from vopd.video import open_frames

    if not name:
        frames = open_frames([str(one) for one in flight.video])
        (picture,) = frames.pictures([frames.place(number, name)])
        return picture
    assert flight.folder is not None
    of_video = [one if one.is_dir() or not one.suffix else one.parent for one in flight.video]
    found = image_file(image_places([*of_video, flight.folder]), name)
    if found is None:
        places = dict.fromkeys(_as_named(one, flight.folder) for one in of_video)
        where = " or ".join([*places, "the project's folder"])
        others = other_images(of_video)
        cure = "[picks] video, or --images of vopd plot, names its folder"
        if others:
            cure = f"{others} there: the picks name an image as its file is named"
        raise VopdError(f"{name} is not in {where}; {cure}")
    (picture,) = open_frames([str(found)]).pictures([0])
    return picture


def _as_named(path: Path, folder: Path) -> str:
    """Write a path as the project in a folder names it, or as it is where it is elsewhere."""
    return str(path.relative_to(folder) if path.is_relative_to(folder) else os.path.normpath(path))


def other_images(folders: Iterable[Path]) -> str:
    """Name the first images of some folders, and say whether they are one or several."""
    from vopd.video import stills_in

    return _are([one.name for folder in folders for one in stills_in(folder)])


def lost_images(names: Iterable[str], folders: Iterable[Path]) -> str:
    """Name the first images that are in none of some folders; empty if there is none."""
    places = image_places(folders)
    return _are([name for name in names if not image_file(places, name)])


def _are(names: list[str]) -> str:
    return f"{first_of(names, MOST_NAMED)} {'is' if len(names) == 1 else 'are'}" if names else ""


MOST_NAMED = 3


def missing_images(flight: Flight) -> str:
    """Say which picked images are not where the project has its photographs; empty if all are.

    Args:
        flight: whose project may name them by `[picks] video`
    """
    if not flight.image_name or not flight.video or flight.folder is None:
        return ""
    folders = [one if one.is_dir() else one.parent for one in flight.video]
    lost = lost_images(dict.fromkeys(flight.image_name), (*folders, flight.folder))
    others = other_images(folders)
    if not lost or not others:
        return ""
    return (
        f"[picks] video: {lost} picked and not among the images, where {others}: the picks name an "
        "image as its file is named, or there is no photograph of it"
    )


MOST_SIZES = 20  # pictures whose size each answer looks at


def other_size(flight: Flight, most: int | None = None) -> str:
    """Name the first picked picture that has another size than its lens; empty if none has.

    Args:
        flight: whose project may name the pictures by `[picks] video`
        most: how many pictures are looked at; None: all
    """
    if not flight.video or flight.folder is None or not len(flight.picks.frame):
        return ""
    of_lens = np.broadcast_to(flight.lens.by_rows("size_px"), (len(flight.frame), 2))
    for k, name, size in _sizes(flight, np.unique(flight.picks.frame)[:most].tolist()):
        if (of_lens[k] != size).any():
            return other_size_text("[picks] video", name, size, of_lens[k].tolist())
    return ""


def other_size_text(
    where: str, name: str, size_px: Sequence[float], lens_px: Sequence[float]
) -> str:
    """Say that a picture has another size than its lens.

    Args:
        where: the key that names it
        name: the picture's
        size_px: its width and height
        lens_px: those of the lens's pictures
    """
    own, lens = (f"{one[0]:.0f} x {one[1]:.0f}" for one in (size_px, lens_px))
    turned = ", turned" if [*lens_px] == [*size_px][::-1] else ""
    return (
        f"{where}: {name} has {own} upright, and the lens is for {lens}{turned}: if it was picked "
        "in, give the lens of such pictures; of the same picture in another size it is lens_size_px"
    )


def _sizes(flight: Flight, frames: list[int]) -> Iterator[tuple[int, str, tuple[int, int]]]:
    """Iterate over the sizes of pictures of a flight, each with its frame and its name.

    One that is not there, or cannot be read, is left out, which is told where it is shown. The
    frames of a video have one size, for which one of them is decoded.
    """
    from vopd.video import STILLS, frame_size, open_frames, upright_size

    assert flight.folder is not None
    first, named = flight.video[0], flight.image_name
    with suppress(VopdError):
        if not named and first.suffix.lower() not in STILLS and not first.is_dir():
            yield frames[0], first.name, frame_size(first)
            return
        folders = [one if one.is_dir() else one.parent for one in flight.video]
        places = image_places([*folders, flight.folder])
        images = None if named else open_frames([str(one) for one in flight.video])
        for k in frames:
            with suppress(VopdError):
                if images is None:
                    path, name = image_file(places, named[k]), named[k]
                else:
                    path = images.images[images.place(int(flight.frame[k]), "")]
                    name = path.name
                if path:
                    yield k, name, upright_size(path)


def image_places(folders: Iterable[Path]) -> list[Path]:
    """List folders of a project or of images, and the folders within each behind it."""
    places = []
    for folder in folders:
        places.append(folder)
        with suppress(OSError, ValueError):
            places += sorted(one for one in folder.iterdir() if one.is_dir())
    return places


def image_file(places: Sequence[Path], name: str) -> Path | None:
    """Find an image by its whole name, or else by that without folders.

    Args:
        places: folders that may have it
        name: of the image's file, as the picks have it
    """
    for own in dict.fromkeys((name, PurePosixPath(name).name)):
        with suppress(OSError, ValueError):  # a name that no file can have
            found = next((one / own for one in places if (one / own).is_file()), None)
            if found is not None:
                return found
    return None
