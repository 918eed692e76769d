"""The short table: which digits, which columns, which letters; in the library and a notebook."""

from __future__ import annotations

import html
import re
import shutil
from dataclasses import replace
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.histories import by_hand
from vopd.attitude import summary
from vopd.attitude.history import History
from vopd.attitude.long_history import one_part
from vopd.attitude.summary import columns, flag_letters, frames_of
from vopd.findings import Finding, frames_text
from vopd.screen import aligned, shortened, width, wrapped

ROOT = Path(__file__).parents[2]
HILL = ROOT / "examples" / "hill"
CASE_1 = ROOT / "decks" / "appendix_h" / "case1.dat"


def test_results_show_themselves_in_print_and_in_a_notebook() -> None:
    flight = vopd.solve_flight(HILL)
    assert str(flight) == flight.summary(80) and max(map(len, str(flight).splitlines())) <= 80
    assert repr(flight) == f"FlightResult({HILL / 'flight.toml'}, 5 frames)"
    page = flight._repr_html_()
    assert page.count("<tr>") == 6 and "-11.9974" in page
    assert flight.history()._repr_html_().count("<tr>") == 6
    run = vopd.run(ROOT / "decks" / "appendix_h" / "case2.dat")
    assert run._repr_html_().count("<tr>") == 2 and "card 59" in run._repr_html_()


def test_a_notebook_has_what_print_has() -> None:
    """What yaw is on a map's grid, what the sigmas include, what is doubtful, and warnings."""
    history = vopd.solve_flight(HILL).history().take(np.array([0, 1]))
    about = history.estimate.about
    words = replace(about.words, conventions={"grid azimuth": "true azimuth less 1 degree"})
    estimate = replace(history.estimate, about=about._replace(words=words))
    one = one_part(replace(history, estimate=estimate))
    said = re.findall("<p>(.*?)</p>", html.unescape(summary.html([one], [Finding("odd")])))
    printed = " ".join(summary.text([one], 80, ["odd"]).split())
    assert len(said) == 6 and "less 1 degree" in said[1]
    for paragraph in said:
        assert paragraph.removeprefix("not in it: ").removeprefix("warning: ") in printed


def at(history: History, latitude: float, longitude: float, **more: Any) -> str:
    """Where a flight begins, which is at another place and time."""
    one = history.estimate
    place = replace(one.position, latitude_deg=np.array([np.nan, latitude]),
                    longitude_deg=np.array([np.nan, longitude]))  # fmt: skip
    about = one.about._replace(epoch=more.pop("epoch", one.about.epoch))
    return summary.where_text([replace(one, position=place, about=about, **more)])


def test_where_and_when_a_flight_begins() -> None:
    """At its first position: south and west by their letters; a time without a date is none."""
    history = vopd.solve_flight(HILL).history().take(np.array([0, 1]))
    assert_approved(at(history, -33.856784, -151.21529))
    # .6 s after the zone's 23:59:59.5 is the next day, 13:30 earlier by UTC
    zone = timezone(timedelta(hours=13, minutes=30))
    moment = datetime(2025, 12, 31, 23, 59, 59, 500_000, zone)
    assert_approved(at(history, 0.0, 180.0, epoch=moment, time_s=np.array([0.0, 0.6])))
    for time_s in (np.nan, 1e12):
        told = at(history, 0.0, 0.0, time_s=np.array([0.0, time_s]), frame_names=["a", "b.jpg"])
        assert_approved(told)
    assert at(history, np.nan, np.nan) == ""
    (deck,) = vopd.run(CASE_1).histories()
    assert summary.where_text([deck.estimate]) == ""
    begins = summary.where_text([deck.estimate, history.estimate])
    assert begins == summary.where_text([history.estimate]) != ""


def test_where_no_frame_has_an_attitude_that_is_said() -> None:
    lost = one_part(
        by_hand(2, angles_deg=np.full((2, 9), np.nan), half_deg=np.full((2, 9), np.nan))
    )
    assert_approved(summary.text([lost], 80))
    assert_approved(re.findall("<p>(.*?)</p>", summary.html([lost])))


def test_on_the_narrowest_screen_angles_come_before_what_is_about_them() -> None:
    """It may be too narrow for these, too."""
    one = one_part(by_hand(2, time_s=np.arange(2.0)))
    for wide in (40, 20):
        assert_approved("\n".join(summary.text([one], wide).splitlines()[:6]))


