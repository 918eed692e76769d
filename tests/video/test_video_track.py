"""Tracks that come with a video: GoPro's GPMF, and DJI's subtitles."""

from __future__ import annotations

import os
import struct
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.video import klv, write_gpmf, write_stub, write_video
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import open_input
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.track import TRACK_FORMATS, TrackRows


def read(path: Path) -> TrackRows:
    return read_by_content(TRACK_FORMATS, open_input(path.name, path.parent))


def device(*entries: bytes) -> bytes:
    """A device with one stream."""
    inside = b"".join(entries)
    stream = klv("STRM", "", 1, len(inside), inside)
    return klv("DEVC", "", 1, len(stream), stream)


def gps5(rows: list[tuple[float, float, float]], fix: int = 3, dilution: int = 250) -> bytes:
    scaled = [(round(a * 1e7), round(b * 1e7), round(h * 1e3), 0, 0) for a, b, h in rows]
    return device(
        klv("GPSF", "L", 4, 1, struct.pack(">L", fix)),
        klv("GPSP", "S", 2, 1, struct.pack(">H", dilution)),
        klv("SCAL", "l", 4, 5, struct.pack(">5l", 10**7, 10**7, 1000, 1000, 100)),
        klv("GPS5", "l", 20, len(rows), b"".join(struct.pack(">5l", *one) for one in scaled)),
    )


def gps9(rows: list[tuple[float, float, int]], day: int = 9_000) -> bytes:
    """Latitude, seconds of a day, and the fix; at 15 east, 300 m, with a dilution of 2."""
    scale = 10**7, 10**7, 1000, 1000, 100, 1, 1000, 100, 1
    content = b"".join(
        struct.pack(">7l2H", round(a * 1e7), 15 * 10**7, 300_000, 0, 0, day,
                    round(s * 1e3), 200, fix)
        for a, s, fix in rows
    )  # fmt: skip
    return device(
        klv("TYPE", "c", 1, 9, b"lllllllSS"),
        klv("SCAL", "l", 4, 9, struct.pack(">9l", *scale)),
        klv("GPS9", "?", 32, len(rows), content),
    )


def karma(rows: list[tuple[float, float, float, float]]) -> bytes:
    """Seconds of a clock, latitude, and standard deviations; at 15 east, 300 m, with a fix."""
    scale = 10**6, 10**7, 10**7, 1000, 100, 100, 100, 100, 1
    content = b"".join(
        struct.pack(">Q3l4HB", round(s * 1e6), round(a * 1e7), 15 * 10**7, 300_000,
                    round(across * 100), round(up * 100), 0, 0, 3)
        for s, a, across, up in rows
    )  # fmt: skip
    return device(
        klv("TYPE", "c", 1, 9, b"JlllSSSSB"),
        klv("SCAL", "l", 4, 9, struct.pack(">9l", *scale)),
        klv("GPRI", "?", 29, len(rows), content),
    )


def test_gps5_is_spread_over_its_packets(tmp_path: Path) -> None:
    """The first second has no fix; 7.5 m and 12.5 m are 3 and 5 m times a dilution of 2.5."""
    places = [(47.1, 15.2, 400.5), (47.2, 15.3, 401.0), (47.3, 15.4, 402.0)]
    packets = [(0, gps5([(0, 0, 0)], fix=0)), (1000, gps5(places[:2])), (2000, gps5(places[2:]))]
    rows = read(write_gpmf(tmp_path / "a.mp4", packets))
    assert_close("place or time as a file has it", rows.time_s, [1.0, 1.5, 2.0])
    assert_close("place or time as a file has it", rows.coordinate, np.array(places)[:, [1, 0, 2]])
    assert_close("place or time as a file has it", rows.sigma_m, [[7.5, 7.5, 12.5]] * 3)
    assert rows.clock == "seconds" and rows.by_video and rows.height is None
    assert_approved(rows.said)


def test_what_is_no_place_of_gps5_is_left_out(tmp_path: Path) -> None:
    """Latitude and longitude 0 are; one of them, and the poles, are places."""
    places = [(0, 15.0, 1.0), (0, 0, 2.0), (47.0, 0, 3.0), (90.0, 9.0, 4.0), (90.1, 9.0, 5.0)]
    level = gps5([(48.0, 9.0, 7.0)], fix=2)  # of two dimensions: its height is a guess
    packets = [(0, gps5([*places, (-90.0, 9.0, 6.0)])), (1000, level)]
    rows = read(write_gpmf(tmp_path / "a.mp4", packets))
    assert rows.coordinate[:, 2].tolist() == [1.0, 3.0, 4.0, 6.0]


