"""The report's tables: frames, flags, landmarks. Cells have the text of the CSV."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from vopd.attitude.columns import columns_of
from vopd.attitude.flags import MEANING
from vopd.attitude.formats.delimited import table_text
from vopd.attitude.history import History

SHOWN = (
    *("job", "frame", "status", "time_s", "flags"),
    *("camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("sigma_vehicle_yaw_deg", "sigma_vehicle_pitch_deg", "sigma_vehicle_roll_deg"),
    *("alpha_deg", "beta_deg", "eta_deg"),
    *("sigma_alpha_deg", "sigma_beta_deg", "sigma_eta_deg"),
    *("airspeed_ft_s", "landmarks", "residual_rms_mm", "condition", "last_correction_rad"),
)
"""The columns of the frames' table; that of the deck comes first where there are several."""

WORDS = {"deck", "status", "flags"}


def frame_table(histories: Sequence[History]) -> str:
    """One row a frame, all of them; each row's `data-flags` has its flags without their details."""
    text = table_text(histories)
    about = {column.name: column for column in columns_of(histories)}
    several = len({h.deck for h in histories}) > 1
    names = ["deck", *SHOWN] if several else list(SHOWN)
    head = "".join(_heading(name, about[name].meaning, name in WORDS) for name in names)
    rows = []
    for k, flags in enumerate(text["flags"]):
        raised = [flag.partition(":")[0] for flag in flags.split(";") if flag]
        cells = "".join(_cell(name, text[name][k]) for name in names)
        rows.append(f'<tr data-flags="{" ".join(raised)}">{cells}</tr>')
    return _table("frames", "Frames", head, rows)


def flag_options(histories: Sequence[History]) -> str:
    """The choices of the filter, each with its number of frames."""
    options = []
    for name in MEANING:
        count = sum(int(h.flags.raised[name].sum()) for h in histories)
        if count:
            options.append(f'<option value="{name}">{name} ({count})</option>')
    return "".join(options)


def flag_table(histories: Sequence[History]) -> str:
    """What every flag means, and how often it was raised."""
    head = "".join(
        _heading(name, "", name != "frames") for name in ("flag", "frames", "meaning", "what to do")
    )
    rows = []
    for name, (meaning, remedy) in MEANING.items():
        count = sum(int(h.flags.raised[name].sum()) for h in histories)
        rows.append(
            f'<tr><th scope="row"><code>{name}</code></th><td class="n">{count}</td>'
            f"<td>{escape(meaning)}</td><td>{escape(remedy)}</td></tr>"
        )
    return _table("flags", "Flags", head, rows)


def landmark_table(histories: Sequence[History]) -> str:
    """What the residuals of each landmark of each job have in common, micrometres on the film."""
    named = (
        ("landmark", "its number in group 9"),
        ("job", ""),
        ("frames", "in which it takes part"),
        ("ignored", "frames from which it is left out"),
        ("mean x", "of the residuals, µm"),
        ("mean y", "of the residuals, µm"),
        ("rms x", "root mean square of the residuals, µm"),
        ("rms y", "root mean square of the residuals, µm"),
        ("largest", "the longest residual, µm"),
        ("in frame", "where that is"),
        ("outlier", "times it was the outlier"),
    )
    head = "".join(_heading(name, about, False) for name, about in named)
    rows = [row for h in histories for row in _landmark_rows(h)]
    return _table("landmarks", "Residuals by landmark", head, rows)


def _landmark_rows(h: History) -> list[str]:
    r = h.results
    here = r.used & np.isfinite(r.residual_mm).all(axis=2)
    rows = []
    for number in sorted({int(n) for n in r.landmark[here | r.ignored]}):
        mine = here & (r.landmark == number)
        left_out = int((r.ignored & (r.landmark == number)).sum())
        residual = r.residual_mm[mine] * 1000.0
        cells = [str(number), str(h.job), str(len(residual)), str(left_out)]
        if len(residual):
            worst = int(np.hypot(*residual.T).argmax())
            numbers = [*residual.mean(axis=0), *np.sqrt((residual**2).mean(axis=0))]
            numbers.append(float(np.hypot(*residual[worst])))
            cells += [f"{value:.3f}" for value in numbers]
            cells.append(str(int(r.frame[np.nonzero(mine)[0][worst]])))
        else:
            cells += [""] * 6
        cells.append(str(int((h.flags.misfit & (r.landmark == number)).sum())))
        rows.append("<tr>" + "".join(f'<td class="n">{cell}</td>' for cell in cells) + "</tr>")
    return rows


def _cell(name: str, text: str) -> str:
    if name == "flags":
        marks = "".join(f"<span>{escape(flag)}</span> " for flag in text.split(";") if flag)
        return f'<td class="flags" data-text="{escape(text)}">{marks}</td>'
    kind = "" if name in WORDS else ' class="n"'
    return f"<td{kind}>{escape(text)}</td>"


def _heading(name: str, about: str, words: bool) -> str:
    title = f' title="{escape(about)}"' if about else ""
    kind = ' data-words=""' if words else ""
    return f'<th scope="col"{kind}><button type="button"{title}>{escape(name)}</button></th>'


def _table(name: str, caption: str, head: str, rows: list[str]) -> str:
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{caption}">'
        f'<table id="{name}-table" class="sortable"><caption>{caption}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )
