"""What `vopd check` says of projects with the usual mistakes."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd
from tests.kit.flight_project import TOML, long_track, marks_m, write_project
from tests.tolerances import assert_close
from vopd.attitude.findings import HistorySummary
from vopd.findings import Finding, VopdError
from vopd.flight import check as check_module
from vopd.flight.check import check_flight, messages_of_files
from vopd.flight.flight import Flight
from vopd.flight.formats import photographs
from vopd.flight.formats.photographs import photograph
from vopd.flight.misfits import far_landmarks as far_module
from vopd.flight.misfits import mistakes
from vopd.flight.misfits.blunders import ARE_EXCHANGED
from vopd.flight.misfits.far_landmarks import far_landmarks
from vopd.flight.project.keys import read_project
from vopd.flight.project.read import flight_of, read_flight
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.rotations import SolvedFlight
from vopd.geometry.earth import earth_centred_m, geodetic


def messages(path: Path) -> list[str]:
    return [finding.message for finding in check_flight(str(path))]


def changed(path: Path, name: str, change: object) -> None:
    file = path.parent / name
    rows = [row.split(",") for row in file.read_text().splitlines()]
    body = [change(row) for row in rows[1:]]  # type: ignore[operator]
    file.write_text("\n".join(",".join(row) for row in [rows[0], *body]))


def test_an_error_is_one_and_has_status_1(tmp_path: Path) -> None:
    path = write_project(tmp_path, TOML.replace("[track]", "[trak]"))
    ran = vopd("check", "--format", "json", path)
    assert ran.status == 1
    (found,) = json.loads(ran.stdout)
    assert_approved(found["errors"][0]["message"])


def test_all_keys_that_are_wrong_are_named(tmp_path: Path) -> None:
    """Those inside an inline table, too, by every command."""
    text = TOML.replace("[landmarks]", "v = 5\nsigma = 1\n[landmarks]")
    text = text.replace("fx_px =", "f_px = 1, fx_px =").replace(
        "[flight]", "name = 1\nzz = 1\n[flight]"
    )
    path = write_project(tmp_path, text + "[solv]\n")
    ran, solved = vopd("check", path), vopd("attitude", path)
    assert (ran.status, solved.status, solved.stdout) == (1, 1, "")
    assert_approved(ran.stdout)
    assert_approved(solved.stderr)


def test_each_file_that_is_wrong_is_named(tmp_path: Path) -> None:
    """Also where another is, and what no file says; an error that follows from another is not."""
    text = TOML.replace(
        '[landmarks]\nfile = "landmarks.csv"\nheight = "ellipsoid"\n', "[landmarks]\n"
    )
    text = text.replace("[landmarks]", '[landmarks]\nfile = "landmarks.csv"\n')
    path = write_project(
        tmp_path, text + '[wind]\nfile = "wind.csv"\n[vehicle]\nattitude = "a.csv"\n'
    )
    changed(path, "picks.csv", lambda row: [*row[:2], "left", row[3]])
    (tmp_path / "track.csv").write_text("t_s,lat_deg,lon_deg,h_m\n0,91,16,400\n")
    ran, solved = vopd("check", path), vopd("attitude", path)
    assert (ran.status, solved.status, solved.stdout) == (1, 1, "")
    assert_approved(ran.stdout)
    texts = [
        one.removeprefix("error: ").removeprefix(f"{path}: ") for one in ran.stdout.splitlines()
    ]
    assert [one.removeprefix(f"{path}: ") for one in solved.stderr.splitlines()] == texts[:-1]
    for command in (("attitude", path, path), ("batch", path, "-d", tmp_path / "out")):
        told = vopd(*command).stderr.splitlines()
        assert {*told} == {f"{path}: {one}" for one in texts[:-1]} and len(told) % 5 == 0


@pytest.mark.parametrize(("stated_s", "wrong_s"), [(0.5, 0.4), (0.5, -0.6), (5.0, -4.0)])
def test_a_clock_that_is_off_by_what_is_stated_is_named(
    stated_s: float, wrong_s: float, tmp_path: Path
) -> None:
    """The angles are those of the clock as it is stated, and their residuals large."""
    text = TOML.replace('sigma_t_s = "exact"', f"sigma_t_s = {stated_s}\noffset_s = {wrong_s}")
    text = text.replace("frame_rate", "sigma_px = 0.5\nframe_rate")
    path = write_project(tmp_path, text, noise_px=0.5)
    long_track(tmp_path)
    *_, said = messages(path)
    offset_s, _, sigma_s = said.partition("offset_s = ")[2].split()[:3]
    assert abs(float(offset_s)) < 3.0 * float(sigma_s) < 0.1


def test_a_frame_that_misfits_is_named_as_attitude_names_it(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    odd = ["1", "church"], ["1", "mast"]
    changed(
        path, "picks.csv",
        lambda row: [*row[:2], str(float(row[2]) + 40.0 * (row[:2] in odd)), *row[3:]],
    )  # fmt: skip
    found = messages(path)
    told = vopd("attitude", path, "-o", tmp_path / "attitude.csv").stderr
    (misfit,) = [one for one in found if "misfit" in one]
    assert f"warning: {path}: {misfit}\n" in told
    assert_approved(misfit)


def test_a_frame_of_which_a_pick_is_named_is_not_named_again(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    changed(
        path, "picks.csv",
        lambda row: [*row[:2], str(float(row[2]) + 40.0 * (row[:2] == ["1", "church"])), *row[3:]],
    )  # fmt: skip
    of_frame = [one for one in messages(path) if "frame 1: " in one]
    assert len(of_frame) == 1
    assert_approved(*of_frame)


def test_landmarks_never_picked_and_picks_outside_the_image(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    marks = tmp_path / "landmarks.csv"
    marks.write_text(marks.read_text() + "barn,47.6,16.4,400\n")
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([*rows, "4,well,5000,20"]))
    found = messages(path)
    assert "never picked: barn" in found
    assert any("picked 2 times" in one for one in found)
    (tmp_path / "picks.csv").write_text("\n".join([*rows[:-1], "4,well,5000,20"]))
    assert any("the first well in frame 4 at 5000, 20" in one for one in messages(path))


@pytest.mark.parametrize("name", ["landmarks.csv", "track.csv"])
def test_latitude_and_longitude_exchanged_are_noticed(tmp_path: Path, name: str) -> None:
    path = write_project(tmp_path)
    changed(path, name, lambda r: [r[0], r[2], r[1], r[3]])
    (found,) = messages(path)
    assert_approved(found)


def exchanged(tmp_path: Path) -> Path:
    """A project in whose frame 3 mast and tower are exchanged."""
    path = write_project(tmp_path, noise_px=0.3)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    swap = {"mast": "tower", "tower": "mast"}
    frame_3 = [",".join([r.split(",")[0], swap.get(r.split(",")[1], r.split(",")[1]),
                         *r.split(",")[2:]]) for r in rows[19:25]]  # fmt: skip
    (tmp_path / "picks.csv").write_text("\n".join(rows[:19] + frame_3 + rows[25:]))
    return path


def test_two_exchanged_landmarks_are_found_without_solving_a_flight(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = exchanged(tmp_path)
    passes_of: list[int] = []
    solve = mistakes.solve

    def counted(flight: Flight, passes: int) -> SolvedFlight:
        passes_of.append(passes)
        return solve(flight, passes=passes)

    monkeypatch.setattr(mistakes, "solve", counted)
    assert any(ARE_EXCHANGED in one for one in messages(path))
    assert passes_of == []


def test_a_track_that_covers_no_frame_by_18_s_says_so(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    changed(path, "track.csv", lambda r: [str(float(r[0]) + 18.0), *r[1:]])
    (found,) = messages(path)
    assert_approved(found)
    changed(path, "track.csv", lambda r: [str(float(r[0]) + 500.0), *r[1:]])
    assert "it does" not in messages(path)[0]


def test_easting_and_northing_exchanged_are_noticed(tmp_path: Path) -> None:
    shutil.copytree(Path(__file__).parents[2] / "examples" / "summits", tmp_path / "p")
    path = tmp_path / "p" / "flight.toml"
    changed(path, "summits.csv", lambda r: [r[0], r[2], r[1], r[3]])
    for found in messages(path):
        assert_approved(found)


@pytest.mark.parametrize("keys", ['pixel_grid = "one-based"', 'pixel_grid = "centre"\nv = "up"'])
def test_picks_are_the_same_when_a_changed_project_is_read(tmp_path: Path, keys: str) -> None:
    text = TOML.replace('.csv"\npixel_grid = "centre"', f'.csv"\n{keys}', 1)
    project = read_project(str(write_project(tmp_path, text)))
    first = flight_of(project).picks.pixel
    np.testing.assert_array_equal(
        flight_of(project.changed("track", "offset_s", 0.5)).picks.pixel, first
    )


def test_many_frames_are_tried_by_some_of_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 5 frames 0, 2 and 4 are tried: 18 of 30 picks, in 6 passes."""
    path = write_project(tmp_path, noise_px=0.3)
    changed(path, "picks.csv", lambda r: [r[0], r[1], r[2], str(1079.0 - float(r[3]))])
    monkeypatch.setattr(mistakes, "FRAMES_TRIED", 3)
    tried: list[tuple[int, int]] = []
    solve = mistakes.solve

    def counted(flight: Flight, passes: int) -> SolvedFlight:
        tried.append((len(flight.picks.frame), passes))
        return solve(flight, passes=passes)

    monkeypatch.setattr(mistakes, "solve", counted)
    assert any('with v counted upward: give [picks] v = "up"?' in one for one in messages(path))
    assert set(tried) == {(18, 6)}


