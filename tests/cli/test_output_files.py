"""What a file of `-o` holds after any failure: the old content or the new, whole.

Every call by which a file is written is made to fail in turn (`FaultyCalls`).
"""

from __future__ import annotations

import builtins
import errno
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import vopd.files as output
from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_4, DECKS, PROCESSOR, ROOT, Ran, vopd
from vopd.cli.output import refuse_to_overwrite
from vopd.files import OutputError, whole_file
from vopd.findings import VopdError

OLD = b"what was there before\n"
STARS = DECKS / "stars" / "table_6_3.csv"
WRITERS = {  # a command of every kind, up to the name of its output
    "run": ["run", CASE_4, "-o"],
    "tape10": ["run", CASE_4, "-o", "listing", "--tape10"],
    "attitude": ["attitude", CASE_4, "--format", "csv", "-o"],
    "npz": ["attitude", CASE_4, "--format", "npz", "-o"],
    "report": ["report", CASE_4, "-o"],
    "plot": ["plot", CASE_4, "--figure", "image", "-o"],
    "demo": ["demo", "--frames", "1", "-o"],
    "truth": ["demo", "--frames", "1", "-o", "listing", "--truth"],
    "stars": ["stars", "solve", STARS, "--focal", "76", "-o"],
    "errata": ["errata", "-o"],
}
SUFFIXES = {"report": ".html", "plot": ".svg"}
FAILING = {  # a command that makes nothing, up to the name of its output
    "no deck": ["run", "no-such.dat", "-o"],
    "no deck, tape": ["run", "no-such.dat", "--tape10"],
    "a deck that breaks off": ["run", "broken.dat", "-o"],
    "attitude": ["attitude", "broken.dat", "--format", "csv", "-o"],
    "report": ["report", "broken.dat", "-o"],
    "plot": ["plot", "broken.dat", "-o"],
    "stars": ["stars", "solve", "broken.dat", "--focal", "76", "-o"],
    "diff": ["diff", "broken.dat", "no-such.lst", "-o"],
    "errata": ["errata", "no-such-erratum", "-o"],
    "usage": ["demo", "--frames", "0", "-o"],
}


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.dat").write_text("\n".join(CASE_4.read_text().splitlines()[:30]))
    return tmp_path


def names() -> set[str]:
    return {path.name for path in Path().iterdir()} - {"broken.dat"}


@pytest.mark.parametrize("name", FAILING)
def test_a_command_that_makes_nothing_leaves_the_old_file(name: str) -> None:
    out = Path("out" + SUFFIXES.get(name, ".lst"))
    out.write_bytes(OLD)
    ran = vopd(*FAILING[name], out)
    assert ran.status == (2 if name in ("usage", "errata") else 1) and ran.stderr
    assert out.read_bytes() == OLD and names() == {out.name}
    out.unlink()
    vopd(*FAILING[name], out)
    assert names() == set()


@pytest.mark.usefixtures("saved_empty")
@pytest.mark.parametrize("name", WRITERS)
def test_a_command_that_makes_something_replaces_the_old_file(name: str) -> None:
    out = Path("out" + SUFFIXES.get(name, ".lst"))
    out.write_bytes(OLD)
    assert vopd(*WRITERS[name], out).status == 0
    assert out.read_bytes() != OLD and names() - {"listing"} == {out.name}


def test_what_was_made_before_a_failure_is_kept() -> None:
    """The pages of the good deck, whichever of the decks fails."""
    whole = vopd("run", CASE_4).output
    for decks in ([CASE_4, "broken.dat"], ["broken.dat", CASE_4]):
        assert vopd("run", *decks, "-o", "out").status == 1
        assert Path("out").read_bytes() == whole
        Path("out").unlink()


