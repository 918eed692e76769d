"""A batch that is killed, at any moment and in any way, and then goes on, gives the same files."""

from __future__ import annotations

import errno
import os
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.batch import contents, end_process_at, loading, small_decks, start_batch, workers
from tests.kit.command import vopd
from vopd import files as whole_file
from vopd.batch import workers as processes
from vopd.batch.workers import in_processes

pytestmark = pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs /proc")
DECKS = 20


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return small_decks(tmp_path_factory.mktemp("inputs") / "in", DECKS)


@pytest.fixture(scope="module")
def undisturbed(inputs: Path) -> dict[str, bytes]:
    assert vopd("batch", inputs, "-d", inputs.parent / "one").status == 0
    return contents(inputs.parent / "one")


def until(is_so: Callable[[], Any]) -> Any:
    """Wait for something, a minute at most."""
    end = time.monotonic() + 60.0
    while not (found := is_so()):
        assert time.monotonic() < end
        time.sleep(0.002)
    return found


def listings(out: Path) -> int:
    return len(list(out.glob("*.lst")))


def gone(pid: int) -> bool:
    """Whether a process has ended; one that nobody has waited for is a zombie, Z."""
    try:
        return ") Z " in Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return True


def resumed(inputs: Path, out: Path) -> dict[str, bytes]:
    ran = vopd("batch", inputs, "-d", out, "--resume")
    assert ran.status == 0, ran.stderr
    return contents(out)


@pytest.mark.parametrize(
    ("jobs", "number", "written"),
    [
        ("1", signal.SIGTERM, 0),
        ("1", signal.SIGKILL, 7),
        ("2", signal.SIGTERM, 7),
        ("2", signal.SIGKILL, 0),
        ("2", signal.SIGKILL, 7),
    ],
)
def test_the_command_is_killed(
    jobs: str,
    number: signal.Signals,
    written: int,
    inputs: Path,
    undisturbed: dict[str, bytes],
    tmp_path: Path,
) -> None:
    """Its processes end with it, and the lock is free at once."""
    out = tmp_path / "out"
    with start_batch(inputs, "-d", out, "--jobs", jobs, place=tmp_path) as process:
        until(lambda: listings(out) >= written if written else (out / ".vopd-batch").exists())
        mine = until(lambda: workers(process.pid)) if jobs == "2" else []
        process.send_signal(number)
        assert process.wait(60) in (-number, 128 + number)
        assert not (out / "summary.jsonl").exists()
        until(lambda: all(map(gone, mine)))
    assert resumed(inputs, out) == undisturbed


@pytest.fixture
def noticed() -> Iterator[None]:
    """Control-C is not ignored here, also where the tests run in the background or under nohup."""
    kept = signal.signal(signal.SIGINT, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGINT, kept)


@pytest.mark.usefixtures("noticed")
def test_control_c_while_the_package_is_loaded(inputs: Path, tmp_path: Path) -> None:
    """A terminal sends it to all processes; the command ends, and the others say nothing."""
    with start_batch(inputs, "-d", tmp_path / "out", "--jobs", "2", place=tmp_path) as process:
        (loader,) = until(lambda: loading(process.pid))
        os.kill(loader, signal.SIGINT)
        time.sleep(0.1)
        os.kill(process.pid, signal.SIGINT)
        _, messages = process.communicate(timeout=60)
        assert (process.returncode, messages) == (130, "")
        until(lambda: gone(loader))


