"""Residuals by landmark, and the image of a frame: every mark, by numbers of one's own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import vopd
from tests.approved.texts import assert_approved
from tests.kit.estimates import POINTS, estimate
from tests.kit.figures import DARK_RED, OKABE_ITO, arrows_and_key, labelled, points, texts, ticks
from tests.kit.histories import by_hand
from tests.tolerances import assert_close
from vopd.attitude.history import History, history
from vopd.estimate import Units, Words
from vopd.figures.image import arrow_scale, draw_image, residual_arrows
from vopd.figures.residuals import draw_residuals, residual_points
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

X = np.array([[3.0, 1.0, -2.0, 0.0], [1.0, 1.0, 2.0, 0.5], [4.0, 1.0, 2.0, 0.25]])
Y = np.array([[0.0, 5.0, 1.0, 0.5], [6.0, 0.0, 2.0, 0.5], [0.0, 0.0, 4.0, 0.5]])
TIMES = np.array([10.0, 11.0, 14.0])
ON_FILM = Units("ft", "mm", 0.3048, "µm", 1000.0)


def film(**changes: Any) -> History:
    given: dict[str, Any] = {"residual": np.column_stack([X, Y]) / 1000.0, "units": ON_FILM}
    given |= {"time_s": TIMES, "landmark_names": {}}
    return by_hand(3, **(given | changes))


def drawn(*histories: History) -> tuple[Figure, str]:
    figure = Figure()
    said = draw_residuals(figure, histories or [film()], None)
    return figure, said


def by_landmark(axis: Any) -> dict[str, list[list[float]]]:
    """The points of the lines of a panel, by the place of their landmark in the legend."""
    return {name: points(line) for name, line in labelled(axis).items() if name.isdigit()}


def test_a_line_for_each_landmark() -> None:
    """In order of the size of their residuals, which the legend names."""
    odd = [[False, True, False, False], [False] * 4, [False, False, True, False]]
    figure, said = drawn(film(outlier=odd))
    above, legend, below, _, _, _ = figure.axes
    rms = np.sqrt(((X**2) + (Y**2)).sum(axis=0) / 6.0)
    order = np.argsort(-rms)
    for axis, values in ((above, X), (below, Y)):
        lines = by_landmark(axis)
        for place, k in enumerate(order):
            expected = np.column_stack([TIMES, values[:, k]])
            assert_close("drawn residual", np.array(lines[str(place)], float), expected)
        squares = labelled(axis)["does not fit"]
        expected = [[TIMES[0], values[0, 1]], [TIMES[2], values[2, 2]]]
        assert_close("drawn residual", np.array(points(squares), float), expected)
        assert squares.get_markeredgecolor() == DARK_RED
    named = [f"{7 + k}: {rms[k]:.3g}" for k in order]
    assert texts(legend.get_legend()) == [*named, "does not fit"]
    assert said.startswith("hand.toml, job 1: a flight by hand\nmeasured minus computed; ")


def test_a_gap_breaks_the_line() -> None:
    times = np.array([0.0, 1.0, 2.0, 3.0, 9.0])
    one = by_hand(5, time_s=times, residual=np.ones((5, 8)))
    for line in by_landmark(drawn(one)[0].axes[0]).values():
        assert [x for x, _ in line] == [0.0, 1.0, 2.0, 3.0, None, 9.0]


def test_no_mean_is_where_no_frame_is() -> None:
    """Of 250 frames whose last 50 are half a minute later: 60 means of five each."""
    times = np.arange(250.0) + np.where(np.arange(250) < 200, 0.0, 30.0)
    one = by_hand(250, time_s=times, residual=np.ones((250, 8)))
    lines = by_landmark(drawn(one)[0].axes[0])
    assert len(lines) == 4
    for line in lines.values():
        found = np.array([x for x, _ in line], float)
        middles = np.arange(2.0, 250.0, 5.0)
        expected = np.insert(middles + np.where(middles < 200.0, 0.0, 30.0), 40, np.nan)
        assert_close("drawn residual", found, expected)


def test_many_residuals_are_dots() -> None:
    """Each where it is, up to an edge that a few are beyond."""
    residual = np.column_stack([np.linspace(-0.004, 0.004, 250)] * 8)
    residual[100] = [0.5, -0.5] * 4
    above = drawn(by_hand(250, residual=residual, units=ON_FILM))[0].axes[0]
    (dots,) = (one for one in above.lines if one.get_marker() == ",")
    most = above.get_ylim()[1] / 1.06
    assert most < 500.0
    expected = np.clip(1000.0 * residual[:, :4], -most, most)
    assert_close("drawn residual", np.sort(dots.get_ydata()), np.sort(expected.ravel()))


@pytest.mark.parametrize(("frames", "means"), [(110, False), (201, True)])
def test_lines_are_means_where_one_job_has_many_residuals_of_a_landmark(
    frames: int, means: bool
) -> None:
    """More than 200; the same landmark in two jobs is drawn twice."""
    residual = np.tile(1e-3 * np.arange(8.0), (frames, 1))
    jobs = [by_hand(frames, residual=residual, units=ON_FILM, said={"job": k}) for k in (1, 2)]
    assert ("lines: means of " in drawn(*jobs)[1]) == means


def test_of_more_landmarks_than_colours_the_others_are_dots_alone() -> None:
    """Of three jobs with four landmarks each those with the smallest residuals."""
    size = np.arange(12.0).reshape(3, 4) + 1.0
    jobs = [
        by_hand(
            250, residual=np.tile(np.tile(size[k], 2) * 1e-3, (250, 1)), units=ON_FILM,
            landmark=np.tile(np.arange(4) + 4 * k + 7, (250, 1)), said={"job": k},
        )
        for k in range(3)
    ]  # fmt: skip
    figure, said = drawn(*jobs)
    lines = by_landmark(figure.axes[0])
    least = min(float(np.nanmin(np.array(line, float)[:, 1])) for line in lines.values())
    assert 4 < len(lines) < 12
    assert_close("drawn residual", least, 13.0 - len(lines))
    assert_approved(next(one for one in said.split("; ") if one.startswith("lines: ")))


def test_pixels_are_drawn_as_they_are_picked() -> None:
    """Residuals x to the left and y up are u to the right and v down."""
    figure, said = drawn(film(units=Units("m", "px", 1.0, "px", 1.0)))
    above, _, below = figure.axes[:3]
    assert above.get_ylabel() == "residual u, px,\nto the right"
    assert below.get_ylabel() == "residual v, px,\ndown"
    drawn_v = np.concatenate([np.array(one, float)[:, 1] for one in by_landmark(below).values()])
    assert_close("drawn residual", np.sort(drawn_v), np.sort(-Y.ravel() / 1000.0))
    in_sigmas = {line.get_label(): line.get_ydata() for line in figure.axes[4].lines}
    of_sigmas = np.asarray(in_sigmas["v"], float)
    assert (np.sign(of_sigmas) == np.sign(-Y[np.isfinite(Y)].reshape(of_sigmas.shape))).all()
    assert "picked minus computed" in said


def test_units_and_words_of_a_film() -> None:
    figure, _ = drawn(film(said={"words": Words(surface="on the film")}))
    labels = [axis.get_ylabel() for axis in figure.axes[::2]]
    assert labels == [
        "residual x to the left, µm\non the film", "residual y up, µm\non the film",
        "residual, in\nits sigma",
    ]  # fmt: skip
    assert [axis.get_xlabel() for axis in figure.axes[::2]] == ["", "", "time, s"]


def test_nothing_is_cut_off_unsaid() -> None:
    """A residual far beyond the others is a triangle at the edge, and is counted."""
    both = np.tile(np.column_stack([X, Y]), (40, 1))
    both[7, 2] = -900.0
    odd = np.zeros((120, 4), bool)
    odd[7, 2] = True
    own = {"time_s": np.arange(120.0), "residual": both / 1000.0, "units": ON_FILM}
    figure, said = drawn(by_hand(120, outlier=odd, **own))
    edge = 3.0 * np.quantile(np.abs(both.reshape(-1)), 0.99)
    assert f"1 residual beyond {edge:.3g} µm at the edge, as triangles" in said
    (triangle,) = [line for line in figure.axes[0].lines if line.get_marker() == "v"]
    assert_close("drawn residual", np.array(points(triangle), float), [[7.0, -edge]])
    square = labelled(figure.axes[0])["does not fit"]
    assert_close("drawn residual", np.array(points(square), float), [[7.0, -edge]])
    lowest = [min(y for _, y in line) for line in by_landmark(figure.axes[0]).values()]
    assert_close("drawn residual", min(lowest), -edge)
    assert "triangles" not in drawn()[1]
    figure, _ = drawn(by_hand(120, time_s=np.arange(120.0), residual=both, units=ON_FILM))
    (bars,) = [axis.patches for axis in figure.axes if len(axis.patches) == 30]
    assert bars[0].get_width() > 0.0 and bars[29].get_width() > 0.0


def test_in_sigmas() -> None:
    """Over each reading's sigma, less what the frame's three angles take: three of eight."""
    own = np.tile([1.0, 1.5, 1.0, 2.0], (50, 1))
    made = history(estimate(np.tile([10.0, -60.0, 20.0], (50, 1)), noise=0.1, relative_sigma=own))
    found = residual_points([made])
    e, sigma = made.estimate, made.uncertainty.reading.sigma
    taken = np.einsum("fjc,fcj->fj", e.partials, e.gain)
    assert_close("unit element", taken.sum(axis=1), np.full(50, 3.0))
    expected = e.residual / (sigma * np.tile(own, 2) * np.sqrt(1.0 - taken))
    assert_close(
        "unit element", found.sigmas.T.reshape(2, 50, 4), np.stack(np.split(expected, 2, 1))
    )


def test_residuals_that_are_left_out() -> None:
    """Of landmarks that take no part, of frames without a time, or that are no number."""
    used, ignored = np.ones((3, 4), bool), np.zeros((3, 4), bool)
    used[0, 0], ignored[0, 0] = False, True
    both = np.column_stack([X, Y])
    both[1, 1] = np.nan  # x only
    found = residual_points([film(used=used, ignored=ignored, residual=both)])
    assert found.pair[:, 1].tolist() == [5.0, 1.0, 0.5, 6.0, 2.0, 0.5, 0.0, 0.0, 4.0, 0.5]
    assert found.landmark.tolist() == [8, 9, 10, 7, 9, 10, 7, 8, 9, 10]
    untimed = residual_points([film(time_s=np.array([0.0, np.nan, 2.0]))])
    assert untimed.time.tolist() == [0.0] * 4 + [2.0] * 4


def test_one_frame_has_its_residuals_by_landmark() -> None:
    """Each on a line from 0; of several jobs on bars of the root mean square both ways."""
    names = {7: "spire", 8: "$", 9: ""}
    one = by_hand(1, residual=np.column_stack([X, Y])[:1], landmark_names=names)
    figure, said = drawn(one)
    above, below = figure.axes
    most = 1.08 * np.abs([X[0], Y[0]]).max()
    for axis, values in ((above, -X[0]), (below, -Y[0])):
        (spots,) = [one for one in axis.collections if one.get_label() == "0"]
        assert spots.get_offsets().tolist() == [[float(k), values[k]] for k in range(4)]
        assert not axis.patches
        assert_close("table value", axis.get_ylim(), [-most, most])
    assert ticks(below) == ([0, 1, 2, 3], ["spire", r"\$", "9", "10"])
    rms = np.sqrt(np.mean([X[0] ** 2, Y[0] ** 2]))
    assert f"picked minus computed; rms of a coordinate {rms:.3g} px; in sigmas, rms " in said
    figure, said = drawn(one, one)
    assert "; columns from left to right: the jobs; " in said
    assert len(texts(figure.legends[0])) == 3
    named = [replace(one, estimate=replace(one.estimate, about=one.about._replace(source=path)))
             for path in ("_a/flight.toml", "b/flight.toml")]  # fmt: skip
    assert {one.about.label for one in named} < {*texts(drawn(*named)[0].legends[0])}
    heights = [bar.get_height() for bar in figure.axes[0].patches]
    assert_close("table value", heights, 2.0 * np.abs(X[0]))
    assert len({spot.get_facecolor().tobytes() for spot in figure.axes[0].collections}) == 2


def test_a_residual_of_one_frame_that_does_not_fit_is_marked() -> None:
    odd = [[False, True, False, False]]
    one = by_hand(1, residual=np.column_stack([X, Y])[:1], outlier=odd)
    figure, said = drawn(one)
    rms = np.sqrt(np.mean(residual_points([one]).sigmas[[0, 2, 3]] ** 2))
    assert f"in sigmas, rms of those that fit: {rms:#.3g} (1 if sigma is right)" in said
    reading = replace(one.uncertainty.reading, source="residuals")
    fitted = replace(one, uncertainty=replace(one.uncertainty, reading=reading))
    assert "; sigma is" in drawn(fitted)[1] and "; sigma is" not in drawn(fitted, one)[1]
    for axis, values in zip(figure.axes, (-X[0], -Y[0]), strict=True):
        assert points(labelled(axis)["does not fit"]) == [[1.0, values[1]]]


def test_a_flight_whose_picks_are_all_left_out_has_no_residuals() -> None:
    figure, said = drawn(film(used=np.zeros((3, 4), bool)))
    assert said.endswith("measured minus computed")
    assert ticks(figure.axes[1]) == ([], [])


def test_residuals_whose_sigma_is_left_out_have_none() -> None:
    """A reading sigma of 0 says nothing of their size: none is beyond a sigma."""
    one = film()
    reading = replace(one.uncertainty.reading, sigma=0.0)
    one = replace(one, uncertainty=replace(one.uncertainty, reading=reading))
    assert np.isnan(residual_points([one]).sigmas).all()
    figure, said = drawn(one)
    assert [text.get_text() for axis in figure.axes for text in axis.texts] == ["no sigma"]
    assert "sigma" not in said and "beyond" not in said
    assert_close("table value", figure.axes[4].get_ylim(), [-3.18, 3.18])
    zero = film(residual=np.zeros((3, 8)))
    assert_close("table value", drawn(zero)[0].axes[0].get_ylim(), [-1.06e-9, 1.06e-9])


# The image of one frame

MICROMETRES = Units("ft", "mm", 0.3048, "µm", 1000.0)
RESIDUAL = np.array([[0.0303, 0.0404], [0.0, -0.01], [-0.02, 0.0], [0.0, 0.0]])  # longest .0505
SAID = {"source": "a.dat", "job": 2, "title": "a title", "fixes": ""}


def film_image(residual: Any = RESIDUAL, frames: int = 2, **changes: Any) -> History:
    """Frames alike, with these residuals of the four landmarks."""
    both = np.tile(np.asarray(residual).T.ravel(), (frames, 1))
    return by_hand(frames, residual=both, **changes)


def drawn_image(*histories: History, frame: Any = None) -> tuple[Any, list[str]]:
    figure = Figure(figsize=(9.0, 6.5))
    said = draw_image(figure, histories, frame)
    (axis,) = figure.axes
    return axis, said.split("\n")


def test_what_is_drawn_image() -> None:
    """Marks where landmarks were measured and computed, as seen from behind the camera."""
    axis, _ = drawn_image(film_image(outlier=[[False, True, False, False]] * 2))
    lines = labelled(axis)
    assert list(lines) == ["computed", "measured", "does not fit", "principal point"]
    (legend,) = axis.figure.legends
    assert texts(legend) == list(lines)
    assert points(lines["measured"]) == POINTS.tolist()
    assert_close("table value", np.array(points(lines["computed"]), float), POINTS - RESIDUAL)
    assert points(lines["does not fit"]) == [POINTS[1].tolist()]
    assert points(lines["principal point"]) == [[0.0, 0.0]]
    looks = {name: (one.get_marker(), one.get_markersize()) for name, one in lines.items()}
    assert looks == {
        "computed": ("+", 12), "measured": ("o", 7), "does not fit": ("s", 12),
        "principal point": ("x", 8),
    }  # fmt: skip
    edges = {name: to_hex(line.get_markeredgecolor()) for name, line in lines.items()}
    assert edges["measured"] == OKABE_ITO[0] and edges["does not fit"] == DARK_RED
    assert lines["measured"].get_markerfacecolor() == "none"
    assert_close("table value", axis.get_xlim(), (5.4, -5.4))  # 1.35 times the farthest, 4
    assert_close("table value", axis.get_ylim(), (-5.4, 5.4))
    assert axis.get_aspect() == 1.0
    assert axis.get_xlabel() == "x, px in the image, to the left"
    assert axis.get_ylabel() == "y, px in the image, up"
    names = [(t.get_text(), list(t.xy)) for t in axis.texts]
    expected = ["bridge; north end: does not fit", "church tower", "=A1", "<crossing>"]
    assert names == list(zip(expected, POINTS[[1, 0, 2, 3]].tolist(), strict=True))
    assert [t.get_fontweight() for t in axis.texts] == ["bold", *["normal"] * 3]


ARROWS = {  # units: times as long, the key, its length in image units
    "px": (Units("m", "px", 1.0, "px", 1.0), 20.0, "0.05 px", 0.05),
    "mm": (MICROMETRES, 20.0, "50 µm", 0.05),
}


@pytest.mark.parametrize("unit", ARROWS)
def test_the_arrows_and_their_key(unit: str) -> None:
    """From the computed position; the longest, .0505, is drawn about .12 of the width, 10.8."""
    units, times, key, length = ARROWS[unit]
    axis, said = drawn_image(film_image(units=units))
    arrows, label = arrows_and_key(axis)
    assert_close("table value", np.column_stack([arrows.X, arrows.Y]), POINTS - RESIDUAL)
    assert_close("table value", np.column_stack([arrows.U, arrows.V]), RESIDUAL)
    assert (arrows.angles, arrows.scale_units) == ("xy", "xy")
    assert_close("table value", arrows.scale, 1.0 / times)
    assert to_hex(arrows.get_facecolor()[0]) == OKABE_ITO[1]
    assert label.text.get_text() == key and label.coord == "axes"
    assert_close("table value", label.U, length)
    assert_approved(said[2], parts=[20])
    assert axis.get_xlabel() == f"x, {unit} in the image, to the left"
    assert axis.get_ylabel() == f"y, {unit} in the image, up"


def test_residuals_of_zero_have_no_key() -> None:
    axis, said = drawn_image(film_image(np.zeros((4, 2))))
    assert arrows_and_key(axis)[1] is None and said[2].endswith("computed, 1 times as long")


LENGTHS = {  # of the longest residual, µm: of the key
    0.9: "0.5 µm", 1.0: "1 µm", 1.99: "1 µm", 2.0: "2 µm", 4.99: "2 µm", 5.0: "5 µm", 9.99: "5 µm",
    10.0: "10 µm", 25.0: "20 µm", 100.0: "100 µm", 0.3: "0.2 µm", 0.003: "0.002 µm",
    999.0: "500 µm", 1000.0: "1 mm",
}  # fmt: skip


@pytest.mark.parametrize("longest_um", LENGTHS)
def test_round_lengths(longest_um: float) -> None:
    """1, 2 or 5 of a power of ten, not above the longest, which is one coordinate: not rounded."""
    axis = Figure().subplots()
    residual = np.array([[0.0, -1.0]]) * longest_um / 1000.0
    residual_arrows(axis, np.zeros((1, 2)), residual, 1.0, MICROMETRES)
    assert arrows_and_key(axis)[1].text.get_text() == LENGTHS[longest_um]


def test_the_scale_of_arrows_is_by_the_longest_and_not_by_a_coordinate() -> None:
    """1.2 of 10 wide: 24 times .05, 30 times .04."""
    assert arrow_scale(np.array([[0.03, 0.04]]), 10.0) == 20.0
    assert arrow_scale(np.array([[0.024, 0.032], [0.0, 0.001]]), 10.0) == 20.0
    assert arrow_scale(np.array([[24.0, 32.0]]), 10.0) == 0.02
    assert arrow_scale(np.zeros((0, 2)), 10.0) == 1.0


TITLES = {  # changes: the lines below the title
    "usual": ({}, 1, "a.dat, job 2: a title", "DJI_0001.JPG, 1.000 s, 4"),
    "time 0": ({}, 0, "a.dat, job 2: a title", "DJI_0000.JPG, 0.000 s, 4"),
    "no time": ({"time_s": np.full(2, np.nan)}, 1, "a.dat, job 2: a title", "DJI_0001.JPG, 4"),
    "a number": ({"frame_names": ()}, 1, "a.dat, job 2: a title", "2, 1.000 s, 4"),
    "formula": ({"frame_names": ("a", "$b\a")}, 1, "a.dat, job 2: a title", r"\$b?, 1.000 s, 4"),
}


@pytest.mark.parametrize("name", TITLES)
def test_the_title(name: str) -> None:
    """Of the job that has the frame, though there are several."""
    changes, k, caption, frame = TITLES[name]
    one = film_image(said=SAID, **changes)
    other = film_image(said=SAID | {"job": 3}, frame_names=("x", "y"), frame=np.array([8, 9]))
    _, said = drawn_image(other, one, frame=one.estimate.frame_label(k))
    assert said[0] == caption
    assert_approved(said[1:], parts=[frame, 20])


def test_a_misfit_is_explained_below_its_own_frame_only() -> None:
    one = film_image(flags={"misfit": [1]}, misfit=["", "without $7"])
    assert drawn_image(one, frame="DJI_0001.JPG")[1][3:] == [r"misfit: without \$7"]
    assert drawn_image(one, frame="DJI_0000.JPG")[1][3:] == []


def test_landmarks_that_take_no_part_or_have_no_numbers_are_not_drawn() -> None:
    used, ignored = np.ones((2, 4), bool), np.zeros((2, 4), bool)
    used[1, 0], ignored[1, 0] = False, True
    points_px, residual = np.tile(POINTS, (2, 1, 1)), np.tile(RESIDUAL.T.ravel(), (2, 1))
    points_px[1, 1, 0], residual[1, 6] = np.nan, np.nan  # x of the second, residual y of the third
    one = by_hand(2, used=used, ignored=ignored, image=points_px, residual=residual)
    axis, said = drawn_image(one, frame="DJI_0001.JPG")
    assert points(labelled(axis)["measured"]) == [[2.0, 2.0]]
    assert [t.get_text() for t in axis.texts] == ["<crossing>"]
    assert_approved(said[1], parts=["DJI_0001.JPG", "1.000 s", "3 landmarks"])
    assert len(points(labelled(drawn_image(one, frame="DJI_0000.JPG")[0])["measured"])) == 4


def test_names_without_room_are_counted() -> None:
    """Twenty landmarks in one place."""
    flat = np.zeros((1, 20))
    many = by_hand(
        1, landmark=flat.astype(int) + 7, used=flat == 0, ignored=flat == 1, outlier=flat == 0,
        image=np.ones((1, 20, 2)), residual=np.zeros((1, 40)), landmark_names={7: "$"},
    )  # fmt: skip
    axis, said = drawn_image(many)
    shown = [t.get_text() for t in axis.texts]
    assert set(shown) == {r"\$: does not fit"} and len(shown) < 20
    assert_approved(said[1], parts=["20 landmarks", f"{20 - len(shown)} names"])


def test_the_words_of_a_source() -> None:
    words = Words(surface="on the film", centre="centre of the image")
    axis, _ = drawn_image(film_image(units=MICROMETRES, said={"words": words}))
    assert axis.get_xlabel() == "x, mm on the film, to the left"
    assert axis.get_ylabel() == "y, mm on the film, up"
    assert list(labelled(axis)) == ["computed", "measured", "centre of the image"]


def test_an_image_whose_landmarks_are_all_at_the_centre_has_a_size() -> None:
    axis, _ = drawn_image(by_hand(1, image=np.zeros((1, 4, 2))))
    assert_close("table value", axis.get_ylim(), (-0.00135, 0.00135))


def test_no_name_of_many_covers_the_mark_of_another() -> None:
    """On film, where x grows to the left."""
    (job,) = make(Plan(frames=1, landmarks=60, seed=1))[:1]
    figure = vopd.run(job).plot("image")
    FigureCanvasAgg(figure).draw()
    axis = max(figure.axes, key=lambda one: len(one.texts))
    boxes = [text.get_window_extent() for text in axis.texts]
    drawn = [line.get_xydata() for line in axis.lines if line.get_marker() in ("o", "s")]
    marks = axis.transData.transform(np.vstack(drawn))
    assert len(boxes) > 50
    assert not [box for box in boxes for mark in marks if box.contains(*mark)]
