"""What `vopd plot` draws of star photographs: the residuals over the image."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from vopd.figures.star_residuals import StarPicture, draw_star_residuals
from vopd.findings import VopdError

if TYPE_CHECKING:
    from vopd.stellar.files.read_solution import ReadSolution


def plot_stars(names: Sequence[str], frame: str | None, size_in: tuple[float, float] | None) -> Any:
    """A figure of one solution: of the photograph asked for, or of that with the most stars.

    Args:
        names: files that `vopd stars solve --format json` wrote
        frame: the photograph's name
        size_in: width and height, inches

    Raises:
        VopdError: no such photograph, or a file is not such a file.
    """
    from vopd.stellar.files.read_solution import read_solutions

    found = [(name, one) for name in names for one in read_solutions(name)]
    asked = [pair for pair in found if frame in (None, pair[1].image)]
    if not asked:
        known = ", ".join(dict.fromkeys(one.image for _, one in found if one.image))
        raise VopdError(f"no photograph {frame}" + (f": there are {known}" if known else ""))
    name, solution = max(asked, key=lambda pair: len(pair[1].images))
    return draw_star_residuals(_picture(name, solution), size_in)


def _picture(name: str, one: ReadSolution) -> StarPicture:
    alpha, delta, swing = one.pointing
    image = f", {one.image}" if one.image else ""
    title = (
        f"{name}{image}: {one.method}, {len(one.images)} stars\n"
        f"alpha {alpha:.5f}, delta {delta:.5f}, swing {swing:.5f} degrees"
    )
    return StarPicture(title, one.images, one.residuals, one.labels, one.unit)
