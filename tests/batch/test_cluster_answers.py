"""Tasks sent to a cluster and what comes of each answer, by a client without a cluster."""

from __future__ import annotations

import pickle
import sys
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from vopd.attitude.history import HistoryOptions
from vopd.batch import dask as cluster_task
from vopd.batch import dask as dask_cluster
from vopd.batch import run as runs
from vopd.batch.dask import ClusterResult, ClusterTask
from vopd.batch.folder import FAILED, SOLVED, SourceRecord
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.pipeline import SolveOptions
from vopd.version import __version__

SETTINGS = BatchSettings("out", "out/.w", SolveOptions(), HistoryOptions())
Answers = Callable[[tuple[str, ...], "list[str] | None"], Any]


class Future:
    def __init__(self, key: int, answer: Any) -> None:
        self.key = key
        self.answer = answer

    def cancelled(self) -> bool:
        return self.answer is None

    def exception(self) -> BaseException | None:
        return self.answer if isinstance(self.answer, BaseException) else None

    def result(self) -> Any:
        return self.answer


class Client:
    """Answers each task at once; remembers the tasks and to which workers they may go."""

    loop = "the loop"

    def __init__(self, answers: Answers) -> None:
        self.answers = answers
        self.sent: list[tuple[tuple[str, ...], list[str] | None]] = []
        self.tasks: list[ClusterTask] = []
        self.versions: dict[str, Any] = {"a": __version__}
        self.most_waiting = self.waiting = 0
        self.closed = False
        self.looked_for: list[Path] = []

    def close(self) -> None:
        self.closed = True

    def nthreads(self) -> dict[str, int]:
        return dict.fromkeys(self.versions, 3)

    def run(self, function: object, asked: Any, on_error: str) -> dict[str, Any]:
        if function is eval:
            return dict(self.versions)
        self.looked_for.append(asked)
        return dict.fromkeys(self.versions, True)

    def submit(
        self, function: object, text: str, given: dict[str, bytes], **options: Any
    ) -> Future:
        assert function is eval and options["pure"] is False
        assert text == "__import__('vopd.batch.dask').batch.dask.solve_pickled(task)"
        task = pickle.loads(given["task"])
        names = tuple(one.name for one in task.sources)
        self.tasks.append(task)
        self.sent.append((names, options["workers"]))
        self.waiting += 1
        self.most_waiting = max(self.most_waiting, self.waiting)
        return Future(len(self.sent), self.answers(names, options["workers"]))


class Completed:
    def __init__(self, futures: list[Future], loop: object) -> None:
        assert loop == "the loop"
        self.queue = deque(futures)

    def add(self, future: Future) -> None:
        self.queue.append(future)

    def __iter__(self) -> Iterator[Future]:
        while self.queue:
            CLIENT[0].waiting -= 1
            yield self.queue.popleft()


CLIENT: list[Client] = []


def solved(names: tuple[str, ...], version: str = __version__) -> ClusterResult:
    records = [SourceRecord(one, f"{one}.dat", SOLVED, "", "", version, "") for one in names]
    return ClusterResult(records, {f"{one}.lst": b"page" for one in names})


def run(
    monkeypatch: pytest.MonkeyPatch, answers: Answers, *chunks: str, shared: bool = False
) -> tuple[Client, list[tuple[str, Any]], list[str]]:
    """The client, the answers by the names of their sources, and what was warned of."""
    client = Client(answers)
    CLIENT[:] = [client]
    module = ModuleType("distributed")
    module.__file__ = "distributed.py"
    module.as_completed = Completed  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "distributed", module)
    monkeypatch.setattr(dask_cluster, "client_of", lambda address: client)
    said: list[str] = []
    pieces = [[BatchSource(f"{name}.dat", name, 1) for name in chunk] for chunk in chunks]
    found = [
        ("".join(one.name for one in sources), answer)
        for sources, answer in dask_cluster.in_cluster("t:1", pieces, SETTINGS, shared, said.append)
    ]
    assert client.closed
    return client, found, said