class FaultyFile:
    """A file of which every call may fail; leaving a `with` block closes it."""

    def __init__(self, file: Any, calls: FaultyCalls) -> None:
        self.write = calls.call("write", file.write)
        self.flush = calls.call("flush", file.flush)
        self.close = calls.call("close", file.close)
        self.fileno = file.fileno

    def __enter__(self) -> FaultyFile:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class FaultyCalls:
    """Functions and files of which the `fails`-th call fails, counted over all of them."""

    def __init__(self, fails: int, number: int) -> None:
        self.fails = fails
        self.number = number
        self.calls: list[str] = []

    def call(self, name: str, function: Any) -> Any:
        def faulty(*arguments: Any, **options: Any) -> Any:
            self.calls.append(name)
            failing = len(self.calls) == self.fails
            if failing and name != "close":
                raise OSError(self.number, os.strerror(self.number))
            result = function(*arguments, **options)
            if failing:  # a close that fails has closed all the same
                raise OSError(self.number, os.strerror(self.number))
            return result

        return faulty

    def open(self, *arguments: Any, **options: Any) -> Any:
        file = self.call("open", builtins.open)(*arguments, **options)
        return FaultyFile(file, self)

    def install(self, patch: pytest.MonkeyPatch) -> None:
        functions = {name: getattr(os, name) for name in dir(os)}
        for name in ("stat", "fsync", "chmod", "replace", "unlink", "open", "access"):
            functions[name] = self.call(name, functions[name])
        patch.setattr(output, "os", SimpleNamespace(**functions))
        patch.setattr(output, "open", self.open, raising=False)


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("run", errno.ENOSPC),
        ("run", errno.EACCES),
        ("run", errno.EINTR),
        ("tape10", errno.ENOSPC),
        ("npz", errno.EACCES),
        ("truth", errno.EINTR),
        ("stars", errno.ENOSPC),
    ],
)
def test_every_call_that_fails_leaves_the_old_file_or_the_new(name: str, number: int) -> None:
    out = Path("out")
    vopd(*WRITERS[name], out)
    new = out.read_bytes()
    seen: set[str] = set()
    for fails in range(1, 100):
        out.write_bytes(OLD)
        out.chmod(0o664)  # more than the umask lets a new file have
        Path("listing").unlink(missing_ok=True)
        faulty = FaultyCalls(fails, number)
        with pytest.MonkeyPatch.context() as patch:
            faulty.install(patch)
            ran = vopd(*WRITERS[name], out)
        assert names() <= {"out", "listing"} and not output.TEMPORARY
        if len(faulty.calls) < fails:  # nothing failed: the end
            assert (ran.status, out.read_bytes()) == (0, new)
            break
        seen.add(faulty.calls[fails - 1])
        assert out.read_bytes() in (OLD, new)
        if ran.status != 0:
            assert ran.status == 1 and ran.stderr.count("cannot be written") == 1
            assert ran.stderr.count("\n") == 1
        else:  # what failed was a look at the files, and the write was none the worse
            assert faulty.calls[fails - 1] == "stat" and out.read_bytes() == new
    else:
        raise AssertionError("the commands never end")
    assert {"open", "write", "flush", "fsync", "close", "chmod", "replace"} <= seen


def test_a_temporary_file_that_cannot_be_removed_is_no_traceback(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: Any) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    changed = {**{name: getattr(os, name) for name in dir(os)}, "unlink": refuse, "fsync": refuse}
    monkeypatch.setattr(output, "os", SimpleNamespace(**changed))
    ran = vopd("run", CASE_4, "-o", "out")
    assert ran.status == 1
    assert_approved(ran.stderr)


def test_an_exception_of_another_kind_leaves_the_old_file() -> None:
    Path("out").write_bytes(OLD)
    with pytest.raises(KeyboardInterrupt), whole_file("out") as file:
        file.write(b"half a page")
        assert len(names()) == 2
        raise KeyboardInterrupt
    assert names() == {"out"} and Path("out").read_bytes() == OLD


def test_half_of_two_outputs_is_none() -> None:
    """Where one output cannot be written, the other does not appear either."""
    Path("out").write_bytes(OLD)
    with pytest.raises(OutputError), whole_file("out") as file, whole_file("/dev/full") as full:
        file.write(b"pages")
        full.write(b"x" * 100_000)
    assert Path("out").read_bytes() == OLD and names() == {"out"}


def test_links_modes_and_long_names() -> None:
    Path("far").mkdir()
    Path("far/target").write_bytes(OLD)
    Path("far/target").chmod(0o4604)
    Path("link").symlink_to("far/target")
    assert vopd("run", CASE_4, "-o", "link").status == 0
    whole = vopd("run", CASE_4).output
    assert Path("link").is_symlink() and Path("far/target").read_bytes() == whole
    assert stat.S_IMODE(Path("far/target").stat().st_mode) == 0o4604
    Path("dangling").symlink_to("far/new")
    assert vopd("run", CASE_4, "-o", "dangling").status == 0
    assert Path("far/new").read_bytes() == whole and Path("dangling").is_symlink()
    before = os.umask(0o027)
    try:
        assert vopd("run", CASE_4, "-o", "n" * 255).status == 0
    finally:
        os.umask(before)
    assert stat.S_IMODE(Path("n" * 255).stat().st_mode) == 0o640


def test_nobody_can_read_more_while_a_file_is_replaced() -> None:
    """The temporary file of a private file is private too."""
    Path("out").write_bytes(OLD)
    Path("out").chmod(0o600)
    with whole_file("out") as file:
        file.write(b"half a page")
        (temporary,) = names() - {"out"}
        assert stat.S_IMODE(Path(temporary).stat().st_mode) == 0o600
    assert stat.S_IMODE(Path("out").stat().st_mode) == 0o600


def refusal(*arguments: str | Path) -> str:
    """What a command says that refuses its output before any work, the deck being missing."""
    ran = vopd("run", "no-such.dat", *arguments)
    assert ran.status == 1 and "no-such.dat" not in ran.stderr
    return ran.stderr


