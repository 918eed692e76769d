"""The command line as a process: what it does where its output cannot go.

The environment is empty but for what a process needs, so that no variable of a
developer's machine (PYTHONUNBUFFERED above all) can hide a failure.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_4, PROCESSOR, ROOT

FULL = Path("/dev/full")
VOPD = [sys.executable, "-m", "vopd"]
ENVIRONMENT = {
    "PATH": os.defpath,
    "PYTHONPATH": str(ROOT),
    "LANG": "C.UTF-8",
    **{name: os.environ[name] for name in ("SYSTEMROOT",) if name in os.environ},
    **PROCESSOR,
}
BUFFERED = [ENVIRONMENT, ENVIRONMENT | {"PYTHONUNBUFFERED": "1"}]


def process(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*VOPD, *arguments],
        text=True,
        **({"env": ENVIRONMENT} | options),  # type: ignore[call-overload]
    )


@pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")
@pytest.mark.parametrize("environment", BUFFERED, ids=["buffered", "unbuffered"])
@pytest.mark.parametrize(
    "arguments", [["errata"], ["run", str(CASE_4)], ["--help"], ["run", "--help"]], ids=str
)
def test_a_full_disk_is_one_message_and_status_1(
    arguments: list[str], environment: dict[str, str]
) -> None:
    """Whether the output is written as it comes or at the very end."""
    with FULL.open("wb") as full:
        run = process(*arguments, stdout=full, stderr=subprocess.PIPE, env=environment)
    assert (run.returncode, run.stderr) == (1, "standard output: No space left on device\n")


def test_a_compiled_file_that_breaks_off_is_said(tmp_path: Path) -> None:
    """Python up to 3.12.7 leaves such a file on a full disk, and click takes it for Ctrl-C."""
    cached = ENVIRONMENT | {"PYTHONPYCACHEPREFIX": str(tmp_path)}
    ran = {"env": cached, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    assert process("errata", **ran).returncode == 0
    (compiled,) = tmp_path.rglob("cli/errata.*.pyc")
    compiled.write_bytes(compiled.read_bytes()[:500])
    run = process("errata", **ran)
    assert run.returncode == 1
    assert_approved(run.stderr.replace(sys.prefix, "PREFIX"))


@pytest.mark.parametrize("environment", BUFFERED, ids=["buffered", "unbuffered"])
def test_a_reader_that_has_seen_enough_is_no_failure(environment: dict[str, str]) -> None:
    pages = str(ROOT / "decks" / "appendix_h" / "cases_1_2_3.dat")
    command = f'"{sys.executable}" -m vopd run -q "{pages}" "{pages}" 2>&1 1>&3 | cat >&2'
    script = f'{{ {command}; echo "${{PIPESTATUS[0]}}" >&2; }} 3>&1 | head -n 1'
    run = subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, env=environment, check=False
    )
    assert run.stdout.startswith("1   VIKING") and run.stderr == "0\n"


def test_all_is_written_before_the_process_ends() -> None:
    run = process("run", str(CASE_4), capture_output=True)
    assert run.returncode == 0 and run.stdout.endswith("END OF CASE\n")


def test_a_status_reaches_the_shell() -> None:
    assert process("run", "--no-such", capture_output=True).returncode == 2
    assert process("run", "no-such.dat", capture_output=True).returncode == 1


def shell(script: str, **settings: str) -> tuple[int, str, str]:
    """Status, standard output and standard error of a script in which `vopd` is the command."""
    command = f"vopd() {{ '{sys.executable}' -m vopd \"$@\"; }}; deck='{CASE_4}'; {script}"
    done = subprocess.run(
        ["bash", "-c", command], env=ENVIRONMENT | settings, capture_output=True, text=True
    )
    return done.returncode, done.stdout, done.stderr


NOT_OPEN = "Bad file descriptor\n"
CLOSED = [  # a script, its status and what it says
    ("vopd run $deck >&-", 1, f"standard output: {NOT_OPEN}"),
    ("vopd errata >&-", 1, f"standard output: {NOT_OPEN}"),
    ("vopd --help >&-", 1, f"standard output: {NOT_OPEN}"),
    ("vopd run - <&-", 1, f"-: {NOT_OPEN}"),
    ("vopd run - <&- >&- 2>&-", 1, ""),
    ("vopd stars solve - --focal 76 <&-", 1, f"standard input: cannot be read: {NOT_OPEN}"),
    ("vopd run $deck -o /dev/null <&- >&- 2>&-", 0, ""),
    ("vopd run no-such.dat 2>&-", 1, ""),
    ("vopd run no-such.dat 2>/dev/full", 1, ""),
    (
        "vopd run $deck no-such.dat $deck 2>/dev/full | grep -c 'END OF'; exit ${PIPESTATUS[0]}",
        1,
        "",
    ),
    ("vopd run $deck --fix all 2> >(true) | grep -c 'END OF'; exit ${PIPESTATUS[0]}", 0, ""),
    ('cd "$(mktemp -d)"; rmdir "$PWD"; vopd run film.dat', 1, "the current folder: ..."),
]


@pytest.mark.parametrize("script, status, said", CLOSED, ids=[script for script, _, _ in CLOSED])
def test_standard_streams_that_are_closed_or_full(script: str, status: int, said: str) -> None:
    if "/dev/full" in script and not FULL.exists():
        pytest.skip("no device that is always full")
    ran, printed, errors = shell(script)
    assert_approved((ran, errors))
    if "grep" in script:
        assert printed == ("2\n" if "no-such" in script else "1\n")


def test_a_file_never_gets_the_number_of_a_closed_stream(tmp_path: Path) -> None:
    """Or a message to standard error would be written into the deck."""
    (tmp_path / "deck").write_bytes(CASE_4.read_bytes())
    status, _, _ = shell(f"cd '{tmp_path}'; vopd run deck --no-such <&- >&- 2>&-")
    assert status == 2 and (tmp_path / "deck").read_bytes() == CASE_4.read_bytes()


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_a_name_that_the_encoding_does_not_have(encoding: str) -> None:
    """A name of bytes that are no UTF-8, printed and written to standard error."""
    status, printed, errors = shell(r"vopd check $'\xff.dat'", PYTHONIOENCODING=encoding)
    assert status == 1 and ".dat: " in printed and errors == ""


def test_figures_in_a_notebook_of_another_installation(tmp_path: Path) -> None:
    """A cell's `!vopd plot` has its backend in the environment; it need not be installed here."""
    pytest.importorskip("matplotlib")
    figure = tmp_path / "a.svg"
    for backend in ("module://matplotlib_inline.backend_inline", "no_such"):
        status, _, errors = shell(f"vopd plot -q $deck -o '{figure}'", MPLBACKEND=backend)
        assert (status, errors) == (0, "") and figure.read_text().startswith("<?xml")
        figure.unlink()


def test_settings_of_figures_that_cannot_be_read(tmp_path: Path) -> None:
    """matplotlib reads those of the current folder, where a project of others may lie."""
    pytest.importorskip("matplotlib")
    (tmp_path / "matplotlibrc").write_bytes(b"\xff\xfe")
    status, _, errors = shell(f"cd '{tmp_path}'; vopd plot -q $deck -o a.svg")
    assert status == 1 and "matplotlibrc" in errors and "Traceback" not in errors
    assert_approved(errors.splitlines()[-1])


def test_memory_that_runs_out_is_one_message() -> None:
    program = (
        "from vopd.cli import cli, check\n"
        "def fail(*_, **__): raise MemoryError\n"
        "check.check_deck = fail\n"
        f"cli(['check', {str(CASE_4)!r}])"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], env=ENVIRONMENT, capture_output=True, text=True
    )
    assert run.returncode == 1
    assert_approved(run.stderr)
