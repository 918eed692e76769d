"""The output folder of a batch in every state: new, in use, of another batch, after a kill."""

from __future__ import annotations

import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from tests.approved.texts import assert_approved, refused
from vopd.batch import folder as folder_lock
from vopd.batch.folder import SOLVED, BatchFolder, FolderLock, Records, SourceRecord
from vopd.batch.sources import BatchSource
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.version import __version__

RECORD = SourceRecord("a", "a.dat", SOLVED, "", "", __version__, "{}", frames=1)


def hidden(folder: Path) -> Path:
    return folder / ".vopd-batch"


def written(path: Path, *records: SourceRecord) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"".join(one.line() for one in records))


@contextmanager
def held(folder: Path, name: str) -> Iterator[FolderLock]:
    """Another process has this lock: a file that is opened anew stands for one."""
    lock = FolderLock(hidden(folder) / name)
    assert lock.acquire()
    yield lock
    lock.release()


def begin(
    folder: Path, shard: tuple[int, int], resume: bool = False, options: str = "{}"
) -> Records:
    with BatchFolder(str(folder), *shard).begun(resume, options) as records:
        return dict(records)


def refusal(folder: Path, shard: tuple[int, int], resume: bool = False, options: str = "{}") -> str:
    with pytest.raises(VopdError) as refusal:
        begin(folder, shard, resume, options)
    return str(refusal.value).removeprefix(f"{folder}: ")


def test_what_is_there_while_it_works_and_what_is_left(tmp_path: Path) -> None:
    """A folder that was not there is removed where nothing was written, others stay."""
    for name, there, output, left in (
        ("new", False, False, False), ("new2", False, True, True), ("old", True, False, True),
    ):  # fmt: skip
        folder = tmp_path / name
        if there:
            folder.mkdir()
        one = BatchFolder(str(folder), 2, 3)
        assert one.working == hidden(folder) / "2-of-3" and one.folder == folder
        with one.begun(False, "{}") as records:
            assert records == {}
            inside = sorted(path.name for path in hidden(folder).iterdir())
            assert inside == ["2-of-3", "2-of-3.lock"] and not [*one.working.iterdir()]
            (one.working / "temporary").write_text("")
            if output:
                (folder / "a.lst").write_text("")
        assert folder.exists() == left and not hidden(folder).exists()


def test_temporary_files_of_a_killed_run_are_removed(tmp_path: Path) -> None:
    left = hidden(tmp_path) / "1-of-1" / "deep"
    left.mkdir(parents=True)
    (left / "half").write_text("")
    one = BatchFolder(str(tmp_path))
    with one.begun(True, "{}"):
        assert one.working.is_dir() and not [*one.working.iterdir()]


def test_a_file_and_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    assert_approved(refusal(file, (1, 1)))
    inside = refusal(file / "out", (1, 1))
    assert_approved(inside)
    with pytest.raises(OutputError):
        begin(file, (1, 1))
    with pytest.raises(OutputError):
        begin(file / "out", (1, 1))


@pytest.mark.parametrize(
    ("lock", "busy"),
    [("2-of-3.lock", True), ("1-of-3.lock", False), ("3-of-3.lock", False), ("1-of-2.lock", True),
     ("2-of-13.lock", True), ("1-of-1.lock", True)],
)  # fmt: skip
def test_which_locks_of_others_keep_a_shard_out(lock: str, busy: bool, tmp_path: Path) -> None:
    """Its own, and those of a batch with another number of shards, while their owner lives."""
    with held(tmp_path, lock):
        if not busy:
            begin(tmp_path, (2, 3))
            return
        me = f"process {os.getpid()} on {socket.gethostname()}"
        said = refusal(tmp_path, (2, 3))
        assert me in said
        assert_approved(said.replace(me, "(its owner)"))
    (hidden(tmp_path) / lock).write_text("process 1 on a machine that has ended it")
    begin(tmp_path, (2, 3))


