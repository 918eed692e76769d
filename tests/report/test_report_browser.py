"""The report in a browser."""

from __future__ import annotations

import base64
import csv
import io
import json
import re
import shutil
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from PIL import Image
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select, WebDriverWait

from tests.approved.texts import assert_approved
from tests.kit.browser import all_shown, forget, load, styles
from tests.kit.command import ROOT
from tests.kit.histories import by_hand, flight, histories, with_estimate
from tests.kit.html_page import data_of
from tests.kit.renamed_hill import WIDE, renamed
from tests.tolerances import assert_close
from vopd.attitude.history import History
from vopd.export import FORMATS, FileRequest
from vopd.flight.result import solve_flight
from vopd.report import report

HILL = ROOT / "examples" / "hill" / "flight.toml"
pytestmark = pytest.mark.usefixtures("not_laid_out")


@pytest.fixture
def case4(browser: Any, tmp_path: Path) -> Any:
    return load(browser, tmp_path, page_of("case4"))


@pytest.fixture
def film(browser: Any, tmp_path: Path) -> Any:
    """Thirty frames: frame 8 ignored, an outlier in frame 5; without figures."""
    return load(browser, tmp_path, page_of("film"))


@pytest.fixture
def long_film(browser: Any, tmp_path: Path) -> Any:
    """The same with 250 frames."""
    return load(browser, tmp_path, page_of("long film"))


@pytest.fixture
def hill(browser: Any, tmp_path: Path) -> Any:
    """Five frames of a flight, with photographs that are a grey ramp."""
    return load(browser, tmp_path, page_of("hill"))


@cache
def page_of(name: str) -> bytes:
    if name == "case4":
        return report(histories("appendix_h/case4"))
    with pytest.MonkeyPatch.context() as patch:  # the figure takes longer than all the rest
        patch.setitem(sys.modules, "matplotlib.figure", None)
        if name == "hill":
            solved = solve_flight(HILL).history()
            scene = solved.estimate.scene
            assert scene is not None
            grey = Image.linear_gradient("L")

            def photographs(frames: list[tuple[int, str]]) -> Iterator[tuple[int, Any]]:
                return ((k, grey.copy()) for k in range(len(frames)))

            shown = replace(scene(), photographs=photographs)
            return report([with_estimate(solved, scene=lambda: shown)], photographs=True)
        if name == "3000":
            (one,) = flight()
            many = np.arange(3000)
            long = with_estimate(one.take(many % 30), frame=many, time_s=many / 32.0, scene=None)
            return report([long])
        if name == "grid":
            return report([solve_flight(ROOT / "examples" / "summits" / "flight.toml").history()])
        if name == "case1":
            return report(histories("appendix_h/case1"))
        if name == "left out":
            return left_out()
        if name == "odd":
            return report([odd(), by_hand(3, said={"job": 2})], ["a warning"], 5.0)
        return report(flight(250 if name == "long film" else 30))


def left_out() -> bytes:
    """The hill with a check landmark, a pick that does not fit, and two that are not there.

    Its horizon is told to go through the south-east.
    """
    with TemporaryDirectory() as place:
        shutil.copytree(HILL.parent, place, dirs_exist_ok=True)
        project, picks = (Path(place) / name for name in ("flight.toml", "picks.csv"))
        solve = '[solve]\nblunders = "drop"\ncheck_landmarks = ["tower"]\n'
        project.write_text(project.read_text() + solve)
        head, first, *rows = picks.read_text().splitlines()
        frame, name, u, *rest = first.split(",")
        wrong = ",".join([frame, name, str(float(u) + 200.0), *rest])
        picks.write_text("\n".join([head, wrong, *rows[:3], *rows[5:], ""]))
        page = report([solve_flight(project).history()]).decode()
    return re.sub(r'"first": \[3[^]]*\]', '"first": [125,125,125,125,125]', page).encode()


def odd() -> History:
    """Nine frames with a gap, one without angles, a wide interval, and angles beyond the cuts."""
    angles = np.tile([355.0, -60.0, 178.0, 355.0, -60.0, 178.0, 1.0, -2.0, 3.0], (9, 1))
    angles += np.outer(np.arange(9.0), [3.0, 0.1, 1.0, 3.0, 0.1, 1.0, 0.2, 0.3, 0.4])
    angles[:, :6] %= 360.0
    angles[4] = np.nan
    half = np.tile([0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6], (9, 1))
    half[6], half[7] = 9.0, np.inf
    times = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 9.0, 9.5, 12.0])
    angles[8, 3] += 150.0
    flags = {"two_landmarks": [1, 2], "second_solution": [1, 2, 3], "jump": [6]}
    one = by_hand(9, angles_deg=angles, half_deg=half, flags=flags, time_s=times)
    return replace(one, residual_rms=np.array([1.0, 1.2, 0.8, 1.1, 0.9, 1.3, 40.0, np.nan, 0.7]))


def columns(browser: Any, table: str = "frames-table") -> dict[str, list[str]]:
    """The texts of all columns by their headings, of the rows that are shown."""
    script = """
      const table = document.getElementById(arguments[0]);
      const rows = [...table.tBodies[0].rows].filter((row) => !row.hidden);
      return [...table.tHead.rows[0].cells].map((cell, k) => [cell.textContent,
        rows.map((row) => row.cells[k].dataset.text ?? row.cells[k].textContent.trim())]);
    """
    pairs = browser.execute_script(script, table)
    assert len(dict(pairs)) == len(pairs)
    return dict(pairs)