def test_flagged_frames_of_several_jobs_are_told_with_their_jobs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "tests" / "approved" / "inputs" / "five_jobs.dat", "a.dat")
    shown = str(vopd.run("a.dat")).splitlines()
    assert_approved([line for line in shown if "two_landmarks," in line])


def test_rows_of_several_decks_and_jobs_name_theirs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one deck of three jobs, and of two decks; flags of many frames are counted."""
    monkeypatch.chdir(CASE_1.parent)
    assert_approved("\n".join(str(vopd.run("cases_1_2_3.dat")).splitlines()[:8]))
    both = [vopd.run(f"case{k}.dat").histories()[0] for k in (1, 2)]
    assert_approved("\n".join(summary.text(list(map(one_part, both)), 120).splitlines()[:7]))
    film = one_part(by_hand(40, time_s=np.arange(40.0)))
    odd = film.whole.flags.raised["two_landmarks"].copy()
    odd[::2] = True
    raised = film.whole.flags.raised | {"two_landmarks": odd}
    flags = replace(film.whole.flags, raised=raised)
    flagged = [one_part(replace(film.whole, flags=flags))]
    (line,) = [one for one in summary.doubt_lines(*frames_of(flagged)) if "two_landmarks" in one]
    assert " 20 frames: " in line
    assert f"<p>{html.escape(line)}</p>" in summary.html(flagged, [])


def test_blanks_at_the_ends_of_a_title_are_not_of_it(tmp_path: Path) -> None:
    """A card has them, and so may the name of a flight."""
    project = tmp_path / "flight.toml"
    shutil.copytree(HILL, tmp_path, dirs_exist_ok=True)
    text = project.read_text(encoding="utf-8")
    project.write_text(text.replace('name = "F12"', 'name = "  F12   "'), encoding="utf-8")
    flight, (job, *_) = vopd.solve_flight(project), vopd.read_deck(CASE_1)
    assert flight.summary(200).splitlines()[0].endswith(": 5 frames, F12")
    assert ": 5 frames, F12</p>" in flight._repr_html_()
    run = vopd.run(replace(job, title="  FLIGHT  12  ".ljust(80)))
    assert ": 1 frame, FLIGHT  12</p>" in run._repr_html_()


def test_each_names_the_other_for_what_it_does_not_take() -> None:
    deck, project = ROOT / "decks" / "appendix_h" / "case1.dat", HILL / "flight.toml"
    with pytest.raises(vopd.VopdError, match=re.escape("vopd.solve_flight(")):
        vopd.run(project)
    with pytest.raises(vopd.VopdError, match=re.escape("vopd.run(")):
        vopd.solve_flight(deck)
    with pytest.raises(vopd.VopdError, match=re.escape("vopd.run ")):
        vopd.solve_flight(vopd.read_deck(deck))  # type: ignore[arg-type]
    read = vopd.solve_flight(project)
    assert (vopd.solve_flight(read.read).camera_deg == read.camera_deg).all()


@pytest.mark.parametrize(
    ("frames", "without", "rows", "said"),
    [
        (30, 13, 17, "13 more frames, 13 without an attitude"),
        (60, 13, 20, "40 more frames, 13 without an attitude"),
        (20, 13, 20, ""), (25, 25, 20, "5 more frames"), (25, 0, 20, "5 more frames"),
    ],
)  # fmt: skip
def test_frames_without_an_attitude_have_no_rows_where_rows_are_few(
    frames: int, without: int, rows: int, said: str
) -> None:
    """Each frame has a row while there is room; else those with an attitude have them."""
    history = vopd.solve_flight(HILL).history().take(np.resize(np.arange(5), frames))
    vehicle_deg = history.estimate.vehicle_deg.copy()
    vehicle_deg[:without] = np.nan
    (shown,) = frames_of([one_part(replace(history, estimate=replace(
        history.estimate, vehicle_deg=vehicle_deg, frame=np.arange(100, 100 + frames)
    )))])  # fmt: skip
    told = [one for one in summary.doubt_lines(shown) if one.endswith(" without an attitude")]
    assert told == ([f"{without} frames without an attitude"] if without else [])
    table = columns(shown)
    label = next(one.cells for one in table if one.name in ("frame", "image"))
    first = 100 + without if frames > 20 > without else 100
    assert len(label) == rows and label[0] == str(first)
    assert {len(one.cells) for one in table} == {rows}
    assert shown.more_text == said


@pytest.mark.parametrize(("without", "flagged"), [(1, 39), (1, 38), (0, 40)])
def test_every_frame_is_every_one_with_an_attitude(without: int, flagged: int) -> None:
    film = by_hand(40, time_s=np.arange(40.0))
    vehicle_deg = film.estimate.vehicle_deg.copy()
    vehicle_deg[:without] = np.nan
    estimate = replace(film.estimate, vehicle_deg=vehicle_deg)
    flagged_as = {"two_landmarks": np.arange(40) >= 40 - flagged}
    flags = replace(film.flags, raised=film.flags.raised | flagged_as)
    (shown,) = frames_of([one_part(replace(film, estimate=estimate, flags=flags))])
    every = [", every frame (" in one for one in summary.doubt_lines(shown) if "two_" in one]
    assert every == [flagged + without == 40]


@pytest.mark.parametrize(
    ("details", "told"), [(["", "a", "a", ""], " (a)"), (["", "a", "b", ""], ""), ([""] * 4, "")]
)
def test_a_detail_is_told_that_all_frames_of_a_flag_have(details: list[str], told: str) -> None:
    film = by_hand(4)
    raised = film.flags.raised | {"outlier": np.array([False, True, True, False])}
    flags = replace(film.flags, raised=raised, detail=film.flags.detail | {"outlier": details})
    (shown,) = frames_of([one_part(replace(film, flags=flags))])
    (line,) = [one for one in summary.doubt_lines(shown) if " outlier" in one]
    where = frames_text([film.estimate.frame_label(k) for k in (1, 2)])
    assert f" outlier, {where}{told}: " in line


@pytest.mark.parametrize("known", [1, 2, 3])
def test_a_flag_of_frames_without_an_attitude_is_not_of_every_frame(known: int) -> None:
    """As many have none as have one, or more: they are named, and have its letter."""
    film = by_hand(4)
    vehicle_deg = film.estimate.vehicle_deg.copy()
    vehicle_deg[known:] = np.nan
    estimate = replace(film.estimate, vehicle_deg=vehicle_deg)
    raised = film.flags.raised | {"undetermined": np.arange(4) >= known}
    flags = replace(film.flags, raised=raised)
    (shown,) = frames_of([one_part(replace(film, estimate=estimate, flags=flags))])
    (letter,) = [key for name, key in flag_letters(shown).items() if name == "undetermined"]
    (line,) = [one for one in summary.doubt_lines(shown) if " undetermined" in one]
    where = frames_text([film.estimate.frame_label(k) for k in range(known, 4)])
    assert line.startswith(f"{letter} undetermined, {where}: "), line


def test_wide_characters_take_two_columns() -> None:
    assert (width("東京"), width("e\u0301")) == (4, 1)
    assert aligned([["東京", "1"], ["a", "22"]], {0}) == ["東京   1", "a     22"]
    assert shortened("frame_000001_left.jpg", 12) == "fra...ft.jpg"
    assert width(shortened("写真" * 10, 12)) <= 12


def test_lines_are_broken_at_words() -> None:
    assert wrapped("a bb ccc", 5, "  ") == "a bb\n  ccc"
    assert wrapped("    a bb ccc", 8) == "    a bb\n    ccc"
    assert wrapped("x" * 9, 5) == "x" * 9


def test_angles_are_rounded_within_their_range() -> None:
    """Yaw is 0 to 360, and roll above -180 to 180; a yaw beyond a circle is shown as it is."""
    angles = np.tile([359.9996, -60.0, 180.0004], (3, 3))
    angles[1:, [3, 5]] = [[0.0004, 179.9996], [720.5, 0.0]]
    film = one_part(by_hand(3, angles_deg=angles, half_deg=np.full((3, 9), 0.1)))
    cells = {one.name: one.cells for one in columns(frames_of([film])[0])}
    assert cells["yaw"] == ["0.00", "0.00", "720.50"]
    assert cells["roll"] == ["180.00", "180.00", "0.00"]
