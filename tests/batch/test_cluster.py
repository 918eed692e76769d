"""Tasks sent to a cluster and what comes of each answer, by a client without a cluster."""

from __future__ import annotations

import logging
import pickle
import shutil
import sys
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, ROOT, vopd
from vopd.attitude.history import HistoryOptions
from vopd.batch import workers as dask_cluster
from vopd.batch.folder import SOLVED, SourceRecord
from vopd.batch.sources import BatchSettings, BatchSource, input_sha256
from vopd.batch.workers import (
    Fleet,
    can_travel,
    client_of,
    cluster_task,
    shared_task,
    solve_pickled,
)
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
        self.tasks: list[Any] = []
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
        assert text == "__import__('vopd.batch.workers').batch.workers.solve_pickled(task)"
        task = pickle.loads(given["task"])
        names = tuple(one.name for one in task[0])
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


def solved(names: tuple[str, ...], version: str = __version__) -> Any:
    records = [SourceRecord(one, f"{one}.dat", SOLVED, "", "", version, "") for one in names]
    return records, {f"{one}.lst": b"page" for one in names}


def run(
    monkeypatch: pytest.MonkeyPatch, answers: Answers, *chunks: str, shared: bool = False
) -> tuple[Client, list[tuple[str, Any]], list[str]]:
    """The client, the errors by the names of their sources, and what was warned of."""
    client = Client(answers)
    CLIENT[:] = [client]
    module = ModuleType("distributed")
    module.__file__ = "distributed.py"
    module.as_completed = Completed  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "distributed", module)
    monkeypatch.setattr(dask_cluster, "client_of", lambda address: client)
    said: list[str] = []
    pieces = [[BatchSource(f"{name}.dat", name, 1) for name in chunk] for chunk in chunks]
    written: list[str] = []
    monkeypatch.setattr(
        "vopd.batch.folder.write_output", lambda settings, name, content: written.append(name)
    )
    found = [
        ("".join(one.source for one in records), "\n".join(one.error for one in records).strip())
        for records in dask_cluster.in_cluster("t:1", pieces, SETTINGS, shared, said.append)
    ]
    answered = [one for names, error in found if not error for one in names]
    assert written == [f"{name}.lst" for name in answered]
    assert client.closed
    return client, found, said


def test_every_chunk_is_sent_and_answered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two tasks for each of three threads are ahead; each answer makes room for one more."""
    chunks = [chr(97 + k) for k in range(20)]
    client, found, said = run(monkeypatch, lambda names, _: solved(names), *chunks)
    assert [name for name, _ in found] == chunks and said == []
    assert client.sent == [((name,), None) for name in chunks]
    assert client.most_waiting == 6 and client.looked_for == []
    assert all(task[1] == SETTINGS and isinstance(task[2], list) for task in client.tasks)


def test_a_shared_file_system_is_looked_at_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then tasks name sources and folders by their whole paths, the first chunk among them."""
    client, found, _ = run(monkeypatch, lambda names, _: solved(names), "ab", "c", shared=True)
    assert [name for name, _ in found] == ["ab", "c"]
    assert client.looked_for == [Path("out/.w").absolute()]
    _, settings, locations = client.tasks[0]
    assert locations == {f"{one}.dat": str(Path(f"{one}.dat").absolute()) for one in "ab"}
    assert (settings.folder, settings.working) == tuple(
        str(Path(one).absolute()) for one in ("out", "out/.w")
    )


def test_a_chunk_that_is_lost_is_taken_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """By itself a source that is lost again is given up, with the kind of the error."""

    def answers(names: tuple[str, ...], _: object) -> Any:
        return RuntimeError("worker lost") if "b" in names else solved(names)

    client, found, said = run(monkeypatch, answers, "ab", "cd", "b")
    assert [names for names, _ in client.sent] == [("a", "b"), ("c", "d"), ("b",), ("a",), ("b",)]
    given = {name: answer for name, answer in found if name != "b"}
    assert sorted(given) == ["a", "cd"] and said == []
    lost = [answer for name, answer in found if name == "b"]
    assert lost == ["b.dat: RuntimeError: worker lost"] * 2


def test_what_ends_the_whole_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    with refused(OutputError):
        run(monkeypatch, lambda *_: OutputError("out/a.lst: no space"), "ab", "c")
    with refused(VopdError):
        run(monkeypatch, lambda *_: None, "a")
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
    assert given.pop("i") == "i.dat: RuntimeError: odd"
    assert not any(given.values())
    ahead = [((name,), None) for name in chunks[:7]]
    again = [((name,), ["a"]) for name in ("b", *chunks[7:])]
    assert client.sent == [*ahead, *again]
    assert len(said) == 1 and "the worker x " in said[0]


def test_an_error_of_a_worker_that_is_fit_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    client, found, said = run(monkeypatch, lambda *_: ValueError("odd"), "a")
    assert found == [("a", "a.dat: ValueError: odd")] and len(client.sent) == 1 and said == []


def test_a_task_is_solved_from_its_files_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Each source in a folder of its own, with folders below; errors name what was given."""
    read: dict[str, str] = {}

    def solve(sources: Any, given: BatchSettings, locations: Any) -> Any:
        assert not Path(given.folder).samefile(tmp_path)
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

    monkeypatch.setattr("vopd.batch.solve.solve_chunk", solve)
    sources = [BatchSource(f"in/{name}/x.dat", name, 1) for name in "abc"]
    files = {"x.dat": b"deck a", "sub/deep/p.csv": b"picks"}, {"x.dat": b"deck b"}, {}
    given = BatchSettings(str(tmp_path), str(tmp_path), SolveOptions(), HistoryOptions())
    records, outputs = dask_cluster.solve_pickled(pickle.dumps((sources, given, files)))
    assert read == {"a x.dat": "deck a", "a sub/deep/p.csv": "picks", "b x.dat": "deck b"}
    assert [one.error for one in records] == [f"in/{name}/x.dat: odd" for name in "abc"]
    assert outputs == {f"{name}.lst": name.encode() for name in "abc"}


# What a batch makes of the answers


def batch(
    monkeypatch: pytest.MonkeyPatch, folder: Path, *, shared: bool = False
) -> tuple[list[SourceRecord], list[Any], list[list[str]]]:
    """The records of sources a to d, of which d cannot travel and c is known from before."""
    settings = BatchSettings(str(folder), str(folder / "w"), SolveOptions(), HistoryOptions())
    (folder / "w").mkdir(parents=True)
    (folder / "old.csv").write_text("")
    sources = [BatchSource(f"{name}.dat", name, 1) for name in "abcd"]
    before = {
        name: SourceRecord(name, f"{name}.dat", SOLVED, "", "", "", "", outputs={"old.csv": ""})
        for name in "acd"
    }
    sent: list[list[str]] = []

    def in_cluster(address: str, pieces: Any, given: Any, on_files: bool, warn: Any) -> Any:
        assert (address, given, on_files, warn) == ("t:1", settings, shared, done.append)
        for chunk in pieces:
            sent.append([one.name for one in chunk])
            yield solved(tuple(sent[-1]))[0]

    def here(chunk: Any, given: Any) -> Any:
        return [SourceRecord(one.name, one.path, SOLVED, "here", "", "", "") for one in chunk]

    monkeypatch.setattr(dask_cluster, "in_cluster", in_cluster)
    monkeypatch.setattr(dask_cluster, "can_travel", lambda one: one.name != "d")
    monkeypatch.setattr("vopd.batch.folder.unchanged", lambda *_: [before["c"]])
    monkeypatch.setattr("vopd.batch.solve.solve_chunk", here)
    kept: list[Any] = []
    done: list[int] = []
    holder: Any = type("Folder", (), {"keep": staticmethod(kept.append)})
    records = dask_cluster.run_batch(
        sources, settings, holder, before, done.append, dask="t:1", shared=shared, warn=done.append
    )
    assert sum(done) == 4
    return records, kept, sent


def test_a_source_that_cannot_travel_is_solved_here(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    records, kept, sent = batch(monkeypatch, tmp_path / "out")
    assert sent == [["a", "b"]]
    assert [(one.source, one.error) for one in records] == [
        ("a", ""), ("b", ""), ("c", ""), ("d", "here"),
    ]  # fmt: skip
    assert not (tmp_path / "out" / "old.csv").exists()  # an output that a has not written again
    assert [len(some) for some in kept] == [1, 2, 1]


def test_all_sources_go_to_machines_that_share_their_files(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    records, _, sent = batch(monkeypatch, tmp_path / "out", shared=True)
    assert sent == [["a", "b", "d"]] and [one.source for one in records] == list("abcd")


# Tasks

HILL = ROOT / "examples" / "hill"


def given(folder: Path) -> tuple[list[BatchSource], BatchSettings]:
    """Two flights with files of the same names, a deck, one that breaks off, and one not there."""
    home = folder / "in"
    for name in ("hill", "half"):
        shutil.copytree(HILL, home / name)
    picks = (home / "half" / "picks.csv").read_text().splitlines()
    (home / "half" / "picks.csv").write_text("\n".join(picks[:20]))
    shutil.copy(CASE_1, home / "case1.dat")
    (home / "broken.dat").write_text("\n".join(CASE_1.read_text().splitlines()[:30]))
    names = ("hill/flight.toml", "half/flight.toml", "case1.dat", "broken.dat", "none.dat")
    sources = [BatchSource(str(home / name), name.rpartition(".")[0], 1) for name in names]
    (folder / "out" / "w").mkdir(parents=True)
    out = folder / "out"
    return sources, BatchSettings(str(out), str(out / "w"), SolveOptions(), HistoryOptions())


def test_the_outputs_of_a_task_that_travels(tmp_path: Path) -> None:
    """The sources are gone when it is solved; errors name the files that were given."""
    sources, settings = given(tmp_path)
    home = tmp_path / "in"
    expected = {
        f"{one.name}.csv": vopd("attitude", one.path, "-q").output for one in sources[:3]
    } | {"case1.lst": vopd("run", home / "case1.dat", "-q").output}
    digests = [input_sha256(one.path) for one in sources]
    error = vopd("attitude", home / "broken.dat", "-q").stderr.splitlines()
    task = cluster_task(sources, settings)
    shutil.rmtree(home)
    records, outputs = solve_pickled(task)
    for name, content in expected.items():
        assert outputs.pop(name) == content
    assert not outputs and not [*(tmp_path / "out").rglob("*.csv")]
    flight, half, deck, broken, none = records
    assert [one.input_sha256 for one in records] == digests
    assert digests[4] == "" and len(set(digests)) == 5
    assert flight.status == half.status == deck.status == "solved"
    assert flight.frames > half.frames
    assert broken.error.splitlines() == error[:1]
    assert none.error == f"{home / 'none.dat'}: No such file or directory"
    assert [one.path for one in records] == [one.path for one in sources]


def test_a_task_in_a_file_system_that_is_shared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The paths are relative here and absolute there; errors name them as they were given."""
    sources, settings = given(tmp_path)
    monkeypatch.chdir(tmp_path)
    sources = [one._replace(path=str(Path(one.path).relative_to(tmp_path))) for one in sources]
    task = shared_task(sources, replace(settings, folder="out", working="out/w"))
    monkeypatch.chdir(ROOT)
    records, outputs = solve_pickled(task)
    assert outputs == {}
    out = tmp_path / "out"
    written = {path.relative_to(out).as_posix() for path in out.rglob("*.*")}
    assert written == {"hill/flight.csv", "half/flight.csv", "case1.lst", "case1.csv"}
    _, _, deck, broken, none = records
    assert deck.path == "in/case1.dat" and deck.input_sha256 == input_sha256(str(CASE_1))
    assert broken.error.startswith("in/broken.dat: ")
    assert none.error == "in/none.dat: No such file or directory"


