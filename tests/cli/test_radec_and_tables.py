"""What `vopd stars radec` and `vopd stars tables` take and write."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from vopd.findings import Finding

tables: Any = import_module("vopd.cli.stars.tables")


GIVEN = ["--focal", "76", "--attitude", "1,2,3"]
RADEC: list[tuple[list[str], tuple[Any, ...]]] = [
    (["f.csv", *GIVEN], ("f.csv", 76.0, (1.0, 2.0, 3.0), (), "text")),
    (["f.csv", *GIVEN, "--format", "csv"], ("f.csv", 76.0, (1.0, 2.0, 3.0), (), "csv")),
    (
        [*GIVEN, "--image", "4,5", "--image", "-6,7", "--format", "json"],
        (None, 76.0, (1.0, 2.0, 3.0), ((4.0, 5.0), (-6.0, 7.0)), "json"),
    ),
    (["t.txt", "--typed"], ("t.txt", None, None, (), "text")),
]


@pytest.mark.parametrize(("options", "expected"), RADEC)
def test_what_fictitious_stars_are_made_of(
    options: list[str], expected: tuple[Any, ...], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    given: list[Any] = []

    def made(*one: Any) -> str:
        *arguments, report = one
        given.append(tuple(arguments))
        report(Finding("odd", "f", severity="warning"))
        return "Zürich\n"

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("vopd.stellar.radec.radec_text", made)
    ran = vopd("stars", "radec", *options)
    assert (ran.status, ran.output, ran.stderr) == (0, "Zürich\n".encode(), "warning: f: odd\n")
    assert given == [expected]
    vopd("stars", "radec", *options, "-o", "out.txt")
    assert Path("out.txt").read_bytes() == "Zürich\n".encode()


WRONG = [
    ["--typed"],
    *(["f.csv", "--typed", *more]
      for more in (GIVEN[:2], GIVEN[2:], ["--image", "1,2"])),
    ["f.csv"], ["f.csv", *GIVEN[:2]], ["f.csv", *GIVEN[2:]],
    GIVEN, ["f.csv", *GIVEN, "--image", "1,2"],
]  # fmt: skip


@pytest.mark.parametrize("options", WRONG)
def test_fictitious_stars_that_are_not_made(options: list[str]) -> None:
    ran = vopd("stars", "radec", *options)
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr)


@pytest.mark.parametrize("typed", [False, True])
def test_the_input_of_fictitious_stars_is_not_written_over(typed: bool, tmp_path: Path) -> None:
    (tmp_path / "f").write_text("before")
    options = ["--typed"] if typed else GIVEN
    ran = vopd("stars", "radec", tmp_path / "f", *options, "-o", tmp_path / "f")
    assert ran.status == 1
    assert_approved(ran.stderr)
    assert (tmp_path / "f").read_text() == "before"


# tables


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf", ".PDF", ".txt", ""])
def test_tables_or_figures_by_the_suffix(
    suffix: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(tables, "_tables", lambda: b"tables")
    monkeypatch.setattr(tables, "_figures", lambda suffix: suffix.encode())
    out = tmp_path / f"t{suffix}"
    assert vopd("stars", "tables", "-o", out).status == 0
    drawn = suffix not in (".txt", "")
    assert out.read_bytes() == (suffix.lower().encode() if drawn else b"tables")
    assert vopd("stars", "tables").output == b"tables"


@pytest.mark.parametrize("suffix", [".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".JPG"])
def test_other_pictures_are_refused(suffix: str, tmp_path: Path) -> None:
    ran = vopd("stars", "tables", "-o", tmp_path / f"t{suffix}")
    assert ran.status == 2
    assert_approved(ran.stderr, parts=[suffix])


def test_tables_are_not_computed_for_a_file_that_cannot_be_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(tables, "_tables", None)
    ran = vopd("stars", "tables", "-o", tmp_path / "no" / "t.txt")
    assert ran.status == 1 and "No such file or directory" in ran.stderr


def test_the_tables_one_after_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vopd.stellar.tables_1987.tables", lambda: [1, 2, 3])
    monkeypatch.setattr("vopd.stellar.tables_1987.as_text", lambda one: f"Zürich {one}\n")
    expected = "Zürich 1\n\nZürich 2\n\nZürich 3\n"
    assert vopd("stars", "tables").output == expected.encode()


def test_the_figures_are_numbered_from_1(monkeypatch: pytest.MonkeyPatch) -> None:
    """A panel for each angle, with the errors of that angle."""
    drawn: list[Any] = []
    errors = np.arange(12.0).reshape(2, 2, 3)
    monkeypatch.setattr(
        "vopd.stellar.tables_1987.figure_errors", lambda: ("pairs", "methods", errors)
    )
    monkeypatch.setattr(
        "vopd.figures.stars.draw_errors_by_pair", lambda *one: drawn.append(one) or "f"
    )
    monkeypatch.setattr("vopd.figures.style.save", lambda *one: repr(one).encode())
    assert tables._figures(".svg") == b"('f', '.svg')"
    ((pairs, methods, panels),) = drawn
    assert (pairs, methods) == ("pairs", "methods")
    assert [f"6.{k}" in title for k, title in enumerate(panels, 1)] == [True] * 3
    assert [values.tolist() for values in panels.values()] == [
        [[k, k + 3], [k + 6, k + 9]] for k in range(3)
    ]
