"""Sort findings into kinds, so that similar ones can be counted instead of shown."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Hashable, Iterable

from vopd.findings import Finding

_VARYING = r"'[^']*'|\"[^\"]*\"|[-+]?\d[\d.,]*(?:e[-+]?\d+)?"
"""What differs between the messages of one kind: quoted text and numbers."""


def kind_of(finding: Finding) -> Hashable:
    """The kind of a finding: everything but the card and the numbers in the message."""
    words = re.sub(_VARYING, "#", finding.message)
    return finding.severity, finding.deck, finding.job, finding.group, finding.field, words


def first_of_each_kind(
    findings: Iterable[Finding], most: int
) -> tuple[list[Finding], list[tuple[Finding, int]]]:
    """The first findings of each kind, and the number of others of each kind.

    Args:
        findings: the findings
        most: how many of one kind are kept

    Returns:
        The findings that are kept, in their order; and for each kind that has more, its last
        kept finding and the number of those left out.
    """
    seen: Counter[Hashable] = Counter()
    kept: list[Finding] = []
    example: dict[Hashable, Finding] = {}
    for finding in findings:
        kind = kind_of(finding)
        seen[kind] += 1
        if seen[kind] <= most:
            kept.append(finding)
            example[kind] = finding
    return kept, [(example[k], count - most) for k, count in seen.items() if count > most]
