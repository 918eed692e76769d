"""Write the report: one HTML page that needs no other file and no network.

The page is a jinja2 template, `page.html`, which escapes every text that is put
into it; the modules of this folder make the numbers and the texts.
"""

from __future__ import annotations

from collections.abc import Sequence

from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.figures.drawn_jobs import left_out_text
from vopd.findings import VopdError
from vopd.report.embedded_figures import NoFigures, embedded_figures
from vopd.report.page_template import page_template, style_and_script
from vopd.report.summary import summary, uncertainty_sentences
from vopd.report.tables import flag_rows, frame_table, job_table, landmark_table

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
    template = page_template("page.html")
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame has an attitude")
    figures = embedded_figures(histories)
    page = template.render(
        about=histories[0].about,
        sources=", ".join(dict.fromkeys(h.about.source for h in histories)),
        failed=failed,
        summary=summary(histories),
        messages=messages,
        figures=[] if isinstance(figures, NoFigures) else figures,
        no_figures=figures.reason if isinstance(figures, NoFigures) else "",
        left_out=left_out_text(histories) if figures and not isinstance(figures, NoFigures) else "",
        jobs=job_table(histories),
        frames=frame_table(histories),
        at_once=ROWS_AT_ONCE,
        flags=flag_rows(histories),
        landmarks=landmark_table(histories),
        uncertainty=uncertainty_sentences(histories, max_rate_deg_s),
        conventions=conventions(histories),
        **style_and_script(),
    )
    return page.encode("utf-8", "replace")


def ready() -> None:
    """Check that a report can be made.

    Raises:
        VopdError: where jinja2 is not installed
    """
    page_template("page.html")
