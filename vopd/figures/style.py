"""The look of all figures: colours, fonts, sizes, captions; and files of them."""

from __future__ import annotations

import io
import os
import re
import warnings
from bisect import bisect
from collections.abc import Callable, Iterator, Sequence
from colorsys import hls_to_rgb, rgb_to_hls
from contextlib import contextmanager
from functools import cache, partial
from math import floor, log10
from typing import TYPE_CHECKING, Any
from unicodedata import bidirectional, east_asian_width

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.conventions import doubts_text
from vopd.attitude.history import History
from vopd.files import optional_package
from vopd.findings import VopdError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Draw figures of attitude histories with matplotlib, which is imported when first needed.
#
# Every figure shows all histories it is given, those of several jobs and sources
# too. Lines break where frames are missing, between jobs, and where an angle wraps.

Inches = tuple[float, float]
NOTEBOOK_DPI = 100

SUFFIXES = (".png", ".svg", ".pdf")
_UNDATED: dict[str, dict[str, Any]] = {  # without dates, so that the same figure is the same file
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


@contextmanager
def matplotlib_figure(size_in: Inches) -> Iterator[Any]:
    """Open a new figure, with the style of all figures in force.

    It shows itself in a notebook, where matplotlib's own figures do so only behind pyplot.

    Raises:
        VopdError: where matplotlib is not installed
    """
    figure_class = _figure_class()
    with style():
        figure = figure_class(figsize=size_in, layout="constrained")
        figure._repr_png_ = partial(save, figure, ".png", NOTEBOOK_DPI)
        yield figure


def save(
    figure: Figure | Sequence[Figure],
    suffix: str,
    dpi: int = 150,
    note: Callable[[str], object] = lambda _: None,
) -> bytes:
    """Write a figure to a file; the same figure always gives the same bytes.

    Args:
        figure: what `draw` has made; several are pages of a .pdf
        suffix: of `SUFFIXES`
        dpi: dots an inch, for .png
        note: is given a sentence if no installed font has some characters

    Raises:
        VopdError: where the figure cannot be written
    """
    file = io.BytesIO()
    with style(), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            if isinstance(figure, Sequence):
                from matplotlib.backends.backend_pdf import PdfPages

                with PdfPages(file, metadata=_UNDATED[suffix]) as pages:
                    for page in figure:
                        with _laid_out(page):
                            pages.savefig(page)
            else:
                with _laid_out(figure, dpi if suffix == ".png" else None):
                    figure.savefig(file, format=suffix[1:], metadata=_UNDATED[suffix], dpi=dpi)
        except (ValueError, OverflowError, OSError) as error:
            if "SOURCE_DATE_EPOCH" not in os.environ:  # which PDF reads, whatever it has then
                raise
            raise VopdError("SOURCE_DATE_EPOCH is not a number of seconds since 1970") from error
    missing = {found[1] for one in warned if (found := MISSING.match(str(one.message)))}
    if missing and suffix != ".svg":
        letters = sorted(chr(int(code)) for code in missing)
        font = "install Noto Sans CJK, or " if all(map(_is_wide, letters)) else ""
        note(f"no font has {', '.join(letters[:5])}; {font}draw as .svg")
    for one in warned:
        text = str(one.message)
        if not (MISSING.match(text) or "constrained_layout" in text or UNSHAPED in text):
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
    return _renamed(file.getvalue()) if suffix == ".svg" else file.getvalue()


@contextmanager
def _laid_out(figure: Figure, dpi: int | None = None) -> Iterator[None]:
    """Divide the room of a figure among its panels once: with its engine all is drawn twice.

    Args:
        figure: the figure
        dpi: for which letters are fitted to dots; None: they are not, as in .svg and .pdf
    """
    import matplotlib as mpl

    engine = figure.get_layout_engine()
    if engine is not None:
        own = figure.dpi
        figure.set_dpi(dpi or own)
        with mpl.rc_context({} if dpi else {"text.hinting": "none"}):
            engine.execute(figure)
            engine.execute(figure)  # labels beside narrow panels have their room the second time
        figure.set_layout_engine(None)
        figure.set_dpi(own)
    yield
    figure.set_layout_engine(engine)


UNSHAPED = "does not support"  # of Arabic names, by matplotlib before 3.11
MISSING = re.compile(r"Glyph (\d+) .* missing from")


def _renamed(text: bytes) -> bytes:
    """Number the ids of an SVG in order: some of matplotlib's depend on memory addresses."""
    ids = dict.fromkeys(re.findall(rb'\bid="([^"]+)"', text))
    names = {old: b"v%d" % number for number, old in enumerate(ids)}
    return re.sub(rb'(\bid="|#)([^"#)]+)(?=["\)])', lambda m: m[1] + names.get(m[2], m[2]), text)


def svg(figure: Figure) -> str:
    """Write the figure as SVG text that is light or dark, as the page is that shows it."""
    text = save(figure, ".svg").decode("utf-8")
    found = dict.fromkeys(colour for _, colour in HEX.findall(text))
    colours = {one: f"--c{k}" for k, one in enumerate(found)}
    names = {"light": dict(zip(colours.values(), colours, strict=True))}
    names["dark"] = {name: _on_dark(one) for name, one in names["light"].items()}
    light, dark = (
        "".join(f"{name}:{one};" for name, one in scheme.items()) for scheme in names.values()
    )
    rules = f":root{{{light}fill:#000000}}@media (prefers-color-scheme:dark)"
    rules += f"{{:root{{{dark}fill:{_on_dark('#000000')}}}}}"
    text = HEX.sub(lambda found: f"{found[1]}var({colours[found[2]]})", text)
    return text.replace("</style>", f"{rules}</style>", 1)


HEX = re.compile(r'([:"] ?)(#[0-9a-f]{6})(?=[;"])')  # as the value of a property, no part of a name
DARK_RGB, LIGHT_RGB = (22, 24, 27), (232, 232, 232)  # ground and text of a dark page


def _on_dark(colour: str) -> str:
    """Choose the colour on a dark page: greys are turned round, other colours are made lighter."""
    rgb = [int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    hue, light, strong = rgb_to_hls(*rgb)
    if strong < 0.1:
        made = [a + (b - a) * light for a, b in zip(LIGHT_RGB, DARK_RGB, strict=True)]
    else:
        made = [255.0 * one for one in hls_to_rgb(hue, 0.42 + 0.45 * light, min(strong, 0.75))]
    return "#" + "".join(f"{round(one):02x}" for one in made)


def ready() -> None:
    """Check that matplotlib is installed.

    Raises:
        VopdError: where matplotlib is not installed
    """
    _figure_class()


def _figure_class() -> Any:
    return optional_package("matplotlib.figure", "plots").Figure


# The look of all figures: colours that the colour-blind can tell apart, sizes, captions.

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")  # Okabe and Ito
FLAGGED = "#b30000"
TITLE_PT = 9.0  # size of all letters but names, points
_SETTINGS: dict[Any, Any] = {
    "font.size": TITLE_PT,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "svg.hashsalt": "vopd",
    "svg.fonttype": "none",  # texts are texts: the viewer has fonts for them
    "path.simplify": True,
}


@contextmanager
def style() -> Iterator[None]:
    """Apply the style for drawing and saving a figure, and restore the old settings afterwards."""
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        mpl.rcParams["font.family"] = [*mpl.rcParams["font.family"], *_more_fonts()]
        yield


MORE_FONTS = (
    "Noto Sans CJK JP", "Noto Sans CJK SC", "Noto Sans JP", "Noto Sans SC", "Source Han Sans",
    "IPAexGothic", "IPAGothic", "TakaoPGothic", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei",
    "Droid Sans Fallback", "Hiragino Sans", "Yu Gothic", "MS Gothic", "PingFang SC",
    "Microsoft YaHei", "SimHei", "Noto Sans KR", "Malgun Gothic", "Apple SD Gothic Neo",
    "Arial Unicode MS",
)  # fmt: skip
"""Fonts for Japanese, Chinese and Korean names, which matplotlib's own font does not have."""


@cache
def _more_fonts() -> list[str]:
    """List those of `MORE_FONTS` that are installed."""
    from matplotlib.font_manager import fontManager

    installed = {font.name for font in fontManager.ttflist}
    return [name for name in MORE_FONTS if name in installed]


MOST_DOUBTS = 3  # sources of which a caption says how they are contradicted
SOURCE_SHOWN = 80  # characters of the path of a source: its end
TITLE_SHOWN = 100  # characters of a job's title: those of a card and some more


def caption(histories: Sequence[History]) -> str:
    """Write the caption: sources, the title if there is one job, fixes in force, misfits."""
    names = list(dict.fromkeys(h.about.source for h in histories))
    text = ", ".join(short_start(one, SOURCE_SHOWN) for one in names[:3])
    text += f" and {len(names) - 3} more" if len(names) > 3 else ""
    if len(histories) == 1:
        about = histories[0].about
        text += f", job {about.job}" if about.words.jobs else ""
        text += f": {short(about.title, TITLE_SHOWN)}" if about.title else ""
    else:
        text += f", {len(histories)} jobs"
    fixes = histories[0].about.fixes
    if fixes:
        text += f"\ncorrected run, not the original: {fixes}"
    return "\n".join(map(plain, [text, *doubts_text(histories)[:MOST_DOUBTS]]))


def label(history: History, histories: Sequence[History]) -> str:
    """Label a job in a legend."""
    sources = {h.about.source for h in histories}
    text = history.about.label if len(sources) > 1 else f"job {history.about.job}"
    return plain(short_start(text, LABEL_SHOWN))


LABEL_SHOWN = 60  # characters of a job's label: the end, as it is of a path


def legend_below(figure: Any, handles: Sequence[Any], texts: Sequence[str], most: int) -> None:
    """Put a legend below the panels, in so many columns as the figure has room for.

    Args:
        figure: or part of one
        handles: of the marks
        texts: beside them
        most: columns
    """
    widths = [max(text_width_pt(line, TITLE_PT) for line in one.split("\n")) for one in texts]
    wide_pt = np.array(widths) + HANDLE_PT
    room_pt = LEGEND_MARGIN * 72.0 * figure.bbox.width / figure.dpi
    columns = most
    while columns > 1 and _columns_pt(wide_pt, columns) > room_pt:
        columns -= 1
    figure.legend(handles, texts, loc="outside lower center", ncols=columns)


def _columns_pt(wide_pt: Floats, columns: int) -> float:
    """Add up the widths of columns, which are filled one after the other."""
    return sum(float(one.max(initial=0.0)) for one in np.array_split(wide_pt, columns))


HANDLE_PT = 46.0  # width of a mark of a legend with the room around it


LONGEST_TEXT = 300  # characters


def plain(text: str) -> str:
    """Escape text for matplotlib: no formulas, and `?` for unprintable characters.

    Of a text that no figure has room for the end is left out.
    """
    if len(text) > LONGEST_TEXT:
        text = f"{text[: LONGEST_TEXT - 1]}…"
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text).replace("$", r"\$")


MARGIN = 0.89  # of a figure's width for a line of a title: letters fitted to few dots are wider
LEGEND_MARGIN = 0.94  # the same for a legend


def wrapped(text: str, width_in: float) -> str:
    """Break the lines of a title where they would leave the figure, long words too.

    Args:
        text: the title, of the size `TITLE_PT`
        width_in: of the figure, inches
    """
    most = MARGIN * width_in * 72.0
    lines = []
    for line in text.splitlines():
        begun = ""
        for word in line.split():
            joined = f"{begun} {word}" if begun else word
            if text_width_pt(joined, TITLE_PT) <= most:
                begun = joined
                continue
            lines += [begun] if begun else []
            while text_width_pt(word, TITLE_PT) > most:
                fits = range(1, len(word))
                here = max(1, bisect(fits, most, key=lambda n: text_width_pt(word[:n], TITLE_PT)))
                lines.append(word[:here])
                word = word[here:]
            begun = word
        lines.append(begun)
    return "\n".join(lines)


def text_width_pt(text: str, size_pt: float, bold: bool = False) -> float:
    """Measure one line of text in the fonts of the figures, points.

    Args:
        text: as matplotlib takes it (`plain`)
        size_pt: of the letters
        bold: whether they are
    """
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(size=size_pt, weight="bold" if bold else "normal")
    shown = "".join("W" if _is_wide(c) else c for c in text.replace(r"\$", "$"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of letters that no font has: `save` names them
        width, _, _ = text_to_path.get_text_width_height_descent(shown, font, ismath=False)
    return float(width)


def _is_wide(letter: str) -> bool:
    """Tell whether a letter is as wide as it is high, as Chinese ones are."""
    return east_asian_width(letter) in "WF"


SHOWN = 16  # characters of a label that are shown


def short(label: str, most: int = SHOWN) -> str:
    """Shorten a label."""
    return label if len(label) <= most else f"{label[: most - 1]}…"


def short_start(label: str, most: int) -> str:
    """Shorten a label whose end tells it from others, as a path or the name of an image."""
    return label if len(label) <= most else f"…{label[1 - most :]}"


def name_text(name: str, most: int = SHOWN) -> str:
    """Write a name for matplotlib, short, and so that what follows stays to its right.

    Args:
        name: of a landmark, star or parameter
        most: characters that are shown
    """
    text = plain(short(name, most))
    if any(bidirectional(c) in ("R", "AL") for c in text):
        return f"{LEFT_TO_RIGHT}{text}{LEFT_TO_RIGHT}"
    return text


LEFT_TO_RIGHT = "\u200e"  # about an Arabic or Hebrew name: the text around it keeps its order


# Names beside their points, none over another

NAME_PT = 8.0  # size of names, points
APART_PT = 7.0  # from a point to its name
SIDES = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1))


def halo(width: float = 2.5) -> list[Any]:
    """Outline marks in white, so that they are seen on a photograph."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground="white")]


BEHIND = {"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.6}
"""A ground for texts on a photograph: with an outline they would be no text in an .svg."""


def place_names(
    axis: Any,
    points: Floats,
    names: Sequence[str],
    points_per_unit: Floats,
    inside: Floats,
    bold: Bools | None = None,
    avoid: Floats | None = None,
) -> int:
    """Write names beside their points where no other name or point is; gives how many have no room.

    Args:
        axis: the panel
        points: in its coordinates, the most important first, (n, 2)
        names: of the points
        points_per_unit: how large a unit is drawn along x and y, points; negative where the
            coordinate grows to the left or down
        inside: corners of the area that names stay in, (2, 2)
        bold: which are written bold, (n,)
        avoid: further points that no name covers if there is another place, as those along
            arrows, (m, 2)
    """
    centre = points * points_per_unit
    marks = np.hstack([centre - 4.0, centre + 4.0])
    taken = marks[:0]
    low, high = np.sort(inside * points_per_unit, axis=0)
    lines = np.zeros((0, 2)) if avoid is None else avoid * points_per_unit
    left_out = 0
    for k, name in enumerate(names):
        strong = bold is not None and bool(bold[k])
        wide = text_width_pt(name, NAME_PT, strong) + 0.5 * NAME_PT
        half = np.array([wide, 1.3 * NAME_PT]) / 2.0
        others = np.vstack([np.delete(marks, k, axis=0), taken])
        best: tuple[int, Any, Any] | None = None
        for side in SIDES:
            middle = centre[k] + np.array(side) * (half + APART_PT * (0.6 if all(side) else 1.0))
            box = np.concatenate([middle - half, middle + half])
            over = (others[:, :2] < box[2:]).all(axis=1) & (others[:, 2:] > box[:2]).all(axis=1)
            if over.any() or not ((box[:2] >= low).all() and (box[2:] <= high).all()):
                continue
            crossed = int(((lines > box[:2]) & (lines < box[2:])).all(axis=1).sum())
            if best is None or crossed < best[0]:
                best = crossed, middle, box
        if best is None:
            left_out += 1
            continue
        _, middle, box = best
        taken = np.vstack([taken, box])
        axis.annotate(
            name, points[k], middle - centre[k], textcoords="offset points", ha="center",
            va="center", fontsize=NAME_PT, bbox=BEHIND, annotation_clip=True, zorder=6,
            fontweight="bold" if strong else "normal",
        )  # fmt: skip
    return left_out


def width_in(figure: Any) -> float:
    """Find the width of a figure, or of a part of one, inches."""
    return float(figure.bbox.width / figure.dpi)


def round_number(number: float) -> float:
    """Round down to one of 1, 2, 5, 10, 20 ...; 1 for a number not above 0."""
    if not number > 0.0:
        return 1.0
    power = 10.0 ** floor(log10(number))
    return next(step for step in (5.0, 2.0, 1.0) if step * power <= number * (1 + 1e-9)) * power
