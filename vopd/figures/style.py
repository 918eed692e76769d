"""The look of all figures: colours, fonts, sizes, captions; and files of them."""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any

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


SUFFIXES = (".png", ".svg", ".pdf")
_UNDATED: dict[str, dict[str, Any]] = {  # without dates, so that the same figure is the same file
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


@contextmanager
def matplotlib_figure(size_in: Inches) -> Iterator[Any]:
    """Open a new figure, with the style of all figures in force.

    Args:
        size_in: width and height, inches

    Raises:
        VopdError: where matplotlib is not installed
    """
    figure_class = _figure_class()
    with style():
        yield figure_class(figsize=size_in, layout="constrained")


def save(
    figure: Figure, suffix: str, dpi: int = 150, note: Callable[[str], object] = lambda _: None
) -> bytes:
    """Write the figure to a file; the same figure always gives the same bytes.

    Args:
        figure: what `draw` has made
        suffix: of `SUFFIXES`
        dpi: dots an inch, for .png
        note: is given a sentence if no installed font has some characters

    Raises:
        VopdError: where the figure cannot be written
    """
    file = io.BytesIO()
    with style(), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.execute(figure)
            figure.set_layout_engine(None)  # with one, savefig draws everything twice
        try:
            figure.savefig(file, format=suffix[1:], metadata=_UNDATED[suffix], dpi=dpi)
        except (ValueError, OverflowError, OSError) as error:
            if "SOURCE_DATE_EPOCH" not in os.environ:  # which PDF reads, whatever it has then
                raise
            raise VopdError("SOURCE_DATE_EPOCH is not a number of seconds since 1970") from error
        figure.set_layout_engine(engine)
    missing = {found[1] for one in warned if (found := MISSING.match(str(one.message)))}
    if missing and suffix != ".svg":
        names = ", ".join(sorted(chr(int(code)) for code in missing)[:5])
        note(f"no font has {names}; install Noto Sans CJK, or draw as .svg")
    for one in warned:
        if not (MISSING.match(str(one.message)) or "constrained_layout" in str(one.message)):
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
    return _renamed(file.getvalue()) if suffix == ".svg" else file.getvalue()


MISSING = re.compile(r"Glyph (\d+) .* missing from")


def _renamed(text: bytes) -> bytes:
    """Number the ids of an SVG in order: some of matplotlib's depend on memory addresses."""
    ids = dict.fromkeys(re.findall(rb'\bid="([^"]+)"', text))
    names = {old: b"v%d" % number for number, old in enumerate(ids)}
    return re.sub(rb'(\bid="|#)([^"#)]+)(?=["\)])', lambda m: m[1] + names.get(m[2], m[2]), text)


def svg(figure: Figure) -> str:
    """Write the figure as SVG text."""
    return save(figure, ".svg").decode("utf-8")


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
_SETTINGS: dict[Any, Any] = {
    "font.size": 9.0,
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


def caption(histories: Sequence[History]) -> str:
    """Write the caption: sources, the title if there is one job, and the fixes in force."""
    names = list(dict.fromkeys(h.about.source for h in histories))
    text = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    if len(histories) == 1:
        text += f", job {histories[0].about.job}: {histories[0].about.title}"
    else:
        text += f", {len(histories)} jobs"
    fixes = histories[0].about.fixes
    if fixes:
        text += f"\ncorrected run, not the original: {fixes}"
    return plain(text)


def label(history: History, histories: Sequence[History]) -> str:
    """Label a job in a legend."""
    sources = {h.about.source for h in histories}
    return plain(history.about.label if len(sources) > 1 else f"job {history.about.job}")


LONGEST_TEXT = 300  # characters


def plain(text: str) -> str:
    """Escape text for matplotlib: no formulas, and `?` for unprintable characters.

    Of a text that no figure has room for the end is left out.
    """
    if len(text) > LONGEST_TEXT:
        text = f"{text[: LONGEST_TEXT - 1]}…"
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text).replace("$", r"\$")


SHOWN = 16  # characters of a label that are shown


def short(label: str, most: int = SHOWN) -> str:
    """Shorten a label."""
    return label if len(label) <= most else f"{label[: most - 1]}…"
