"""What the report hands to its template, and the template's own texts, without any figure."""

from __future__ import annotations

import base64
import hashlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import jinja2
import numpy as np
import pytest

import vopd.report as report_module
from tests.kit.histories import by_hand
from vopd.findings import VopdError
from vopd.report import (
    EmbeddedFigure,
    NoFigures,
    check_ready,
    embedded_figures,
    page_template,
    report,
    style_and_script,
)

ROOM = Path(report_module.__file__).parent
FIGURES_MODULE = sys.modules["vopd.report"]
OF_ALL_JOBS = {  # the value of the page: the function it comes from
    "summary": "summary", "jobs": "job_table", "frames": "frame_table", "flags": "flag_rows",
    "landmarks": "landmark_table", "conventions": "conventions", "figures": "embedded_figures",
    "left_out": "left_out_text",
}  # fmt: skip


class Given:
    """Takes the place of the template, and keeps what it is given."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.values: dict[str, Any] = {}
        self.text = "<page>"
        monkeypatch.setattr(report_module, "page_template", lambda name: self if name else None)
        for name in OF_ALL_JOBS.values():
            monkeypatch.setattr(report_module, name, self.by(name))
        monkeypatch.setattr(report_module, "uncertainty_sentences", self.by("sentences"))

    @staticmethod
    def by(name: str) -> Any:
        return lambda *arguments: (name, *arguments)

    def render(self, **values: Any) -> str:
        self.values = values
        return self.text


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> Given:
    return Given(monkeypatch)


def of(*sources: str) -> list[Any]:
    return [by_hand(said={"source": one}) for one in sources]


def test_every_value_is_of_all_jobs(given: Given) -> None:
    jobs = of("b", "a", "b")
    assert report(jobs) == b"<page>"
    values = given.values
    for name, function in OF_ALL_JOBS.items():
        assert values[name] == (function, jobs), name
    assert values["about"] is jobs[0].about
    assert values["sources"] == "b, a"
    assert (values["failed"], list(values["messages"]), values["no_figures"]) == (False, [], "")
    assert values["uncertainty"] == ("sentences", jobs, None)
    assert values["at_once"] == 200
    messages = [f"message {k}" for k in range(30)]
    report(jobs, messages, 12.5, True)
    assert given.values["uncertainty"] == ("sentences", jobs, 12.5)
    assert (given.values["failed"], list(given.values["messages"])) == (True, messages)


def test_what_utf_8_cannot_write_is_a_question_mark(given: Given) -> None:
    given.text = "é µ \udcff"
    assert report(of("a")) == b"\xc3\xa9 \xc2\xb5 ?"


def test_without_figures_it_says_why(given: Given, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(report_module, "embedded_figures", lambda _: NoFigures("a reason"))
    report(of("a"))
    values = given.values
    assert (values["figures"], values["no_figures"], values["left_out"]) == ([], "a reason", "")


def test_histories_without_any_attitude(given: Given) -> None:
    """Are refused; beside one that has some, they are not."""
    none = by_hand(vehicle_deg=np.full((3, 3), np.nan))
    with pytest.raises(VopdError, match=r"^no frame has an attitude$"):
        report([none])
    assert report([none, by_hand()]) == b"<page>" and given.values


FIGURES = {  # title, caption
    "attitude": (
        "Camera and vehicle attitude",
        "Camera and vehicle yaw, pitch and roll against time, with bands of 95 %.",
    ),
    "attack": (
        "Angles of attack",
        "Alpha, beta and eta against time, with bands of 95 %; eta is never below 0.",
    ),
    "residuals": (
        "Residuals by landmark",
        "Residuals x and y of every frame, a column for each landmark; the numbers are in the "
        "table of landmarks.",
    ),
    "image": (
        "One frame's image",
        "One frame's landmarks, measured and computed, with their residuals.",
    ),
}


def test_the_figures_of_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """All of them, of all jobs, each as an SVG within the page."""
    jobs = of("a", "b")
    monkeypatch.setattr(FIGURES_MODULE, "draw", lambda name, some: (name, some == jobs))
    monkeypatch.setattr(FIGURES_MODULE, "svg", lambda drawn: f"<svg>{drawn} é</svg>")
    made = embedded_figures(jobs)
    expected = []
    for name, (title, caption) in FIGURES.items():
        picture = base64.b64encode(f"<svg>{(name, True)} é</svg>".encode()).decode()
        expected.append(
            EmbeddedFigure(name, title, caption, f"data:image/svg+xml;base64,{picture}")
        )
    assert made == expected


def test_no_figures_without_matplotlib(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    reason = "matplotlib is not installed: pip install 'vopd[plots]'"
    assert embedded_figures(of("a")) == NoFigures(reason)


def test_what_the_page_may_load() -> None:
    """Its own style and script by their SHA-256, embedded images, and nothing else."""
    values = style_and_script()
    allowed = {}
    for name in ("page.css", "page.js"):
        digest = hashlib.sha256((ROOM / name).read_bytes()).digest()
        allowed[name] = f"'sha256-{base64.b64encode(digest).decode()}'"
    assert values == {
        "style": (ROOM / "page.css").read_text(encoding="utf-8"),
        "script": (ROOM / "page.js").read_text(encoding="utf-8"),
        "policy": (
            f"default-src 'none'; img-src data:; style-src {allowed['page.css']}; "
            f"script-src {allowed['page.js']}; base-uri 'none'; form-action 'none'"
        ),
    }


def test_the_templates_escape_and_know_all_their_values() -> None:
    environment = page_template("macros.html").environment
    assert environment.from_string("{{ text }}").render(text="<&\"'>") == "&lt;&amp;&#34;&#39;&gt;"
    with pytest.raises(jinja2.UndefinedError):
        environment.from_string("{{ missing }}").render()


@pytest.mark.parametrize(
    "found", [None, ModuleType("jinja2")], ids=["missing", "without its names"]
)
def test_without_jinja2_it_is_said_how_to_install_it(
    found: ModuleType | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", found)
    with pytest.raises(VopdError, match=r"^jinja2 is not installed: pip install 'vopd\[report\]'$"):
        check_ready()
