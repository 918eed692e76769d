"""The report: one HTML page that holds everything, opens from disk and asks for nothing."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Sequence
from html import escape
from importlib.resources import files

from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.attitude.input_sigmas import Sigmas
from vopd.findings import VopdError
from vopd.report.pictures import pictures
from vopd.report.summary import failed_banner, fixes_banner, summary, uncertainty_said
from vopd.report.tables import (
    column_list,
    flag_options,
    flag_table,
    frame_table,
    landmark_table,
)


def report(
    histories: Sequence[History],
    remarks: Sequence[str] = (),
    sigmas: Sigmas | None = None,
    max_rate_deg_s: float | None = None,
    failed: bool = False,
) -> bytes:
    """The page for all jobs of all decks, UTF-8.

    `remarks` are the decks' warnings and faults, shown as they are; `sigmas`
    and `max_rate_deg_s` are what the histories were asked for. `failed`: a deck
    failed, which the page says at its head. Without matplotlib the pictures'
    place says how to get them. Raises `VopdError` where no frame has an attitude.
    """
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame is left with an attitude")
    decks = ", ".join(dict.fromkeys(h.about.source for h in histories))
    parts = {
        "title": escape(f"Attitude report: {decks}"),
        "decks": escape(decks),
        "fixes": fixes_banner(histories) + failed_banner(failed),
        "summary": summary(histories),
        "remarks": _remarks(remarks),
        "pictures": pictures(histories),
        "flag_options": flag_options(histories),
        "frames": frame_table(histories),
        "columns": column_list(histories),
        "flags": flag_table(histories),
        "landmarks": landmark_table(histories),
        "uncertainty": uncertainty_said(histories, sigmas or Sigmas(), max_rate_deg_s),
        "conventions": _definitions(conventions(histories)),
    }
    style, script = _file("page.css"), _file("page.js")
    parts |= {"style": style, "script": script, "policy": _policy(style, script)}
    return _filled(_file("page.html"), parts).encode("utf-8", "replace")


def _filled(template: str, parts: dict[str, str]) -> str:
    """The template with each `{{name}}` replaced, in one pass: what is put in stays as it is."""
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], template)


def _file(name: str) -> str:
    return (files("vopd.report") / name).read_text(encoding="utf-8")


def _policy(style: str, script: str) -> str:
    """A content security policy that lets this style, this script and the pictures in, no more."""

    def allowed(text: str) -> str:
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        return f"'sha256-{digest}'"

    return (
        f"default-src 'none'; img-src data:; style-src {allowed(style)}; "
        f"script-src {allowed(script)}; base-uri 'none'; form-action 'none'"
    )


def _remarks(remarks: Sequence[str]) -> str:
    if not remarks:
        return "<p>None.</p>"
    items = "".join(f"<li><pre>{escape(remark)}</pre></li>" for remark in remarks)
    return (
        f'<div class="scroll remarks" tabindex="0" role="region" aria-label="Warnings">'
        f"<ul>{items}</ul></div>"
    )


def _definitions(said: dict[str, str]) -> str:
    rows = "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in said.items())
    return f"<dl>{rows}</dl>"