@pytest.mark.parametrize(
    ("picks", "travels"),
    [
        ("picks.csv", True),
        ("sub/picks.csv", True),
        ("../picks.csv", False),
        ("/picks.csv", False),
        ("sub/../../picks.csv", False),
    ],
)
def test_a_project_whose_files_are_elsewhere_does_not_travel(
    picks: str, travels: bool, tmp_path: Path
) -> None:
    home = tmp_path / "p"
    (home / "sub").mkdir(parents=True)
    name = str(tmp_path / "picks.csv") if picks[0] == "/" else picks
    (home / name).write_text("")
    (home / "flight.toml").write_text(f'[picks]\nfile = "{name}"\n')
    assert can_travel(BatchSource(str(home / "flight.toml"), "p", 1)) is travels
    assert can_travel(BatchSource(str(tmp_path / "none.toml"), "p", 1))
    assert can_travel(BatchSource(str(CASE_1), "p", 1))


# Workers that are used


class WorkersOnly:
    """Workers with as many threads and this version each; an exception where it has no package."""

    def __init__(self, versions: dict[str, Any], threads: int = 2) -> None:
        self.versions = versions
        self.threads = threads
        self.seen: dict[str, Any] = {}
        self.looked_for: list[Path] = []

    def nthreads(self) -> dict[str, int]:
        return dict.fromkeys(self.versions, self.threads)

    def run(self, function: object, asked: Any, on_error: str) -> dict[str, Any]:
        assert on_error == "return"
        if function is eval:
            assert eval(asked) == __version__
            return dict(self.versions)
        assert function is Path.exists
        self.looked_for.append(asked)
        return {worker: self.seen.get(str(asked), True) for worker in self.versions}


