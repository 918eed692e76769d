"""Results that show themselves: printed, in a notebook, as a figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vopd.findings import Finding, refuse_other_kind

if TYPE_CHECKING:  # a run of a deck waits for none of this
    from matplotlib.figure import Figure

    from vopd.attitude.long_history import HistoryParts


class Shown:
    """Base class of results with frames."""

    def _shown(self) -> tuple[list[HistoryParts], Sequence[Finding]]:
        """Give the jobs, and the warnings."""
        raise NotImplementedError

    def summary(self, width: int = 80) -> str:
        """Return the short table: the first frames, their uncertainty, and doubtful frames."""
        from vopd.attitude.summary import finding_texts, text

        refuse_other_kind(width, int, "summary", "columns of a screen")
        jobs, findings = self._shown()
        return text(jobs, width, finding_texts(findings))

    def __str__(self) -> str:
        return self.summary()

    def _repr_html_(self) -> str:
        from vopd.attitude.summary import html

        return html(*self._shown())

    def plot(self, name: str = "attitude", frame: int | str | None = None) -> Figure:
        """Draw a figure.

        Args:
            name: "attitude", "attack", "residuals", "image", "map", "patches" or "all"
            frame: number or name of the frame of image and map; None takes the one with the
                most landmarks

        Raises:
            VopdError: where matplotlib is not installed, or there is nothing to draw
        """
        from vopd.figures import draw

        return draw(name, [job.whole for job in self._shown()[0]], frame)