def test_a_process_of_the_batch_is_killed(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    """The batch goes on by itself and loses nothing."""
    out = tmp_path / "out"
    with start_batch(inputs, "-d", out, "--jobs", "2", place=tmp_path) as process:
        until(lambda: listings(out) >= 3)
        os.kill(workers(process.pid)[0], signal.SIGKILL)
        _, messages = process.communicate(timeout=120)
    assert process.returncode == 0, messages
    assert contents(out) == undisturbed


def test_a_chunk_that_kills_its_process_is_given_up() -> None:
    """All others are worked on, those that were taken together with it too."""
    done = in_processes(
        end_process_at, range(10, 18), 2, lambda chunk: [chunk], lambda chunk: -chunk
    )
    assert sorted(done) == sorted([-13, *(n * n for n in range(10, 18) if n != 13)])


def test_a_deck_that_kills_its_process_is_named(
    inputs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def give_up(
        _work: object, chunks: Any, _jobs: int, split: Callable[[Any], Any], given_up: Any
    ) -> Iterator[Any]:
        return (given_up(one) for chunk in chunks for one in split(chunk))

    monkeypatch.setattr(processes, "in_processes", give_up)
    decks = [inputs / f"deck{k:03d}.dat" for k in (0, 1)]
    ran = vopd("batch", *decks, "--jobs", "2", "-d", tmp_path / "out")
    assert ran.status == 1
    assert_approved(ran.stderr)


def test_a_full_disk(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whichever file it is noticed at, the command ends with its name, and can go on later."""
    out = tmp_path / "out"
    for left in (0, 5, 2 * DECKS):
        names = []

        def replace(one: str, other: str, left: int = left, names: list[str] = names) -> None:
            if len(names) == left:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            names.append(other)
            os.replace(one, other)  # noqa: PTH105

        changed = vars(os) | {"replace": replace}
        with monkeypatch.context() as patch:
            patch.setattr(whole_file, "os", SimpleNamespace(**changed))
            ran = vopd("batch", inputs, "-d", out, "--resume")
        assert ran.status == 1 and "No space left on device" in ran.stderr
        assert not (out / "summary.jsonl").exists()
    assert resumed(inputs, out) == undisturbed


def test_two_batches_in_one_folder(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    """The second is refused by name, also as a shard; the first does not notice."""
    out = tmp_path / "out"
    with start_batch(inputs, "-d", out, "--jobs", "2", place=tmp_path) as process:
        until(lambda: listings(out) >= 1)
        process.send_signal(signal.SIGSTOP)
        for options in ([], ["--resume"], ["--shard", "1/2"]):
            ran = vopd("batch", inputs, "-d", out, *options)
            assert ran.status == 1 and f"(process {process.pid} on " in ran.stderr
        process.send_signal(signal.SIGCONT)
        process.communicate(timeout=120)
    assert contents(out) == undisturbed


def test_three_shards_at_the_same_time(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    """One of them is killed: the others end without a summary, and it goes on."""
    out = tmp_path / "out"
    parts = [start_batch(inputs, "-d", out, "--shard", f"{k}/3", place=tmp_path) for k in (1, 2, 3)]
    until(lambda: (out / ".vopd-batch" / "2-of-3").exists())
    parts[1].kill()
    for part in parts:
        part.communicate(timeout=120)
    assert [part.returncode for part in parts] == [0, -signal.SIGKILL, 0]
    assert not (out / "summary.jsonl").exists()
    assert vopd("batch", inputs, "-d", out, "--shard", "2/3", "--resume").status == 0
    assert contents(out) == undisturbed


def test_a_line_of_the_journal_that_was_cut_short(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert vopd("batch", inputs, "-d", out, "--shard", "1/2").status == 0
    journal = out / ".vopd-batch" / "1-of-2.jsonl"
    journal.write_bytes(journal.read_bytes()[:-40])
    for part in ("2/2", "1/2"):
        ran = vopd("batch", inputs, "-d", out, "--shard", part, "--resume")
        assert ran.status == 0 and (out / "summary.jsonl").exists() == (part == "1/2")
    assert contents(out) == undisturbed


# In a made-up pool


class Late(Future[str]):
    """A future that is not done when another one is, and has its result when asked for it."""

    def __init__(self, text: str | None) -> None:
        super().__init__()
        self.text = text

    def result(self, timeout: float | None = None) -> str:
        if self.text is None:
            raise BrokenProcessPool
        return self.text


class MadeUpPool:
    """A pool that works at once, but for the chunks whose end is given."""

    def __init__(self, ends: dict[str, Future[str]]) -> None:
        self.ends = ends

    def submit(self, work: Callable[[str], str], chunk: str) -> Future[str]:
        if chunk in self.ends:
            return self.ends.pop(chunk)
        done: Future[str] = Future()
        done.set_result(work(chunk))
        return done


def broken() -> Future[str]:
    future: Future[str] = Future()
    future.set_exception(BrokenProcessPool())
    return future


def shout(chunk: str) -> str:
    return chunk.upper()


@pytest.mark.parametrize("others", [("late", "late"), ("late", "lost"), ("lost", "lost")])
@pytest.mark.parametrize("count", [3, 7])
def test_every_chunk_has_one_result(
    monkeypatch: pytest.MonkeyPatch, others: tuple[str, str], count: int
) -> None:
    """The first of three that are at work is lost; of the others some end well after that."""
    chunks = [f"{letter}{letter.upper()}" for letter in "abcdefg"[:count]]
    ends = {chunks[0]: broken()}
    for chunk, end in zip(chunks[1:3], others, strict=True):
        ends[chunk] = Late(shout(chunk) if end == "late" else None)
    pools: list[int] = []

    @contextmanager
    def pool(jobs: int) -> Iterator[MadeUpPool]:
        pools.append(jobs)
        yield MadeUpPool(ends)

    monkeypatch.setattr(processes, "_pool", pool)
    found = list(in_processes(shout, chunks, 2, lambda one: [one], lambda one: f"no {one}"))
    assert sorted(found) == sorted(map(shout, chunks)) and pools == [2, 1, 2]


def test_a_chunk_that_a_broken_pool_does_not_take_is_not_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A process may end between two chunks; nothing more is given to the pool after that."""
    refused: list[str] = []

    class Broken(MadeUpPool):
        def submit(self, work: Callable[[str], str], chunk: str) -> Future[str]:
            if chunk == "b" or refused:
                refused.append(chunk)
                raise BrokenProcessPool
            return super().submit(work, chunk)

    pools = iter((Broken({}), MadeUpPool({}), MadeUpPool({})))

    @contextmanager
    def pool(_: int) -> Iterator[MadeUpPool]:
        yield next(pools)

    monkeypatch.setattr(processes, "_pool", pool)
    found = list(in_processes(shout, list("abcde"), 2, lambda one: [one], lambda one: f"no {one}"))
    assert sorted(found) == list("ABCDE") and refused == ["b"]


def test_a_chunk_that_ends_its_process_twice_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """And a chunk of two is split: the one at fault is given up alone."""

    class Deadly(MadeUpPool):
        def submit(self, work: Callable[[str], str], chunk: str) -> Future[str]:
            if "x" in chunk:
                tried.append(chunk)
                return broken()
            return super().submit(work, chunk)

    @contextmanager
    def pool(_: int) -> Iterator[MadeUpPool]:
        yield Deadly({})

    tried: list[str] = []
    monkeypatch.setattr(processes, "_pool", pool)
    found = list(in_processes(shout, ["a", "bx", "c"], 2, list, lambda one: f"no {one}"))
    assert sorted(found) == ["A", "B", "C", "no x"]
    assert tried == ["bx", "x", "x"]
