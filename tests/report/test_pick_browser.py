"""The page of picks in a browser: clicks, keys, what it keeps and what it saves."""

from __future__ import annotations

import base64
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from tests.approved.texts import assert_approved, refused
from tests.kit.browser import all_shown, drawn, forget, load
from tests.kit.command import DECKS
from tests.kit.random_flights import SIZE, lenses, random_frame
from tests.tolerances import assert_close
from vopd.cards.head import read_head
from vopd.cards.read import read_jobs
from vopd.findings import VopdError
from vopd.flight.project.directions import plain_lenses
from vopd.flight.solve.rotations import solve_rotations
from vopd.geometry.lenses import Lenses, project
from vopd.report import pick
from vopd.report.pick import PageContent, Predicted, pick_page
from vopd.video import open_frames

BLOCK = (30, 20)  # first pixel of a white square of 8 pixels
LANDMARKS = ("mast", 'a "b", <c>')


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("images")
    for k in range(2):
        own = np.full((48, 64, 3), 60, np.uint8)
        own[20:28, 30 + 8 * k : 38 + 8 * k] = 255
        Image.fromarray(own).save(folder / f"{k}.png")
    return pick_page(open_frames([str(folder)]), [0, 1], PageContent(LANDMARKS))


@pytest.fixture
def opened(browser: Any, tmp_path: Path, page: bytes) -> Any:
    shown = load(browser, tmp_path, page)
    browser.execute_script("localStorage.clear()")
    browser.refresh()
    return ready(shown)


def ready(browser: Any, zoom: float = 1.0) -> Any:
    WebDriverWait(browser, 20).until(lambda one: where(one)[2] > zoom)
    return browser


def opened_with(browser: Any, kept: str) -> Any:
    """The page opened anew with something in the browser's storage.

    A busy browser may open it before another process of its own has stored that: it is done again.
    """
    for _ in range(10):
        browser.execute_script("localStorage.setItem(place, arguments[0])", kept)
        browser.refresh()
        if ready(browser).execute_script("return localStorage.getItem(place)") == kept:
            break
    return browser


def wait_for_picture(browser: Any) -> None:
    WebDriverWait(browser, 20).until(lambda one: one.execute_script("return picture !== null"))


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
        wide, high, *drawn = opened.execute_script("""
          const box = canvas.parentElement.getBoundingClientRect();
          return [box.width, box.height, canvas.width, canvas.height, loupe.width, loupe.height];
        """)
        assert drawn[:2] == [int(wide * dense), int(high * dense)]  # pixels of the screen
        assert drawn[2] == drawn[3] > 100 * dense
        for zoom in (16, 8, 4, 2, 1):
            if zoom in (16, 1) or dense == 1.5:  # whole numbers are as the others are
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


def test_one_frame_is_decoded_at_a_time(opened: Any) -> None:
    """Forty frames of 12 megapixels would take 2 GB."""
    opened.execute_script("""
      window.open_now = 1; window.most = 1;
      const make = createImageBitmap, close = ImageBitmap.prototype.close;
      window.createImageBitmap = (blob) => make(blob).then((made) => {
        window.most = Math.max(window.most, ++window.open_now);
        return made;
      });
      ImageBitmap.prototype.close = function () { window.open_now -= 1; close.call(this); };
    """)
    for key in (Keys.PAGE_DOWN, Keys.PAGE_UP, Keys.PAGE_DOWN):
        press(opened, key)
        wait_for_picture(opened)
    assert opened.execute_script("return [open_now, most]") == [1, 1]
    opened.execute_script("choose(0); choose(1); choose(0)")  # the first two come too late
    wait_for_picture(opened)
    WebDriverWait(opened, 20).until(lambda one: one.execute_script("return open_now") == 1)
    assert opened.execute_script("return picture.width") == 64


def test_the_loupe_shows_pixels_and_a_cross(opened: Any) -> None:
    """Pixels as squares; the arms of a cross lead away from its middle, which stays free."""
    assert opened.execute_script("""
      draw();
      return [loupe.getContext("2d").imageSmoothingEnabled, loupe.width > 0];
    """) == [False, True]
    arms = opened.execute_script("""
      const arms = [];
      const pen = { beginPath() {}, stroke() {}, moveTo: (...at) => arms.push([at]),
        lineTo: (...at) => arms.at(-1).push(at) };
      mark(pen, 100, 50, 9, "red");
      return arms;
    """)
    ways = [(1, 0), (-1, 0), (0, 1), (0, -1)]
    assert arms == [[[100 + n * x, 50 + n * y] for n in (2, 9)] for x, y in ways]


