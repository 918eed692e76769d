"""Pictures by what is drawn in them, not by their pixels; what `draw` and `save` take and make."""

from __future__ import annotations

import io
import re
import struct
import sys
import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, ClassVar
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from PIL import Image

from tests.approved.texts import refused
from tests.kit import repeated_frame
from tests.kit.command import DECKS, ROOT, Ran, vopd
from tests.kit.estimates import estimate
from tests.kit.histories import about, by_hand, flight, histories, turning, with_estimate
from tests.tolerances import assert_close, within
from vopd.attitude.history import History, history
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.table import table
from vopd.attitude.uncertainty import ANGLES
from vopd.errata import fixes
from vopd.figures import (
    FIGURES,
    OF_CLICKS,
    draw,
    least_size_in,
    refuse_small,
)
from vopd.figures.attitude import (
    NO_ATTACK,
    draw_table,
    interval_of,
    values_of,
)
from vopd.figures.image import arrow_scale, chosen
from vopd.figures.residuals import draw_residuals
from vopd.figures.style import caption, matplotlib_figure, ready, save, svg
from vopd.findings import VopdError
from vopd.pipeline import read_deck, run

CASE_4 = DECKS / "appendix_h" / "case4.dat"


@cache
def figure_of(name: str, made: Callable[[], Sequence[History]] = flight) -> Any:
    """A figure that several tests look at, laid out as in a file."""
    figure = draw(name, made())
    figure.draw_without_rendering()
    return figure


OF_JOBS = [one for one in FIGURES if one not in OF_CLICKS]


def panels(figure: Any) -> list[Any]:
    return [axis for part in figure.subfigs for axis in part.axes]


def lines(axis: Any) -> list[np.ndarray]:
    """The lines of an axis as points (n, 2)."""
    return [np.column_stack(line.get_data()) for line in axis.lines if line.get_ls() == "-"]


def segments(axis: Any) -> np.ndarray:
    """All straight pieces that are drawn: (n, 2, 2)."""
    pieces = [np.stack([a[:-1], a[1:]], axis=1) for a in lines(axis) if len(a) > 1]
    pieces = np.concatenate(pieces) if pieces else np.zeros((0, 2, 2))
    return pieces[np.isfinite(pieces).all(axis=(1, 2))]


@pytest.mark.parametrize("rate_deg", [4.0, 23.0], ids=["through north", "round and round"])
def test_no_line_across_what_is_missing_or_wraps(rate_deg: float) -> None:
    one = turning(rate_deg)
    for axis in panels(draw("attitude", [one]))[:3]:
        drawn = segments(axis)
        assert len(drawn) > 8
        assert np.abs(drawn[:, 1, 1] - drawn[:, 0, 1]).max() < 180.0
        times = drawn[:, :, 0]
        gone = one.estimate.time_s[8:11]
        assert not ((times[:, :1] < gone) & (times[:, 1:] > gone)).any()


def test_a_turn_through_north_is_one_line_labelled_as_it_is() -> None:
    axis = panels(draw("attitude", [turning()]))[0]
    drawn = segments(axis)
    assert len(drawn) == 20 - 1 - 4  # a piece between each two frames, but for the gap's
    low, high = axis.get_ylim()
    assert high - low < 120.0
    names = [axis.yaxis.get_major_formatter()(tick, 0) for tick in (-20.0, 0.0, 30.0, 365.0)]
    assert names == ["340", "0", "30", "5"]


def test_the_band_is_the_table_s_95_percent() -> None:
    """Of alpha and beta the half-width on both sides, of eta from its lower to its upper end."""
    (one,) = flight()
    values = table([one])
    ends = {
        name: [
            values[f"{name}_deg"] + sign * values[f"half_width_95_{name}_deg"] for sign in (-1, 1)
        ]
        for name in ("alpha", "beta")
    }
    ends["eta"] = [values["eta_low_95_deg"], values["eta_high_95_deg"]]
    for axis, name in zip(panels(figure_of("attack")), ends, strict=False):
        (band,) = [one for one in axis.collections if one.get_label() == "band"]
        edges = np.concatenate([path.vertices for path in band.get_paths()])
        known = np.isfinite(values[f"{name}_deg"])
        for end in ends[name]:
            for when, value in zip(values["time_s"][known], end[known], strict=True):
                here = edges[np.abs(edges[:, 0] - when) < within("time")]
                assert np.abs(here[:, 1] - value).min() < within("drawn angle")


