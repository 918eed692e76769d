"""Figures whole: each line, mark, text and axis of what no command of the approved cases draws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.approved.texts import assert_approved
from tests.kit.command import ROOT
from tests.kit.drawn import described
from tests.kit.figures import alike, film
from tests.kit.histories import (
    FILM,
    about,
    by_hand,
    flagged_film,
    flight,
    histories,
    turning,
    with_estimate,
)
from tests.kit.joint_flights import drone, flight_of
from tests.kit.renamed_hill import renamed
from vopd.attitude.history import History
from vopd.figures import draw
from vopd.figures.adjust import draw_adjusted
from vopd.figures.stars import StarPicture, draw_errors_by_pair, draw_star_residuals
from vopd.flight.result import solve_flight, solve_flight_read
from vopd.flight.solve.equations import Priors
from vopd.scene import Change

PHOTOGRAPH = np.add.outer(0.1 * np.arange(1080), 50.0 * np.sin(0.07 * np.arange(1920)) + 80.0)


def of_many(frames: int, landmarks: int, jobs: int = 1) -> list[History]:
    """Jobs of as many landmarks, each with numbers of its own; some residuals are far larger."""
    random = np.random.default_rng(frames)
    made = []
    for job in range(jobs):
        residual = random.normal(size=(frames, 2, 4)) * np.linspace(1.0, 2.0, 4) / 1000.0
        residual[::97, 0, 1] *= 30.0
        first = 7 + (4 * job) % landmarks
        many = np.tile(first + np.arange(4), (frames, 1))
        outlier = np.zeros((frames, 4), bool)
        outlier[::97, 1] = True
        time_s = np.arange(frames) + np.where(np.arange(frames) > frames // 2, 30.0, 0.0)
        made.append(
            by_hand(
                frames, residual=residual.reshape(frames, 8), units=FILM, landmark=many,
                outlier=outlier, time_s=time_s, said={"job": job + 1, "source": "long.dat"},
            )
        )  # fmt: skip
    return made


def from_above() -> History:
    """A survey's frames, whose landmarks are not all picked."""
    scene = drone(np.random.default_rng(1), 6, 8)
    return solve_flight_read(flight_of(np.random.default_rng(2), scene, 0.3, Priors())).history()


def with_scene(one: History, **changes: Any) -> History:
    assert one.estimate.scene is not None
    scene = replace(one.estimate.scene(), **changes)
    return with_estimate(one, scene=lambda: scene)


def case_4() -> History:
    """A film of landmarks 40 km away."""
    return histories("appendix_h/case4")[0]


def hill() -> History:
    one = solve_flight(ROOT / "examples" / "hill" / "flight.toml").history()
    return about(one, source="hill/flight.toml")


def all_around() -> History:
    """The hill, of which three landmarks are behind the camera, where nothing sees them."""
    one = hill()
    assert one.estimate.scene is not None
    moved_m = one.estimate.scene().landmark_m.copy()
    moved_m[::2] = 2.0 * one.estimate.scene().camera_m[0] - moved_m[::2]
    return with_scene(one, landmark_m=moved_m)


def two_moved() -> History:
    """A survey of which two landmarks were elsewhere."""
    one = from_above()
    assert one.estimate.scene is not None
    moved_m = one.estimate.scene().landmark_m.copy()
    moved_m[[0, 2]] += [[30.0, 0.0, 10.0], [0.0, 20.0, 0.0]]
    return with_scene(one, landmark_m=moved_m)


def clicked() -> History:
    """The hill, of which two landmarks were clicked and followed; a click is wrong."""
    one = hill()
    assert one.estimate.scene is not None
    scene = one.estimate.scene()
    assert scene.image is not None
    places = [(0, 0), (3, 0), (4, 0), (1, 3)]
    views = [scene.image(*one.estimate.frame_key(k)) for k, _ in places]
    pixels = np.array([view.computed[m] for view, (_, m) in zip(views, places, strict=True)])
    wrong = np.array([False, True, False, False])
    at, marks = np.transpose(places)
    grey = Image.fromarray(PHOTOGRAPH.astype(np.uint8))
    shown = replace(
        scene, clicks=lambda: (at, marks, pixels, wrong), photograph=lambda *_: grey.copy()
    )
    return with_estimate(one, scene=lambda: shown)


