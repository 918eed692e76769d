"""Which workers of a cluster are used, by the answers of a client that has no cluster behind it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from vopd.attitude.history import HistoryOptions
from vopd.batch.dask import Fleet
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.findings import VopdError
from vopd.pipeline import SolveOptions
from vopd.version import __version__


class Client:
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


def fleet(client: Client) -> tuple[Fleet, list[str]]:
    said: list[str] = []
    return Fleet(client, "tcp://a:1", said.append), said


def test_threads_of_all_workers() -> None:
    found, said = fleet(Client(dict.fromkeys("abc", __version__), threads=4))
    assert found.threads == 12 and found.fit() == {"a", "b", "c"}
    assert found.refused == {} and said == []


@pytest.mark.parametrize(
    ("versions", "message"),
    [
        ({}, "the cluster has no workers; start some first"),
        (
            {"a": __version__, "b": "0.0"},
            f"the worker b has vopd 0.0, and this is {__version__}; install the same on all",
        ),
        (
            {"a": ImportError("No module named 'vopd'"), "b": __version__},
            f"the worker a cannot import vopd: No module named 'vopd'; install vopd {__version__} "
            "on all workers",
        ),
    ],
)
def test_a_cluster_that_cannot_be_used(versions: dict[str, Any], message: str) -> None:
    with pytest.raises(VopdError) as refused:
        fleet(Client(versions))
    assert str(refused.value) == f"--dask tcp://a:1: {message}"


def test_a_worker_that_joins_later_is_refused_once() -> None:
    client = Client({"a": __version__})
    found, said = fleet(client)
    client.versions["b"] = "0.0"
    client.versions["c"] = __version__
    for _ in range(2):
        assert found.fit() == {"a", "c"}
        assert said == [
            f"--dask tcp://a:1: the worker b has vopd 0.0, and this is {__version__}; install the "
            "same on all; it is sent nothing more"
        ]
    assert [*found.refused] == ["b"]
    client.versions = {"b": __version__}  # with the same name again, it is not trusted
    with pytest.raises(VopdError, match=f"no worker with vopd {__version__} is left"):
        found.fit()


@pytest.mark.parametrize("unseen", ["folder", "source", None])
def test_folders_that_a_worker_does_not_see(unseen: str | None, tmp_path: Path) -> None:
    """The first source that is there is looked for; one that is nowhere is not."""
    client = Client({"a": __version__})
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
        named = f"the folder {tmp_path / 'out'}" if unseen == "folder" else f"the source {there}"
        with pytest.raises(VopdError, match=f"the worker a does not see {named}; leave the option"):
            found.check_folders(settings, sources)
