"""New projects of videos: times, size, files, and a track that comes with them."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from PIL import ExifTags, Image

from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd
from tests.kit.video import SIZE, write_video
from vopd.findings import VopdError
from vopd.flight.project.inspect import NewProject
from vopd.flight.project.keys import Project, Section
from vopd.flight.project.new import NAME, Answer, open_keys, project_of_files

LANDMARKS = "landmark,lat_deg,lon_deg,h_m,sigma_m\nmast,47.0,15.0,300.0,0.1\n"
BLOCK = (
    "{0}\n00:00:0{0},000 --> 00:00:0{0},900\n[latitude: 47.0{0}] [longitude: 15.0] [abs_alt: 9]\n"
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a video in two files and landmarks."""
    monkeypatch.chdir(tmp_path)
    for name in ("a.mp4", "b.mp4"):
        write_video(Path(name), [0, 40, 80])
    Path("l.csv").write_text(LANDMARKS)
    return tmp_path


def values(new: NewProject) -> dict[str, dict[str, object]]:
    """The keys of a new project."""
    return tomllib.loads(new.contents[NAME].decode())


def test_a_video_with_a_track_beside_it(folder: Path) -> None:
    Path("a.SRT").write_text("".join(BLOCK.format(k) for k in range(3)))
    new = project_of_files(folder, {"landmarks": "l.csv"}, video=["a.mp4", "b.mp4"])
    found = values(new)
    assert found["picks"] == {
        "file": "clicks.csv", "tracked": "tracked.csv", "first_frame_t_s": 0.0, "times": "video",
        "video": ["a.mp4", "b.mp4"],
    }  # fmt: skip
    assert found["camera"] == {"image_size_px": list(SIZE)}
    assert found["track"] == {"file": "a.SRT"}
    needed = {("camera", "lens"), ("landmarks", "height"), ("track", "height")}
    assert {*new.needed} == needed | {("track", "sigma_m"), ("track", "sigma_t_s")}
    assert_approved("\n".join([*new.said, new.then]).replace(str(folder), "FOLDER"))


def test_clicks_in_few_frames_are_to_be_followed(folder: Path) -> None:
    """Picks in every frame, as another program's, are not."""
    Path("t.csv").write_text("t_s,lat_deg,lon_deg,h_m,sigma_m\n0,47,15,9,1\n1,47.001,15,9,1\n")
    head, row = (
        "# pixels: (0, 0) the centre of the first pixel\nframe,landmark,u_px,v_px\n",
        "{},mast,1,2\n",
    )
    said = []
    for frames in ([0], [0, 1, 2]):
        Path("c.csv").write_text(head + "".join(map(row.format, frames)))
        given = {"landmarks": "l.csv", "track": "t.csv", "picks": "c.csv"}
        new = project_of_files(folder, given, video=["a.mp4"])
        said.append(f"{values(new)['picks'].get('tracked')}: {new.said[2:4]}")
    assert_approved("\n".join(said).replace(str(folder), "FOLDER"))


def test_what_to_do_next_with_clicks_when_nothing_is_needed(folder: Path) -> None:
    """Click first while none is there; then all frames, where something is still needed not yet."""
    Path("t.csv").write_text("t_s,lat_deg,lon_deg,h_m,sigma_m\n0,47,15,9,1\n1,47.001,15,9,1\n")
    head = "# pixels: (0, 0) the centre of the first pixel\nframe,landmark,u_px,v_px\n"
    Path("c.csv").write_text(f"{head}0,mast,1,2\n")
    options = [
        "--video", "a.mp4", "--landmarks", "l.csv", "--track", "t.csv", "--height", "ellipsoid",
        "--lens", "60,60,32,24", "--pixel-grid", "centre", "--first-frame", "0",
        "--sigma-time", "0",
    ]  # fmt: skip
    said = []
    for name, more in {"a": [], "b": ["--picks", "c.csv"], "c": ["--picks", "c.csv"]}.items():
        given = options[:-2] if name == "c" else options
        ran = vopd("new", name, *given, *more)
        assert ("needed: " in ran.stdout) == (name == "c")
        said.append(ran.stdout.splitlines()[-1])
    assert_approved(said)


def test_a_video_with_a_track_by_date(folder: Path) -> None:
    """Neither file says when the first frame was, and the track has a clock of its own."""
    Path("t.csv").write_text(
        "t_utc,lat_deg,lon_deg,h_m,sigma_m\n2026-05-01T10:00:00Z,47,15,9,1\n"
        "2026-05-01T10:00:01Z,47.001,15,9,1\n"
    )
    given = {"landmarks": "l.csv", "track": "t.csv"}
    new = project_of_files(folder, given, video=["a.mp4"])
    assert values(new)["picks"] == {
        "file": "clicks.csv",
        "tracked": "tracked.csv",
        "times": "video",
        "video": "a.mp4",
    }
    assert {("picks", "first_frame_t_s"), ("flight", "epoch")} <= {*new.needed}
    with refused(VopdError):
        project_of_files(folder, given, video=["l.csv"])