def test_the_lowest_panel_has_half_the_width_of_the_bands() -> None:
    """A line for each angle, solid, dashed and dotted, named in that order."""
    values = table(flight())
    half = [values[f"half_width_95_{name}_deg"] for name in ("alpha", "beta")]
    half.append((values["eta_high_95_deg"] - values["eta_low_95_deg"]) / 2.0)
    axis = panels(figure_of("attack"))[3]
    drawn = {line.get_ls(): line for line in axis.lines if len(line.get_ydata())}
    names = [text.get_text() for text in axis.get_legend().get_texts()]
    assert names == ["alpha", "beta", "eta"] and list(drawn) == ["-", "--", ":"]
    for line, expected in zip(drawn.values(), half, strict=True):
        shown = np.asarray(line.get_ydata(), float)
        known = np.isfinite(expected)
        assert_close("drawn angle", shown[np.isfinite(shown)], expected[known])


def test_every_panel_shows_the_angle_of_its_column_and_label() -> None:
    """The camera's on the left and the vehicle's, whose roll is 210 degrees less, on the right."""
    (one,) = flight()
    values = table([one])
    seen = []
    for axis in panels(figure_of("attitude")):
        column = ("camera", "vehicle")[axis.get_subplotspec().colspan.start]
        name = f"{column}_{axis.get_ylabel().replace(',', ' ').partition(' ')[0]}_deg"
        if name in values:
            seen.append(name)
            times, angles = np.asarray(axis.lines[0].get_data(), float)
            known = np.isfinite(angles)
            assert times[known].tolist() == one.estimate.time_s[one.has_attitude].tolist()
            off = (angles[known] - values[name][one.has_attitude] + 180.0) % 360.0 - 180.0
            assert np.abs(off).max() < within("drawn angle"), name
    assert sorted(seen) == sorted(f"{name}_deg" for name in ANGLES[:6])
    titles = [axis.get_title() for axis in panels(figure_of("attitude")) if axis.get_title()]
    assert titles == ["camera", "vehicle"]


def test_residuals_are_in_micrometres_x_above_y() -> None:
    """Every residual of every landmark that takes part."""
    (one,) = flight()
    residual = one.estimate.residual_xy[one.estimate.used & one.has_attitude[:, None]]
    axes = panels(figure_of("residuals"))
    for axis, k, words in ((axes[0], 0, "residual x to"), (axes[2], 1, "residual y up")):
        assert axis.get_ylabel().startswith(words)
        lines = [line.get_ydata() for line in axis.lines if line.get_label() in "012345 others"]
        shown = np.concatenate([np.asarray(line, float) for line in lines])
        shown = np.sort(shown[np.isfinite(shown)])
        assert_close("drawn residual", shown, np.sort(residual[:, k] * 1000.0))


def test_the_key_of_the_arrows_is_in_their_unit() -> None:
    (axis,) = panels(figure_of("image"))
    (key,) = [artist for artist in axis.get_children() if type(artist).__name__ == "QuiverKey"]
    assert re.fullmatch(r"\d+(\.\d+)? µm", key.text.get_text())
    assert_close("film length", key.U, float(key.text.get_text().split()[0]) / 1000.0)


def test_one_frame_is_a_table() -> None:
    (one,) = histories("appendix_h/case1")
    (axis,) = panels(draw("attitude", [one]))
    cells = [cell.get_text().get_text() for cell in axis.tables[0].get_celld().values()]
    values = table([one])
    yaw, half = values["vehicle_yaw_deg"][0], values["half_width_95_vehicle_yaw_deg"][0]
    assert 1.0 <= half < 10.0 and f"{yaw:.1f} ± {half:.1f}" in cells
    (axis,) = panels(draw("attack", [one]))
    cells = [cell.get_text().get_text() for cell in axis.tables[0].get_celld().values()]
    alpha, half = values["alpha_deg"][0], values["half_width_95_alpha_deg"][0]
    assert 1.0 <= half < 10.0 and f"{alpha:.1f} ± {half:.1f}" in cells
    lost = with_estimate(one, attack_deg=np.full((1, 3), np.nan))
    (part,) = draw("attitude", [lost]).subfigs
    assert part.get_suptitle().endswith(f"\n{NO_ATTACK}")
    assert NO_ATTACK not in draw("attitude", [one]).subfigs[0].get_suptitle()


