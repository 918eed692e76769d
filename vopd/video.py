"""Frames of a video, or images in the place of one: numbers, times of presentation, and pixels.

Frames count from 0 in the order in which they are shown, on through all files of a video that a
camera has written in several. Pixels are those of the upright image: a tag that says how a camera
was turned is followed, as other programs do that images are clicked in. PyAV decodes, or, where it
is not installed, `ffmpeg`.
"""

from __future__ import annotations

import codecs
import io
import re
import shlex
import shutil
import subprocess
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePath, PurePosixPath
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.files import optional_package, reason
from vopd.findings import VopdError, count_text
from vopd.inputs import no_file

if TYPE_CHECKING:
    from PIL.Image import Image

STILLS = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".webp")
KINDS = ("JPEG", "PNG", "TIFF", "BMP", "WEBP")  # of images, as Pillow names them
SHOWN = 3  # gaps in the numbers of images, in words
FEWEST_NUMBERED = 3  # images from which their numbers tell a step
MOST_GAPS = 0.2  # of the steps: with more the images were chosen
GAP = 1.5  # of the usual time between frames: a longer one is a gap
VARIES, TWO_MS = 0.1, 0.002  # of the usual time, beyond rounding: the rate varies
GIVE = "give the video itself, or the folder of its frames as images"
LISTS = (b"ffconcat", b"#EXTM3U", b"<?xml", b"<MPD")  # begin files that name others, or addresses
WITH_LUMA = (
    "yuv420p", "yuv422p", "yuv444p", "yuvj420p", "yuvj422p", "yuvj444p", "nv12", "nv21", "gray",
)  # fmt: skip
"""Formats of pixels whose luminance in eight bits is taken as it is stored."""
REORDERED = ("h264", "hevc")  # frames that refer to later ones, of which an AVI has no times
ORIENTATION = 274  # EXIF's tag of how an image is turned; 1: upright
SIDES = 256, 257  # TIFF's tags of width and height, as stored
ON_ITS_SIDE = (5, 6, 7, 8)  # ORIENTATION of images whose rows are shown as columns
BAND = 250_000  # pixels of more than eight bits that are scaled at once
SOONER_S = 10.0  # than a frame that is asked for ffmpeg begins to decode


@dataclass(frozen=True, eq=False)
class Chapter:
    """A file of a video, F frames."""

    path: Path  # of the file
    first: int  # index of its first frame among those of the whole video
    tick: Ints  # presentation times in the file's own unit, (F,)
    unit_s: float  # that unit, seconds
    lost: int  # frames of its index that are not in the file
    hidden: int = 0  # frames in the file that its edit list does not show


