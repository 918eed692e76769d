"""Small videos, each of whose frames shows its number as a grey level."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from PIL.Image import Image

UNIT = 1_000  # of presentation times a second
LEVELS = 5  # of grey a frame, from 20 on
SIZE = (64, 48)


def write_video(
    path: Path, shown_ms: Sequence[int], bright_corner: bool = False, pixels: str = "yuv420p"
) -> Path:
    """Write a video in H.264, with frames that refer to later ones.

    Args:
        path: where to
        shown_ms: when each frame is shown, milliseconds
        bright_corner: whether the left half of the first eight rows is white
        pixels: the format of pixels
    """
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.width, stream.height = SIZE
        stream.pix_fmt = pixels
        stream.codec_context.time_base = Fraction(1, UNIT)
        stream.options = {"crf": "10", "g": "12", "bf": "2"}
        for k, ms in enumerate(shown_ms):
            level = np.full((SIZE[1], SIZE[0], 3), 20 + LEVELS * k, np.uint8)
            if bright_corner:
                level[:8, : SIZE[0] // 2] = 255
            frame = av.VideoFrame.from_ndarray(level, "rgb24")
            frame.pts, frame.time_base = ms, Fraction(1, UNIT)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def number_of(picture: Image) -> float:
    """The number of the frame that a picture shows."""
    return (float(np.asarray(picture).mean()) - 20.0) / LEVELS


def write_gpmf(path: Path, packets: Sequence[tuple[int, bytes]]) -> Path:
    """Write a video of a frame a packet, with a stream of data.

    Args:
        path: where to; its suffix is .mp4
        packets: when each begins, milliseconds, and what is in it
    """
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.width, stream.height = SIZE
        stream.pix_fmt = "yuv420p"
        stream.codec_context.time_base = Fraction(1, UNIT)
        data = container.add_data_stream("bin_data")
        data.time_base = Fraction(1, UNIT)
        for ms, _ in packets:
            frame = av.VideoFrame.from_ndarray(np.zeros((SIZE[1], SIZE[0], 3), np.uint8), "rgb24")
            frame.pts, frame.time_base = ms, Fraction(1, UNIT)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
        for ms, content in packets:
            packet = av.Packet(content)
            packet.stream, packet.time_base = data, Fraction(1, UNIT)
            packet.pts = packet.dts = ms
            packet.duration = 1000
            container.mux(packet)
    return path


def klv(key: str, kind: str, size: int, count: int, content: bytes) -> bytes:
    """Write an entry of GPMF: key, type, size, number, content to whole words."""
    head = key.encode() + (kind or "\0").encode() + bytes([size]) + count.to_bytes(2, "big")
    return head + content + b"\0" * (-len(content) % 4)


STUB = r"""#!{python}
import re, sys
import av
given = sys.argv[1:]
try:
    container = av.open(given[given.index("-i") + 1].removeprefix("file:"))
except av.error.FFmpegError as error:
    sys.exit(str(error))
_, letter, number = given[given.index("-map") + 1].split(":")
kinds = [one for one in container.streams if one.type[0] == letter]
if int(number) >= len(kinds):
    sys.exit("Stream map matches no streams.")
stream, out = kinds[int(number)], sys.stdout.buffer
unit = float(stream.time_base)
if "framecrc" in given:
    out.write(f"#tb 0: {{stream.time_base}}\n".encode())
    for packet in container.demux(stream):
        if packet.pts is not None:
            times = f"0, {{packet.pts}}, {{packet.pts}}, {{packet.duration}}"
            out.write(f"{{times}}, {{packet.size}}, 0x0\n".encode())
elif "data" in given:
    for packet in container.demux(stream):
        out.write(bytes(packet))
elif stream.codec_context is None:
    sys.exit("Decoder (codec none) not found for input stream #0:0")
else:
    low, high = map(float, re.search(r"t.,([-\d.]+).,([-\d.]+)", " ".join(given)).groups())
    for frame in container.decode(stream):
        if low <= frame.pts * unit <= high:
            if "pgm" in given:
                plane = frame.planes[0]
                rows = [bytes(plane)[k * plane.line_size :] for k in range(frame.height)]
                content, kind = b"".join(row[: frame.width] for row in rows), 5
            else:
                content, kind = frame.to_ndarray(format="rgb24").tobytes(), 6
            out.write(f"P{{kind}}\n{{frame.width}} {{frame.height}}\n255\n".encode() + content)
"""


def write_stub(path: Path) -> None:
    """Write a program that answers as ffmpeg does to what `vopd.video` asks it, by PyAV."""
    path.parent.mkdir(exist_ok=True)
    path.write_text(STUB.format(python=sys.executable))
    path.chmod(0o755)