def test_the_table_of_one_frame_tells_camera_and_vehicle_apart() -> None:
    """To two digits of the interval; one angle has none, and one is not known.

    The letters keep their size where the figure is small.
    """
    half = np.array([[0.5, np.inf, 0.02, 3.0, 0.3, 12.0, 1.0, 1.0, 1.0]])
    attack, eta = np.array([[np.nan, 2.0, 3.0]]), np.array([[2.5, 4.5]])
    one = by_hand(1, half_deg=half, attack_deg=attack, eta_deg=eta)
    one = with_estimate(
        one, camera_deg=np.array([[10.0, -60.0, 20.0]]), vehicle_deg=np.array([[30.0, 1.0, 2.0]])
    )

    def shown(names: Sequence[str]) -> dict[str, str]:
        figure = Figure(figsize=(2.0, 3.0))
        draw_table(figure, [one], names)
        figure.draw_without_rendering()
        cells = figure.axes[0].tables[0].get_celld()
        assert not figure.axes[0].axison
        with_yaw = any("yaw" in name for name in names)
        assert ("yaw from true north" in figure.axes[0].get_title("left")) == with_yaw
        assert {cell.get_fontsize() for cell in cells.values()} == {11.0}
        rows = {row: cells[row, 0].get_text().get_text() for row, _ in cells}
        return {name: cells[row, 1].get_text().get_text() for row, name in rows.items()}

    assert shown(ANGLES[:6]) == {
        "frame": "DJI_0000.JPG", "camera yaw": "10.00 ± 0.50", "camera pitch": "-60.0000 ± ?",
        "camera roll": "20.000 ± 0.020", "vehicle yaw": "30.0 ± 3.0",
        "vehicle pitch": "1.00 ± 0.30", "vehicle roll": "2 ± 12", "flags": "none",
    }  # fmt: skip
    assert shown(["vehicle_roll", "alpha"])["alpha"] == "none"
    assert shown(["eta"])["eta"] == "3.0 ± 1.0"  # the mean of its two sides
    assert {*shown(ANGLES[3:6])} == {"frame", "yaw", "pitch", "roll", "flags"}


def test_an_angle_that_is_not_determined_has_no_band() -> None:
    (one,) = run(repeated_frame.repeated(landmarks=[2], draws=3)).histories()
    assert np.isinf(one.uncertainty.half_width_95).any()
    for axis in panels(draw("attitude", [one])):
        low, high = axis.get_ylim()
        assert np.isfinite([low, high]).all()


def test_units_stand_on_every_axis() -> None:
    units = ("degrees", "µm", "mm", "sigma", ", m", ", km")
    for name in OF_JOBS:
        for axis in panels(figure_of(name)):
            named = axis.get_ylabel() or not axis.axison or axis.get_subplotspec().colspan.start
            assert (
                any(unit in axis.get_ylabel() for unit in units) or named is not axis.get_ylabel()
            )
            shown = axis.get_xlabel()
            assert not shown or any(u in shown for u in (", s", "mm", "how many", ", m", ", km"))


def flag_rows(figure: Any) -> dict[str, list[float]]:
    """The times of the marks of each flag, by the text of its row."""
    axis = panels(figure)[4]
    labels = [one.get_text() for one in axis.get_yticklabels()]
    times = [np.asarray(line.get_xdata()).tolist() for line in axis.lines]
    return dict(zip(labels, times, strict=True))


def test_flagged_frames_are_marked() -> None:
    (one,) = flight()
    time_s, raised = one.estimate.time_s, one.flags.raised
    drawn = {name.split("\n")[0]: times for name, times in flag_rows(figure_of("attack")).items()}
    assert drawn["misfit"] == time_s[raised["misfit"]].tolist() == [time_s[4]]
    for name, times in drawn.items():
        assert times == time_s[raised[name.replace(" ", "_")] & one.has_attitude].tolist() != []


def test_the_image_of_a_misfit_says_what_explains_it() -> None:
    (one,) = flight()
    figure = draw("image", [one], int(one.estimate.frame[4]))
    title = figure.subfigs[0].get_suptitle()
    assert f"misfit: {one.flags.detail['misfit'][4]}" in title and "without" in title
    rows = frame_landmarks(one)
    here = (rows.frame == 4) & rows.mends
    (label,) = {one.estimate.landmark_label(n) for n in rows.landmark[here].tolist()}
    assert f"without {label}" in title
    (square,) = [line for line in figure.subfigs[0].axes[0].lines if line.get_marker() == "s"]
    assert_close("unit element", np.transpose(square.get_data()), rows.image[here])
    assert not (rows.mends & (rows.frame != 4)).any()


def test_fixes_are_in_the_title() -> None:
    made = run(read_deck(CASE_4), fixes("first-landmark")).histories()
    title = draw("image", made).subfigs[0].get_suptitle()
    assert "corrected run, not the original: first-landmark" in title


# The image


def film_by_hand(k: int) -> np.ndarray:
    """Printed X, Y less XP, YP, times 1 - DELTA R/R (docs/conventions.md)."""
    r = run(read_deck(CASE_4))[0]
    away = r.point_mm[k] - r.centre_mm[k]
    return (away * (1.0 - r.distortion_mm[k] / r.radius_mm[k])[:, None])[r.used[k]]


