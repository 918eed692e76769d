"""The page of a batch: its rows, their links, and what it says about sources that failed."""

from __future__ import annotations

from urllib.parse import unquote, urljoin

import pytest

from tests.kit.html_page import Page
from vopd.report import COLUMNS, batch_page, source_row

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
    row = source_row("one", file, "solved", 3, 2, None)
    assert row.page == ADDRESSES[file]
    assert urljoin("file:///batch/index.html", row.page).startswith("file:///batch/")
    if not file.startswith("//"):
        assert unquote(row.page, errors="surrogateescape") == f"./{file}"
    assert (row.source, row.cells) == ("one", ("solved", "3", "2", "None"))


def test_a_source_without_a_report_has_no_link() -> None:
    assert source_row("one", None).page == ""


ROWS = [
    source_row("lost", None, "failed", 0, 0, 0, 0, 0, "", "<b>no such file</b>"),
    source_row("a&b", "a&b.html", "not converged", 30, 29, 1, 9, 2, "misfit:9", ""),
    source_row("two", None, "solved", 4, 4, 0, 10, 0, "outlier:10", ""),
]


@pytest.mark.parametrize("failed", [0, 1, 2])
def test_the_page(failed: int) -> None:
    """Every cell is text, in the order given; how many failed is said where any did."""
    text = batch_page(ROWS, "3 sources: 1 failed & 2 <done>", failed).decode()
    page = Page(text)
    (table,) = page.tables.values()
    assert table[0] == [column.name for column in COLUMNS]
    assert table[1:] == [[row.source, *row.cells] for row in ROWS]
    assert [one for one in page.loads if not one.startswith("data:")] == ["./a%26b.html"]
    assert "<p>3 sources: 1 failed &amp; 2 &lt;done&gt;</p>" in text
    assert (f"<strong>{failed} of 3 sources failed.</strong>" in text) == (failed > 0)
    assert ("failed.</strong>" in text) == (failed > 0)
    assert "<title>Batch of 3 sources</title>" in text
