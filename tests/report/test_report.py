"""The report's page, read as text: what is in it, and what must not be."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import shutil
import sys
from dataclasses import replace
from functools import cache
from html import unescape
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urljoin

import numpy as np
import pytest

import vopd.report as report_module
import vopd.report.frames as frames_module
from tests.approved.texts import assert_approved, refused
from tests.kit.clicked_flights import clicked_flight
from tests.kit.command import DECKS, vopd
from tests.kit.flight_project import TOML, uneven_flight, write_project
from tests.kit.histories import about, by_hand, flight, histories, table_text
from tests.kit.html_page import Page, frame_columns
from tests.kit.video import write_video
from tests.tolerances import assert_close
from vopd.attitude.flags import MEANING
from vopd.attitude.history import History, history
from vopd.attitude.included import one_turn_texts
from vopd.attitude.long_history import with_about
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import column_name
from vopd.errata import fixes
from vopd.figures.patches import has_patches
from vopd.findings import VopdError
from vopd.flight.result import solve_flight_read
from vopd.pipeline import read_deck, run
from vopd.report import COLUMNS, batch_page, embedded_figures, pick, report, style_and_script
from vopd.report.answer import angle_table
from vopd.report.frames import SHOWN, frames_json, undrawn

CASE_4 = DECKS / "appendix_h" / "case4.dat"
pytestmark = pytest.mark.usefixtures("not_laid_out")


@cache
def page_with_figures() -> tuple[bytes, Page]:
    """The page of case 4, made once."""
    made = report(histories("appendix_h/case4"))
    return made, Page(made.decode())


def shown(history: History) -> list[str]:
    """The columns of the table of frames."""
    return [column_name(one, history.estimate) for one in SHOWN]


def page(made: list[History], *rest: Any) -> tuple[str, Page]:
    text = report(made, *rest).decode()
    return text, Page(text)


@pytest.mark.usefixtures("no_figures")
def test_every_cell_is_the_csv_s() -> None:
    made = [*histories("appendix_h/case4", "appendix_h/cases_1_2_3"), *flight()]
    content, found = page(made)
    text, columns = table_text(made), frame_columns(content)
    names = ["deck", *shown(made[0])]
    assert found.tables["frames-table"] == [names]  # its rows are made by the script
    assert list(columns)[: len(names)] == names
    for name, texts in columns.items():
        assert texts == text[name], name


@pytest.mark.usefixtures("no_figures")
def test_one_deck_needs_no_column_for_it() -> None:
    made = histories("appendix_h/case4")
    _, found = page(made)
    assert found.tables["frames-table"][0] == shown(made[0])


@pytest.mark.usefixtures("no_figures")
def test_landmarks_of_several_decks_name_theirs() -> None:
    _, found = page(histories("appendix_h/case2", "appendix_h/case4"))
    head, *rows = found.tables["landmarks-table"]
    assert head[:4] == ["landmark", "deck", "job", "frames"]
    decks = [(row[1], row[0]) for row in rows]
    assert decks == [("appendix_h/case2.dat", n) for n in ("65", "66", "67")] + [
        ("appendix_h/case4.dat", n) for n in ("28", "62", "69")
    ]


@pytest.mark.usefixtures("no_figures")
def test_every_column_is_explained() -> None:
    made = histories("appendix_h/case4")
    text, _ = page(made)
    explained = re.findall(r"<dt>(\w+)</dt><dd>[^<]+</dd>", text.split("What the columns are")[1])
    assert explained[: len(SHOWN)] == shown(made[0])


@pytest.mark.usefixtures("no_figures")
def test_a_deck_that_failed_is_told_first() -> None:
    made = histories("appendix_h/case4")
    assert "A deck failed" not in page(made, ["a warning"])[0]
    text, _ = page(made, ["x.dat: No such file"], None, True)
    assert "A deck failed" in text.split("<main>")[0] and "x.dat: No such file" in text


@pytest.mark.usefixtures("no_figures")
def test_where_nothing_is_known_it_says_so() -> None:
    """A frame whose residuals vanish has no sigmas."""
    text, _ = page(histories("regression/vanished"))
    assert "unknown" in Page(text).tables["angles-table"][1]
    assert "; 1 frame</dd>" in text


@pytest.mark.usefixtures("no_figures")
def test_how_sure_an_attitude_is_whose_yaw_and_roll_are_not() -> None:
    """The camera of case 4 looks down, that of case 1 does not."""
    made = histories("appendix_h/case4")
    (told,) = one_turn_texts(made)
    assert f"<p>{told}.</p>" in page(made)[0].partition('<section id="frames">')[0]
    assert not one_turn_texts(histories("appendix_h/case1"))


@pytest.mark.usefixtures("no_figures")
def test_the_flags_are_explained_and_counted() -> None:
    _, found = page(list(flight()))
    head, *rows = found.tables["flags-table"]
    assert [row[0] for row in rows] == list(MEANING)
    counts = {row[0]: int(row[1]) for row in rows}
    assert counts["outlier"] == 1 and counts["jump"] == 0
    assert head == ["flag", "frames", "meaning", "what to do"]


@pytest.mark.usefixtures("no_figures")
def test_the_summary_counts_misfits_and_effects_of_errata() -> None:
    """Landmark 3 of frame 5 is misread; the effect of errata is 2 degrees in two frames."""
    (one,) = flight()
    effect = np.full((30, 9), 1e-6)
    effect[10, 4] = effect[20, 2] = effect[21, 2] = 2.0
    text, _ = page([history(replace(one.estimate, slip_effect_deg=effect))])
    said = dict(re.findall(r"<dt>([^<]+)</dt><dd>([^<]+)</dd>", text))
    count, told = said["Frames that misfit"].split("; ")
    frame = one.estimate.frame[4]
    label = one.estimate.landmark_label(one.estimate.landmark[4, 2])
    assert count == "1" and told.startswith(f"frame {frame}: without {label} (chance ")
    most = said["Errata of the original program"]
    assert "by up to 2 degree" in most and "in 3 of 30 frames" in most
    assert "Errata of the original program" not in page([one])[0]


@pytest.mark.usefixtures("no_figures")
def test_landmarks_by_hand() -> None:
    """Case 4: landmarks 28 and 62 in two frames, a third frame ignored; golden residuals."""
    _, found = page(histories("appendix_h/case4"))
    _, first, second, third = found.tables["landmarks-table"]
    x, y = np.array([0.00888, 0.01133]) * 1e3, np.array([0.02759, 0.03565]) * 1e3
    assert first[:4] == ["28", "1", "2", "0"] and second[0] == "62"
    assert third == ["69", "1", "0", "2", *[""] * 6, "0"]
    expected = [x.mean(), y.mean(), np.sqrt((x**2).mean()), np.sqrt((y**2).mean())]
    expected.append(np.hypot(x[1], y[1]))
    assert_close("reported residual", np.array(first[4:9], float), expected)
    assert first[9:] == ["65", "0"]


def test_it_loads_nothing_and_every_id_is_its_own() -> None:
    made, found = page_with_figures()
    text = unescape(made.decode())
    assert len(found.ids) == len(set(found.ids)) and found.scripts == 1
    for load in found.loads:
        assert load.startswith(("#", "data:")), load
        assert not load.startswith("#") or load[1:] in found.ids
    without_figures = re.sub(r"base64,[A-Za-z0-9+/=]+", "", text)
    assert set(re.findall(r"https?://[^\"]*", without_figures)) == {"http://www.w3.org/2000/svg"}
    assert "default-src 'none'" in text and "unsafe-inline" not in text


@pytest.mark.usefixtures("no_figures")
def test_the_same_page_twice() -> None:
    """That the figures are the same is tested where they are drawn."""
    first, again = (report(histories("appendix_h/case4")) for _ in range(2))
    assert first == again


@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize("where", ["source", "title", "message"])
def test_hostile_names_stay_text(where: str) -> None:
    bad = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\"'{{style}}{% raw %}"
    (one,) = histories("appendix_h/case4")
    messages = [bad] if where == "message" else []
    if where != "message":
        one = about(one, **{where: bad})
    text, found = page([one], messages)
    assert found.scripts == 1 and "<script>alert" not in text and "onerror=alert(2)>&" not in text
    assert "{{style}}" in text  # as it was given, not filled in


@pytest.mark.usefixtures("no_figures")
def test_control_characters_are_written_as_escapes() -> None:
    """HTML has none but tabs and ends of lines; others turn the text that follows around."""
    (one,) = histories("appendix_h/case4")
    turning = "\u202e\u2066"
    control = "".join(map(chr, (*range(9), 11, 12, *range(14, 32), *range(127, 160)))) + turning
    text, _ = page([about(one, source=f"a{control}b\t")], [f"c{control}d\n"])
    assert not {*control} & {*text} and "\t" in text
    escaped = "".join(f"\\x{ord(c):02x}" for c in control[: -len(turning)]) + r"\u202e\u2066"
    assert f"a{escaped}b\t" in text and f"c{escaped}d\n" in text


@pytest.mark.usefixtures("no_figures")
def test_messages_sigmas_and_rate_are_said() -> None:
    sigmas = Sigmas(reading=0.004, position=120.0, focal_length=0.02, time_s=0.3)
    made = histories("appendix_h/case4", sigmas=sigmas)
    text, _ = page(made, ["deck x: card 3: odd"], 45.0)
    for said in ("deck x: card 3: odd", "120 ft", "0.02 mm", "0.3 s", "45 degrees a second"):
        assert said in text
    assert "as given" in text and "by its three readings" not in text


@pytest.mark.usefixtures("no_figures")
def test_fixes_in_force_are_first() -> None:
    text, _ = page(run(read_deck(CASE_4), fixes("earth")).histories())
    before, after = text.split("Corrected run, not the original")
    assert "earth (WGS 84)" in after[:200] and "<main>" not in before


@pytest.mark.usefixtures("no_figures")
def test_without_matplotlib_the_rest_is_there() -> None:
    text, found = page(histories("appendix_h/case4"))
    assert "pip install matplotlib" in text and "frames-table" in found.tables


@pytest.mark.usefixtures("no_figures")
def test_the_command(tmp_path: Path) -> None:
    out = tmp_path / "r.html"
    assert vopd("report", CASE_4, "-o", out).status == 0
    assert "frames-table" in Page(out.read_text()).tables
    assert vopd("report", CASE_4, "-o", "-", "--strict").status == 3
    wind = DECKS / "regression" / "wind_out_of_order.dat"
    assert vopd("report", wind, CASE_4, "-q", "-o", out).status == 1
    text = out.read_text()
    assert "altitudes out of order at position 2" in text and "A deck failed" in text


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (["appendix_h/case4.dat", "-o", "r.pdf"], 2),
        (["appendix_h/case4.dat", "-o", "no/such/r.html"], 1),
        (["appendix_h/case4.dat", "-o", "r.html", "--time-sigma", "-1"], 2),
        (["regression/lens_out_of_order.dat", "-o", "r.html"], 1),
        (["none.dat", "-o", "r.html"], 1),
    ],
)
def test_mistakes_leave_no_file(
    arguments: list[str], status: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = vopd("report", DECKS / arguments[0], *arguments[1:])
    assert result.status == status
    assert_approved(result.stderr)
    assert list(tmp_path.iterdir()) == []


def test_without_jinja2(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    result = vopd("report", CASE_4, "-o", tmp_path / "r.html")
    assert result.status == 1 and "pip install jinja2" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_many_jobs_have_a_table_and_few_have_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the figures of many jobs show is not looked at here, so that none is drawn."""
    (one,) = histories("appendix_h/case4")
    made = [with_about(one, one.about._replace(job=k + 1)) for k in range(22)]
    with monkeypatch.context() as patch:
        figures = sys.modules["vopd.report"]
        patch.setattr(figures, "draw", lambda *_, **__: None)
        patch.setattr(figures, "svg", lambda _: "<svg/>")
        text, found = page(made)
    head, *rows = found.tables["jobs-table"]
    assert head[:5] == ["job", "title", "frames", "attitudes", "not_converged"]
    assert [row[0] for row in rows] == [str(k + 1) for k in range(22)]
    assert rows[0][2:4] == [str(len(one.status)), str(int(one.has_attitude.sum()))]
    assert "The figure shows 20 of 22 jobs" in text and "--job N" in text
    single, found = page_with_figures()
    assert "jobs-table" not in found.tables and b"The figure shows" not in single


