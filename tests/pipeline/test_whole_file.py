"""A file that appears as a whole: what is on the disk during, after, and after a failure."""

from __future__ import annotations

import io
import os
import stat
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.approved.texts import refused
from vopd import files as module
from vopd.files import TEMPORARY, OutputError, file_status, is_plain, whole_file
from vopd.findings import VopdError

posix = pytest.mark.skipif(os.name != "posix", reason="modes, links and pipes")


@pytest.fixture(autouse=True)
def umask() -> Iterator[None]:
    before = os.umask(0o022)
    yield
    os.umask(before)
    assert not TEMPORARY  # whatever happened


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def write(path: Path | str, data: bytes = b"new", working: str = "") -> None:
    with whole_file(str(path), working) as file:
        file.write(data)


def names(folder: Path) -> list[str]:
    return sorted(one.name for one in folder.iterdir())


@pytest.mark.parametrize("before", [None, b"old"])
def test_the_file_is_as_it_was_until_the_block_ends(before: bytes | None, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    if before:
        path.write_bytes(before)
    with whole_file(str(path)) as file:
        assert names(tmp_path) == ["a.csv"] * bool(before) and not TEMPORARY
        file.write(b"ne")
        (temporary,) = set(names(tmp_path)) - {"a.csv"}
        assert temporary.startswith(".vopd-") and len(temporary) == 18
        assert {str(tmp_path / temporary)} == TEMPORARY
        file.write(b"w")
        assert (path.read_bytes() if before else None) == before
    assert path.read_bytes() == b"new" and names(tmp_path) == ["a.csv"]


@pytest.mark.parametrize(
    ("error", "content"),
    [
        (VopdError("half"), b"new"), (OutputError("other file"), b"old"),
        (KeyError("bug"), b"old"), (KeyboardInterrupt(), b"old"), (OSError("disk"), b"old"),
        (BrokenPipeError(), b"old"),
    ],
    ids=lambda one: type(one).__name__,
)  # fmt: skip
def test_what_is_there_after_an_error(error: BaseException, content: bytes, tmp_path: Path) -> None:
    """All that was written before an error that a user can correct; otherwise what was there."""
    path = tmp_path / "a"
    path.write_bytes(b"old")
    raised: type[BaseException] = type(error)
    raised = OutputError if isinstance(error, BrokenPipeError) else raised
    with pytest.raises(raised) as found, whole_file(str(path)) as file:
        file.write(b"new")
        raise error
    assert path.read_bytes() == content and names(tmp_path) == ["a"]
    if raised is OutputError and error is not found.value:
        assert str(found.value) == f"{path}: not written, because standard output was closed"


def test_where_nothing_is_written_nothing_is_touched(tmp_path: Path) -> None:
    old = tmp_path / "old"
    old.write_bytes(b"old")
    for path in (old, tmp_path / "none"):
        with whole_file(str(path)):
            pass
        with pytest.raises(VopdError), whole_file(str(path)):
            raise VopdError("nothing")
    assert names(tmp_path) == ["old"] and old.read_bytes() == b"old"


@posix
@pytest.mark.parametrize("mode", [0o644, 0o600, 0o640, 0o444, 0o755, 0o666])
def test_a_file_that_is_replaced_keeps_its_mode(mode: int, tmp_path: Path) -> None:
    path = tmp_path / "a"
    write(path)
    assert mode_of(path) == 0o644  # a new one: that of every program
    path.chmod(mode)
    with whole_file(str(path)) as file:
        file.write(b"second")
        (temporary,) = TEMPORARY
        assert mode_of(Path(temporary)) & ~(mode | stat.S_IWUSR) == 0  # nobody reads more
    assert mode_of(path) == mode and path.read_bytes() == b"second"


@posix
def test_a_link_stays_a_link(tmp_path: Path) -> None:
    """Also one whose file is not there yet; the temporary file is beside the file."""
    away = tmp_path / "away"
    away.mkdir()
    (away / "old").write_bytes(b"old")
    for name in ("old", "none"):
        link = tmp_path / f"to-{name}"
        link.symlink_to(away / name)
        with whole_file(str(link)) as file:
            file.write(b"new")
            assert any(one.startswith(".vopd-") for one in names(away))
        assert link.is_symlink() and (away / name).read_bytes() == b"new"
    assert names(away) == ["none", "old"] and names(tmp_path) == ["away", "to-none", "to-old"]


def test_files_are_synchronised_but_for_those_with_a_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synchronised: list[int] = []
    monkeypatch.setattr(module.os, "fsync", synchronised.append)
    working = tmp_path / "work"
    working.mkdir()
    write(tmp_path / "a")
    assert len(synchronised) == 1
    with whole_file(str(tmp_path / "b"), str(working)) as file:
        file.write(b"new")
        assert len(names(working)) == 1
    assert len(synchronised) == 1 and (tmp_path / "b").read_bytes() == b"new"
    assert names(tmp_path) == ["a", "b", "work"] and names(working) == []


def test_standard_output_is_written_and_flushed(monkeypatch: pytest.MonkeyPatch) -> None:
    flushed: list[bytes] = []

    class Buffer(io.BytesIO):
        def flush(self) -> None:
            flushed.append(self.getvalue())

    monkeypatch.setattr(sys, "stdout", SimpleNamespace(buffer=Buffer()))
    write("-")
    assert flushed == [b"new"]


@posix
def test_a_device_and_a_pipe_are_written_as_they_are(tmp_path: Path) -> None:
    write("/dev/null")
    assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write(pipe)
        assert os.read(reader, 9) == b"new" and stat.S_ISFIFO(pipe.stat().st_mode)
    finally:
        os.close(reader)


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    for path, why in (
        (tmp_path / "none" / "a", "No such file or directory"),
        (tmp_path / "file" / "a", "Not a directory"),
        (tmp_path, "Is a directory"),
    ):
        with pytest.raises(OutputError) as raised:
            write(path)
        assert str(raised.value) == f"{path}: cannot be written: {why}"
    assert names(tmp_path) == ["file"]


@pytest.mark.parametrize("call", ["replace", "fsync"])
def test_a_failure_at_the_end_leaves_the_old_file_and_nothing_else(
    call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "a"
    path.write_bytes(b"old")
    monkeypatch.setattr(module.os, call, fail)
    with refused(OutputError):
        write(path)
    assert path.read_bytes() == b"old" and names(tmp_path) == ["a"]


@posix
def test_which_paths_are_plain_files(tmp_path: Path) -> None:
    plain, gone = tmp_path / "a", tmp_path / "gone"
    for path in (plain, gone):
        path.write_bytes(b"a")
    (tmp_path / "link").symlink_to(plain)
    status = file_status(str(plain))
    assert status and is_plain(str(plain), status) and is_plain(str(tmp_path / "link"), status)
    assert not is_plain(str(gone), status)  # another file has that name
    gone.unlink()
    assert not is_plain(str(gone), status) and file_status(str(gone)) is None
    for path in (str(tmp_path), "/dev/null"):
        found = file_status(path)
        assert found and not is_plain(path, found)
    with pytest.raises(NotADirectoryError):
        file_status(str(plain / "b"))
