"""Positions of the camera solved with the attitude: values, deviations, needs and errors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import InputError
from vopd.stellar.field import Failure
from vopd.stellar.files import photograph as solved_resection
from vopd.stellar.files.images import CentredImages, ReadingErrors
from vopd.stellar.files.photograph import SolvedResection, solve_resection
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.resection import Resection

COUNT = 8
IMAGE = np.random.default_rng(2).uniform(-20.0, 20.0, (COUNT, 2))
EVERYONE = np.arange(COUNT)


def star_file(count: int = COUNT, kind: str = "ra_deg,dec_deg") -> StarFile:
    lines = tuple(range(2, 2 + count))
    points = np.column_stack([100.0 * IMAGE, 5.0 * IMAGE[:, 0]])[:count]
    return StarFile("a.csv", lines, ("",) * count, IMAGE[:count], "mm", kind, points)


GROUND = "x_m,y_m,z_m"
POSITION = np.array([10.0, 20.0, 7600.0])


def position(**more: Any) -> Resection:
    given: dict[str, Any] = {
        "failure": Failure.NONE, "matrix": np.eye(3), "position": POSITION, "iterations": 7,
        "residuals": np.tile([0.3, -0.4], (COUNT, 1)),
        "covariance": np.diag([1e-6, 4e-6, 9e-6, 16.0, 25.0, 36.0]),
    } | more  # fmt: skip
    return Resection(**given)


def resect(
    monkeypatch: pytest.MonkeyPatch, found: Resection, errors: ReadingErrors | None = None,
    sigma: float | None = None, file: StarFile | None = None,
) -> tuple[SolvedResection, list[Any]]:  # fmt: skip
    given: list[Any] = []
    monkeypatch.setattr(
        solved_resection, "resection", lambda *arguments: given.extend(arguments) or found
    )
    ground = file or star_file(kind=GROUND)
    images = CentredImages(IMAGE[: len(ground.lines)], 76.0)
    return solve_resection(ground, images, errors or ReadingErrors(), sigma), given


@pytest.mark.parametrize("stated", [None, 0.25])
@pytest.mark.parametrize("by_sigma", [False, True])
def test_a_position(monkeypatch: pytest.MonkeyPatch, stated: float | None, by_sigma: bool) -> None:
    """Residuals of .5 in sixteen coordinates less six; with sigmas of 2 they count a quarter."""
    errors = ReadingErrors(np.tile(4.0 * np.eye(2), (COUNT, 1, 1)) if by_sigma else None)
    found, given = resect(monkeypatch, position(), errors, stated)
    one = found.solved
    assert given[0].shape == (COUNT, 3) and given[1] is not None and given[2] == 76.0
    assert (given[3] is not None) == by_sigma and (found.stars.errors is not None) == by_sigma
    size = stated or (COUNT * 0.25 / (4.0 if by_sigma else 1.0) / 10.0) ** 0.5
    assert (one.method, one.stars, one.iterations) == ("resection", tuple(range(1, 9)), 7)
    assert one.converged and one.camera_m == [10.0, 20.0, 7600.0]
    assert one.camera_sigma_m is not None and one.rotation_sigma_arcsec is not None
    assert_close("rae element", one.camera_sigma_m, np.array([4.0, 5.0, 6.0]) * size)
    turns = np.degrees(np.array([1e-3, 2e-3, 3e-3]) * size) * 3600.0
    assert_close("rae angle", one.rotation_sigma_arcsec, turns)
    assert_close("rae element", one.reading_sigma, size)  # type: ignore[arg-type]
    assert one.reading_freedom == (10 if stated is None else None)
    away = star_file(kind=GROUND).positions - POSITION
    assert_close(
        "rae element", found.stars.directions, away / np.linalg.norm(away, axis=1)[:, None]
    )
    assert found.findings == []


@pytest.mark.parametrize("stated", [None, 0.25])
def test_what_the_readings_do_not_determine(
    monkeypatch: pytest.MonkeyPatch, stated: float | None
) -> None:
    """An attitude known to 14 degrees is refused, however the reading sigma is known."""
    found, _ = resect(monkeypatch, position(covariance=np.eye(6)), sigma=stated)
    assert found.solved.failure == Failure.TOO_UNCERTAIN
    for degrees, failure in ((2.99, Failure.NONE), (3.01, Failure.TOO_UNCERTAIN)):
        spread = np.eye(6) * np.radians(degrees) ** 2
        found, _ = resect(monkeypatch, position(covariance=spread), sigma=1.0)
        assert found.solved.failure == failure


def test_another_position_that_fits_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    found, _ = resect(monkeypatch, position(second=np.array([1.04, -2.06, 1234.56])))
    (said,) = found.findings
    assert (said.kind, said.finding.severity) == ("resection", "warning")
    assert str(said.finding) == (
        "a.csv: resection: the points fit as well from 1.0, -2.1, 1234.6: give more points, or "
        "--camera"
    )


REFUSED: list[tuple[StarFile, dict[str, Any], str]] = [
    (star_file(), {}, "--resection is for ground points; the file has ra_deg,dec_deg"),
    (star_file(kind="u,v,w"), {}, "--resection is for ground points; the file has u,v,w"),
    (star_file(count=3, kind=GROUND), {}, "--resection takes 4 points at least, the file has 3"),
    (star_file(kind=GROUND), {"failure": Failure.SINGULAR}, "resection: the stars leave the "
     "attitude undetermined, or every weight is zero"),
    (star_file(kind=GROUND), {"failure": Failure.NO_CONVERGENCE}, "resection: no convergence in 50 "
     "corrections"),
]  # fmt: skip


@pytest.mark.parametrize(("file", "changes", "said"), REFUSED)
def test_positions_that_are_not_found(
    monkeypatch: pytest.MonkeyPatch, file: StarFile, changes: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        resect(monkeypatch, position(**changes), file=file)
    assert str(caught.value) == f"a.csv: {said}"


def test_four_points_are_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    found = position(residuals=np.full((4, 2), 0.1))
    four, _ = resect(monkeypatch, found, file=star_file(count=4, kind=GROUND))
    assert four.solved.reading_freedom == 2
