"""Every command and every Python example of the documentation, run; what it shows, compared.

In a ```console block a line `$ ...` is a command, and what follows is its
output; a line `...` stands for any lines. ```python blocks of one page go on
where the one before ended, as in a notebook; a ```text block that follows is
what they print. All run beside a copy of the decks, not in the checkout.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
FAILING = ("diff",)  # a comparison that is shown because it finds something


def blocks(page: Path) -> list[tuple[str, str]]:
    return FENCE.findall(page.read_text(encoding="utf-8"))


def commands(block: str) -> list[tuple[str, list[str]]]:
    """Each command of a console block with the lines shown after it."""
    found: list[tuple[str, list[str]]] = []
    for line in block.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif found:
            found[-1][1].append(line.rstrip())
    return found


def agrees(shown: list[str], printed: list[str]) -> bool:
    """Whether the shown lines are the printed ones, `...` standing for any number."""
    if not shown:
        return not printed
    if shown[0] == "...":
        return any(agrees(shown[1:], printed[k:]) for k in range(len(printed) + 1))
    return bool(printed) and shown[0] == printed[0] and agrees(shown[1:], printed[1:])


@pytest.fixture
def place(tmp_path: Path) -> Path:
    for folder in ("decks", "golden_outputs", "examples"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    (tmp_path / "bin").mkdir()
    script = tmp_path / "bin" / "vopd"
    script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m vopd "$@"\n')
    script.chmod(0o755)
    return tmp_path


def environment(place: Path) -> dict[str, str]:
    path = os.pathsep.join(
        [str(place / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]]
    )
    return os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)}


def python(before: str, block: str, place: Path) -> str:
    """What a block prints after those before it."""
    mark = "-- what follows is printed by the last block --"
    program = f"{before}\nprint({mark!r})\n{block}"
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=place, env=environment(place),
        capture_output=True, text=True,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    return run.stdout.split(mark + "\n")[1]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_shows_is_so(page: Path, place: Path) -> None:
    before = printed = ""
    for language, block in blocks(page):
        if language == "python":
            printed = python(before, block, place)
            before += block
        if language == "text" and printed:
            lines = [line.rstrip() for line in printed.splitlines()]
            assert agrees([line.rstrip() for line in block.splitlines()], lines), printed
            printed = ""
        if language == "console":
            for command, shown in commands(block):
                run = subprocess.run(
                    ["bash", "-c", command], cwd=place, env=environment(place), text=True,
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                )  # fmt: skip
                expected = (0, 1) if any(f"vopd {word}" in command for word in FAILING) else (0,)
                assert run.returncode in expected, f"{command}\n{run.stdout}"
                lines = [line.rstrip() for line in run.stdout.splitlines()]
                assert not shown or agrees(shown, lines), f"{command}\n{run.stdout}"


def test_the_pages_show_every_command() -> None:
    from vopd.cli import COMMANDS

    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    for command in COMMANDS:
        assert f"$ vopd {command}" in text, command


def test_links_between_pages_lead_somewhere() -> None:
    for page in PAGES:
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert (page.parent / link).exists(), f"{page.name}: {link}"
