"""Write the page about a batch: a row for each source, with a link to its report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from urllib.parse import quote

from vopd.report.page_template import page_template, style_and_script
from vopd.report.tables import PageColumn

COLUMNS = (
    PageColumn("source", "the name of its outputs", True),
    PageColumn("status", "solved, not converged (some frame) or failed", True),
    PageColumn("frames", "of all its jobs"),
    PageColumn("attitudes", "frames with an attitude"),
    PageColumn("not_converged", "frames that did not converge"),
    PageColumn("flagged", "frames with any flag"),
    PageColumn("warnings", "about cards, files and frames"),
    PageColumn("flags", "frames with each flag", True),
    PageColumn("error", "why it failed", True),
)


class SourceRow(NamedTuple):
    """A source of a batch; `cells` are the columns after the first."""

    source: str
    page: str  # its report, as a relative address; empty where it has none
    cells: tuple[str, ...]


def source_row(source: str, page: str | None, *cells: object) -> SourceRow:
    """A row of the page.

    Args:
        source: the name of the source
        page: the file of its report, relative to the page; None where it has none
        cells: the values of the columns after the first
    """
    address = "" if page is None else "./" + quote(page.encode("utf-8", "surrogateescape"))
    return SourceRow(source, address, tuple(map(str, cells)))


def batch_page(rows: Sequence[SourceRow], totals: str, failed: int) -> bytes:
    """Make the page, in UTF-8; it needs no network.

    Args:
        rows: the sources, the worst first
        totals: a sentence about all
        failed: how many failed

    Raises:
        VopdError: where jinja2 is not installed
    """
    page = page_template("batch.html").render(
        rows=rows, totals=totals, failed=failed, columns=COLUMNS, **style_and_script()
    )
    return page.encode("utf-8", "replace")