def test_every_chunk_is_sent_and_answered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two tasks for each of three threads are ahead; each answer makes room for one more."""
    chunks = [chr(97 + k) for k in range(20)]
    client, found, said = run(monkeypatch, lambda names, _: solved(names), *chunks)
    assert [name for name, _ in found] == chunks and said == []
    assert client.sent == [((name,), None) for name in chunks]
    assert client.most_waiting == 6 and client.looked_for == []
    assert all(task.settings == SETTINGS and task.locations is None for task in client.tasks)


def test_a_shared_file_system_is_looked_at_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then tasks name sources and folders by their whole paths, the first chunk among them."""
    client, found, _ = run(monkeypatch, lambda names, _: solved(names), "ab", "c", shared=True)
    assert [name for name, _ in found] == ["ab", "c"]
    assert client.looked_for == [Path("out/.w").absolute()]
    first = client.tasks[0]
    assert first.locations == {f"{one}.dat": str(Path(f"{one}.dat").absolute()) for one in "ab"}
    assert (first.settings.folder, first.settings.working) == tuple(
        str(Path(one).absolute()) for one in ("out", "out/.w")
    )
    assert first.files == ()


def test_a_chunk_that_is_lost_is_taken_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """By itself a source that is lost again is given up, with the kind of the error."""

    def answers(names: tuple[str, ...], _: object) -> Any:
        return RuntimeError("worker lost") if "b" in names else solved(names)

    client, found, said = run(monkeypatch, answers, "ab", "cd", "b")
    assert [names for names, _ in client.sent] == [("a", "b"), ("c", "d"), ("b",), ("a",), ("b",)]
    given = {name: answer for name, answer in found if name != "b"}
    assert sorted(given) == ["a", "cd"] and said == []
    assert [answer for name, answer in found if name == "b"] == ["RuntimeError: worker lost"] * 2


def test_what_ends_the_whole_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(OutputError, match=r"^out/a\.lst: no space$"):
        run(monkeypatch, lambda *_: OutputError("out/a.lst: no space"), "ab", "c")
    with pytest.raises(VopdError) as lost:
        run(monkeypatch, lambda *_: None, "a")
    assert str(lost.value) == (
        "--dask t:1: the scheduler was lost; give --resume to go on when it is there again"
    )
    assert CLIENT[0].closed


@pytest.mark.parametrize("old", ["0.0.1", None])
def test_a_worker_without_this_version_is_sent_nothing_more(
    monkeypatch: pytest.MonkeyPatch, old: str | None
) -> None:
    """What it was sent is sent again, and tasks go to the others alone from then on."""

    odd = [RuntimeError("odd")]  # an error of a worker that is fit is an answer

    def answers(names: tuple[str, ...], workers: list[str] | None) -> Any:
        if names == ("b",) and workers is None:
            CLIENT[0].versions["x"] = old or ImportError("no vopd")
            return solved(names, old) if old else ImportError("no vopd")
        if names == ("i",) and workers is not None and odd:
            return odd.pop()
        return solved(names)

    chunks = "abcdefghij"
    client, found, said = run(monkeypatch, answers, *chunks)
    assert sorted(name for name, _ in found) == list(chunks)
    given = dict(found)
    assert given.pop("i") == "RuntimeError: odd"
    assert all(answer.records[0].version == __version__ for answer in given.values())
    ahead = [((name,), None) for name in chunks[:7]]
    again = [((name,), ["a"]) for name in ("b", *chunks[7:])]
    assert client.sent == [*ahead, *again]
    assert len(said) == 1 and "the worker x " in said[0]


def test_an_error_of_a_worker_that_is_fit_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    client, found, said = run(monkeypatch, lambda *_: ValueError("odd"), "a")
    assert found == [("a", "ValueError: odd")] and len(client.sent) == 1 and said == []


