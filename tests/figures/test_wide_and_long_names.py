"""Names that are long, wide, of other scripts: nothing leaves the figure or covers a mark."""

from __future__ import annotations

import warnings
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure

from tests.approved.texts import assert_approved
from tests.kit.command import DECKS, vopd
from tests.kit.histories import by_hand
from tests.kit.renamed_hill import ARABIC, JAPANESE, THAI, WIDE, renamed
from vopd.figures import draw, least_size_in
from vopd.figures.adjust import Change, draw_adjusted
from vopd.figures.residuals import MOST_SIGMAS, residual_points
from vopd.figures.style import (
    matplotlib_figure,
    plain,
    round_number,
    save,
    text_width_pt,
    wrapped,
)

pytestmark = [
    pytest.mark.filterwarnings(r"ignore:Glyph \d+"),
    pytest.mark.filterwarnings("ignore:Matplotlib currently does not support"),
]


def test_text_for_a_figure_and_round_numbers() -> None:
    """Of 300 characters all are drawn, of one more the last two are left out for three dots."""
    assert plain("a" * 300) == "a" * 300 and plain("a" * 301) == "a" * 299 + "…"
    assert plain("a\tb$") == r"a?b\$"
    assert [round_number(one) for one in (0.0, -3.0, float("nan"), 0.19, 7.0, 0.3 - 0.1)] == [
        1.0, 1.0, 1.0, 0.1, 5.0, 0.2,
    ]  # fmt: skip


class _Failing(Figure):
    """A figure that matplotlib cannot write, or warns of."""

    def __init__(self, what: BaseException | Warning) -> None:
        super().__init__()
        self._what = what

    def savefig(self, *given: Any, **named: Any) -> None:
        if isinstance(self._what, Warning):
            warnings.warn(self._what, stacklevel=1)
            super().savefig(*given, **named)
        else:
            raise self._what


def test_what_matplotlib_says_of_a_figure_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """But for missing letters, and a date that is none, which the user can mend."""
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    with pytest.raises(ValueError, match=r"^too large$"):
        save(_Failing(ValueError("too large")), ".png")
    with pytest.warns(UserWarning, match=r"^odd$"):
        assert save(_Failing(UserWarning("odd")), ".svg").startswith(b"<?xml")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = Figure()
        figure.text(0.5, 0.5, "\ue123")
        told: list[str] = []
        save(figure, ".png", note=told.append)
    assert len(told) == 1


@cache
def laid_out(name: str) -> Any:
    """A figure of the flight with long names as it is drawn; no test changes it."""
    figure = draw(name, [renamed()], 2)
    figure.draw_without_rendering()
    return figure


@pytest.mark.parametrize("name", ["image", "map", "residuals", "attitude"])
def test_no_text_leaves_the_figure(name: str) -> None:
    figure = laid_out(name)
    (part,) = figure.subfigs
    texts = [part._suptitle, *(text for axis in part.axes for text in axis.texts)]
    texts += [text for one in part.legends for text in one.get_texts()]
    for text in filter(lambda one: one.get_text(), texts):
        box = text.get_window_extent()
        assert box.x0 >= 0.0 and box.x1 <= figure.bbox.width, text.get_text()
    assert part._suptitle.get_window_extent().height < 0.25 * figure.bbox.height


@pytest.mark.parametrize("name", ["image", "map"])
def test_a_name_does_not_cover_its_mark(name: str) -> None:
    """And in the view from the side it stays within the panel."""
    (part,) = laid_out(name).subfigs
    for axis in part.axes:
        marks = [line for line in axis.lines if line.get_marker() in ("o", "^", "s")]
        at = np.vstack([axis.transData.transform(line.get_xydata()) for line in marks])
        names = [text for text in axis.texts if text.get_text()[:5] in shown_as]
        assert len(names) >= 4
        for text in names:
            box = text.get_window_extent()
            covered = (at > [box.x0, box.y0]).all(axis=1) & (at < [box.x1, box.y1]).all(axis=1)
            assert not covered.any(), text.get_text()
    side = part.axes[-1]
    near = side.bbox.width / 100.0  # the size of the panel is known to so much beforehand
    for text in side.texts if name == "map" else ():
        box = text.get_window_extent()
        assert box.x0 > side.bbox.x0 - near and box.x1 < side.bbox.x1 + near


shown_as = ("abcde", "WWWWW", "MMMMM", "@@@@@", f"\u200e{ARABIC[:4]}", JAPANESE[:5])


def test_names_in_titles_are_short() -> None:
    """In the line that explains a misfit, and where lines of sight miss most."""
    for name in ("image", "map"):
        title = " ".join(laid_out(name).subfigs[0].get_suptitle().split())
        assert "W" * 23 + "…" in title and ("(chance" in title or name == "map")
        assert "abcde fgh " * 3 not in title


def test_lines_of_a_title_are_as_wide_as_the_figure() -> None:
    with matplotlib_figure((4.0, 4.0)):
        lines = wrapped(f"first\n{WIDE}\n{'i' * 1000} {'word ' * 100}", 4.0).splitlines()
        widths = [text_width_pt(line, 9.0) for line in lines]
    assert lines[0] == "first" and max(widths) < 4.0 * 72.0
    assert len(max(lines, key=len)) > 3 * len(max((x for x in lines if "W" in x), key=len))
    assert "".join(lines).count("i") == "".join(lines).count("W") + 1  # of "first"
    inner = [width for line, width in zip(lines, widths, strict=True) if line.endswith("word")]
    assert all(width > 3.3 * 72.0 for width in inner[:-1])


