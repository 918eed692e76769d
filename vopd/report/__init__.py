"""The report: one HTML page about flights and decks that needs no other file."""

from __future__ import annotations

import base64
import hashlib
import io
from collections.abc import Callable, Sequence
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.conventions import conventions, reading_sigma_text
from vopd.attitude.findings import errata_text, misfits, summary_of
from vopd.attitude.flags import meanings
from vopd.attitude.history import History, has_photographs
from vopd.attitude.included import one_turn_texts
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.summary import where_text
from vopd.figures import FIGURES, draw, drawn_jobs, figure_names, left_out_text
from vopd.figures.adjust import draw_adjusted
from vopd.figures.style import ready, svg
from vopd.files import optional_package, readable
from vopd.findings import VopdError, count_text
from vopd.report.answer import MOST, Sigma, angle_table, doubts, not_included, sigmas_in_force
from vopd.report.frames import (
    WORDS,
    frames_json,
    residual_directions,
    residual_names,
    shown_columns,
    undrawn,
)

if TYPE_CHECKING:
    from jinja2 import Template


Column = tuple[str, str, bool]
"""Of a table on the page: its name, its meaning, and whether it is sorted as words."""
Table = tuple[list[Column], list[list[str]]]
"""The columns of a table, and its rows of cells."""


def report(
    histories: Sequence[History],
    messages: Sequence[str] = (),
    max_rate_deg_s: float | None = None,
    failed: bool = False,
    photographs: bool = False,
    on_missing: Callable[[str], None] = lambda _: None,
) -> bytes:
    """Make the page about all jobs, in UTF-8; without matplotlib it has no figure and says so.

    Args:
        histories: one or more jobs, of one kind of source
        messages: warnings and errors, shown as they are
        max_rate_deg_s: the limit of the flag `jump` that they were made with
        failed: whether a source failed, which the page says at its head
        photographs: whether the page has the photographs of its frames, reduced
        on_missing: takes the sentence about photographs that are missing, which the page has, too

    Raises:
        VopdError: where jinja2 is not installed, or no frame has an attitude
    """
    template = page_template("page.html")
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame has an attitude")
    try:
        ready()
        no_figures = ""
    except VopdError as error:
        no_figures = str(error)
    pictures, no_photographs = embedded_photographs(histories) if photographs else ([], "")
    if no_photographs:
        on_missing(no_photographs)
    elif not photographs and any(map(has_photographs, histories)):
        no_photographs = LEFT_OUT
    page = template.render(
        about=histories[0].about,
        photographs=pictures,
        no_photographs=no_photographs,
        sources=", ".join(dict.fromkeys(h.about.source for h in histories)),
        failed=failed,
        summary=summary(histories),
        messages=messages,
        figures=[] if no_figures else embedded_figures(histories),
        no_figures=no_figures,
        left_out="" if no_figures else left_out_text(histories),
        jobs=job_table(histories),
        frames=frames_json(histories),
        columns=shown_columns(histories),
        undrawn=undrawn(histories),
        words=(*WORDS, histories[0].about.words.source),
        job_labels=[h.about.label for h in histories],
        residual_names=residual_names(histories[0].estimate.units),
        angles=angle_table(histories),
        where=where_text(one.estimate for one in histories),
        one_turn=one_turn_texts(histories)[:MOST],
        doubts=doubts(histories),
        not_included=not_included(histories),
        flags=flag_rows(histories),
        landmarks=landmark_table(histories),
        uncertainty=uncertainty_sentences(histories, max_rate_deg_s),
        conventions=conventions(histories),
        **style_and_script(),
    )
    return page.encode("utf-8", "replace")


LEFT_OUT = "Photographs are left out: vopd report --photographs puts them into the images below."


def check_ready() -> None:
    """Check that a report can be made.

    Raises:
        VopdError: where jinja2 is not installed
    """
    page_template("page.html")


