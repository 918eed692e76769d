"""Stars that are enlarged, turned, moved along the equator or in another order: the same answer."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.command import DECKS, vopd
from tests.tolerances import within

ORION = DECKS / "stars" / "orion.csv"
Row = dict[str, str]
Answer = tuple[list[dict[str, Any]], list[str]]


@cache
def stars(wrong: bool) -> tuple[Row, ...]:
    """The eight stars of Orion in decimals; the sixth 9' away from its image, or not."""
    lines = [line for line in ORION.read_text(encoding="utf-8").splitlines() if line[0] != "#"]
    found = []
    for row in csv.DictReader(lines):
        hours = [float(one) for one in re.findall(r"[\d.]+", row["ra_deg"])]
        parts = [float(one) for one in re.findall(r"[\d.]+", row["dec_deg"])]
        south = row["dec_deg"].startswith("-")
        degrees = sum(one / 60.0**k for k, one in enumerate(parts)) * (-1.0 if south else 1.0)
        place = {"ra_deg": 15.0 * sum(one / 60.0**k for k, one in enumerate(hours))}
        found.append(row | {key: repr(one) for key, one in (place | {"dec_deg": degrees}).items()})
    if wrong:
        found[5]["x_mm"] = repr(float(found[5]["x_mm"]) + 0.2)
    return tuple(found)


def solved(folder: Path, rows: list[Row], focal: float, options: tuple[str, ...]) -> Answer:
    """The solutions, and what is said, without numbers.

    Of single-rotation neither: its axis is another one in other axes, and so is its error.
    """
    file = folder / "stars.csv"
    with file.open("w", encoding="utf-8", newline="") as text:
        writer = csv.DictWriter(text, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    ran = vopd("stars", "solve", file, "--focal", str(focal), "--format", "json", *options)
    lines = [line for line in ran.stderr.splitlines() if "single-rotation" not in line]
    said = [re.sub(r"[-+]?\d[\d.e-]*", "#", line.replace(str(file), "")) for line in lines]
    assert ran.status in (0, 3), ran.stderr
    found = [one for one in json.loads(ran.stdout) if one["method"] != "single-rotation"]
    return found, sorted(said)


def with_numbers(row: Row, **numbers: float) -> Row:
    return row | {name: repr(value) for name, value in numbers.items()}


def enlarged(row: Row) -> Row:
    return with_numbers(row, x_mm=2.0 * float(row["x_mm"]), y_mm=2.0 * float(row["y_mm"]))


def quarter(row: Row) -> Row:
    """The camera turned about its axis."""
    return with_numbers(row, x_mm=-float(row["y_mm"]), y_mm=float(row["x_mm"]))


def along(row: Row) -> Row:
    return with_numbers(row, ra_deg=float(row["ra_deg"]) + 40.0)


SAME = ("alpha_deg", "delta_deg", "sigma_alpha_deg", "sigma_delta_deg", "swing_deg",
        "sigma_swing_deg", "reading_freedom", "covariance_factor_95", "boresight_95_arcsec",
        "converged", "method", "stars", "orthogonality_defect")  # fmt: skip
SIZES = ("rms_mm", "reading_sigma_mm", "residuals_mm")
OPTIONS: dict[str, tuple[bool, tuple[str, ...]]] = {
    "all methods": (False, ("--method", "all")),
    "as solved": (False, ("--method", "all", "--rotation", "as-solved", "--initial", "two-star")),
    "all pairs": (False, ("--method", "svd", "--all-pairs")),
    "robust": (True, ("--weights", "robust")),
    "reject": (True, ("--reject",)),
    "by pairs": (True, ("--edit-by-pairs", "--method", "svd")),
    "focal": (False, ("--free", "focal")),
}


# the elements of what is no rotation are others in other axes
CASES = [(name, enlarged) for name in OPTIONS]
CASES += [(name, one) for one in (quarter, along) for name in OPTIONS if name != "as solved"]


@pytest.mark.parametrize(("name", "changed"), CASES)
def test_the_answer_is_the_same(name: str, changed: Callable[[Row], Row], tmp_path: Path) -> None:
    wrong, options = OPTIONS[name]
    rows = [*stars(wrong)]
    times = 2.0 if changed is enlarged else 1.0
    first, said = solved(tmp_path, rows, 76.0, options)
    again, told = solved(tmp_path, [changed(row) for row in rows], 76.0 * times, options)
    assert len(first) == len(again) and told == said
    shift = {along: {"alpha_deg": 40.0}, quarter: {"swing_deg": -90.0}}.get(changed, {})
    for one, other in zip(first, again, strict=True):
        assert [*one] == [*other]
        for key in {*SAME, *SIZES} & {*one}:
            value, found = one[key], other[key]
            if isinstance(value, bool | str) or key == "stars":
                assert found == value, key
                continue
            expected = np.array(value, float) * (times if key in SIZES else 1.0)
            if changed is quarter and key == "residuals_mm":
                expected = np.column_stack([-expected[:, 1], expected[:, 0]])
            away = np.array(found, float) - expected - shift.get(key, 0.0)
            if key in ("alpha_deg", "swing_deg"):
                away = (away + 180.0) % 360.0 - 180.0
            assert np.abs(away).max(initial=0.0) < within("symmetric stars"), (key, value, found)
