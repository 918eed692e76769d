"""Which mistake is taken of several, which are tried alone, and which together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from vopd.stellar.files import mistakes as usual_mistakes
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import (
    MendedStars,
    UsualMistake,
    _best,
    _several_of_camera,
    one_mistake,
    two_mistakes,
)
from vopd.stellar.files.read import StarFile
from vopd.stellar.outlier_search import AttitudeFit

AXES = ImageAxes(focal_mm=50.0)
FILE = StarFile("a", (2,), ("",), np.zeros((1, 2)), "mm", "ra_deg,dec_deg", np.zeros((1, 2)))
FIT = AttitudeFit(1.0, 9, np.eye(3))


def sized(*sigmas: float, about: tuple[int, ...] = ()) -> list[UsualMistake | None]:
    """Mistakes a, b, c that leave these residuals; some are about a star."""
    return [
        UsualMistake("abc"[k], sigma, (1,) if k in about else ()) for k, sigma in enumerate(sigmas)
    ]


BEST = [
    (sized(3.0, 1.0, 2.0), "b"),
    (sized(1.0, 1.0, 1.0), "a"),
    (sized(1.004, 1.003, 1.0), "a"),  # to three digits all are 1.00
    (sized(1.006, 1.003, 1.0), "b"),
    (sized(1.0, 2.9, about=(0,)), "b"),  # one about all stars before one about some
    (sized(1.0, 3.1, about=(0,)), "a"),
    (sized(1.0, 2.9, 2.0, about=(0, 2)), "b"),
    (sized(2.0, 1.0, about=(0, 1)), "b"),
    ([None, *sized(2.0), None], "a"),
]


@pytest.mark.parametrize(("tried", "best"), BEST)
def test_the_best_of_several(tried: list[UsualMistake | None], best: str) -> None:
    found = _best(tried)
    assert found is not None and found.advice == best
    assert _best([None, None]) is None and _best([]) is None


def tries(monkeypatch: pytest.MonkeyPatch, sigmas: dict[str, float]) -> list[str]:
    """Let each trial leave these residuals, by its name; the names of what is tried."""
    seen: list[str] = []

    def trial(name: str, about: tuple[int, ...] = ()) -> UsualMistake | None:
        seen.append(name)
        return UsualMistake(name, sigmas[name], about) if name in sigmas else None

    def camera(
        field: str, free: tuple[str, ...], *given: Any, named: bool = True
    ) -> UsualMistake | None:
        assert [one is other for one, other in zip(given, (FIT, FILE, AXES), strict=True)] == [
            True
        ] * 3
        return trial(f"{field}{','.join(free)}{'' if named else '?'}")

    def images(file: Any, field: str, axes: Any) -> list[MendedStars]:
        return [MendedStars("mirror", f"{field}mirror ", moved=True)]  # type: ignore[arg-type]

    def directions(file: Any, field: str) -> list[MendedStars]:
        return [MendedStars("hours", f"{field}hours ")]  # type: ignore[arg-type]

    def coordinates(one: MendedStars, _: Any) -> UsualMistake | None:
        found = trial(f"{one.stars}")
        return found and found._replace(advice=one.advice)

    def wrong(field: str, outliers: Any, _: Any) -> UsualMistake | None:
        return trial(f"{field}stars {outliers}", (1,))

    for name, made in (
        ("by_camera", camera), ("mended_images", images), ("mended_directions", directions),
        ("by_coordinates", coordinates), ("by_wrong_stars", wrong),
        ("find_outliers", lambda field: "found"),
    ):  # fmt: skip
        monkeypatch.setattr(usual_mistakes, name, made)
    return seen


FIELD: Any = ""
GIVEN: Any = "given"


def test_what_is_tried_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = tries(monkeypatch, {})
    assert one_mistake(FILE, FIELD, FIT, GIVEN, AXES) is None
    assert seen == ["mirror ", "hours ", "focal", "centre", "k1", "stars given"]


ALONE: list[tuple[dict[str, float], str]] = [
    ({"mirror ": 1.0, "hours ": 1.0, "focal": 1.0}, "mirror"),
    ({"hours ": 1.0, "focal": 1.0}, "hours"),
    ({"focal": 2.0, "centre": 1.0, "k1": 1.5}, "centre"),
    ({"stars given": 1.0}, "stars given"),
    ({"stars given": 1.0, "k1": 2.5}, "k1"),
    ({"hours ": 1.0, "focal,k1": 0.1}, "hours"),  # several of a camera only beside one of it
    ({"focal": 1.0, "focal,k1": 0.34}, "focal"),  # its variance nine times smaller, or not
    ({"focal": 1.0, "focal,k1": 0.33}, "focal,k1"),
    ({"k1": 1.0, "focal,centre,k1": 0.01, "focal,centre": 0.02}, "focal,centre"),
]


@pytest.mark.parametrize(("sigmas", "best"), ALONE)
def test_one_mistake(monkeypatch: pytest.MonkeyPatch, sigmas: dict[str, float], best: str) -> None:
    tries(monkeypatch, sigmas)
    found = one_mistake(FILE, FIELD, FIT, GIVEN, AXES)
    assert found is not None and found.advice == best


SEVERAL: list[tuple[dict[str, float], str | None]] = [
    ({"focal,k1": 3.0, "focal,centre": 2.0, "focal,centre,k1": 1.0}, "focal,k1"),
    ({"focal,k1": 3.1, "focal,centre": 2.0, "focal,centre,k1": 1.0}, "focal,centre"),
    ({"focal,k1": 3.1, "focal,centre": 3.1, "focal,centre,k1": 1.0}, "focal,centre,k1"),
    ({"focal,k1": 4.0, "focal,centre": 1.0, "focal,centre,k1": 2.0}, "focal,centre"),
    ({}, None),
]


@pytest.mark.parametrize(("sigmas", "best"), SEVERAL)
def test_the_fewest_unknowns_of_a_camera(
    monkeypatch: pytest.MonkeyPatch, sigmas: dict[str, float], best: str | None
) -> None:
    tries(monkeypatch, sigmas)
    found = _several_of_camera(FIELD, FIT, FILE, AXES)
    assert (found and found.advice) == best


def test_what_is_tried_of_two_mistakes(monkeypatch: pytest.MonkeyPatch) -> None:
    """A principal point can be stated in the file's coordinates where the images are the file's."""
    seen = tries(monkeypatch, {})
    assert two_mistakes(FILE, FIELD, FIT, AXES) is None
    assert seen == [
        "focal,k1", "focal,centre", "focal,centre,k1", "mirror hours ",
        "mirror focal?", "mirror centre?", "mirror k1?", "mirror stars found",
        "hours focal", "hours centre", "hours k1", "hours stars found",
    ]  # fmt: skip


TWO = {
    "focal,k1": "focal,k1",
    "mirror hours ": "mirror, and hours",
    "mirror k1?": "mirror, and mirror k1?",
    "hours centre": "hours, and hours centre",
    "mirror stars found": "mirror, and mirror stars found",
    "hours stars found": "hours, and hours stars found",
}


@pytest.mark.parametrize("name", TWO)
def test_two_mistakes(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    tries(monkeypatch, {name: 1.0})
    found = two_mistakes(FILE, FIELD, FIT, AXES)
    assert found is not None and found.advice == TWO[name]
    assert found.stars == ((1,) if "stars" in name else ())