def test_of_several_readings_the_last_is_removed(opened: Any) -> None:
    opened.execute_script("put(10, 11); put(12, 14, true); put(20, 30, true)")
    assert rows(opened) == ["0.png,mast,10.00,11.00", "0.png,mast,12.00,14.00",
                            "0.png,mast,20.00,30.00"]  # fmt: skip
    press(opened, Keys.DELETE)
    assert rows(opened) == ["0.png,mast,10.00,11.00", "0.png,mast,12.00,14.00"]


def test_a_page_that_no_browser_holds_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After the frame that is too many, the second of 2.2 MB; 3 MB for the usual 400."""
    noise = np.random.default_rng(1).integers(0, 256, (900, 900, 3), np.uint8)
    for k in range(3):
        Image.fromarray(noise).save(tmp_path / f"{k}.png")
    monkeypatch.setattr(pick, "MOST_BYTES", 3_000_000)
    with refused(VopdError, parts=[tmp_path.as_posix()]):
        pick_page(open_frames([str(tmp_path)]), [0, 1, 2], PageContent(LANDMARKS))


@pytest.mark.parametrize(("wanted", "quality"), [(10_000_000, 92), (180_000, 85), (60_000, 75)])
def test_a_page_of_many_frames_has_a_lower_quality(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, wanted: int, quality: int
) -> None:
    """Two frames of noise, 190 by 190 pixels; a page is made to be below 250 MB."""
    assert pick.WANTED_BYTES < 250_000_000
    noise = np.random.default_rng(1).integers(0, 256, (190, 190, 3), np.uint8)
    for k in range(2):
        Image.fromarray(noise).save(tmp_path / f"{k}.png")
    monkeypatch.setattr(pick, "WANTED_BYTES", wanted)
    made = pick_page(open_frames([str(tmp_path)]), [0, 1], PageContent(LANDMARKS))
    own = io.BytesIO()
    Image.fromarray(noise).save(own, "JPEG", quality=quality, subsampling=0)
    assert made.count(base64.b64encode(own.getvalue())) == 2


def test_keys_alone_pick_move_remove_and_undo(opened: Any) -> None:
    """The cross begins in the middle of 64 by 48 pixels, 31.5, 23.5."""
    press(opened, Keys.ENTER)
    assert rows(opened) == ["0.png,mast,31.50,23.50"]
    press(opened, Keys.ARROW_RIGHT, Keys.ARROW_UP, Keys.ARROW_UP)
    assert rows(opened) == ["0.png,mast,31.60,23.30"]
    press(opened, Keys.PAGE_DOWN, "N")
    WebDriverWait(opened, 20).until(lambda one: where(one)[0] == 31.5)
    press(opened, Keys.ENTER)
    assert rows(opened)[1] == '1.png,"a ""b"", <c>",31.50,23.50'
    press(opened, Keys.DELETE)
    assert len(rows(opened)) == 1
    ActionChains(opened).key_down(Keys.CONTROL).send_keys("z").key_up(Keys.CONTROL).perform()
    assert len(rows(opened)) == 2


@pytest.mark.parametrize("held", ["metaKey", "altKey"])
def test_keys_that_are_the_browser_s_own_move_nothing(opened: Any, held: str) -> None:
    """On a Mac Command and Left is the page before, and Control stands for nothing there."""
    press(opened, Keys.ENTER)
    before = rows(opened)
    event = "new KeyboardEvent('keydown', {key: arguments[0], [arguments[1]]: true, bubbles: true, "
    event += "cancelable: true})"
    for key in ("ArrowLeft", "ArrowUp", "Enter", "Delete", "PageDown", "h"):
        sent = f"const one = {event}; canvas.dispatchEvent(one); return one.defaultPrevented"
        taken = opened.execute_script(sent, key, held)
        assert not taken and rows(opened) == before
    opened.execute_script(f"canvas.dispatchEvent({event})", "z", held)
    assert len(rows(opened)) == (held == "altKey")  # Command Z is undo


def test_a_reload_loses_nothing(opened: Any) -> None:
    press(opened, Keys.ENTER)
    before = rows(opened)
    opened.refresh()
    assert before
    WebDriverWait(ready(opened), 20).until(lambda one: rows(one) == before)
    assert opened.find_element(By.ID, "kept").text


def test_names_of_the_project_join_those_that_were_kept(opened: Any) -> None:
    """As where a landmark was added to the project since the page was used."""
    kept = {"names": ["mast", "old"], "picks": [], "hidden": [], "frame": 0, "landmark": 0}
    opened_with(opened, json.dumps(kept))
    assert opened.execute_script("return names") == [*LANDMARKS, "old"]


def test_the_landmark_that_was_chosen_is_known_by_its_name(opened: Any) -> None:
    """It was the first of two then, and is the third now."""
    kept = {"names": ["old", "mast"], "picks": [], "hidden": [], "frame": 0, "landmark": 0}
    opened_with(opened, json.dumps(kept))
    assert opened.execute_script("return names[landmark]") == "old"


@pytest.mark.parametrize(
    "kept",
    [
        "{", "7", '"text"', "[]", '{"picks": 3}',
        '{"names": ["mast"], "picks": {}, "hidden": [], "frame": 0, "landmark": 0}',
        '{"names": [5], "picks": [], "hidden": [], "frame": 0, "landmark": 0}',
        '{"names": ["mast"], "picks": [null], "hidden": [], "frame": 0, "landmark": 0}',
        '{"names": ["mast"], "picks": [{"frame": 0, "landmark": "mast"}], "hidden": [], '
        '"frame": 0, "landmark": 0}',
        '{"names": ["mast"], "picks": [], "hidden": [{"frame": 99, "landmark": "mast"}], '
        '"frame": 0, "landmark": 0}',
        '{"names": ["mast"], "picks": [], "hidden": [], "frame": 99, "landmark": 0}',
    ],
)  # fmt: skip
def test_damaged_storage_is_left_aside(opened: Any, kept: str) -> None:
    """The page starts as it was made, and keeps what is picked then."""
    before = opened.execute_script("return [names, picks, hidden, frame, landmark]")
    wait_for_picture(opened_with(opened, kept))
    assert opened.execute_script("return [names, picks, hidden, frame, landmark]") == before
    press(opened, Keys.ENTER)
    assert len(rows(opened)) == 1


def test_nothing_is_picked_before_the_image_is_there(opened: Any) -> None:
    opened.execute_script("choose(1); put(5, 5)")
    assert rows(opened) == []
    wait_for_picture(opened)
    opened.execute_script("put(5, 5)")
    assert rows(opened) == ["1.png,mast,5.00,5.00"]


def test_keys_of_the_browser_stay_its_own(opened: Any) -> None:
    """Alt and Left is the page before, Ctrl and + its size; a locked Ctrl Z is one, too."""
    press(opened, Keys.ENTER)
    before, zoom = rows(opened), where(opened)[2]
    pressed = """
      return arguments[0].map(([key, more]) => !canvas.dispatchEvent(
        new KeyboardEvent("keydown", {key, bubbles: true, cancelable: true, ...more})))
    """
    own = [["ArrowLeft", {"altKey": True}], *([key, {"ctrlKey": True}] for key in "+-0")]
    assert opened.execute_script(pressed, own) == [False] * 4
    assert rows(opened) == before and where(opened)[2] == zoom
    assert opened.execute_script(pressed, [["Z", {"ctrlKey": True}]]) == [True]
    assert rows(opened) == []


def test_two_fingers_zoom_and_pick_nothing(opened: Any) -> None:
    """Their distance grows from 100 to 160 px; one that the system takes away ends the drag."""
    script = """
      const box = canvas.getBoundingClientRect(), [x, y] = [box.left + 300, box.top + 300];
      canvas.setPointerCapture = () => {};
      return arguments[0].map(([kind, pointerId, away]) => {
        const given = {pointerId, clientX: x + away, clientY: y, button: 0};
        canvas.dispatchEvent(new PointerEvent("pointer" + kind, given));
        return view.scale;
      });
    """
    down = [["down", 1, 0], ["down", 2, 100]]
    scale = opened.execute_script(script, [*down, ["move", 2, 140], ["move", 2, 160]])
    assert scale[0] == scale[1] == scale[2] < scale[3]
    narrow = opened.execute_script(script, [["move", 2, 100], ["up", 2, 100], ["up", 1, 0]])
    assert narrow[0] < scale[3] and rows(opened) == []
    opened.execute_script(script, [["down", 1, 0], ["cancel", 1, 0]])
    place = opened.execute_script("return view.x")
    opened.execute_script(script, [["move", 1, 50]])
    assert opened.execute_script("return view.x") == place and rows(opened) == []


def test_a_wheel_that_goes_sideways_does_not_zoom(opened: Any) -> None:
    script = """
      const turn = (deltaX, deltaY) => {
        canvas.dispatchEvent(new WheelEvent("wheel", {deltaX, deltaY, cancelable: true}));
        return view.scale;
      };
      return [view.scale, turn(80, 0), turn(0, 100)];
    """
    before, sideways, out = opened.execute_script(script)
    assert sideways == before > out


def test_letters_in_a_field_are_no_commands_and_the_hidden_is_not_asked_for(opened: Any) -> None:
    opened.find_element(By.ID, "name").send_keys("hnp", Keys.ENTER)
    assert opened.execute_script("return [names, hidden]") == [[*LANDMARKS, "hnp"], []]
    press(opened, "n", "n", "h")  # mast, the next, which is hidden here
    press(opened, "p", "n")
    script = "return document.querySelector('[aria-pressed=true]').firstChild.textContent"
    assert opened.execute_script(script) == "hnp"


def test_a_pick_stays_in_its_frame_and_in_its_place_when_enlarged(opened: Any) -> None:
    """The frame's edge is half a pixel beyond the centre of its first; the loupe makes way."""
    opened.execute_script("put(-3, 2)")
    assert rows(opened) == ["0.png,mast,-0.50,2.00"]
    opened.execute_script("put(50, 10)")
    place = "return on(...cross)"
    press(opened, "0")
    before, scale = opened.execute_script(place), where(opened)[2]
    press(opened, "-")
    assert where(opened)[2] < scale
    assert_close("corner on a screen", opened.execute_script(place), before)
    script = """
      cross = [(canvas.width - 20 - view.x) / view.scale, (20 - view.y) / view.scale];
      draw();
      return [loupe.getBoundingClientRect().left, canvas.getBoundingClientRect().left];
    """
    loupe, canvas = opened.execute_script(script)
    assert 0.0 <= loupe - canvas < 20.0


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


