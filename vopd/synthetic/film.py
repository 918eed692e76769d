"""The film read: which landmarks in each frame, and three readings of every point."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.job import Landmarks, Readings
from vopd.synthetic.camera import View, images
from vopd.synthetic.ground import FLATTEST, IN_X, in_view, only, points_km
from vopd.synthetic.plan import Part, Plan, stream

CHUNK = 2000  # frames at a time
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])  # over the frame's size


def choose(plan: Plan, seen: View, marks: Landmarks) -> tuple[Landmarks, Ints, Floats]:
    """The landmarks that are read, numbered anew; which are in each frame; and their images.

    Which (F, L) is by their place, from 0; the images (F, L, 2) are inches on the
    reader. The lowest number in view is read, then always the one farthest on the
    ground from those taken: a landmark stays until one enters or leaves the film.
    """
    chunks = [seen.only(slice(k, k + CHUNK)) for k in range(0, len(seen.axes), CHUNK)]
    parts = [_choose(plan, chunk, marks) for chunk in chunks]
    which, image = (np.concatenate(part) for part in zip(*parts, strict=True))
    read, place = np.unique(which, return_inverse=True)
    return only(marks, read), place.reshape(which.shape), image


def _choose(plan: Plan, seen: View, marks: Landmarks) -> tuple[Ints, Floats]:
    where = points_km(marks)
    image, slope = images(plan, seen, where)
    free = in_view(image / plan.frame_in, IN_X) & (slope > FLATTEST)
    apart = np.linalg.norm(where[:, None] - where, axis=-1)
    frames = np.arange(len(image))
    taken = [free.argmax(axis=1)]
    nearest = apart[taken[0]]
    for _ in range(1, plan.landmarks):
        taken.append(np.where(free, nearest, -1.0).argmax(axis=1))
        nearest = np.minimum(nearest, apart[taken[-1]])
    which = np.sort(np.stack(taken, axis=1), axis=1)
    return which, image[frames[:, None], which]


def readings(plan: Plan, frame: Ints, landmark: Ints, image_in: Floats, time: int) -> Readings:
    """What the reader punches, in thousandths of an inch, of images (F, L, 2) in inches.

    `time` counts how often this film was read before: its noise is another.
    """
    random = stream(plan, Part.FILM, time)

    def read(point: Floats) -> Floats:
        three = np.repeat(point[:, :, None], 3, axis=2)
        noisy = three + plan.noise_in * random.standard_normal(three.shape)
        return np.asarray(np.round(noisy * 1000.0) / 1000.0 + 0.0)  # no minus zero

    corners = np.broadcast_to(CORNERS * plan.frame_in, (len(frame), 4, 2))
    return Readings(
        frame=frame,
        fiducial_in=read(corners),
        landmark=landmark,
        present=np.ones(landmark.shape, bool),
        landmark_in=read(image_in),
    )
