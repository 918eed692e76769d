"""Inputs and command lines that showed an error, and their neighbours, through the judge.

`inputs/` has damaged decks (.dat), star files (.csv, .txt), listings (.lst) and folders
of flights; `commands.txt` has command lines. README.md says what each showed.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, DECKS, ROOT, vopd
from tests.kit.flight_project import write_project
from tests.kit.judge import Command, deck_commands, flight_commands, judge, judge_all, star_commands

HERE = Path(__file__).parent
INPUTS = sorted((HERE / "inputs").iterdir())
LINES = [
    line
    for line in (HERE / "commands.txt").read_text(encoding="utf-8").splitlines()
    if line and not line.startswith("#")
]


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def commands_for(name: str) -> list[Command]:
    """What an input is put through, by its suffix."""
    if name.startswith("flight_"):
        return flight_commands("flight.toml")
    if name.endswith(".dat"):
        report = [["report", name, "-o", "report.html"]] if "_of_1e" in name else []
        return [*deck_commands(name), *report]  # a report takes as long as all others
    if name.endswith(".lst"):
        return [["diff", name, name], ["diff", "--format", "json", name, name, "-o", "differences"]]
    return [*star_commands(name)]


@pytest.mark.usefixtures("saved_empty", "solved_once")
@pytest.mark.parametrize("path", INPUTS, ids=lambda path: path.name)
def test_inputs(path: Path, place: Path) -> None:
    if path.is_dir():
        shutil.copytree(path, place, dirs_exist_ok=True)
    else:
        shutil.copy(path, place / path.name)
    assert judge_all(commands_for(path.name)) == []


@pytest.mark.parametrize("initial", ["deck", "closed-form"])
@pytest.mark.parametrize(
    "path", [one for one in INPUTS if one.suffix == ".dat"], ids=lambda path: path.name
)
def test_a_deck_costs_no_other(path: Path, initial: str) -> None:
    """A good deck that is solved together with a bad one, before or after it, is as alone."""
    good = DECKS / "appendix_h" / "case1.dat"
    alone = vopd("run", good, "--initial", initial).output
    assert vopd("run", path, good, "--initial", initial).output.endswith(alone)
    assert vopd("run", good, path, "--initial", initial).output.startswith(alone)


@pytest.mark.parametrize("line", LINES)
def test_commands(line: str, place: Path) -> None:
    for source in (DECKS / "appendix_h" / "case1.dat", DECKS / "stars" / "table_6_3.csv"):
        shutil.copy(source, place)
    assert judge(shlex.split(line)).failures == []


def test_the_judge_sees_what_is_wrong(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An exception, a warning, a status, a file left behind, a changed input, and a half file."""
    import warnings

    from vopd.cli import console as boundary

    shutil.copy(DECKS / "appendix_h" / "case1.dat", place / "deck.dat")
    (place / "other").write_text("input")

    def bad(command: object) -> int:
        warnings.warn("nothing", RuntimeWarning, stacklevel=1)
        (place / ".vopd-1").write_text("half")
        (place / "other").write_text("changed")
        return 7

    assert judge(["run", "deck.dat"]).failures == []
    with monkeypatch.context() as patch:
        patch.setattr("vopd.cli.at_the_boundary", bad)
        failures = "\n".join(judge(["run", "deck.dat"]).failures)
    for sign in ("RuntimeWarning", "status 7", "left behind: a temporary file", "changed: other"):
        assert sign in failures

    def fail(command: object) -> int:
        raise ZeroDivisionError("none")

    monkeypatch.setattr("vopd.cli.at_the_boundary", fail)
    assert "ZeroDivisionError" in judge(["run", "deck.dat"]).failures[0]
    assert boundary.at_the_boundary is not fail


def test_what_a_failure_says_may_be_in_the_output(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the same text stood in it before."""
    (place / "flight.toml").touch()
    for _ in range(2):
        assert judge(["check", "flight.toml", "-o", "out"]).failures == []
    monkeypatch.setattr("vopd.cli.at_the_boundary", lambda _: 1)
    assert judge(["check", "flight.toml", "-o", "out"]).failures == ["check: fails without a word"]


def test_the_judge_compares_check_with_run(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (place / "deck.dat").write_bytes(b"no deck\n")
    commands = [["check", "deck.dat"], ["run", "deck.dat"]]
    assert judge_all(commands) == []
    monkeypatch.setattr("vopd.cli.check.check_deck", lambda *_, **__: [])
    assert judge_all(commands)[0].startswith("run fails unforeseen: deck.dat: card 1")


@pytest.mark.parametrize("megabytes", [150, 180, 240])
def test_a_small_address_space_is_refused_at_once(megabytes: int) -> None:
    """OpenBLAS tried without end to get memory while scipy was loaded; only KILL ended it."""
    resource = pytest.importorskip("resource", reason="no limits of processes here")
    if sys.platform != "linux":
        pytest.skip("the address space is limited on Linux alone")
    limit = megabytes * 1_000_000

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    found = subprocess.run(
        [sys.executable, "-m", "vopd", "check", "flight.toml"],
        capture_output=True, text=True, timeout=60, preexec_fn=limited, check=False,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert found.returncode == 1 and not found.stdout
    assert_approved(found.stderr)


OF_NO_TEXT = os.fsdecode(b"caf\xe9")


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are bytes there alone")
@pytest.mark.parametrize(
    ("command", "status"),
    [
        (f"stars solve {OF_NO_TEXT}.csv --focal 76", 0),
        (f"stars solve {OF_NO_TEXT}.csv b.csv --focal 76 --format csv", 0),
        (f"stars solve {OF_NO_TEXT}.csv b.csv --focal 76 --format jsonl", 0),
        (f"new a --picks {OF_NO_TEXT}.picks", 1),
        (f"adjust {OF_NO_TEXT}/flight.toml --free focal -o a", 1),
        (f"attitude {OF_NO_TEXT}/flight.toml", 0),
        (f"run {OF_NO_TEXT}.dat", 0),
    ],
    ids=range(7),
)
def test_names_of_files_that_are_not_utf_8(
    command: str, status: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are read and written with escapes; a project, which is UTF-8, cannot have them."""
    monkeypatch.chdir(tmp_path)
    for name in (f"{OF_NO_TEXT}.csv", "b.csv"):
        shutil.copy(DECKS / "stars" / "orion.csv", name)
    shutil.copy(CASE_1, f"{OF_NO_TEXT}.dat")
    write_project(Path(OF_NO_TEXT))
    shutil.copy(Path(OF_NO_TEXT, "picks.csv"), f"{OF_NO_TEXT}.picks")
    ran = vopd(*command.split())
    assert (ran.status, "Traceback" in ran.stderr) == (status, False)
    if status:
        assert_approved(ran.stderr)
        assert not Path("a").exists()
    elif command.startswith("stars"):
        assert r"caf\udce9.csv" in ran.stdout