# The page itself

ROOM = Path(report_module.__file__).parent


@pytest.mark.usefixtures("no_figures")
def test_what_utf_8_cannot_write_is_a_question_mark() -> None:
    made = report([by_hand(said={"source": "\u00e9 \u00b5 \udcff"})])
    assert b"<h1>Attitude report</h1>\n<p>\xc3\xa9 \xc2\xb5 ?</p>" in made


@pytest.mark.usefixtures("no_figures")
def test_histories_without_any_attitude() -> None:
    """Are refused; beside one that has some, they are not."""
    none = by_hand(vehicle_deg=np.full((3, 3), np.nan))
    with refused(VopdError):
        report([none])
    assert report([none, by_hand()]).startswith(b"<!DOCTYPE html>")


def test_what_the_page_may_load() -> None:
    """Its own style and script by their SHA-256, embedded images, and nothing else."""
    values = style_and_script()
    allowed = {}
    for name in ("page.css", "page.js"):
        digest = hashlib.sha256((ROOM / name).read_bytes()).digest()
        allowed[name] = f"'sha256-{base64.b64encode(digest).decode()}'"
    assert values == {
        "style": (ROOM / "page.css").read_text(encoding="utf-8"),
        "script": (ROOM / "page.js").read_text(encoding="utf-8"),
        "policy": (
            f"default-src 'none'; img-src data:; style-src {allowed['page.css']}; "
            f"script-src {allowed['page.js']}; base-uri 'none'; form-action 'none'"
        ),
    }


