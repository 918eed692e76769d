"""All that is known of solved frames of a deck, and of their surroundings, number by number."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.command import DECKS
from tests.kit.jobs import case, film, without
from tests.kit.spherical_film import uneven
from tests.kit.whole import whole
from vopd.errata import NO_FIXES, Fixes, fixes
from vopd.estimate import Estimate
from vopd.film import estimates_of_jobs, film_estimate
from vopd.job import Job
from vopd.program.vopd import run
from vopd.results import SolvedJob


def surroundings(one: Estimate, every: int = 1) -> str:
    """Tell the surroundings of frames, of their landmarks each so manieth one."""
    assert one.scene is not None
    scene: Any = one.scene()
    frames = np.arange(len(scene.camera_m))
    numbers = sorted({int(number) for number in one.frame})
    corners, places, axes = scene.film(frames)
    sights = [scene.sight(number, "") for number in numbers]
    return whole({
        "names": scene.names[::every], "camera_m": scene.camera_m,
        "landmark_m": scene.landmark_m[::every],
        "index": [scene.index(number, "") for number in numbers],
        "sight": [(mark[::every], ray[::every]) for mark, ray in sights],
        "corners": corners, "places": places[:, ::every], "axes": axes,
    })  # fmt: skip


def mounted() -> Job:
    """Four frames, of which one is left out, of a camera that is turned in its vehicle."""
    job = without(film(4), 2)
    wind = replace(job.wind, altitude_ft=np.array([119_920.0, 119_990.0]))
    camera = replace(
        job.camera, multiplier=np.array([1.0, -0.5, 1.0]), offset_deg=np.array([10.0, -20.0, 30.0])
    )
    return replace(job, camera=camera, wind=wind)


@pytest.mark.parametrize(
    ("job", "chosen"),
    [(mounted(), NO_FIXES), (mounted(), fixes("earth", "restart")), (case(4), NO_FIXES),
     (vopd.read_deck(DECKS / "regression" / "ignored.dat")[0], fixes("earth"))],
    ids=["mounted", "mounted, earth", "case 4", "ignored"],
)  # fmt: skip
def test_an_estimate_number_by_number(job: Job, chosen: Fixes) -> None:
    one = film_estimate(run(job, chosen), "a.dat", 3)
    left_out = ("about", "scene", "frame_names")
    every = {field.name: getattr(one, field.name) for field in fields(one)}
    told = {name: value for name, value in every.items() if name not in left_out}
    assert_approved(whole(told | {"about": one.about._replace(words=None)}, form=".8f"))
    assert_approved(surroundings(one))


def test_surroundings_of_blocks() -> None:
    """A frame of very many landmarks between others of few."""
    solved = run(uneven([3, 3000, 3, 4]))
    (blocks,) = estimates_of_jobs([SolvedJob("a.dat", 3, solved)])
    assert len(blocks) > 1
    together = replace(blocks[0][1], frame=solved.frame)
    assert_approved(surroundings(together, 700))
