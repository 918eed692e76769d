"""Parameters and residuals before and after `vopd adjust`."""

from __future__ import annotations

import shutil
from base64 import b64decode
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.container import ErrorbarContainer

from tests.approved.texts import assert_approved
from tests.kit.command import ROOT, vopd
from tests.kit.figures import labelled, points
from tests.tolerances import assert_close
from vopd.figures.adjust import MOST_ROWS, Change, draw_adjusted
from vopd.figures.residuals import residual_points
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.parameters import before_and_after
from vopd.flight.result import solve_flight
from vopd.report import embedded_figures

RMS = np.array([[2.0, 1.0], [3.0, 4.0], [np.nan, np.nan], [2.5, 2.0]])
CHANGES = (
    Change("focal", "1 → 2 ± 1 px", 0.5, 0.25, stated=True),
    Change("k1", "3 → 4 ± 1", -2.0, 1.0, stated=False),
    Change("centre_u", "7 px, trades with yaw", np.nan, 1.0, stated=True),
)


def drawn(changes: Any = CHANGES, **given: Any) -> Any:
    return draw_adjusted("a $title$", changes, ("one", "two", "three"), RMS, **given)


def test_a_row_for_each_parameter() -> None:
    """What is stated is a bar of one sigma about 0; each is where it moved to, with its sigma."""
    above, below, values = drawn().axes
    bars = [(bar.get_x(), bar.get_width(), bar.get_y() + 0.35) for bar in above.patches]
    assert_close("table value", bars, [(-1.0, 2.0, 0.0), (-1.0, 2.0, 2.0)])
    ends = [one.get_segments()[0] for one in above.collections]
    assert_close("table value", sorted(map(np.ravel, ends), key=lambda end: end[1]),
                 [[0.25, 0.0, 0.75, 0.0], [-3.0, 1.0, -1.0, 1.0]])  # fmt: skip
    assert points(labelled(above)["not held: kept as stated"]) == [[0.0, 2.0]]
    crosses = (one for one in above.containers if isinstance(one, ErrorbarContainer))
    marks = {one.get_label(): one[0].get_marker() for one in crosses}
    assert_approved([f"{label}: {marker}" for label, marker in marks.items()])
    names = [text.get_text() for text in above.get_yticklabels()]
    assert names == ["focal", "k1", "centre_u"]
    assert [text.get_text() for text in values.get_yticklabels()] == [one.told for one in CHANGES]
    lines = labelled(below)
    assert points(lines["before"]) == [[3.0, 0.0], [2.0, 1.0], [2.5, 2.0]]  # the largest first
    assert points(lines["after"]) == [[4.0, 0.0], [1.0, 1.0], [2.0, 2.0]]
    assert [text.get_text() for text in below.get_yticklabels()] == ["two", "one", "all"]


def test_a_long_landmark_keeps_its_axes() -> None:
    changes = [Change(f"{'m' * 99} {axis}", "", 0.5, 0.2, stated=True) for axis in ("east", "up")]
    names = [text.get_text() for text in drawn(changes).axes[0].get_yticklabels()]
    assert [name.split()[1] for name in names] == ["east", "up"]
    assert max(map(len, names)) < 40


def test_of_many_those_that_moved_most() -> None:
    many = [Change(str(k), "", (-1.0) ** k * k, 1.0, stated=True) for k in range(100)]
    figure = drawn(many)
    shown = [text.get_text() for text in figure.axes[0].get_yticklabels()]
    assert shown == [str(k) for k in range(100 - MOST_ROWS, 100)]
    assert f"{MOST_ROWS} of 100 parameters" in figure.get_suptitle()