def test_a_page_is_small() -> None:
    """With 600 frames of six landmarks, scenes and figures; script and style by themselves."""
    assert len(report(list(flight(600)))) < 1_500_000
    assert sum(len(style_and_script()[one]) for one in ("style", "script")) < 60_000


# The page of a batch

ADDRESSES = {  # a file beside the page, as an address that no browser takes for another place
    "one.html": "./one.html",
    "a b/one#1.html": "./a%20b/one%231.html",
    "what?.html": "./what%3F.html",
    "C:one.html": "./C%3Aone.html",
    "http://x.html": "./http%3A//x.html",
    "//x/one.html": ".///x/one.html",
    "50 %.html": "./50%20%25.html",
    "flüge.html": "./fl%C3%BCge.html",
    "\udcff.html": "./%FF.html",  # a byte that is no text, as the file system gives it
}


@pytest.mark.parametrize("file", ADDRESSES)
def test_the_address_of_a_report(file: str) -> None:
    page = Page(batch_page([(file, ["one"]), (None, ["two"])], "", 0).decode("utf-8"))
    (address,) = (one for one in page.loads if not one.startswith("data:"))
    assert address == ADDRESSES[file]
    assert urljoin("file:///batch/index.html", address).startswith("file:///batch/")
    if not file.startswith("//"):
        assert unquote(address, errors="surrogateescape") == f"./{file}"


