"""A job's attitude history in parts, so that a table of any length needs the memory of one part."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from vopd.attitude.history import History
from vopd.attitude.history_summary import HistorySummary, summary_of
from vopd.attitude.long_history import with_about
from vopd.estimate import About


class HistoryParts:
    """The attitude history of one job in parts of consecutive frames, in the order of the frames.

    A part is made when it is come to, and made again whenever the parts are gone through again.

    Attributes:
        head: the history of one frame or more, for what is said of the whole job
        frames: how many frames the job has
    """

    def __init__(
        self,
        head: History,
        frames: int,
        make: Callable[[], Iterator[History]],
        whole: Callable[[], History],
    ) -> None:
        self.head = head
        self.frames = frames
        self._make = make
        self._make_whole = whole
        self._whole: History | None = None
        self._summary: HistorySummary | None = None

    @property
    def about(self) -> About:
        """What the history is about: source, job, title and fixes."""
        return self.head.about

    def __iter__(self) -> Iterator[History]:
        if self._whole is not None:
            yield self._whole
            return
        summary = HistorySummary()
        for part in self._make():
            summary.add(part)
            yield part
        self._summary = summary

    @property
    def counted(self) -> bool:
        """Whether `summary` takes no further work."""
        return self._whole is not None or self._summary is not None

    @property
    def summary(self) -> HistorySummary:
        """What is said of the frames together; known once all parts have been made."""
        if self._summary is None:
            self._summary = summary_of(self)
        return self._summary

    @property
    def whole(self) -> History:
        """All frames together."""
        if self._whole is None:
            self._whole = self._make_whole()
        return self._whole

    def has_attitude(self) -> bool:
        """Whether any frame has an attitude; the parts up to that frame are made."""
        return any(part.has_attitude.any() for part in self)

    def with_about(self, about: About) -> HistoryParts:
        """The same history under another description of its source."""
        return HistoryParts(
            with_about(self.head, about),
            self.frames,
            lambda: (with_about(part, about) for part in self),
            lambda: with_about(self.whole, about),
        )

    def watched(self, tell: Callable[[int], object]) -> HistoryParts:
        """The same history, which reports its progress: the frames of each part that is made.

        Args:
            tell: is given the number of frames
        """

        def parts() -> Iterator[History]:
            for part in self:
                tell(len(part.estimate.frame))
                yield part

        return HistoryParts(self.head, self.frames, parts, lambda: self.whole)


def one_part(history: History) -> HistoryParts:
    """A history that is made already, as its only part.

    Args:
        history: of one job
    """
    parts = HistoryParts(
        history, len(history.estimate.frame), lambda: iter((history,)), lambda: history
    )
    parts._whole = history
    return parts