def column(browser: Any, name: str, table: str = "frames-table") -> list[str]:
    return columns(browser, table)[name]


def heading(browser: Any, name: str) -> Any:
    script = """
      return [...document.querySelectorAll("#frames-table thead button")]
        .find((button) => button.textContent === arguments[0]);
    """
    return browser.execute_script(script, name)


def tabbed(browser: Any, times: int) -> list[tuple[Any, str]]:
    """What Tab leads to, pressed so many times, and how each is outlined while it has the focus."""
    browser.execute_script("""
      window.reached = [];
      document.addEventListener("focusin", ({target}) =>
        window.reached.push([target, getComputedStyle(target).outlineStyle]));
    """)
    ActionChains(browser).send_keys(Keys.TAB * times).perform()
    return [(one, outline) for one, outline in browser.execute_script("return window.reached")]


def test_it_loads_without_a_word_and_asks_for_nothing(browser: Any, tmp_path: Path) -> None:
    case4 = load(forget(browser), tmp_path, page_of("case4"))
    assert case4.get_log("browser") == []
    events = [json.loads(entry["message"])["message"] for entry in case4.get_log("performance")]
    sent = [one["params"] for one in events if one["method"] == "Network.requestWillBeSent"]
    asked = {one["request"]["url"] for one in sent}
    assert {url for url in asked if not url.startswith("data:")} == {case4.current_url}
    sizes = case4.execute_script("return [...document.images].map((image) => image.naturalWidth)")
    assert len(sizes) == 1 and sizes[0] > 100


@pytest.mark.parametrize("made", ["case4", "film"])
def test_its_numbers_are_the_csv_s(made: str, request: pytest.FixtureRequest) -> None:
    browser = request.getfixturevalue(made)
    source = histories("appendix_h/case4") if made == "case4" else flight()
    text = FORMATS["csv"].render(source, FileRequest()).decode()
    rows = list(csv.DictReader(line for line in io.StringIO(text) if not line.startswith("#")))
    seen = columns(browser)
    assert {"frame", "vehicle_yaw_deg", "eta_deg", "eta_high_95_deg", "flags"} <= set(seen)
    for name, texts in seen.items():
        assert texts == [row[name] for row in rows], name


def test_a_column_sorts_up_and_down(film: Any) -> None:
    """As numbers, not as words; the ignored frame, which has none, stays last."""
    before = column(film, "vehicle_pitch_deg")
    known = sorted((text for text in before if text), key=float)
    assert len(known) == 29 and known != sorted(known)
    heading(film, "vehicle_pitch_deg").click()
    assert column(film, "vehicle_pitch_deg") == [*known, ""]
    th = heading(film, "vehicle_pitch_deg").find_element(By.XPATH, "..")
    assert th.get_attribute("aria-sort") == "ascending"
    heading(film, "vehicle_pitch_deg").click()
    assert column(film, "vehicle_pitch_deg") == [*known[::-1], ""]
    assert th.get_attribute("aria-sort") == "descending"
    heading(film, "frame").click()
    assert column(film, "frame") == [str(k) for k in range(1, 31)]
    assert th.get_attribute("aria-sort") is None


def test_words_sort_as_words_and_what_is_no_number_stays_last(browser: Any, tmp_path: Path) -> None:
    half = np.tile(np.arange(1.0, 5.0)[:, None], (1, 9))
    half[1, 3] = np.inf
    names = ["b.jpg", "a.jpg", "10.jpg", "9.jpg"]
    load(browser, tmp_path, report([by_hand(4, half_deg=half, frame_names=names)]))
    heading(browser, "image").click()
    assert column(browser, "image") == ["10.jpg", "9.jpg", "a.jpg", "b.jpg"]
    for expected in (["1", "3", "4", "2"], ["4", "3", "1", "2"]):  # up, down
        heading(browser, "half_width_95_vehicle_yaw_deg").click()
        assert column(browser, "frame") == expected


def test_by_keyboard_alone(film: Any) -> None:
    """Tab reaches the filters and the headings in order; Enter sorts, arrows choose."""
    script = "return arguments[0].map((one) => one.id || one.textContent)"
    reached = film.execute_script(script, [one for one, _ in tabbed(film, 60)])
    assert reached[0].startswith("Skip")
    assert reached.index("flag") < reached.index("number") < reached.index("frame")
    film.refresh()
    tabbed(film, reached.index("time_s") + 1)
    assert film.switch_to.active_element == heading(film, "time_s")
    film.switch_to.active_element.send_keys(Keys.ENTER, Keys.ENTER)
    times = [float(text) for text in column(film, "time_s")]
    assert times == sorted(times, reverse=True)


def test_tab_reaches_every_control_in_order(case4: Any) -> None:
    """The controls are those that the page's markup has, by another way than their order."""
    controls = case4.execute_script("""
      return [...document.querySelectorAll("a[href], button, select, input, summary, [tabindex]")]
        .filter((one) => one.checkVisibility() && !one.disabled);
    """)
    tags = case4.execute_script("return arguments[0].map((one) => one.localName)", controls)
    assert tags.count("select") == 3 and tags.count("button") > 24 and "summary" in tags
    reached = tabbed(case4, len(controls))
    for control, (one, outline) in zip(controls, reached, strict=True):
        assert one == control, control.get_attribute("outerHTML")[:80]
        assert outline == "solid", control.get_attribute("outerHTML")[:80]


