"""`vopd pick`: which frames are on the page, names and picks that it begins with, wrong usage."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.approved.texts import assert_approved, refused
from tests.kit.command import DECKS, vopd
from tests.kit.flight_project import TOML, camera_m, marks_m, write_project
from tests.kit.video import write_video
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.flight import Refraction
from vopd.flight.project.new import example_project
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.flight.solve.next_click import NextPlace
from vopd.report.pick import PageContent, pick_page

MARKS = "landmark,lat_deg,lon_deg,h_m\nmast,47,8,400\n</script>,47.001,8,400\n"


@pytest.fixture(autouse=True)
def in_a_new_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_video(tmp_path / "a.mp4", [40 * k for k in range(40)])


def data(page: str = "p.html") -> dict[str, Any]:
    """What the page was given."""
    text = Path(page).read_text(encoding="utf-8")
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)
    assert found
    return dict(json.loads(found[1]))


def picked(*arguments: Any, page: str = "p.html") -> Any:
    """Make a page; all that is said and all that the page was given is approved."""
    done = vopd("pick", *arguments, "-o", page)
    assert (done.status, done.stdout) == (0, ""), done.stderr
    size = f"{len(Path(page).read_bytes()) / 1e6:.1f} MB"
    lines = [done.stderr.replace(size, "N MB").rstrip("\n")]
    for key, value in data(page).items():
        for one in value if isinstance(value, list) else [value] if value and key != "key" else []:
            lines.append(f"{key}: {json.dumps(_rounded(one), sort_keys=True)}")
    assert_approved("\n".join(lines).replace(str(Path.cwd()), "FOLDER"))
    return data(page)


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_rounded(one) for one in value]
    return round(value, 6) + 0.0 if isinstance(value, float) else value


@pytest.mark.parametrize("at", ["", "3,", "x", "-1", "1.5", "\u0663", "1234567890"])
def test_frames_that_are_asked_for_are_numbers(at: str) -> None:
    ran = vopd("pick", "a.mp4", "-o", "p.html", f"--at={at}")
    assert ran.status == 2 and not Path("p.html").exists()
    assert_approved(ran.stderr.splitlines()[-1])


def test_frames_of_a_video(tmp_path: Path) -> None:
    names = [int(one["name"]) for one in picked("a.mp4")["frames"]]
    assert len(names) == 12 and (names[0], names[-1]) == (0, 39) and sorted(names) == names
    picked("a.mp4", "--at", "7,3,7")


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are bytes there alone")
def test_a_name_that_is_not_utf_8_costs_no_page() -> None:
    name = os.fsdecode(b"caf\xe9.png")
    Image.new("L", (40, 30)).save(name)
    assert vopd("pick", name, "-o", "p.html").status == 0
    assert "caf" in Path("p.html").read_text(encoding="utf-8")


def test_frames_before_one_that_cannot_be_decoded_are_offered() -> None:
    content = example_project().contents["flight.mp4"]
    Path("cut.mp4").write_bytes(content[: len(content) * 2 // 3])
    done = vopd("pick", "cut.mp4", "-o", "p.html")
    assert done.status == 1
    assert_approved(re.sub(r"(frame|--at) [\d,]+", r"\1 N", done.stderr))
    (at,) = re.findall(r"--at ([\d,]+)", done.stderr)
    assert vopd("pick", "cut.mp4", "-o", "p.html", "--at", at).status == 0
    alone = vopd("pick", "cut.mp4", "-o", "p.html", "--at", "20")
    assert alone.status == 1 and "--at 0 " in alone.stderr


@pytest.mark.parametrize("missing", ["jinja2", "PIL.Image"])
def test_all_packages_that_it_takes_are_named_at_once(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    done = vopd("pick", "a.mp4", "-o", "p.html")
    assert done.status == 1
    assert_approved(done.stderr)
    assert not Path("p.html").exists()


def test_landmarks_and_picks_that_there_are(tmp_path: Path) -> None:
    """A pick of another frame stays for the file; a name of its own is offered."""
    Path("lm.csv").write_text(MARKS)
    saved = "# pixels: u right, v down, (0, 0) the centre of the first pixel\n"
    Path("c.csv").write_text(saved + "frame,landmark,u_px,v_px\n3,pond,1.5,2\n4,mast,1,1\n")
    picked("a.mp4", "--at", "3", "--landmarks", "lm.csv", "--clicks", "c.csv")


def test_a_project_names_video_and_landmarks(tmp_path: Path) -> None:
    project = write_project(tmp_path, TOML.replace("[landmarks]", 'video = "a.mp4"\n[landmarks]'))
    Path("picks.csv").unlink()  # nothing is picked yet
    picked(project)


def test_a_project_goes_on_where_it_was(tmp_path: Path) -> None:
    """Its own picks and hidden marks are there; a lens and a track let the page predict."""
    toml = TOML.replace("picks.csv", "mine.csv").replace(
        "[landmarks]", 'video = "photos"\n[landmarks]'
    )
    project = write_project(tmp_path, toml)
    Path("photos").mkdir()
    for k in (0, 3):
        Image.new("L", (1920, 1080)).save(Path("photos", f"{k}.png"))
    saved = (
        "# pixels: u right, v down, (0, 0) the centre of the first pixel\n# hidden: 3.png,mast\n"
    )
    Path("mine.csv").write_text(saved + "image,landmark,u_px,v_px\n3.png,well,1.5,2\n")
    picked(project)
    alone = ("--clicks", "mine.csv", "--landmarks", "landmarks.csv")
    assert vopd("pick", "photos", "-o", "q.html", *alone).status == 0
    assert [data("q.html")[one] for one in ("picks", "hidden")] == [
        data()["picks"],
        data()["hidden"],
    ]
    (lens,) = data()["lenses"]
    assert (lens["kind"], lens["focal"], data()["sighted"][0]) == ("brown", [1500, 1490], "church")
    to = np.array([one["to"] for one in data()["frames"]])
    time_s = 2.0 + np.array([0, 3]) / 10.0
    frame, mark = np.divmod(np.arange(12), 6)
    lines = sight_lines(camera_m(time_s), marks_m(), frame, mark, Refraction())
    assert_close("direction on a page", to.reshape(-1, 3), lines.direction)


def test_no_click_is_asked_for_where_a_landmark_is_hidden(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three places are shown; for each that is hidden one more is looked for."""
    keys = '[picks]\nvideo = "a.mp4"\ntracked = "t.csv"\ntracked_from = "clicks"\nfile'
    project = write_project(tmp_path, TOML.replace("[picks]\nfile", keys, 1))
    saved = "# pixels: u right, v down, (0, 0) the centre of the first pixel\n# hidden: 7,mast\n"
    Path("picks.csv").write_text(saved + "frame,landmark,u_px,v_px\n3,well,1.5,2\n")
    solved = SimpleNamespace(estimates=SimpleNamespace(joint="joint"))
    asked: list[Any] = []

    def places(*given: Any) -> list[NextPlace]:
        asked.append(given)
        marks = [("7", "mast"), ("7", "pond"), ("9", "mast"), ("11", "well"), ("12", "well")]
        return [NextPlace(frame, mark, f"{mark} in {frame}", (1.0, 2.0)) for frame, mark in marks]

    monkeypatch.setattr("vopd.flight.result.solve_flight", lambda _: solved)
    monkeypatch.setattr("vopd.flight.solve.next_click.next_places", places)
    shown = [one["text"] for one in picked(project)["places"]]
    assert (asked, shown) == ([("joint", 4)], ["pond in 7", "mast in 9", "well in 11"])