@pytest.mark.parametrize("frame", [60, 65])
def test_landmarks_where_they_were_measured_and_arrows_to_scale(frame: int) -> None:
    (one,) = histories("appendix_h/case4")
    k = one.estimate.frame.tolist().index(frame)
    figure = draw("image", [one], frame)
    (axis,) = panels(figure)
    by_label = {line.get_label(): np.column_stack(line.get_data()) for line in axis.lines}
    residual = one.estimate.residual_xy[k][one.estimate.used[k]]
    assert_close("film length", by_label["measured"], film_by_hand(k))
    assert_close("residual", by_label["measured"] - by_label["computed"], residual)
    (arrows,) = axis.collections
    assert_close("film length", np.column_stack([arrows.U, arrows.V]), residual)
    assert_close("film length", np.column_stack([arrows.X, arrows.Y]), by_label["computed"])
    said = figure.subfigs[0].get_suptitle()
    assert f"{1.0 / arrows.scale:g} times as long" in said and f"frame {frame}," in said
    left, right = axis.get_xlim()
    assert left > right  # x grows to the left


def test_the_frame_of_a_film_and_landmarks_that_were_not_used() -> None:
    """The fiducials by their readings; landmark 65 of case 2, which is ignored, as computed."""
    (one,) = histories("appendix_h/case2")
    (axis,) = panels(draw("image", [one]))
    (frame,) = axis.patches
    read = read_deck(DECKS / "appendix_h" / "case2.dat")[0].readings.fiducial_in[0]
    corners = read.mean(axis=1) * 0.713816400205  # mm on the film an inch of the reader
    corners -= corners.mean(axis=0)
    assert_close("film length", frame.get_xy()[:4], corners)
    by_label = {line.get_label(): np.column_stack(line.get_data()) for line in axis.lines}
    (place,) = by_label["not used: computed place"]
    estimate = one.estimate
    scene = estimate.scene() if estimate.scene else None
    assert scene is not None and scene.film is not None
    _, computed, _ = scene.film(np.array([0]))
    assert_close("film of eight digits", computed[0, 1:], by_label["computed"])
    assert_close("film length", place, computed[0, 0])
    assert {text.get_text() for text in axis.texts} == {"65", "66", "67", "N", ""}


@pytest.mark.usefixtures("not_laid_out")
def test_residuals_that_are_all_zero_have_no_key_arrow() -> None:
    """Whose residuals vanish: nothing to scale, and no warning."""
    made = histories("regression/vanished", "regression/zero_residuals")
    for one in made:
        if one.has_attitude.any():
            draw("image", [one]).draw_without_rendering()


def test_the_frame_with_the_most_landmarks_by_default() -> None:
    made = histories("appendix_h/cases_1_2_3")
    assert "job 1" in draw("image", made[::-1]).subfigs[0].get_suptitle()


def test_legends_cover_no_point() -> None:
    """In pixels, where they end up."""
    for name in OF_JOBS:
        figure = figure_of(name)
        boxes = [part.legends[0].get_window_extent() for part in figure.subfigs if part.legends]
        boxes += [a.get_legend().get_window_extent() for a in panels(figure) if a.get_legend()]
        assert boxes
        for axis in panels(figure):
            for line in axis.lines:
                points = np.column_stack(line.get_data()).astype(float)
                points = points[np.isfinite(points).all(axis=1)]
                seen = axis.transData.transform(points) if len(points) else np.zeros((0, 2))
                for box in boxes:
                    assert not any(box.contains(*point) for point in seen), name


# Files


def test_the_same_picture_is_the_same_file() -> None:
    made = flight()
    assert save(draw("image", made), ".png", 50) == save(draw("image", made), ".png", 50)


@pytest.mark.usefixtures("not_laid_out")
def test_a_figure_for_a_pipe() -> None:
    done = plot(CASE_4, "-o", "-", "--format", "png", "--figure", "image")
    assert done.status == 0 and done.output.startswith(b"\x89PNG\r\n\x1a\n")


@pytest.mark.parametrize("name", ["nothing", ["image", "attitud"]])
def test_there_are_six_figures(name: str | list[str]) -> None:
    with refused(VopdError):
        draw(name, flight())


def test_a_date_that_is_none_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which matplotlib reads for a .pdf, as programs do that make the same file again."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "abc")
    with refused(VopdError):
        save(draw("image", flight()), ".pdf")


