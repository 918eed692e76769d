"""Write the report: one HTML page that needs no other file and no network.

The page is a jinja2 template, `page.html`, which escapes every text that is put
into it; the modules of this folder make the numbers and the texts.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from importlib.resources import files
from typing import TYPE_CHECKING

from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.findings import VopdError
from vopd.report.embedded_figures import NoFigures, embedded_figures
from vopd.report.summary import summary, uncertainty_sentences
from vopd.report.tables import flag_rows, frame_table, landmark_table

if TYPE_CHECKING:
    from jinja2 import Template

ROWS_AT_ONCE = 200  # rows of frames that a screen shows at first: 9000 take it five seconds


def report(
    histories: Sequence[History],
    messages: Sequence[str] = (),
    max_rate_deg_s: float | None = None,
    failed: bool = False,
) -> bytes:
    """Make the page about all jobs, in UTF-8; without matplotlib it has no figures and says so.

    Args:
        histories: one or more jobs, of one kind of source
        messages: warnings and errors, shown as they are
        max_rate_deg_s: the limit of the flag `jump` that they were made with
        failed: whether a source failed, which the page says at its head

    Raises:
        VopdError: where jinja2 is not installed, or no frame has an attitude
    """
    template = _template()
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame has an attitude")
    figures = embedded_figures(histories)
    style, script = _file("page.css"), _file("page.js")
    page = template.render(
        about=histories[0].about,
        sources=", ".join(dict.fromkeys(h.about.source for h in histories)),
        failed=failed,
        summary=summary(histories),
        messages=messages,
        figures=[] if isinstance(figures, NoFigures) else figures,
        no_figures=figures.reason if isinstance(figures, NoFigures) else "",
        frames=frame_table(histories),
        at_once=ROWS_AT_ONCE,
        flags=flag_rows(histories),
        landmarks=landmark_table(histories),
        uncertainty=uncertainty_sentences(histories, max_rate_deg_s),
        conventions=conventions(histories),
        style=style,
        script=script,
        policy=_policy(style, script),
    )
    return page.encode("utf-8", "replace")


def ready() -> None:
    """Check that a report can be made.

    Raises:
        VopdError: where jinja2 is not installed
    """
    _template()


def _template() -> Template:
    try:
        from jinja2 import Environment, StrictUndefined
    except ImportError as error:
        raise VopdError("jinja2 is not installed: pip install 'vopd[report]'") from error
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    return environment.from_string(_file("page.html"))


def _file(name: str) -> str:
    return (files("vopd.report") / name).read_text(encoding="utf-8")


def _policy(style: str, script: str) -> str:
    """A content security policy that allows this style, this script and embedded images only."""

    def allowed(text: str) -> str:
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        return f"'sha256-{digest}'"

    return (
        f"default-src 'none'; img-src data:; style-src {allowed(style)}; "
        f"script-src {allowed(script)}; base-uri 'none'; form-action 'none'"
    )
