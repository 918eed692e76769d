"""Runs command lines on any input and names what must never happen, whatever the input.

A failure is an exception that the error boundary lets through, a Python warning, an
exit status other than 0 to 3, a file left or changed that is no output, an output
that differs from what goes to standard output, or a disagreement: `check` finds no
error where `run` of a deck or `attitude` of a flight fails, or the reverse.
"""

from __future__ import annotations

import traceback
import warnings
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from tests.kit.command import Ran, vopd

OUTPUTS = ("-o", "--output", "--tape10", "--truth", "--numbers", "--figure")
TO_FILES = ("-o", "listing", "--tape10", "tape")
STATUSES = (0, 1, 2, 3)
FLIGHT_TABLE = ("--format", "csv", "-o", "table")
NO_ATTITUDE = "no frame has an attitude"
OLD = b"what was there before\n"
Command = Sequence[str]


class Verdict(NamedTuple):
    """What a command answered, None where it did not, its output files, and its failures."""

    ran: Ran | None
    written: dict[str, bytes]
    failures: list[str]


def judge_all(commands: Iterable[Command]) -> list[str]:
    """The failures of some commands, run one after the other in the current folder."""
    verdicts = {tuple(command): judge(command) for command in commands}
    failures = [failure for verdict in verdicts.values() for failure in verdict.failures]
    for command, verdict in verdicts.items():
        checked = verdicts.get(("check", *command[1:2]))
        solves = command[0] == "run" and len(command) == 2 and not command[1].endswith(".toml")
        solves = solves or (command[0] == "attitude" and command[2:] == FLIGHT_TABLE)
        if solves and checked is not None and checked.ran and verdict.ran:
            failures += _disagreement(checked.ran, verdict.ran, command)
        printed = verdicts.get(command[:2])
        to_files = command[2:] == TO_FILES and printed is not None and printed.ran is not None
        if to_files and verdict.written["listing"] != (printed.ran.output or OLD):
            failures.append(f"{command[0]}: its file is not what it prints")
    return failures


def _disagreement(checked: Ran, ran: Ran, command: Command) -> list[str]:
    """Whether `check` and the command differ on whether a deck or flight can be solved.

    A deck without an attitude is no error: the 1974 program prints it.
    """
    printed = NO_ATTITUDE in ran.stderr and not command[1].endswith(".toml")
    if printed or (checked.status == 1) == (ran.status == 1):
        return []
    said = (checked.stdout if checked.status == 1 else ran.stderr).splitlines()
    stops = f"{command[0]} fails unforeseen"
    if checked.status == 1:
        stops = f"check finds an error and {command[0]} none"
    errors = [line for line in said if not line.startswith(("warning:", " "))]
    return [f"{stops}: {errors[0] if errors else 'no message'}"]


def judge(command: Command) -> Verdict:
    """Run one command in the current folder."""
    outputs = _outputs(command)
    for name in outputs - {"-", ""}:
        if not Path(name).exists() and "/" not in name:
            Path(name).write_bytes(OLD)
    before, versions = _contents(), {name: _version(name) for name in outputs}
    what = " ".join(command[:2]) if command[0] == "stars" else command[0]
    ran: Ran | None = None
    failures: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warnings.filterwarnings("ignore", r"'\w+' deprecated - use")  # pyparsing, older matplotlib
        try:
            ran = vopd(*command)
        except BaseException as error:
            failures.append(f"{what}: {type(error).__name__} in {_place(error)}: {error}"[:300])
    failures += [f"{what}: {one.category.__name__}: {one.message}"[:300] for one in caught]
    if ran is not None:
        failures += [f"{what}: {failure}" for failure in _statements(ran)]
    after = _contents()
    written = any(_version(name) != version for name, version in versions.items())
    if ran is not None and ran.status in (1, 2):
        said = ran.stderr or ran.stdout or written or {"-q", "--quiet"} & {*command}
        if not said:
            failures.append(f"{what}: fails without a word")
        if ran.status == 2 and written:
            failures.append(f"{what}: wrong usage changes the output")
    failures += [
        f"{what}: {'left behind' if name not in before else 'changed'}: {_kind(name)}"
        for name in after | before
        if name not in outputs and after.get(name) != before.get(name)
    ]
    return Verdict(ran, {name: after.get(name, b"") for name in outputs}, failures)


def _outputs(command: Command) -> set[str]:
    """The names of the output files, as `-o name`, `-oname` or `--output=name`."""
    names = {name for option, name in pairwise(command) if option in OUTPUTS}
    names |= {word[2:] for word in command if word.startswith("-o") and word != "-o"}
    for word in command:
        option, equals, name = word.partition("=")
        if equals and option.startswith("--") and option in OUTPUTS:
            names.add(name)
    return names


def _statements(ran: Ran) -> list[str]:
    """What the exit status and the messages themselves say."""
    found = []
    if ran.status not in STATUSES:
        found.append(f"exit status {ran.status}")
    if "Traceback" in ran.stderr:
        found.append("a traceback is printed")
    if "not enough memory" in ran.stderr:
        found.append("memory ran out")
    return found


def _kind(name: str) -> str:
    return "a temporary file" if name.startswith(".vopd-") else name


def _contents() -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in Path().rglob("*") if path.is_file()}


def _version(name: str) -> tuple[int, int] | None:
    """What changes where a file is written again, with the same content too."""
    try:
        status = Path(name).stat()
    except (OSError, ValueError):
        return None
    return status.st_ino, status.st_mtime_ns


def _place(error: BaseException) -> str:
    """The innermost function of the package that an exception went through."""
    frames = [
        frame for frame in traceback.extract_tb(error.__traceback__) if "/vopd/" in frame.filename
    ]
    if not frames:
        return "no function of the package"
    path = frames[-1].filename.rpartition("/vopd/")[2]
    return f"{path}, {frames[-1].name}"


def deck_commands(deck: str) -> list[list[str]]:
    """What every deck is put through."""
    return [
        ["check", deck],
        ["check", "--format", "json", deck],
        ["run", deck],
        ["run", deck, *TO_FILES],
        ["cards", deck],
        ["attitude", deck, "--format", "csv", "-o", "table"],
        [
            "attitude",
            deck,
            "--format",
            "jsonl",
            "--landmark-sigma",
            "30",
            "--initial",
            "closed-form",
        ],
        ["run", deck, "--fix", "all", "--initial", "closed-form", "--compare-initial"],
    ]


def flight_commands(flight: str) -> list[list[str]]:
    """What every flight project is put through."""
    return [
        ["check", flight],
        ["attitude", flight, *FLIGHT_TABLE],
        ["attitude", flight, "--format", "jsonl", "--strict", "-o", "lines"],
        ["adjust", flight, "--test"],
    ]


def star_commands(file: str) -> list[list[str]]:
    """What every star file is put through."""
    solve = ["stars", "solve", file, "--focal", "76"]
    return [
        [*solve, "--method", "all", "--format", "json"],
        [*solve, "--weights", "robust", "-o", "solution"],
        [*solve, "--method", "two-star", "--all-pairs"],
        [*solve, "--camera", "1000,2000,3000", "--format", "csv"],
        ["stars", "radec", file, "--focal", "76", "--attitude", "156,-18.75,46"],
        ["stars", "radec", file, "--typed", "-o", "stars.csv"],
    ]