@pytest.mark.parametrize("name", OF_JOBS)
def test_the_smallest_size_holds_every_panel(name: str) -> None:
    """No warning of the layout, panels that can be read, legends that cover no label."""
    made = histories("appendix_h/cases_1_2_3")
    for size_in in filter(None, (least_size_in(name), FIGURES[name].column_in)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            figure = draw(name, made, size_in=size_in)
            figure.draw_without_rendering()
        for axis in panels(figure):
            box, flags = axis.get_window_extent(), len(getattr(axis, "lines", ()))
            assert box.width / figure.dpi > 1.5
            strip = not axis.get_ylabel() and name in ("attitude", "attack") and len(made) == 1
            assert box.height / figure.dpi > (0.18 * flags if strip else 0.5)
        for legend in (one for part in figure.subfigs for one in part.legends):
            box = legend.get_window_extent()
            assert box.x0 >= 0.0 and box.x1 <= figure.bbox.x1
        for axis in panels(figure):
            if axis.get_legend() and axis.get_xlabel():
                legend, label = axis.get_legend(), axis.xaxis.label
                assert not legend.get_window_extent().overlaps(label.get_window_extent())
    width, height = least_size_in(name)
    for small in ((width - 0.1, height), (width, height - 0.1)):
        with refused(VopdError):
            draw(name, made, size_in=small)


def test_the_smallest_size_of_all_has_room_for_each() -> None:
    """Heights are shared in the proportion of the usual ones."""
    width, height = least_size_in("all")
    usual = sum(FIGURES[name].size_in[1] for name in OF_JOBS)
    for kind in map(FIGURES.__getitem__, OF_JOBS):
        assert kind.least_in[0] <= width
        assert kind.least_in[1] <= height * kind.size_in[1] / usual + 0.05
    with refused(VopdError):  # nor have several a narrow form
        refuse_small(["patches", "residuals"], (4.5, 99.0))


@pytest.mark.usefixtures("not_laid_out")
def test_thousands_of_frames_stay_a_file_of_some_megabytes() -> None:
    job = read_deck(DECKS / "regression" / "flight.dat")[0]
    assert len(svg(draw("all", run(job).histories()))) < 3_000_000


def plot(*arguments: str | Path) -> Ran:
    return vopd("plot", *arguments)


@pytest.mark.usefixtures("not_laid_out")
def test_the_command_writes_what_the_suffix_says(tmp_path: Path) -> None:
    made = {s: tmp_path / f"p{s}" for s in (".png", ".svg", ".pdf")}
    size = ("--size", "7,5", "--dpi", "60", "--figure", "image", "--frame", "65")
    assert plot(CASE_4, "-o", made[".png"], *size).status == 0
    head = made[".png"].read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">2I", head[16:]) == (420, 300)
    assert plot(CASE_4, "-o", made[".svg"], "--figure", "attack").status == 0
    assert ET.parse(made[".svg"]).getroot().tag.endswith("svg")
    assert plot(CASE_4, "-o", made[".pdf"], "--figure", "residuals", "--strict").status == 3
    assert made[".pdf"].read_bytes().startswith(b"%PDF-")


