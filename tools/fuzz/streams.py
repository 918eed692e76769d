"""Commands as processes, with standard streams that are closed, full, or left by their reader."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from random import Random

from trial import Trial, write

ROOT = Path(__file__).parents[2]
STREAMS = [
    ">&-", "<&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-", "> /dev/full", "2> /dev/full", "| head -1",
    "| true", "2> >(true)", "> out.txt", ">> deck.dat", "< deck.dat", "",
]  # fmt: skip
SETTINGS = [
    {}, {"PYTHONUNBUFFERED": "1"}, {"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "POSIX"},
    {"PYTHONWARNINGS": "error"}, {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"},
    {"COLUMNS": "1"}, {"TZ": "Asia/Kathmandu"}, {"PYTHONOPTIMIZE": "2"},
]  # fmt: skip


def process_failures(trial: Trial, random: Random) -> tuple[str, list[str]]:
    """Run one command of a trial as a shell would; the command line, and its failures."""
    command = random.choice(trial.commands)
    if random.random() < 0.2:
        command = ["-" if part == "deck.dat" else part for part in command]
    streams, settings = random.choice(STREAMS), random.choice(SETTINGS)
    words = [part for part in command if "\0" not in part]
    line = " ".join(map(shlex.quote, [sys.executable, "-m", "vopd", *words]))
    script = f"{line} {streams}\nexit ${{PIPESTATUS[0]}}"
    said = " ".join([*(f"{k}={v}" for k, v in settings.items()), "vopd", *words, streams])
    with tempfile.TemporaryDirectory() as place:
        for name, data in trial.files.items():
            write(Path(place) / name, data)
        environment = {"PATH": os.environ["PATH"], "PYTHONPATH": str(ROOT), "LANG": "C.UTF-8"}
        try:
            done = subprocess.run(
                ["bash", "-c", script], cwd=place, env=environment | settings, timeout=120,
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return said, ["process: no end within two minutes"]
        left = [path.name for path in Path(place).iterdir() if path.name.startswith(".vopd-")]
    text = done.stdout.decode(errors="replace")
    failures = [f"process: exit status {done.returncode}"] * (done.returncode not in (0, 1, 2, 3))
    failures += ["process: a temporary file is left"] * bool(left)
    for sign in ("Traceback", "Exception ignored", "Warning: "):
        if sign in text:
            failures.append(f"process: {sign}: {text.strip().splitlines()[-1]}"[:300])
    return said, failures