def shown(browser: Any) -> list[str]:
    """The frame numbers of the rows that are painted."""
    script = """
      return [...document.querySelectorAll("#frames-table tbody tr")]
        .filter((row) => row.checkVisibility()).map((row) => row.querySelector("th").textContent);
    """
    return list(browser.execute_script(script))


def test_a_long_table_comes_in_pages(long_film: Any) -> None:
    numbers = [str(k) for k in range(1, 251)]
    flag, after, more = (
        long_film.find_element(By.ID, one) for one in ("flag", "rows-after", "more")
    )
    assert shown(long_film) == numbers[:100]
    last = "#frames-table tbody tr:nth-child(100) button"
    long_film.find_element(By.CSS_SELECTOR, last).send_keys(Keys.ENTER)
    long_film.switch_to.active_element.send_keys(Keys.ARROW_DOWN)
    assert chosen(long_film) == "101" and shown(long_film) == numbers[100:200]
    heading(long_film, "frame").click()
    heading(long_film, "frame").click()
    assert shown(long_film) == numbers[::-1][:100]  # the last of all, not of those shown
    for _ in range(2):
        after.click()
    assert shown(long_film) == numbers[::-1][200:] and not after.is_enabled()
    assert long_film.switch_to.active_element.get_attribute("id") == "rows-before"
    assert more.text == "Show all 250 rows"
    more.click()
    assert shown(long_film) == numbers[::-1] and not more.is_displayed()
    Select(flag).select_by_value("outlier")
    assert "5" in shown(long_film) and not more.is_displayed()


def test_without_scripting_the_rest_is_there_to_read(film: Any) -> None:
    film.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        film.refresh()
        (told,) = film.find_elements(By.TAG_NAME, "noscript")
        assert "vopd attitude" in told.text
        assert not film.find_element(By.ID, "work").is_displayed()
        rows = film.find_elements(By.CSS_SELECTOR, "#angles-table tbody tr")
        assert len(rows) == 9 and all(row.is_displayed() for row in rows)
    finally:
        film.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def test_filters(film: Any) -> None:
    choice = Select(film.find_element(By.ID, "flag"))
    values = [option.get_attribute("value") for option in choice.options]
    assert values == ["", "*", "-", "outlier", "misfit"]
    choice.select_by_value("outlier")
    assert column(film, "frame") == ["5"]
    assert film.find_element(By.ID, "count").text == "1 of 30 frames"
    choice.select_by_value("-")
    without = column(film, "frame")
    choice.select_by_value("*")
    assert column(film, "frame") == ["5"] and len(without) == 29 and "5" not in without
    assert film.find_element(By.ID, "now").text.startswith("frame 5,")
    film.find_element(By.CSS_SELECTOR, "#filters [type=reset]").click()
    WebDriverWait(film, 20).until(lambda one: len(column(one, "frame")) == 30)  # after the event
    assert chosen(film) == "5"
    film.find_element(By.CSS_SELECTOR, "#answer [data-flag=misfit]").click()
    assert column(film, "frame") == ["5"]


def test_a_range_filters_and_a_pasted_number_may_have_blanks(film: Any) -> None:
    Select(film.find_element(By.ID, "column")).select_by_visible_text("frame")
    low, high = film.find_element(By.ID, "low"), film.find_element(By.ID, "high")
    paste(film, low, " 11 ")
    paste(film, high, "\u00a014\t")
    assert column(film, "frame") == ["11", "12", "13", "14"] and chosen(film) == "11"
    assert film.find_element(By.ID, "slider").get_attribute("max") == "3"
    paste(film, low, "11,5")
    assert column(film, "frame") == ["12", "13", "14"]  # a decimal comma
    paste(film, low, "eleven")
    assert low.get_attribute("aria-invalid") == "true" and len(column(film, "frame")) == 14
    paste(film, film.find_element(By.ID, "number"), " 12\n")
    assert chosen(film) == "12"
    for typed, told in ((" 20 ", "left out by the filters"), ("99", "no frame 99")):
        paste(film, film.find_element(By.ID, "number"), typed)
        assert told in film.find_element(By.ID, "nowhere").text and chosen(film) == "12"


# The frame that is chosen


def chosen(browser: Any) -> str:
    """The number of the chosen frame, on which all parts of the page agree."""
    number, *others = browser.execute_script("""
      const of = (id) => document.getElementById(id);
      return [document.querySelector("#frames-table [aria-current] th").textContent,
        of("now").textContent, of("slider").getAttribute("aria-valuetext"),
        of("image-text").textContent,
        ...[...document.querySelectorAll(".drawing svg")].map((one) => one.ariaLabel)];
    """)
    assert len(others) == 6
    for text in others:
        assert re.search(rf"\bframe {number}\b", text), text
    return str(number)


def paste(browser: Any, box: Any, text: str) -> None:
    browser.execute_script(
        "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'));",
        box,
        text,
    )


def test_the_slider_curves_keys_and_rows_choose_a_frame(film: Any) -> None:
    assert chosen(film) == "5"  # the first that has a flag
    slider = film.find_element(By.ID, "slider")
    paste(film, slider, "11")
    assert chosen(film) == "12"
    slider.send_keys(Keys.ARROW_RIGHT, Keys.PAGE_UP, Keys.ARROW_LEFT)
    assert chosen(film) == "22" and film.switch_to.active_element == slider
    curve = film.find_element(By.ID, "curve-box")
    curve.send_keys(Keys.HOME)
    assert chosen(film) == "1"
    film.find_element(By.ID, "after").click()
    assert chosen(film) == "2"
    wide = film.execute_script("return document.querySelector('#curve-box svg').clientWidth")
    edge = int(wide / 2) - 15  # the last frame is 14 px from the right
    ActionChains(film).move_to_element_with_offset(curve, edge, 0).click().perform()
    assert chosen(film) == "30"
    row = film.find_element(By.CSS_SELECTOR, "#frames-table tbody tr:nth-child(18) button")
    row.send_keys(Keys.ENTER)
    assert chosen(film) == "18"
    film.switch_to.active_element.send_keys(Keys.ARROW_DOWN)
    assert chosen(film) == "19"
    assert film.switch_to.active_element.text == "19"  # the focus goes with it