@pytest.mark.usefixtures("not_laid_out")
def test_one_job_of_several(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page about job 2 names neither of the others, and says which frame it shows."""
    stacked = DECKS / "appendix_h" / "cases_1_2_3.dat"
    out = tmp_path / "p.svg"
    drawn: list[list[int]] = []

    def draw_and_note(name: str, histories: list[History], *rest: Any) -> Any:
        drawn.append([one.about.job for one in histories])
        return draw(name, histories, *rest)

    monkeypatch.setattr("vopd.cli.plot.draw", draw_and_note)
    assert plot(stacked, "-o", out, "--job", "2", "--figure", "image").status == 0
    assert drawn == [[2]]
    result = plot(stacked, "-o", tmp_path / "q.svg", "--job", "4")
    assert result.status == 1 and "no job 4" in result.stderr


@pytest.mark.usefixtures("not_laid_out")
@pytest.mark.parametrize(("job", "status"), [("1", 0), ("2", 3), (None, 3)])
def test_the_status_is_that_of_the_job_that_is_drawn(
    job: str | None, status: int, tmp_path: Path
) -> None:
    """Job 2 alone has frames with flags."""
    deck = ROOT / "tests" / "approved" / "inputs" / "five_jobs.dat"
    chosen = ["--job", job] if job else []
    done = plot(deck, "-o", tmp_path / "a.svg", "--strict", "--fix", "all", *chosen)
    assert done.status == status and ("are flagged" in done.stderr) == (status == 3)


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (["-o", "p.jpg"], 2, "name the file .png, .svg or .pdf, or give --format"),
        (["-o", "p"], 2, "name the file"),
        ([], 2, "Missing option"),
        (["-o", "p.svg", "--dpi", "100"], 2, "--dpi is for .png"),
        (["-o", "p.png", "--size", "9"], 2, "not a width and height"),
        (["-o", "p.png", "--size", "0x5"], 2, "the smallest size is 8x29.5"),
        (["-o", "p.png", "--size", "nanx5"], 2, "not a width and height"),
        (["-o", "p.png", "--figure", "image", "--size", "4x3"], 2, "the smallest size is 6x4"),
        (["-o", "p.png", "--size", "999x999"], 2, "is more than 100 inches"),
        (["-o", "-"], 2, "give --format"),
        (["-o", "p.png", "--frame", "7"], 1, "no frame 7: there are 60 to 65"),
        (["-o", "p.png", "--frame", "55"], 1, "frame 55 has no attitude"),
        (["-o", "no/p.png"], 1, "cannot be written"),
        (["-o", "p.png", "--focal-sigma", "-1"], 2, "focal length sigma"),
    ],
)
def test_mistakes_leave_no_file(
    arguments: Sequence[str],
    status: int,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    result = plot(CASE_4, *arguments)
    assert result.status == status and said in " ".join(result.stderr.split())
    assert list(tmp_path.iterdir()) == []


def test_without_matplotlib(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    result = plot(CASE_4, "-o", tmp_path / "p.png")
    assert result.status == 1 and "pip install matplotlib" in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("not_laid_out")
def test_hostile_titles_are_text() -> None:
    (one,) = histories("appendix_h/case4")
    save(draw("image", [about(one, source="$x$\n_^", title="$\\frac{ <b>&\x07$")]), ".svg")


@pytest.mark.usefixtures("not_laid_out")
def test_the_command_says_which_jobs_are_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the first figure is drawn: of the others it is the message that counts."""
    deck, figure = tmp_path / "many.dat", tmp_path / "figure.png"
    vopd("demo", "--jobs", "21", "--frames", "1", "-o", deck)
    ran = plot(deck, "-o", figure, "--figure", "attack")
    assert "drawn are 20 of 21 jobs" in ran.stderr and figure.exists()
    monkeypatch.setattr("vopd.cli.plot.draw", lambda *_: None)
    monkeypatch.setattr("vopd.cli.plot.save", lambda *_: b"")
    attack = ("--figure", "attack")
    for more in ((*attack, "--job", "21"), ("--figure", "image"), (*attack, "-q")):
        assert "drawn are" not in plot(deck, "-o", figure, *more).stderr


# What draw and save do

KINDS = {  # title, usual size, smallest size, and with panels one below the other
    "attitude": ("Attitude", (9, 8), (7.5, 6), None),
    "attack": ("Angles of attack", (9, 7), (5, 5.5), None),
    "residuals": ("Residuals", (9, 7), (8, 5), (4, 8)),
    "image": ("One frame's image", (9, 6.5), (6, 4), None),
    "map": ("Map", (9, 9), (7, 6.5), None),
    "patches": ("Patches", (9, 6), (7, 4), (4, 5)),
}
OF_ANY = list(KINDS)[:4]  # those that a job without a scene has, too
LEAST = {name: kind[2] for name, kind in KINDS.items()} | {"all": (8, 29.5)}  # 37.5 / 7 * 5.5
WORST = "the most frames that did not converge, misfit or have a flag"


def test_the_kinds() -> None:
    assert [(name, kind[1:]) for name, kind in FIGURES.items()] == list(KINDS.items())


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """Every figure that is drawn: its name, part, histories, frame. Each says its name."""
    seen: list[tuple[Any, ...]] = []

    def stands_for(name: str) -> Any:
        def note(part: Any, histories: Any, frame: Any, photograph: Any) -> str:
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
    assert [one[0] for one in asked] == OF_ANY
    assert [one[1] for one in asked] == list(figure.subfigs)
    assert {one[3] for one in asked} == {"DJI_0001.JPG"}
    assert figure.get_size_inches().tolist() == [9.0, 28.5]
    assert figure.subfigs[0]._subplotspec.get_gridspec().get_height_ratios() == [8, 7, 7, 6.5]
    tables = draw(["attitude", "attack"], [by_hand(1)] * 3)  # of a frame each
    assert tables.get_size_inches().tolist() == [9.0, 2 * (3.5 + 2 * 0.25)]


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
    names = OF_ANY
    assert said == [[f"said by {name}", left_out] for name in names[:3]] + [["said by image"]]
    asked.clear()
    draw("all", jobs[3:23])
    assert [one[2] for one in asked] == [jobs[3:23]] * 4
    asked.clear()
    draw("all", [by_hand(3, attack_deg=np.full((3, 3), np.nan))] * 20 + [by_hand(3)])
    assert [one[0] for one in asked] == ["attitude", "residuals", "image"]


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
    column = KINDS[name][3] if name in KINDS else None
    high = 99.0 if column is None else column[1] - 0.01
    fits = [None, (width, height), (width, 99.0), (99.0, height), *filter(None, [column])]
    for one in fits:
        refuse_small(name, one)
    wrong = [(width - 0.01, high), (99.0, height - 0.01), (float("nan"), 99.0)]
    for small in [*wrong, *([(column[0] - 0.01, 99.0)] if column else [])]:
        with pytest.raises(VopdError) as refused:
            refuse_small(name, small)
        sizes = ", or ".join(f"{w:g}x{h:g}" for w, h in filter(None, [(width, height), column]))
        assert str(refused.value) == (
            f"the figure '{name}' does not fit in {small[0]:g}x{small[1]:g} inches: "
            f"the smallest size is {sizes}"
        )
        with pytest.raises(VopdError):
            draw(name, [by_hand(3)], size_in=small)


def test_a_new_figure_has_the_style() -> None:
    with matplotlib_figure((4.0, 3.0)) as figure:
        assert figure.get_size_inches().tolist() == [4.0, 3.0]
        assert isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine)
        assert mpl.rcParams["axes.grid"]
    assert not mpl.rcParams["axes.grid"]


