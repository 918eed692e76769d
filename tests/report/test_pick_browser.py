"""The page of picks in a browser: clicks, keys, what it keeps and what it saves."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from tests.kit.browser import forget, load, open_browser
from tests.tolerances import assert_close
from vopd.report.pick import pick_page
from vopd.video import open_frames

BLOCK = (30, 20)  # first pixel of a white square of 8 pixels
LANDMARKS = ("mast", 'a "b", <c>')


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    yield from open_browser(tmp_path_factory.mktemp("browser"))


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("images")
    for k in range(2):
        own = np.full((48, 64, 3), 60, np.uint8)
        own[20:28, 30 + 8 * k : 38 + 8 * k] = 255
        Image.fromarray(own).save(folder / f"{k}.png")
    return pick_page(open_frames([str(folder)]), [0, 1], LANDMARKS, head="#")


@pytest.fixture
def opened(browser: Any, tmp_path: Path, page: bytes) -> Any:
    shown = load(browser, tmp_path, page)
    browser.execute_script("localStorage.clear()")
    browser.refresh()
    return ready(shown)


def ready(browser: Any) -> Any:
    WebDriverWait(browser, 20).until(lambda one: where(one)[2] > 1.0)
    return browser


def where(browser: Any) -> tuple[float, float, float]:
    """u and v of the cross, and the zoom."""
    words = browser.find_element(By.ID, "where").text.split()
    return (float(words[1]), float(words[3]), float(words[5])) if len(words) == 6 else (0, 0, 0)


def rows(browser: Any) -> list[str]:
    text = browser.execute_script("return document.getElementById('csv').value")
    return text.splitlines()[2:]


def press(browser: Any, *keys: str) -> None:
    browser.execute_script("document.getElementById('view').focus()")
    ActionChains(browser).send_keys(*keys).perform()


def click_at(browser: Any, x: float, y: float, dense: float) -> None:
    """Click at a pixel of the screen, as a mouse reports it."""
    for kind in ("mousePressed", "mouseReleased"):
        at = {"x": x / dense, "y": y / dense, "button": "left", "clickCount": 1}
        browser.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, **at})


def block_on_screen(browser: Any, dense: float) -> tuple[float, float, float, float]:
    """The edges of the white square in a picture of the screen: left, top, right, bottom."""
    screen = np.asarray(Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB"))
    white = (screen > 220).all(axis=2)
    white[:, : round(245 * dense)] = False  # the list of landmarks
    white[: round(185 * dense), round(-185 * dense) :] = False  # the loupe
    white[round(-50 * dense) :] = False  # the line that says where the cross is
    y, x = np.nonzero(white)
    return x.min(), y.min(), x.max() + 1, y.max() + 1


@pytest.mark.parametrize("dense", [1.0, 1.5, 2.0])
def test_a_click_is_where_the_screen_shows_it(opened: Any, dense: float) -> None:
    """At each zoom: in a picture of the screen the square says where a pixel of the screen is."""
    metrics = {"width": 1200, "height": 800, "deviceScaleFactor": dense, "mobile": False}
    opened.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    try:
        press(opened, "0", "+", "+", "+", "+", "+")
        for zoom in (16, 8, 4, 2, 1):
            press(opened, Keys.DELETE)
            assert where(opened)[2] == zoom
            left, top, right, bottom = block_on_screen(opened, dense)
            assert (right - left, bottom - top) == (8 * zoom, 8 * zoom)
            x, y = int(left + 2.6 * zoom), int(top + 5.2 * zoom)
            click_at(opened, x, y, dense)
            (row,) = rows(opened)
            u, v = map(float, row.split(",")[2:])
            assert_close("click on a page", u, BLOCK[0] + (x + 0.5 - left) / zoom - 0.5)
            assert_close("click on a page", v, BLOCK[1] + (y + 0.5 - top) / zoom - 0.5)
            press(opened, "-")
    finally:
        opened.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_keys_alone_pick_move_remove_and_undo(opened: Any) -> None:
    """The cross begins in the middle of 64 by 48 pixels, 31.5, 23.5."""
    press(opened, Keys.ENTER)
    assert rows(opened) == ["0.png,mast,31.50,23.50"]
    press(opened, Keys.ARROW_RIGHT, Keys.ARROW_UP, Keys.ARROW_UP)
    assert rows(opened) == ["0.png,mast,31.60,23.30"]
    press(opened, Keys.PAGE_DOWN, "n")
    WebDriverWait(opened, 20).until(lambda one: where(one)[0] == 31.5)
    press(opened, Keys.ENTER)
    assert rows(opened)[1] == '1.png,"a ""b"", <c>",31.50,23.50'
    press(opened, Keys.DELETE)
    assert len(rows(opened)) == 1
    ActionChains(opened).key_down(Keys.CONTROL).send_keys("z").key_up(Keys.CONTROL).perform()
    assert len(rows(opened)) == 2


def test_a_reload_loses_nothing(opened: Any) -> None:
    press(opened, Keys.ENTER)
    before = rows(opened)
    opened.refresh()
    assert before
    WebDriverWait(ready(opened), 20).until(lambda one: rows(one) == before)
    assert opened.find_element(By.ID, "kept").text


def test_it_asks_for_nothing_and_names_stay_text(browser: Any, tmp_path: Path, page: bytes) -> None:
    shown = ready(load(forget(browser), tmp_path, page))
    browser.execute_script("localStorage.clear()")
    assert shown.get_log("browser") == []
    events = [json.loads(entry["message"])["message"] for entry in shown.get_log("performance")]
    sent = [one["params"] for one in events if one["method"] == "Network.requestWillBeSent"]
    asked = {one["request"]["url"] for one in sent}
    assert {url for url in asked if not url.startswith("data:")} == {shown.current_url}
    names = [
        one.text.removesuffix("\n●")
        for one in shown.find_elements(By.CSS_SELECTOR, "#landmarks button")
    ]
    assert names == list(LANDMARKS)
