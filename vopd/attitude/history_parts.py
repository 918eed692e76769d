"""A job's attitude history in parts, so that a table of any length needs the memory of one part."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property

from vopd.attitude.blocks import with_about
from vopd.attitude.history import History
from vopd.attitude.history_summary import HistorySummary, summary_of
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
        self._whole = whole

    @property
    def about(self) -> About:
        """What the history is about: source, job, title and fixes."""
        return self.head.about

    def __iter__(self) -> Iterator[History]:
        if "whole" in self.__dict__:
            yield self.whole
            return
        summary = HistorySummary()
        for part in self._make():
            summary.add(part)
            yield part
        self.__dict__["summary"] = summary

    @property
    def counted(self) -> bool:
        """Whether `summary` takes no further work."""
        return bool({"whole", "summary"} & set(self.__dict__))

    @cached_property
    def summary(self) -> HistorySummary:
        """What is said of the frames together; known once all parts have been made."""
        return summary_of(self)

    @cached_property
    def whole(self) -> History:
        """All frames together."""
        return self._whole()

    def has_attitude(self) -> bool:
        """Whether any frame has an attitude; the parts up to that frame are made."""
        return any(part.has_attitude.any() for part in self)

    def with_about(self, about: About) -> HistoryParts:
        """The same with other words about its source."""
        return HistoryParts(
            with_about(self.head, about),
            self.frames,
            lambda: (with_about(part, about) for part in self),
            lambda: with_about(self.whole, about),
        )

    def watched(self, tell: Callable[[int], object]) -> HistoryParts:
        """The same, which tells the number of frames of each part when that has been made.

        Args:
            tell: is given the number
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
    parts.__dict__["whole"] = history
    return parts