def test_a_frame_without_an_interval_has_no_band(browser: Any, tmp_path: Path) -> None:
    """Eta of frame 5 has none; a gap divides the frames into 7 and 22, each with two edges."""
    page = page_of("film").decode()
    columns = {one["name"]: one for one in data_of(page)["columns"]}
    for end in ("low", "high"):
        page = page.replace(columns[f"eta_{end}_95_deg"]["values"][4], "null", 1)
    load(browser, tmp_path, page.encode())
    script = """
      const group = document.getElementById("group");
      group.value = "attack";
      group.dispatchEvent(new Event("change", { bubbles: true }));
      return [...document.querySelectorAll("#curve-box .band")].map((one) =>
        one.getAttribute("d").split(/[ML]/).length - 1);
    """
    assert browser.execute_script(script) == [14, 44, 14, 44, 12, 44]


def test_curves_as_people_read_them(browser: Any, tmp_path: Path) -> None:
    """Roll beyond 180 is negative, a gap breaks the line, and one fact has one row of marks."""
    angles = np.tile([10.0, -60.0, 190.0, 10.0, -60.0, 190.0, 0.0, 0.0, 0.0], (5, 1))
    times = np.array([0.0, 1.0, 2.0, 3.0, 9.0])
    flags = {"two_landmarks": [1, 2], "second_solution": [1, 2], "jump": [4]}
    one = by_hand(5, angles_deg=angles, time_s=times, flags=flags)
    load(browser, tmp_path, report([one]))
    values = [text.text for text in browser.find_elements(By.CSS_SELECTOR, "#curve-box .value")]
    assert float(values[2].split()[0]) == -170.0 and float(values[0].split()[0]) == 10.0
    flags_drawn = browser.find_elements(By.CSS_SELECTOR, "#curve-box .flagname")
    assert [text.text for text in flags_drawn] == ["two_landmarks (2)", "jump (1)"]
    line = browser.find_element(By.CSS_SELECTOR, "#curve-box path.curve").get_attribute("d")
    assert line.count("M") == 2 and line.count("L") == 3


def test_a_roll_on_both_sides_of_180_goes_on_and_angles_round_into_their_range(
    browser: Any, tmp_path: Path
) -> None:
    """As in the table: 181 follows 180. A yaw of 359.9999 is 0.00, and no 360."""
    angles = np.tile([359.9999, -60.0, 182.0], (3, 3))
    angles[:, 5] = [182.0, 178.0, 180.0]
    load(browser, tmp_path, report([by_hand(3, angles_deg=angles, half_deg=np.full((3, 9), 0.1))]))
    values = [text.text for text in browser.find_elements(By.CSS_SELECTOR, "#curve-box .value")]
    assert [float(values[k].split()[0]) for k in (0, 2)] == [0.0, 182.0]
    ticks = [text.text for text in browser.find_elements(By.CSS_SELECTOR, "#curve-box .tick")]
    assert {"178", "180", "182"} <= {*ticks} and "-178" not in ticks


def test_curves_are_those_of_the_chosen_job(browser: Any, tmp_path: Path) -> None:
    """Of two jobs of five and three frames: choosing a frame of the other draws its curves."""
    second = by_hand(3, said={"job": 2})
    load(browser, tmp_path, report([by_hand(5), second]))
    script = """
      const line = () => document.querySelector("#curve-box path.curve").getAttribute("d");
      const before = line().split(/[ML]/).length - 1;
      const rows = [...document.querySelectorAll("#frames-table tbody tr")];
      rows.at(-1).click();
      return [before, line().split(/[ML]/).length - 1, document.getElementById("now").textContent];
    """
    before, after, now = browser.execute_script(script)
    assert (before, after) == (5, 3)
    assert now.startswith(f"{second.about.label}, ")


def test_image_map_and_residuals_are_those_of_the_frame(hill: Any) -> None:
    """Against the picks of the project's file, and the track that goes east by 5 m a frame."""
    picks = list(csv.DictReader((HILL.parent / "picks.csv").read_text().splitlines()))
    hill.find_element(By.ID, "curve-box").send_keys(Keys.END)
    assert chosen(hill) == "4"
    own = {row["landmark"]: row for row in picks if row["frame"] == "4"}
    rows = columns(hill, "picks-table")
    assert set(rows["landmark"]) == set(own) and set(rows[""]) == {""}
    lengths = [float(text) for text in rows["length, px"]]
    assert lengths == sorted(lengths, reverse=True)
    places = hill.execute_script("""
      const box = document.querySelector("#image-box svg").viewBox.baseVal;
      return [box.width, ...[...document.querySelectorAll("#image-box circle")].map(
        (one) => [Number(one.getAttribute("cx")), Number(one.getAttribute("cy"))])];
    """)
    width, *marks = places
    expected = [[float(row["u_px"]) + 0.5, float(row["v_px"]) + 0.5] for row in own.values()]
    assert_close("mark on a page", np.array(marks) * (1920.0 / width), expected)
    photograph = hill.find_element(By.CSS_SELECTOR, "#image-box image")
    assert photograph.get_attribute("href").startswith("data:image/jpeg;base64,")
    texts = [one.text for one in hill.find_elements(By.CSS_SELECTOR, "#map-box text.name")]
    assert set(own) <= set(texts)
    script = "return [0.3, 1, 1.9, 2, 4.9, 5, 9.9, 10, 0].map(roundNumber)"  # of bars and arrows
    assert hill.execute_script(script) == [0.2, 1, 1, 2, 2, 5, 5, 10, 1]