def test_the_owner_of_a_lock_is_written_over_the_one_before(tmp_path: Path) -> None:
    path = hidden(tmp_path) / "lock"
    path.parent.mkdir()
    path.write_text("process 123456789 on " + "x" * 99)
    with held(tmp_path, "lock") as lock:
        assert path.read_text() == f"process {os.getpid()} on {socket.gethostname()}\n"
        other = FolderLock(path)
        assert other.owner() == path.read_text().strip() and lock.held and not other.held
    path.write_text(" \n")
    assert FolderLock(path).owner() == "another process"


OTHER = replace(RECORD, source="b", version="0.0.1")


@pytest.mark.parametrize("file", ["summary.jsonl", ".vopd-batch/2-of-3.jsonl"])
@pytest.mark.parametrize("records", [(OTHER,), (RECORD, OTHER), (OTHER, RECORD)])
@pytest.mark.parametrize("resume", [False, True])
def test_records_of_another_version(
    file: str, records: tuple[SourceRecord, ...], resume: bool, tmp_path: Path
) -> None:
    """One of them is enough, also where the run is to go on."""
    written(tmp_path / file, *records)
    assert_approved(refusal(tmp_path, (1, 3), resume))


@pytest.mark.parametrize(
    ("file", "taken"),
    [("summary.jsonl", True), (".vopd-batch/1-of-3.jsonl", True),
     (".vopd-batch/2-of-3.jsonl", False), (".vopd-batch/1-of-2.jsonl", True),
     (".vopd-batch/2-of-13.jsonl", True)],
)  # fmt: skip
def test_what_a_batch_that_does_not_go_on_finds(file: str, taken: bool, tmp_path: Path) -> None:
    """Other shards of the same batch may have begun; with `--resume` all may be there."""
    written(tmp_path / file, RECORD)
    assert begin(tmp_path, (1, 3), resume=True) == {"a": RECORD}
    if taken:
        assert_approved(refusal(tmp_path, (1, 3)))
    else:
        assert begin(tmp_path, (1, 3)) == {"a": RECORD}


@pytest.mark.parametrize("text", ["", "not a record\n"])
def test_a_run_goes_on_where_the_one_before_has_no_record(text: str, tmp_path: Path) -> None:
    (tmp_path / "summary.jsonl").write_text(text)
    assert begin(tmp_path, (1, 1), resume=True) == {}
    assert_approved(refusal(tmp_path, (1, 1)))


def test_all_shards_have_the_same_options(tmp_path: Path) -> None:
    unlike = replace(RECORD, source="b", options='{"report": true}')
    written(hidden(tmp_path) / "2-of-3.jsonl", RECORD, unlike)
    assert_approved(refusal(tmp_path, (1, 3)))
    assert begin(tmp_path, (1, 3), resume=True) == {"a": RECORD, "b": unlike}
    written(hidden(tmp_path) / "2-of-3.jsonl", RECORD)
    assert begin(tmp_path, (1, 3)) == {"a": RECORD}
    assert_approved(refusal(tmp_path, (1, 3), options='{"x": 1}'))


def test_a_journal_is_added_to_and_a_line_cut_short_spoils_no_other(tmp_path: Path) -> None:
    """Words of an error may have any character but a newline in them as they are."""
    strange = replace(RECORD, source="b", error="one\u2028two\x85three\x0c\n\udcff")
    file = hidden(tmp_path) / "1-of-1.jsonl"
    file.parent.mkdir()
    file.write_bytes(RECORD.line() + b'{"source": "cut sh')
    one = BatchFolder(str(tmp_path))
    with one.begun(True, "{}"):
        one.keep([strange])
        one.keep([replace(RECORD, source="c"), replace(RECORD, source="d")])
    assert file.read_bytes().startswith(RECORD.line())
    with file.open("ab") as more:
        more.write(b'\n\xff\xfe broken\n{"source": 3}\n[]\n')
    names = {"a": RECORD, "b": strange}
    names |= {name: replace(RECORD, source=name) for name in "cd"}
    assert begin(tmp_path, (1, 1), resume=True) == names


