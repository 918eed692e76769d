"""The lowest panel of angles: half the width of the 95 % intervals, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.figures import ANGLES, ETA, HALF, film, panels, points
from tests.kit.histories import by_hand
from tests.tolerances import assert_close

MARKS = ["-", "--", ":"]


def test_half_widths() -> None:
    """Broken at the gap and nowhere else; none where it is 0 or there is none."""
    angles, half, eta = ANGLES.copy(), HALF.copy(), ETA.copy()
    angles[:, 6] = np.arange(5) * 170.0  # which wraps
    half[0, 6], half[1, 7] = 0.0, np.inf
    eta[2] = angles[2, 8]
    axis = panels([film(angles_deg=angles, half_deg=half, eta_deg=eta)])[3]
    alpha, beta = HALF[[1, 2, 3, 0, 4], 6], HALF[[1, 2, 3, 0, 4], 7]
    expected = [
        [alpha[0], alpha[1], alpha[2], None, None, alpha[4]],
        [None, beta[1], beta[2], beta[3], None, beta[4]],
        [0.625, None, 0.625, 0.625, None, 0.625],
    ]
    drawn = [line for line in axis.lines if len(line.get_xdata())]
    for line, values in zip(drawn, expected, strict=True):
        assert [y for _, y in points(line)] == values
        assert [x for x, _ in points(line)] == [0.0, 1.0, 2.0, 3.0, None, 12.0]
    looks = [(one.get_marker(), one.get_markersize(), one.get_linewidth()) for one in drawn]
    assert looks == [(".", 2.5, 1.0)] * 3


SCALES = {  # smallest and largest half-width: both ends of the scale
    (0.02, 0.5): (0.01, 1.0),
    (1e-9, 0.5): (5e-7, 1.0),
    (2e-6, 2.0): (2e-6, 4.0),
    (8e-6, 2.0): (4e-6, 4.0),
}


@pytest.mark.parametrize("least_and_most", SCALES)
def test_the_scale_of_half_widths(least_and_most: tuple[float, float]) -> None:
    """Twice as far as they go both ways, but six powers of ten at most."""
    half = np.tile([*least_and_most, least_and_most[1]], (9, 1)).T
    axis = panels([by_hand(3, half_deg=half, eta_deg=np.full((3, 2), np.nan))])[3]
    assert axis.get_yscale() == "log"
    assert_close("relative, in blocks or not", axis.get_ylim(), SCALES[least_and_most])
    assert axis.yaxis.get_major_formatter()(0.003, None) == "0.003"
    assert axis.yaxis.get_minor_formatter()(0.02, None) == ""
    marked = axis.yaxis.get_major_locator().tick_values(0.009, 1.1)
    assert_close(
        "table value", marked[(marked > 0.009) & (marked < 1.1)], [0.01, 0.03, 0.1, 0.3, 1]
    )
    assert axis.yaxis.get_major_locator().numticks == 7
    legend = axis.get_legend()
    assert [one.get_linestyle() for one in legend.get_lines()] == MARKS
    assert {one.get_color() for one in legend.get_lines()} == {"0.3"}
    assert legend._ncols == 3
    anchor, dpi = legend.get_bbox_to_anchor(), axis.figure.dpi
    assert_close("flight pixel", [anchor.x0, axis.bbox.y0 - anchor.y0], [axis.bbox.x0, 0.42 * dpi])


def test_without_half_widths_there_is_no_logarithmic_scale() -> None:
    none = by_hand(3, half_deg=np.full((3, 9), np.inf), eta_deg=np.full((3, 2), np.nan))
    axis = panels([none])[3]
    assert axis.get_yscale() == "linear" and axis.get_ylabel() == "half of 95 %,\ndegrees"
