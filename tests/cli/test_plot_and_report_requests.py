"""What figures and reports are made of, option by option; nothing is solved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from vopd.cli import plot, report


def job(number: int) -> Any:
    return SimpleNamespace(about=SimpleNamespace(job=number))


PLOTS: list[tuple[str, tuple[Any, ...], str, int]] = [
    ("f.svg", ("all", [1, 2, 1], None, None), ".svg", 150),
    ("f.PNG", ("all", [1, 2, 1], None, None), ".png", 150),
    ("f.pdf --figure attack", ("attack", [1, 2, 1], None, None), ".pdf", 150),
    ("f.png --dpi 20", ("all", [1, 2, 1], None, None), ".png", 20),
    ("f.png --dpi 1200", ("all", [1, 2, 1], None, None), ".png", 1200),
    ("f.png --dpi 900 --size 9X21.5", ("all", [1, 2, 1], None, (9.0, 21.5)), ".png", 900),
    ("f.x --format png", ("all", [1, 2, 1], None, None), ".png", 150),
    ("f.svg --format pdf --frame 7a", ("all", [1, 2, 1], "7a", None), ".pdf", 150),
    ("f.svg --figure image --frame 60", ("image", [1, 2, 1], "60", None), ".svg", 150),
    ("f.svg --job 1", ("all", [1, 1], None, None), ".svg", 150),
    ("f.svg --job 2 --size 16.5x30", ("all", [2], None, (16.5, 30.0)), ".svg", 150),
]


@pytest.mark.parametrize(("options", "drawn", "suffix", "dpi"), PLOTS)
def test_what_a_figure_is_made_of(
    options: str,
    drawn: tuple[Any, ...],
    suffix: str,
    dpi: int,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """The exit status is that of the solve; what is saved is what is written."""
    given: list[Any] = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plot, "collect_histories", lambda *_: ([job(1), job(2), job(1)], 3))
    monkeypatch.setattr(plot, "left_out_text", lambda _: "")
    monkeypatch.setattr(plot, "draw", lambda *one: given.append(one) or "picture")
    monkeypatch.setattr(plot, "save", lambda *one: given.append(one) or b"saved")
    ran = vopd("plot", "a.dat", "-o", *options.split())
    assert (ran.status, ran.stdout, ran.stderr) == (3, "", "")
    (name, jobs, frame, size), saved = given
    assert (name, [one.about.job for one in jobs], frame, size) == drawn
    assert saved == ("picture", suffix, dpi)
    assert (tmp_path / options.split()[0]).read_bytes() == b"saved"


@pytest.mark.parametrize(
    "options",
    [
        "",
        "--figure attack",
        "--figure image",
        "-q",
    ],
)
def test_jobs_that_are_not_drawn_are_told(
    options: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(plot, "collect_histories", lambda *_: ([job(1)], 0))
    monkeypatch.setattr(plot, "left_out_text", lambda _: "20 of 30 jobs, with the worst")
    monkeypatch.setattr(plot, "draw", lambda *_: None)
    monkeypatch.setattr(plot, "save", lambda *_: b"saved")
    ran = vopd("plot", "a.dat", "-o", tmp_path / "f.svg", *options.split())
    assert (ran.status, ran.stdout) == (0, "")
    assert_approved(ran.stderr)


REFUSED = [
    ("f.svg --dpi 100", 2),
    ("f.pdf --dpi 150", 2),
    ("f.png --format svg --dpi 100", 2),
    ("f.txt", 2),
    ("f", 2),
    ("f.svg --job 3", 1),
]


@pytest.mark.parametrize(("options", "status"), REFUSED)
def test_figures_that_are_refused(
    options: str, status: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plot, "collect_histories", lambda *_: ([job(1), job(2)], 0))
    ran = vopd("plot", "a.dat", "b.dat", "-o", *options.split())
    assert ran.status == status
    assert_approved(ran.stderr.splitlines()[-1])
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("name", ["a.json", "A.JSON"])
def test_star_photographs_are_drawn_with_the_frame_size_and_dots_asked_for(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    given: list[Any] = []
    monkeypatch.setattr(plot, "plot_stars", lambda *one: given.append(one) or "picture")
    monkeypatch.setattr(plot, "save", lambda *one: given.append(one) or b"saved")
    out = tmp_path / "f.png"
    words = ("--frame", "one", "--size", "9x6.5", "--dpi", "99", "--format", "png")
    ran = vopd("plot", name, "b.json", "-o", out, *words)
    assert (ran.status, ran.stderr) == (0, "") and out.read_bytes() == b"saved"
    assert given == [((name, "b.json"), "one", (9.0, 6.5)), ("picture", ".png", 99)]
    vopd("plot", name, "-o", out)
    assert given[2:] == [((name,), None, None), ("picture", ".png", 150)]


@pytest.mark.parametrize("status", [0, 1, 3])
@pytest.mark.parametrize("name", ["p.html", "p.HTM"])
def test_what_a_report_is_made_of(
    status: int, name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The histories, all that was heard, the rate, and whether a source failed."""

    def collected(_: object, __: object, hear: Callable[[str], None]) -> tuple[list[str], int]:
        hear("odd")
        hear("wrong")
        return ["history"], status

    given: list[Any] = []
    monkeypatch.setattr(report, "collect_histories", collected)
    monkeypatch.setattr(
        report, "report", lambda *one, failed: given.append((*one, failed)) or b"page"
    )
    ran = vopd("report", "a.dat", "-o", tmp_path / name, "--max-rate", "40")
    assert ran.status == status and (tmp_path / name).read_bytes() == b"page"
    assert given == [(["history"], ["odd", "wrong"], 40.0, status == 1)]
    ran = vopd("report", "a.dat", "-o", tmp_path / "p.txt")
    assert ran.status == 2
    assert_approved(ran.stderr)