def test_a_journal_that_cannot_be_written(tmp_path: Path) -> None:
    file = hidden(tmp_path) / "1-of-1.jsonl"
    one = BatchFolder(str(tmp_path))
    with one.begun(False, "{}"):
        file.mkdir()
        with refused(OutputError, parts=[file]):
            one.keep([RECORD])
        file.rmdir()


@pytest.mark.parametrize(
    "text",
    ["", "not JSON", "[1]", '{"source": "a"}', '{"seconds": 1}', "3",
     '{"source": "a", "seconds": NaN}', '{"source": "a", "seconds": "x"}', "[" * 9999,
     '{"source": "a", "seconds": 1e300}'],
)  # fmt: skip
def test_times_that_cannot_be_read_are_not_known(text: str, tmp_path: Path) -> None:
    written(tmp_path / "summary.jsonl", replace(RECORD, seconds=0.0))
    good = json.dumps({"source": "a", "seconds": 2.5})
    (tmp_path / "times.jsonl").write_text(text)
    assert begin(tmp_path, (1, 1), resume=True)["a"].seconds == 0.0
    (tmp_path / "times.jsonl").write_text(f"{good}\n{text or 'x'}\n")
    assert begin(tmp_path, (1, 1), resume=True)["a"].seconds == 2.5


@pytest.mark.parametrize("name", ["summary.jsonl", "times.jsonl", ".vopd-batch/1-of-1.jsonl"])
def test_a_pipe_in_the_place_of_records_is_not_read(name: str, tmp_path: Path) -> None:
    """`--resume` waited for it without an end."""
    pipe = tmp_path / name
    pipe.parent.mkdir(exist_ok=True)
    try:
        os.mkfifo(pipe)
    except (AttributeError, OSError):
        pytest.skip("no pipes with names here")
    if name == "times.jsonl":
        assert begin(tmp_path, (1, 1), resume=True) == {}
    else:
        assert_approved(refusal(tmp_path, (1, 1), resume=True))


PLAN = [BatchSource(f"{name}.dat", name, 1) for name in ("b", "a", "c")]


def ended(
    folder: Path, shard: tuple[int, int], options: str = "{}"
) -> tuple[bool, list[str] | None, bool]:
    """Whether it was the last, what the summary was written of, and whether its lock was free."""
    rows: list[str] | None = None

    def write(records: list[SourceRecord]) -> None:
        nonlocal rows
        rows = [one.source for one in records]

    one = BatchFolder(str(folder), *shard)
    with one.begun(True, options):
        last = one.finish(PLAN, options, write)
        free = not (hidden(folder) / "{}-of-{}.lock".format(*shard)).exists()
    return last, rows, free


def test_the_last_shard_writes_the_summary_in_the_order_of_the_plan(tmp_path: Path) -> None:
    written(hidden(tmp_path) / "1-of-2.jsonl", *(replace(RECORD, source=one) for one in "ac"))
    assert ended(tmp_path, (2, 2)) == (False, None, True)
    written(hidden(tmp_path) / "2-of-2.jsonl", *(replace(RECORD, source=one) for one in "xb"))
    with held(tmp_path, "1-of-2.lock"):
        assert ended(tmp_path, (2, 2)) == (False, None, True)
    assert ended(tmp_path, (2, 2), '{"x": 1}') == (False, None, True)
    assert sorted(path.name for path in hidden(tmp_path).glob("*")) == [
        "1-of-2.jsonl", "2-of-2.jsonl",
    ]  # fmt: skip
    assert ended(tmp_path, (2, 2)) == (True, ["b", "a", "c"], False)
    assert not hidden(tmp_path).exists() and tmp_path.exists()