def test_the_map_has_places_where_they_are(hill: Any) -> None:
    """North up and east to the right, of one scale, which is that of the bar."""
    (job,) = data_of(page_of("hill").decode())["jobs"]
    marks, (bar, told) = hill.execute_script("""
      const numbers = (path) => path.getAttribute("d").match(/-?[\\d.]+/g).slice(0, 2).map(Number);
      const bar = document.querySelector("#map-box .bar");
      return [[...document.querySelectorAll("#map-box g .mark, #map-box g .other")].map(numbers),
        [bar.getAttribute("x2") - bar.getAttribute("x1"), bar.nextSibling.textContent]];
    """)
    east, north = (np.array(job["places"][name], float) for name in ("east_m", "north_m"))
    x, y = np.array(marks).T
    scale = float(bar) / float(told.removesuffix(" m"))
    border = hill.find_element(By.CSS_SELECTOR, "#map-box rect.border")
    assert bar <= 0.25 * float(border.get_attribute("width")) < 2.5 * bar  # 1, 2, 5 or 10 m
    assert_close("mark on a page", x - x[0], (east - east[0]) * scale)
    assert_close("mark on a page", y - y[0], (north[0] - north) * scale)


def test_the_side_view_has_distances_along_its_azimuth(hill: Any) -> None:
    (job,) = data_of(page_of("hill").decode())["jobs"]
    azimuth_deg, camera, marks = hill.execute_script("""
      const side = document.querySelector("#map-box svg");
      const x = (path) => Number(path.getAttribute("d").match(/-?[\\d.]+/)[0]);
      return [Number(side.textContent.match(/distance toward (\\d+)/)[1]),
        Number(side.querySelector(":scope > circle.camera").getAttribute("cx")),
        [...side.querySelectorAll(":scope > path.mark")].map(x)];
    """)
    away = [
        np.array(job["places"][name], float) - float(job["camera"][name][0])
        for name in ("east_m", "north_m")
    ]
    along = away[0] * np.sin(np.radians(azimuth_deg)) + away[1] * np.cos(np.radians(azimuth_deg))
    shown = np.array(marks) - camera
    assert len(shown) == len(along) and np.corrcoef(shown, along)[0, 1] > 0.999


def test_the_map_of_a_grid_has_true_north(browser: Any, tmp_path: Path) -> None:
    """Of one whose north is 30 degrees east of true north: 30 degrees left of upward is north."""
    script = """
      const side = document.querySelector("#map-box svg"), north = side.querySelector(".north");
      const ends = (north.getAttribute("d") ?? north.outerHTML).match(/-?[\\d.]+/g).map(Number);
      return [Number(side.textContent.match(/distance toward (\\d+)/)[1]), ends];
    """
    page, shown = page_of("hill").decode(), []
    for convergence in ("0.0", "30.0"):
        turned = page.replace('"convergence": 0.0', f'"convergence": {convergence}')
        load(browser, tmp_path, turned.encode())
        shown.append(browser.execute_script(script))
    (grid_deg, up), (true_deg, left) = shown
    assert (true_deg - grid_deg) % 360 == 30
    for (x, y, to_x, to_y), angle_deg in ((up[:4], 0.0), (left[:4], -30.0)):
        found = np.degrees(np.arctan2(to_x - x, y - to_y))
        assert_close("mark on a page", found, angle_deg)


def test_every_control_has_a_name_and_wide_figures_scroll(case4: Any) -> None:
    script = """
      const named = (one) => one.ariaLabel || (one.matches("input, select") ? one.labels.length
        : one.textContent.trim());
      return [[...document.querySelectorAll("button, input, select, a, [tabindex], [role]")]
        .filter((one) => !named(one)).map((one) => one.outerHTML),
        getComputedStyle(document.querySelector(".picture")).overflowX];
    """
    assert case4.execute_script(script) == [[], "auto"]


def test_a_number_below_zero_keeps_its_sign(browser: Any, tmp_path: Path) -> None:
    angles = np.tile([10.0, -1e-9, 20.0], (3, 3))
    load(browser, tmp_path, report([by_hand(3, angles_deg=angles)]))
    assert column(browser, "vehicle_pitch_deg") == ["-0.000000"] * 3


def test_one_frame_has_no_curves(browser: Any, tmp_path: Path) -> None:
    for frames in (1, 2):
        load(browser, tmp_path, report([by_hand(frames)]))
        assert browser.find_element(By.ID, "curves").is_displayed() == (frames > 1)


def test_captions_of_image_and_map(hill: Any, film: Any, request: pytest.FixtureRequest) -> None:
    """What their marks are, which north, what is broken off."""
    for name in ("film", "hill"):
        load(hill, request.getfixturevalue("tmp_path"), page_of(name))
        for part in ("image-text", "map-text"):
            assert_approved(hill.find_element(By.ID, part).text)


