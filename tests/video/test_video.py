"""Frames of videos and of folders of images: order, times, pixels, and what cannot be read."""

from __future__ import annotations

import os
import shutil
import struct
import sys
import wave
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from tests.approved.texts import assert_approved, refused
from tests.kit.command import peak
from tests.kit.flight_project import TOML, write_project
from tests.kit.video import LEVELS, SIZE, number_of, write_stub, write_video
from tests.tolerances import assert_close
from vopd import video
from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight.project.new import example_project
from vopd.flight.project.read import read_flight
from vopd.video import (
    Chapter,
    VideoFrames,
    eight_bits,
    grey_frames,
    grey_frames_backward,
    open_frames,
    spread,
)

EVEN_MS = [40 * k for k in range(40)]
UNEVEN_MS = [0, 33, 66, 100, 133, 333, 366, 400, 433]  # five frames are missing after the fifth


def test_frames_count_in_the_order_in_which_they_are_shown(tmp_path: Path) -> None:
    """Frames of H.264 are stored in another order; a grey level says which each is."""
    frames = open_frames([str(write_video(tmp_path / "a.mp4", EVEN_MS))])
    assert len(frames) == 40 and not frames.image_name
    chosen = [39, 0, 13, 11, 12, 25]
    found = [number_of(picture) for picture in frames.pictures(chosen)]
    assert_close("frame by its grey level", found, chosen)
    assert [frames.label(k) for k in (0, 39)] == ["0", "39"]


def test_times_of_presentation(tmp_path: Path) -> None:
    frames = open_frames([str(write_video(tmp_path / "a.mp4", UNEVEN_MS))])
    assert_close("presentation time", frames.time_s, np.array(UNEVEN_MS) / 1000.0)
    assert_approved(frames.about)
    varying = open_frames([str(write_video(tmp_path / "b.mp4", [0, 32, 80, 112, 160, 208]))])
    assert_approved(varying.about)


def test_frames_that_are_all_shown_at_one_time() -> None:
    chapter = Chapter(Path("a.mp4"), 0, np.zeros(3, np.int64), 1e-3, 0)
    assert_approved(VideoFrames("a.mp4", (), np.zeros(3), chapters=(chapter,)).about)


def test_a_video_whose_tags_are_not_utf_8(tmp_path: Path) -> None:
    path = write_video(tmp_path / "a.mp4", [0, 40, 80])
    content = path.read_bytes()
    assert b"VideoHandler" in content
    path.write_bytes(content.replace(b"VideoHandler", b"Video\xffandler"))
    assert len(open_frames([str(path)])) == 3


