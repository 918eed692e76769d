"""The epoch of a flight project in the files that have dates."""

from __future__ import annotations

from pathlib import Path

from tests.kit.command import vopd
from tests.kit.flight_project import TOML, write_project


def test_a_project_states_its_own_epoch(tmp_path: Path) -> None:
    """2 s after 11:58:42; the option has precedence."""
    project = write_project(tmp_path)
    aem, czml = (vopd("attitude", project, "--format", form).stdout for form in ("aem", "czml"))
    assert "START_TIME = 2026-05-01T11:58:44.000000" in aem
    assert '"epoch": "2026-05-01T11:58:42.000000Z"' in czml
    given = ("--epoch", "2020-01-01T00:00:00Z")
    aem = vopd("attitude", project, "--format", "aem", *given).stdout
    assert "START_TIME = 2020-01-01T00:00:02.000000" in aem
    assert "zero is 2020-01-01T00:00:00.000000Z" in aem and "2026-05-01T11" not in aem


def test_projects_without_one_epoch_have_no_dates(tmp_path: Path) -> None:
    dated = write_project(tmp_path / "dated")
    toml = TOML.replace("epoch = 2026-05-01T11:58:42Z\n", "")
    undated = write_project(tmp_path / "undated", toml)
    ran = vopd("attitude", undated, "--format", "aem")
    assert ran.status == 1 and "give [flight] epoch in the project, or --epoch" in ran.stderr
    ran = vopd("attitude", dated, undated, "--format", "czml")
    assert ran.status == 1 and "the sources do not have one epoch" in ran.stderr
    ran = vopd("attitude", dated, undated)
    assert ran.status == 0 and "zero is each source's own epoch" in ran.stdout