COLUMNS: tuple[Column, ...] = (
    ("source", "the name of its outputs", True),
    ("status", "solved, misfits (a flight), not converged (some frame) or failed", True),
    ("frames", "of all its jobs", False),
    ("attitudes", "frames with an attitude", False),
    ("not_converged", "frames that did not converge", False),
    ("flagged", "frames with any flag", False),
    ("warnings", "about cards, files and frames", False),
    ("flags", "frames with each flag", True),
    ("error", "why it failed", True),
)
"""The columns of the page of a batch: a row for each source."""


def batch_page(
    rows: Sequence[tuple[str | None, Sequence[object]]], totals: str, failed: int
) -> bytes:
    """Make the page about a batch, in UTF-8: a row for each source, with a link to its report.

    Args:
        rows: the sources, the worst first: the file of each report, relative to the page, or
            None where it has none, and the values of `COLUMNS`
        totals: a sentence about all
        failed: how many failed

    Raises:
        VopdError: where jinja2 is not installed
    """
    linked = [
        ("" if file is None else "./" + quote(file.encode("utf-8", "surrogateescape")), cells)
        for file, cells in rows
    ]
    page = page_template("batch.html").render(
        rows=linked, totals=totals, failed=failed, columns=COLUMNS, **style_and_script()
    )
    return page.encode("utf-8", "replace")


def page_template(name: str) -> Template:
    """Load a template of this folder, which escapes every text that is put into it.

    Raises:
        VopdError: where jinja2 is not installed
    """
    jinja2 = optional_package("jinja2", "report")
    loader = jinja2.FunctionLoader(_file)
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, loader=loader, finalize=_readable
    )
    template: Template = environment.get_template(name)
    return template


def _readable(value: object) -> object:
    """Write the control characters of a text, as of a landmark's name, as on a terminal."""
    return readable(value) if type(value) is str else value


def style_and_script(name: str = "page") -> dict[str, str]:
    """Fill in `style`, `script` and `policy` of a template.

    The policy, of content security, allows this style, this script and embedded images only.

    Args:
        name: of both files of this folder, without the suffix
    """
    style, script = _file(f"{name}.css"), _file(f"{name}.js")
    allowed = [
        f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
        for text in (style, script)
    ]
    policy = (
        f"default-src 'none'; img-src data:; style-src {allowed[0]}; "
        f"script-src {allowed[1]}; base-uri 'none'; form-action 'none'"
    )
    return {"style": style, "script": script, "policy": policy}


def _file(name: str) -> str:
    return (files("vopd.report") / name).read_text(encoding="utf-8")


# Summary, and sentences about the uncertainty

MOST_SHOWN = 6  # explanations of frames that misfit


def summary(histories: Sequence[History]) -> dict[str, str]:
    """Summarise frames, the span of time and medians, with the title of a single job."""
    units, words = histories[0].estimate.units, histories[0].about.words
    status = [word for h in histories for word in h.status]
    counts = (f"{status.count(word)} {word}" for word in dict.fromkeys(status))
    has = np.concatenate([h.has_attitude for h in histories])
    flagged = np.concatenate([h.flags.any() for h in histories])
    strays = np.concatenate([h.flags.raised["not_converged"] for h in histories])
    rms = np.concatenate([h.residual_rms for h in histories])[has] * units.residuals_per_image
    rows = {
        "Jobs": str(len(histories)),
        "Frames": f"{len(status)}: {', '.join(counts)}",
        "Frames with an attitude": str(int(has.sum())),
        "Frames with a flag": str(int(flagged.sum())),
        "Frames that did not converge": str(int(strays.sum())),
        "Frames that misfit": _misfits(histories),
        **_errata(histories),
        "Time": _span(np.concatenate([h.estimate.time_s for h in histories])[has]),
        "Median residual (root mean square)": _median(rms, f"{units.residual} {words.surface}"),
    }
    if len(histories) == 1:
        frames = count_text(len(status), "frame")
        rows[histories[0].about.label] = f"{histories[0].about.title or 'no title'}; {frames}"
    return rows


