"""One trial: files and command lines, judged in a child process with limits of time and memory."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.kit.judge import judge_all

SLOW = "more time than the limit"
PICTURES = ("plot", "report")
PICTURE_S = 6.0  # a picture takes matplotlib some seconds, whatever the input
FLIGHT_S = 11.0  # beside, of a flight that misfits: docs/promises.md has what was measured
PAIR_S = 1e-3  # for each pair of stars that are all asked for
JOB_S = {"check": 5e-3, "run": 6e-3, "attitude": 9e-3, "report": 0.012, "plot": 0.012}
FLIGHT_TIMES = 60  # what a byte of a flight may cost, against that of a deck: a dozen solves
BYTES = 20.0  # of memory for every byte of the input
PRINTED_BYTES = 100.0  # the same of a flight whose table is printed: what is printed is kept here
HARD_MB = 4000  # the child is ended there, so that the machine survives
PATIENCE = 20  # the clock may show so many times the limit on a machine that is shared


IMPORT_S = 0.08  # of numpy on the processor of docs/performance.md, for which the limits are
MOST_SLOWER = 3.0


@cache
def times_slower() -> float:
    """Measure how many times slower this machine is than that for which the limits are."""
    each = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", "import numpy"], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        each.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(max(min(each) / IMPORT_S, 1.0), MOST_SLOWER)


@dataclass(frozen=True)
class Trial:
    """Files, and the commands that are run on them in one folder."""

    files: dict[str, bytes]
    commands: list[list[str]]
    jobs: int = 0  # of a deck that has many

    def seconds(self) -> float:
        """What the commands may take together, in time of the processor."""
        size = sum(map(len, self.files.values()))
        if "flight.toml" in self.files:
            size *= FLIGHT_TIMES
        flight_s = FLIGHT_S * ("flight.toml" in self.files)
        pictures = sum(command[0] in PICTURES for command in self.commands)
        by_pairs = sum("--all-pairs" in command for command in self.commands)
        stars = min(200, self.files.get("stars.csv", b"").count(b"\n"))
        return times_slower() * (
            len(self.commands) * (2.0 + flight_s + 2.0 * size / 1e7)
            + sum(self.jobs * JOB_S.get(command[0], 5e-3) for command in self.commands)
            + pictures * PICTURE_S
            + by_pairs * stars**2 / 2.0 * PAIR_S
        )

    def megabytes(self) -> float:
        """By how much the memory may grow."""
        each = BYTES
        if any(_prints(command) for command in self.commands):
            each += PRINTED_BYTES
        return 200.0 + each * sum(map(len, self.files.values())) / 1e6


def _prints(command: list[str]) -> bool:
    """Whether it prints the table of a flight in a format, in which it may be 17 times as long."""
    table = command[0] == "attitude" and "flight.toml" in command
    return table and "--format" in command and not {"-o", "--output"} & {*command}


def failures_of(trial: Trial) -> list[str]:
    """The failures of a trial, each as one line; one that took too long is tried once more.

    On a machine that others use too, the same work can take twice the time.
    """
    failures = _failures(trial)
    return _failures(trial) if any(SLOW in failure for failure in failures) else failures


def _failures(trial: Trial) -> list[str]:
    limit_s = trial.seconds()
    with tempfile.TemporaryDirectory() as place, tempfile.TemporaryFile() as answer:
        for name, data in trial.files.items():
            write(Path(place) / name, data)
        base_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        child = os.fork()
        if child == 0:
            _judge(trial, place, answer.fileno(), limit_s)
        status, usage = _wait(child, PATIENCE * limit_s)
        answer.seek(0)
        text = answer.read()
    failures: list[str] = json.loads(text) if text else []
    used_s = usage.ru_utime + usage.ru_stime
    grown_mb = (usage.ru_maxrss - base_kb) / 1000
    if os.WIFSIGNALED(status):
        failures.append(f"{_names(trial)}: ended by signal {os.WTERMSIG(status)}")
    if used_s > limit_s:
        failures.append(f"{_names(trial)}: {SLOW} [{used_s:.1f} s]")
    if grown_mb > trial.megabytes():
        failures.append(f"{_names(trial)}: more memory than the limit [{grown_mb:.0f} MB]")
    return failures


def write(path: Path, data: bytes) -> None:
    """Write an input file, and the folder that it is in."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def _names(trial: Trial) -> str:
    return " ".join(sorted({command[0] for command in trial.commands}))


def _judge(trial: Trial, place: str, answer: int, limit_s: float) -> None:
    """In the child: run the commands and hand the failures back."""
    os.chdir(place)
    seconds = int(2 * limit_s) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    resource.setrlimit(resource.RLIMIT_AS, (HARD_MB << 20, HARD_MB << 20))
    status = 70
    try:
        os.write(answer, json.dumps(judge_all(trial.commands)).encode())
        status = 0
    finally:
        sys.stderr.flush()
        os._exit(status)


def _wait(child: int, seconds: float) -> tuple[int, resource.struct_rusage]:
    until = time.monotonic() + seconds
    while True:
        ended, status, usage = os.wait4(child, os.WNOHANG)
        if ended:
            return status, usage
        if time.monotonic() > until:
            os.kill(child, signal.SIGKILL)
            until += 1e9
        time.sleep(0.002)


def kind(failure: str) -> str:
    """What is the same in two failures of one cause: no number, no name, no place in the input."""
    failure = re.sub(r"\[.*?\]|'[^']*'", "", failure)
    return re.sub(r"-?[\d.]+", "0", failure)
