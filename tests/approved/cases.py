"""Approved cases: command lines, the inputs they run on, and what they leave."""

from __future__ import annotations

import contextlib
import json
import lzma
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest.mock import patch

from tests.approved.compare import NUMBER
from tests.approved.content import content
from tests.kit.command import ROOT, Ran, vopd
from vopd import __version__ as vopd_version

HERE = Path(__file__).parent
TRIALS = HERE / "trials"
ENVIRONMENT = {"COLUMNS": "80", "LINES": "24", "SOURCE_DATE_EPOCH": "146851200", "TZ": "UTC"}
FIRST_LINES = 40
KEYS = {
    "name", "why", "command", "inputs", "files", "variants", "status", "stdin", "terminal",
    "third_party", "digits", "noise", "every",
}  # fmt: skip


Changes = Mapping[str, str | list[str]]
"""Files by name: the text of each, or what is replaced in it: old, new, old, new ..."""


@dataclass(frozen=True)
class Case:
    """Command lines that run one after the other in a folder of their own.

    Attributes:
        name: the folder of its expected output
        commands: command lines without `vopd`
        inputs: paths from the root of the repository; `path -> name` renames a file
        files: further inputs, and changes of those above
        variants: folders that each have all inputs, and changes of their own; in a command
            `{variants}` stands for the `flight.toml` of each
        statuses: exit status of each command; None where it is kept with the outputs, as `status`
        stdin: a file of the folder on standard input
        terminal: run in a process under a pseudo-terminal of 80 columns
        third_party: beginnings of messages of other packages; a line is compared up to their end
        digits: how many digits are kept of each number, where the inputs determine no more
        noise: outputs whose numbers are rounding noise, of a frame that is not determined: each
            becomes a #
        every: of an output of more lines than that, only the first FIRST_LINES and every so many
            are kept
    """

    name: str
    commands: tuple[str, ...]
    inputs: tuple[str, ...] = ()
    files: Changes = field(default_factory=dict)
    variants: Mapping[str, Changes] = field(default_factory=dict)
    statuses: tuple[int, ...] | None = (0,)
    stdin: str | None = None
    terminal: bool = False
    third_party: tuple[str, ...] = ()
    digits: int | None = None
    noise: tuple[str, ...] = ()
    every: int | None = None


@dataclass(frozen=True)
class Outcome:
    """Exit statuses, and the text of each output by name: stdout, stderr, files/NAME."""

    statuses: tuple[int, ...]
    outputs: dict[str, str]


def read_cases(path: Path) -> list[Case]:
    """Read the cases of a .toml."""
    cases = tomllib.loads(path.read_text(encoding="utf-8"))["case"]
    return [_case(keys, path.name) for keys in cases]


def read_trials(path: Path = TRIALS / "inputs.jsonl.xz") -> list[Case]:
    """Read the trials of tools/fuzz that are kept: a line for each, with its name, commands, files.

    Their exit statuses are kept among their expected outputs.
    """
    with lzma.open(path, "rt", encoding="ascii") as lines:
        return [
            Case(one["name"], tuple(one["commands"]), files=one["files"], statuses=None)
            for one in map(json.loads, lines)
        ]


def _case(keys: dict[str, Any], file: str) -> Case:
    if unknown := keys.keys() - KEYS:
        raise ValueError(f"{file}: {keys.get('name')}: unknown key {', '.join(sorted(unknown))}")
    several = isinstance(keys["command"], list)
    commands = tuple(keys["command"]) if several else (keys["command"],)
    status = keys.get("status", [0] * len(commands) if several else 0)
    return Case(
        name=keys["name"],
        commands=commands,
        inputs=tuple(keys.get("inputs", ())),
        files=keys.get("files", {}),
        variants=keys.get("variants", {}),
        statuses=tuple(status) if several else (status,),
        stdin=keys.get("stdin"),
        terminal=keys.get("terminal", False),
        third_party=tuple(keys.get("third_party", ())),
        digits=keys.get("digits"),
        noise=tuple(keys.get("noise", ())),
        every=keys.get("every"),
    )


def run_case(case: Case, folder: Path) -> Outcome:
    """Run a case in an empty folder.

    Args:
        folder: empty; inputs are copied into it
    """
    copy_inputs(case, folder)
    before = _files(folder)
    done = []
    with _place(folder), _quick_figures("report" in " ".join(case.commands)):
        for command in case.commands:
            each = " ".join(f"{name}/flight.toml" for name in case.variants)
            arguments = shlex.split(command.replace("{variants}", each))
            if case.terminal:
                done.append(on_a_terminal(arguments))
            else:
                stdin = Path(case.stdin).read_bytes() if case.stdin else None
                done.append(vopd(*arguments, stdin=stdin))
    outputs = {"stdout": b"", "stderr": b""}
    for command, ran in zip(case.commands, done, strict=True):
        title = f"$ vopd {command}\n".encode() if len(done) > 1 else b""
        outputs["stdout"] += title + ran.output
        if ran.stderr:
            outputs["stderr"] += title + ran.stderr.encode()
    if case.statuses is None:
        outputs["status"] = " ".join(str(ran.status) for ran in done).encode()
    after = _files(folder)
    for name in sorted(after):
        if after[name] != before.get(name):
            outputs[f"files/{name}"] = after[name]
    outputs |= {f"files/{name}": b"(removed)" for name in before.keys() - after.keys()}
    return Outcome(
        tuple(ran.status for ran in done),
        {
            name: _kept(normalised(content(data), folder), name, case)
            for name, data in outputs.items()
            if data or name != "stderr"
        },
    )