def test_a_video_that_is_cut_off_behind_its_index(tmp_path: Path) -> None:
    content = example_project().contents["flight.mp4"]
    (tmp_path / "cut.mp4").write_bytes(content[: len(content) // 2])
    frames = open_frames([str(tmp_path / "cut.mp4")])
    assert len(frames) < 51 == len(frames) + frames.chapters[0].lost
    assert_approved(frames.about)


@pytest.mark.parametrize("decodes", [True, False], ids=["PyAV", "ffmpeg"])
def test_a_video_that_is_cut_off_within_its_index(
    decodes: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a decoder says depends on the place: no decoder, no frame, no time, no valid data."""
    if not decodes and shutil.which("ffmpeg") is None:
        pytest.skip("ffmpeg is not there")
    content = write_video(tmp_path / "a.mp4", EVEN_MS).read_bytes()
    index = content.index(b"moov") - 4
    monkeypatch.setattr("vopd.video.has_pyav", lambda: decodes)
    inside = [content.index(name) for name in (b"mvhd", b"stsd", b"avcC", b"stts", b"stsz")]
    whole = int.from_bytes(content[index : index + 4])
    for end in (index - 9, index + 8, *inside):
        (tmp_path / "cut.mp4").write_bytes(content[:end])
        missing = (index if end < index else index + whole) - end
        with refused(VopdError, parts=[f"{missing} bytes"]):
            open_frames([str(tmp_path / "cut.mp4")])
    (tmp_path / "cut.mp4").write_bytes(content[:index])
    with refused(VopdError):
        open_frames([str(tmp_path / "cut.mp4")])


def test_frames_that_an_edit_list_does_not_show(tmp_path: Path) -> None:
    """Without a unit of time all but the first are behind the end of the list."""
    content = bytearray(example_project().contents["flight.mp4"])
    at = content.index(b"mdhd") + 16  # the units a second
    content[at : at + 4] = bytes(4)
    (tmp_path / "a.mp4").write_bytes(content)
    frames = open_frames([str(tmp_path / "a.mp4")])
    assert (len(frames), frames.hidden, frames.lost) == (1, 50, 0)
    assert_approved(frames.about)


def test_a_pick_of_a_frame_that_an_edit_list_does_not_show(tmp_path: Path) -> None:
    keys = '[picks]\nvideo = "a.mp4"\nfile'
    project = write_project(tmp_path, TOML.replace("[picks]\nfile", keys, 1))
    content = bytearray(example_project().contents["flight.mp4"])
    at = content.index(b"mdhd") + 16
    content[at : at + 4] = bytes(4)
    (tmp_path / "a.mp4").write_bytes(content)
    with refused(VopdError, parts=[tmp_path]):
        read_flight(str(project))


def test_numbers_that_are_missing_among_images(tmp_path: Path) -> None:
    """Gaps of one and of several numbers, every tenth frame, a choice of frames, no numbers."""
    told = []
    for k, numbers in enumerate((
        [*range(7), *range(8, 20), *range(25, 60)],
        [*range(0, 200, 10), 230, 240],
        range(0, 200, 10), [3, 17, 40, 41, 90], [5], [*range(5), *range(6, 10), *range(11, 14)],
        [0, 1, 3, 4, 6, 7, 8, 9], [*range(0, 200, 10), 205],
    )):  # fmt: skip
        folder = tmp_path / str(k)
        folder.mkdir()
        for number in numbers:
            (folder / f"frame_{number:04d}.png").write_bytes(b"")
        told.append(open_frames([str(folder)]).about.removeprefix(str(folder)))
    assert_approved("\n".join(told))
    chosen = open_frames([str(tmp_path / "3")])  # 3, 17, 40, 41 and 90
    assert chosen.place(40, "") == chosen.place(0, "frame_0040.png") == 2


def test_a_codec_without_a_decoder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By PyAV, and by a program that stands for ffmpeg."""
    content = example_project().contents["flight.mp4"]
    where = content.rindex(b"avc1")
    (tmp_path / "raw.mp4").write_bytes(content[:where] + b"zzzz" + content[where + 4 :])
    monkeypatch.chdir(tmp_path)
    with refused():
        open_frames(["raw.mp4"])
    if os.name != "nt":
        write_stub(tmp_path / "bin" / "ffmpeg")
        monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=os.pathsep)
        monkeypatch.setitem(sys.modules, "av", None)
        with refused():
            next(open_frames(["raw.mp4"]).decoded(0, 0))


def test_a_later_start_counts_from_the_first_frame(tmp_path: Path) -> None:
    frames = open_frames([str(write_video(tmp_path / "a.mkv", [ms + 500 for ms in UNEVEN_MS]))])
    assert frames.time_s[0] == 0.0
    assert_close("presentation time", frames.time_s, np.array(UNEVEN_MS) / 1000.0)


def test_images_have_their_names_and_stand_upright(tmp_path: Path) -> None:
    """EXIF's orientation 6: the first row as stored is the right-hand column."""
    own = np.zeros((20, 30, 3), np.uint8)
    own[0] = 255
    image = Image.fromarray(own)
    exif = Image.Exif()
    exif[0x0112] = 6
    image.save(tmp_path / "b.png", exif=exif)
    Image.fromarray(np.array([[100, 300]], np.uint16)).save(tmp_path / "a.tif")
    (tmp_path / "notes.txt").write_text("none")
    frames = open_frames([str(tmp_path)])
    assert frames.image_name == ("a.tif", "b.png")
    thermal, turned = frames.pictures([0, 1])
    assert [thermal.getpixel((u, 0)) for u in (0, 1)] == [(0, 0, 0), (255, 255, 255)]
    assert turned.size == (20, 30)
    assert np.asarray(turned)[:, 19].min() == 255 and np.asarray(turned)[:, :19].max() == 0


@pytest.mark.parametrize("mode", ["I;16", "I", "F"])
def test_a_large_image_of_16_bits_takes_a_few_bytes_a_pixel(mode: str) -> None:
    """It is scaled band by band, all from one darkest to one brightest pixel."""
    rows = np.arange(1000)[:, None]
    levels = np.broadcast_to(65 * rows, (1000, 4000)).astype(np.uint16)
    image = Image.fromarray(levels).convert(mode)
    assert peak(lambda: eight_bits(image)) < 4 * levels.size
    shown = np.asarray(eight_bits(image))
    np.testing.assert_array_equal(shown[:, ::999, 1], np.round(rows * 255 / 999) + 0 * rows[:5].T)


def test_the_file_of_a_photograph_serves_where_browsers_show_it_upright(tmp_path: Path) -> None:
    """Others are decoded: one that lies on its side, one of a printer's four inks, a .png."""
    turned = Image.Exif()
    turned[0x0112] = 6
    for name, mode, more in (
        ("a.jpg", "RGB", {}), ("b.jpg", "L", {}), ("c.jpg", "CMYK", {}),
        ("d.jpg", "RGB", {"exif": turned}), ("e.png", "RGB", {}),
    ):  # fmt: skip
        Image.new(mode, (30, 20)).save(tmp_path / name, **more)
    frames = open_frames([str(tmp_path)])
    assert [frames.jpeg(k) is not None for k in range(5)] == [True, True, False, False, False]
    assert frames.jpeg(0) == (tmp_path / "a.jpg").read_bytes()


ONE = 1 << 16


@pytest.mark.parametrize(
    ("matrix", "corner", "is_turned"),
    [((0, ONE, -ONE, 0), "top right", True), ((0, -ONE, ONE, 0), "bottom left", True),
     ((-ONE, 0, 0, -ONE), "bottom right", False), ((-ONE, 0, 0, ONE), "top right", False),
     ((ONE, 0, 0, -ONE), "bottom left", False), ((0, ONE, ONE, 0), "top left", True)],
    ids=["clockwise", "counter-clockwise", "upside down", "mirrored", "in water", "transposed"],
)  # fmt: skip
def test_a_video_of_a_turned_camera_stands_upright(
    matrix: tuple[int, ...], corner: str, is_turned: bool,
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Where the display matrix puts the corner at the top left as stored.

    Its numbers a, b, c, d take a pixel from x, y, down, to ax + cy, bx + dy.
    """
    path = write_video(tmp_path / "a.mp4", EVEN_MS[:3], bright_corner=True)
    content = bytearray(path.read_bytes())
    a, b, c, d = matrix
    start = content.index(b"tkhd") + 44
    content[start : start + 36] = struct.pack(">9i", a, b, 0, c, d, 0, 0, 0, 1 << 30)
    path.write_bytes(content)

    def stands() -> bool:
        (picture,) = open_frames([str(path)]).pictures([1])
        seen: Floats = np.asarray(picture.convert("L"), dtype=float)
        brightest = {
            f"{row} {column}": seen[rows, columns].mean()
            for row, rows in (("top", np.s_[:6]), ("bottom", np.s_[-6:]))
            for column, columns in (("left", np.s_[:6]), ("right", np.s_[-6:]))
        }
        size = SIZE if is_turned else SIZE[::-1]
        return seen.shape == size and max(brightest, key=lambda one: brightest[one]) == corner

    assert stands()
    if shutil.which("ffmpeg"):
        monkeypatch.setitem(sys.modules, "av", None)
        assert stands()


def test_frames_spread_over_a_video(tmp_path: Path) -> None:
    frames = open_frames([str(write_video(tmp_path / "a.mp4", EVEN_MS[:10]))])
    assert spread(frames, 4) == [0, 3, 6, 9]
    assert spread(frames, 99) == list(range(10))


def test_what_is_no_video(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_video(tmp_path / "a.mp4", EVEN_MS)
    Path("list.mp4").write_text("#EXTM3U\n#EXTINF:10,\na.mp4\n")
    Path("words.mp4").write_bytes(b"\0frame,landmark\n" * 9)
    Path("geo.txt").write_text("EPSG:32633\n" + "F0.JPG 600000 5200000 540 0 0 0\n" * 60)
    Path("\xe4.nfo").write_bytes(511 * b"a" + "\xe4".encode() + b"a" * 9)  # cut within a letter
    Path("empty.png").write_bytes(b"")
    Path("folder").mkdir()
    with wave.open("sound.wav", "wb") as sound:
        sound.setparams((1, 2, 8000, 0, "NONE", ""))
        sound.writeframes(b"\0" * 800)
    write_video(tmp_path / "bare.h264", EVEN_MS)  # a stream without times
    for name in ("a", "b"):
        Path(name).mkdir()
        Path(name, "same.png").write_bytes(b"")
    for names in (
        ["none.mp4"], ["words.mp4"], ["folder"], ["a.mp4", "a.mp4"],
        ["a.mp4", "empty.png"],
        ["a", "empty.png"], ["a/same.png", "b/same.png"], ["/dev/zero"], ["list.mp4"],
        ["sound.wav"], ["bare.h264"], ["geo.txt"], ["\xe4.nfo"],
    ):  # fmt: skip
        with refused(VopdError):
            open_frames(names)
    with refused(VopdError):
        list(open_frames(["empty.png"]).pictures([0]))


@pytest.mark.skipif(os.name == "nt", reason="no colon stands in a name there")
def test_a_name_with_a_colon_is_no_protocol(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_video(tmp_path / "a.mp4", EVEN_MS).rename("12:30.mp4")
    assert len(open_frames(["12:30.mp4"])) == len(EVEN_MS)


def test_levels_that_are_not_finite(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    """They are the darkest or the brightest of those that are."""
    levels = np.array([[np.nan, -np.inf, 2.0, 6.0, 10.0, np.inf]], np.float32)
    Image.fromarray(levels).save(tmp_path / "a.tif")
    Image.fromarray(np.full((2, 2), np.nan, np.float32)).save(tmp_path / "b.tif")
    first, second = open_frames([str(tmp_path)]).pictures([0, 1])
    assert np.asarray(first)[0, :, 0].tolist() == [0, 0, 0, 128, 255, 255]
    assert not np.asarray(second).any() and not recwarn


def test_chapters_are_counted_on(tmp_path: Path) -> None:
    """The second file begins a frame's time after the last frame of the first."""
    names = [str(write_video(tmp_path / name, EVEN_MS[:9])) for name in ("a.mp4", "b.mp4")]
    frames = open_frames(names)
    assert_close("presentation time", frames.time_s, np.arange(18) * 0.04)
    assert [frames.label(k) for k in (0, 17)] == ["0", "17"]
    found = [number_of(picture) for picture in frames.pictures([0, 8, 9, 17])]
    assert_close("frame by its grey level", found, [0, 8, 0, 8])
    assert [k for k, _ in frames.decoded(7, 11, grey=True)] == [7, 8, 9, 10, 11]
    assert_approved(frames.about)


@pytest.mark.skipif(os.name == "nt", reason="the stub is a script")
@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not there")
@pytest.mark.parametrize("grey", [False, True])
def test_ffmpeg_decodes_pixels_of_ten_bits(
    grey: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As telephones write them; its PPM would have two bytes a colour."""
    video = str(write_video(tmp_path / "a.mp4", EVEN_MS, pixels="yuv420p10le"))
    by_pyav = dict(open_frames([video]).decoded(1, 4, grey))
    monkeypatch.setitem(sys.modules, "av", None)
    found = dict(open_frames([video]).decoded(1, 4, grey))
    assert list(found) == [1, 2, 3, 4]
    for k, picture in found.items():
        assert picture.shape == by_pyav[k].shape
        assert abs(picture.astype(int) - by_pyav[k]).max() <= LEVELS // 2


def test_ffmpeg_serves_where_pyav_is_not_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    video = str(write_video(tmp_path / "a.mp4", UNEVEN_MS))
    by_pyav = open_frames([video])
    pictures = [np.asarray(one) for one in by_pyav.pictures([8])]
    grey = dict(by_pyav.decoded(3, 6, grey=True))
    write_stub(tmp_path / "bin" / "ffmpeg")
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=os.pathsep)
    monkeypatch.setitem(sys.modules, "av", None)
    frames = open_frames([video])
    assert frames.about == by_pyav.about and (frames.time_s == by_pyav.time_s).all()
    for one, other in zip(frames.pictures([8]), pictures, strict=True):
        assert (np.asarray(one) == other).all()
    found = dict(frames.decoded(3, 6, grey=True))
    assert list(found) == [3, 4, 5, 6]
    assert all((found[k] == grey[k]).all() for k in found)
    (tmp_path / "words.mp4").write_bytes(b"\0frame,landmark\n" * 9)
    monkeypatch.chdir(tmp_path)
    with refused(VopdError):
        open_frames(["words.mp4"])
    monkeypatch.setenv("PATH", str(tmp_path))
    with refused(VopdError):
        open_frames([video])


@pytest.mark.skipif(os.name == "nt", reason="the stub is a script")
@pytest.mark.parametrize("first", ["48003", str(-(2**63))])
def test_packets_whose_times_ffmpeg_does_not_know(
    first: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of MPEG programme streams, whose frames were at -1e14 s; a bare stream has none."""
    stub = tmp_path / "bin" / "ffmpeg"
    stub.parent.mkdir()
    packets = f"0, 45000, {first}, 3003, 607, 0xc0", f"0, 48003, {-(2**63)}, 1, 2, 0"
    lines = ["#tb 0: 1/90000", *packets]
    stub.write_text("\n".join(["#!/bin/sh", *(f"echo '{line}'" for line in lines)]) + "\n")
    stub.chmod(0o755)
    monkeypatch.setenv("PATH", str(stub.parent), prepend=os.pathsep)
    monkeypatch.setitem(sys.modules, "av", None)
    (tmp_path / "a.mpg").write_bytes(b"\0any")
    with refused(VopdError):
        open_frames([str(tmp_path / "a.mpg")])


def test_each_frame_of_a_file_that_cannot_seek_before_its_first(tmp_path: Path) -> None:
    """The last frames of an FLV were told as not decodable."""
    frames = open_frames([str(write_video(tmp_path / "a.flv", EVEN_MS))])
    for k in range(40):
        (picture,) = frames.pictures([k])
        assert round(number_of(picture)) == k


def test_a_frame_more_than_a_thousand_behind_its_key_frame(tmp_path: Path) -> None:
    """Of a video with one key frame, whose frames are by turns black and white."""
    with av.open(str(tmp_path / "long.mp4"), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.width, stream.height, stream.pix_fmt = 16, 16, "yuv420p"
        stream.options = {"crf": "1", "g": "9999", "preset": "ultrafast"}
        for k in range(1_100):
            level = np.full((16, 16), 255 * (k % 2), np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(level, "gray")))
        container.mux(stream.encode())
    frames = open_frames([str(tmp_path / "long.mp4")])
    levels = [picture.mean() for k in (1_050, 1_051) for _, picture in frames.decoded(k, k, True)]
    assert levels[0] < 50.0 and levels[1] > 200.0


def test_an_avi_of_frames_that_refer_to_later_ones(tmp_path: Path) -> None:
    """Seven of forty were told as damaged."""
    with refused(VopdError):
        open_frames([str(write_video(tmp_path / "a.avi", EVEN_MS))])


def test_a_frame_that_is_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The index at the head of a file is whole, and the frames at its end are not there."""
    monkeypatch.chdir(tmp_path)
    video = write_video(tmp_path / "a.mkv", EVEN_MS)
    frames = open_frames(["a.mkv"])
    video.write_bytes(video.read_bytes()[: video.stat().st_size // 2])
    with refused(VopdError):
        list(frames.pictures([39]))
    write_video(video, EVEN_MS)
    video.write_bytes(video.read_bytes()[: video.stat().st_size * 3 // 4])
    seen = [k for k, _ in grey_frames(frames, 0, 39)]  # those before it serve
    assert seen == list(range(len(seen))) and 0 < len(seen) < 40
    with refused(VopdError):
        list(grey_frames(frames, 39, 39))


def damage(video: Path, frame: int) -> None:
    """Overwrite the packet of one frame by zeros."""
    with av.open(str(video)) as container:
        packets = [one for one in container.demux(video=0) if one.pts is not None]
        packet = sorted(packets, key=lambda one: one.pts)[frame]
        at, size = packet.pos, packet.size
    content = video.read_bytes()
    video.write_bytes(content[:at] + bytes(size) + content[at + size :])


def test_frames_behind_a_damaged_packet_begin_with_the_next_key_frame(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Key frames are 0, 12, 24 and 36. A few before the packet are still in the decoder."""
    damage(write_video(tmp_path / "a.mp4", EVEN_MS), 15)
    frames = open_frames([str(tmp_path / "a.mp4")])
    lost: list[int] = []
    found = dict(frames.decoded(0, 39, lost=lost.append))
    assert lost == [*range(11, 24)]
    assert sorted([*found, *lost]) == [*range(40)]
    assert all(round(number_of(Image.fromarray(one))) == k for k, one in found.items())
    told: list[str] = []
    grey = dict(grey_frames(frames, 0, 39, told.append))
    assert list(grey) == [*range(40)] and len(told) == len(lost)
    assert [k for k, one in grey.items() if not one.any()] == lost
    assert_approved(told[0])
    assert list(dict(grey_frames(frames, lost[0], 30))) == [*range(lost[0], 31)]
    monkeypatch.setattr(video, "BACKWARD_BYTES", 4 * grey[0].nbytes)
    backward = list(dict(grey_frames_backward(frames, 39, 0)))
    assert backward[:16] == [*range(39, 23, -1)] and backward[-11:] == [*range(10, -1, -1)]
    with refused(VopdError):
        next(frames.pictures(lost))
