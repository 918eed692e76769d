"""The texts, links and cells of the page, from values that are given to its template by hand."""

from __future__ import annotations

import re
from functools import cache
from html import unescape
from typing import Any

import pytest

from tests.kit.html_page import Page
from vopd.estimate import About, Words
from vopd.report import (
    COLUMNS,
    CellTable,
    EmbeddedFigure,
    FlagRow,
    FrameRow,
    FrameTable,
    PageColumn,
    batch_page,
    page_template,
    source_row,
)

template = cache(page_template)

ABOUT = About("a.dat", words=Words(source="deck", no_fixes="none, the original's numbers"))
TABLE = CellTable([PageColumn("job", "its number"), PageColumn("a_title", "", True)], [])
FRAMES = FrameTable(
    [
        PageColumn("job", "its number"),
        PageColumn("frame", "number of the frame"),
        PageColumn("flags", "what is odd", True),
        PageColumn("half_width_95", "degrees"),
    ],
    [
        FrameRow("7", "outlier misfit", ["1", "7", "outlier:3;misfit:x y", "0.5"]),
        FrameRow("8", "", ["1", "8", "", "0.25"]),
        FrameRow("9", "jump", ["1", "9", "jump", "inf"]),
    ],
)
VALUES: dict[str, Any] = {
    "about": ABOUT, "sources": "a.dat, b.dat", "failed": False,
    "summary": {"Jobs": "2", "Time": "1 to 2 s"}, "messages": [], "figures": [], "no_figures": "",
    "left_out": "", "jobs": TABLE._replace(rows=[["1", "one"], ["2", "two"]]), "frames": FRAMES,
    "at_once": 2,
    "flags": [FlagRow("outlier", 1, "does not fit", "look"), FlagRow("jump", 0, "turns", "wait")],
    "landmarks": TABLE._replace(rows=[["28", "x<y"]]), "uncertainty": ["One.", "Two.", "Three."],
    "conventions": {"fixes": "none", "sigmas": "all"}, "style": "p{}", "script": "x()",
    "policy": "default-src 'none'",
}  # fmt: skip


def html(**changes: Any) -> str:
    return template("page.html").render(**(VALUES | changes))


def text(page: str, section: str = "") -> str:
    """What the page says, or one section of it, without the tags."""
    if section:
        (page,) = re.findall(rf'<section id="{section}">(.*?)</section>', page, re.S)
    said = re.sub(r"<(style|script|title)>.*?</\1>|<[^>]+>", " ", page, flags=re.S)
    return " ".join(unescape(said).split())


HEAD = "Skip to the table of frames Attitude report a.dat, b.dat"
LINKS = "Summary Figures Jobs Frames Flags Landmarks Uncertainty Conventions"
PLAIN = ABOUT._replace(words=Words())
FIXED = ABOUT._replace(fixes="earth (WGS 84)")
HEADS: dict[str, tuple[dict[str, Any], str]] = {
    "original": ({}, f"{HEAD} Fixes in force: none, the original's numbers. {LINKS}"),
    "nothing to fix": ({"about": PLAIN}, f"{HEAD} {LINKS}"),
    "corrected": (
        {"about": FIXED},
        f"{HEAD} Corrected run, not the original. Fixes in force: earth (WGS 84). {LINKS}",
    ),
    "failed": (
        {"about": PLAIN, "failed": True},
        f"{HEAD} A source failed. Its jobs before the error, and the other sources, are here; "
        f"warnings and errors say why. {LINKS}",
    ),
    "one job": (
        {"about": PLAIN, "jobs": TABLE._replace(rows=[["1", "one"]])},
        f"{HEAD} {LINKS.replace(' Jobs', '')}",
    ),
}


@pytest.mark.parametrize("name", HEADS)
def test_the_head(name: str) -> None:
    changes, expected = HEADS[name]
    page = html(**changes)
    assert text(page.split("<main>")[0]) == expected
    links = re.findall(r'href="#(\w+)"', page)
    assert set(links) <= set(Page(page).ids) and links[0] == "frames"
    sections = [one.lower() for one in expected.removeprefix(HEAD).split()[-8:] if one in LINKS]
    assert re.findall(r'<section id="(\w+)">', page) == sections
    assert re.findall(r'<li><a href="#(\w+)">', page) == sections
    assert ('href="#messages"' in page) == (name == "failed")
    assert "<title>Attitude report: a.dat, b.dat</title>" in page
    assert '<meta charset="utf-8">' in page and 'lang="en"' in page
    policy = "default-src &#39;none&#39;"
    assert f'<meta http-equiv="Content-Security-Policy" content="{policy}">' in page
    assert "<style>p{}</style>\n<script>x()</script>" in page


def test_the_summary_and_the_messages() -> None:
    none, some = html(), html(messages=["card 1:\n  odd", "<b>"])
    begin = "Summary Jobs 2 Time 1 to 2 s Warnings and errors"
    assert text(none, "summary") == f"{begin} None."
    assert text(some, "summary") == f"{begin} card 1: odd <b>"
    assert "<li><pre>card 1:\n  odd</pre></li><li><pre>&lt;b&gt;</pre></li>" in some
    assert "<dt>Jobs</dt><dd>2</dd><dt>Time</dt><dd>1 to 2 s</dd>" in none


def test_the_figures() -> None:
    figures = [EmbeddedFigure("attack", "A title", "A caption.", "data:x")]
    page = html(figures=figures, left_out="20 of 22 jobs")
    assert text(page, "figures") == (
        "Figures The figures show 20 of 22 jobs . For those of another job:".replace(" .", ".")
        + " vopd plot a.dat --job N -o FILE.png A caption."
    )
    assert '<img alt="A title" src="data:x">' in page and 'id="figure-attack"' in page
    assert 'aria-label="A title"' in page
    assert text(html(no_figures="no matplotlib"), "figures") == "Figures No figures: no matplotlib"
    assert text(html(figures=figures), "figures") == "Figures A caption."


