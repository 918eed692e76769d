"""Make the readings of a synthetic film: the landmarks of each frame, each read three times."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.job import Landmarks, Readings
from vopd.synthetic.camera import CameraView, images
from vopd.synthetic.ground import FLATTEST, IN_X, in_view, only, points_km
from vopd.synthetic.plan import Plan, RandomPart, random_stream

FRAMES_AT_A_TIME = 2000  # frames at a time
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])  # over the frame's size


def choose_landmarks(
    plan: Plan, seen: CameraView, marks: Landmarks
) -> tuple[Landmarks, Ints, Floats]:
    """Choose the landmarks that are read in each frame.

    The lowest number in view is read, then always the one farthest on the ground
    from those chosen: a landmark stays until one enters or leaves the frame.

    Args:
        plan: the flight
        seen: the camera in F frames
        marks: the landmarks that may be in view

    Returns:
        The landmarks that are read in any frame, numbered anew; the index of each frame's
        landmarks among them (F, L); and their images on the film reader, in (F, L, 2).
    """
    chunks = [
        seen.only(slice(k, k + FRAMES_AT_A_TIME))
        for k in range(0, len(seen.axes), FRAMES_AT_A_TIME)
    ]
    parts = [_choose_in_frames(plan, chunk, marks) for chunk in chunks]
    which, image = (np.concatenate(part) for part in zip(*parts, strict=True))
    read, index = np.unique(which, return_inverse=True)
    return only(marks, read), index.reshape(which.shape), image


def _choose_in_frames(plan: Plan, seen: CameraView, marks: Landmarks) -> tuple[Ints, Floats]:
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


def read_film(plan: Plan, frame: Ints, landmark: Ints, image_in: Floats, time: int) -> Readings:
    """The three readings of every point, in thousandths of an inch, with noise.

    Args:
        plan: the flight
        frame: frame numbers (F,)
        landmark: landmark numbers (F, L)
        image_in: images of the landmarks on the film reader, in (F, L, 2)
        time: how often this film was read before; each time has other noise
    """
    random = random_stream(plan, RandomPart.FILM, time)

    def read(point: Floats) -> Floats:
        three = np.repeat(point[:, :, None], 3, axis=2)
        noisy = three + plan.noise_in * random.standard_normal(three.shape)
        return np.asarray(np.round(noisy * 1000.0) / 1000.0 + 0.0)  # no minus zero

    corners = np.broadcast_to(CORNERS * plan.frame_in, (len(frame), 4, 2))
    return Readings.of(
        frame=frame,
        fiducial_in=read(corners),
        landmark=landmark,
        present=np.ones(landmark.shape, bool),
        landmark_in=read(image_in),
    )