def test_an_arabic_name_keeps_its_number_to_the_right() -> None:
    """Marks of the direction stand on both sides of it; of other names there are none."""
    (legend,) = [
        axis.get_legend() for axis in laid_out("residuals").subfigs[0].axes if axis.get_legend()
    ]
    texts = [text.get_text() for text in legend.get_texts()]
    (arabic,) = [text for text in texts if ARABIC in text]
    assert arabic.startswith(f"\u200e{ARABIC}\u200e: ")
    assert sum("\u200e" in text for text in texts) == 1


def test_letters_that_no_font_has() -> None:
    """Which font helps is said if one of those helps that are looked for."""
    notes: list[str] = []
    for text in (THAI, f"{THAI} {JAPANESE}", JAPANESE):
        with matplotlib_figure((4.0, 4.0)) as figure:
            figure.subplots().set_title(text, fontfamily="DejaVu Sans")
        for suffix in (".png", ".pdf", ".svg"):
            save(figure, suffix, note=notes.append)
    assert_approved(notes)


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_labels_at_both_sides_stay_in_the_file(suffix: str) -> None:
    """Also where letters are not fitted to dots, and so are wider."""
    changes = [Change("focal", "1495.00 → 1494.93 ± 0.21 px" * 2, 0.5, 0.25, stated=True)]
    rms_px = np.array([[2.0, 1.0], [2.0, 1.0]])
    figure = draw_adjusted("title", changes, ["0123456789" * 3], rms_px)
    save(figure, suffix, dpi=100)
    above, below, values = figure.axes
    figure.set_layout_engine(None)
    with mpl.rc_context({} if suffix == ".png" else {"text.hinting": "none"}):
        make: Any = RendererAgg
        renderer = make(1, 1, figure.dpi)
        right = max(text.get_window_extent(renderer).x1 for text in values.get_yticklabels())
        left = min(text.get_window_extent(renderer).x0 for text in below.get_yticklabels())
    assert 0.0 <= left < right <= figure.bbox.width
    assert above.bbox.width > 0.2 * figure.bbox.width


def test_a_frame_that_misfits_leaves_the_axis_of_sigmas_readable() -> None:
    """Thousands of sigmas are triangles at its edge; four frames of five are as expected."""
    sigmas = np.abs(residual_points([renamed()]).sigmas)
    assert sigmas.max() > 1000.0 and np.quantile(sigmas, 0.7) < 3.0
    axis = laid_out("residuals").subfigs[0].axes[4]
    assert axis.get_ylim()[1] < 2.2 * MOST_SIGMAS
    title = " ".join(laid_out("residuals").subfigs[0].get_suptitle().split())
    assert "sigma at the edge, as triangles" in title


def test_rows_of_residuals_are_equally_far_apart() -> None:
    """Beside a legend of six landmarks, in the smallest figure."""
    figure = draw("residuals", [renamed()], None, least_size_in("residuals"))
    figure.draw_without_rendering()
    boxes = [axis.get_window_extent() for axis in figure.subfigs[0].axes[::2]]
    first, second = (above.y0 - below.y1 for above, below in pairwise(boxes))
    assert max(first, second) < 1.5 * min(first, second)


def test_the_angles_stay_below_a_star_photograph_s_long_name(tmp_path: Path) -> None:
    """And the star that does not fit keeps its name."""
    rows = (DECKS / "stars" / "orion_misidentified.csv").read_text(encoding="utf-8").splitlines()
    head = rows.index("x_mm,y_mm,ra_deg,dec_deg,name")
    stars = tmp_path / "stars.csv"
    lines = [f"{rows[head]},image", *(f"{row}{'M' * 40},{WIDE[:400]}" for row in rows[head + 1 :])]
    stars.write_text("\n".join(lines), encoding="utf-8")
    solved, file = tmp_path / "solved.json", tmp_path / "a.svg"
    made = vopd("stars", "solve", stars, "--focal", "76", "--reject", "-q", "-o", solved)
    assert made.status == 0 and vopd("plot", solved, "-o", file).status == 0
    page = file.read_text(encoding="utf-8")
    assert "alpha 84.0000" in page and ": does not fit<" in page
    assert "W" * 30 in page and "W" * 100 not in page


@pytest.mark.parametrize("name", ["attitude", "residuals"])
def test_frames_without_times_have_whole_numbers(name: str) -> None:
    """Three images of a camera that stands."""
    one = by_hand(3, time_s=np.full(3, np.nan), frame=np.array([0, 1, 2]))
    figure = draw(name, [one])
    figure.draw_without_rendering()
    below = [axis for axis in figure.subfigs[0].axes if axis.get_xlabel() == "frame"]
    assert below
    for axis in below:
        low, high = axis.get_xlim()
        assert [tick for tick in axis.get_xticks() if low < tick < high] == [0.0, 1.0, 2.0]


@pytest.mark.parametrize("length", [1, 30, 300])
def test_a_legend_of_jobs_stays_in_the_figure(length: int) -> None:
    """In fewer columns if their sources have long names; of a very long one the end is shown."""
    jobs = [by_hand(3, said={"source": f"{'W' * length}{k}", "job": k + 1}) for k in range(3)]
    figure = draw("attitude", jobs)
    figure.draw_without_rendering()
    (legend,) = figure.subfigs[0].legends
    box = legend.get_window_extent()
    assert box.x0 >= 0.0 and box.x1 <= figure.bbox.width
    names = [text.get_text() for text in legend.get_texts()[:3]]
    assert [name.partition(",")[0][-2:] for name in names] == ["W0", "W1", "W2"]
    assert (legend._ncols == 4) == (length == 1)