SOURCES: list[tuple[str | None, list[object]]] = [
    (None, ["lost", "failed", 0, 0, 0, 0, 0, "", "<b>no such file</b>"]),
    ("a&b.html", ["a&b", "not converged", 30, 29, 1, 9, 2, "misfit:9", ""]),
    ("two", ["two", "solved", 4, 4, 0, 10, 0, "outlier:10", ""]),
]


@pytest.mark.parametrize("failed", [0, 1, 2])
def test_the_page_of_a_batch(failed: int) -> None:
    """Every cell is text, in the order given; how many failed is said where any did."""
    text = batch_page(SOURCES, "3 sources: 1 failed & 2 <done>", failed).decode()
    found = Page(text)
    (table,) = found.tables.values()
    assert table[0] == [name for name, _, _ in COLUMNS]
    assert table[1:] == [[str(cell) for cell in cells] for _, cells in SOURCES]
    assert [one for one in found.loads if not one.startswith("data:")] == ["./a%26b.html", "./two"]
    assert "<p>3 sources: 1 failed &amp; 2 &lt;done&gt;</p>" in text
    assert (f"<strong>{failed} of 3 sources failed.</strong>" in text) == (failed > 0)
    assert ("failed.</strong>" in text) == (failed > 0)
    assert "<title>Batch of 3 sources</title>" in text


def test_a_flight_without_velocity_has_no_angles_of_attack() -> None:
    (one,) = flight()
    known = replace(one.estimate, attack_deg=np.full_like(one.estimate.attack_deg, np.nan))
    names = {row[0] for row in angle_table([history(known)])[1]}
    assert names == {row[0] for row in angle_table([one])[1]} - {"alpha", "beta", "eta"}


def test_angles_that_frames_lack_are_not_those_of_unknown_uncertainty() -> None:
    """As of the frames beyond a track, which have no velocity."""
    (one,) = flight()
    attack_deg = one.estimate.attack_deg.copy()
    attack_deg[0] = np.nan
    made = history(replace(one.estimate, attack_deg=attack_deg))
    widths = {row[0]: row[-1] for row in angle_table([made])[1]}
    assert "alpha" in widths and not any("unknown" in one for one in widths.values())


