"""docs/names.md: every name in its tables is one of the code."""

from __future__ import annotations

import importlib
import inspect
import re
from pathlib import Path

import pytest

from tests.kit.appendix_a import solve_input
from tests.kit.jobs import case
from vopd.program.vopd import run

PAGE = (Path(__file__).parents[1] / "docs" / "names.md").read_text(encoding="utf-8")
CODE = re.compile(r"`([^`]+)`")


def rows(section: str) -> list[list[str]]:
    """The rows of a section's table, without its heading."""
    text = PAGE.split(f"\n## {section}\n")[1].split("\n## ")[0]
    lines = [line for line in text.splitlines() if line.startswith("| ")][1:]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]


def found(path: str) -> object:
    """What `module.name` or `module.Class.field` in `vopd.program` stands for."""
    module, *names = path.split(".")
    thing: object = importlib.import_module(f"vopd.program.{module}")
    for name in names:
        thing = getattr(thing, name)
    return thing


@pytest.mark.parametrize("section", ["Input", "Results"])
def test_every_expression_can_be_evaluated(section: str) -> None:
    """And has the shape that is said, on case 4: two frames and one that is ignored."""
    results = run(case(4))
    known = {"job": results.job, "results": results, "len": len}
    frames, landmarks = results.used.shape
    fixed = {"F": frames, "L": landmarks, "NT": len(results.job.ignored.everywhere)}
    table = rows(section)
    assert len(table) > 20
    for _, names, shape, _ in table:
        first, *others = CODE.findall(names)
        for name in (first, *(re.sub(r"\.\w+$", other, first) for other in others)):
            value = eval(name, dict(known))
            if not shape.startswith("("):
                continue
            axes = [axis.strip() for axis in shape.strip("()").split(",") if axis.strip()]
            assert len(value.shape) == len(axes), name
            for size, axis in zip(value.shape, axes, strict=True):
                wanted = int(axis) if axis.isdigit() else fixed.get(axis, size)
                assert size == wanted, f"{name}: {shape}"


def test_every_name_of_the_computation_is_in_the_code() -> None:
    table = rows("The computation")
    assert len(table) > 40
    for fortran, here, *_ in table:
        names, _, place = here.partition(" in ")
        if not place:
            for path in CODE.findall(names):
                found(path)
            continue
        source = inspect.getsource(found(CODE.findall(place)[0]))  # type: ignore[arg-type]
        for name in CODE.findall(names):
            assert re.search(rf"\b{name}\b", source), f"{fortran}: {name} is not in {place}"


def test_the_named_factor_is_that_of_the_lens() -> None:
    """A name that was wrong once: DISTR is 1 - DELR/RR, and the film coordinates times it."""
    r = run(case(1))
    away = r.point_mm[0, 0] - r.centre_mm[0]
    wanted = away * (1.0 - r.distortion_mm[0, 0] / r.radius_mm[0, 0])
    assert solve_input([case(1)]).point[0].tolist() == wanted.tolist()