def test_a_name_that_begins_as_a_comment_is_quoted(browser: Any, tmp_path: Path) -> None:
    Image.new("L", (64, 48), 90).save(tmp_path / "1.png")
    content = PageContent(("#1",), [("1.png", "#1", 3.0, 4.0)])
    page = pick_page(open_frames([str(tmp_path / "1.png")]), [0], content)
    ready(load(browser, tmp_path, page), 0.0)
    assert rows(browser) == ['1.png,"#1",3.00,4.00']


CASES = ("cases_1_2_3", "case1")
SIX = ("mast", "church", "tower", "well", "bridge", "corner")


def text(browser: Any, element: str) -> str:
    return str(browser.find_element(By.ID, element).text)


def test_the_rotation_is_that_of_a_solve_with_the_position_fixed(
    browser: Any, tmp_path: Path
) -> None:
    """A lens of every kind, a frame each, picks 1 px off; the sixth landmark is predicted."""
    rng = np.random.default_rng(29)
    each = tuple(lenses().values())
    seen = [random_frame(rng, lens, 6, 1.0) for lens in each]
    for k in range(len(each)):
        Image.new("L", SIZE, 90).save(tmp_path / f"{k}.png")
    frames = open_frames([str(tmp_path)])
    lens = Lenses.join(each, np.arange(len(each)))
    direction = np.array([one.direction for one in seen])
    by = Predicted(SIX, direction, *plain_lenses(lens, len(each)), 1.0, "")
    clicks = [
        (f"{k}.png", name, *one.pixel[m].tolist())
        for k, one in enumerate(seen)
        for m, name in enumerate(SIX[:5])
    ]
    places = [("3.png", "corner", "why", None), ("1.png", "corner", "why", (99.5, 44.0))]
    content = PageContent(SIX, clicks, [("4.png", "corner")], predicted=by, places=places)
    load(browser, tmp_path, pick_page(frames, range(len(each)), content))
    browser.execute_script("localStorage.clear()")
    browser.refresh()
    ready(browser, 0.0)
    assert browser.execute_script("return [frame, names[landmark]]") == [3, "corner"]
    browser.execute_script("choose(0); select(0)")
    wait_for_picture(browser)
    frame = np.repeat(np.arange(len(each)), 5)
    solved = solve_rotations(
        lens, len(each), frame, np.concatenate([one.pixel[:5] for one in seen]),
        np.ones(len(frame)), np.concatenate([one.direction[:5] for one in seen]),
        np.ones(len(frame), bool),
    )  # fmt: skip
    for k, one in enumerate(seen):
        own, place, off = browser.execute_script(
            f"const [one] = predict({k}); return [one.rotation, one.places.get('corner'), one.off]"
        )
        turn = Rotation.from_matrix(np.array(own) @ solved.rotation[k].T).as_rotvec(degrees=True)
        assert_close("rotation on a page", turn, 0.0)
        expected = project(each[k], one.direction @ solved.rotation[k].T).pixel
        assert_close("landmark predicted on a page", place, expected[5])
        sum_of_squares = float(((one.pixel[:5] - expected[:5]) ** 2).sum())
        assert_close("landmark predicted on a page", off, np.sqrt(sum_of_squares / 7))

    # a place that is predicted is told from a pick by more than its colour
    assert browser.execute_script("""
      const dashes = [], make = CanvasRenderingContext2D.prototype.setLineDash;
      CanvasRenderingContext2D.prototype.setLineDash = function (one) {
        dashes.push(one.length);
        make.call(this, one);
      };
      draw();
      CanvasRenderingContext2D.prototype.setLineDash = make;
      return dashes;
    """) == [2, 0]  # fmt: skip

    # an exchange is named, and undone by its button
    assert "rotation alone fitted to 5 landmarks" in text(browser, "fit")
    before = rows(browser)
    browser.execute_script(
        "change(picks.map(one => one.frame || one.landmark !== 'mast' && one.landmark !== 'well' "
        "? one : { ...one, landmark: one.landmark === 'mast' ? 'well' : 'mast' }))"
    )
    assert text(browser, "exchange") in ("exchange mast and well", "exchange well and mast")
    assert "!" in browser.find_element(By.ID, "landmarks").text
    browser.find_element(By.ID, "exchange").click()
    assert rows(browser) == before
    assert not browser.find_element(By.ID, "exchange").is_displayed()

    # the next landmark without a pick, the cross where it is predicted; a second reading; hidden
    press(browser, "n")
    u, v = browser.execute_script("return seen.places.get('corner')")
    assert_close("click on a page", where(browser)[:2], (u, v))
    press(browser, Keys.ENTER)
    press(browser, Keys.ARROW_RIGHT)
    ActionChains(browser).key_down(Keys.SHIFT).send_keys(Keys.ENTER).key_up(Keys.SHIFT).perform()
    press(browser, Keys.ARROW_LEFT, Keys.ARROW_LEFT)
    two = [float(row.split(",")[2]) for row in rows(browser) if row.startswith("0.png,corner")]
    assert_close("click on a page", two, (u + 0.1, u - 0.1))
    assert "± .10 px" in browser.find_element(By.ID, "landmarks").text
    press(browser, Keys.PAGE_DOWN)
    wait_for_picture(browser)
    browser.execute_script(
        "const kept = picks; picks = []; seen = null; aim(); picks = kept; show()"
    )
    assert_close("click on a page", where(browser)[:2], (99.5, 44.0))
    press(browser, "h", "n")
    assert browser.execute_script("return names[landmark]") == "mast"
    saved = browser.execute_script("return document.getElementById('csv').value")
    assert [line for line in saved.splitlines() if "hidden" in line] == [
        "# hidden: 4.png,corner",
        "# hidden: 1.png,corner",
    ]
    browser.refresh()
    wait_for_picture(browser)
    assert browser.execute_script("return document.getElementById('csv').value") == saved

    # every sentence about the fit
    sentences = browser.execute_script("""
      const swap = { pair: ["mast", "well"], off: 0.5 }, said = [];
      for (const [count, other] of [[0, null], [2, null], [5, null], [5, swap], [0, swap]]) {
        [seen, exchange] = [count ? { count, off: 2 } : null, other];
        said.push(told());
      }
      data.leftOut = "refraction";
      seen = { count: 2, off: 0 };
      said.push(told());
      data.frames[frame].to = data.frames[frame].to.map(() => null);
      said.push(told());
      data.sighted = [];
      said.push(told());
      data.unpredicted = "there is no lens";
      said.push(told());
      seen = null;  // what is drawn later needs the places of a fit
      return said;
    """)
    assert_approved(sentences)
    assert browser.get_log("browser") == []