def test_the_frames_of_a_video_as_images(folder: Path) -> None:
    """Numbers and a rate are their times; photographs have times and positions of their own."""
    for name in (
        "film/f_7.png",
        "film/f_8.png",
        "film/f_10.png",
        "photos/a_1.jpg",
        "photos/a_2.jpg",
    ):
        Path(name).parent.mkdir(exist_ok=True)
        picture, exif = Image.new("RGB", SIZE), Image.Exif()
        exif.get_ifd(ExifTags.IFD.Exif)[ExifTags.Base.DateTimeOriginal] = "2026:05:01 10:00:00"
        picture.save(name, exif=exif if "photos" in name else None)
    Path("t.csv").write_text("t_s,lat_deg,lon_deg,h_m,sigma_m\n0,47,15,9,1\n1,47.001,15,9,1\n")
    said = []
    for images in ("film", "photos"):
        given = {"landmarks": "l.csv", "track": "t.csv", "images": images}
        new = project_of_files(folder, given)
        said += [str(values(new)["picks"]), *new.said[1:3], *map(str, new.needed)]
    assert_approved("\n".join(said).replace(str(folder), "FOLDER"))


def test_the_frames_of_a_video_that_were_picked_in_by_their_names(folder: Path) -> None:
    """They were refused as having no place in a video, and --images was advised."""
    Path("film").mkdir()
    for k in range(3):
        Image.new("RGB", SIZE).save(f"film/f_{k}.png")
    Path("p.csv").write_text("image,landmark,u_px,v_px\nf_0.png,x,1,2\nf_2.png,x,1,2\n")
    Path("t.csv").write_text("t_s,lat_deg,lon_deg,h_m,sigma_m\n0,47,15,9,1\n1,47.001,15,9,1\n")
    given = {"landmarks": "l.csv", "track": "t.csv", "images": "film", "picks": "p.csv"}
    new = project_of_files(folder, given)
    assert values(new)["picks"] == {"file": "p.csv", "video": "film"}
    assert values(new)["camera"] == {"image_size_px": list(SIZE)}
    assert [("picks", "frame_rate_hz") in new.needed, ("picks", "times") in new.needed] == [
        True,
        False,
    ]
    picks = {"file": "p.csv", "video": "film", "pixel_grid": "centre"}  # of photographs, perhaps
    given = {"picks": picks, "track": {"file": "t.csv", "height": "ellipsoid"}}
    sections = {name: Section("p.toml", name, own) for name, own in given.items()}
    needed = open_keys(Project("p.toml", folder, sections))
    assert ("picks", "times") in needed and ("picks", "frame_rate_hz") not in needed


def test_a_calibration_for_pictures_of_another_size(folder: Path) -> None:
    """The size is that of the frames, so that vopd check asks about the lens, too."""
    Path("lens.txt").write_text("1 OPENCV 128 96 150 150 64 48 0 0 0 0\n")
    new = project_of_files(folder, {"landmarks": "l.csv", "lens": "lens.txt"}, video=["a.mp4"])
    assert values(new)["camera"] == {"lens": "lens.txt", "image_size_px": list(SIZE)}
    assert_approved(new.said[2])
    scaled = Answer("--set", [("camera", "lens_size_px")], "[128, 96]", at_once=True)
    given = {"landmarks": "l.csv", "lens": "lens.txt"}
    again = project_of_files(folder, given, [scaled], video=["a.mp4"])
    assert again.said == [one for one in new.said if one != new.said[2]]


def test_what_a_project_without_clicks_needs_is_named_at_once(folder: Path) -> None:
    """Its first step is not the page to click on while there are no landmarks."""
    ran = vopd("new", "p", "--video", "a.mp4")
    assert ran.stdout.splitlines()[-1].startswith("next: vopd new p --lens ")
    needed = [line.split(" (")[0] for line in ran.stdout.splitlines() if "needed: " in line]
    asked = vopd("check", "p").stdout
    assert len(needed) == 7 and all(f"\n{one.split()[-1]} = " in asked for one in needed)


def test_images_are_no_video(folder: Path) -> None:
    Image.new("L", SIZE).save("a.png")
    with refused(VopdError):
        project_of_files(folder, {"landmarks": "l.csv"}, video=["a.png"])