def test_outputs_that_are_refused_before_the_work() -> None:
    Path("old").write_bytes(OLD)
    Path("old").chmod(0o444)
    Path("loop").symlink_to("loop")
    Path("folder").mkdir()
    assert_approved(refusal("-o", "old"))
    assert_approved(refusal("-o", "folder"))
    assert_approved(refusal("-o", "no/out"))
    assert_approved(refusal("-o", "old/out"))
    assert "symbolic links" in refusal("--tape10", "loop")
    assert_approved(refusal("-o", "out/"))
    assert Path("old").read_bytes() == OLD and names() == {"old", "loop", "folder"}


@pytest.mark.parametrize("arguments", [("",), ("no-such.dat", ""), ("no-such.dat", "-o", "")])
def test_a_name_of_a_variable_without_value(arguments: tuple[str, ...]) -> None:
    ran = vopd("run", *arguments)
    assert ran.status == 2
    assert_approved(ran.stderr)


def test_an_output_that_is_an_input_by_any_name() -> None:
    Path("deck").write_bytes(CASE_4.read_bytes())
    os.link("deck", "hard")
    Path("soft").symlink_to("hard")
    for name in ("deck", "hard", "soft", "../" + Path.cwd().name + "/deck"):
        ran = vopd("run", "deck", "-o", name)
        assert (ran.status, ran.output) == (1, b"") and "needed already" in ran.stderr
    assert "needed already" in vopd("run", CASE_4, "-o", "deck", "--tape10", "soft").stderr
    assert "needed already" in vopd("run", CASE_4, "-o", "new", "--tape10", "./new").stderr
    assert vopd("run", CASE_4, "-o", os.devnull, "--tape10", os.devnull).status == 0
    assert Path("deck").read_bytes() == CASE_4.read_bytes()


def shell(script: str) -> Ran:
    """A shell script in which `vopd` is the command of this checkout."""
    command = f"vopd() {{ '{sys.executable}' -m vopd \"$@\"; }}; {script}"
    environment = {"PATH": os.defpath, "PYTHONPATH": str(ROOT), "LANG": "C.UTF-8"} | PROCESSOR
    environment["PYTHONDONTWRITEBYTECODE"] = "1"  # a limit of size would cut it off
    done = subprocess.run(["bash", "-c", command], capture_output=True, env=environment)
    return Ran(done.returncode, done.stdout.decode(), done.stderr.decode(), done.stdout)


@pytest.mark.parametrize("script", ["run - -o deck < deck", "run deck >> deck"])
def test_standard_streams_that_are_the_other_file(script: str) -> None:
    Path("deck").write_bytes(CASE_4.read_bytes())
    ran = shell(f"vopd {script}")
    assert ran.status == 1 and "needed already" in ran.stderr
    assert Path("deck").read_bytes() == CASE_4.read_bytes()


def test_devices_and_pipes_are_written_as_they_are() -> None:
    whole = vopd("run", CASE_4).output
    os.mkfifo("pipe")
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(Path("pipe").read_bytes()))
    reader.start()
    assert vopd("run", CASE_4, "-o", "pipe").status == 0
    reader.join()
    assert read == [whole] and stat.S_ISFIFO(Path("pipe").stat().st_mode)
    assert shell(f"vopd run {CASE_4} -o /dev/stdout | cat").output == whole
    full = vopd("run", CASE_4, "-o", "/dev/full")
    assert_approved(full.stderr)
    assert names() == {"pipe"}


@pytest.mark.parametrize("unbuffered", ["", "PYTHONUNBUFFERED=1 "], ids=["buffered", "unbuffered"])
def test_a_disk_that_fills_up(unbuffered: str) -> None:
    """The limit of a file's size stands for the disk: the last write is a short one."""
    Path("out").write_bytes(OLD)
    decks = " ".join([str(CASE_4)] * 5)  # five pages of 1.5 kB
    ran = shell(f"ulimit -f 4; {unbuffered}vopd run {decks} -o out")
    assert ran.status == 1
    assert_approved(ran.stderr)
    assert Path("out").read_bytes() == OLD and names() == {"out"}
    ran = shell(f"ulimit -f 4; {unbuffered}vopd run {decks} > piped")
    assert (ran.status, ran.stderr) == (1, "standard output: File too large\n")


def test_a_reader_that_leaves_does_not_leave_half_a_tape() -> None:
    Path("tape").write_bytes(OLD)
    decks = " ".join([str(DECKS / "appendix_h" / "cases_1_2_3.dat")] * 40)  # 180 kB
    ran = shell(f"vopd run -q {decks} --tape10 tape | head -1; exit ${{PIPESTATUS[0]}}")
    assert (ran.status, ran.stdout.count("\n")) == (1, 1)
    assert_approved(ran.stderr)
    assert Path("tape").read_bytes() == OLD and names() == {"tape"}


def test_an_error_of_the_work_still_lets_the_file_appear() -> None:
    with refused(VopdError), whole_file("out") as file:
        file.write(b"a page\n")
        raise VopdError("landmark 7 is not defined")
    assert Path("out").read_bytes() == b"a page\n"
    with refused(OutputError):
        refuse_to_overwrite(("out",), "out")