def test_picks_outside_the_field_of_the_lens_are_told(tmp_path: Path) -> None:
    """With k1 = -.5 the image folds where 1 - 1.5 r2 = 0: at .8165, seen at .5443, 816 px."""
    text = TOML.replace("k = [-0.1, 0.02, 1e-3, -2e-3, 3e-3]", "k = [-0.5, 0.0, 0.0, 0.0, 0.0]")
    path = write_project(tmp_path, text)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    for u_px, told in ((1790, True), (1770, False)):
        (tmp_path / "picks.csv").write_text("\n".join([*rows[:-1], f"4,well,{u_px},534"]))
        found = solve_flight_read(read_flight(str(path))).findings
        assert any("frame 4: well lies outside the field" in str(one) for one in found) == told


# What a check of a project says of its files, of landmarks far away, and in which order


def flight(folder: Path, toml: str = TOML) -> Flight:
    return read_flight(str(write_project(folder, toml)))


def test_an_error_stands_behind_the_warnings_and_has_no_name_of_the_file(tmp_path: Path) -> None:
    path = write_project(tmp_path, "[flight]\n")
    (found,) = check_flight(str(path))
    assert found == Finding(found.message, str(path))
    assert_approved(found.message)
    path = write_project(tmp_path, TOML.replace('height = "ellipsoid"\n', "", 1))
    (found,) = check_flight(str(path))
    assert found.message.startswith("[landmarks]: `height` is needed: ")
    assert (found.source, found.severity) == (str(path), "error")


