"""What `draw` hands to each kind of figure and puts around it, and what `save` writes."""

from __future__ import annotations

import sys
from typing import Any, ClassVar

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

import vopd.figures as figures
from tests.approved.texts import refused
from tests.kit.histories import by_hand
from vopd.figures import FIGURES, draw, least_size_in, matplotlib_figure, ready, refuse_small, save
from vopd.findings import VopdError

KINDS = {  # title, usual size, smallest size
    "attitude": ("Camera and vehicle attitude", (9, 8), (7.5, 6)),
    "attack": ("Angles of attack", (9, 7), (5, 5.5)),
    "residuals": ("Residuals by landmark", (9, 5), (5, 3.5)),
    "image": ("One frame's image", (9, 6.5), (6, 4)),
}
LEAST = {name: kind[2] for name, kind in KINDS.items()} | {"all": (7.5, 20.8)}  # 26.5 / 7 * 5.5
WORST = "the most frames that did not converge, misfit or have a flag"


def test_the_kinds() -> None:
    assert [(name, kind[1:]) for name, kind in FIGURES.items()] == list(KINDS.items())


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """Every figure that is drawn: its name, part, histories, frame. Each says its name."""
    seen: list[tuple[Any, ...]] = []

    def stands_for(name: str) -> Any:
        def note(part: Any, histories: Any, frame: Any) -> str:
            grid = mpl.rcParams["axes.grid"]  # part of the style
            seen.append((name, part, list(histories), frame, grid))
            return f"said by {name}"

        return note

    for name in KINDS:
        monkeypatch.setitem(FIGURES, name, FIGURES[name]._replace(draw=stands_for(name)))
    return seen


@pytest.mark.parametrize("name", KINDS)
def test_one_figure(name: str, asked: list[tuple[Any, ...]]) -> None:
    jobs = [by_hand(3), by_hand(2)]
    figure = draw(name, jobs, 7)
    ((drawn, part, histories, frame, grid),) = asked
    assert (drawn, histories, frame, grid) == (name, jobs, 7, True)
    assert not mpl.rcParams["axes.grid"]
    assert part.get_suptitle() == f"{KINDS[name][0]}\nsaid by {name}"
    assert part._suptitle.get_fontsize() == 9.0  # "medium" of the style
    assert figure.get_size_inches().tolist() == list(KINDS[name][1])
    assert isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine)
    assert draw(name, jobs, size_in=(11.0, 9.5)).get_size_inches().tolist() == [11.0, 9.5]
    assert asked[-1][3] is None


def test_all_figures(asked: list[tuple[Any, ...]]) -> None:
    """One below the other, as high as each is alone."""
    figure = draw("all", [by_hand(3)], "DJI_0001.JPG")
    assert [one[0] for one in asked] == list(KINDS)
    assert [one[1] for one in asked] == list(figure.subfigs)
    assert {one[3] for one in asked} == {"DJI_0001.JPG"}
    assert figure.get_size_inches().tolist() == [9.0, 26.5]
    assert figure.subfigs[0]._subplotspec.get_gridspec().get_height_ratios() == [8, 7, 5, 6.5]


def test_of_many_jobs_some_are_drawn_but_any_frame(asked: list[tuple[Any, ...]]) -> None:
    """The worst 20: those that did not converge, then misfits, then other flags, then the first.

    In their order. The image may be that of any job.
    """
    flags = {
        3: {"misfit": [0, 1]},
        21: {"misfit": [0]},
        22: {"not_converged": [1]},
        24: {"outlier": [0, 1], "jump": [0]},
        23: {"outlier": [0, 1, 2]},
        25: {"outlier": [0]},
    }
    jobs = [by_hand(3, flags=flags.get(k, {})) for k in range(26)]
    jobs[2] = by_hand(3, vehicle_deg=np.full((3, 3), np.nan), flags={"not_converged": [0, 1, 2]})
    draw("all", jobs)
    some = [jobs[k] for k in (0, 1, *range(3, 15), 3 + 12, 21, 22, 23, 24, 25)]
    assert [one[2] for one in asked] == [some, some, some, jobs]
    said = [one[1].get_suptitle().split("\n")[1:] for one in asked]
    left_out = f"20 of 26 jobs, with {WORST}"
    names = list(KINDS)
    assert said == [[f"said by {name}", left_out] for name in names[:3]] + [["said by image"]]
    asked.clear()
    draw("all", jobs[3:23])
    assert [one[2] for one in asked] == [jobs[3:23]] * 4


WORSE = {  # flags of some jobs, and of those that are worse
    "frames that are flagged, not flags": ({"jump": [0], "outlier": [0]}, {"jump": [1, 2]}),
    "a misfit": ({"jump": [0, 1, 2]}, {"misfit": [0]}),
    "two misfits": ({"misfit": [0], "jump": [1, 2]}, {"misfit": [0, 1]}),
    "one that did not converge": ({"misfit": [0, 1, 2]}, {"not_converged": [0]}),
}