def test_a_page_without_the_video_of_its_clicks_has_the_other_figures(tmp_path: Path) -> None:
    one = clicked_flight(np.random.default_rng(3), 8, 4, every=4, reach=5).flight
    gone = replace(one, video=(tmp_path / "gone.mp4",), folder=tmp_path)
    (history,) = [solve_flight_read(gone).history()]
    assert has_patches([history])
    assert [figure.name for figure in embedded_figures([history])] == ["residuals"]


@pytest.mark.usefixtures("no_figures")
def test_photographs_that_are_missing_are_named(tmp_path: Path) -> None:
    """On the page and on standard error: which one, where it was looked for, what to do."""
    shutil.copytree(DECKS.parent / "examples" / "summits", tmp_path / "post")
    project, page = tmp_path / "post" / "flight.toml", tmp_path / "r.html"
    said = []
    for video in ("", 'video = "../gone/photographs"\n'):
        text = project.read_text().replace("[picks]\n", "[picks]\n" + video)
        project.write_text(text)
        ran = vopd("report", project, "-o", page, "--photographs")
        assert ran.status == 0
        (line,) = [one for one in ran.stderr.splitlines() if "photograph:" in one]
        assert unescape(page.read_text()).count(line) == 1
        said.append(line)
        assert (
            "photograph:" not in vopd("report", project, "-o", page, "-q", "--photographs").stderr
        )
    assert_approved(said)


@pytest.mark.usefixtures("no_figures")
def test_frames_of_a_video_that_cannot_be_shown_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_video(tmp_path / "flight.mp4", range(0, 500, 100))
    named = TOML.replace("[picks]\n", '[picks]\nvideo = "flight.mp4"\n')
    project = write_project(tmp_path, named)
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    ran = vopd("report", project, "-o", tmp_path / "r.html", "--photographs")
    assert ran.status == 0
    assert_approved(ran.stderr)


def drawn_of(*together: History) -> list[set[str]]:
    """What a page has of each job besides its table."""
    return [set(one) for one in json.loads(frames_json(together))["jobs"]]


def test_a_frame_without_a_position_costs_the_plan_of_the_others_nothing() -> None:
    flight = uneven_flight([4, 4, 4, 4])
    places = flight.path.position_m.copy()
    places[1] = np.nan
    made = solve_flight_read(replace(flight, path=replace(flight.path, position_m=places)))
    (job,) = json.loads(frames_json([made.history()]))["jobs"]
    for axis in job["camera"].values():
        assert [one is None for one in axis] == [False, True, False, False]
    assert not any(None in axis for axis in job["places"].values())


def test_what_a_page_draws_is_decided_by_all_of_its_jobs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a flight, twice: as many picks, frames and places as both have, and one fewer."""
    (one,) = flight()
    picks, frames = int(one.landmarks.sum()), len(one.status)
    (every,) = drawn_of(one)
    (job,) = json.loads(frames_json([one]))["jobs"]
    others = len(job["others"]["landmark"])
    for name, most, gone in (
        ("MOST_PICKS", 2 * picks, "picks"), ("MOST_FOOTPRINTS", 2 * frames, "horizon"),
        ("MOST_OTHERS", 2 * (others - 1), "others"),  # by the commas between them
    ):  # fmt: skip
        with monkeypatch.context() as patch:
            patch.setattr(frames_module, name, most)
            assert drawn_of(one, one) == [every] * 2 and not undrawn([one, one])
            patch.setattr(frames_module, name, most - 1)
            assert drawn_of(one) == [every] and not undrawn([one])
            assert all(gone in every - fewer for fewer in drawn_of(one, one))
            said = undrawn([one, one])
            assert bool(said) == (gone == "picks")
        if said:
            assert_approved(said)


def test_the_limits_of_pages() -> None:
    """Of reports, in picks, places and frames; of pages of picks, in bytes and pixels."""
    limits = {frames_module: ("MOST_PICKS", "MOST_OTHERS", "MOST_FOOTPRINTS", "FAR_M", "FAR_PX")}
    limits[report_module] = ("PHONE_IN", "MOST_PX", "QUALITY", "MOST_SHOWN")
    limits[pick] = ("QUALITIES", "WANTED_BYTES", "MOST_BYTES", "MOST_SIDE_PX")
    assert_approved([f"{n} {getattr(of, n)}" for of, names in limits.items() for n in names])
