"""Put sources together into chunks: small decks are solved together, a large one by itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import ceil

from vopd.batch.sources import BatchSource

CHUNK_BYTES = 4_000_000  # about 2,000 frames of four landmarks
CHUNK_SOURCES = 200
LEAST_CHUNKS = 4  # for each process, so that all have work to the end


def even_chunk_bytes(sources: Sequence[BatchSource], processes: int) -> float:
    """The bytes of a chunk for which every process has as many chunks, about equally large.

    Args:
        sources: the sources
        processes: how many work on them
    """
    sizes = [one.size for one in sources if not one.flight]
    for_each = max(sum(sizes) / CHUNK_BYTES, len(sizes) / CHUNK_SOURCES) / processes
    return max(sum(sizes), 1) / (processes * max(LEAST_CHUNKS, ceil(for_each)))


def chunks(
    sources: Iterable[BatchSource], chunk_bytes: float = CHUNK_BYTES
) -> Iterator[list[BatchSource]]:
    """The sources in chunks, in order; a flight is a chunk by itself.

    Args:
        sources: the sources
        chunk_bytes: of the decks in a chunk; each begins with the deck whose middle lies
            behind the next multiple of it
    """
    chunk: list[BatchSource] = []
    before, number = 0, 0.0
    for source in sources:
        now = (before + source.size / 2.0) // chunk_bytes
        full = len(chunk) == CHUNK_SOURCES or now != number
        if chunk and (full or source.flight or chunk[-1].flight):
            yield chunk
            chunk = []
        chunk.append(source)
        number = now
        before += 0 if source.flight else source.size
    if chunk:
        yield chunk


def taken_apart(chunk: list[BatchSource]) -> list[list[BatchSource]]:
    """Every source of a chunk as a chunk by itself."""
    return [[one] for one in chunk]
