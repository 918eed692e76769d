"""The numbers of landmarks and frames on cards, which have two and four columns for them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.write_number import rounded_to_fit
from vopd.findings import VopdError
from vopd.flight.flight import Flight

MOST_LANDMARKS, MOST_FRAMES = 99, 9999  # two and four columns


class NumberRow(NamedTuple):
    """What a number on the cards stands for."""

    kind: str  # frame or landmark
    number: int
    name: str


def _within(what: str, count: int, most: int) -> None:
    if count > most:
        raise VopdError(f"{count} {what}: cards have numbers for {most}; punch a part of them")


def landmark_numbers(flight: Flight, seen: Ints) -> tuple[Ints, list[NumberRow]]:
    """A number of two columns for each landmark of the flight (N,), 0 where it is not seen.

    Args:
        flight: the flight
        seen: indices of the landmarks that are seen

    Returns:
        The numbers, and what they stand for where they are not the flight's own.

    Raises:
        VopdError: where there are more landmarks than numbers
    """
    _within("landmarks", len(seen), MOST_LANDMARKS)
    own = flight.landmarks.number
    keeps = all(
        0 < own[k] <= MOST_LANDMARKS and _is_its_name(int(own[k]), flight.landmarks.name[k])
        for k in seen
    )
    number = np.zeros(len(own), np.int64)
    number[seen] = own[seen] if keeps else np.arange(1, len(seen) + 1)
    rows = [NumberRow("landmark", int(number[k]), flight.landmarks.name[k]) for k in seen]
    return number, [] if keeps else rows


def _is_its_name(number: int, name: str) -> bool:
    """Whether a landmark is called by its number."""
    return name.isascii() and name.isdigit() and int(name) == number


def frame_numbers(flight: Flight, frames: Ints) -> tuple[Ints, list[NumberRow]]:
    """A number of four columns for each frame that is written; its own where that fits.

    Args:
        flight: the flight
        frames: indices of the frames that are written

    Returns:
        The numbers, and what they stand for where they are not the flight's own.

    Raises:
        VopdError: where there are more frames than numbers
    """
    _within("frames", len(frames), MOST_FRAMES)
    own = flight.frame[frames]
    if not flight.image_name and own.min(initial=0) >= 0 and own.max(initial=0) <= MOST_FRAMES:
        return own, []
    number = np.arange(1, len(frames) + 1)
    names = flight.image_name or tuple(str(n) for n in flight.frame)
    return number, [
        NumberRow("frame", int(n), names[k]) for n, k in zip(number, frames, strict=True)
    ]


def frame_times(flight: Flight, frames: Ints) -> tuple[Floats, list[str]]:
    """Times that increase from frame to frame, to what ten columns hold."""
    time_s = np.array([rounded_to_fit(t, 82, 0) for t in flight.time_s[frames]])
    if np.isfinite(time_s).all() and (np.diff(time_s) > 0.0).all():
        return time_s, []
    note = "the frames have no times that increase: on the cards they are a second apart"
    return np.arange(len(frames), dtype=np.float64), [note]
