"""Readings with some of their arrays replaced."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vopd.job import Readings

ARRAYS = "frame", "fiducial_in", "landmark", "present", "landmark_in"


def reread(readings: Readings, **arrays: np.ndarray) -> Readings:
    """The readings with other arrays, by frame and landmark as `Readings.of` takes them."""
    every = {name: getattr(readings, name) for name in ARRAYS} | arrays
    return replace(Readings.of(**every), first_card=readings.first_card)
