"""All that is found out about videos and images, frame by frame, by PyAV and by ffmpeg."""

from __future__ import annotations

import os
import struct
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from PIL import Image

from tests.approved.texts import assert_approved
from tests.kit.video import SIZE, number_of, write_stub, write_video
from tests.kit.whole import whole
from vopd import video
from vopd.findings import VopdError
from vopd.flight.project.new import example_project
from vopd.video import (
    VideoFrames,
    find_images,
    grey_frames,
    grey_frames_backward,
    images_without_number,
    open_frames,
    payloads,
    spread,
    twins_text,
    upright_size,
)


def told(names: list[str]) -> str:
    """Tell all of the frames of some files: what they are, what they show, what cannot be read."""
    try:
        frames = open_frames(names)
    except VopdError as error:
        return f"refused: {error}"
    said, last = list[str](), len(frames) - 1
    shown = grey_frames(frames, 0, last, said.append)
    # the luminance of black is 16, that of white 235
    numbers = {k: round(number_of(Image.fromarray((grey - 16.0) * 255 / 219))) for k, grey in shown}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(video, "BACKWARD_BYTES", 3 * SIZE[0] * SIZE[1])
        backward = [k for k, _ in grey_frames_backward(frames, last, min(2, last))]
    sizes = [
        f"{one.mode} {one.size} {number_of(one):.0f}"
        for k in spread(frames, 3)
        for one in _picture(frames, k)
    ]
    return whole(frames) + "\n" + whole({
        "lost": frames.lost, "hidden": frames.hidden, "missing": frames.missing,
        "about": frames.about, "labels": [frames.label(0), frames.label(last)], "told": said,
        "levels": numbers, "backward": backward, "sizes": sizes, "spread": spread(frames, 4),
        "jpeg": [len(frames.jpeg(k) or b"") > 0 for k in (0, last)],
        "some": [k for k, _ in frames.decoded(1, min(3, last))],
    })  # fmt: skip


def _picture(frames: VideoFrames, k: int) -> list[Any]:
    try:
        return list(frames.pictures([k]))
    except VopdError:
        return []


def boxes(*own: tuple[bytes, int, int]) -> bytes:
    """Write boxes of an MP4: name, the length that is stated, and the bytes that follow it."""
    return b"".join(struct.pack(">L4s", size, name) + bytes(more) for name, size, more in own)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


EVEN_MS = [40 * k for k in range(9)]
LONG_MS = [1000 * k + 700 for k in range(14)]