def _misfits(histories: Sequence[History]) -> str:
    """Count the frames that misfit, with their explanations."""
    count = sum(int(h.flags.raised["misfit"].sum()) for h in histories)
    texts: list[str] = []
    for h in histories:
        repairs, _ = misfits(summary_of([h]))
        job = f"{h.about.label}, " if len(histories) > 1 else ""
        texts += [f"{job}{frames}: {repair}" for frames, repair in repairs]
    more = ["others: see the table of frames"] if len(texts) > MOST_SHOWN else []
    return "; ".join([str(count), *texts[:MOST_SHOWN], *more])


def _errata(histories: Sequence[History]) -> dict[str, str]:
    """Say how far the errata change each job of a run that has them."""
    if all(h.estimate.slip_effect_deg is None for h in histories):
        return {}
    texts = []
    for h in histories:
        if told := errata_text(summary_of([h])):
            texts.append((f"{h.about.label}: " if len(histories) > 1 else "") + told)
    more = [f"{len(texts) - MOST_SHOWN} more jobs likewise"] if len(texts) > MOST_SHOWN else []
    none = "their effect on every angle is below its standard deviation"
    return {"Errata of the original program": "; ".join([*texts[:MOST_SHOWN], *more]) or none}


def _span(time_s: Floats) -> str:
    known = time_s[np.isfinite(time_s)]
    return f"{known.min():.3f} to {known.max():.3f} s" if len(known) else "unknown"


def _median(values: Floats, unit: str) -> str:
    known = values[np.isfinite(values)]
    return f"{np.median(known):.4g} {unit}".strip() if len(known) else "unknown"


def uncertainty_sentences(histories: Sequence[History], max_rate_deg_s: float | None) -> list[str]:
    """Say where the standard deviations come from."""
    sentences = [
        "Intervals are those of 95 %. Standard deviations are those of the attitude angles by the "
        "partials of the collinearity equations. The readings of a job have one standard "
        "deviation, estimated from the residuals of all its frames, and never below the spread of "
        "repeated readings or the resolution of the readings. Few degrees of freedom widen the "
        "intervals by the factor of Student's t, not the standard deviations."
    ]
    if len(histories) == 1:
        (h,) = histories
        sentences.append(
            f"{h.about.label}: the standard deviation of {h.about.words.reading} is "
            f"{reading_sigma_text(h)}."
        )
        sentences.append(f"{h.about.label}: other standard deviations: {other_sigmas_text(h)}.")
    else:
        sentences.append("The table of jobs has the standard deviations of each job.")
    if max_rate_deg_s is None:
        sentences.append("Jumps were not looked for: no --max-rate was given.")
    else:
        sentences.append(
            f"Frames that turn faster than {max_rate_deg_s:g} degrees a second are jumps."
        )
    return sentences


def other_sigmas_text(history: History) -> str:
    """List the standard deviations in force besides that of the readings, with units.

    Args:
        history: the job
    """
    stated = [
        f"{what} {_size(value)} {unit}"
        for what, unit, value in sigmas_in_force(history)
        if np.any(value)
    ]
    return "; ".join(stated) or "none stated"


def _size(value: Sigma) -> str:
    """Write one number, several with commas if they differ, or the range of those of many rows."""
    if np.ndim(value) > 1:
        some = np.asarray(value)[np.asarray(value) > 0.0]
        value = (float(some.min()), float(some.max()))
        return " to ".join(dict.fromkeys(f"{one:.3g}" for one in value))
    return ", ".join(dict.fromkeys(f"{one:.3g}" for one in np.atleast_1d(value)))


# Tables of jobs, flags and landmarks