def test_of_many_landmarks_those_with_the_largest_residuals() -> None:
    """The largest first, as for few, and all together below them."""
    names = [f"m{k}" for k in range(90)]
    rms = np.column_stack([np.arange(91.0), np.ones(91)])
    figure = draw_adjusted("title", CHANGES, names, rms)
    shown = [text.get_text() for text in figure.axes[1].get_yticklabels()]
    assert shown == [*(f"m{k}" for k in range(89, 89 - MOST_ROWS, -1)), "all"]
    assert_approved(figure.get_suptitle())


@pytest.fixture
def wrong(tmp_path: Path) -> Path:
    """The hill with a focal length that is 2 % too long."""
    folder = tmp_path / "hill"
    shutil.copytree(ROOT / "examples" / "hill", folder)
    file = folder / "flight.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(
        text.replace("fx_px = 1500.0, fy_px = 1490.0", "fx_px = 1530.0, fy_px = 1519.8")
    )
    return file


def test_residuals_before_and_after(wrong: Path) -> None:
    """Before they are those of the project as it is; of the right focal length they are small."""
    _, names, rms_px = before_and_after(adjust(str(wrong), ["focal"]).result.estimates)
    found = residual_points([solve_flight(wrong).history()])
    by_landmark = [
        np.sqrt(np.mean(found.pair[found.landmark == k] ** 2)) for k in np.unique(found.landmark)
    ]
    assert_close("flight pixel", np.sort(rms_px[:-1, 0]), np.sort(by_landmark))
    assert_close("flight pixel", rms_px[-1, 0], np.sqrt(np.mean(found.pair**2)))
    assert len(names) == 6 and rms_px[-1, 1] < 0.3 < 1.0 < rms_px[-1, 0]


def test_blunders_are_not_searched_again(wrong: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = adjust(str(wrong), ["focal"])
    monkeypatch.delattr("vopd.flight.result.find_blunders")
    assert np.isfinite(before_and_after(made.result.estimates)[2]).all()


@pytest.mark.usefixtures("not_laid_out")
def test_the_report_has_it(wrong: Path) -> None:
    """Of a project with [solve] free, beside the residuals; of another there is none."""
    before = embedded_figures([solve_flight(wrong).history()])
    assert [one.name for one in before] == ["residuals"]
    text = wrong.read_text(encoding="utf-8")
    wrong.write_text(f'{text}[solve]\nfree = ["focal"]\n', encoding="utf-8")
    freed = solve_flight(wrong).history()
    *_, second = embedded_figures([freed, freed])
    assert second.name == "adjusted-1"
    *_, (name, title, caption, address, _) = embedded_figures([freed])
    page = b64decode(address.partition(",")[2]).decode("utf-8")
    made = adjust(str(wrong), ["focal"])
    (focal,) = made.parameters
    assert ">focal<" in page and f">{focal.before:.2f} → {focal.after:.2f} ± " in page
    assert name == "adjusted-0"
    assert_approved([title, caption])


@pytest.mark.usefixtures("not_laid_out")
def test_the_command_draws_it(wrong: Path, tmp_path: Path) -> None:
    file = tmp_path / "a.svg"
    ran = vopd("adjust", wrong, "--free", "focal,centre", "-q", "--figure", file)
    assert "focal" in ran.stdout
    text = file.read_text(encoding="utf-8")
    assert ">focal<" in text and "1524.9" in text and "→" in text
    assert vopd("adjust", wrong, "--free", "focal", "--figure", tmp_path / "a.jpg").status == 2
    over = vopd("adjust", wrong, "--free", "focal", "--figure", wrong)
    assert over.status == 2 and wrong.read_text(encoding="utf-8").startswith("[flight]")
    photograph = wrong.parent / "frame_0000.png"
    photograph.write_bytes(b"a photograph")
    named = wrong.read_text(encoding="utf-8").replace(
        "[picks]", '[picks]\nvideo = "frame_0000.png"'
    )
    wrong.write_text(named, encoding="utf-8")
    over = vopd("adjust", wrong, "--free", "focal", "--figure", photograph)
    assert over.status == 1 and photograph.read_bytes() == b"a photograph"
