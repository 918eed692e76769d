"""One listing against another: page by page, line by line, field by field.

Text must be equal but for trailing blanks; numbers may differ as far as
`vopd.compare.tolerances` says. EXPECTED may be the transcript of a damaged
print: there a field of nothing but `?` is not legible and not compared, and a
line that is a single `?` stands for any one line. In ACTUAL a `?` is text.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from typing import Literal

from vopd.compare.align import align
from vopd.compare.difference import Difference
from vopd.compare.fields import agree, off_by, units_allowed
from vopd.compare.line_kinds import ILLEGIBLE, Item, Page, frames, recognise, split_pages
from vopd.compare.pairing_cost import common_kind, line_cost, page_cost
from vopd.listing.line_formats import Line

_PagePair = tuple[Page | None, Page | None]


@dataclass
class Tally:
    """What was looked at: pages of EXPECTED, fields compared, fields not legible."""

    pages: int = 0
    fields_compared: int = 0
    fields_illegible: int = 0


@dataclass
class Comparison(Tally):
    """All differences, in the order of the listings, and what was looked at."""

    differences: tuple[Difference, ...] = ()


def compare(expected_text: str, actual_text: str, units: float | Decimal | str = 1.0) -> Comparison:
    """Compare two listings given as text.

    A number may differ by `units` (0 or more) units of its last printed digit;
    0 asks for identical text. Raises VopdError for any other `units`.
    """
    result = Comparison()
    result.differences = tuple(find_differences(expected_text, actual_text, units, result))
    return result


def find_differences(
    expected_text: str, actual_text: str, units: float | Decimal | str, tally: Tally
) -> Iterator[Difference]:
    """The differences one by one, as `compare` collects them; counts into `tally` meanwhile."""
    allowed = units_allowed(units)
    pages = align(split_pages(expected_text), split_pages(actual_text), page_cost)
    for expected, actual in _past_ejects(pages):
        tally.pages += expected is not None
        if expected is not None and actual is not None:
            yield from _compare_pages(expected, actual, allowed, tally)
        elif expected is not None:
            yield _lone_page("missing page", expected)
        elif actual is not None:
            yield _lone_page("extra page", actual)


def _past_ejects(pairs: Iterable[_PagePair]) -> list[_PagePair]:
    """Illegible lines may stand for page ejects, so for pages that EXPECTED seems not to have."""
    joined: list[_PagePair] = []
    for expected, actual in pairs:
        if joined and not expected and _has_room(*joined[-1], actual):
            page, before = joined.pop()
            joined.append((page, _one_page(before, actual)))
            continue
        while joined and not joined[-1][0] and _has_room(expected, actual, joined[-1][1]):
            actual = _one_page(joined.pop()[1], actual)
        joined.append((expected, actual))
    return joined


def _has_room(expected: Page | None, actual: Page | None, more: Page | None) -> bool:
    """Whether illegible lines are left over for most of one more page of ACTUAL."""
    if not expected or not actual or not more or ILLEGIBLE not in expected.lines:
        return False
    return 2 * (len(expected.lines) - len(actual.lines)) >= len(more.lines)


def _one_page(first: Page | None, second: Page | None) -> Page | None:
    if not first or not second:
        return first or second
    return Page(first.number, first.first, first.lines + second.lines)


def _lone_page(kind: Literal["missing page", "extra page"], page: Page) -> Difference:
    text = "\n".join(page.lines)
    if kind == "missing page":
        return Difference(kind, page.number, page.key or "", page.first, None, text, "")
    return Difference(kind, page.number, page.key or "", None, page.first, "", text)


def _compare_pages(
    expected: Page, actual: Page, units: Decimal, tally: Tally
) -> Iterator[Difference]:
    kinds = recognise(expected.lines, damaged=True)
    if expected.lines == actual.lines and not any(ILLEGIBLE in text for text in expected.lines):
        tally.fields_compared += sum(map(_count, kinds, expected.lines))
        return
    others = recognise(actual.lines)
    frame, other_frame = frames(expected.lines, kinds), frames(actual.lines, others)
    for one, other in align(expected.items(kinds), actual.items(others), line_cost):
        named = (frame[one.number - expected.first] if one else "").strip("?")
        if other and not named:
            named = other_frame[other.number - actual.first]
        place = partial(
            Difference,
            page=expected.number,
            frame=named,
            expected_line=one.number if one else None,
            actual_line=other.number if other else None,
        )
        if one and other:
            yield from _compare_lines(one, other, units, tally, place)
        elif one:
            yield place("missing line", expected=one.raw, actual="")
        elif other:
            yield place("extra line", expected="", actual=other.raw)


def _compare_lines(
    one: Item, other: Item, units: Decimal, tally: Tally, place: partial[Difference]
) -> Iterator[Difference]:
    if one.raw == ILLEGIBLE:
        tally.fields_illegible += _count(other.kind, other.raw)
        return
    if one.raw == other.raw and ILLEGIBLE not in one.raw:
        kind = one.kind if one.kind is other.kind else common_kind(one, other)
        tally.fields_compared += _count(kind, one.raw)
        return
    kind = common_kind(one, other)
    if kind is None or any(one.raw[gap].rstrip() != other.raw[gap].rstrip() for gap in kind.gaps):
        if one.raw != other.raw:
            yield place("line", expected=one.raw, actual=other.raw)
        return
    landmark = one.landmark.strip("?") or other.landmark
    for field in kind.fields:
        here, there = one.raw[field.columns], other.raw[field.columns]
        if not here.strip(" ?") and "?" in here:
            tally.fields_illegible += 1
            continue
        tally.fields_compared += bool(here.strip() or there.strip())
        if not agree(field, here, there, units):
            yield place(
                "field",
                expected=here.strip(),
                actual=there.strip(),
                landmark=landmark,
                field=field.name,
                off_by=off_by(field, here, there),
            )


def _count(kind: Line | None, text: str) -> int:
    """How many fields of a line are printed."""
    if kind is None or not kind.fields:
        return 0
    if len(text) >= kind.fields[-1].first:
        return len(kind.fields)
    return sum(bool(text[field.columns].strip()) for field in kind.fields)