DRAWN: dict[str, Callable[[], Any]] = {
    "angles that wrap, a gap, a frame alone": lambda: draw("attitude", [film()]),
    "two films": lambda: draw(["attack", "attitude"], [film(), film(said={"source": "b.dat"})]),
    "round and round": lambda: draw("attitude", [turning(23.0)]),
    "roll about 180": lambda: draw("attack", alike(70, 178.0, 350.0)),
    "flags": lambda: draw("attitude", [flagged_film(), flagged_film(said={"source": "c.dat"})]),
    "no times": lambda: draw(
        ["attitude", "residuals"], [by_hand(3, time_s=np.full(3, np.nan), frame=np.arange(3))]
    ),
    "with times and without": lambda: draw(
        ["attitude", "residuals"], [film(), by_hand(3, time_s=np.full(3, np.nan))]
    ),
    "means of residuals": lambda: draw("residuals", of_many(610, 4)),
    "more landmarks than colours": lambda: draw("residuals", of_many(250, 12, 3)),
    "marks at some residuals": lambda: draw("residuals", of_many(150, 4)),
    "others among few": lambda: draw("residuals", of_many(20, 12, 3), size_in=(4.0, 8.0)),
    "each its own landmark": lambda: draw("residuals", of_many(1, 4)),
    "jobs of one frame": lambda: draw(["attitude", "attack", "residuals"], of_many(1, 4, 4)),
    "eight jobs of one frame": lambda: draw(["attitude", "residuals"], of_many(1, 8, 8)),
    "long names": lambda: draw(
        ["image", "map", "residuals"], [about(renamed(), source="hill/flight.toml")], 2
    ),
    "from above": lambda: draw(["image", "map"], [from_above()]),
    "all around": lambda: draw("map", [all_around()], 0),
    "turned and not": lambda: draw("attitude", [*flight(), *alike(4, 20.0)]),
    "a place and none": lambda: draw("all", [with_estimate(case_4(), scene=None), *flight()]),
    "far on a grid": lambda: draw(
        "map",
        [with_scene(case_4(), crs="EPSG:9", plane=lambda m: (m[:, :2], 0.1 * m[:, 0] / m[:, 0]))],
    ),
    "two lines miss": lambda: draw("map", [two_moved()]),
    "clicks": lambda: draw(["image", "map", "patches"], [clicked()]),
    "patches of picks": lambda: draw(
        "patches", [with_scene(clicked(), clicks=None)], size_in=(4.0, 5.0)
    ),
}


@pytest.mark.filterwarnings(r"ignore:Glyph \d+", "ignore:Matplotlib currently does not support")
@pytest.mark.parametrize("name", DRAWN)
def test_histories(name: str) -> None:
    assert_approved("\n".join(described(DRAWN[name]())))


CHANGES = [
    Change("focal", "1 → 2 ± 1 px", 0.5, 0.25, stated=True),
    Change("k1", "3 → 4 ± 1", -2.0, 1.0, stated=False),
    Change("centre_u", "7 px, trades with yaw", np.nan, 1.0, stated=True),
    Change(f"{'m' * 30} east", "$5", 0.1, 0.05, stated=True),
]


@pytest.mark.parametrize("count", [4, 40])
def test_adjusted(count: int) -> None:
    changes = [one._replace(moved=one.moved + k) for k in range(count // 4) for one in CHANGES]
    random = np.random.default_rng(count)
    rms_px = random.uniform(1.0, 2.0, (count + 1, 2))
    rms_px[2], rms_px[3, 0] = np.nan, np.nan
    names = [f"mark {k}" for k in range(count)]
    size_in = (6.0, 7.0) if count == 4 else None
    assert_approved(
        "\n".join(described(draw_adjusted("a $title$", changes, names, rms_px, size_in)))
    )


IMAGES = np.array([[1.0, 2.0], [-10.0, 4.0], [3.0, -6.0], [60.0, 30.0], [8.0, 8.0], [-4.0, -4.0]])
RESIDUALS = 0.01 * np.array(
    [[1.0, 2.0], [3.0, -4.0], [400.0, 0.0], [1.0, 1.0], [0.0, 2.0], [0.0, 0.0]]
)
STARS = StarPicture(
    "a $title$", IMAGES, RESIDUALS, ("Deneb", "$a$", "7", "far", "b", "c"), "mm",
    odd=[False, False, True, False, True, False], left_out=[False, False, True, False, False, True],
)  # fmt: skip
WIDE = (-20.0, 20.0, -15.0, 15.0)


def sky_deg(points: Any) -> Any:
    """A field about 0 h, 60 degrees north."""
    return np.stack([(points[:, 0] * 0.6 - 1.0) % 360.0, 60.0 + points[:, 1] / 3.0], axis=1)


SKIES: dict[str, StarPicture] = {
    "as they are": STARS,
    "within edges": STARS._replace(edges=WIDE, centre=(1.0, -1.0), in_file=True, epoch="J2000"),
    "over a photograph, y down": STARS._replace(
        edges=(-20.0, 20.0, 15.0, -15.0), y_down=True, unit="px", point="ground point",
        photograph=Image.fromarray(PHOTOGRAPH.astype(np.uint8)), sky=sky_deg, epoch="ICRF axes",
    ),
    "the sky": STARS._replace(edges=WIDE, sky=sky_deg),
    "all fit": STARS._replace(residuals=0.1 * RESIDUALS, odd=(), left_out=(), y_down=True),
}  # fmt: skip


@pytest.mark.parametrize("name", SKIES)
def test_stars(name: str) -> None:
    size_in = (6.0, 5.0) if name == "the sky" else None
    assert_approved("\n".join(described(draw_star_residuals(SKIES[name], size_in))))


def test_errors_by_pair() -> None:
    errors = np.linspace(-1.0, 2.0, 32).reshape(2, 2, 8)
    panels = {"first": errors[0], "second": errors[1]}
    figure = draw_errors_by_pair(["a-b", "a-c"], [f"method {k}" for k in range(8)], panels)
    assert_approved("\n".join(described(figure)))
