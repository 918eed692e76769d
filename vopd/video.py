"""Frames of a video, or images in the place of one: numbers, times of presentation, and pixels.

Frames count from 0 in the order in which they are shown. Pixels are those of the upright image: a
tag that says how a camera was turned is followed, as other programs do that images are clicked in.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.files import optional_package, reason
from vopd.findings import VopdError, count_text
from vopd.inputs import no_file

if TYPE_CHECKING:
    from PIL.Image import Image

STILLS = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp")
GAP = 1.5  # of the usual time between frames: a longer one is a gap
AT_MOST_DECODED = 1_000  # frames after a key frame, for one that is asked for


@dataclass(frozen=True, eq=False)
class VideoFrames:
    """The frames of a video, or images, F of them.

    Args:
        source: the video or the folder, for messages
        image_name: file names of images; empty for the frames of a video
        time_s: of presentation after the first frame, seconds (F,); NaN for images
        path: of the video
        images: of images
        tick: presentation times of a video in its own unit, (F,)
    """

    source: str
    image_name: tuple[str, ...]
    time_s: Floats
    path: Path | None = None
    images: tuple[Path, ...] = ()
    tick: Ints | None = None

    def __len__(self) -> int:
        return len(self.time_s)

    def label(self, k: int) -> str:
        """Name a frame as rows of picks do: by its number, or the image's file name."""
        return self.image_name[k] if self.image_name else str(k)

    @property
    def about(self) -> str:
        """The number of frames, their rate, and what is odd about their times, in a sentence."""
        if self.path is None:
            return f"{self.source}: {count_text(len(self), 'image')}"
        told = f"{self.source}: {count_text(len(self), 'frame')}"
        step_s = np.diff(self.time_s)
        if not len(step_s):
            return told
        usual_s = float(np.median(step_s))
        told += f" in {self.time_s[-1]:.3f} s" + (f", {1 / usual_s:.6g} a second" * (usual_s > 0))
        twice, gaps = int((step_s <= 0.0).sum()), int((step_s > GAP * usual_s).sum())
        if twice:
            told += f", {twice} shown at the time of another"
        if gaps:
            told += f", {count_text(gaps, 'gap')} longer than {GAP:g} times that"
        return told

    def pictures(self, chosen: Iterable[int]) -> Iterator[Image]:
        """Iterate over some frames as upright images in RGB, one at a time.

        Args:
            chosen: their indices

        Raises:
            VopdError: if one cannot be decoded
        """
        for k in chosen:
            yield self._still(self.images[k]) if self.path is None else self._decoded(k)

    def _still(self, path: Path) -> Image:
        pillow = optional_package("PIL.Image", "images", "reading images")
        turned = optional_package("PIL.ImageOps", "images")
        try:
            with pillow.open(path) as image:
                upright: Image = turned.exif_transpose(image)
                return eight_bits(upright)
        except (OSError, ValueError, SyntaxError, pillow.DecompressionBombError) as error:
            raise VopdError(
                f"{path.name}: not an image that can be read: {reason(error)}"
            ) from error

    def _decoded(self, k: int) -> Image:
        assert self.tick is not None and self.path is not None
        optional_package("PIL.Image", "images", "showing frames")
        wanted, lost = (
            int(self.tick[k]),
            VopdError(f"{self.source}: frame {k} cannot be decoded: is the file complete?"),
        )
        try:
            with opened(self.path) as (container, stream):
                container.seek(wanted, stream=stream)
                for number, frame in enumerate(container.decode(stream)):
                    if frame.pts == wanted:
                        image: Image = frame.to_image()
                        return image.rotate(frame.rotation, expand=True)
                    if frame.pts is None or frame.pts > wanted or number > AT_MOST_DECODED:
                        break
        except VopdError as error:
            raise lost from error
        raise lost