def rows(page: str, table: str) -> list[list[str]]:
    return [[cell.strip() for cell in row] for row in Page(page).tables[f"{table}-table"]]


def headings(page: str, table: str) -> list[tuple[str, str, bool]]:
    """Every column: its name, what it is, and whether it is sorted as words."""
    (head,) = re.findall(rf'id="{table}-table".*?<thead>(.*?)</thead>', page, re.S)
    found = re.findall(r"<th([^>]*)><button([^>]*)>(.*?)</button></th>", head)
    return [
        (re.sub("<wbr>", "", name), (re.findall('title="(.*?)"', about) or [""])[0], "data-w" in th)
        for th, about, name in found
    ]


def test_the_table_of_frames() -> None:
    """Flags as one word each with the whole text beside; what is above `at_once` comes later."""
    page = html()
    head, *cells = rows(page, "frames")
    assert head == ["job", "frame", "flags", "half_width_95"]
    assert cells == [
        ["1", "7", "outlier:3 misfit:x y", "0.5"], ["1", "8", "", "0.25"], ["1", "9", "jump", "inf"]
    ]  # fmt: skip
    assert headings(page, "frames") == [
        ("job", "its number", False), ("frame", "number of the frame", False),
        ("flags", "what is odd", True), ("half_width_95", "degrees", False),
    ]  # fmt: skip
    assert "half_<wbr>width_<wbr>95" in page
    assert '<td class="flags" data-text="outlier:3;misfit:x y"><span>outlier:3</span> ' in page
    assert '<td class="flags" data-text=""></td>' in page
    assert '<th scope="row" class="n stays">8</th><td class="flags"' in page
    assert '<td class="n">0.25</td>' in page
    assert re.findall(r"<tr (data.*?)>", page) == [
        'data-flags="outlier misfit" data-frame="7"', 'data-flags="" data-frame="8"',
        'data-flags="jump" data-frame="9" class="later"',
    ]  # fmt: skip
    said = text(page, "frames")
    assert "Flag all frames any flag no flag outlier (1) Frame job" in said.replace("Frames ", "")
    assert re.findall(r'<option value="(.*?)">', page) == ["", "*", "-", "outlier"]
    assert said.endswith(
        "Show all What the columns are job its number frame number of the frame flags what is odd "
        "half_width_95 degrees"
    )
    assert '<form class="controls" autocomplete="off" hidden>' in page
    assert '<button id="more" type="button" hidden>' in page


def test_the_other_tables() -> None:
    page = html()
    assert rows(page, "jobs") == [["job", "a_title"], ["1", "one"], ["2", "two"]]
    assert rows(page, "landmarks") == [["job", "a_title"], ["28", "x<y"]]
    assert headings(page, "jobs") == [("job", "its number", False), ("a_title", "", True)]
    assert '<th scope="row" class="n">28</th><td>x&lt;y</td>' in page
    assert rows(page, "flags") == [
        ["flag", "frames", "meaning", "what to do"], ["outlier", "1", "does not fit", "look"],
        ["jump", "0", "turns", "wait"],
    ]  # fmt: skip
    assert [words for _, _, words in headings(page, "flags")] == [True, False, True, True]
    assert '<code>outlier</code></th><td class="n">1</td><td>does not fit</td>' in page
    captions = re.findall(r"<caption>(.*?)</caption>", page)
    assert captions == ["Jobs", "Frames", "Flags", "Residuals by landmark"]
    assert re.findall(r'<div class="scroll"[^>]*aria-label="(.*?)"', page) == captions
    assert page.count('class="sortable"') == 4
    assert text(page, "uncertainty") == "Uncertainty One. Two. Three."
    assert text(page, "conventions") == "Conventions fixes none sigmas all"


BATCH = [
    ("source", "the name of its outputs", True),
    ("status", "solved, not converged (some frame) or failed", True),
    ("frames", "of all its jobs", False),
    ("attitudes", "frames with an attitude", False),
    ("not_converged", "frames that did not converge", False),
    ("flagged", "frames with any flag", False),
    ("warnings", "about cards, files and frames", False),
    ("flags", "frames with each flag", True),
    ("error", "why it failed", True),
]


def test_the_page_of_a_batch() -> None:
    many = [source_row(f"s{k}", None, "solved", 1, 2, 3, 4, 5, "a:1", "") for k in range(300)]
    page = batch_page([source_row("<", "", "x", 1, 2, 3, 4, 5, "", "\udcff"), *many], "All.", 2)
    said = page.decode()
    assert [tuple(column) for column in COLUMNS] == BATCH == headings(said, "sources")
    assert text(said).startswith(
        "Batch All. 2 of 301 sources failed. The column error says why. Sources The worst are "
        "first: those that failed, then those with frames that did not converge, then by frames "
        "with a flag. Sources source status"
    )
    first, *others = rows(said, "sources")[1:]
    assert first == ["<", "x", "1", "2", "3", "4", "5", "", "?"] and len(others) == 300
    assert '<a href="./">&lt;</a>' in said and "<a href=" not in said.split("s0</th>")[1]
    assert (
        '<td>solved</td><td class="n">1</td><td class="n">2</td><td class="n">3</td>'
        '<td class="n">4</td><td class="n">5</td><td>a:1</td><td></td>'
    ) in said
    assert '<meta charset="utf-8">' in said and "default-src &#39;none&#39;" in said
