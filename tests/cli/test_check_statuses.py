"""How a check ends, and what it writes of each finding."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from vopd.cli import check
from vopd.findings import Finding


@pytest.mark.parametrize(
    ("severities", "strict", "status"),
    [
        ([], False, 0), ([], True, 0), (["warning"], False, 0), (["warning"], True, 3),
        (["error"], False, 1), (["error", "warning"], True, 1),
    ],
)  # fmt: skip
def test_the_status_of_a_check(severities: list[Any], strict: bool, status: int) -> None:
    found = [Finding("odd", severity=one) for one in severities]
    assert check._status({"a": [], "b": found}, strict) == status


def test_a_check_in_json_has_every_field_of_a_finding() -> None:
    error = Finding("wrong", "a", 3, 1, 9, "longitude", (11, 20), "  card", "error")
    text = check._as_json({"a": [replace(error, message="odd", severity="warning"), error]})
    fields = {"card": 3, "job": 1, "group": 9, "field": "longitude", "columns": [11, 20]}
    import json

    assert text.startswith('[\n  {\n    "deck": "a",\n    "errors": [\n') and text.endswith("]\n")
    (report,) = json.loads(text)
    assert report == {
        "deck": "a",
        "errors": [{"message": "wrong", **fields, "image": "  card"}],
        "warnings": [{"message": "odd", **fields, "image": "  card"}],
    }
    assert [*report] == ["deck", "errors", "warnings"]


def test_findings_of_a_deck_in_text() -> None:
    """Errors first; one with a ruler is followed by an empty line; the count is of its kind."""
    ruled = Finding("wrong", "a", 3, 1, 9, "longitude", (11, 13), "0123456789abc", "error")
    odd = [
        Finding("odd", "a", k, 1, 9, "x", (1, 2), "card", severity="warning") for k in range(1, 9)
    ]
    lines = check._as_text({"a": [*odd, ruled]}, show_all=False).splitlines()
    assert lines[0] == "error: a: card 3, job 1, group 9, longitude (columns 11-13): wrong"
    assert lines[3:6] == ["    0123456789abc", " " * 14 + "^^^", ""]
    assert lines[-2] == "warning: a: job 1, group 9, x: 5 more like the 3 above; --all shows them"
    assert lines[-1] == "a: 1 error, 8 warnings"
