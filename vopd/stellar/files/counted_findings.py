"""Findings by their kind, so that many of one kind are counted and not repeated."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

from vopd.findings import Finding

SHOWN_OF_A_KIND = 3
"""How many findings of one kind are shown; the others are counted."""


class KindOfFinding(NamedTuple):
    """A finding and its kind, so that many of one kind can be counted."""

    kind: str
    finding: Finding


def counted(findings: Iterable[KindOfFinding]) -> list[Finding]:
    """The first three findings of each kind, and the number of the others."""
    seen: Counter[str] = Counter()
    shown: list[Finding] = []
    last: dict[str, Finding] = {}
    for kind, finding in findings:
        seen[kind] += 1
        if seen[kind] <= SHOWN_OF_A_KIND or kind == "plausibility":
            shown.append(finding)
        last[kind] = finding
    for kind, count in seen.items():
        if count > SHOWN_OF_A_KIND and kind != "plausibility":
            method = kind.partition(":")[0]
            text = f"{method}: {count - SHOWN_OF_A_KIND} more like these"
            more = Finding(text, last[kind].deck, severity=last[kind].severity)
            shown.append(more)
    return shown
