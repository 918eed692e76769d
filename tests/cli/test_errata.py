"""`vopd errata` and the options that correct a run."""

from __future__ import annotations

import json
from pathlib import Path

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, vopd
from vopd.errata import VOPD_ERRATA


def test_lists_every_erratum_with_all_its_parts() -> None:
    ran = vopd("errata")
    lines = ran.stdout.splitlines()
    assert [line for line in lines if not line.startswith(" ") and line] == [
        "latitude-series", "first-landmark", "restart", "earth",
        "sin-6phi", "feet-per-km", "eight-digits", "standard-deviation",
    ]  # fmt: skip
    for part in ("where", "original", "fix", "evidence", "effect"):
        assert sum(line.startswith(f"  {part:10}") for line in lines) == len(VOPD_ERRATA) == 8
    assert max(map(len, lines)) <= 80


def test_json_and_choice_and_program() -> None:
    (row,) = json.loads(vopd("errata", "restart", "--format", "json").stdout)
    assert row["name"] == "restart" and row["program"] == "vopd"
    assert list(row)[2:] == ["where", "original", "fix", "evidence", "effect"]
    rae = json.loads(vopd("errata", "--program", "rae", "--format", "json").stdout)
    assert {row["program"] for row in rae} == {"rae"}


def test_output_to_a_file(tmp_path: Path) -> None:
    ran = vopd("errata", "earth", "-o", tmp_path / "earth.txt")
    assert ran[:3] == (0, "", "")
    assert (tmp_path / "earth.txt").read_text() == vopd("errata", "earth").stdout


def test_unknown_erratum() -> None:
    ran = vopd("errata", "nothing")
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr)
    assert_approved(vopd("errata", "restrat").stderr)
    other = vopd("errata", "--program", "rae", "restart")
    assert other.status == 2
    assert_approved(other.stderr)


def test_run_with_fixes_says_so_and_refuses_unknown_ones() -> None:
    plain = vopd("run", CASE_1)
    fixed = vopd("run", CASE_1, "--fix", "earth", "--fix", "restart", "--ellipsoid", "clarke1866")
    listed = "restart, earth (Clarke 1866)"
    assert_approved(fixed.stderr, parts=[listed])
    assert f"\n CORRECTED RUN, NOT THE ORIGINAL: {listed}\n" in fixed.stdout
    assert "CORRECTED" not in plain.stdout + plain.stderr
    unknown = vopd("run", CASE_1, "--fix", "nothing")
    assert unknown.status == 2
    assert_approved(unknown.stderr)
    alone = vopd("run", CASE_1, "--ellipsoid", "wgs84")
    assert alone.status == 2 and "--fix earth" in alone.stderr