def test_one_record_with_other_options_keeps_the_summary_back(tmp_path: Path) -> None:
    some = [replace(RECORD, source=one) for one in "ab"]
    unlike = replace(RECORD, source="c", options='{"x": 1}')
    written(hidden(tmp_path) / "1-of-1.jsonl", *some, unlike)
    assert ended(tmp_path, (1, 1)) == (False, None, True)


def test_beginning_waits_for_another_that_begins_or_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The lock of all shards is waited for, up to a minute in naps of a twentieth of a second."""
    naps: list[float] = []
    other = FolderLock(hidden(tmp_path) / "lock")
    assert other.acquire()

    def nap(seconds: float) -> None:
        naps.append(seconds)
        if len(naps) == 3:
            other.release()

    monkeypatch.setattr("time.sleep", nap)
    assert begin(tmp_path, (1, 1)) == {}
    assert naps == [0.05] * 3


def test_a_shard_that_waits_in_vain_for_another_does_not_work_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(folder_lock, "WAIT_S", 0.0)
    me = f"process {os.getpid()} on {socket.gethostname()}"
    with held(tmp_path, "lock"):
        said = refusal(tmp_path, (1, 2))
    assert me in said
    assert_approved(said.replace(me, "(its owner)"))
    assert begin(tmp_path, (1, 2)) == {}  # and leaves nothing that keeps it out later


# Locks

Locks = tuple[FolderLock, FolderLock]


@pytest.fixture
def two(tmp_path: Path) -> Iterator[Locks]:
    """The same lock twice: each opens the file anew, so that one process stands for two."""
    first, second = FolderLock(tmp_path / "lock"), FolderLock(tmp_path / "lock")
    yield first, second
    first.release()
    second.release()


@pytest.fixture
def naps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The clock stands still but for naps, which are noted and take no time."""
    slept: list[float] = []
    monkeypatch.setattr(time, "sleep", slept.append)
    monkeypatch.setattr(time, "monotonic", lambda: 1000.0 + sum(slept))
    return slept


def test_a_lock_that_is_held_is_refused_at_once(two: Locks, naps: list[float]) -> None:
    first, second = two
    assert first.acquire() and first.held
    assert not second.acquire() and not second.held
    assert second.held_by_another() and naps == []


def test_a_wait_ends_after_a_minute(two: Locks, naps: list[float]) -> None:
    first, second = two
    assert first.acquire()
    assert not second.acquire(wait=True) and not second.held
    assert 60.0 <= sum(naps) < 61.0


def test_a_wait_ends_when_the_lock_is_free(two: Locks, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = two
    assert first.acquire()
    monkeypatch.setattr(time, "sleep", lambda _: first.release())
    assert second.acquire(wait=True) and second.held and not first.held


def test_the_owner_is_named_and_nothing_is_left_behind(tmp_path: Path) -> None:
    lock, other = FolderLock(tmp_path / "new" / "lock"), FolderLock(tmp_path / "new" / "lock")
    assert lock.acquire()
    assert other.owner().startswith(f"process {os.getpid()} on ")
    lock.release()
    assert not lock.held and not lock.path.exists()
    assert not other.held_by_another() and not lock.path.exists()
    assert other.owner() == "another process"
    lock.release()  # a second time does nothing


@pytest.mark.parametrize("again", [False, True])
def test_a_file_that_its_owner_has_removed_is_no_lock(
    again: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between opening and locking it; a third process may have made it again by then."""
    lock, locked, removed = FolderLock(tmp_path / "lock"), folder_lock._locked, []

    def late(file: object) -> bool:
        if not removed:
            removed.append(lock.path)
            lock.path.unlink()
            if again:
                lock.path.write_text("another's")
        return locked(file)

    monkeypatch.setattr(folder_lock, "_locked", late)
    assert not lock.acquire() and not lock.held and removed
    assert lock.acquire() and lock.held and lock.path.exists()
    lock.release()
    assert not lock.path.exists()
