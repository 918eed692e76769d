"""Compare one listing with another: page by page, line by line, field by field.

Text must be equal except for blanks at the end of a line; numbers may differ as far as
`vopd.compare.tolerances` says. EXPECTED may be the transcript of a damaged print: there a field of
nothing but `?` is illegible and not compared, and a line that is a single `?` stands for any one
line. In ACTUAL a `?` is text.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from typing import Literal

from vopd.compare.align import align
from vopd.compare.difference import Difference
from vopd.compare.field_comparison import exact_units, fields_agree, units_apart
from vopd.compare.pairing_cost import common_kind, line_cost, page_cost
from vopd.compare.undetermined import Undetermined, may_hold, refuse_layout
from vopd.listing.line_formats import Line
from vopd.listing.lines import (
    ILLEGIBLE,
    ListingLine,
    ListingPage,
    frames_of_lines,
    recognise_lines,
    split_pages,
)

NONE: Undetermined = {}
_PagePair = tuple[ListingPage | None, ListingPage | None]


@dataclass
class ComparisonCounts:
    """How much was compared: pages of EXPECTED, fields compared, fields that are illegible.

    Also fields that differ in digits that are not determined.
    """

    pages: int = 0
    fields_compared: int = 0
    fields_illegible: int = 0
    fields_undetermined: int = 0


@dataclass
class Comparison(ComparisonCounts):
    """All differences of two listings, in their order, and how much was compared."""

    differences: tuple[Difference, ...] = ()


def compare_listings(
    expected_text: str,
    actual_text: str,
    units: float | Decimal | str = 1.0,
    undetermined: Undetermined = NONE,
) -> Comparison:
    """Compare two listings given as text.

    Args:
        expected_text: the listing to compare with; it may be a transcript with illegible parts
        actual_text: the listing to be judged
        units: how many units of its last printed digit a number may differ by, 0 or more;
            0 asks for identical text
        undetermined: fields of EXPECTED whose digits are not determined

    Returns:
        The differences, and how many pages and fields were compared.

    Raises:
        VopdError: if `units` is negative, not finite, or no number.
    """
    result = Comparison()
    result.differences = tuple(
        find_differences(expected_text, actual_text, units, result, undetermined)
    )
    return result


def find_differences(
    expected_text: str,
    actual_text: str,
    units: float | Decimal | str,
    counts: ComparisonCounts,
    undetermined: Undetermined = NONE,
) -> Iterator[Difference]:
    """Yield the differences one by one, and add to `counts` what has been compared so far.

    The arguments are those of `compare_listings`.
    """
    allowed = exact_units(units)
    pages = align(split_pages(expected_text), split_pages(actual_text), page_cost)
    for expected, actual in _join_illegible_pages(pages):
        counts.pages += expected is not None
        if expected is not None and actual is not None:
            yield from _compare_pages(expected, actual, allowed, counts, undetermined)
        elif expected is not None:
            yield _page_without_partner("missing page", expected)
        elif actual is not None:
            yield _page_without_partner("extra page", actual)


def _join_illegible_pages(pairs: Iterable[_PagePair]) -> list[_PagePair]:
    """Join pages of ACTUAL where illegible lines of EXPECTED stand for the pages between them."""
    joined: list[_PagePair] = []
    for expected, actual in pairs:
        if joined and not expected and _has_room(*joined[-1], actual):
            page, before = joined.pop()
            joined.append((page, _joined(before, actual)))
            continue
        while joined and not joined[-1][0] and _has_room(expected, actual, joined[-1][1]):
            actual = _joined(joined.pop()[1], actual)
        joined.append((expected, actual))
    return joined


def _has_room(
    expected: ListingPage | None, actual: ListingPage | None, more: ListingPage | None
) -> bool:
    """Whether EXPECTED has illegible lines enough for most of one more page of ACTUAL."""
    if not expected or not actual or not more or ILLEGIBLE not in expected.lines:
        return False
    return 2 * (len(expected.lines) - len(actual.lines)) >= len(more.lines)


def _joined(first: ListingPage | None, second: ListingPage | None) -> ListingPage | None:
    """Two pages as one."""
    if not first or not second:
        return first or second
    return ListingPage(first.number, first.first_line, first.lines + second.lines)


def _page_without_partner(
    kind: Literal["missing page", "extra page"], page: ListingPage
) -> Difference:
    """The difference that a page of one listing only is."""
    text = "\n".join(page.lines)
    if kind == "missing page":
        return Difference(kind, page.number, page.key or "", page.first_line, None, text, "")
    return Difference(kind, page.number, page.key or "", None, page.first_line, "", text)


def undetermined_fields(low_text: str, high_text: str) -> Undetermined:
    """The fields whose digits are not determined: those in which two listings differ.

    Args:
        low_text: a listing with all numbers as low as they may be
        high_text: the listing of the same deck with all numbers as high as they may be

    Raises:
        VopdError: where the two have other lines
    """
    found: dict[tuple[int, str], tuple[str, str]] = {}
    for one in compare_listings(low_text, high_text, 0).differences:
        if one.kind != "field" or one.expected_line is None:
            raise refuse_layout(str(one))
        found[one.expected_line, one.field] = one.expected, one.actual
    return found


def _compare_pages(
    expected: ListingPage,
    actual: ListingPage,
    units: Decimal,
    counts: ComparisonCounts,
    undetermined: Undetermined,
) -> Iterator[Difference]:
    """Compare two pages that belong together, line by line."""
    kinds = recognise_lines(expected.lines, damaged=True)
    if expected.lines == actual.lines and not any(ILLEGIBLE in text for text in expected.lines):
        counts.fields_compared += sum(map(_count, kinds, expected.lines))
        return
    others = recognise_lines(actual.lines)
    frame = frames_of_lines(expected.lines, kinds)
    other_frame = frames_of_lines(actual.lines, others)
    for one, other in align(expected.with_kinds(kinds), actual.with_kinds(others), line_cost):
        named = (frame[one.number - expected.first_line] if one else "").strip("?")
        if other and not named:
            named = other_frame[other.number - actual.first_line]
        located = partial(
            Difference,
            page=expected.number,
            frame=named,
            expected_line=one.number if one else None,
            actual_line=other.number if other else None,
        )
        if one and other:
            yield from _compare_lines(one, other, units, counts, undetermined, located)
        elif one:
            yield located("missing line", expected=one.text, actual="")
        elif other:
            yield located("extra line", expected="", actual=other.text)


def _compare_lines(
    one: ListingLine,
    other: ListingLine,
    units: Decimal,
    counts: ComparisonCounts,
    undetermined: Undetermined,
    located: partial[Difference],
) -> Iterator[Difference]:
    """Compare two lines that belong together, field by field."""
    if one.text == ILLEGIBLE:
        counts.fields_illegible += _count(other.kind, other.text)
        return
    if one.text == other.text and ILLEGIBLE not in one.text:
        kind = one.kind if one.kind is other.kind else common_kind(one, other)
        counts.fields_compared += _count(kind, one.text)
        return
    kind = common_kind(one, other)
    if kind is None or any(one.text[gap].rstrip() != other.text[gap].rstrip() for gap in kind.gaps):
        if one.text != other.text:
            yield located("line", expected=one.text, actual=other.text)
        return
    landmark = one.landmark.strip("?") or other.landmark
    for field in kind.fields:
        here, there = one.text[field.columns], other.text[field.columns]
        if not here.strip(" ?") and "?" in here:
            counts.fields_illegible += 1
            continue
        counts.fields_compared += bool(here.strip() or there.strip())
        if not fields_agree(field, here, there, units):
            between = undetermined.get((one.number, field.name))
            free = between is not None and all(
                may_hold(field, text, *between) for text in (here, there)
            )
            counts.fields_undetermined += free
            yield located(
                "field",
                expected=here.strip(),
                actual=there.strip(),
                landmark=landmark,
                field=field.name,
                off_by=units_apart(field, here, there),
                determined=not free,
            )


def _count(kind: Line | None, text: str) -> int:
    """How many fields of a line are printed."""
    if kind is None or not kind.fields:
        return 0
    if len(text) >= kind.fields[-1].first:
        return len(kind.fields)
    return sum(bool(text[field.columns].strip()) for field in kind.fields)