@pytest.mark.parametrize("cut", [1, 12, 40, 90])
def test_a_packet_that_is_cut_off_costs_no_other(cut: int, tmp_path: Path) -> None:
    """So many bytes are missing at its end; what an entry says to hold is whole, or not there."""
    one, two, three = ((47.0 + k / 10.0, 15.2, 400.0) for k in range(3))
    packets = [(0, gps5([one])), (1000, gps5([two, two])[:-cut]), (2000, gps5([three]))]
    rows = read(write_gpmf(tmp_path / "a.mp4", packets))
    assert_close("place or time as a file has it", rows.time_s, [0.0, 2.0])
    assert_close("place or time as a file has it", rows.coordinate[:, 1], [47.0, 47.2])


def test_times_count_from_the_first_frame(tmp_path: Path) -> None:
    """Of a video whose first frame is shown at 3.5 s, as of one that begins at 0."""
    packets = [(k * 1000, gps5([(47.0 + k / 10.0, 15.2, 400.0)])) for k in range(3)]
    later = [(3500 + ms, content) for ms, content in packets]
    for name, some in (("a.mp4", packets), ("b.mp4", later)):
        rows = read(write_gpmf(tmp_path / name, some))
        assert_close("place or time as a file has it", rows.time_s, [0.0, 1.0, 2.0])


def test_gps9_has_times_of_its_own(tmp_path: Path) -> None:
    """Samples at 36000.25 and .5 s of a day are .25 s apart, about the middle of 0 and .5 s."""
    packets = [(0, gps9([(47.0, 36_000.25, 3), (47.1, 36_000.5, 3)])), (1000, gps9([(0, 1, 0)]))]
    rows = read(write_gpmf(tmp_path / "a.mp4", packets))
    assert_close("place or time as a file has it", rows.time_s, [0.125, 0.375])
    assert_close("place or time as a file has it", rows.coordinate[:, 1], [47.0, 47.1])
    assert_approved(rows.said)


def test_a_clock_that_goes_back_is_none(tmp_path: Path) -> None:
    """Nor one that stands: samples are spread over their packets."""
    for later_s in (36_000.0, 36_000.25):
        packets = [(0, gps9([(47.0, 36_000.25, 3), (47.1, later_s, 3)])), (1000, gps9([(0, 1, 0)]))]
        rows = read(write_gpmf(tmp_path / "a.mp4", packets))
        assert_close("place or time as a file has it", rows.time_s, [0.0, 0.5])


def test_a_packet_that_is_cut_short_has_what_is_whole_in_it(tmp_path: Path) -> None:
    whole, cut = gps5([(47.1, 15.2, 400.5)]), gps5([(47.2, 15.3, 401.0)])[:-4]
    rows = read(write_gpmf(tmp_path / "a.mp4", [(0, whole + cut), (1000, whole[:-4])]))
    assert_close("place or time as a file has it", rows.coordinate, [[15.2, 47.1, 400.5]])


def test_a_day_beyond_the_calendar_is_no_date(tmp_path: Path) -> None:
    packets = [(0, gps9([(47.0, 0.2, 3), (47.1, 0.7, 3)], day=2**31 - 1))]
    assert_approved(read(write_gpmf(tmp_path / "a.mp4", packets)).said)


@pytest.mark.parametrize("is_first", [True, False])
def test_of_two_streams_that_of_the_better_receiver_is_read(is_first: bool, tmp_path: Path) -> None:
    """Cameras that have both write GPS9 for its times of day; without a fix in it, GPS5."""
    nine = gps9([(47.0, 36_000.2, 3), (47.1, 36_000.7, 3)])
    five = gps5([(48.0, 15.0, 300.0), (48.1, 15.0, 300.0)])
    both = nine + five if is_first else five + nine
    rows = read(write_gpmf(tmp_path / "a.mp4", [(0, both)]))
    assert_close("place or time as a file has it", rows.coordinate[:, 1], [47.0, 47.1])
    none = gps9([(47.0, 36_000.2, 0), (47.1, 36_000.7, 0)])
    lost = none + five if is_first else five + none
    again = read(write_gpmf(tmp_path / "b.mp4", [(0, lost)]))
    assert_close("place or time as a file has it", again.coordinate[:, 1], [48.0, 48.1])
    assert_approved([rows.said, again.said])


