"""How `vopd stars solve` ends: its status, what it writes, and what it says unless it is quiet."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from vopd.findings import Finding


@pytest.mark.parametrize("quiet", [False, True])
@pytest.mark.parametrize("status", [0, 1, 3])
def test_the_status_and_the_messages(
    quiet: bool, status: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Warnings of the solve, then those of the writing; errors are said also if it is quiet."""
    monkeypatch.chdir(tmp_path)
    found = (Finding("odd", "a.csv", severity="warning"), Finding("wrong", "b.csv"))
    given: list[Any] = []

    def render(form: str, photographs: Any, request: Any, report: Any) -> bytes:
        given.append((form, photographs, request.method))
        report(Finding("left out", "a.csv", severity="warning"))
        return b"content"

    photographs: Any = ["photograph"]
    monkeypatch.setattr(
        "vopd.stellar.files.photograph.solve_photographs", lambda *_: (photographs, found, status)
    )
    monkeypatch.setattr(import_module("vopd.cli.stars.solve"), "render", render)
    words = ("stars", "solve", "a.csv", "b.csv", "--method", "svd", "-o", "t.jsonl")
    ran = vopd(*words, *(["-q"] if quiet else []))
    assert (ran.status, ran.stdout) == (status, "")
    warnings = ["warning: a.csv: odd", "b.csv: wrong", "warning: a.csv: left out"]
    assert ran.stderr.splitlines() == (["b.csv: wrong"] if quiet else warnings)
    assert given == [("jsonl", photographs, "svd")]
    assert Path("t.jsonl").read_bytes() == b"content"


def test_an_input_is_not_written_over(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "b.csv"):
        Path(name).write_text("before")
        ran = vopd("stars", "solve", "a.csv", "b.csv", "-o", f"./{name}")
        assert ran.status == 1
        assert_approved(ran.stderr, parts=[name])
        assert Path(name).read_text() == "before"