def test_a_figure_shows_itself_in_a_notebook() -> None:
    """As a PNG, before and after it is saved; a notebook asks for _repr_png_."""
    figure: Any = draw("attitude", [by_hand(3)])
    width, height = figure.get_size_inches()
    for _ in range(2):
        with Image.open(io.BytesIO(figure._repr_png_())) as shown:
            assert (shown.format, shown.size) == ("PNG", (round(100 * width), round(100 * height)))
        save(figure, ".svg")


class Saved:
    """A figure that keeps what it is asked to do."""

    asked: ClassVar[dict[str, Any]] = {}

    dpi = 100.0

    def __init__(self) -> None:
        self.engine: Any = self
        self.done: list[Any] = []

    def set_dpi(self, dpi: float) -> None:
        self.dpi = dpi

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
    """Laid out, in the style, without a date; the ids of an SVG are numbered."""
    figure: Any = Saved()
    written = save(figure, suffix)
    (laid_out, salt), again, (asked, engine, other) = figure.done
    assert again == (laid_out, salt)
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
    """And its texts are texts, for which the viewer has the fonts."""
    made = []
    for _ in range(2):
        figure = Figure(figsize=(1.0, 1.0))
        figure.text(0.5, 0.5, "word", clip_path=None).set_clip_on(True)
        figure.text(0.5, 0.2, "L#100234: #0072b2", color="#d55e00")
        figure.subplots().plot([0, 1], [0, 1])
        made.append(svg(figure))
    assert made[0] == made[1] and made[0].startswith("<?xml")
    assert ">word</text>" in made[0] and "<dc:date>" not in made[0]
    assert ">L#100234: #0072b2</text>" in made[0]
    assert made[0].count("#d55e00") == 1  # in the rules, by which it is another one on a dark page


def test_without_matplotlib_it_is_said_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with refused(VopdError):
        ready()


# Before anything is drawn

ATTITUDES = [[10.0, -60.0, 20.0], [11.0, -61.0, 21.0], [12.0, -62.0, 22.0]]


@cache
def made() -> History:
    """Three frames with four landmarks each, all of which have residuals."""
    return history(estimate(ATTITUDES, noise=0.1))


def of_source(source: str, job: int = 1, title: str = "a title") -> History:
    return about(made(), source=source, job=job, title=title)


CAPTIONS = {  # sources in their order
    ("a",): "a, job 1: a title",
    ("a", "a"): "a, 2 jobs",
    ("b", "a"): "b, a, 2 jobs",
    ("a", "b", "c"): "a, b, c, 3 jobs",
    ("a", "b", "c", "b"): "a, b, c, 4 jobs",
    ("a", "b", "c", "d"): "a, b, c and 1 more, 4 jobs",
    ("a", "b", "c", "d", "e"): "a, b, c and 2 more, 5 jobs",
}


@pytest.mark.parametrize("sources", CAPTIONS)
def test_the_caption(sources: tuple[str, ...]) -> None:
    """Three sources are named, and one job's title; the fixes have a line of their own."""
    some = [of_source(source) for source in sources]
    assert caption(some) == CAPTIONS[sources]
    fixed = [about(one, fixes="restart, earth") for one in some]
    words = "\ncorrected run, not the original: restart, earth"
    assert caption(fixed) == CAPTIONS[sources] + words


def test_a_long_path_leaves_room_for_the_title() -> None:
    """Its end tells it from others."""
    text = caption([of_source("folder/" * 100 + "flight.toml")])
    assert len(text) < 100 and text.endswith("folder/flight.toml, job 1: a title")