def fleet(client: WorkersOnly) -> tuple[Fleet, list[str]]:
    said: list[str] = []
    return Fleet(client, "tcp://a:1", said.append), said


def test_threads_of_all_workers() -> None:
    found, said = fleet(WorkersOnly(dict.fromkeys("abc", __version__), threads=4))
    assert found.threads == 12 and found.fit() == {"a", "b", "c"}
    assert found.refused == {} and said == []


@pytest.mark.parametrize(
    "versions",
    [
        {},
        {"a": __version__, "b": "0.0"},
        {"a": ImportError("No module named 'vopd'"), "b": __version__},
    ],
)
def test_a_cluster_that_cannot_be_used(versions: dict[str, Any]) -> None:
    with refused(VopdError):
        fleet(WorkersOnly(versions))


def test_a_worker_that_joins_later_is_refused_once() -> None:
    client = WorkersOnly({"a": __version__})
    found, said = fleet(client)
    client.versions["b"] = "0.0"
    client.versions["c"] = __version__
    for _ in range(2):
        assert found.fit() == {"a", "c"}
        assert_approved(said, parts=[__version__])
    assert [*found.refused] == ["b"]
    client.versions = {"b": __version__}  # with the same name again, it is not trusted
    with refused(VopdError):
        found.fit()


@pytest.mark.parametrize("unseen", ["folder", "source", None])
def test_folders_that_a_worker_does_not_see(unseen: str | None, tmp_path: Path) -> None:
    """The first source that is there is looked for; one that is nowhere is not."""
    client = WorkersOnly({"a": __version__})
    found, _ = fleet(client)
    working, there = tmp_path / "out" / "w", tmp_path / "b.dat"
    later = tmp_path / "c.dat"
    for path in (there, later):
        path.write_text("")
    paths = [tmp_path / "none.dat", there, later, tmp_path / "out"]
    settings = BatchSettings(str(tmp_path / "out"), str(working), SolveOptions(), HistoryOptions())
    sources = [BatchSource(str(path), "x", 0) for path in paths]
    if unseen is None:
        found.check_folders(settings, sources)
        assert client.looked_for == [working, there]
        return
    for answer in (False, PermissionError("no")):
        client.seen = {str(working if unseen == "folder" else there): answer}
        with refused(VopdError):
            found.check_folders(settings, sources)


# Addresses


@pytest.mark.parametrize(
    ("address", "answer"),
    [
        ("10.0.0.1:1", "no scheduler answers at this address"),
        ("10.0.0.1:65535", "no scheduler answers at this address"),
        ("tls://10.0.0.1:65535", "no scheduler answers at this address"),
        ("10.0.0.1:0", "not an address such as tcp://10.0.0.1:8786"),
        ("10.0.0.1:65536", "not an address such as tcp://10.0.0.1:8786"),
        ("ucx://10.0.0.1:8786", "not an address such as tcp://10.0.0.1:8786"),
        ("tcp://10.0.0.1:65536", "not an address such as tcp://10.0.0.1:8786"),
        ("10.0.0.1", "not an address such as tcp://10.0.0.1:8786"),
    ],
)
def test_ports_of_an_address_from_both_sides(
    address: str, answer: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A port is 1 to 65535; `distributed` is asked only for one of these."""
    asked: list[str] = []

    def client(given: str, **options: object) -> None:
        asked.append(given)
        assert options == {"timeout": 10, "set_as_default": False}
        raise OSError

    def host_port(whole: str, strict: bool) -> tuple[str, int]:
        assert strict and whole == (address if "://" in address else f"tcp://{address}")
        if whole.startswith("ucx"):
            raise NotImplementedError
        host, _, port = whole.partition("://")[2].partition(":")
        return host, int(port)

    modules = {"distributed": {"Client": client}, "distributed.comm": {}}
    modules["distributed.comm.addressing"] = {"get_address_host_port": host_port}
    for name, values in modules.items():
        module = ModuleType(name)
        vars(module).update(values, __file__=f"{name}.py")
        monkeypatch.setitem(sys.modules, name, module)
    silenced: list[int] = []
    monkeypatch.setattr(logging, "disable", silenced.append)
    with refused(VopdError, parts=[address]):
        client_of(address)
    assert asked == ([address] if answer.startswith("no scheduler") else [])
    assert silenced == [logging.CRITICAL]


def test_without_distributed_its_name_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with refused(VopdError):
        client_of("tcp://10.0.0.1:8786")
