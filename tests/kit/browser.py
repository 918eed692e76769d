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