def test_frames_that_are_picked_are_on_the_page_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of a video: all up to a number, and others spread over it where they are few."""
    toml = TOML.replace("picks.csv", "clicks.csv").replace(
        "[landmarks]", 'video = "a.mp4"\n[landmarks]'
    )
    project = write_project(tmp_path, toml)
    head = "frame,landmark,u_px,v_px\n"
    for picked in ([0], [0, 39], [5, 7, 99], [*range(40)], [1, 2, 3, *range(20, 32)]):
        rows = "".join(f"{frame},well,1.5,2\n" for frame in picked)
        Path("clicks.csv").write_text(head + rows)
        assert vopd("pick", project, "-o", "p.html").status == 0
        shown = [int(one["name"]) for one in data()["frames"]]
        inside = [frame for frame in picked if frame < 40]
        assert shown == sorted(shown) and len(shown) == max(12, len(inside))
        assert {*inside} <= {*shown} and len({*shown}) == len(shown)
        others = sorted({*shown} - {*inside})
        assert not others or {0, 39} <= {*shown}
    Path("clicks.csv").write_text(head + "".join(f"{frame},well,1.5,2\n" for frame in range(40)))
    monkeypatch.setattr("vopd.cli.pick.MOST_STILLS", 20)  # of too many each second one
    assert vopd("pick", project, "-o", "p.html").status == 0
    assert [int(one["name"]) for one in data()["frames"]] == [*range(0, 40, 2)]


@pytest.mark.parametrize("column", ["frame", "image"])
def test_images_stand_on_the_page_as_they_are_picked(column: str, tmp_path: Path) -> None:
    """By the numbers at the ends of their names, or by these; what is saved has one kind."""
    keys = '[picks]\nvideo = "images"\nfile'
    project = write_project(tmp_path, TOML.replace("[picks]\nfile", keys, 1))
    (tmp_path / "images").mkdir()
    for k in range(5):
        Image.new("L", (192, 108)).save(tmp_path / "images" / f"f_{k:03d}.png")
    if column == "image":
        head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
        named = [f"f_{int(row.partition(',')[0]):03d}.png,{row.partition(',')[2]}" for row in rows]
        (tmp_path / "picks.csv").write_text("\n".join([head.replace("frame", "image"), *named]))
    page = picked(project)
    assert page["column"] == column
    names = [str(k) if column == "frame" else f"f_{k:03d}.png" for k in range(5)]
    assert [one["name"] for one in page["frames"]] == names
    assert [one["title"] for one in page["frames"]] == [f"f_{k:03d}.png" for k in range(5)]
    assert {one["frame"] for one in page["picks"]} == {*range(5)}


@pytest.mark.parametrize("there", [True, False])
def test_images_whose_times_are_by_number_are_predicted(there: bool, tmp_path: Path) -> None:
    """Where nothing is picked yet, what is saved has numbers too: the table has no images."""
    toml = TOML.replace("frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0", 'times = "times.csv"')
    toml = toml.replace("[landmarks]", 'video = "photos"\n[landmarks]')
    project = write_project(tmp_path, toml)
    Path("photos").mkdir()
    for k in (1, 3):
        Image.new("L", (1920, 1080)).save(Path("photos", f"f_{k}.png"))
    Path("times.csv").write_text("frame,t_s\n0,2\n1,2.25\n2,2.5\n3,2.75\n4,3\n")
    head, *rows = Path("picks.csv").read_text().splitlines()
    Path("picks.csv").write_text("\n".join([head, *(one for one in rows if one[0] in "13")]))
    if not there:
        Path("picks.csv").unlink()
    page = picked(project)
    assert (page["column"], [one["name"] for one in page["frames"]]) == ("frame", ["1", "3"])
    assert len(page["picks"]) == (12 if there else 0)
    frame, mark = np.divmod(np.arange(12), 6)
    lines = sight_lines(camera_m(np.array([2.25, 2.75])), marks_m(), frame, mark, Refraction())
    to = np.array([one["to"] for one in page["frames"]])
    assert_close("direction on a page", to.reshape(-1, 3), lines.direction)


def test_where_to_click_next_is_not_known_of_a_flight_without_a_solution(tmp_path: Path) -> None:
    toml = TOML.replace("[landmarks]", 'video = "a.mp4"\ntracked = "t.csv"\n[landmarks]')
    project = write_project(tmp_path, toml)
    assert {*range(5)} <= {int(one["name"]) for one in picked(project)["frames"]}


def test_photographs_of_a_camera_that_stands_are_predicted_one_by_one(tmp_path: Path) -> None:
    """All are one frame to the solve; and of another size than the lens they are not predicted."""
    toml = TOML.partition("[track]")[0].replace("frame_rate_hz = 10.0\n", "")
    toml = toml.replace("first_frame_t_s = 2.0\n", 'video = "photos"\n')
    toml += '[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\nsigma_m = "exact"\n'
    toml += 'height = "ellipsoid"\n[solve]\nframes = "one"\n'
    project = write_project(tmp_path, toml.replace("picks.csv", "clicks.csv"))
    Path("photos").mkdir()
    for k in (0, 3):
        Image.new("L", (1920, 1080)).save(Path("photos", f"{k}.png"))
    first, second = (np.array(one["to"]) for one in picked(project)["frames"])
    assert first.shape == (6, 3) and np.array_equal(first, second)
    Image.new("L", (1280, 720)).save(Path("photos", "0.png"))
    assert "to" not in picked(project)["frames"][0]


def test_what_is_no_pick_in_the_picks_of_a_project_is_told(tmp_path: Path) -> None:
    picks = '[picks]\nfile = "picks.csv"\npixel_grid = "centre"'
    assert picks in TOML
    toml = TOML.replace(picks, '[picks]\nfile = "a.json"\nvideo = "a_1.png"')
    project = write_project(tmp_path, toml)
    Image.new("L", (1920, 1080)).save("a_1.png")
    shapes = [
        {"label": "mast", "points": [[9.5, 9.5]], "shape_type": "point"},
        {"label": "road", "points": [[1.0, 2.0], [3.0, 4.0]], "shape_type": "line"},
    ]
    labels = {"imagePath": "a_1.png", "imageWidth": 1920, "imageHeight": 1080, "shapes": shapes}
    Path("a.json").write_text(json.dumps(labels))
    assert [one["landmark"] for one in picked(project)["picks"]] == ["mast"]


def test_the_folder_of_a_project_is_the_project(tmp_path: Path) -> None:
    """With images in it, it is a folder of images."""
    write_project(tmp_path, TOML.replace("[landmarks]", 'video = "a.mp4"\n[landmarks]'))
    Path("picks.csv").unlink()
    assert len(picked(".")["landmarks"]) == 6
    Image.new("RGB", (8, 6)).save("one.png")
    assert [one["name"] for one in picked(".")["frames"]] == ["one.png"]


def test_a_folder_above_has_its_own_name_as_title(tmp_path: Path) -> None:
    (tmp_path / "shots" / "page").mkdir(parents=True)
    Image.new("RGB", (8, 6)).save("shots/one.png")
    os.chdir("shots/page")
    assert vopd("pick", "..", "-o", "p.html").status == 0
    assert "<h1>shots</h1>" in Path("p.html").read_text(encoding="utf-8")


def test_a_new_project_of_images_is_picked_in() -> None:
    """Its landmarks have the names that the project's columns give them; it predicts."""
    Path("photographs").mkdir()
    Image.new("L", (64, 48)).save(Path("photographs", "a.png"))
    Path("lm.csv").write_text("mast,47,8,400\npond,47.001,8,400\n")
    given = "--landmarks lm.csv --columns landmarks:landmark,lat_deg,lon_deg,h_m --height same "
    given += "--position 46.999,8,450 --lens 60,60,31.5,23.5 --pixel-grid centre "
    given += "--image-size 64x48 --sigma-landmarks .1 --sigma-position .1"
    for way in ("--images photographs", "--set picks.video=../photographs --set picks.file=c.csv"):
        assert vopd("new", "mine", *given.split(), *way.split()).status == 0
        done = vopd("pick", "mine", "-o", "p.html")
        assert done.status == 0, done.stderr
        assert data()["sighted"] == ["mast", "pond"]
        assert data()["landmarks"] == ["mast", "pond"]
        Path("mine", "flight.toml").unlink()