def write_all(folder: Path) -> dict[str, list[str]]:
    """Write videos of many kinds; files by what they are."""
    write_video(folder / "even.mp4", EVEN_MS)
    write_video(folder / "uneven.mkv", [500, 533, 566, 600, 833, 866, 1000])
    write_video(folder / "varies.mp4", [0, 32, 80, 112, 160, 208])
    write_video(folder / "one.mp4", [0])
    write_video(folder / "long.mkv", LONG_MS)
    write_video(folder / "flash.flv", EVEN_MS)
    content = example_project().contents["flight.mp4"]
    (folder / "cut.mp4").write_bytes(content[: len(content) // 2])
    hidden = bytearray(content)
    at = hidden.index(b"mdhd") + 16
    hidden[at : at + 4] = bytes(4)
    (folder / "hidden.mp4").write_bytes(hidden)
    return {
        "chapters": ["even.mp4", "uneven.mkv", "one.mp4", "varies.mp4"], "long": ["long.mkv"],
        "one": ["one.mp4"], "flash": ["flash.flv"],
    }  # fmt: skip


def test_videos_frame_by_frame(folder: Path) -> None:
    for names in write_all(folder).values():
        assert_approved(told(names))
    for name in ("cut.mp4", "hidden.mp4"):
        (folder / f"more-{name}").write_bytes((folder / name).read_bytes())
        frames = open_frames([name, f"more-{name}"])
        assert_approved([frames.about, (frames.lost > 0, frames.hidden > 0, len(frames.chapters))])
        assert frames.lost == 2 * frames.chapters[0].lost
        assert frames.hidden == 2 * frames.chapters[0].hidden


@pytest.mark.skipif(os.name == "nt", reason="the stub is a script")
def test_what_ffmpeg_is_asked_for(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a program that stands for it, with the same answers as PyAV's but for what is lost."""
    every = write_all(folder)
    by_pyav = {name: told(names) for name, names in every.items()}
    write_stub(folder / "bin" / "ffmpeg")
    monkeypatch.setenv("PATH", str(folder / "bin"), prepend=os.pathsep)
    monkeypatch.setitem(sys.modules, "av", None)
    asked, popen = list[str](), video.subprocess.Popen

    def noted(command: list[str], **more: Any) -> Any:
        asked.append(" ".join(command[1:]))
        return popen(command, **more)

    monkeypatch.setattr(video.subprocess, "Popen", noted)
    assert told(every["chapters"]) == by_pyav["chapters"]
    frames = open_frames(["long.mkv"])
    for first, last, grey in ((0, 1, True), (9, 9, False), (12, 13, True)):
        shown = [k for k, _ in frames.decoded(first, last, grey)]
        assert shown == [*range(first, last + 1)]
    assert_approved(asked)


@pytest.mark.skipif(os.name == "nt", reason="the stub is a script")
def test_packets_that_are_not_shown_by_ffmpeg(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stub = folder / "bin" / "ffmpeg"
    stub.parent.mkdir()
    flags = ("", ", F=0x4", ", S=1, 8, 0x2, F=0x5", ", F=0x1", ", F=0xC", ", F=0x0")
    times = (300, 0, 100, 500, 400, -100)
    lines = [f"0, {t}, {t}, 100, 607, 0xc0{flag}" for t, flag in zip(times, flags, strict=True)]
    echoes = [f"echo '{one}'" for one in ("#tb 0: 1/1000", "#media_type 0: video", *lines)]
    stub.write_text("\n".join(["#!/bin/sh", *echoes, ""]))
    stub.chmod(0o755)
    monkeypatch.setenv("PATH", str(stub.parent), prepend=os.pathsep)
    monkeypatch.setitem(sys.modules, "av", None)
    (folder / "a.mpg").write_bytes(b"\0any")
    frames = open_frames(["a.mpg"])
    assert_approved(whole(frames) + f"\n{frames.about}")


def test_files_that_end_too_early(folder: Path) -> None:
    """Boxes of an MP4 by their lengths, of which one says that 8 bytes have it, or the end."""
    head = (b"ftyp", 16, 8)
    for k, content in enumerate((
        boxes(head, (b"mdat", 100, 92)), boxes(head, (b"mdat", 100, 90)),
        boxes(head, (b"mdat", 0, 50)), boxes(head, (b"free", 8, 0), (b"wide", 8, 0)),
        boxes(head) + struct.pack(">L4sQ", 1, b"mdat", 40) + bytes(24),
        boxes(head) + struct.pack(">L4sQ", 1, b"mdat", 400) + bytes(24),
        boxes((b"skip", 8, 0), (b"mdat", 9, 0)), boxes((b"wide", 8, 0)), boxes((b"free", 12, 4)),
        boxes(head, (b"moov", 8, 0), (b"mdat", 20, 0)), boxes(head, (b"moov", 8, 0)),
        boxes((b"abcd", 80, 0)), boxes(head, *[(b"free", 8, 0)] * 1000, (b"mdat", 80, 0)),
        boxes(head, (b"mdat", 4, 0), (b"mdat", 8, 4)),
    )):  # fmt: skip
        (folder / f"{k}.mp4").write_bytes(content)
        with pytest.raises(VopdError) as error:
            open_frames([f"{k}.mp4"])
        own = str(error.value)
        assert_approved(own if "the file" in own else "in others' words")


def test_images_of_every_kind(folder: Path) -> None:
    """By their names, kinds, modes and the eight ways in which a camera may have been turned."""
    rng = np.random.default_rng(2)
    grey = Image.fromarray(np.kron(rng.integers(0, 256, (6, 8)), np.ones((8, 8))).astype(np.uint8))
    for k, suffix in enumerate((".png", ".BMP", ".tif", ".tiff", ".webp")):
        grey.save(folder / f"kind_{k}{suffix}", **({"lossless": True} if k == 4 else {}))
    for way in range(9):
        exif = Image.Exif()
        exif[274] = way
        grey.save(folder / f"way_{way}.png", exif=exif)
        grey.save(folder / f"way_{way}.TIF", exif=exif)
    for k, mode in enumerate(("1", "LA", "P", "RGBA", "CMYK", "I", "F", "I;16")):
        grey.convert(mode).save(folder / f"mode_{k}.tif")
    (folder / "mode_9.png").write_bytes(b"none")
    for mode, way in (("L", 1), ("CMYK", 1), ("RGB", 2), ("RGB", 1)):
        exif = Image.Exif()
        exif[274] = way
        grey.convert(mode).save(folder / f"{mode}_{way}.jpeg", exif=exif)
    frames = open_frames([str(folder)])
    for way in range(9):
        alike = [frames.place(0, f"way_{way}{suffix}") for suffix in (".png", ".TIF")]
        one, other = map(np.asarray, frames.pictures(alike))
        np.testing.assert_array_equal(one, other)
    said = []
    for k, name in enumerate(frames.image_name):
        size = upright_size(frames.images[k]) if name != "mode_9.png" else None
        jpeg, shown = frames.jpeg(k) is not None, _picture(frames, k)
        cells = whole(shown[0], "shown") if shown and not name.endswith(".jpeg") else len(shown)
        said.append(f"{name}: {size}, JPEG as it is: {jpeg}, {cells}")
    assert_approved(said)


@pytest.mark.parametrize("numbers", [
    "a f_1 f_2 f_4", "f_1 f_2 f_4 f_5 f_6 f_7", "f_1 f_2 f_3 f_6 f_7 f_8 f_9",
    "f_1 f_3", "f_0 f_2 f_6 f_8 f_10 f_12 f_16",
    "f_1 f_2 f_9 f_10 f_11 f_20 f_21 f_22 f_23 f_24 f_30 f_31 f_32 f_33 f_34 f_36 f_37 f_38 f_39 "
    "f_40 f_41 f_42", "f_1 f_01 f_2 g_2 h f_3", "2 3 5 6 7 8 9", "f_0 f_1 f_2 f_\u0663 f_4 f_5 f_6",
])  # fmt: skip
def test_numbers_of_images(numbers: str, folder: Path) -> None:
    (folder / "i").mkdir()
    for name in numbers.split():
        (folder / "i" / f"{name}.png").write_bytes(b"")
    (folder / "i" / "notes.txt").write_bytes(b"")
    frames = open_frames([str(folder / "i")])
    names = frames.image_name
    found = [frames.place(k, "") for k in (1, 2) if k in video.image_numbers(names)]
    for number, name in ((99, ""), (0, "i/none.png")):
        with pytest.raises(VopdError) as error:
            frames.place(number, name)
        found.append(str(error.value).replace(str(folder), "FOLDER"))
    only = open_frames([str(one) for one in frames.images])
    assert_approved([
        str(names), frames.missing, frames.about.replace(str(folder), "FOLDER"), only.source,
        str(video.image_numbers(names)), str(images_without_number(names)), str(found),
        str(frames.place(0, f"elsewhere/{names[-1]}")),
    ])  # fmt: skip


def test_images_that_are_looked_up() -> None:
    """Whole names first, then the ends of names that one image alone has."""
    known = ["a/1.png", "b/1.png", "2.png", "c/3.png", "d/4.png", "4.png"]
    said = [
        f"{names}: {find_images(known, names).tolist()}"
        for names in (
            ["1.png"], ["a/1.png", "x/2.png"], ["x/2.png", "y/2.png"], ["2.png", "x/2.png"],
            ["c/3.png", "3.png"], ["4.png", "x/4.png"], ["d/4.png", "e/4.png"], ["5.png"],
        )
    ]  # fmt: skip
    said += [twins_text(names) for names in (known, ["a/7", "b/7", "c/7", "d/8"], ["a", "b"])]
    assert_approved(said)


@pytest.mark.skipif(os.name == "nt", reason="the stub is a script")
def test_packets_of_data(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two streams the first with what is sought, after a first frame that is late."""
    with av.open("a.mp4", "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.width, stream.height = SIZE
        stream.pix_fmt, stream.codec_context.time_base = "yuv420p", Fraction(1, 1000)
        data = [container.add_data_stream("bin_data") for _ in range(3)]
        for k in range(3):
            frame = av.VideoFrame.from_ndarray(np.zeros((SIZE[1], SIZE[0], 3), np.uint8), "rgb24")
            frame.pts, frame.time_base = 250 + 1000 * k, Fraction(1, 1000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
        for k, (own, content) in enumerate(
            ((2, b"DEVCz"), (0, b"none"), (1, b"DEVCa"), (1, b"other"), (1, b"DEVCbb"))
        ):
            packet = av.Packet(content)
            packet.stream, packet.time_base = data[own], Fraction(1, 1000)
            packet.pts = packet.dts = 500 * k
            packet.duration = 400 + k
            container.mux(packet)
    found = payloads(folder / "a.mp4", b"DEVC")
    assert_approved(whole(found, "found"))
    write_stub(folder / "bin" / "ffmpeg")
    monkeypatch.setenv("PATH", str(folder / "bin"), prepend=os.pathsep)
    monkeypatch.setitem(sys.modules, "av", None)
    assert whole(payloads(folder / "a.mp4", b"DEVC")) == whole(found)
    assert payloads(folder / "a.mp4", b"neither") == []