def job_table(histories: Sequence[History]) -> Table:
    """Tabulate the jobs, one row each."""
    words, units = histories[0].about.words, histories[0].estimate.units
    several = _several(histories)
    columns = [
        ("job", "its number", False),
        *([(words.source, "", True)] if several else []),
        ("title", "", True),
        ("frames", "of the job", False),
        ("attitudes", "frames with an attitude", False),
        ("not_converged", "frames that did not converge", False),
        ("misfit", "frames whose residuals do not agree with the standard deviations", False),
        ("flagged", "frames with any flag", False),
        (f"reading_sigma_{units.image}", f"standard deviation of {words.reading}", False),
        ("from", "where that is from, and how well it is known", True),
        ("other standard deviations", "those in force", True),
    ]
    return columns, [_job_row(h, several) for h in histories]


def _job_row(h: History, several: bool) -> list[str]:
    raised = h.flags.raised
    _, _, source = reading_sigma_text(h).partition(", ")
    return [
        str(h.about.job),
        *([h.about.source] if several else []),
        h.about.title,
        str(len(h.status)),
        str(int(h.has_attitude.sum())),
        str(int(raised["not_converged"].sum())),
        str(int(raised["misfit"].sum())),
        str(int(h.flags.any().sum())),
        f"{h.uncertainty.reading.sigma:.3g}",
        source,
        other_sigmas_text(h),
    ]


def flag_rows(histories: Sequence[History]) -> list[tuple[str, int, str, str]]:
    """List every flag: its name, how many frames have it, its meaning, and what to do."""
    return [
        (name, sum(int(h.flags.raised[name].sum()) for h in histories), meaning, advice)
        for name, (meaning, advice) in meanings(histories[0].about.words).items()
    ]


def landmark_table(histories: Sequence[History]) -> Table:
    """Tabulate the statistics of the residuals of each landmark of each job."""
    units, words = histories[0].estimate.units, histories[0].about.words
    several = _several(histories)
    right, down = residual_directions(units)
    columns = [
        ("landmark", words.landmark, bool(histories[0].estimate.landmark_names)),
        *([(words.source, "", True)] if several else []),
        ("job", "", False),
        ("frames", "in which it takes part", False),
        ("ignored", "frames from which it is left out", False),
        (f"mean {right}, {units.residual}", "of the residuals", False),
        (f"mean {down}, {units.residual}", "of the residuals", False),
        (f"rms {right[0]}, {units.residual}", "root mean square of the residuals", False),
        (f"rms {down[0]}, {units.residual}", "root mean square of the residuals", False),
        (f"largest, {units.residual}", "the longest residual", False),
        ("in frame", "where that is", bool(histories[0].estimate.frame_names)),
        ("outlier", "frames in which it is the outlier", False),
    ]
    return columns, [row for h in histories for row in _frame_landmarks(h, several)]


def _several(histories: Sequence[History]) -> bool:
    return len({h.about.source for h in histories}) > 1


def _frame_landmarks(h: History, several: bool) -> list[list[str]]:
    e = h.estimate
    of = frame_landmarks(h)
    residual = of.residual * e.units.residuals_per_image
    if e.units.image == "px":  # as they are picked
        residual = -residual
    here = of.used & np.isfinite(residual).all(axis=1)
    rows = []
    for number in np.unique(of.landmark[here | of.ignored]).tolist():
        mine = here & (of.landmark == number)
        left_out = int((of.ignored & (of.landmark == number)).sum())
        outlier = int((of.outlier & (of.landmark == number)).sum())
        frames = of.frame[mine]
        rows.append([
            e.landmark_label(number),
            *([h.about.source] if several else []),
            str(h.about.job),
            str(len(frames)),
            str(left_out),
            *_statistics(residual[mine]),
            e.frame_label(_worst(residual[mine], frames)) if len(frames) else "",
            str(outlier),
        ])  # fmt: skip
    return rows


