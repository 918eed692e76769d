"""Small videos, each of whose frames shows its number as a grey level."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from PIL.Image import Image

UNIT = 1_000  # of presentation times a second
LEVELS = 5  # of grey a frame, from 20 on
SIZE = (64, 48)


def write_video(path: Path, shown_ms: Sequence[int]) -> Path:
    """Write a video in H.264, with frames that refer to later ones.

    Args:
        path: where to
        shown_ms: when each frame is shown, milliseconds
    """
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.width, stream.height = SIZE
        stream.pix_fmt = "yuv420p"
        stream.codec_context.time_base = Fraction(1, UNIT)
        stream.options = {"crf": "10", "g": "12", "bf": "2"}
        for k, ms in enumerate(shown_ms):
            level = np.full((SIZE[1], SIZE[0], 3), 20 + LEVELS * k, np.uint8)
            frame = av.VideoFrame.from_ndarray(level, "rgb24")
            frame.pts, frame.time_base = ms, Fraction(1, UNIT)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def number_of(picture: Image) -> float:
    """The number of the frame that a picture shows."""
    return (float(np.asarray(picture).mean()) - 20.0) / LEVELS
