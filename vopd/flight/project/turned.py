"""Images that are solved as one, of a camera that has turned between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import fdtrc

from vopd.arrays import Floats, Ints
from vopd.attitude.residuals import SIGNIFICANCE, chance_text
from vopd.findings import size_text
from vopd.flight.formats.picks import PickRows

MOST_IMAGES = 50  # of more some are left out
LEAST_PX = 0.1  # that picks are off: less is rounding


def doubts_of_turn(read: PickRows, image: Ints, names: Sequence[str]) -> list[str]:
    """Doubt that a camera stood still, where the picks of an image are off together.

    A turn shifts and turns the picture. F tests what the shift and turn of every image take from
    the squares of picks about their landmarks' means, (P - L) pairs of numbers.

    Args:
        read: the picks
        image: index of the image of each (P,)
        names: what to call the images
    """
    images = int(image.max(initial=-1)) + 1
    chosen = np.arange(0, images, -(-images // MOST_IMAGES) or 1)
    pick = np.flatnonzero(np.isin(image, chosen))
    mark, own = read.landmark.which[pick], np.searchsorted(chosen, image[pick])
    pixel = read.centred_px(pick)
    about = pixel - pixel.mean(axis=0)
    arm_px = float(np.sqrt((about**2).mean()))
    turn = np.stack([-about[:, 1], about[:, 0]], axis=1) / max(arm_px, LEAST_PX)
    moves = np.zeros((len(pick), 2, len(chosen), 3))  # of each image: right, down, turned
    moves[np.arange(len(pick)), :, own] = np.concatenate(
        [np.broadcast_to(np.eye(2), (len(pick), 2, 2)), turn[:, :, None]], axis=2
    )
    away = _about_means(pixel, mark).ravel()
    columns = _about_means(moves.reshape(len(pick), -1), mark).reshape(away.size, -1)
    move, _, rank, _ = np.linalg.lstsq(columns, away, rcond=1e-9)
    freedom = 2 * (len(pick) - len(np.unique(mark))) - int(rank)
    if not rank or freedom < 1:
        return []
    rest = float(((away - columns @ move) ** 2).sum())
    gain = float((away**2).sum()) - rest
    chance = float(fdtrc(rank, freedom, gain / rank / max(rest / freedom, LEAST_PX**2)))
    if chance > SIGNIFICANCE:
        return []
    size_px = np.hypot(*move.reshape(-1, 3)[:, :2].T)
    farthest = int(np.argmax(size_px))
    return [
        '[solve] frames = "one": the camera has turned between the images: the picks of '
        f"{names[chosen[farthest]]} are {size_text(float(size_px[farthest]))} px off the mean "
        f"of all images, all of them alike (chance {chance_text(chance)}); without this line each "
        "image has its own attitude"
    ]


def _about_means(values: Floats, group: Ints) -> Floats:
    """Take off the mean of each group from its values (P, K)."""
    total = np.zeros((int(group.max(initial=-1)) + 1, values.shape[1]))
    np.add.at(total, group, values)
    count = np.maximum(np.bincount(group, minlength=len(total)), 1)
    return np.asarray(values - (total / count[:, None])[group])