def with_landmarks(*counts: int) -> History:
    """The history with so many landmarks that take part in each frame."""
    used = np.arange(4) < np.array(counts)[:, None]
    return history(replace(made().estimate, used=used))


FEWEST, MOST = (3, 3, 4), (3, 4, 4)


def test_the_frame_with_the_most_landmarks() -> None:
    """The first of several, in the first job that has it."""
    few, many = with_landmarks(*FEWEST), with_landmarks(*MOST)
    assert chosen([few], None) == (few, 2)
    assert chosen([many], None) == (many, 1)
    assert chosen([few, many], None) == (few, 2)
    assert chosen([many, few], None) == (many, 1)


@pytest.mark.parametrize("asked", ["DJI_0001.JPG", " DJI_0001.JPG "])
def test_a_frame_by_its_name(asked: str) -> None:
    """In the first job that has it with an attitude."""
    one, two = made(), of_source("b")
    assert chosen([one, two], asked) == (one, 1)
    angles = one.estimate.vehicle_deg.copy()
    angles[1] = np.nan
    without = with_estimate(one, vehicle_deg=angles)
    assert chosen([without, two], asked) == (two, 1)
    with refused(VopdError):
        chosen([without], asked)
    with refused(VopdError):
        chosen([one], 7)


def test_frames_by_their_numbers() -> None:
    numbered = with_estimate(made(), frame_names=())
    assert [chosen([numbered], one)[1] for one in (1, "2", " 3 ")] == [0, 1, 2]
    with refused(VopdError):
        chosen([numbered], 4)


@pytest.mark.parametrize("name", ANGLES)
def test_values_and_intervals_of_every_angle(name: str) -> None:
    """Each angle from its own column; NaN where the half-width is not finite, for eta too."""
    one = made()
    index = ANGLES.index(name)
    angles = np.arange(27.0).reshape(3, 9)
    half = 1.0 + np.arange(27.0).reshape(3, 9) / 10.0
    half[1] = np.inf
    eta = np.array([[7.0, 10.0], [0.0, 180.0], [20.0, 30.0]])
    given = with_estimate(
        one, camera_deg=angles[:, :3], vehicle_deg=angles[:, 3:6], attack_deg=angles[:, 6:]
    )
    doubt = replace(one.uncertainty, half_width_95=half, eta_interval_95_deg=eta)
    given = replace(given, uncertainty=doubt)
    assert values_of(given, name).tolist() == angles[:, index].tolist()
    low, high = interval_of(given, name)
    if name == "eta":
        assert low[[0, 2]].tolist() == [7.0 - 8.0, 20.0 - 26.0]
        assert high[[0, 2]].tolist() == [10.0 - 8.0, 30.0 - 26.0]
    else:
        assert low[[0, 2]].tolist() == (-half[[0, 2], index]).tolist()
        assert high[[0, 2]].tolist() == half[[0, 2], index].tolist()
    assert np.isnan([low[1], high[1]]).all()


LONG = "a name of sixteen"
NAMES = [  # of landmark 7 in the first and the second job: its label
    ("tower", "spire", "tower", 90.0),
    ("", "spire", "spire", 90.0),
    ("", "", "7", 0.0),
    (LONG[:16], "", LONG[:16], 90.0),
    (LONG, "", LONG[:15] + "…", 90.0),
    ("abcd", "", "abcd", 0.0),
]


@pytest.mark.parametrize(("first", "second", "text", "rotation"), NAMES)
def test_labels_of_landmarks(first: str, second: str, text: str, rotation: float) -> None:
    """The name that the first job has that has one; sixteen characters, turned above four."""
    seven = np.full((3, 4), 7)
    jobs = [
        with_estimate(
            made(), landmark=seven, landmark_names={7: name} if name else {}, time_s=np.zeros(3)
        )
        for name in (first, second)
    ]
    figure = Figure()
    draw_residuals(figure, jobs, None)
    (label,) = figure.axes[1].get_xticklabels()
    assert (label.get_text(), label.get_rotation()) == (text, rotation)


SCALES = [
    (0.011, 10.0, 100.0),
    (0.013, 10.0, 50.0),
    (0.03, 10.0, 20.0),
    (1.2, 10.0, 1.0),
    (0.0, 9.0, 1.0),
]


@pytest.mark.parametrize(("longest", "width", "scale"), SCALES)
def test_arrows_are_a_round_number_of_times_as_long(
    longest: float, width: float, scale: float
) -> None:
    """The longest is about .12 of the width: 1.2 of 10."""
    assert arrow_scale(np.array([[0.0, longest], [longest / 2.0, 0.0]]), width) == scale
