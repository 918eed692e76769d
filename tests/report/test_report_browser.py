"""The report in a browser."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from tests.kit.browser import forget, load, open_browser
from tests.kit.histories import about, flight, histories
from vopd.export import FORMATS, FileRequest
from vopd.report import report

pytestmark = pytest.mark.usefixtures("not_laid_out")


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    yield from open_browser(tmp_path_factory.mktemp("browser"))


@pytest.fixture
def case4(browser: Any, tmp_path: Path) -> Any:
    return load(browser, tmp_path, page_of("case4"))


@pytest.fixture
def film(browser: Any, tmp_path: Path) -> Any:
    """Thirty frames: frame 8 ignored, an outlier in frame 5; without figures."""
    return load(browser, tmp_path, page_of("film"))


@pytest.fixture
def long_film(browser: Any, tmp_path: Path) -> Any:
    """The same with 450 frames."""
    return load(browser, tmp_path, page_of("long film"))


@cache
def page_of(name: str) -> bytes:
    if name == "case4":
        return report(histories("appendix_h/case4"))
    with pytest.MonkeyPatch.context() as patch:  # figures take longer than all the rest
        patch.setitem(sys.modules, "matplotlib.figure", None)
        return report(flight(450 if name == "long film" else 30))


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
    assert len(sizes) == 5 and min(sizes) > 100


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


def test_words_sort_as_words_and_what_is_no_number_stays_last(film: Any) -> None:
    heading(film, "status").click()
    assert column(film, "frame") == ["8", *(str(k) for k in range(1, 31) if k != 8)]
    film.execute_script("""
      const table = document.getElementById("frames-table");
      table.tBodies[0].rows[3].querySelector("td:nth-last-child(2)").textContent = "inf";
    """)
    for _ in range(2):  # up, down
        heading(film, "condition").click()
        *numbers, last, later = column(film, "condition")
        assert {last, later} == {"inf", ""} and len(set(map(float, numbers))) > 20
        assert numbers == sorted(numbers, key=float, reverse=float(numbers[0]) > float(numbers[-1]))


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
        .filter((one) => one.checkVisibility());
    """)
    tags = case4.execute_script("return arguments[0].map((one) => one.localName)", controls)
    assert tags.count("select") == 1 and tags.count("button") > 24 and "summary" in tags
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


def test_a_long_table_comes_in_parts(long_film: Any) -> None:
    numbers = [str(k) for k in range(1, 451)]
    assert shown(long_film) == numbers[:200]
    heading(long_film, "frame").click()
    heading(long_film, "frame").click()
    assert shown(long_film) == numbers[::-1][:200]  # the last of all, not of those shown
    box = long_film.find_element(By.CSS_SELECTOR, "#frames .scroll")
    long_film.execute_async_script(
        "const [box, done] = arguments; box.addEventListener('scroll', () => setTimeout(done, 0));"
        "box.scrollTop = box.scrollHeight;",
        box,
    )
    assert shown(long_film) == numbers[::-1][:400]
    more = long_film.find_element(By.ID, "more")
    assert more.text == "Show all 450 rows"
    more.click()
    assert shown(long_film) == numbers[::-1] and not more.is_displayed()
    Select(long_film.find_element(By.ID, "flag")).select_by_value("outlier")
    assert "5" in shown(long_film) and not more.is_displayed()


def test_paper_has_all_rows_of_a_long_table(long_film: Any) -> None:
    long_film.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        assert len(shown(long_film)) == 450
    finally:
        long_film.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def test_without_scripting_all_is_there_to_read(long_film: Any) -> None:
    long_film.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        long_film.refresh()
        rows = long_film.find_elements(By.CSS_SELECTOR, "#frames-table tbody tr")
        assert len(rows) == 450 and rows[449].is_displayed()
        assert not long_film.find_element(By.ID, "flag").is_displayed()
    finally:
        long_film.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


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
    choice.select_by_value("")
    film.find_element(By.ID, "number").send_keys("8")
    assert column(film, "status") == ["ignored"]
    film.find_element(By.ID, "number").send_keys("8")
    assert column(film, "frame") == []


def test_a_phone_scrolls_in_one_direction_only(film: Any) -> None:
    size = {"width": 360, "height": 740, "deviceScaleFactor": 1, "mobile": True}
    film.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        width = film.execute_script("return document.documentElement.scrollWidth")
    finally:
        film.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert width <= 360


def test_print_shows_all_rows_and_no_controls(film: Any) -> None:
    Select(film.find_element(By.ID, "flag")).select_by_value("outlier")
    film.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        rows = film.find_elements(By.CSS_SELECTOR, "#frames-table tbody tr")
        assert len(rows) == 30 and all(row.is_displayed() for row in rows)
        assert not film.find_element(By.ID, "flag").is_displayed()
    finally:
        film.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def test_text_is_readable_in_light_and_dark(film: Any) -> None:
    """Contrast of text and of flags against what is behind them: 4.5 at least (WCAG AA)."""
    script = """
      const rgb = (text) => text.match(/\\d+/g).slice(0, 3).map(Number);
      const style = (name) => getComputedStyle(document.querySelector(name));
      return [[style("body").color, style("body").backgroundColor],
              [style(".flags span").color, style(".flags span").backgroundColor],
              [style("nav a").color, style("body").backgroundColor],
              [style("th button").color, style("thead th").backgroundColor]].map(
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


def contrast(one: list[int], other: list[int]) -> float:
    """The ratio of WCAG 2, from its definition."""

    def luminance(rgb: list[int]) -> float:
        parts = [c / 255.0 for c in rgb]
        linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.usefixtures("no_figures")
def test_hostile_names_do_nothing(browser: Any, tmp_path: Path) -> None:
    bad = "</title></script><script>document.title='taken'</script><img src=x onerror=alert(2)>"
    (one,) = histories("appendix_h/case4")
    load(forget(browser), tmp_path, report([about(one, source=bad)], [bad]))
    assert browser.title.startswith("Attitude report: </title>")
    assert browser.get_log("browser") == []
    assert bad in browser.find_element(By.TAG_NAME, "header").text


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