def test_images_of_a_folder() -> None:
    Path("photographs").mkdir()
    for name in ("b.png", "a.png"):
        Image.fromarray(np.zeros((4, 6, 3), np.uint8)).save(Path("photographs", name))
    picked("photographs")


def test_a_pixel_of_a_scanned_film_in_inches_of_the_reader() -> None:
    """At 2540 dpi a pixel is .01 mm on the film; .713816400205 mm are an inch on the reader."""
    Image.new("L", (8, 6)).save("1.png")
    deck = str(DECKS / "appendix_h/case1.dat")
    given = picked("1.png", "--cards", deck, "--dpi", "2540")
    assert_close("inch of the reader", given["deck"]["inch"], 0.01 / 0.713816400205)
    Path("again").mkdir()
    Path("1.png").rename(Path("again", "b_1.png"))
    Image.new("L", (8, 6)).save(Path("again", "a_1.png"))
    done = vopd("pick", "again", "-o", "q.html", "--cards", deck, "--dpi", "2540")
    assert done.status == 1 and not Path("q.html").exists()
    assert_approved(done.stderr)
    for number, status in ((9999, 0), (10000, 1)):  # a card has four columns for it
        Image.new("L", (8, 6)).save(f"{number}.png")
        done = vopd("pick", f"{number}.png", "-o", "n.html", "--cards", deck, "--dpi", "2540")
        assert (done.status, f"{number}.png: name each" in done.stderr) == (status, bool(status))