def test_each_frame_has_the_size_of_its_image(browser: Any, tmp_path: Path) -> None:
    """Of a second job too, whose images are of two sizes."""
    made = page_of("hill").decode()
    both = report([solve_flight(HILL).history()] * 2).decode()
    start, end = (both.index(one) for one in ('"sizes": [[1920,1080]]', '"picks": '))
    assert start > 0 and end > 0 and made
    second = both.rindex('"sizes": [[1920,1080]]')
    sizes = '"sizes": [[400,300],[1920,1080]], "size": [0,1,0,1,1]'
    both = both[:second] + sizes + both[second + len('"sizes": [[1920,1080]]') :]
    load(browser, tmp_path, both.encode())
    script = """
      const slider = document.getElementById("slider");
      slider.value = arguments[0];
      slider.dispatchEvent(new Event("input"));
      const { width, height } = document.querySelector("#image-box svg").viewBox.baseVal;
      return width / height;
    """
    wide = [browser.execute_script(script, frame) for frame in range(10)]
    expected = [16 / 9] * 5 + [4 / 3, 16 / 9, 4 / 3, 16 / 9, 16 / 9]
    assert_close("mark on a page", wide, expected)


def test_names_on_a_photograph_are_readable(hill: Any) -> None:
    """Against their outline, as a photograph may be light or dark: 4.5 at least."""
    pairs = hill.execute_script("""
      const rgb = (text) => text.match(/\\d+/g).slice(0, 3).map(Number);
      return [...document.querySelectorAll("#image-box svg.photo text")].map((one) => {
        const { fill, stroke } = getComputedStyle(one);
        return [rgb(fill), rgb(stroke)];
      });
    """)
    assert len(pairs) > 8  # of landmarks and azimuths
    for one, other in pairs:
        assert contrast(one, other) >= 4.5, (one, other)


def test_arrows_are_as_many_times_as_long_as_is_said(film: Any) -> None:
    """Those of a film are in micrometres, its places in millimetres; the key is an arrow too."""
    (job,) = data_of(page_of("film").decode())["jobs"]
    said, width, marks, arrows, key = film.execute_script("""
      const all = (name) => [...document.querySelectorAll(`#image-box ${name}`)];
      const ends = (path) => path.getAttribute("d").match(/-?[\\d.]+/g).slice(0, 4).map(Number);
      return [document.getElementById("image-text").textContent,
        document.querySelector("#image-box svg").viewBox.baseVal.width,
        all("circle.picked").map((one) => [one.getAttribute("cx"), one.getAttribute("cy")]),
        all("path.residual").map(ends), all("text.key").at(-1).textContent];
    """)
    times = float(re.findall(r"residuals, ([\d.]+) times", said)[0])
    k = int(chosen(film)) - 1
    picks = {name: np.array(values, float) for name, values in job["picks"].items()}
    ends = np.cumsum(picks["count"]).astype(int)
    own = slice(ends[k] - int(picks["count"][k]), ends[k])
    du, dv, u, state = (picks[name][own] for name in ("du", "dv", "u", "state"))
    unit = np.ptp(np.array(marks, float)[:, 0]) / np.ptp(u[state == 0])
    *own_arrows, of_key = np.array(arrows)
    lengths = np.array([np.hypot(one[2] - one[0], one[3] - one[1]) for one in own_arrows])
    expected = np.hypot(du, dv) / 1000.0 * times * unit
    assert times > 1.0 and np.median(lengths) > 0.005 * width
    drawn = np.sort(expected[(expected > 0.5) & (expected <= 0.3 * width)])
    assert_close("mark on a page", np.sort(lengths), drawn)
    long_um = float(key.split()[0])
    assert_close("mark on a page", of_key[2] - of_key[0], long_um / 1000.0 * times * unit)


PAGES = {"hill": 6, "long film": 8, "3000": 8}
"""Sheets of paper at most, without the figures of matplotlib."""


@pytest.mark.parametrize("name", PAGES)
def test_widths_and_paper(name: str, browser: Any, tmp_path: Path) -> None:
    """The page is never wider than the screen, on paper no table is, and the pages are few."""
    load(forget(browser), tmp_path, page_of(name))
    assert len(page_of(name)) < 2_000_000
    try:
        for width in (360,) if name == "3000" else (360, 800, 1400):  # more take seconds each
            size = {"width": width, "height": 740, "deviceScaleFactor": 1, "mobile": width < 800}
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
            script = """
              const [done] = arguments;
              const right = (one) => one.getBoundingClientRect().right;
              requestAnimationFrame(() => setTimeout(() => done([
                document.documentElement.scrollWidth,
                ...[...document.querySelectorAll(".drawing svg")].map(right)]), 50));
            """
            assert max(browser.execute_async_script(script)) <= width, width
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        paper = {"width": 1047, "height": 718, "deviceScaleFactor": 1, "mobile": False}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", paper)
        wide = "return [...document.querySelectorAll('table')].map((one) => one.offsetWidth)"
        assert max(browser.execute_script(wide)) <= 1047
        repeated = "return getComputedStyle(document.querySelector('#frames-table thead')).display"
        assert browser.execute_script(repeated) == "table-header-group"  # on each sheet
        assert not browser.find_element(By.ID, "flag").is_displayed()
        assert not browser.find_element(By.ID, "more").is_displayed()
        left = """
          return [...document.querySelectorAll("nav, .along, .controls button, input, select")]
            .filter((one) => one.offsetParent).map((one) => one.outerHTML);
        """
        assert browser.execute_script(left) == []
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    printed = browser.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"]
    assert len(re.findall(rb"/Type /Page\b", base64.b64decode(printed))) <= PAGES[name]
    assert browser.get_log("browser") == []