def test_a_task_is_solved_from_its_files_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Each source in a folder of its own, with folders below; errors name what was given."""
    read: dict[str, str] = {}

    def solve(sources: Any, given: BatchSettings, earlier: Any, locations: Any) -> Any:
        assert earlier == {} and not Path(given.folder).samefile(tmp_path)
        records = []
        for one in sources:
            path = Path(locations.get(one.path, one.path))
            for file in sorted(path.parent.rglob("*.*")) if one.path in locations else []:
                read[f"{one.name} {file.relative_to(path.parent).as_posix()}"] = file.read_text()
            (Path(given.folder) / f"{one.name}.lst").write_text(one.name)
            records.append(
                SourceRecord(one.name, one.path, SOLVED, f"{path}: odd", "", "", "",
                             outputs={f"{one.name}.lst": ""})
            )  # fmt: skip
        return records

    monkeypatch.setattr(cluster_task, "solve_chunk", solve)
    sources = [BatchSource(f"in/{name}/x.dat", name, 1) for name in "abc"]
    files = {"x.dat": b"deck a", "sub/deep/p.csv": b"picks"}, {"x.dat": b"deck b"}, {}
    given = BatchSettings(str(tmp_path), str(tmp_path), SolveOptions(), HistoryOptions())
    result = cluster_task.solve_task(ClusterTask(tuple(sources), given, files))
    assert read == {"a x.dat": "deck a", "a sub/deep/p.csv": "picks", "b x.dat": "deck b"}
    assert [one.error for one in result.records] == [f"in/{name}/x.dat: odd" for name in "abc"]
    assert result.outputs == {f"{name}.lst": name.encode() for name in "abc"}


# What a batch makes of the answers


def batch(
    monkeypatch: pytest.MonkeyPatch, folder: Path, answers: dict[str, Any], *, shared: bool = False
) -> tuple[list[SourceRecord], list[Any], dict[str, Any]]:
    """The records of sources a to d, of which d cannot travel and c is known from before."""
    settings = BatchSettings(str(folder), str(folder / "w"), SolveOptions(), HistoryOptions())
    (folder / "w").mkdir(parents=True)
    (folder / "old.csv").write_text("")
    sources = [BatchSource(f"{name}.dat", name, 1) for name in "abcd"]
    before = {
        name: SourceRecord(name, f"{name}.dat", SOLVED, "", "", "", "", outputs={"old.csv": ""})
        for name in "acd"
    }
    asked: dict[str, Any] = {}

    def in_cluster(address: str, pieces: Any, given: Any, shared: bool, warn: Any) -> Any:
        chunks = [*pieces]
        asked.update(address=address, chunks=chunks, shared=shared, warn=warn, settings=given)
        return [(chunk, answers[one.name]) for chunk in chunks for one in chunk[:1]]

    def here(chunk: Any, given: Any, earlier: Any) -> Any:
        asked["here"] = [one.name for one in chunk], earlier
        return [SourceRecord(one.name, one.path, SOLVED, "here", "", "", "") for one in chunk]

    monkeypatch.setattr(dask_cluster, "in_cluster", in_cluster)
    monkeypatch.setattr(dask_cluster, "can_travel", lambda one: one.name != "d")
    monkeypatch.setattr(runs, "unchanged", lambda *_: [before["c"]])
    monkeypatch.setattr(runs, "solve_chunk", here)
    kept: list[Any] = []
    done: list[int] = []
    holder: Any = type("Folder", (), {"keep": staticmethod(kept.append)})
    records = runs.run_batch(
        sources, settings, holder, before, done.append, dask="t:1", shared=shared, warn=done.append
    )
    assert sum(done) == 4 and [one for some in kept for one in some] != []
    assert asked["address"] == "t:1" and asked["shared"] is shared
    assert asked["settings"] == settings and asked["warn"] == done.append
    assert asked.get("here", (["d"], before)) == (["d"], before)
    return records, kept, asked


def test_answers_become_files_and_records(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    records, kept, asked = batch(monkeypatch, tmp_path / "out", {"a": solved(("a", "b"))})
    assert [[one.name for one in chunk] for chunk in asked["chunks"]] == [["a", "b"]]
    assert [(one.source, one.error) for one in records] == [
        ("a", ""), ("b", ""), ("c", ""), ("d", "here"),
    ]  # fmt: skip
    out = tmp_path / "out"
    assert (out / "a.lst").read_bytes() == (out / "b.lst").read_bytes() == b"page"
    assert not (out / "old.csv").exists()  # an output that a has not written again
    assert [len(some) for some in kept] == [2, 1, 1]


def test_an_answer_that_is_an_error_fails_its_sources(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    records, *_ = batch(monkeypatch, tmp_path / "out", {"a": "RuntimeError: lost"})
    assert [(one.source, one.status, one.error) for one in records[:2]] == [
        (name, FAILED, f"{name}.dat: RuntimeError: lost") for name in "ab"
    ]
    assert records[2].status == SOLVED


def test_all_sources_go_to_machines_that_share_their_files(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    answer = {"a": solved(("a", "b", "d"))}
    records, _, asked = batch(monkeypatch, tmp_path / "out", answer, shared=True)
    assert [[one.name for one in chunk] for chunk in asked["chunks"]] == [["a", "b", "d"]]
    assert "here" not in asked and [one.source for one in records] == list("abcd")