@pytest.mark.parametrize(
    ("chapters", "chosen"), [(["a"], [2, 5, 7]), (["a"], [7]), (["a"], [0]), ([], [2, 7])]
)
def test_a_frame_that_cannot_be_read_is_said_with_those_before_it(
    chapters: list[str], chosen: list[int]
) -> None:
    """The last one; of a video, whose end may be missing, but not of images or the first frame."""

    def pictures(which: list[int]) -> list[Any]:
        if which == chosen[-1:]:
            raise VopdError("no picture.")
        return [Image.new("L", (8, 6))]

    frames: Any = SimpleNamespace(
        pictures=pictures, chapters=chapters, source="a.mp4", label=str, time_s=np.zeros(8),
        jpeg=lambda k: None,
    )  # fmt: skip
    with refused(VopdError):
        pick_page(frames, chosen, PageContent())


def test_wrong_usage(tmp_path: Path) -> None:
    write_project(tmp_path, TOML)
    deck = (DECKS / "appendix_h/case1.dat").read_text()
    Path("film.dat").write_text(deck)
    Path("short.dat").write_text("\n".join(deck.splitlines()[:28]))
    Path("head.dat").write_text("\n".join(deck.splitlines()[:30]))
    Image.new("L", (8, 6)).save("x.png")
    Path("only").mkdir()
    write_project(tmp_path / "only", TOML)
    control = {"id": "a", "observations": [{"shot_id": "1.png", "projection": [0.1, 0.2]}]}
    Path("gcp.json").write_text(json.dumps({"points": [control]}))
    Path("many").mkdir()
    for k in range(61):
        Path("many", f"{k}.png").touch()
    for arguments in (
        "a.mp4 -o p.txt", "a.mp4", "a.mp4 -o p.html --at 3,x", "a.mp4 -o p.html --at 3,40",
        "flight.toml -o p.html", "flight.toml a.mp4 -o p.html", "only a.mp4 -o p.html",
        "many -o p.html", "none.mp4 -o p.html", "a.mp4 -o p.html --landmarks none.csv",
        "a.mp4 -o p.html --clicks picks.csv", "a.mp4 -o a.mp4/p.html",
        "a.mp4 -o p.html --clicks gcp.json",
        "a.mp4 -o p.html --cards picks.csv", "a.mp4 -o p.html --dpi 9",
        "flight.toml -o p.html --cards x --dpi 9",
        "a.mp4 -o p.html --cards picks.csv --dpi 9", "a.mp4 -o p.html --cards none.dat --dpi 9",
        "x.png -o p.html --cards short.dat --dpi 9", "x.png -o p.html --cards head.dat --dpi 9",
        "x.png -o p.html --cards film.dat --dpi 9",
        "x.png -o p.html --cards head.dat --dpi 9 --landmarks marks.csv",
    ):  # fmt: skip
        done = vopd("pick", *arguments.split())
        assert done.status in (1, 2), arguments
        assert_approved(done.stderr)
    assert not Path("p.html").exists()


def test_damaged_tags_of_an_image_are_no_warning_of_another_package() -> None:
    tags = Image.Exif()
    tags[271] = "camera"
    counted = b"MM\0*\0\0\0\x08"
    damaged = tags.tobytes().replace(counted + b"\0\1", counted + b"\xff\xff")
    assert damaged != tags.tobytes()
    Image.new("L", (40, 30)).save("a.jpg", exif=damaged)
    done = vopd("pick", "a.jpg", "-o", "p.html")
    assert done.status == 0 and len(done.stderr.splitlines()) == 2


def test_an_image_that_is_too_wide_for_a_jpeg_is_named() -> None:
    Image.new("L", (65_501, 1)).save("panorama.png")
    done = vopd("pick", "panorama.png", "-o", "p.html")
    assert done.status == 1 and not Path("p.html").exists()
    assert_approved(done.stderr)
    Image.new("L", (65_500, 1)).save("panorama.png")
    assert vopd("pick", "panorama.png", "-o", "p.html").status == 0