def test_landmarks_never_picked_are_named_in_the_order_of_the_file(tmp_path: Path) -> None:
    """Ten, and the count of the rest; the first landmark, too."""
    one = flight(tmp_path)
    names = tuple(f"m{k}" for k in range(14))
    for picked, named in (
        (range(14), None), (range(1, 14), "m0"), (range(4, 14), "m0, m1, m2, m3"),
        (range(10, 14), "m0, m1, m2, m3, m4, m5, m6, m7, m8, m9"),
        (range(11, 14), "m0, m1, m2, m3, m4, m5, m6, m7, m8, m9 and 1 more"),
        (range(3), "m3, m4, m5, m6, m7, m8, m9, m10, m11, m12 and 1 more"),
    ):  # fmt: skip
        count = len(picked)
        picks = replace(
            one.picks, frame=np.zeros(count, int), landmark=np.array(picked)[::-1],
            pixel=np.full((count, 2), 5.0), sigma_px=np.ones(count),
        )  # fmt: skip
        landmarks = replace(one.landmarks, name=names)
        found = [*messages_of_files(replace(one, picks=picks, landmarks=landmarks))]
        assert found == ([] if named is None else [f"never picked: {named}"])


def test_numbers_that_are_missing_in_a_folder_of_images(tmp_path: Path) -> None:
    one, folder = flight(tmp_path), tmp_path / "frames"
    folder.mkdir()
    for number in (*range(1, 20), *range(23, 40)):
        (folder / f"frame_{number:04}.png").write_bytes(b"")
    (found,) = messages_of_files(replace(one, video=(folder,)))
    assert_approved(found.removeprefix(f"{folder}"))
    for number in range(20, 23):
        (folder / f"frame_{number:04}.png").write_bytes(b"")
    assert not [*messages_of_files(replace(one, video=(folder,)))]


def test_images_that_are_not_there_or_named_otherwise(tmp_path: Path) -> None:
    """A folder without an image; one with other names; and all that are picked beside another."""
    one, folder = flight(tmp_path), tmp_path / "frames"
    folder.mkdir()
    named = tuple(f"{k}.png" for k in range(5))
    own = replace(one, video=(folder,), image_name=named)
    (found,) = messages_of_files(own)
    assert_approved(found.removeprefix(f"{folder}"))
    for name in ("x.png", "y.png"):
        (folder / name).write_bytes(b"")
    assert_approved([*messages_of_files(own)])
    with refused(VopdError):
        photograph(own, 0, "0.png")
    for name in named:
        (folder / name).write_bytes(b"")
    assert not [*messages_of_files(own)]


