"""Causes of errors that the sigmas of `vopd attitude` do not contain, on standard error."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, DECKS, ROOT, vopd
from tests.kit.flight_project import TOML, write_project

SIGMAS = ["position", "landmark", "focal", "time", "mount", "velocity", "wind"]
KEYS = {
    "position": "[track] or [position] sigma_m",
    "landmark": "[landmarks] sigma_m",
    "focal": "[uncertainty] focal_rel",
    "principal point": "[uncertainty] principal_px",
    "time": "[track] sigma_t_s",
}
START = "the sigmas do not include errors of: "


def named(source: object, *options: str) -> dict[str, str]:
    """The causes that are left out, and where each is to be stated."""
    ran = vopd("attitude", str(source), *options)
    assert ran.status == 0
    told = [line for line in ran.stderr.splitlines() if START in line]
    assert len(told) <= 1 and all(line.startswith(f"{source}: ") for line in told)
    items = told[0].partition(START)[2].split(", ") if told else []
    return {name: where.rstrip(")") for name, where in (one.split(" (") for one in items)}


def test_a_deck_names_the_options_that_are_not_given() -> None:
    assert named(CASE_1) == {name: f"--{name}-sigma" for name in SIGMAS}
    for name in SIGMAS:
        assert named(CASE_1, f"--{name}-sigma", ".01").keys() == set(SIGMAS) - {name}
    assert named(CASE_1, *(word for name in SIGMAS for word in (f"--{name}-sigma", ".01"))) == {}
    assert named(CASE_1, "--quiet") == {}


def test_a_project_names_its_keys(tmp_path: Path) -> None:
    options = {name: f"--{name}-sigma" for name in ("mount", "velocity", "wind")}
    assert_approved(named(ROOT / "examples" / "hill" / "flight.toml"))
    project = write_project(tmp_path)
    text = project.read_text().replace("[track]", "sigma_m = 0.1\n[track]\nsigma_m = 3.0")
    project.write_text(f"{text}\n[uncertainty]\nfocal_rel = 0.001\n")
    left = {name: KEYS[name] for name in ("principal point", "time")}
    assert named(project) == left | options


def test_what_cannot_change_the_angles_is_not_named(tmp_path: Path) -> None:
    """A camera that does not move has no error by time, and no angles of attack."""
    project = write_project(tmp_path)
    fixed = '[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\nheight = "ellipsoid"\n'
    project.write_text(TOML[: TOML.index("[track]")] + fixed)
    assert_approved(named(project))


def test_sources_that_are_alike_are_said_once() -> None:
    decks = sorted((DECKS / "appendix_h").glob("case*.dat"))[:3]
    ran = vopd("attitude", *decks)
    assert_approved(ran.stderr, parts=[decks[0]])
    assert ran.stderr.count(START) == 1


@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_the_table_is_the_same(form: str) -> None:
    quiet = vopd("attitude", CASE_1, "-q", "--format", form)
    assert vopd("attitude", CASE_1, "--format", form).output == quiet.output and not quiet.stderr