def copy_inputs(case: Case, folder: Path) -> None:
    """Copy the inputs of a case into a folder, or into one folder for each variant."""
    for name in case.variants or [""]:
        (folder / name).mkdir(exist_ok=True)
        _copy(case.inputs, folder / name)
        _change(case.files, folder / name)
        _change(case.variants.get(name, {}), folder / name)


def _copy(inputs: tuple[str, ...], folder: Path) -> None:
    """Copy inputs into a folder: a file by its name, of a folder its contents."""
    for entry in inputs:
        path, _, name = (part.strip() for part in entry.partition("->"))
        source = ROOT / path
        if source.is_dir():
            shutil.copytree(source, folder / name, dirs_exist_ok=True)
        else:
            target = folder / (name or source.name)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)


def _change(files: Changes, folder: Path) -> None:
    """Write files, or replace texts in those that are there, each of which stands there once."""
    for name, change in files.items():
        path = folder / name
        if isinstance(change, str):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(change.encode(errors="surrogateescape"))
            continue
        text = path.read_bytes().decode()
        for old, new in zip(change[::2], change[1::2], strict=True):
            if text.count(old) != 1:
                raise ValueError(f"{path}: {old!r} stands there {text.count(old)} times, not once")
            text = text.replace(old, new)
        path.write_bytes(text.encode())


def normalised(text: str, folder: Path) -> str:
    """Replace what differs from run to run: the version, the folder, hashes, times taken."""
    text = text.replace(str(folder.resolve()), "FOLDER").replace(str(folder), "FOLDER")
    version = re.escape(vopd_version)
    text = re.sub(rf"(vopd,? (?:version )?|['\"]){version}", r"\1VERSION", text)
    text = re.sub(r"\b[0-9a-f]{64}\b", "HASH", text)
    return re.sub(r"(\"seconds\": )[-+.e\d]+", r"\1SECONDS", text)


def _kept(text: str, output: str, case: Case) -> str:
    """Leave out of an output what a case does not keep."""
    for beginning in case.third_party:
        text = re.sub(f"({re.escape(beginning)}).*", r"\1...", text)
    if output in case.noise:
        text = re.sub(rf" *(?:{NUMBER.pattern}|-?inf)", " #", text)
    return shortened(rounded(text, case.digits), case.every)


def shortened(text: str, every: int | None) -> str:
    """Keep the first lines, and then every so many, of a long text; None keeps all."""
    lines = text.splitlines(keepends=True)
    if every is None or len(lines) <= every:
        return text
    return "".join(lines[:FIRST_LINES] + lines[FIRST_LINES::every])


def rounded(text: str, digits: int | None) -> str:
    """Round every number with a point to so many digits; None leaves them as they are."""
    if digits is None:
        return text
    return re.sub(
        r"(?<![\w.])-?\d*\.\d+(e[-+]\d+)?(?![\w.])", lambda m: f"{float(m[0]):.{digits}g}", text
    )


def _files(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@contextlib.contextmanager
def _place(folder: Path) -> Iterator[None]:
    """The same place for every run: folder, environment, and warnings as errors."""
    plain = {name: value for name, value in os.environ.items() if "COLOR" not in name}
    with (
        contextlib.chdir(folder),
        patch.dict(os.environ, plain | ENVIRONMENT, clear=True),
        warnings.catch_warnings(),
    ):
        yield


@contextlib.contextmanager
def _quick_figures(of_pages: bool) -> Iterator[None]:
    """Figures without layout, which takes most of the time: what is drawn in them in place of SVG.

    Of other pictures only the size is made.

    Args:
        of_pages: whether only reports have figures, which are not compared
    """
    from matplotlib.figure import Figure

    from tests.kit.drawn import described

    save = Figure.savefig

    def saved(figure: Figure, file: Any, **options: Any) -> None:
        if options["format"] == "svg" and not of_pages:
            file.write("\n".join([*described(figure), ""]).encode())
        else:
            save(Figure(figure.get_size_inches()), file, **options)

    engine = "matplotlib.layout_engine.ConstrainedLayoutEngine.execute"
    with patch(engine, lambda *_: None), patch.object(Figure, "savefig", saved):
        yield


def on_a_terminal(arguments: list[str]) -> Ran:
    """Run `vopd` in a process whose three streams are a pseudo-terminal of 80 by 24 characters.

    Returns: what the screen got, as standard output.
    """
    import fcntl
    import struct
    import termios

    ours, theirs = os.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TERM": "xterm-256color"}
    del environment["COLUMNS"], environment["LINES"]
    process = subprocess.Popen(
        [sys.executable, "-m", "vopd", *arguments],
        stdin=theirs, stdout=theirs, stderr=theirs, env=environment, start_new_session=True,
    )  # fmt: skip
    os.close(theirs)
    screen = b""
    with contextlib.suppress(OSError):  # the end, on Linux
        while data := os.read(ours, 65536):
            screen += data
    os.close(ours)
    shown = screen.replace(b"\r\n", b"\n")
    shown = re.sub(rb"\r[^\r\n]*(?=\r)|\r", b"", shown)  # progress, on a busy machine
    return Ran(process.wait(), screen.decode(), "", shown)
