"""The page on which landmarks are picked: frames in one HTML file that needs no other."""

from __future__ import annotations

import base64
import hashlib
import io
from collections.abc import Callable, Iterable, Sequence

from vopd.findings import VopdError
from vopd.report import page_template, style_and_script
from vopd.video import VideoFrames

QUALITY = 92  # of JPEG: the difference is less than a grey level or two
MOST_BYTES = 400_000_000  # of a page, which a browser still opens


def pick_page(
    frames: VideoFrames,
    chosen: Sequence[int],
    landmarks: Iterable[str] = (),
    clicks: Iterable[tuple[str, str, float, float]] = (),
    head: str = "",
    file: str = "clicks.csv",
    tell: Callable[[], object] = lambda: None,
) -> bytes:
    """Make the page on which landmarks are picked, in UTF-8.

    Args:
        frames: of a video or a folder of images
        chosen: the indices of those on the page
        landmarks: names that are offered
        clicks: the picks that there are: frame or image, landmark, u and v in pixels from the
            centre of the first pixel
        head: the first line of the file of picks
        file: the name that the page gives to the file of picks
        tell: is called after each frame

    Raises:
        VopdError: if jinja2 is not installed, a frame cannot be read, or they are too many
    """
    template = page_template("pick.html")
    rows, images, size = [], [], 0
    for k, picture in zip(chosen, frames.pictures(chosen), strict=True):
        buffer = io.BytesIO()
        picture.save(buffer, "JPEG", quality=QUALITY, subsampling=0)
        images.append(base64.b64encode(buffer.getvalue()).decode())
        size += len(images[-1])
        if size > MOST_BYTES:
            raise VopdError(
                f"{frames.source}: the page has more than {MOST_BYTES // 1_000_000} MB after "
                f"{len(images)} frames; choose fewer with --at"
            )
        label, time_s = frames.label(k), frames.time_s[k]
        title = f"{label}, {time_s:.3f} s" if time_s == time_s else label
        width, height = picture.size
        rows.append({"name": label, "title": title, "width": width, "height": height})
        tell()
    here = {row["name"]: k for k, row in enumerate(rows)}
    known = [
        {"frame": here[frame], "landmark": name, "u": u, "v": v}
        for frame, name, u, v in clicks
        if frame in here
    ]
    digest = hashlib.sha256(f"{frames.source} {[*here]} {known}".encode()).hexdigest()
    page = template.render(
        source=frames.source,
        file=file,
        images=images,
        data={
            "head": head,
            "column": "image" if frames.image_name else "frame",
            "key": digest,
            "frames": rows,
            "landmarks": list(
                dict.fromkeys([*landmarks, *(str(row["landmark"]) for row in known)])
            ),
            "picks": known,
        },
        **style_and_script("pick"),
    )
    return page.encode("utf-8", "replace")