def test_pictures_are_found_from_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A notebook that changes its folder drew figures without their photographs, unsaid."""
    images = pytest.importorskip("PIL.Image")
    write_project(tmp_path / "own", TOML.replace("[picks]", '[picks]\nvideo = "frames"', 1))
    (tmp_path / "own" / "frames").mkdir()
    images.new("RGB", (1920, 1080)).save(tmp_path / "own" / "frames" / "0.png")
    monkeypatch.chdir(tmp_path)
    flight = read_flight("own/flight.toml")
    monkeypatch.chdir(tmp_path / "own" / "frames")
    assert photograph(flight, 0, "0.png").size == (1920, 1080)
    assert photograph(flight, 0, "cam/0.png").size == (1920, 1080)
    scene = solve_flight_read(flight).history().estimate.scene
    assert scene is not None and scene().photographs is not None
    found = dict(scene().photographs([(7, "1.png"), (9, "0.png")]))  # by their places
    assert found[1].size == (1920, 1080) and isinstance(found[0], VopdError)


def test_folders_are_listed_once_for_all_images(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder of 3,000 was listed for each of them: 170 s."""
    (tmp_path / "inside").mkdir()
    for name in ("a.png", "inside/b.png", "c.png"):
        (tmp_path / name).touch()
    listed: list[Path] = []
    listing = Path.iterdir
    monkeypatch.setattr(Path, "iterdir", lambda one: listed.append(one) or listing(one))
    names = ["a.png", "x/b.png", "d.png", "c.png/e.png", "\0", "c.png", "inside/a.png"]
    there = photographs.lost_images(names, [tmp_path, tmp_path / "none"])
    assert there == "d.png, c.png/e.png, \0 are"
    assert listed == [tmp_path, tmp_path / "none"]


def test_pictures_of_another_size_than_their_lens(tmp_path: Path) -> None:
    """Upright; those that are not there, or are no images, are none."""
    images = pytest.importorskip("PIL.Image")
    one = flight(tmp_path)
    folder = tmp_path / "film"
    folder.mkdir()
    named = tuple(f"{k}.jpg" for k in range(len(one.frame)))
    own = replace(one, video=(folder,), image_name=named, folder=tmp_path)
    wide, high = one.lens.size_px

    def write(k: int, size: tuple[int, int], orientation: int = 1) -> list[str]:
        tags = images.Exif()
        tags[0x112] = orientation
        images.new("L", size).save(folder / named[k], exif=tags)
        return [told for told in messages_of_files(own) if "the lens is for" in told]

    assert write(2, (wide, high)) == write(1, (high, wide), 6) == []
    (folder / named[0]).write_bytes(b"\xff\xd8\xff")
    assert_approved(write(3, (wide // 2, high // 2)))
    assert_approved(write(2, (wide, high), 8))


def test_each_answer_says_that_a_picture_has_another_size_than_its_lens(tmp_path: Path) -> None:
    """One of the first twenty, once; `check` looks at all of them."""
    images = pytest.importorskip("PIL.Image")
    path = write_project(tmp_path, TOML.replace('"picks.csv"', '"picks.csv"\nvideo = "film"'))
    (tmp_path / "film").mkdir()
    picks = (tmp_path / "picks.csv").read_text().splitlines()
    picks = [f"{row.partition(',')[0]}.png,{row.partition(',')[2]}" for row in picks[1:]]
    (tmp_path / "picks.csv").write_text("\n".join(["image,landmark,u_px,v_px", *picks, ""]))
    for k, size in enumerate([(1920, 1080)] * 3 + [(960, 540)] * 2):
        images.new("L", size).save(tmp_path / "film" / f"{k}.png")
    ran, checked = vopd("attitude", path), vopd("check", path)
    assert (ran.status, ran.stderr.count("the lens is for")) == (0, 1)
    assert "3.png has 960 x 540" in ran.stderr and checked.stdout.count("the lens is for") == 1


def test_a_video_of_another_size_than_the_lens(tmp_path: Path) -> None:
    """The size of one of its frames is that of all."""
    pytest.importorskip("av")
    from tests.kit.video import SIZE, write_video

    one = flight(tmp_path)
    video = write_video(tmp_path / "a.mp4", [40 * k for k in range(int(one.frame[-1]) + 1)])
    own = replace(one, video=(video,), image_name=(), folder=tmp_path)
    assert_approved([*messages_of_files(own)])
    same = replace(own, lens=replace(one.lens, size_px=SIZE))
    assert not [told for told in messages_of_files(same) if "the lens is for" in told]


@pytest.mark.parametrize("decoder", ["PyAV", "ffmpeg"])
def test_each_answer_says_that_a_video_has_another_size_than_the_lens(
    decoder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("av")
    from tests.kit.video import write_video

    if decoder == "ffmpeg":
        if shutil.which("ffmpeg") is None:
            pytest.skip("ffmpeg is not there")
        monkeypatch.setattr("vopd.video.has_pyav", bool)  # False
    path = write_project(tmp_path, TOML.replace('"picks.csv"', '"picks.csv"\nvideo = "a.mp4"'))
    write_video(tmp_path / "a.mp4", [100 * k for k in range(5)])
    for command in ("attitude", "check"):
        ran = vopd(command, path)
        assert (ran.stdout + ran.stderr).count("a.mp4 has 64 x 48 upright") == 1, ran


def test_picks_outside_the_image_are_counted_and_the_first_is_named(tmp_path: Path) -> None:
    one = flight(tmp_path)
    pixel = one.picks.pixel.copy()
    pixel[8], pixel[20] = (-7.25, 50.0), (5.0, 3000.5)
    (found,) = messages_of_files(replace(one, picks=replace(one.picks, pixel=pixel)))
    assert_approved(found)


@pytest.mark.parametrize(
    ("share", "middle"), [(0.1, False), (0.2, True)]
)  # fmt: skip
def test_picks_that_count_from_the_middle_of_the_image(
    share: float, middle: bool, tmp_path: Path
) -> None:
    """Some are then left of it, and none is farther than half its size, 960 by 540."""
    one = flight(tmp_path)
    pixel = np.abs(one.picks.pixel) % [900.0, 500.0]
    pixel[: round(share * len(pixel))] *= [-1.0, 1.0]
    (found,) = messages_of_files(replace(one, picks=replace(one.picks, pixel=pixel)))
    assert ("u + 960 and v + 540 " in found) == middle
    pixel[-1] = 970.0, 0.0
    (found,) = messages_of_files(replace(one, picks=replace(one.picks, pixel=pixel)))
    assert "u + 960" not in found


def far(one: Flight, camera_m: Any = None, marks_m: Any = None) -> list[str]:
    path = one.path if camera_m is None else replace(one.path, position_m=camera_m)
    marks = one.landmarks if marks_m is None else replace(one.landmarks, position_m=marks_m)
    return [*far_landmarks(replace(one, path=path, landmarks=marks))]


@pytest.mark.parametrize(("height_km", "told"), [(297.0, False), (303.0, True)])
def test_landmarks_300_km_away_are_far(height_km: float, told: bool, tmp_path: Path) -> None:
    one = flight(tmp_path)
    camera = np.tile(earth_centred_m(47.6435, 16.4759, 1e3 * height_km), (5, 1))
    found = far(one, camera)
    assert bool(found) == bool(told)
    assert_approved(found)
    camera[[0, 3, 4]] = np.nan  # frames without a position do not count
    found = far(one, camera)
    assert bool(found) == bool(told)
    assert_approved(found)
    camera[:] = np.nan
    assert far(one, camera) == []
    # half of the landmarks is near, and they decide with their count
    marks = marks_m()
    marks[:2] = earth_centred_m(-47.0, 100.0, 0.0)
    assert far(one, marks_m=marks) == []
    marks[:4] = earth_centred_m(-47.0, 100.0, 0.0)
    assert_approved(far(one, marks_m=marks))


def test_whose_latitude_and_longitude_are_exchanged(tmp_path: Path) -> None:
    one = flight(tmp_path)

    def turned(position: Any) -> Any:
        where = geodetic(position)
        return earth_centred_m(where.longitude_deg, where.latitude_deg, where.height_m)

    whose = "the landmarks or of the camera"
    assert_approved(far(one, marks_m=turned(one.landmarks.position_m)), parts=[whose])
    assert_approved(far(one, turned(one.path.position_m)), parts=[whose])
    assert far(one, turned(one.path.position_m), turned(one.landmarks.position_m)) == []
    east = earth_centred_m([47.0] * 6, [120.0] * 6, [0.0] * 6)
    across = earth_centred_m([60.0] * 5, [-133.0] * 5, [0.0] * 5)  # 120 degrees by the pole
    assert_approved(far(one, across, east))
    assert_approved(far(one, earth_centred_m([47.0] * 5, [16.4759] * 5, [0.0] * 5), east))


def test_a_lost_sign_and_radians_are_named(tmp_path: Path) -> None:
    one = flight(tmp_path)
    marks = one.landmarks.position_m
    where = geodetic(marks)
    radians = earth_centred_m(
        np.deg2rad(where.latitude_deg), np.deg2rad(where.longitude_deg), where.height_m
    )
    (longitude,) = far(one, marks_m=marks * [1.0, -1.0, 1.0])
    assert "the other sign of longitude of the landmarks" in longitude
    (latitude,) = far(one, marks_m=marks * [1.0, 1.0, -1.0])
    assert "the other sign of latitude of the landmarks" in latitude
    (found,) = far(one, marks_m=radians)
    assert "latitude and longitude of the landmarks in radians" in found


def test_a_height_is_named_where_it_may_be_what_is_wrong(tmp_path: Path) -> None:
    one = read_flight(str(write_project(tmp_path)))
    where = geodetic(one.landmarks.position_m)
    (found,) = far(one, marks_m=earth_centred_m(where.latitude_deg, where.longitude_deg, 4e5))
    assert_approved(found)


def test_an_exchanged_position_is_not_the_landmarks(tmp_path: Path) -> None:
    """The landmarks are in the area of their CRS as they stand; exchanged they leave it."""
    shutil.copytree(Path(__file__).parents[2] / "examples" / "summits", tmp_path / "p")
    path = tmp_path / "p" / "flight.toml"
    one = read_flight(str(path))
    camera = far_module._grid_exchanged(one, one.path.position_m)
    (found,) = far(one, camera)
    assert "with x and y of the position exchanged" in found


def test_easting_and_northing_are_named_before_latitude_and_longitude(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = flight(tmp_path)
    where = geodetic(one.landmarks.position_m)
    turned = earth_centred_m(where.longitude_deg, where.latitude_deg, where.height_m)
    words, _ = far_module.COORDINATE_MISTAKES[0]
    grid = words, lambda flight, position_m: one.landmarks.position_m
    every = (grid, *far_module.COORDINATE_MISTAKES[1:])
    monkeypatch.setattr(far_module, "COORDINATE_MISTAKES", every)
    assert_approved(far(one, marks_m=turned))


def test_findings_of_a_check_stand_in_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where landmarks are far no usual mistake is looked for."""
    path = str(write_project(tmp_path))
    monkeypatch.setattr(check_module, "usual_mistakes", lambda *_: ["a mistake"])
    usual = [Finding("a mistake", path, severity="warning")]
    assert check_flight(path) == usual
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([*rows, "9,mast,5,5", "0,steeple,1,1"]))
    found = check_flight(path)
    assert [(one.severity, one.message.partition(":")[0].partition(" (")[0]) for one in found] == [
        ("warning", "no landmark steeple"),
        ("warning", "frame 9"),
        ("warning", "a mistake"),
    ]
    monkeypatch.setattr(check_module, "messages_of_files", lambda flight: ["of the files"])
    monkeypatch.setattr(check_module, "far_landmarks", lambda flight: ["far away"])
    unknown, *rest = check_flight(path)
    assert unknown.message.startswith("no landmark steeple (1 pick)")
    assert rest == [
        Finding(message, path, severity="warning") for message in ("of the files", "far away")
    ]


@pytest.mark.parametrize(("solved", "told"), [([False, False], True), ([True, False], False)])
def test_a_solve_without_an_attitude_is_an_error(
    solved: list[bool], told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = str(write_project(tmp_path))
    history = SimpleNamespace(about=None, summary=HistorySummary())
    result = SimpleNamespace(
        solved=np.array(solved),
        findings=(),
        misfits=False,
        history_parts=lambda _: history,
        estimates=None,
    )
    monkeypatch.setattr(check_module, "solve_flight_read", lambda flight, project: result)
    monkeypatch.setattr(check_module, "usual_mistakes", lambda *_: [])
    found = check_flight(path)
    assert bool(found) == bool(told)
    assert_approved(found)


def test_a_solve_that_is_refused_is_an_error_without_the_file_s_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = str(write_project(tmp_path))

    def fails(flight: Flight, project: object) -> None:
        raise VopdError(f"{path}: odd")

    monkeypatch.setattr(check_module, "solve_flight_read", fails)
    monkeypatch.setattr(check_module, "messages_of_files", lambda flight: ["of the files"])
    assert check_flight(path) == [
        Finding("of the files", path, severity="warning"), Finding("odd", path),
    ]  # fmt: skip


def test_rows_of_a_track_that_are_no_fixes_are_named(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    track = tmp_path / "track.csv"
    rows = track.read_text().splitlines()
    t_s = rows[2].split(",")[0]
    for row in (f"{t_s},0,0.0,0", rows[1]):
        track.write_text("\n".join([*rows[:2], row, *rows[3:]]))
        (found,) = messages(path)
        assert_approved(found, parts=["line 3"])
        new = vopd("new", tmp_path / "p", "--track", track)
        assert found[found.index("line 3") :] in new.stderr


@pytest.mark.parametrize("own", ["t_ms", "time_ms"])
def test_times_in_milliseconds_are_read_as_such(tmp_path: Path, own: str) -> None:
    path = write_project(tmp_path)
    before = read_flight(str(path))
    changed(path, "track.csv", lambda r: [f"{1e3 * float(r[0]):.3f}", *r[1:]])
    track = tmp_path / "track.csv"
    track.write_text(track.read_text().replace("t_s", own, 1))
    after = read_flight(str(path))
    assert np.array_equal(after.path.position_m, before.path.position_m)
    assert_approved([one for one in after.about if one not in before.about], parts=[own])


@pytest.mark.parametrize("own", ["Altitude (ft)", "h_ft", "elevation_feet"])
def test_heights_in_feet_are_read_as_such(tmp_path: Path, own: str) -> None:
    """As loggers of rockets write them, found by themselves or named."""
    path = write_project(tmp_path)
    before = read_flight(str(path))
    changed(path, "track.csv", lambda r: [*r[:3], f"{float(r[3]) / 0.3048:.9f}", *r[4:]])
    track = tmp_path / "track.csv"
    text = track.read_text()
    track.write_text(text.replace("h_m", own, 1))
    after = read_flight(str(path))
    assert_close("feet", after.path.position_m, before.path.position_m)
    assert_approved([one for one in after.about if one not in before.about], parts=[own])
    path.write_text(path.read_text().replace("[track]", f'[track]\ncolumns = {{ h_m = "{own}" }}'))
    assert_close("feet", read_flight(str(path)).path.position_m, before.path.position_m)


def test_milliseconds_since_1970_in_a_column_of_seconds_are_suspected(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    changed(path, "track.csv", lambda r: [f"{1767225600000 + 1e3 * float(r[0]):.0f}", *r[1:]])
    (found,) = messages(path)
    assert "milliseconds since 1970? then name the column t_unix_ms" in found


def test_a_focal_length_in_millimetres_is_suspected(tmp_path: Path) -> None:
    """A side of 4000 px is 2 atan(2000 / 24) = 178.6 degrees wide with 24 px."""
    shutil.copytree(Path(__file__).parents[2] / "examples" / "summits", tmp_path / "p")
    path = tmp_path / "p" / "flight.toml"
    text = path.read_text().splitlines()
    lens = ['lens = { model = "brown", fx_px = 24.0 }' if t[:4] == "lens" else t for t in text]
    path.write_text("\n".join(lens))
    (found,) = [one for one in messages(path) if "fx_px" in one]
    assert_approved(found, parts=["fx_px = 24", "179 degrees wide"])


def test_a_table_of_a_projected_crs_is_asked_for_x_and_y(tmp_path: Path) -> None:
    shutil.copytree(Path(__file__).parents[2] / "examples" / "summits", tmp_path / "p")
    marks = tmp_path / "p" / "summits.csv"
    marks.write_text(marks.read_text().replace("x_m,y_m", "x_own_m,y_own_m", 1))
    (found,) = messages(tmp_path / "p" / "flight.toml")
    assert_approved(found)
    new = vopd("new", tmp_path / "q", "--landmarks", marks, "--crs", "EPSG:32633")
    assert "--columns landmarks:x_m=x_own_m,y_m=y_own_m" in new.stderr


EXAMPLES = Path(__file__).parents[2] / "examples"


def hill_with(tmp_path: Path, *replaced: tuple[str, str]) -> Path:
    shutil.copytree(EXAMPLES / "hill", tmp_path / "p")
    path = tmp_path / "p" / "flight.toml"
    for old, new in replaced:
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))
    return path


def cause(path: Path) -> str:
    """What explains the residuals, first in the answer of `vopd check` after the misfit."""
    (found,) = [one for one in messages(path) if "typical frame" in one or "speak for" in one][-1:]
    return found


def test_all_heights_in_feet_are_named_and_not_a_landmark(tmp_path: Path) -> None:
    path = hill_with(tmp_path)
    for name in ("landmarks.csv", "track.csv"):
        changed(path, name, lambda r: [*r[:3], str(float(r[3]) / 0.3048), *r[4:]])
    assert_approved(cause(path), parts=["all heights taken for feet"])


def test_one_landmark_far_off_is_named_and_not_feet(tmp_path: Path) -> None:
    """500 m of height at 500 m: the other five fit, and no unit explains it."""
    path = hill_with(tmp_path)
    changed(path, "landmarks.csv", lambda r: [*r[:3], str(float(r[3]) + 500.0 * (r[0] == "tower"))])
    found = messages(path)
    assert not any("feet" in one for one in found) and any("tower" in one for one in found)


@pytest.mark.parametrize("pad_m", [450.0, 520.0])
def test_heights_that_count_from_the_pad_are_named(pad_m: float, tmp_path: Path) -> None:
    """Landmarks 410 to 490 m above the sea: v seemed to be counted upward."""
    path = hill_with(tmp_path)
    changed(path, "track.csv", lambda r: [*r[:3], f"{float(r[3]) - pad_m:.3f}"])
    found = cause(path)
    assert f"+{pad_m:.0f} m" in found
    assert_approved(found)


@pytest.mark.parametrize(("times", "size"), [(2.0, "[3840, 2160]"), (1.5, "[2880, 1620]")])
def test_a_calibration_at_another_size_with_its_centre_is_named(
    times: float, size: str, tmp_path: Path
) -> None:
    """Focal length and principal point scaled together seemed to be another position."""
    lens = {"fx_px": 1500.0, "fy_px": 1490.0, "cx_px": 962.3, "cy_px": 534.8}
    pairs = [(f"{name} = {one}", f"{name} = {times * one}") for name, one in lens.items()]
    found = cause(hill_with(tmp_path, *pairs))
    assert size in found
    assert_approved(found)


@pytest.mark.parametrize(
    ("ratio", "is_said"), [(0.5, True), (2.0 / 3.0, True), (0.7, False), (2.0, True)]
)
def test_a_calibration_at_another_size_is_named(
    ratio: float, is_said: bool, tmp_path: Path
) -> None:
    """The principal point of the smaller one is near the images' corner, too."""
    path = hill_with(
        tmp_path,
        ("fx_px = 1500.0, fy_px = 1490.0", f"fx_px = {1500.0 * ratio}, fy_px = {1490.0 * ratio}"),
    )
    if ratio < 1.0:
        text = path.read_text().replace("cx_px = 962.3", f"cx_px = {962.3 * ratio}")
        path.write_text(text.replace("cy_px = 534.8", f"cy_px = {534.8 * ratio}"))
    found = cause(path)
    assert ("lens_size_px" in found) == is_said
    assert_approved(found)


def test_a_size_of_the_calibration_that_is_stated_is_not_looked_for(tmp_path: Path) -> None:
    """It is the wrong one: a focal length is named, and no other size."""
    size = "image_size_px = [1920, 1080]\n"
    path = hill_with(tmp_path, (size, f"{size}lens_size_px = [1280, 720]\n"))
    found = " ".join(messages(path))
    assert "speak for" in found and "was it calibrated at that size" not in found


@pytest.mark.parametrize(("times", "size"), [(2.0, "960 x 540"), (1.5, "1280 x 720")])
def test_picks_in_smaller_pictures_are_named(times: float, size: str, tmp_path: Path) -> None:
    """They seemed to be of a camera 300 m away; so far from the middle no lens has these."""
    path = hill_with(tmp_path, ("cx_px = 962.3, cy_px = 534.8, ", ""))
    changed(
        path, "picks.csv", lambda r: [*r[:2], *(str((float(x) + 0.5) / times - 0.5) for x in r[2:])]
    )
    found = cause(path)
    assert size in found
    assert_approved(found)


@pytest.mark.parametrize(("first_s", "off"), [("1.9", "1 too low"), ("2.2", "2 too high")])
def test_numbers_of_frames_that_are_off_are_named(first_s: str, off: str, tmp_path: Path) -> None:
    """At 10 a second .1 s is one frame; .04 s are none."""
    path = hill_with(tmp_path, ("first_frame_t_s = 2.0", f"first_frame_t_s = {first_s}"))
    assert off in cause(path)
    path.write_text(path.read_text().replace(f"t_s = {first_s}", "t_s = 2.04"))
    assert "offset_s" in cause(path) and "too " not in cause(path)


def test_grid_coordinates_in_feet_are_named(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES / "summits", tmp_path / "p")
    path = tmp_path / "p" / "flight.toml"
    changed(path, "summits.csv", lambda r: [r[0], *(str(float(one) / 0.3048) for one in r[1:])])
    found = [one for one in messages(path) if "feet" in one]
    assert len(found) == 2
    assert_approved(found)
    own = "+proj=utm +zone=33 +datum=WGS84 +vunits=m"  # with heights of its own
    text = path.read_text().replace('"EPSG:32633"', f'"{own}"')
    path.write_text(re.sub(r"(?m)^height = .*\n", "", text))
    assert any("in feet they are not" in one for one in messages(path))