def eight_bits(image: Image) -> Image:
    """Convert an image to RGB; one of 16 bits, as of thermal cameras, from its darkest pixel to
    its brightest."""
    if image.mode.startswith(("I", "F")):
        from PIL import Image as images

        own = np.asarray(image, dtype=float)
        low, high = float(np.nanmin(own)), float(np.nanmax(own))
        scaled = np.nan_to_num((own - low) * (255.0 / (high - low) if high > low else 0.0)).round()
        image = images.fromarray(scaled.astype(np.uint8))
    return image.convert("RGB")


def open_frames(names: Iterable[str]) -> VideoFrames:
    """Find the frames of a video, of a folder of images, or of images.

    Args:
        names: of one video, one folder, or any number of images

    Raises:
        VopdError: if there is none, or a video cannot be read
    """
    paths = [Path(name) for name in names]
    for path in paths:
        if kind := no_file(path):
            raise VopdError(f"{path}: {kind}")
        if not path.exists():
            raise VopdError(f"{path}: there is no such file or folder")
    folders = [path for path in paths if path.is_dir()]
    if folders:
        if len(paths) > 1:
            raise VopdError(f"{folders[0]}: a folder of images is given alone")
        paths = sorted(one for one in folders[0].iterdir() if one.suffix.lower() in STILLS)
        if not paths:
            raise VopdError(f"{folders[0]}: no image is in it ({', '.join(STILLS)})")
    moving = [path for path in paths if path.suffix.lower() not in STILLS]
    if not moving:
        source = str(folders[0]) if folders else paths[0].name
        if not folders and len(paths) > 1:
            source += f" and {len(paths) - 1} more"
        _refuse_twins(paths)
        none = np.full(len(paths), np.nan)
        return VideoFrames(source, tuple(path.name for path in paths), none, images=tuple(paths))
    if len(paths) > 1:
        raise VopdError(f"{moving[0]}: a video is given alone")
    tick, unit_s = presentation(moving[0])
    return VideoFrames(moving[0].name, (), (tick - tick[0]) * unit_s, moving[0], tick=tick)


def _refuse_twins(paths: list[Path]) -> None:
    """Refuse two images of one file name, which picks could not tell apart."""
    seen: dict[str, Path] = {}
    for path in paths:
        if (other := seen.setdefault(path.name, path)) is not path:
            raise VopdError(f"{path}: has the name of {other}, and picks go by the name")


def presentation(path: Path) -> tuple[Ints, float]:
    """Read the presentation times of all frames of a video, in order, without decoding it.

    Args:
        path: the video

    Returns:
        The times in the video's own unit, (F,), and that unit, seconds.

    Raises:
        VopdError: if it cannot be read, or has no frames
    """
    with opened(path) as (container, stream):
        shown = [
            packet.pts
            for packet in container.demux(stream)
            if packet.pts is not None and not packet.is_discard
        ]
        unit_s = float(stream.time_base)
    if not shown:
        raise VopdError(f"{path.name}: no frame of the video has a time of presentation")
    return np.sort(np.array(shown, dtype=np.int64)), unit_s


@contextmanager
def opened(path: Path) -> Iterator[tuple[Any, Any]]:
    """Open a video, and its first stream of frames.

    Raises:
        VopdError: if it cannot be read, or PyAV is not installed
    """
    av = optional_package("av", "video", f"{path.name} is no image: reading videos")
    try:
        with av.open(str(path)) as container:
            if not container.streams.video:
                raise VopdError(f"{path.name}: no video is in it; is the file complete?")
            stream = container.streams.video[0]
            stream.thread_type = "AUTO"
            yield container, stream
    except (av.error.FFmpegError, OSError) as error:
        raise VopdError(f"{path.name}: not a video that can be read: {reason(error)}") from error


def spread(frames: VideoFrames, count: int) -> list[int]:
    """Choose frames spread over a video, the first and the last among them.

    Args:
        frames: all of them
        count: how many
    """
    chosen = np.linspace(0, len(frames) - 1, min(count, len(frames)))
    return [int(k) for k in np.unique(np.round(chosen))]
