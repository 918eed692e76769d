"""Shell completion: the scripts that shells load, and what they are offered."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kit.command import ROOT, vopd
from vopd.cli import COMMANDS


def offered(monkeypatch: pytest.MonkeyPatch, line: str) -> list[str]:
    """What a shell is offered for the last word of a line, as kind and text."""
    words = line.split(" ")
    monkeypatch.setenv("_VOPD_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
    ran = vopd()
    assert (ran.status, ran.stderr) == (0, "")
    return ran.stdout.split()


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("vopd r", ["plain,run", "plain,report"]),
        ("vopd ", [f"plain,{command}" for command in COMMANDS]),
        ("vopd --v", ["plain,--version"]),
        ("vopd errata --format ", ["plain,text", "plain,json"]),
        ("vopd errata --form", ["plain,--format"]),
        ("vopd stars so", ["plain,solve"]),
        ("vopd diff deck", ["file,deck"]),
        ("vopd diff -o out", ["file,out"]),
        ("vopd run --fix earth deck", ["file,deck"]),
        ("vopd report deck.dat -o ", ["file,"]),
        ("vopd stars solve --focal 76 st", ["file,st"]),
        ("vopd rum deck", []),
        ("vopd diff --tolerances --und", ["plain,--undetermined"]),
    ],
)
def test_what_is_offered(monkeypatch: pytest.MonkeyPatch, line: str, expected: list[str]) -> None:
    assert offered(monkeypatch, line) == expected


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_accepts_its_script(shell: str, tmp_path: Path) -> None:
    environment = os.environ | {"_VOPD_COMPLETE": f"{shell}_source", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "vopd"]
    made = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (made.returncode, made.stderr) == (0, "")
    assert "_VOPD_COMPLETE" in made.stdout
    if shutil.which(shell):
        script = tmp_path / "script"
        script.write_text(made.stdout, encoding="utf-8")
        subprocess.run([shell, "-n", script], check=True)