def test_a_film_on_cards(browser: Any, tmp_path: Path) -> None:
    """Clicks at the readings of a deck give its jobs again: stacked ones, and of a film unread."""
    stacked, alone = ((DECKS / f"appendix_h/{one}.dat").read_bytes() for one in CASES)
    job = next(read_jobs(io.BytesIO(stacked), "deck"))
    inch, size, readings = 0.01, (1460, 1060), job.readings
    Image.new("L", size, 90).save(tmp_path / "1.png")
    points = np.concatenate([readings.fiducial_in[0], readings.points.landmark_in])
    pixel = np.array(size) - 1.0 - points / inch
    whole, head = read_head(stacked, "deck"), read_head(alone, "deck")
    marks = [*(f"fiducial {k}" for k in range(1, 5)), *whole.landmarks]
    clicks = [("1.png", marks[k], *uv) for k in range(7) for uv in pixel[k].tolist()]
    control = [*head.before, "    3         2", *head.after]  # group 5 without frames
    unread = read_head("\n".join(control).encode(), "deck")
    for expected, deck in ((stacked, whole), (alone, unread)):
        deck_of = {**deck._asdict(), "inch": inch}
        content = PageContent(marks, clicks, deck=deck_of, film_number=readings.frame.tolist())
        page = pick_page(open_frames([str(tmp_path / "1.png")]), [0], content)
        load(browser, tmp_path, page)
        found = browser.execute_script("return cards().text").encode()
        assert [*read_jobs(io.BytesIO(found), "page")] == [*read_jobs(io.BytesIO(expected), "deck")]
        assert browser.execute_script("return cards().missing") == []
    wait_for_picture(browser)
    assert not browser.find_element(By.ID, "add").is_displayed()
    press(browser, Keys.ENTER)
    assert "has its three readings" in text(browser, "kept")
    press(browser, Keys.DELETE)
    assert text(browser, "fit") == "1.png: fiducial 1 has 2 of 3 readings"
    press(browser, Keys.ENTER)
    assert len(browser.execute_script("return cards().text").splitlines()) == len(
        alone.splitlines()
    )


