"""`vopd errata` and the options that correct a run."""

from __future__ import annotations

import json
from pathlib import Path

from click.testing import CliRunner

from vopd.cli import cli
from vopd.errata import VOPD_ERRATA

CASE_1 = str(Path(__file__).parents[2] / "decks" / "appendix_h" / "case1.dat")


def test_lists_every_slip_with_all_its_parts() -> None:
    result = CliRunner().invoke(cli, ["errata"])
    for erratum in VOPD_ERRATA:
        assert f"\n{erratum.name}\n" in "\n" + result.stdout
    assert result.stdout.count("  evidence  ") == len(VOPD_ERRATA) >= 8
    assert max(map(len, result.stdout.splitlines())) <= 80


def test_json_and_choice_and_program() -> None:
    one = CliRunner().invoke(cli, ["errata", "restart", "--format", "json"])
    (row,) = json.loads(one.stdout)
    assert row["name"] == "restart" and row["program"] == "vopd"
    rae = CliRunner().invoke(cli, ["errata", "--program", "rae", "--format", "json"])
    assert {row["program"] for row in json.loads(rae.stdout)} == {"rae"}


def test_unknown_slip() -> None:
    result = CliRunner().invoke(cli, ["errata", "nothing"])
    assert "no slip is called 'nothing'" in str(result.exception)


def test_run_with_fixes_says_so_and_refuses_what_is_no_fix() -> None:
    runner = CliRunner()
    plain = runner.invoke(cli, ["run", CASE_1])
    fixed = runner.invoke(
        cli, ["run", CASE_1, "--fix", "earth", "--fix", "restart", "--ellipsoid", "clarke1866"]
    )
    told = "restart, earth (Clarke 1866)"
    assert fixed.stderr.startswith(f"corrected run, not the original: {told}")
    assert f"\n CORRECTED RUN, NOT THE ORIGINAL: {told}\n" in fixed.stdout
    assert "CORRECTED" not in plain.stdout + plain.stderr
    unknown = runner.invoke(cli, ["run", CASE_1, "--fix", "nothing"])
    assert unknown.exit_code == 2 and "no fix is called 'nothing'" in unknown.stderr
    alone = runner.invoke(cli, ["run", CASE_1, "--ellipsoid", "wgs84"])
    assert alone.exit_code == 2 and "--fix earth" in alone.stderr
