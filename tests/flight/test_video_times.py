"""Times of a flight's frames by the video that was picked in, and clicks that say their grid."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd as command
from tests.kit.flight_project import TOML, truth_deg, write_project
from tests.kit.video import write_video
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.picks import CLICKS, read_clicks
from vopd.flight.project.new import example_project

RATE = "frame_rate_hz = 10.0\n"
EVEN_MS = [100 * k for k in range(5)]


def test_frames_have_the_times_at_which_they_are_shown(tmp_path: Path) -> None:
    """Frame 0 is 2 s after the epoch; the third interval is twice as long as the others."""
    write_video(tmp_path / "a.mp4", [0, 100, 200, 400, 500])
    project = write_project(tmp_path, TOML.replace(RATE, 'times = "video"\nvideo = "a.mp4"\n'))
    assert_close("presentation time", vopd.solve_flight(project).time_s, [2.0, 2.1, 2.2, 2.4, 2.5])


def test_a_frame_rate_that_is_the_video_s_own(tmp_path: Path) -> None:
    write_video(tmp_path / "a.mp4", EVEN_MS)
    project = write_project(tmp_path, TOML.replace(RATE, RATE + 'video = "a.mp4"\n'))
    found = vopd.solve_flight(project)
    assert_close("flight angle", found.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert not [one for one in found.about if "a.mp4" in one]  # the times are the rate's


def test_the_rate_of_a_followed_video_is_that_of_all_its_frames(tmp_path: Path) -> None:
    """`vopd track` reads all of it: `vopd check` must not look at the clicked frames alone.

    Eleven frames are 100 ms apart, the first five are picked, and the twelfth is 200 ms late.
    """
    write_video(tmp_path / "a.mp4", [*range(0, 1100, 100), 1300])
    keys = RATE + 'video = "a.mp4"\n'
    vopd.solve_flight(write_project(tmp_path, TOML.replace(RATE, keys)))
    project = write_project(tmp_path, TOML.replace(RATE, keys + 'tracked = "tracked.csv"\n'))
    with refused(VopdError):
        vopd.solve_flight(project)


def test_a_frame_rate_without_a_decoder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Clicks are solved by the rate, which is not compared with the video, and that is said."""
    write_video(tmp_path / "a.mp4", EVEN_MS)
    project = write_project(tmp_path, TOML.replace(RATE, RATE + 'video = "a.mp4"\n'))
    monkeypatch.setitem(sys.modules, "av", None)
    monkeypatch.setenv("PATH", str(tmp_path))
    flight = vopd.solve_flight(project)
    assert_close("presentation time", flight.time_s, [2.0, 2.1, 2.2, 2.3, 2.4])
    assert_approved([one for one in flight.about if "a.mp4" in one])


def test_a_frame_rate_beside_a_video_that_is_cut_off(tmp_path: Path) -> None:
    """Its last frames have any times: the rate is not compared with them, and that is said."""
    content = example_project().contents["flight.mp4"]
    (tmp_path / "a.mp4").write_bytes(content[: len(content) // 2])
    project = write_project(tmp_path, TOML.replace(RATE, RATE + 'video = "a.mp4"\n'))
    flight = vopd.solve_flight(project)
    assert_close("presentation time", flight.time_s, [2.0, 2.1, 2.2, 2.3, 2.4])
    assert_approved([one for one in flight.about if "a.mp4" in one])
    content = (tmp_path / "picks.csv").read_text(encoding="utf-8")
    (tmp_path / "picks.csv").write_text(content.replace("\n4,", "\n40,"), encoding="utf-8")
    with refused():
        vopd.solve_flight(project)


@pytest.mark.parametrize(
    ("shown_ms", "keys"),
    [
        ([300 * k for k in range(5)], RATE + 'video = "a.mp4"'),
        (EVEN_MS[:4], 'times = "video"\nvideo = "a.mp4"'),
        (EVEN_MS, 'times = "video"'),
        (EVEN_MS, 'times = "video"\nvideo = "b.mp4"'),
        (EVEN_MS, 'times = "video"\nvideo = "."'),
    ],
)
def test_videos_that_are_not_of_the_picks(tmp_path: Path, shown_ms: list[int], keys: str) -> None:
    write_video(tmp_path / "a.mp4", shown_ms)
    project = write_project(tmp_path, TOML.replace(RATE, keys + "\n"))
    with refused(VopdError):
        vopd.solve_flight(project)


def test_an_adjusted_project_goes_on_with_the_video(tmp_path: Path) -> None:
    """Its folder is another one: the video is named from there, and the word stays."""
    write_video(tmp_path / "a.mp4", EVEN_MS)
    toml = TOML.replace(RATE, 'times = "video"\nvideo = "a.mp4"\n')
    project = Path(write_project(tmp_path, toml))
    new = tmp_path / "new"
    assert command("adjust", project, "--free", "focal", "-o", new).status == 0
    text = (new / "flight.toml").read_text()
    assert 'times = "video"' in text and 'video = "../a.mp4"' in text
    found = vopd.solve_flight(new / "flight.toml").time_s
    assert_close("presentation time", found, vopd.solve_flight(project).time_s)
    (tmp_path / "a.mp4").unlink()
    write_video(tmp_path / "a.mp4", [2 * ms for ms in EVEN_MS])  # and the frames have other times
    with refused(VopdError):
        vopd.solve_flight(new / "flight.toml")


def test_saved_clicks_need_no_grid(tmp_path: Path) -> None:
    text = f"{CLICKS}\nframe,landmark,u_px,v_px\n7,mast,10.25,3\n"
    assert read_clicks(InputFile("a.csv", Path(), text)) == [("7", "mast", 10.25, 3.0)]
    project = Path(write_project(tmp_path, TOML.replace('pixel_grid = "centre"\nframe', "frame")))
    with refused(VopdError):
        vopd.solve_flight(project)
    picks = project.parent / "picks.csv"
    picks.write_text(f"{CLICKS}\n{picks.read_text()}")
    assert vopd.solve_flight(project).solved.all()
    with refused(VopdError):
        read_clicks(InputFile("a.csv", Path(), text.partition("\n")[2]))
    assert_approved(CLICKS)
