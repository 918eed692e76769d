"""Headless Chromium by its driver, for tests of pages.

Without a browser such tests are skipped, unless VOPD_REQUIRE_BROWSER is set: then they fail, so
that the project's own gate cannot pass without them.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-sync "
    "--disable-background-networking --disable-component-update --disable-dev-shm-usage"
)


def open_browser(folder: Path) -> Iterator[Any]:
    """Open a browser, of a fixture's scope.

    Args:
        folder: an empty one for its own files
    """
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    driver = shutil.which("chromedriver")
    if program is None or driver is None:
        if os.environ.get("VOPD_REQUIRE_BROWSER"):
            pytest.fail("no chromium or no chromedriver, and VOPD_REQUIRE_BROWSER is set")
        pytest.skip("no chromium or no chromedriver: Debian has chromium, chromium-driver")
    options = Options()
    options.binary_location = program
    for flag in FLAGS.split():
        options.add_argument(flag)
    options.add_argument(f"--user-data-dir={folder}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    opened = webdriver.Chrome(options=options, service=Service(driver))
    opened.set_window_size(1200, 900)
    yield opened
    opened.quit()


def load(browser: Any, folder: Path, page: bytes) -> Any:
    """Open a page from disk."""
    (folder / "page.html").write_bytes(page)
    browser.get((folder / "page.html").as_uri())
    return browser


def forget(browser: Any) -> Any:
    """The browser without what it and its own first page have logged and still ask for."""
    browser.get("about:blank")
    browser.get_log("browser"), browser.get_log("performance")
    return browser


SHOWN = """
  const shapes = (one) => {
    const runs = [];
    const walk = (parent) => {
      for (const element of parent.children) {
        const values = [...element.attributes].filter(({ name }) => !/^(class|href)$/.test(name));
        const look = [element.localName, ...element.classList].join(".");
        const text = element.children.length ? "" : element.textContent;
        const said = [...values.map(({ value }) => value), text].filter(Boolean).join(" ");
        if (runs.at(-1)?.[0] === look) runs.at(-1)[1].push(said);
        else runs.push([look, [said]]);
        if (element.children.length) walk(element);
      }
    };
    walk(one);
    return runs.map(([look, all]) => `${look} ${all.join("; ")}`);
  };
  const cells = (row) => [...row.cells].map((cell) => cell.textContent.trim()).join(" | ");
  const seen = (one) => !one.closest("[hidden]") && one.offsetParent !== null;
  return [...document.querySelectorAll(arguments[0])].filter(seen).flatMap((one) => {
    const name = `#${one.closest("[id]").id}`;
    if (one.localName === "svg")
      return [`${name} ${one.ariaLabel}`, one.getAttribute("viewBox"), ...shapes(one)];
    if (one.localName === "table") return [name, ...[...one.tBodies[0].rows].map((row) =>
      [row.className, row.ariaCurrent && "chosen", cells(row)].filter(Boolean).join(": "))];
    const state = [
      one.disabled && "disabled", one.ariaInvalid === "true" && "invalid",
      one.ariaPressed === "true" && "chosen",
    ].filter(Boolean);
    const parts = [one.value ?? "", one.max ?? "", one.ariaValueText ?? "", one.textContent.trim()];
    return [[name, ...state, ...new Set(parts)].filter((part) => part !== "").join(" ")];
  });
"""


def all_shown(browser: Any, what: str) -> list[str]:
    """Describe what is to be seen of a page: drawings by their shapes, tables, controls, texts.

    Shapes stand in the order in which they are drawn: kind and class, then attributes and text.

    Args:
        what: selector of drawings, tables, controls and texts
    """
    found: list[str] = browser.execute_script(SHOWN, what)
    return found


DRAWN = """
  const told = [], proto = CanvasRenderingContext2D.prototype, own = {}, path = [];
  const say = (pen, ...parts) => told.push([pen.canvas.id, ...parts.flat()]
    .map((one) => typeof one === "number" ? Math.round(one * 10) / 10 : one).join(" "));
  const record = {
    beginPath() { path.length = 0; },
    moveTo(...at) { path.push("M", ...at); },
    lineTo(...at) { path.push("L", ...at); },
    arc(...at) { path.push("O", ...at); },
    stroke() { say(this, this.strokeStyle, this.lineWidth, this.getLineDash(), path); },
    strokeText(...text) { say(this, this.strokeStyle, this.lineWidth, this.textAlign, text); },
    fillText(text, ...at) { say(this, this.fillStyle, this.font.split(" ")[0], text, at); },
    fillRect(...at) { say(this, this.fillStyle, at); },
    drawImage(image, ...at) { say(this, image.width, this.imageSmoothingEnabled, at); },
  };
  for (const name in record) {
    own[name] = proto[name];
    proto[name] = function (...given) {
      record[name].apply(this, given);
      return own[name].apply(this, given);
    };
  }
  try { draw(); } finally { Object.assign(proto, own); }
  return told;
"""


def drawn(browser: Any) -> list[str]:
    """Describe what the page of picks draws on its canvases: colour, width, path or text."""
    found: list[str] = browser.execute_script(DRAWN)
    return found


STYLES = """
  const drawing = ["fill", "stroke", "strokeWidth", "strokeDasharray", "fillOpacity", "opacity",
    "fontWeight", "paintOrder", "filter"];
  const text = ["color", "backgroundColor", "fontSize", "fontWeight", "textAlign", "whiteSpace",
    "position", "display", "overflowX", "maxHeight", "opacity", "borderLeftWidth", "columnCount"];
  const values = () => {
    const found = {};
    for (const one of document.querySelectorAll("body *:not(option, wbr)")) {
      const own = one.ownerSVGElement, state = one.matches("[aria-current] *") ? ["chosen"] : [];
      const photograph = own?.classList.contains("photo") ? ["photo"] : [];
      const name = [one.localName, ...one.classList, ...state, ...photograph].join(".");
      if (name in found) continue;
      const style = getComputedStyle(one);
      found[name] = (own ? drawing : text).map((key) => [key, style[key]]);
    }
    return found;
  };
  const sheets = [...document.styleSheets], found = values();
  sheets.forEach((sheet) => { sheet.disabled = true; });
  const plain = values();
  sheets.forEach((sheet) => { sheet.disabled = false; });
  const own = Object.entries(found).map(([name, all]) =>
    [name, all.filter(([, value], k) => plain[name][k][1] !== value)]);
  return Object.fromEntries(own.filter(([, all]) => all.length)
    .map(([name, all]) => [name, all.map((one) => one.join(" ")).join("; ")]));
"""


def styles(browser: Any) -> dict[str, str]:
    """Describe what the page's style sheet makes of each kind of element, and no browser's own."""
    found: dict[str, str] = browser.execute_script(STYLES)
    return found
