"""Landmarks, and the picks of them as readings on film, as cards hold them."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.convert.card_lens import CardFilm
from vopd.convert.card_trajectory import FT_PER_M, to_ten_columns
from vopd.flight.flight import Flight
from vopd.flight.frame_slots import FrameSlots
from vopd.geometry.earth import geodetic
from vopd.job import Ignored, Landmarks, Readings


def card_landmarks(flight: Flight, seen: Ints, number: Ints) -> Landmarks:
    """The landmarks that are seen, with longitude and latitude in degrees and minutes.

    Args:
        flight: the flight
        seen: indices of the landmarks that are seen
        number: of each landmark of the flight on the cards (N,)
    """
    where = geodetic(flight.landmarks.position_m[seen])
    degrees, minutes = [], []
    for angle in (where.longitude_deg, where.latitude_deg):
        whole = np.floor(angle)
        degrees.append(whole)
        minutes.append(to_ten_columns((angle - whole) * 60.0))
    return Landmarks(
        number[seen], degrees[0], minutes[0], degrees[1], minutes[1],
        to_ten_columns(where.height_m * FT_PER_M),
    )  # fmt: skip


def card_ignored(flight: Flight, number: Ints) -> Ignored:
    """Check landmarks are ignored in all frames; a column for each landmark, 0 where none."""
    used = np.array(flight.landmarks.used or (True,) * len(number), dtype=bool)
    check = number[~used & (number > 0)]
    everywhere = np.zeros((number > 0).sum(), np.int64)
    everywhere[: len(check)] = check
    return Ignored(np.zeros(0, np.int64), np.zeros((0, 6), np.int64), everywhere)


def card_readings(
    flight: Flight, film: CardFilm, held: Bools, frames: Ints, frame: Ints, number: Ints
) -> Readings:
    """Three readings of each pick, whose spread is that of the pick's standard deviation."""
    index = np.full(len(flight.frame), -1)
    index[frames] = np.arange(len(frames))
    pick = np.flatnonzero(held & (index[flight.picks.frame] >= 0))
    slots = FrameSlots.of(index[flight.picks.frame[pick]], len(frames))
    apart = np.sqrt(3.0) * flight.picks.sigma_px[pick] * film.inches_per_px
    three = film.point_in[pick, None] + apart[:, None, None] * np.array([-1.0, 0.0, 1.0])[:, None]
    readings = slots.spread(_to_the_reader(three))
    corner = np.floor(film.centre_in * 90.0) / 100.0
    corners = film.centre_in + corner * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    fiducials = np.round(np.repeat(corners[:, None], 3, axis=1), 3)
    present: Bools = slots.spread(np.ones(len(pick), bool))
    return Readings.of(
        frame=frame,
        fiducial_in=np.tile(fiducials, (len(frames), 1, 1, 1)),
        landmark=slots.spread(number[flight.picks.landmark[pick]]),
        present=present,
        landmark_in=readings,
    )


def _to_the_reader(inches: Floats) -> Floats:
    """Readings to what seven columns hold with sign and point."""
    five, four, three = (np.round(inches, decimals) for decimals in (5, 4, 3))
    fits_five = (five >= 0.0) & (five < 10.0)
    fits_four = (four > -10.0) & (four < 100.0)
    return np.where(fits_five, five, np.where(fits_four, four, three))