def test_text_is_readable_in_light_and_dark(film: Any) -> None:
    """Contrast of text and of flags against what is behind them: 4.5 at least (WCAG AA)."""
    script = """
      const rgb = (text) => text.match(/\\d+/g).slice(0, 3).map(Number);
      const style = (name) => getComputedStyle(document.querySelector(name));
      return [[style("body").color, style("body").backgroundColor],
              [style(".flags span").color, style(".flags span").backgroundColor],
              [style("nav a").color, style("body").backgroundColor],
              [style("svg .title").fill, style("body").backgroundColor],
              [style("svg .curve").stroke, style("body").backgroundColor],
              [style("svg .culprit").stroke, style("body").backgroundColor],
              [style("svg .residual").stroke, style("body").backgroundColor],
              [style("[aria-current] td").color, style("[aria-current] td").backgroundColor],
              [style("th button").color, style("#frames-table thead th").backgroundColor]].map(
                ([one, other]) => [rgb(one), rgb(other)]);
    """
    for scheme in ("light", "dark"):
        feature = [{"name": "prefers-color-scheme", "value": scheme}]
        film.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": feature})
        pairs = film.execute_script(script)
        film.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
        for one, other in pairs:
            assert contrast(one, other) >= 4.5, (scheme, one, other)
    assert pairs[0][1] != [255, 255, 255]  # the dark one is dark


def test_figures_are_light_or_dark_as_their_page(case4: Any) -> None:
    """The ground of the figure is the page's, and everything in it can be told from it."""
    image = case4.find_element(By.CSS_SELECTOR, "#residuals img")
    grounds = []
    for scheme in ("light", "dark"):
        feature = [{"name": "prefers-color-scheme", "value": scheme}]
        case4.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": feature})
        picture = np.asarray(Image.open(io.BytesIO(image.screenshot_as_png)).convert("RGB"))
        case4.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
        ground = picture[3, 3].tolist()
        far = np.abs(picture.astype(int) - ground).sum(axis=2)
        ink = picture.reshape(-1, 3)[far.argmax()].tolist()
        assert contrast(ink, ground) >= 12.0, scheme
        grounds.append(ground)
    assert grounds == [[255, 255, 255], [22, 24, 27]]  # --back of page.css
    address = image.get_attribute("src").partition(",")[2]
    dark = base64.b64decode(address).decode().partition("prefers-color-scheme:dark")[2]
    colours = re.findall(r"--c\d+:#(\w\w)(\w\w)(\w\w)", dark)
    levels = [contrast([int(part, 16) for part in one], [22, 24, 27]) for one in colours]
    assert len(levels) > 2 and sum(level < 3.0 for level in levels) <= 2  # ground and grid


def contrast(one: list[int], other: list[int]) -> float:
    """The ratio of WCAG 2, from its definition."""

    def luminance(rgb: list[int]) -> float:
        parts = [c / 255.0 for c in rgb]
        linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_the_skip_link_is_seen_where_it_has_the_focus(film: Any) -> None:
    skip = film.find_element(By.CLASS_NAME, "skip")
    assert skip.rect["x"] < -500
    ActionChains(film).send_keys(Keys.TAB).perform()
    assert film.switch_to.active_element == skip and skip.rect["x"] >= 0


def test_the_frame_s_number_stays_in_sight(film: Any) -> None:
    script = """
      document.getElementById("frames-table").parentNode.scrollLeft = 600;
      const cell = document.querySelector("#frames-table tbody th");
      return [cell, cell.closest(".scroll")].map((one) => one.getBoundingClientRect().left);
    """
    left, box = film.execute_script(script)
    assert left - box < 3


@pytest.mark.usefixtures("no_figures")
def test_hostile_names_do_nothing(browser: Any, tmp_path: Path) -> None:
    bad = "</title></script><script>document.title='taken'</script><img src=x onerror=alert(2)>"
    names = {k: f"{k}{bad}" for k in (7, 8, 9, 10)}
    one = by_hand(
        3, said={"source": bad, "title": bad}, landmark_names=names, frame_names=[bad] * 3
    )
    load(forget(browser), tmp_path, report([one], [bad]))
    assert browser.title.startswith("Attitude report: </title>")
    assert browser.get_log("browser") == []
    assert bad in browser.find_element(By.TAG_NAME, "header").text
    assert bad in browser.find_element(By.ID, "now").text
    assert names[7] in columns(browser, "picks-table")["landmark"]
    assert browser.find_elements(By.CSS_SELECTOR, "#frames img, svg script") == []


