"""Put sources together into chunks: small decks are solved together, a large one by itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from vopd.batch.sources import BatchSource

CHUNK_BYTES = 4_000_000  # about 2,000 frames of four landmarks
CHUNK_SOURCES = 200


def chunks(
    sources: Iterable[BatchSource], most: int = CHUNK_SOURCES
) -> Iterator[list[BatchSource]]:
    """The sources in chunks, in order; a flight is a chunk by itself.

    Args:
        sources: the sources
        most: the largest number of decks in a chunk
    """
    chunk: list[BatchSource] = []
    size = 0
    for source in sources:
        full = len(chunk) == most or size + source.size > CHUNK_BYTES
        if chunk and (full or source.flight or chunk[-1].flight):
            yield chunk
            chunk, size = [], 0
        chunk.append(source)
        size += source.size
    if chunk:
        yield chunk


def taken_apart(chunk: list[BatchSource]) -> list[list[BatchSource]]:
    """Every source of a chunk as a chunk by itself."""
    return [[one] for one in chunk]