# Everything that is drawn and said, step by step

STATE = "#places button, #landmarks button, #fit, #exchange, #kept, #csv, #save, #where, #frame"
STEPS = (
    "select(0); put(cross[0] + 1, cross[1], true); put(cross[0], cross[1] - 3, true)",
    "repair(); select(4)",
    "hide(); ask()",
    "zoom(1); zoom(1); select(1)",
    "remove(); zoom(-1)",
    "undo(); undo(); fit()",
    "part('name').value = ' new, one '; part('add').requestSubmit(); put(900, 400)",
    "change(picks.filter((one) => one.landmark === 'mast'))",
    "choose(1)",
    "select(3); put(1500, 300); select(-1)",
    "data.sighted = []; data.unpredicted = 'no lens'; picks = []; show()",
)


def test_what_is_drawn_and_said(browser: Any, tmp_path: Path) -> None:
    """Two frames with a lens of four coefficients; picks of which two are exchanged, and others."""
    rng, lens = np.random.default_rng(7), lenses()["brown"]
    seen = [random_frame(rng, lens, 6, 0.3) for _ in range(2)]
    for k in range(2):
        Image.new("L", SIZE, 90).save(tmp_path / f"{k}.png")
    both = Lenses.join((lens, lens), np.arange(2))
    by = Predicted(SIX, np.array([one.direction for one in seen]), *plain_lenses(both, 2), 0.5, "x")
    swapped = [("0.png", SIX[k], *seen[0].pixel[m].tolist()) for k, m in enumerate((0, 2, 1, 3))]
    clicks = [*swapped, ("9.png", "mast", 1.0, 2.0)]
    places = [("0.png", "corner", "the first", (99.5, 44.0)), ("1.png", "mast", "the next", None)]
    content = PageContent(
        SIX, clicks, [("1.png", "bridge")], "# head", predicted=by, places=places,
        name=["0.png", "b, c"],
    )  # fmt: skip
    load(browser, tmp_path, pick_page(open_frames([str(tmp_path)]), [0, 1], content, "mine.csv"))
    browser.execute_script("localStorage.clear()")
    browser.refresh()
    wait_for_picture(browser)
    browser.execute_script("""
      canvas.parentElement.style.cssText = "width: 640px; height: 400px; flex: none";
      fit();
    """)
    for step in ("", *STEPS):
        browser.execute_script(step)
        wait_for_picture(browser)
        assert_approved([*all_shown(browser, STATE), *drawn(browser)])
