"""Which jobs are computed together: those that are alike, in groups of enough frames."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator


def alike_together(jobs: Iterable[tuple[Hashable, int]], enough: int) -> Iterator[list[int]]:
    """Indices of jobs that are alike, in groups that end when they have enough frames.

    Args:
        jobs: of each job what those that are alike have in common, and how many frames it has
        enough: frames of a group
    """
    alike: dict[Hashable, list[int]] = {}
    frames: dict[Hashable, int] = {}
    for index, (kind, count) in enumerate(jobs):
        alike.setdefault(kind, []).append(index)
        frames[kind] = frames.get(kind, 0) + count
        if frames[kind] >= enough:
            del frames[kind]
            yield alike.pop(kind)
    yield from alike.values()