def test_a_karma_states_its_standard_deviations(tmp_path: Path) -> None:
    """One for east and north, one upward; 0 where it does not know."""
    packets = [(0, karma([(100.0, 47.0, 1.5, 2.5), (100.3, 47.1, 0.0, 3.0)]))]
    rows = read(write_gpmf(tmp_path / "a.mp4", packets))
    assert rows.time_s is not None and rows.sigma_m is not None
    assert_close("place or time as a file has it", rows.time_s, [0.1, 0.4])
    assert_close(
        "place or time as a file has it", rows.coordinate, [[15, 47, 300], [15, 47.1, 300]]
    )
    assert_close("place or time as a file has it", rows.sigma_m[0], [1.5, 1.5, 2.5])
    assert_close("place or time as a file has it", rows.sigma_m[1, 2], 3.0)
    assert np.isnan(rows.sigma_m[1, :2]).all()
    assert_approved([rows.said, rows.sigma_by])


def test_of_two_receivers_in_a_packet_the_first_is_read(tmp_path: Path) -> None:
    """Their samples are of the same times: those of the second were left in where they went on."""
    one = karma([(100.0, 47.0, 1.5, 2.5), (100.3, 47.1, 1.75, 2.75)])
    other = karma([(100.0, 48.0, 7.5, 8.5), (100.3, 48.1, 7.75, 8.75)])
    rows = read(write_gpmf(tmp_path / "a.mp4", [(0, one + other), (1000, one + other)]))
    assert rows.time_s is not None and rows.sigma_m is not None
    assert_close("place or time as a file has it", rows.time_s, [0.0, 0.5, 1.0, 1.5])
    assert_close("place or time as a file has it", rows.coordinate[:, 1], [47.0, 47.1] * 2)
    assert_close("place or time as a file has it", rows.sigma_m[:, 2], [2.5, 2.75] * 2)


@pytest.mark.skipif(os.name == "nt", reason="the stub is a script")
def test_ffmpeg_reads_gpmf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    packets = [(0, gps5([(47.1, 15.2, 400.5)])), (1000, gps5([(47.2, 15.3, 401.0)] * 2))]
    write_gpmf(tmp_path / "a.mp4", packets)
    write_video(tmp_path / "none.mp4", [0, 40])
    by_pyav = read(tmp_path / "a.mp4")
    write_stub(tmp_path / "bin" / "ffmpeg")
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=os.pathsep)
    monkeypatch.setitem(sys.modules, "av", None)
    rows = read(tmp_path / "a.mp4")
    assert (rows.coordinate == by_pyav.coordinate).all()
    assert rows.time_s is not None and list(rows.time_s) == [0.0, 1.0, 1.5]
    with refused(VopdError):
        read(tmp_path / "none.mp4")