def _statistics(residual: Floats) -> list[str]:
    """Calculate mean x and y, root mean square x and y, and the largest, of residuals (n, 2)."""
    if not len(residual):
        return [""] * 5
    numbers = [*residual.mean(axis=0), *np.sqrt((residual**2).mean(axis=0))]
    return [f"{value:.3f}" for value in (*numbers, np.hypot(*residual.T).max())]


def _worst(residual: Floats, frames: Ints) -> int:
    """Find the frame, by its index, with the longest residual."""
    return int(frames[np.hypot(*residual.T).argmax()])


# Figures: the page draws what belongs to a frame itself, and these show all frames at once


class Figured(NamedTuple):
    """A figure of the page; its addresses hold the SVG itself."""

    name: str
    title: str
    caption: str
    address: str
    small: str = ""  # of a form for narrow screens


PHONE_IN = {"residuals": (4.2, 9.5), "patches": (4.2, 6.5)}  # width and height
CAPTIONS = {
    "residuals": "Residuals of all frames: against time, a line for each landmark, and in their "
    "standard deviations; of one image by landmark. The numbers are in the table of landmarks.",
    "patches": "Each landmark as it was clicked, and as it was found in other frames: the patches "
    "of a row are alike if they are of the same point.",
}


ADJUSTED = (
    "What [solve] free has changed: each parameter in its standard deviations, and the residuals "
    "of each landmark with all parameters as stated and as solved."
)


def embedded_figures(histories: Sequence[History]) -> list[Figured]:
    """Draw the figures of all frames.

    Photographs are not in the page, but for the patches of clicks that were followed.
    """
    figures = []
    for name in [one for one in figure_names("all", histories) if one in CAPTIONS]:
        kind = FIGURES[name]
        try:
            drawn = draw(name, histories)
        except VopdError:
            if name != "patches":
                raise
            continue  # a video that is elsewhere
        small = draw(name, histories, size_in=PHONE_IN[name])
        figures.append(
            Figured(name, kind.title, CAPTIONS[name], _data_uri(drawn), _data_uri(small))
        )
    for k, h in enumerate(drawn_jobs(histories)):
        adjusted = h.estimate.scene().adjusted if h.estimate.scene is not None else None
        if adjusted is not None:
            drawn = draw_adjusted(h.about.source, *adjusted())
            figures.append(Figured(f"adjusted-{k}", "Adjusted", ADJUSTED, _data_uri(drawn)))
    return figures


def _data_uri(drawn: Any) -> str:
    """Write a figure as SVG in an address."""
    return f"data:image/svg+xml;base64,{base64.b64encode(svg(drawn).encode()).decode()}"


MOST_PX, QUALITY = 1024, 80  # of photographs in the page: width or height, and JPEG


def embedded_photographs(histories: Sequence[History]) -> tuple[list[tuple[int, str]], str]:
    """Read the photographs of all frames with an attitude, reduced, as base64 of JPEG.

    Args:
        histories: the jobs

    Returns:
        The number of each frame in the table, with its photograph; and why some are missing.
    """
    found: list[tuple[int, str]] = []
    why: list[str] = []
    first = 0
    for h in histories:
        e, frames = h.estimate, np.flatnonzero(h.has_attitude).tolist()
        read = e.scene().photographs if e.scene else None
        if read is None:
            why.append(f"{h.about.label}: the project names no photographs")
            frames = []
        names = [e.frame_key(k) for k in frames]
        for place, picture in read(names) if read else ():
            if isinstance(picture, VopdError):
                why.append(f"frame {e.frame_label(frames[place])}: {picture}")
                continue
            picture.thumbnail((MOST_PX, MOST_PX))
            file = io.BytesIO()
            picture.convert("RGB").save(file, "JPEG", quality=QUALITY)
            found.append((first + frames[place], base64.b64encode(file.getvalue()).decode()))
        first += len(h.status)
    more = f"; {len(why) - 1} more likewise" if len(why) > 1 else ""
    return found, f"Without a photograph: {why[0]}{more}" if why else ""
