"""An HTML page, read: its tables, its ids, what it loads, and whether its tags are closed."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from typing import Any

VOID = {"meta", "link", "img", "source", "input", "br", "wbr"}


class Page(HTMLParser):
    """Tables as lists of rows of texts, ids, attributes that load, and whether tags are closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tables: dict[str, list[list[str]]] = {}
        self.ids: list[str] = []
        self.loads: list[str] = []
        self.scripts = 0
        self._open: list[str] = []
        self._rows: list[list[str]] = []
        self._cell = False
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if tag not in VOID:
            self._open.append(tag)
        self.ids += [given["id"]] if "id" in given else []
        self.loads += [given[name] for name in ("src", "href", "data", "action") if name in given]
        self.scripts += tag == "script" and "type" not in given
        assert not [name for name in given if name.startswith("on")]
        if tag == "table":
            self._rows = self.tables[given["id"]] = []
        elif tag == "tr":
            self._rows.append([])
        elif tag in ("td", "th"):
            self._rows[-1].append("")
            self._cell = True

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag
        if tag in ("td", "th"):
            self._cell = False

    def handle_data(self, data: str) -> None:
        if self._cell:
            self._rows[-1][-1] += data


def data_of(page: str) -> Any:
    """The data of a report for its script; numbers as the texts that they are written with."""
    (found,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    return json.loads(found, parse_float=str, parse_int=str)


def frame_columns(page: str) -> dict[str, list[str]]:
    """The table of frames of a report by columns, as texts."""
    found: dict[str, list[str]] = {}
    for one in data_of(page)["columns"]:
        values = one.get("values") or found[one["same"]]
        if "words" in one:
            values = [one["words"][int(k)] for k in values]
        found[one["name"]] = ["" if value is None else value for value in values]
    return found