@pytest.mark.parametrize("name", WORSE)
def test_which_jobs_are_worse(name: str, asked: list[tuple[Any, ...]]) -> None:
    """What counts first is whether frames converged, then misfits, then other flags."""
    some, worse = ([by_hand(3, flags=flags) for _ in range(20)] for flags in WORSE[name])
    draw("attack", some + worse)
    assert asked[0][2] == worse


def test_twenty_jobs_are_all_drawn_even_one_without_attitude(asked: list[tuple[Any, ...]]) -> None:
    jobs = [by_hand(3, vehicle_deg=np.full((3, 3), np.nan)), *[by_hand(3) for _ in range(19)]]
    draw("attack", jobs)
    assert asked[0][2] == jobs and "of 20 jobs" not in asked[0][1].get_suptitle()


def test_histories_without_any_attitude() -> None:
    """Cannot be drawn; beside one that has some, they can."""
    none = by_hand(3, vehicle_deg=np.full((3, 3), np.nan))
    with refused(VopdError):
        draw("attack", [none])
    assert draw("attack", [none, by_hand(3)])


@pytest.mark.parametrize("name", LEAST)
def test_the_smallest_sizes(name: str) -> None:
    width, height = LEAST[name]
    assert least_size_in(name) == (width, height)
    for fits in (None, (width, height), (width, 99.0), (99.0, height)):
        refuse_small(name, fits)
    for small in ((width - 0.01, 99.0), (99.0, height - 0.01), (float("nan"), 99.0)):
        with pytest.raises(VopdError) as refused:
            refuse_small(name, small)
        assert str(refused.value) == (
            f"the figure '{name}' does not fit in {small[0]:g}x{small[1]:g} inches: "
            f"the smallest size is {width:g}x{height:g}"
        )
        with pytest.raises(VopdError):
            draw(name, [by_hand(3)], size_in=small)


def test_a_new_figure_has_the_style() -> None:
    with matplotlib_figure((4.0, 3.0)) as figure:
        assert figure.get_size_inches().tolist() == [4.0, 3.0]
        assert isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine)
        assert mpl.rcParams["axes.grid"]
    assert not mpl.rcParams["axes.grid"]


class Saved:
    """A figure that keeps what it is asked to do."""

    asked: ClassVar[dict[str, Any]] = {}

    def __init__(self) -> None:
        self.engine: Any = self
        self.done: list[Any] = []

    def get_layout_engine(self) -> Any:
        return self.engine

    def set_layout_engine(self, engine: Any) -> None:
        self.engine = engine

    def execute(self, figure: Any) -> None:
        self.done.append((figure, mpl.rcParams["svg.hashsalt"]))

    def savefig(self, file: Any, **asked: Any) -> None:
        self.done.append((asked, self.engine, mpl.rcParams["svg.hashsalt"]))
        file.write(b'<a id="m7"/><b id="q"/><c x="#q" y="url(#m7)" z="#m8"/>')


METADATA: dict[str, dict[str, Any]] = {  # nothing that depends on the day or on the version
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


@pytest.mark.parametrize("suffix", METADATA)
def test_what_is_saved(suffix: str) -> None:
    """Laid out once, in the style, without a date; the ids of an SVG are numbered."""
    figure: Any = Saved()
    written = save(figure, suffix)
    (laid_out, salt), (asked, engine, other) = figure.done
    assert (laid_out, salt, engine, other) == (figure, "vopd", None, "vopd")
    assert figure.engine is figure
    assert asked == {"format": suffix[1:], "metadata": METADATA[suffix], "dpi": 150}
    numbered = b'<a id="v0"/><b id="v1"/><c x="#v1" y="url(#v0)" z="#m8"/>'
    plain = b'<a id="m7"/><b id="q"/><c x="#q" y="url(#m7)" z="#m8"/>'
    assert written == (numbered if suffix == ".svg" else plain)
    save(figure, suffix, dpi=60)
    assert figure.done[-1][0]["dpi"] == 60
    figure.engine = None
    save(figure, suffix)
    assert figure.engine is None


def test_an_svg_is_the_same_each_time() -> None:
    """And has no text of a font, but its outlines."""
    made = []
    for _ in range(2):
        figure = Figure(figsize=(1.0, 1.0))
        figure.text(0.5, 0.5, "word", clip_path=None).set_clip_on(True)
        figure.subplots().plot([0, 1], [0, 1])
        made.append(figures.svg(figure))
    assert made[0] == made[1] and made[0].startswith("<?xml")
    assert "<text" not in made[0] and "<dc:date>" not in made[0]


def test_without_matplotlib_it_is_said_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with refused(VopdError):
        ready()