@dataclass(frozen=True, eq=False)
class VideoFrames:
    """The frames of a video, or images, F of them."""

    source: str  # the video or the folder, for messages
    image_name: tuple[str, ...]  # file names of images; empty for the frames of a video
    time_s: Floats  # of presentation after the first frame, seconds (F,); NaN for images
    images: tuple[Path, ...] = ()  # of images
    chapters: tuple[Chapter, ...] = ()  # of a video, in one file or several

    def __len__(self) -> int:
        return len(self.time_s)

    def label(self, k: int) -> str:
        """Name a frame as rows of picks do: by its number, or the image's file name."""
        return self.image_name[k] if self.image_name else str(k)

    def place(self, number: int, name: str) -> int:
        """Find a frame: among images by its file name or by the number in theirs.

        Args:
            number: of the frame
            name: of its image, with or without folders; empty where rows of picks number frames

        Raises:
            VopdError: there is none
        """
        known: Sequence[str | int] = self.image_name or range(len(self))
        if self.image_name and not name:
            known = image_numbers(self.image_name)
        wanted = PurePath(name).name if self.image_name and name else number
        if wanted not in known:
            raise VopdError(f"{self.source}: has no {name or f'frame {number}'}")
        return known.index(wanted)

    @property
    def lost(self) -> int:
        """How many more frames the index of the video has than are in its files."""
        return sum(one.lost for one in self.chapters)

    @property
    def hidden(self) -> int:
        """How many frames are in the files of the video, and no player shows them."""
        return sum(one.hidden for one in self.chapters)

    @property
    def missing(self) -> str:
        """Which numbers are missing among numbered images, in words; empty if none is.

        Images whose numbers go on by a step, as every tenth frame of a video, miss none.
        """
        numbers = sorted({*image_numbers(self.image_name)} - {-1})
        if len(numbers) < max(len(self.image_name), FEWEST_NUMBERED):
            return ""
        step = np.diff(numbers)
        usual = int(np.median(step))
        gaps = np.flatnonzero(step > usual)
        if (step % usual).any() or not len(gaps) or len(gaps) > MOST_GAPS * len(step):
            return ""
        first = [numbers[k] + usual for k in gaps.tolist()]
        last = [numbers[k + 1] - usual for k in gaps.tolist()]
        told = [f"{a} to {b}" if b > a else str(a) for a, b in zip(first, last, strict=True)]
        more = f" and {len(told) - SHOWN} more gaps" if len(told) > SHOWN else ""
        count = int((step[gaps] // usual - 1).sum())
        is_missing = f"{count_text(count, 'number')} {'is' if count == 1 else 'are'} missing"
        return f"{is_missing} among them: {', '.join(told[:SHOWN])}{more}"

    @property
    def about(self) -> str:
        """The number of frames, their rate, and what is odd about their times, in a sentence."""
        if not self.chapters:
            told = f"{self.source}: {count_text(len(self), 'image')}"
            return told + (f", {self.missing}" if self.missing else "")
        told = f"{self.source}: {count_text(len(self), 'frame')}"
        if self.lost:
            told += f" (and {self.lost} more that are not in the file: is it complete?)"
        if self.hidden:
            told += f" (and {self.hidden} more that its edit list does not show: was it trimmed?)"
        step_s = np.diff(self.time_s)
        if not len(step_s):
            return told
        usual_s = float(np.median(step_s))
        told += f" in {self.time_s[-1]:.3f} s"
        told += f", {1 / usual_s:.6g} a second" if usual_s > 0.0 else ""
        twice, gaps = int((step_s <= 0.0).sum()), int((step_s > GAP * usual_s).sum())
        even_s = step_s[(step_s > 0.0) & (step_s <= GAP * usual_s)]
        if len(even_s) and np.ptp(even_s) > VARIES * usual_s + TWO_MS:
            told += f", {1000 * even_s.min():.4g} to {1000 * even_s.max():.4g} ms apart"
        if twice:
            told += f", {twice} shown at the time of another"
        if gaps:
            told += f", {count_text(gaps, 'gap')} longer than {GAP:g} times that"
        return told

    def pictures(self, chosen: Iterable[int]) -> Iterator[Image]:
        """Iterate over some frames as upright images in RGB, one at a time.

        Raises:
            VopdError: if one cannot be decoded
        """
        for k in chosen:
            if not self.chapters:
                yield self._still(self.images[k])
                continue
            images = optional_package("PIL.Image", "images", "showing frames")
            for _, picture in self.decoded(k, k):
                yield images.fromarray(picture)

    def jpeg(self, k: int) -> bytes | None:
        """Read the file of an image that is a JPEG of eight bits and upright; None for others."""
        if not self.images:
            return None
        file = self.images[k].read_bytes()
        if not file.startswith(b"\xff\xd8"):
            return None
        with warnings.catch_warnings(action="ignore"), open_image(io.BytesIO(file)) as image:
            plain = image.mode in ("L", "RGB") and image.getexif().get(ORIENTATION, 1) == 1
        return file if plain else None

    def decoded(
        self, first: int, last: int, grey: bool = False,
        lost: Callable[[int], object] | None = None,
    ) -> Iterator[tuple[int, Any]]:  # fmt: skip
        """Iterate over frames of a video in their order, upright, each decoded once.

        Args:
            first: index of the first one
            last: index of the last one
            grey: whether the luminance is wanted, as the video has it, in the place of red, green
                and blue
            lost: is called with the index of a damaged frame, which is left out; None: that is an
                error

        Yields:
            The index of a frame, and its pixels, (H, W) or (H, W, 3), 0 to 255.

        Raises:
            VopdError: if one cannot be decoded
        """
        for one in self.chapters:
            low, high = max(first - one.first, 0), min(last - one.first, len(one.tick) - 1)
            if low > high:
                continue
            decode = _by_pyav if has_pyav() else _by_ffmpeg
            k = int(np.searchsorted(one.tick, one.tick[low]))  # two may be shown at one time
            try:
                for picture in decode(one, k, high, grey):
                    if k >= low:
                        if picture is not None:
                            yield one.first + k, picture
                        elif lost is None:
                            raise self.lost_frame(one.first + k)
                        else:
                            lost(one.first + k)
                    k += 1
            except NoDecoderError:
                raise
            except VopdError as error:
                raise self.lost_frame(one.first + k) from error
            if k <= high:
                raise self.lost_frame(one.first + k)

    def lost_frame(self, k: int) -> VopdError:
        """Make the error of a frame that cannot be decoded."""
        return VopdError(f"{self.source}: frame {k} cannot be decoded: is the file complete?")

    def _still(self, path: Path) -> Image:
        turned = optional_package("PIL.ImageOps", "images", "reading images")
        try:
            # of a name Pillow maps a bare TIFF that lies on its side as if it were upright
            with (
                warnings.catch_warnings(action="ignore"),
                path.open("rb") as file,
                open_image(file) as image,
            ):
                image.load()
                turned.exif_transpose(image, in_place=True)
                return eight_bits(image)
        except (OSError, ValueError, SyntaxError) as error:
            raise VopdError(
                f"{path.name}: not an image that can be read: {reason(error)}"
            ) from error


def open_image(source: Path | IO[bytes]) -> Image:
    """Open an image; its pixels are decoded when they are asked for.

    Raises:
        OSError: if it is of another kind than `STILLS`: Pillow runs other programs for some
        ValueError: if it has more pixels than Pillow decodes
    """
    pillow = optional_package("PIL.Image", "images", "reading images")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pillow.DecompressionBombWarning)
            image: Image = pillow.open(source, formats=KINDS)
            return image
    except pillow.DecompressionBombError as error:
        most = 2 * pillow.MAX_IMAGE_PIXELS // 1_000_000
        raise ValueError(f"it has more than {most} megapixels: save it smaller") from error


def upright_size(path: Path) -> tuple[int, int]:
    """Read width and height of an image as it is shown, without its pixels.

    Raises:
        VopdError: if it cannot be read
    """
    try:
        with warnings.catch_warnings(action="ignore"), open_image(path) as image:
            return size_as_shown(image)
    except (OSError, ValueError, SyntaxError) as error:
        raise VopdError(f"{path.name}: not an image that can be read: {reason(error)}") from error


def frame_size(path: Path) -> tuple[int, int]:
    """Read width and height of a video as it is shown, of the first of its frames that decodes.

    Raises:
        VopdError: if none does
    """
    picture = None
    if has_pyav():
        for frame in _decodable(path, -np.inf):
            picture = _upright(_luma(frame), frame)
            break
    else:
        one = ("-frames:v", "1", "-f", "image2pipe", "-vf", "format=gray", "-c:v", "pgm")
        with _ffmpeg(path, *one) as output:
            picture = _read_pnm(output)
    if picture is None:
        raise VopdError(f"{path.name}: no frame of it can be decoded: is the file complete?")
    height, width = picture.shape
    return width, height


def size_as_shown(image: Image) -> tuple[int, int]:
    """Read width and height of an opened image as it is shown upright.

    Of a TIFF they are its tags': newer versions of Pillow exchange its size on opening, older ones
    do not.
    """
    width, height = (
        getattr(image, "tag_v2", {}).get(*one) for one in zip(SIDES, image.size, strict=True)
    )
    return (height, width) if image.getexif().get(ORIENTATION) in ON_ITS_SIDE else (width, height)


def eight_bits(image: Image) -> Image:
    """Convert an image to RGB; one of 16 bits, as of thermal cameras, from its darkest pixel to
    its brightest."""
    if image.mode.startswith(("I", "F")):
        from PIL import Image as images

        width, height = image.size
        step = max(BAND // width, 1)
        low, high = np.inf, -np.inf
        for top in range(0, height, step):
            own = np.asarray(image.crop((0, top, width, min(top + step, height))))
            known = own[np.isfinite(own)]
            if len(known):
                low, high = min(low, float(known.min())), max(high, float(known.max()))
        if low > high:
            low = high = 0.0
        scale = 255.0 / (high - low) if high > low else 0.0
        grey = images.new("L", image.size)
        for top in range(0, height, step):
            band = image.crop((0, top, width, min(top + step, height)))
            own = np.nan_to_num(np.asarray(band, dtype=float), nan=low).clip(low, high)
            grey.paste(images.fromarray(((own - low) * scale).round().astype(np.uint8)), (0, top))
        image = grey
    return image if image.mode == "RGB" else image.convert("RGB")


def open_frames(names: Iterable[str]) -> VideoFrames:
    """Find the frames of a video, of a folder of images, or of images.

    Raises:
        VopdError: if there is none, or a video cannot be read
    """
    paths = [Path(name) for name in names]
    for path in paths:
        _refuse_no_file(path)
        if not path.exists():
            raise VopdError(f"{path}: there is no such file or folder")
    folders = [path for path in paths if path.is_dir()]
    if folders:
        if len(paths) > 1:
            raise VopdError(f"{folders[0]}: a folder of images is given alone")
        paths = stills_in(folders[0])
        if not paths:
            raise VopdError(f"{folders[0]}: no image is in it ({', '.join(STILLS)})")
        for path in paths:
            _refuse_no_file(path)
    moving = [path for path in paths if path.suffix.lower() not in STILLS]
    if not moving:
        _refuse_twins(paths)
        none = np.full(len(paths), np.nan)
        source = str(folders[0]) if folders else _together(paths)
        return VideoFrames(source, tuple(path.name for path in paths), none, images=tuple(paths))
    if len(moving) < len(paths):
        still = next(path for path in paths if path not in moving)
        raise VopdError(f"{still}: images and a video are not given together")
    return _of_chapters(paths)


ENDING = re.compile(r"(\d{1,15})\D*$", re.ASCII)


def image_numbers(image: Sequence[str]) -> list[int]:
    """Find the numbers at the ends of images' names, before the suffix; -1 where there is none."""
    found = [ENDING.search(name.rpartition(".")[0] or name) for name in image]
    return [-1 if one is None else int(one[1]) for one in found]


def find_images(known: Sequence[str], names: Iterable[str]) -> Ints:
    """Look up images among others by their names, -1 where there is none; folders do not count.

    A whole name comes first. A name that several others have in different folders is none of them,
    and none of several images is the only one that has their name.
    """
    row, names = {name: k for k, name in enumerate(known)}, [*names]
    ends = [PurePosixPath(name).name for name in row]
    alone = {end for end, count in Counter(ends).items() if count == 1}
    by_end = {end: k for end, k in zip(ends, row.values(), strict=True) if end in alone} | row
    found = [
        (row.get(name, by_end.get(PurePosixPath(name).name, -1)), name in row) for name in names
    ]
    count = Counter(found)
    only = [count[one] == 1 and (one[1] or not count[one[0], True]) for one in found]
    return np.array([k if own else -1 for (k, _), own in zip(found, only, strict=True)], np.int64)


def twins_text(image: Iterable[str]) -> str:
    """Name images that only their folders tell apart, for the end of a message; or nothing."""
    for name, count in Counter(PurePosixPath(one).name for one in image).items():
        if count > 1:
            return f"; {count} images are called {name}, and no folder tells which of them is meant"
    return ""


def images_without_number(image: Sequence[str]) -> dict[str, str]:
    """Find the images that have no number of their own at the end of their names, and say why.

    Of several with one number it is that of the image whose name is otherwise as most are.
    """
    found, known = dict[str, str](), dict[int, list[str]]()
    for name, number in zip(image, image_numbers(image), strict=True):
        known.setdefault(number, []).append(name)
    for name in known.pop(-1, []):
        found[name] = f"{name} has no number in its name, as frame_0100.png for frame 100"
    alike = Counter(map(_without_ending, image))
    for number, names in known.items():
        usual = max(alike[_without_ending(name)] for name in names)
        owner, *others = (name for name in names if alike[_without_ending(name)] == usual)
        for name in names if others else [name for name in names if name != owner]:
            other = owner if name != owner else next(one for one in names if one != owner)
            one = f"{name} and {other} have one number"
            found[name] = f"{one}, {number}: rename or remove one of them"
    return found


def _without_ending(name: str) -> str:
    """Take the number off the end of an image's name."""
    stem = name.rpartition(".")[0] or name
    return ENDING.sub(lambda found: found[0].removeprefix(found[1]), stem) + name[len(stem) :]


def stills_in(folder: Path) -> list[Path]:
    """List the images of a folder, in order of their names, or the one image that it is."""
    inside = folder.iterdir() if folder.is_dir() else [folder] if folder.is_file() else []
    return sorted(one for one in inside if one.suffix.lower() in STILLS)


def _together(paths: list[Path]) -> str:
    more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
    return paths[0].name + more


def _of_chapters(paths: list[Path]) -> VideoFrames:
    """Put the files of a video one after the other, each a frame's time after the one before."""
    chapters: list[Chapter] = []
    times: list[Floats] = []
    first, zero_s = 0, 0.0
    for path in paths:
        if path in [one.path for one in chapters]:
            raise VopdError(f"{path}: is given twice")
        tick, unit_s, lost, hidden = presentation(path)
        time_s = (tick - tick[0]) * unit_s
        chapters.append(Chapter(path, first, tick, unit_s, lost, hidden))
        times.append(zero_s + time_s)
        first += len(tick)
        usual_s = float(np.median(np.diff(time_s))) if len(tick) > 1 else 0.0
        zero_s += float(time_s[-1]) + usual_s
    return VideoFrames(_together(paths), (), np.concatenate(times), chapters=tuple(chapters))


def _refuse_no_file(path: Path) -> None:
    """Refuse a device, and a pipe, which may have no end."""
    if kind := no_file(path):
        raise VopdError(f"{path}: {kind}")


def _refuse_twins(paths: list[Path]) -> None:
    """Refuse two images of one file name, which picks could not tell apart."""
    seen: dict[str, Path] = {}
    for path in paths:
        if (other := seen.setdefault(path.name, path)) is not path:
            raise VopdError(f"{path}: has the name of {other}, and picks go by the name")


def presentation(path: Path) -> tuple[Ints, float, int, int]:
    """Read the presentation times of all frames of a video, in order, without decoding it.

    Returns:
        The times in the video's own unit, (F,), that unit, seconds, how many more frames its index
        has, by PyAV, and how many are not shown.

    Raises:
        VopdError: if it cannot be read, or has no frames
    """
    try:
        return _presentation(path)
    except VopdError as error:
        if told := _cut_off(path):
            raise VopdError(f"{path.name}: {told}") from error
        raise


MOST_BOXES = 1_000  # of an MP4: they are a handful, or the parts of a stream


def _cut_off(path: Path) -> str:
    """Say that an MP4 or MOV ends before one of its boxes does, or has no index.

    A box begins with its length and its name. What decoders say of such a file depends on where it
    ends.

    Returns:
        Empty for others.
    """
    whole = path.stat().st_size
    at, names = 0, list[bytes]()
    with path.open("rb") as file:
        while at < whole and len(names) < MOST_BOXES:
            file.seek(at)
            head = file.read(16)
            names.append(head[4:8])
            if names[0] not in (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip"):
                return ""
            size = int.from_bytes(head[:4])
            size = int.from_bytes(head[8:]) if size == 1 else size or whole - at
            at += max(size, 8)
    if at > whole:
        missing = count_text(at - whole, "byte is missing", "bytes are missing")
        return f"the file is cut off, {missing} at the end: copy it again"
    if at == whole and b"moov" not in names:
        return (
            "the file has no index (moov): the recording or the copy did not come to its end: copy "
            "it again, or repair it by the camera maker's program"
        )
    return ""


def _presentation(path: Path) -> tuple[Ints, float, int, int]:
    lost = hidden = 0
    with path.open("rb") as file:
        head = file.read(512)
    if head.startswith(LISTS):
        raise VopdError(
            f"{path.name}: is a list of other files, not a video: name these, in their order"
        )
    if _is_text(head):
        raise VopdError(f"{path.name}: is a text, not a video: {GIVE}")
    if has_pyav():
        with opened(path) as (container, stream):
            # the packets themselves are the whole file, and are not kept
            shown = []
            for one in container.demux(stream):
                if one.pts is not None:
                    hidden += one.is_discard
                    shown += [] if one.is_discard else [one.pts]
            codec = stream.codec_context
            if container.format.name == "avi" and codec.name in REORDERED and codec.has_b_frames:
                raise VopdError(
                    f"{path.name}: an AVI does not say when frames of its codec are shown; write "
                    f"it anew: {_written_anew(path)}"
                )
            unit_s = float(stream.time_base)
            lost = max(stream.frames - len(shown) - hidden, 0)
    else:
        shown, unit_s, hidden = _packets_by_ffmpeg(path)
    if not shown:
        raise VopdError(
            f"{path.name}: no frame of the video has a time of presentation; write it with the "
            f"camera's frames a second, here 30: {_written_anew(path, '-r 30 ')}"
        )
    return np.sort(np.array(shown, dtype=np.int64)), unit_s, lost, hidden


def _is_text(head: bytes) -> bool:
    """Tell whether a file begins as text, whose lines ffmpeg may draw as the frames of a video."""
    try:
        text = codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return False
    plain = all(one.isprintable() or one in "\t\r\n\f\x1b" for one in text)
    return bool(text) and plain and not head.startswith(b"YUV4MPEG")


# Decoders: PyAV, or the program ffmpeg


def has_pyav() -> bool:
    """Tell whether PyAV decodes: it is installed, or `ffmpeg` is not there either."""
    return _is_installed() or shutil.which("ffmpeg") is None


def has_decoder() -> bool:
    """Tell whether PyAV or `ffmpeg` is there."""
    return _is_installed() or shutil.which("ffmpeg") is not None


def _is_installed() -> bool:
    try:
        optional_package("av", "video")
    except VopdError:
        return False
    return True


def _written_anew(path: Path, before: str = "") -> str:
    """Write the command by which ffmpeg writes a video in H.264, each frame at its time.

    Args:
        path: of the video
        before: options that stand before it
    """
    return (
        f"ffmpeg {before}-i {shlex.quote(path.name)} -fps_mode passthrough -c:v libx264 -crf 15 "
        f"{shlex.quote(path.stem + '-h264.mp4')}"
    )


class NoDecoderError(VopdError):
    """No decoder is there for the codec of a video."""

    def __init__(self, path: Path, program: str) -> None:
        super().__init__(
            f"{path.name}: {program} has no decoder for its codec; write it in H.264 by the "
            f"camera maker's program, or by an ffmpeg that has one: {_written_anew(path)}"
        )


@contextmanager
def opened(path: Path) -> Iterator[tuple[Any, Any]]:
    """Open a video, and its first stream of frames.

    Raises:
        VopdError: if it cannot be read, or PyAV is not installed
    """
    try:
        av = optional_package("av", "video", f"{path.name}: reading videos")
    except VopdError as error:
        raise VopdError(f"{error}; or have the program ffmpeg on the path") from error
    try:
        # without file: a name with a colon, such as 12:30.mp4, is a protocol of the network
        with av.open(f"file:{path}", metadata_errors="replace") as container:
            if not container.streams.video:
                raise VopdError(f"{path.name}: no video is in it; is the file complete?")
            stream = container.streams.video[0]
            if stream.codec_context is None:
                raise NoDecoderError(path, "PyAV")
            yield container, stream
    except (av.error.FFmpegError, OSError) as error:
        raise VopdError(f"{path.name}: not a video that can be read: {reason(error)}") from error


def _by_pyav(chapter: Chapter, first: int, last: int, grey: bool) -> Iterator[Any]:
    """Decode frames of a file from one to another, by PyAV; None for one that is damaged.

    It ends where no later one is there.
    """
    k = first
    for sooner_s in (0.0, SOONER_S, np.inf):  # some files are sought with errors
        sought = chapter.tick[first] - sooner_s / chapter.unit_s
        if sought <= chapter.tick[0]:  # which some files cannot seek
            sought = -np.inf
        for number, frame in enumerate(_decodable(chapter.path, sought)):
            if k == first and frame.pts > chapter.tick[k] and not (number and sooner_s):
                break  # it was sought too late, perhaps
            while k <= last and frame.pts > chapter.tick[k]:
                yield None
                k += 1
            if k <= last and frame.pts == chapter.tick[k]:
                picture = _luma(frame) if grey else frame.to_ndarray(format="rgb24")
                yield _upright(picture, frame)
                k += 1
            if k > last:
                return
        if k > first:
            return


def _decodable(path: Path, sought: float) -> Iterator[Any]:
    """Iterate over the frames of a video that can be decoded, in the order in which they are shown.

    Behind a damaged packet they begin with the next key frame: those before it are made of what is
    missing. Decoders in threads say too late which packet it is, and so it is decoded again
    without.

    Args:
        path: of the file
        sought: time in the stream's unit, before which it begins; minus infinity: at its first
    """
    av = optional_package("av", "video", "reading videos")
    shown, damaged = -np.inf, -np.inf  # times in the stream's unit
    for threads in ("AUTO", "NONE"):
        with opened(path) as (container, stream):
            stream.thread_type, known = threads, shown
            if (start := max(sought, known)) > -np.inf:
                container.seek(int(start), stream=stream)
            for packet in container.demux(stream):
                try:
                    frames = packet.decode()
                except av.error.InvalidDataError:
                    if threads == "AUTO":
                        break
                    damaged = np.inf if packet.pts is None else packet.pts  # None: the last one
                    continue
                for frame in frames:
                    if frame.pts is None:
                        return
                    if frame.key_frame and frame.pts > damaged:
                        damaged = -np.inf
                    if damaged == -np.inf and frame.pts > known:
                        shown = frame.pts
                        yield frame
            else:
                return


def _upright(picture: Any, frame: Any) -> Any:
    """Turn and mirror the pixels of a frame as its display matrix says, to the nearest quarter.

    Args:
        picture: as stored, (H, W) or (H, W, 3)
        frame: of PyAV, with the matrix [a, b, u, c, d, v, x, y, w]: a pixel goes from x, y to
            ax + cy, bx + dy
    """
    own = [one for one in frame.side_data if one.type.name == "DISPLAYMATRIX"]
    if not own:
        return picture
    a, b, _, c, d, *_ = np.frombuffer(bytes(own[0]), np.int32).tolist()
    right, down = a, d
    if abs(b) > abs(a):
        picture, right, down = picture.swapaxes(0, 1), c, b
    return picture[:: -1 if down < 0 else 1, :: -1 if right < 0 else 1]


def _luma(frame: Any) -> Any:
    """Copy the luminance of a decoded frame, (H, W)."""
    own = frame if frame.format.name in WITH_LUMA else frame.reformat(format="yuv420p")
    plane = np.frombuffer(own.planes[0], np.uint8).reshape(-1, own.planes[0].line_size)
    return plane[: frame.height, : frame.width].copy()


FRAMECRC = re.compile(r"\d+,\s*-?\d+,\s*(-?\d+),[^F]*(?:F=0x([0-9A-F]+))?")
NO_TIME = -(2**63)  # of a packet, as ffmpeg writes it
DISCARD = 4  # a packet's flag: its frame is not shown


def _packets_by_ffmpeg(path: Path) -> tuple[list[int], float, int]:
    """Read the presentation times of the frames that are shown, their unit, seconds, and how many
    are not, by ffmpeg."""
    with _ffmpeg(path, "-c", "copy", "-f", "framecrc") as output:
        lines = output.read().decode("ascii", "replace").splitlines()
    unit_s = next((_tick_s(line) for line in lines if line.startswith("#tb 0:")), 1.0)
    packets = [found for line in lines if (found := FRAMECRC.match(line))]
    timeless = sum(int(found[1]) == NO_TIME for found in packets)
    if timeless == len(packets):
        return [], unit_s, 0
    if timeless:
        raise VopdError(
            f"{path.name}: ffmpeg does not say when its frames are shown, and PyAV does: pip "
            f"install av; or write it anew: {_written_anew(path)}"
        )
    shown = [int(found[1]) for found in packets if not int(found[2] or "0", 16) & DISCARD]
    return shown, unit_s, len(packets) - len(shown)


def _tick_s(line: str) -> float:
    """Read the unit of times, seconds, from the line `#tb 0: 1/90000`."""
    above, _, below = line.split()[-1].partition("/")
    return int(above) / int(below)


def _by_ffmpeg(chapter: Chapter, first: int, last: int, grey: bool) -> Iterator[Any]:
    """Decode frames of a file from one to another, by ffmpeg; it ends where one is not there."""
    low, high = (float(chapter.tick[k]) * chapter.unit_s for k in (first, last))
    half, start = 0.5 * chapter.unit_s, float(chapter.tick[0]) * chapter.unit_s
    # the frames have even times on the way out, so that no version repeats or drops one
    chosen = f"select=between(t\\,{low - half:.9f}\\,{high + half:.9f}),settb=1/25,setpts=N"
    chosen += f",format={'|'.join(WITH_LUMA)},extractplanes=y" if grey else ",format=rgb24"
    how = ("-vf", chosen, "-r", "25", "-frames:v", str(last - first + 1), "-f", "image2pipe")
    sooner = ("-ss", f"{low - start - SOONER_S:.6f}") if low - start > SOONER_S else ()
    with _ffmpeg(chapter.path, *how, "-c:v", "pgm" if grey else "ppm", before=sooner) as output:
        for _ in range(first, last + 1):
            if (picture := _read_pnm(output)) is None:
                return
            yield picture


def _read_pnm(stream: IO[bytes]) -> Any:
    """Read a picture in PGM or PPM of eight bits, (H, W) or (H, W, 3); None at the end."""
    words: list[bytes] = []
    while len(words) < 4:
        line = stream.readline()
        if not line:
            return None
        words += line.split()
    width, height = int(words[1]), int(words[2])
    shape = (height, width) if words[0] == b"P5" else (height, width, 3)
    size = int(np.prod(shape))
    content = stream.read(size)
    return None if len(content) < size else np.frombuffer(content, np.uint8).reshape(shape)


NO_DECODER = re.compile(r"no decoder found|decoder .*not found", re.IGNORECASE)


@contextmanager
def _ffmpeg(
    path: Path, *how: str, before: Sequence[str] = (), stream: str = "v:0"
) -> Iterator[IO[bytes]]:
    """Run ffmpeg on a stream of a video, the first one of frames, and read what it writes.

    Raises:
        VopdError: if it ends with an error
    """
    program = shutil.which("ffmpeg")
    assert program is not None
    command = [program, "-nostdin", "-v", "error", "-copyts", *before, "-i", f"file:{path}"]
    with (
        tempfile.TemporaryFile() as errors,
        subprocess.Popen(
            [*command, "-map", f"0:{stream}", *how, "-"], stdout=subprocess.PIPE, stderr=errors
        ) as process,
    ):
        assert process.stdout is not None
        try:
            yield process.stdout
            process.stdout.close()
            status = process.wait()
        finally:  # left early
            process.kill()
        if status:
            errors.seek(0)
            said = errors.read(10_000).decode("utf-8", "replace").strip().splitlines()
            if any(NO_DECODER.search(line) for line in said):
                raise NoDecoderError(path, "ffmpeg")
            why = re.sub(r"^(\[[^]]*\] *)+", "", said[0]) if said else "no reason given"
            raise VopdError(f"{path.name}: not a video that can be read: ffmpeg: {why}")


def payloads(path: Path, begin: bytes) -> list[tuple[float, float, bytes]]:
    """Read the packets of a video's first stream of data that begin in some way.

    Returns:
        When each is shown after the first frame and how long, seconds, and its content.

    Raises:
        VopdError: if the video cannot be read
    """
    tick, unit_s, *_ = presentation(path)
    zero_s = float(tick[0]) * unit_s
    if not has_pyav():
        return _payloads_by_ffmpeg(path, begin, zero_s)
    with opened(path) as (container, _):
        streams = [one for one in container.streams if one.type == "data"]
        found: dict[int, list[tuple[float, float, bytes]]] = {}
        for packet in container.demux(streams) if streams else ():
            if packet.pts is None or not packet.size:
                continue
            content = bytes(packet)
            if content.startswith(begin):
                unit = float(packet.time_base)
                one = packet.pts * unit - zero_s, (packet.duration or 0) * unit, content
                found.setdefault(packet.stream.index, []).append(one)
    return next((found[index] for index in sorted(found)), [])


MOST_STREAMS = 20  # of data, that are looked through by ffmpeg


def _payloads_by_ffmpeg(
    path: Path, begin: bytes, zero_s: float
) -> list[tuple[float, float, bytes]]:
    """Read the packets of data as `payloads` does: their times and sizes, then what is in them."""
    for stream in (f"d:{k}" for k in range(MOST_STREAMS)):
        try:
            with _ffmpeg(path, "-c", "copy", "-f", "framecrc", stream=stream) as output:
                lines = output.read().decode("ascii", "replace").splitlines()
            with _ffmpeg(path, "-c", "copy", "-f", "data", stream=stream) as output:
                content = output.read()
        except VopdError:  # there is no such stream
            return []
        unit_s = next((_tick_s(line) for line in lines if line.startswith("#tb 0:")), 1.0)
        found, at = [], 0
        for line in lines:
            if line.startswith("#"):
                continue
            shown, lasts, size = (int(part) for part in line.split(",")[2:5])
            own = content[at : at + size]
            at += size
            if own.startswith(begin):
                found.append((shown * unit_s - zero_s, lasts * unit_s, own))
        if found:
            return found
    return []


def spread(frames: VideoFrames, count: int) -> list[int]:
    """Choose frames spread over a video, the first and the last among them."""
    chosen = np.linspace(0, len(frames) - 1, min(count, len(frames)))
    return [int(k) for k in np.unique(np.round(chosen))]


# Frames one after the other, as grey pictures

BACKWARD_BYTES = 100_000_000  # of pictures that are held at once where frames are read backward


def grey_frames(
    frames: VideoFrames, first: int, last: int, tell: Callable[[str], object] = lambda _: None
) -> Iterator[tuple[int, Any]]:
    """Iterate over frames as grey pictures, each decoded once.

    Args:
        frames: of a video or images
        first: index of the first one
        last: index of the last one
        tell: is called with why an image cannot be read, or a frame be decoded

    Yields:
        The index of a frame and its grey levels, 0 to 255, (H, W), upright; one that cannot be read
        or decoded is black. A video that cannot be decoded to its end ends the iteration.

    Raises:
        VopdError: if the first frame of a video, or no image, can be decoded
    """
    seen, lost = False, list[int]()
    if not frames.chapters:
        for k in range(first, last + 1):
            try:
                (picture,) = frames.pictures([k])
            except VopdError as error:
                picture = _black(frames)
                tell(str(error))
            yield k, np.asarray(picture.convert("L"))
        return
    try:
        for k, grey in frames.decoded(first, last, grey=True, lost=lost.append):
            seen = True
            for damaged in lost:
                tell(str(frames.lost_frame(damaged)))
                yield damaged, np.zeros_like(grey)
            lost.clear()
            yield k, grey
    except VopdError:
        if not seen:
            raise


def _black(frames: VideoFrames) -> Image:
    """Make a black picture of the size of the first image that can be read."""
    for k in range(len(frames)):
        with suppress(VopdError):
            return next(frames.pictures([k])).point(lambda _: 0)
    raise VopdError(f"{frames.source}: no image in it can be read")


def grey_frames_backward(frames: VideoFrames, last: int, first: int) -> Iterator[tuple[int, Any]]:
    """Iterate over frames as grey pictures from the last to the first, a bounded number at a time.

    Args:
        frames: of a video or images
        last: index of the frame that comes first
        first: index of the frame that comes last
    """
    end, held = last, 1
    while end >= first:
        start = max(end - held + 1, first)
        some = list(grey_frames(frames, start, end))
        if some:  # and not all damaged
            held = max(int(BACKWARD_BYTES // max(some[0][1].nbytes, 1)), 1)
        yield from reversed(some)
        end = start - 1
