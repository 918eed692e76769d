"""The report's tables: frames, flags, landmarks. Cells have the text of the CSV."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from vopd.attitude.flags import MEANING
from vopd.attitude.history import History
from vopd.attitude.table_columns import columns_of
from vopd.export.csv_table import table_text

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
AT_ONCE = 200  # rows of frames a screen is given at first; 9000 at once take it five seconds


def frame_table(histories: Sequence[History]) -> str:
    """One row a frame, all of them; each row's `data-flags` has its flags without their details."""
    text = table_text(histories)
    about = {column.name: column for column in columns_of(histories)}
    names = _shown(histories)
    head = "".join(_heading(name, about[name].meaning, name in WORDS) for name in names)
    rows = []
    for k, flags in enumerate(text["flags"]):
        raised = [flag.partition(":")[0] for flag in flags.split(";") if flag]
        cells = "".join(_cell(name, text[name][k]) for name in names)
        later = ' class="later"' if k >= AT_ONCE else ""
        rows.append(f'<tr data-flags="{" ".join(raised)}"{later}>{cells}</tr>')
    return _table("frames", "Frames", head, rows)


def column_list(histories: Sequence[History]) -> str:
    """What the columns of the frames' table are, as a list of terms."""
    about = {column.name: column.meaning for column in columns_of(histories)}
    rows = (f"<dt>{name}</dt><dd>{escape(about[name])}</dd>" for name in _shown(histories))
    return f"<dl>{''.join(rows)}</dl>"


def _shown(histories: Sequence[History]) -> list[str]:
    return ["deck", *SHOWN] if _several(histories) else list(SHOWN)


def _several(histories: Sequence[History]) -> bool:
    return len({h.about.source for h in histories}) > 1


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
    several = _several(histories)
    named = (
        ("landmark", "its number in group 9"),
        *((("deck", ""),) if several else ()),
        ("job", ""),
        ("frames", "in which it takes part"),
        ("ignored", "frames from which it is left out"),
        ("mean x, µm", "of the residuals"),
        ("mean y, µm", "of the residuals"),
        ("rms x, µm", "root mean square of the residuals"),
        ("rms y, µm", "root mean square of the residuals"),
        ("largest, µm", "the longest residual"),
        ("in frame", "where that is"),
        ("outlier", "times it was the outlier"),
    )
    head = "".join(_heading(name, about, name in WORDS) for name, about in named)
    rows = [row for h in histories for row in _landmark_rows(h, several)]
    return _table("landmarks", "Residuals by landmark", head, rows)


def _landmark_rows(h: History, several: bool) -> list[str]:
    e, residual_mm = h.estimate, h.estimate.residual_xy
    here = e.used & np.isfinite(residual_mm).all(axis=2)
    rows = []
    for number in sorted({int(n) for n in e.landmark[here | e.ignored]}):
        mine = here & (e.landmark == number)
        left_out = int((e.ignored & (e.landmark == number)).sum())
        residual = residual_mm[mine] * 1000.0
        cells = [str(h.about.job), str(len(residual)), str(left_out)]
        if len(residual):
            worst = int(np.hypot(*residual.T).argmax())
            numbers = [*residual.mean(axis=0), *np.sqrt((residual**2).mean(axis=0))]
            numbers.append(float(np.hypot(*residual[worst])))
            cells += [f"{value:.3f}" for value in numbers]
            cells.append(str(int(e.frame[np.nonzero(mine)[0][worst]])))
        else:
            cells += [""] * 6
        cells.append(str(int((h.flags.misfit & (e.landmark == number)).sum())))
        first = f'<th scope="row" class="n">{number}</th>'
        deck = f"<td>{escape(h.about.source)}</td>" if several else ""
        numbered = "".join(f'<td class="n">{cell}</td>' for cell in cells)
        rows.append(f"<tr>{first}{deck}{numbered}</tr>")
    return rows


def _cell(name: str, text: str) -> str:
    if name == "flags":
        marks = "".join(f"<span>{escape(flag)}</span> " for flag in text.split(";") if flag)
        return f'<td class="flags" data-text="{escape(text)}">{marks}</td>'
    if name == "frame":
        return f'<th scope="row" class="n stays">{text}</th>'
    kind = "" if name in WORDS else ' class="n"'
    return f"<td{kind}>{escape(text)}</td>"


def _heading(name: str, about: str, words: bool) -> str:
    title = f' title="{escape(about)}"' if about else ""
    kind = ' data-words=""' if words else ""
    kind += ' class="stays"' if name == "frame" else ""
    text = escape(name).replace("_", "_<wbr>")  # where a heading may be broken on paper
    return f'<th scope="col"{kind}><button type="button"{title}>{text}</button></th>'


def _table(name: str, caption: str, head: str, rows: list[str]) -> str:
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{caption}">'
        f'<table id="{name}-table" class="sortable"><caption>{caption}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )
