"""Times of frames that are images: from their tags, with their zone or the project's."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.kit.command import vopd as run
from tests.kit.flight_project import TOML, camera_m, truth_deg, write_project
from tests.kit.tagged_images import tagged_image
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.flight.image_tags import read_tags
from vopd.geometry.earth import geodetic

TIMES = '\n[picks]\nfile = "picks.csv"\npixel_grid = "centre"\ntimes = "images"\n'


def project_of_images(
    folder: Path, zone: str = "+02:00", more: str = "", part: bool = True
) -> Path:
    """The frames of the project as images whose clock is 2 h ahead of UTC; a track by time.

    Frame k is of 11:58:44 UTC and k tenths, 2 s and k tenths after the epoch.
    """
    start, rest = TOML.split("[picks]")
    project = write_project(folder, start + TIMES + more + rest[rest.index("[landmarks]") :])
    (folder / "images").mkdir()
    for k in range(5):
        tagged_image(
            folder / "images" / f"IMG_{k}.JPG",
            taken="2026:05:01 13:58:44",
            part=str(k) if part else "",
            zone=zone,
        )
    picks = folder / "picks.csv"
    rows = [f"IMG_{row[0]}.JPG{row[1:]}" for row in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    return project


def test_a_time_with_part_of_a_second_and_zone(tmp_path: Path) -> None:
    """13:58:44.25 at two hours ahead is 11:58:44.25 UTC."""
    path = tmp_path / "a.jpg"
    tagged_image(path, taken="2026:05:01 13:58:44", part="250", zone="+02:00")
    tags = read_tags(path)
    expected = datetime(2026, 5, 1, 11, 58, 44, 250_000, tzinfo=UTC).timestamp()
    assert (tags.clock_s - tags.zone_s, tags.zone_s, tags.whole_second) == (expected, 7200.0, False)


@pytest.mark.parametrize("taken", ["", "    :  :     :  :  ", "2026-05-01", "0000:00:00 00:00:00"])
def test_a_clock_that_was_never_set_is_no_time(tmp_path: Path, taken: str) -> None:
    tagged_image(tmp_path / "a.jpg", taken=taken, part="25", zone="west")
    tags = read_tags(tmp_path / "a.jpg")
    assert np.isnan([tags.clock_s, tags.zone_s]).all() and tags.whole_second


def test_frames_have_the_times_of_their_images(tmp_path: Path) -> None:
    flight = vopd.solve_flight(project_of_images(tmp_path))
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert flight.estimate.time_s.round(6).tolist() == [2.0, 2.1, 2.2, 2.3, 2.4]
    assert flight.findings == ()
    assert "images: times of 5 images by their EXIF tags, by their own zone" in flight.about


def test_the_project_gives_a_zone_that_the_tags_do_not_have(tmp_path: Path) -> None:
    project = project_of_images(tmp_path, zone="")
    with pytest.raises(VopdError, match=r"\[picks\] utc_offset_h: is needed: the tags of IMG_0"):
        vopd.solve_flight(project)
    text = project.read_text()
    project.write_text(text.replace('"images"', '"images"\nutc_offset_h = 2.0'))
    flight = vopd.solve_flight(project)
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    project.write_text(text.replace('"images"', '"images"\nutc_offset_h = 1.0'))
    with pytest.raises(VopdError, match="the track is from 1 to 4 s, the frames from 3602 to"):
        vopd.solve_flight(project)
    project.write_text(text.replace('"images"', '"images"\nutc_offset_h = 15.0'))
    with pytest.raises(VopdError, match="utc_offset_h: 15 is not of any zone: -12 to 14 hours"):
        vopd.solve_flight(project)


def test_a_zone_that_the_tags_have_is_not_given_again(tmp_path: Path) -> None:
    project = project_of_images(tmp_path, more="utc_offset_h = 2.0\n")
    with pytest.raises(VopdError, match=r"the tags have their zone, \+2 h: leave the key out"):
        vopd.solve_flight(project)


def test_whole_seconds_are_a_finding_unless_the_project_allows_for_them(tmp_path: Path) -> None:
    """The camera's velocity is 5, 20 and 2 m/s, together 20.7."""
    project = project_of_images(tmp_path, part=False)
    (finding,) = vopd.solve_flight(project).findings[:1]
    assert "whole seconds, in which the camera moves 20.7 m" in str(finding)
    text = project.read_text().replace('"track.csv"', '"track.csv"\nsigma_t_s = 0.3')
    project.write_text(text)
    assert not any("whole seconds" in str(one) for one in vopd.solve_flight(project).findings)