@pytest.mark.usefixtures("no_figures")
def test_wide_names_cover_no_mark(browser: Any, tmp_path: Path) -> None:
    """A thousand letters are short in drawings and below them; the table has them whole."""
    load(browser, tmp_path, report([renamed()], ["first " * 400]))
    of_answer = browser.find_element(By.CSS_SELECTOR, "#answer ul").text
    assert 300 < len(of_answer) < 1500 and of_answer.endswith("…")
    browser.find_element(By.ID, "number").send_keys("2", Keys.ENTER)
    assert WIDE in columns(browser, "picks-table")["landmark"]
    assert len(browser.find_element(By.ID, "image-text").text) < 500
    covered = """
      const boxes = (box, what) => [...document.querySelectorAll(`${box} ${what}`)].map(
        (one) => one.getBoundingClientRect());
      return ["#image-box", "#map-box"].map((box) => {
        const marks = boxes(box, "rect.culprit").map((one) =>
          [one.x + one.width / 2, one.y + one.height / 2]);
        const names = boxes(box, "text.name");
        return [marks.length, names.length, marks.filter(([x, y]) => names.some(
          (name) => x > name.left && x < name.right && y > name.top && y < name.bottom)).length];
      });
    """
    for marks, names, under in browser.execute_script(covered):
        assert marks >= 2 and names >= 3 and under == 0
    written = [one.text for one in browser.find_elements(By.CSS_SELECTOR, "svg text.name")]
    assert max(len(one.removesuffix(": does not fit")) for one in written) == 24
    curve = """
      const lines = [...document.querySelectorAll("#curve-box path.curve")];
      return lines.map((one) => one.getAttribute("d").split("M").length - 1);
    """
    pieces = browser.execute_script(curve)
    assert pieces[:8:2] == [1, 1, 1, 1]  # residuals of hundreds of pixels do not wrap


def test_the_page_of_a_batch(browser: Any, tmp_path: Path) -> None:
    """Worst first; a click on a heading sorts; a link leads to the report of its source."""
    from vopd.report import batch_page

    (tmp_path / "a b").mkdir()
    (tmp_path / "a b" / "one#1.html").write_text("<title>of one</title>")
    rows: list[tuple[str | None, list[object]]] = [
        (None, ["lost", "failed", 0, 0, 0, 0, 0, "", "<b>no such file</b>"]),
        ("a b/one#1.html", ["a b/one#1", "solved", 30, 29, 0, 9, 2, "misfit:9", ""]),
        (None, ["two", "solved", 4, 4, 0, 10, 0, "outlier:10", ""]),
    ]
    page = load(forget(browser), tmp_path, batch_page(rows, "3 sources", 1))
    assert page.get_log("browser") == []
    names = ["lost", "a b/one#1", "two"]
    assert column(page, "source", "sources-table") == names
    assert column(page, "error", "sources-table")[0] == "<b>no such file</b>"
    buttons = page.find_elements(By.CSS_SELECTOR, "#sources-table thead button")
    flagged = next(one for one in buttons if one.get_attribute("textContent") == "flagged")
    for order in ([0, 1, 2], [2, 1, 0]):  # 0, 9, 10: by number, not as words
        flagged.click()
        assert column(page, "source", "sources-table") == [names[k] for k in order]
    page.find_element(By.LINK_TEXT, "a b/one#1").click()
    assert page.title == "of one"


# Everything that the script draws and says, of pages of all kinds, step by step

STATE = (
    ".drawing svg, #picks-table, #now, #count, #rows, #nowhere, #slider, #before, #after, #low, "
    "#high, #more, #rows-before, #rows-after, figcaption[id], #group, #filters select"
)
HANDS = """
  const of = (id) => document.getElementById(id);
  const did = (id, what) => of(id).dispatchEvent(new Event(what, { bubbles: true }));
  const select = (id, value) => { of(id).value = value; did(id, "change"); };
  const type = (id, value) => { of(id).value = value; did(id, "input"); };
  const key = (name) => of("curve-box").dispatchEvent(
    new KeyboardEvent("keydown", { key: name, bubbles: true }));
"""
WIDTHS = """
  window.widthOf = (text) => 6 * text.length + 4;  // of any font
  for (const id of ["curve-box", "image-box", "map-box"])
    document.getElementById(id).style.width = "620px";
  for (const what of ["input", "change"]) {  // all is drawn anew
    document.getElementById("low").dispatchEvent(new Event(what));
  }
"""
DOES: dict[str, list[str]] = {  # what a user does to a page, step by step
    "hill": ["key('End')"],
    "film": ["type('number', 8)", "select('group', 'attack'); type('number', 20)"],
    "case1": [],
    "left out": ["type('number', 1)"],
    "odd": ["select('job', 1)"],
    "grid": [],
}


@pytest.mark.parametrize("name", DOES)
def test_what_is_drawn_and_said(name: str, browser: Any, tmp_path: Path) -> None:
    load(browser, tmp_path, page_of(name))
    browser.execute_script(WIDTHS)
    for does in ["", *DOES[name]]:
        browser.execute_script(HANDS + does)
        assert_approved(all_shown(browser, STATE))


LOOKS: dict[str, dict[str, Any]] = {  # media, and pixels of the screen's width
    "light": {"media": "", "features": [{"name": "prefers-color-scheme", "value": "light"}]},
    "dark": {"media": "", "features": [{"name": "prefers-color-scheme", "value": "dark"}]},
    "print": {"media": "print"},
    "narrow": {"media": "", "width": 360},
}


def test_how_everything_looks(browser: Any, tmp_path: Path) -> None:
    """Light; dark, on paper, and on a narrow screen what looks otherwise then."""
    for name in ("left out", "film", "hill"):
        load(browser, tmp_path, page_of(name))
        usual: dict[str, str] = {}
        try:
            for media in LOOKS.values():
                width = media.get("width", 1000)
                size = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False}
                browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
                given = {key: one for key, one in media.items() if key != "width"}
                browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []} | given)
                found = styles(browser)
                assert_approved({k: v for k, v in found.items() if usual.get(k) != v})
                usual = usual or found
        finally:
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})
            browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
