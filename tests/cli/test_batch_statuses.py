"""How a batch ends, what it says of failed sources, and what it is run with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from vopd.attitude.sigmas import Sigmas
from vopd.cli import batch as solve_batch
from vopd.cli.options import HistoryOptions
from vopd.pipeline import SolveOptions

USUAL = HistoryOptions(SolveOptions(), Sigmas(), None, None, strict=False, quiet=False)
STRICT = replace(USUAL, strict=True)
Said = pytest.CaptureFixture[str]


def record(status: str, flagged: int = 0, error: str = "") -> Any:
    return SimpleNamespace(status=status, flagged=flagged, error=error)


GOOD, FLAGGED, LOST = record("solved"), record("solved", 1), record("not converged", 1)
FAILED = record("failed", error="a: wrong")
MORE = "{} more sources failed; summary.jsonl says why"
BATCHES: list[tuple[list[Any], bool, int, list[str]]] = [
    ([], False, 0, []),
    ([], True, 0, []),
    ([GOOD], True, 0, []),
    ([FLAGGED, GOOD], False, 0, []),
    ([FLAGGED, GOOD], True, 3, []),
    ([GOOD, LOST], False, 3, []),
    ([GOOD, FAILED], False, 3, ["a: wrong"]),
    ([LOST, FAILED], False, 3, ["a: wrong"]),
    ([FAILED], False, 1, ["a: wrong"]),
    ([FAILED] * 20, False, 1, ["a: wrong"] * 20),
    ([FAILED] * 21, True, 1, ["a: wrong"] * 20 + [MORE.format(1)]),
    ([GOOD, *[FAILED] * 45], False, 3, ["a: wrong"] * 20 + [MORE.format(25)]),
]


@pytest.mark.parametrize(("records", "strict", "status", "said"), BATCHES)
def test_the_status_of_a_batch(
    records: list[Any], strict: bool, status: int, said: list[str], capsys: Said
) -> None:
    assert solve_batch._status(records, STRICT if strict else USUAL) == status
    ended = capsys.readouterr()
    assert (ended.out, ended.err.splitlines()) == ("", said)


@pytest.mark.parametrize(("quiet", "last"), [(False, True), (False, False), (True, False)])
def test_a_part_of_a_batch_says_that_it_is_finished(
    quiet: bool, last: bool, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    monkeypatch.setattr(solve_batch, "find_sources", lambda *_: [])
    monkeypatch.setattr(solve_batch, "_run", lambda *_: ([], last))
    monkeypatch.setattr(solve_batch, "summary_text", lambda _: "the summary\n")
    request = solve_batch.BatchRequest(
        ("a.dat",), None, "out", (2, 10), 1, ("csv",), False, None, False, False
    )
    assert solve_batch.solve_batch(request, replace(USUAL, quiet=quiet)) == 0
    ended = capsys.readouterr()
    told = "part 2 of 10 is finished; the part that ends last writes out/summary.jsonl\n"
    assert (ended.out, ended.err) == ("the summary\n", "" if quiet or last else told)


@pytest.mark.parametrize("dask", [None, "tcp://a:1"])
@pytest.mark.parametrize(("shared", "resume"), [(False, True), (True, False)])
def test_what_a_batch_is_run_with(
    dask: str | None,
    shared: bool,
    resume: bool,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Any,
    capsys: Said,
) -> None:
    """The sources of this part only, counted by them; the records of an earlier run."""
    (tmp_path / "out").mkdir()
    given: list[Any] = []
    monkeypatch.setattr(solve_batch, "write_summary", lambda *one: given.append(one))
    monkeypatch.setattr(solve_batch, "run_batch", lambda *one: given.append(one) or ["r"])
    monkeypatch.setattr(
        solve_batch, "Progress",
        lambda unit, total: given.append((unit, total)) or SimpleNamespace(add="add", close=print),
    )  # fmt: skip

    class Place:
        shard = SimpleNamespace(part=lambda plan: plan[1::2])

        def begun(self, *asked: object) -> Any:
            given.append(asked)
            return Begun()

        def finish(self, plan: Any, options: str, write: Callable[..., None]) -> bool:
            given.append((plan, options))
            write(["all rows"])
            return True

    class Begun:
        def __enter__(self) -> str:
            return "earlier"

        def __exit__(self, *_: object) -> None:
            pass

    request = solve_batch.BatchRequest((), None, "", (1, 2), 5, (), False, dask, shared, resume)
    settings: Any = SimpleNamespace(options="options")
    plan: Any = ["a", "b", "c", "d", "e"]
    place: Any = Place()
    assert solve_batch._run(plan, settings, place, request) == (["r"], True)
    assert given.pop() == (settings, ["all rows"])
    begun, progress, (mine, with_settings, where, *rest, cluster), finished = given
    assert begun == (resume, "options") and progress == ("sources", 2)
    assert (mine, with_settings, where) == (["b", "d"], settings, place)
    assert rest == ["earlier", 5, "add"] and finished == (plan, "options")
    if dask is None:
        assert cluster is None
        return
    assert (cluster.address, cluster.shared) == (dask, shared)
    cluster.warn("a worker is refused")
    assert capsys.readouterr().err == "a worker is refused\n"