def test_images_without_times_and_a_folder_of_other_images(tmp_path: Path) -> None:
    project = project_of_images(tmp_path)
    for path in (tmp_path / "images").iterdir():
        path.rename(path.with_name(f"other_{path.name}"))
    with pytest.raises(VopdError, match=r"none of the frames is there \(IMG_0\.JPG\)"):
        vopd.solve_flight(project)
    for path in (tmp_path / "images").iterdir():
        tagged_image(path)
    with pytest.raises(VopdError, match="none of its 5 images has a time in its tags"):
        vopd.solve_flight(project)
    for path in (tmp_path / "images").iterdir():
        path.unlink()
    with pytest.raises(VopdError, match="none of its 0 images has a time in its tags"):
        vopd.solve_flight(project)


def test_a_new_project_takes_times_from_images_beside_a_track(tmp_path: Path) -> None:
    project_of_images(tmp_path / "a", zone="")
    files = tmp_path / "a"
    ran = run(
        "new", tmp_path / "new", "--images", files / "images", "--picks", files / "picks.csv",
        "--track", files / "track.csv",
    )  # fmt: skip
    assert ran.status == 0
    assert "images: 5 images, whose tags give the frames' times" in ran.stdout
    assert "needed: [picks] utc_offset_h" in ran.stdout
    text = (tmp_path / "new" / "flight.toml").read_text()
    assert 'times = "../a/images"' in text and 'file = "../a/track.csv"' in text


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("0,2.0\n1,1.9\n", "t.csv: line 3, column t_s: frame 1 is not after frame 0"),
        ("1,2.0\n0,2.1\n", "t.csv: line 2, column t_s: frame 1 is not after frame 0"),
        ("0,2.0\n0,2.1\n", "a frame has two times"),
        ("0.5,2.0\n", "line 2, column frame: 0.5 is not the number of a frame"),
        ("7,2.0\n", r"none of the frames is there \(0\)"),
    ],
)
def test_times_of_frames_that_cannot_be(tmp_path: Path, rows: str, told: str) -> None:
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0"
    project = write_project(tmp_path, TOML.replace(rate, 'times = "t.csv"'))
    (tmp_path / "t.csv").write_text(f"frame,t_s\n{rows}")
    with pytest.raises(VopdError, match=told):
        vopd.solve_flight(project)
    good = "".join(f"{k},{2.0 + k / 10}\n" for k in range(5))
    (tmp_path / "t.csv").write_text(f"frame,t_s\n{good}")
    assert_close(
        "flight angle", vopd.solve_flight(project).camera_deg, truth_deg() % 360.0 - [0, 360, 0]
    )


def test_a_track_of_images_with_times_gives_positions_times_and_velocity(tmp_path: Path) -> None:
    """Positions belong to the images, so that other times of the frames are not needed."""
    project = project_of_images(tmp_path)
    text = project.read_text().replace('times = "images"\n', "")
    project.write_text(text.replace('"track.csv"', '"images.csv"'))
    where = geodetic(camera_m(2.0 + np.arange(5) / 10.0))
    rows = [
        f"IMG_{k}.JPG,{2.0 + k / 10},{a:.12f},{b:.12f},{h:.6f},0.5"
        for k, (a, b, h) in enumerate(zip(*where, strict=True))
    ]
    head = "image,t_s,lat_deg,lon_deg,h_m,sigma_m"
    (tmp_path / "images.csv").write_text("\n".join([head, *rows]))
    flight = vopd.solve_flight(project)
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert flight.estimate.time_s.round(6).tolist() == [2.0, 2.1, 2.2, 2.3, 2.4]
    velocity = flight.flight.path.velocity_m_s
    assert velocity is not None and np.abs(velocity - [20.0, 5.0, -2.0]).max() < within(
        "speed of images"
    )
    assert flight.flight.path.sigma_m.tolist() == [0.5, 0.5, 0.5]
