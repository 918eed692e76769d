"""The page on which landmarks are picked: frames in one HTML file that needs no other."""

from __future__ import annotations

import base64
import hashlib
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.files import ESCAPED
from vopd.findings import VopdError, count_text
from vopd.report import page_template, style_and_script
from vopd.video import VideoFrames

QUALITIES = (92, 85, 75)  # of JPEG: of the first one the difference is a grey level or two
WANTED_BYTES = 240_000_000  # of a page; of more frames the quality is lower
MOST_BYTES = 400_000_000  # of a page, which a browser still opens
MOST_SIDE_PX = 65_500  # of a JPEG, wide or high, as its encoder writes it
DIGITS = 13  # of a direction's components: a nanosecond of arc

# The page


class Predicted(NamedTuple):
    """What predicts N landmarks in the F frames of a page."""

    landmark: Sequence[str]  # names, (N,)
    direction: Floats  # (F, N, 3) unit vectors east, north, up from the camera; NaN where unknown
    lenses: Sequence[Mapping[str, object]]  # kind, focal, centre, skew, k, field
    which: Sequence[int]  # of them each frame has, (F,)
    sigma_px: float  # of one pick
    left_out: str  # what a solve has besides, for a sentence; empty for nothing


class PageContent(NamedTuple):
    """What a page begins with, besides its frames."""

    landmarks: Iterable[str] = ()  # names that are offered
    clicks: Sequence[tuple[str, str, float, float]] = ()
    # the picks that there are, also of other frames: frame or image, landmark, u and v in pixels
    # from the centre of the first pixel
    hidden: Sequence[tuple[str, str]] = ()  # frames and landmarks that are not to be seen there
    head: str = ""  # the first line of the file of picks
    hidden_head: str = "# hidden: "  # the beginning of its lines of hidden landmarks
    predicted: Predicted | None = None
    unpredicted: str = ""  # why nothing is predicted
    places: Sequence[tuple[str, str, str, tuple[float, float] | None]] = ()
    # where to click next: frame, landmark, why, and near which pixel
    deck: Mapping[str, object] | None = None  # the cards around the readings of a film
    film_number: Sequence[int] = ()  # of each frame, on those cards
    name: Sequence[str] = ()  # of all frames as picks have them; those of the files, if empty


def pick_page(
    frames: VideoFrames,
    chosen: Sequence[int],
    content: PageContent,
    file: str = "clicks.csv",
    tell: Callable[[], object] = lambda: None,
) -> bytes:
    """Make the page on which landmarks are picked, in UTF-8.

    Args:
        frames: of a video or a folder of images
        chosen: the indices of those on the page
        content: what the page begins with
        file: the name that the page gives to the file of picks
        tell: is called after each frame

    Raises:
        VopdError: if jinja2 is not installed, a frame cannot be read or is too wide, or they are
            too many
    """
    template = page_template("pick.html")
    rows, images, size = list[dict[str, Any]](), list[str](), 0
    for k in chosen:
        try:
            (picture,) = frames.pictures([k])
        except VopdError as error:
            if not frames.chapters or not k:
                raise
            before = chosen[: len(images)] or [0]
            at = ",".join(map(str, before))
            raise VopdError(f"{error} --at {at} takes frames before it") from error
        images.append(_jpeg(frames, k, picture, WANTED_BYTES // len(chosen)))
        size += len(images[-1])
        if size > MOST_BYTES:
            raise VopdError(
                f"{frames.source}: the page has more than {MOST_BYTES // 1_000_000} MB after "
                f"{count_text(len(images), 'frame')}; choose fewer with --at"
            )
        label, time_s = frames.label(k), frames.time_s[k]
        title = f"{label}, {time_s:.3f} s" if time_s == time_s else label
        width, height = picture.size
        name = content.name[k] if content.name else label
        rows.append({"name": name, "title": title, "width": width, "height": height})
        tell()
    here = {row["name"]: k for k, row in enumerate(rows)}
    known = [
        {"frame": here.get(frame, frame), "landmark": name, "u": u, "v": v}
        for frame, name, u, v in content.clicks
    ]
    hidden = [{"frame": here.get(one, one), "landmark": name} for one, name in content.hidden]
    by = content.predicted
    if by is not None:
        rounded = np.round(by.direction, DIGITS).tolist()
        for row, lens, to in zip(rows, by.which, rounded, strict=True):
            row["lens"] = lens
            row["to"] = [one if one[0] == one[0] else None for one in to]
    for row, number in zip(rows, content.film_number, strict=False):
        row["number"] = number
    digest = hashlib.sha256(
        f"{frames.source} {[*here]} {known} {hidden} {content.deck}".encode("utf-8", ESCAPED)
    )
    names = [
        *content.landmarks,
        *(one["landmark"] for one in known if one["frame"] in here.values()),
    ]
    page = template.render(
        source=_own_name(frames.source),
        file=file,
        images=images,
        data={
            "head": content.head,
            "hiddenHead": content.hidden_head,
            "column": "image" if here.keys() & {*frames.image_name} else "frame",
            "key": digest.hexdigest(),
            "frames": rows,
            "landmarks": list(dict.fromkeys(names)),
            "picks": known,
            "hidden": hidden,
            "lenses": [] if by is None else by.lenses,
            "sighted": [] if by is None else list(by.landmark),
            "sigma": 1.0 if by is None else by.sigma_px,
            "leftOut": "" if by is None else by.left_out,
            "unpredicted": content.unpredicted,
            "places": [
                {"frame": here[frame], "landmark": name, "text": text, "near": near}
                for frame, name, text, near in content.places
                if frame in here
            ],
            "deck": content.deck,
        },
        **style_and_script("pick"),
    )
    return page.encode("utf-8", "replace")


def _own_name(source: str) -> str:
    """Name a folder that is given as . or .. by its own name."""
    return source if Path(source).name not in ("", "..") else Path(source).resolve().name or source


def _jpeg(frames: VideoFrames, k: int, picture: Any, most: int) -> str:
    """Write a frame as JPEG in base 64, of at most so many characters if it can be.

    An image that is such a file already, and upright, stays as it is, to the last pixel.

    Raises:
        VopdError: if it has more pixels in a row or a column than a JPEG can have
    """
    own = frames.jpeg(k)
    if own is not None and len(own) * 4 // 3 <= most:
        return base64.b64encode(own).decode()
    width, height = picture.size
    if max(width, height) > MOST_SIDE_PX:
        raise VopdError(
            f"{frames.label(k)}: the image has {width} x {height} pixels, and on the page, as a "
            f"JPEG, none can have more than {MOST_SIDE_PX:,} either way: save it smaller, or cut it"
        )
    for quality in QUALITIES:
        buffer = io.BytesIO()
        picture.save(buffer, "JPEG", quality=quality, subsampling=0)
        if buffer.tell() * 4 // 3 <= most:
            break
    return base64.b64encode(buffer.getvalue()).decode()
