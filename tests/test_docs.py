"""The documentation: its commands and Python examples, run; errata and names as the code has them.

In a ```console block a line `$ ...` is a command, and what follows is its
output; a line `...` stands for any lines. ```python blocks of one page go on
where the one before ended, as in a notebook; a ```text block that follows is
what they print. All run beside a copy of the decks, not in the checkout. `vopd`
is run in this process where a line begins with it, also if what it prints goes
into a pipe, which spares its start; tests/cli/test_process.py has what only a
process can show.
"""

from __future__ import annotations

import contextlib
import importlib
import inspect
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.kit.appendix_a import solve_input
from tests.kit.command import vopd
from tests.kit.jobs import case
from vopd.attitude.mean import MeanAttitude
from vopd.attitude.rate import Turn, TurningRate
from vopd.attitude.sigmas import Sigmas
from vopd.findings import Finding
from vopd.flight.adjust.adjustment import Adjustment
from vopd.flight.direction import Direction
from vopd.job import Camera, Clock, Deck, Ignored, Job, Landmarks, Trajectory, Wind
from vopd.program.vopd import run
from vopd.results import Results

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
SHELL = re.compile(r"[|<>&;$*?`~(){}\\#]")  # what a shell does to a line, beside splitting it
STATUS = "; echo $?"
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


class Notebook:
    """The blocks of a page, which share their names, run in this process."""

    def __init__(self, place: Path) -> None:
        self._place = place
        self._names: dict[str, object] = {"__name__": "__main__"}

    def run(self, block: str) -> str:
        """What a block prints, after those before it in the same names."""
        printed = io.StringIO()
        with (
            contextlib.chdir(self._place),
            contextlib.redirect_stdout(printed),
            contextlib.redirect_stderr(printed),
        ):
            exec(compile(block, "block", "exec"), self._names)
        return printed.getvalue()

    def end(self) -> None:
        """Forget all names, which closes the files that an example has left open."""
        self._names.clear()


@pytest.fixture
def notebook(place: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Notebook]:
    """A notebook whose blocks may start `vopd` as a command."""
    monkeypatch.setenv("COLUMNS", "80")
    for name, value in environment(place).items():
        monkeypatch.setenv(name, value)
    opened = Notebook(place)
    yield opened
    opened.end()


def run_command(command: str, place: Path) -> tuple[int, str]:
    """The exit status of a command line, and what a terminal shows of it."""
    command, asks_status = command.removesuffix(STATUS), command.endswith(STATUS)
    said, piped = "", None
    first, bar, rest = command.partition(" | ")
    while first.startswith("vopd ") and not SHELL.search(first):
        with contextlib.chdir(place):
            ran = vopd(*shlex.split(first)[1:], stdin=piped, terminal=not bar)
        if not bar:
            said += ran.terminal
            return (0, f"{said}{ran.status}\n") if asks_status else (ran.status, said)
        said, piped, command = said + ran.stderr, ran.output, rest
        first, bar, rest = command.partition(" | ")
    done = subprocess.run(
        ["bash", "-c", command + STATUS * asks_status], cwd=place, env=environment(place),
        input=piped, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    return done.returncode, said + done.stdout.decode()


@pytest.mark.usefixtures("saved_empty", "solved_once")
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_shows_is_so(page: Path, place: Path, notebook: Notebook) -> None:
    printed = ""
    for language, block in blocks(page):
        if language == "python":
            printed = notebook.run(block)
        if language == "text" and printed:
            lines = [line.rstrip() for line in printed.splitlines()]
            assert agrees([line.rstrip() for line in block.splitlines()], lines), printed
            printed = ""
        if language == "console":
            for command, shown in commands(block):
                status, seen = run_command(command, place)
                expected = (0, 1) if any(f"vopd {word}" in command for word in FAILING) else (0,)
                assert status in expected, f"{command}\n{seen}"
                lines = [line.rstrip() for line in seen.splitlines()]
                assert not shown or agrees(shown, lines), f"{command}\n{seen}"


def test_the_pages_show_every_command() -> None:
    from vopd.cli import COMMANDS
    from vopd.cli.help import page_of, pages

    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    for command in COMMANDS:
        assert f"$ vopd {command}" in text, command
    found = {command: page_of(command, pages()) for command in COMMANDS if command != "help"}
    assert {*found.values()} <= {*pages()}
    rows = [found[name] for name in ("attitude", "pick", "diff")]  # some of several links
    assert rows == ["attitude-files", "your-own-frames", "listing"]


def test_links_between_pages_lead_somewhere() -> None:
    for page in PAGES:
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert (page.parent / link).exists(), f"{page.name}: {link}"


def test_the_recipe_for_continuous_integration(place: Path) -> None:
    """Its last two lines pass with the listing they were given, and fail when a number moves."""
    recipes = [block for _, block in blocks(PAGES[0]) if "vopd diff golden.lst" in block]
    assert len(recipes) == 1
    install, *lines = recipes[0].splitlines()
    assert install == "pip install ." and len(lines) == 2
    shutil.copy(place / "decks" / "appendix_h" / "cases_1_2_3.dat", place / "deck.dat")
    assert run_command("vopd run deck.dat -o golden.lst", place)[0] == 0
    assert [run_command(line, place)[0] for line in lines] == [0, 0]
    golden = place / "golden.lst"
    golden.write_text(golden.read_text().replace("195.270", "195.280"))
    assert [run_command(line, place)[0] for line in lines] == [0, 1]


# docs/errata.md, and the names that last in docs/promises.md


@pytest.mark.parametrize("tool", ["errata_page", "limits", "public_names"])
def test_a_page_is_current(tool: str) -> None:
    path = ROOT / "tools" / f"{tool}.py"
    run = subprocess.run([sys.executable, path, "--check"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


PUBLIC = [Results, Adjustment, Sigmas, Finding, Job, Deck]
OTHERS = {
    MeanAttitude: "history.mean()",
    TurningRate: "history.rate()",
    Turn: "history.turn()",
    Direction: "FlightResult.direction()",
    **{
        one: f"Job.{one.__name__.lower()}"
        for one in (Camera, Trajectory, Wind, Clock, Landmarks, Ignored)
    },
}


@pytest.mark.parametrize("kind", [*PUBLIC, *OTHERS])
def test_help_says_what_each_attribute_is(kind: type) -> None:
    """In the text of the class, by its name, or in a text of its own."""
    promises = (ROOT / "docs" / "promises.md").read_text(encoding="utf-8")
    name = re.escape(OTHERS.get(kind, kind.__name__))
    (listed,) = re.findall(rf"^Attributes of `{name}`: ([^:]*)\.$", promises, re.M)
    text = inspect.getdoc(kind) or ""
    for one in CODE.findall(listed):
        own = inspect.getattr_static(kind, one, None)
        computed = isinstance(own, property) or inspect.isfunction(own)
        assert re.search(rf"^ +{one}: ", text, re.M) or (computed and own.__doc__), one


# docs/names.md


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