def test_videos_without_a_track(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_video(Path("none.mp4"), [0, 40])
    write_gpmf(Path("unfixed.mp4"), [(0, gps5([(47.0, 15.0, 1.0)], fix=0))])
    write_gpmf(Path("other.mp4"), [(0, device(klv("ACCL", "s", 2, 1, b"\0\1")))])
    write_gpmf(Path("wrong.mp4"), [(0, device(klv("GPS5", "?", 20, 1, b"\0" * 20)))])
    write_gpmf(Path("size.mp4"), [(0, device(klv("GPS5", "l", 21, 1, b"\0" * 21)))])
    write_gpmf(Path("letter.mp4"), [(0, device(klv("GPS5", "\7", 20, 1, b"\0" * 20)))])
    letters = klv("TYPE", "c", 1, 5, b"lxlll"), klv("GPS5", "?", 20, 1, b"\0" * 20)
    write_gpmf(Path("letters.mp4"), [(0, device(*letters))])
    scale = klv("SCAL", "l", 4, 2, struct.pack(">2l", 1, 1)), klv("GPS5", "l", 20, 1, b"\0" * 20)
    write_gpmf(Path("scale.mp4"), [(0, device(*scale))])
    block = "1\n00:00:00,000 --> 00:00:01,000\n[latitude: {}] [longitude: {}]{}\n"
    Path("flat.SRT").write_text(block.format(47.2, 15.1, ""))
    Path("lost.SRT").write_text(block.format(0.0, 0.0, " [abs_alt: 3.0]"))
    above = block.format(47.2, 15.1, " [abs_alt: 3.0]"), block.partition("[")[0]
    Path("both.SRT").write_text(f"{above[0]}\n{above[1]}GPS(15.1,47.2,16) BAROMETER:3.0\n")
    videos = (
        "none.mp4",
        "unfixed.mp4",
        "other.mp4",
        "wrong.mp4",
        "size.mp4",
        "letter.mp4",
        "letters.mp4",
        "scale.mp4",
    )
    for name in (*videos, "flat.SRT", "lost.SRT", "both.SRT"):
        with refused(VopdError):
            read(tmp_path / name)
    with refused(VopdError):
        read_by_content(PICK_FORMATS, open_input("none.mp4", tmp_path))


@pytest.mark.parametrize(
    ("block", "place"),
    [
        ("<font size=\"36\">SrtCnt : 1, DiffTime : 33ms\n2026-05-01 10:00:00,774,808\n[iso : 100] "
         "[focal_len : 240] [latitude: -47.25] [longitude: 15.5] [altitude: 512.25] </font>",
         (15.5, -47.25, 512.25)),
        ("[latitude : -47.25] [longtitude : 15.5] [altitude: 512.25]", (15.5, -47.25, 512.25)),
        ("HOME(15.4,-47.2) 2026.05.01 10:00:00\nGPS(15.5000,-47.2500,16) BAROMETER:31.5\nISO:100",
         (15.5, -47.25, 31.5)),
        ("HOME(15.4,-47.2) 2026.5.1 10:00:00\nGPS(15.5000,-47.2500,16) Hb:31.5 Hs:1.9",
         (15.5, -47.25, 31.5)),
        ("F/2.8, SS 30.15, ISO 260, EV -1.7, GPS (15.5, -47.25, 17), HOME (15.4, -47.2, -5.98m), "
         "D 221.2m, H 31.50m, H.S n/a, V.S 0.10m/s, F.PRY (2.7°, -7.0°, 110.1°)",
         (15.5, -47.25, 31.5)),
        ("2026.05.01 10:00:00\nGPS(-47.2500,15.5000,0.0M) BAROMETER:31.5M", (15.5, -47.25, 31.5)),
    ],
    ids=["Air 2S", "Mavic 2", "Mavic Pro", "Mavic Pro before", "Mini, Phantom 4", "Matrice 300"],
)  # fmt: skip
def test_subtitles_of_drones(block: str, place: tuple[float, float, float], tmp_path: Path) -> None:
    """Longitude first, but for the Matrice; heights of the older ones are above the take-off."""
    path = tmp_path / "a.SRT"
    path.write_text(f"1\n00:00:01,000 --> 00:00:02,000\n{block}\n", encoding="utf-8-sig")
    rows = read(path)
    assert_close("place or time as a file has it", rows.coordinate, [place])
    assert_close("place or time as a file has it", rows.time_s, [1.0])
    assert_approved([rows.said, rows.from_ground])


@pytest.mark.parametrize("behind", ["", "x", "m", "°", "ft", " ft", " S", "_5", ".5", ",5", "-"])
@pytest.mark.parametrize(
    "block",
    [
        "[latitude: 47.25{}] [longitude: 15.5] [rel_alt: 31.500 abs_alt: 221.2]",
        "[latitude: 47.25] [longitude: 15.5] [rel_alt: 31.500 abs_alt: 221.2{}]",
        "F/2.8, GPS (15.5, 47.25, 19), D 221.2m, H 221.2{}, H.S 0.00m/s",
    ],
    ids=["latitude", "abs_alt", "H"],
)
def test_numbers_of_subtitles_with_something_behind_them(
    block: str, behind: str, tmp_path: Path
) -> None:
    """A unit that is right is read; with anything else a number is refused, and not cut off."""
    path = tmp_path / "a.SRT"
    path.write_text(f"1\n00:00:01,000 --> 00:00:02,000\n{block.format(behind)}\n", "utf-8")
    if behind in ("", "°" if block.startswith("[latitude: 47.25{") else "m"):
        assert_close(
            "place or time as a file has it", read(path).coordinate, [[15.5, 47.25, 221.2]]
        )
    else:
        with refused(VopdError):
            read(path)


@pytest.mark.parametrize(
    "more", ["[altitude: 12.0] [abs_alt: 221.2]", "[abs_alt: 221.2] [latitude: 40.0]"]
)
def test_two_heights_or_places_in_one_block_are_refused(more: str, tmp_path: Path) -> None:
    """The first counted, in silence, as by which of the two a block begins."""
    path = tmp_path / "a.SRT"
    block = "1\n00:00:01,000 --> 00:00:02,000\n[latitude: 47.25] [longitude: 15.5] {}\n"
    path.write_text(block.format(more))
    with refused(VopdError):
        read(path)
    path.write_text(block.format("[abs_alt: 221.2] [altitude: 221.2]"))
    assert_close("place or time as a file has it", read(path).coordinate, [[15.5, 47.25, 221.2]])


def test_subtitles_repeat_positions(tmp_path: Path) -> None:
    """Four frames of three positions, one of which is written twice; the other spelling too."""
    lines = []
    for k, (a, h) in enumerate([(47.0, 500), (47.0, 500), (47.1, 501), (47.2, 502)], 1):
        spelt = "longtitude" if k == 4 else "longitude"
        lines += [
            f"{k}", f"00:01:00,{k * 33:03d} --> 00:01:00,{k * 33 + 33:03d}",
            f"[iso : 100] [latitude: {a}] [{spelt} : 15.5] [rel_alt: 1.0 abs_alt: {h}.0] </font>",
            "",
        ]  # fmt: skip
    path = tmp_path / "DJI_0001.SRT"
    path.write_text("\n".join(lines))
    rows = read(path)
    assert_close("place or time as a file has it", rows.time_s, [60.033, 60.099, 60.132])
    assert_close(
        "place or time as a file has it", rows.coordinate,
        [[15.5, 47.0, 500.0], [15.5, 47.1, 501.0], [15.5, 47.2, 502.0]],
    )  # fmt: skip
    assert list(rows.line) == [2, 10, 14]
    assert_approved(rows.said)


@pytest.mark.parametrize("last", [3, 9])
def test_a_drone_that_hovers_at_the_end_stays_where_it_is(last: int, tmp_path: Path) -> None:
    """It moves for two seconds; the last block is kept, so that later frames have a position."""
    lines = []
    for k in range(last + 1):
        place = f"[latitude: 47.{min(k, 2)}] [longitude: 15.5] [abs_alt: 500.0]"
        lines += [f"{k + 1}", f"00:00:0{k},000 --> 00:00:0{k},900", place, ""]
    path = tmp_path / "DJI_0003.SRT"
    path.write_text("\n".join(lines))
    rows = read(path)
    assert_close("place or time as a file has it", rows.time_s, [0.0, 1.0, 2.0, last])


def test_parts_of_a_second_of_subtitles_may_have_fewer_digits(tmp_path: Path) -> None:
    place = "[latitude: 47.{}] [longitude: 15.5] [abs_alt: 500.0]\n\n"
    starts = ("00:00:01,5", "00:00:02,25", "01:00:03.125")
    text = [f"{k}\n{one} --> 01:00:09,000\n{place.format(k)}" for k, one in enumerate(starts, 1)]
    (tmp_path / "a.SRT").write_text("".join(text))
    found = read(tmp_path / "a.SRT").time_s
    assert_close("place or time as a file has it", found, [1.5, 2.25, 3603.125])


def test_damaged_subtitles_cost_no_others(tmp_path: Path) -> None:
    """A place that is cut off, a time that is, and the end of the file."""
    lines = []
    for k in range(6):
        time_s = "00:0" if k == 3 else f"00:00:0{k},000"
        place = f"[latitude: 47.{k}] [longitude: 15.5] [abs_alt: 500.0]"
        lines += [f"{k + 1}", f"{time_s} --> 00:00:09,000", place[: 15 if k in (1, 5) else 99], ""]
    path = tmp_path / "DJI_0002.SRT"
    path.write_text("\n".join(lines))
    rows = read(path)
    assert_close("place or time as a file has it", rows.time_s, [0.0, 2.0, 4.0])
    assert_close("place or time as a file has it", rows.coordinate[:, 1], [47.0, 47.2, 47.4])
    assert_approved(rows.said)
