"""A chunk that travels to another machine, without a cluster: what it holds, what comes back."""

from __future__ import annotations

import pickle
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from tests.kit.command import CASE_1, ROOT, vopd
from vopd.attitude.history import HistoryOptions
from vopd.batch.dask import can_travel, cluster_task, shared_task, solve_pickled, solve_task
from vopd.batch.folder import input_sha256
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.pipeline import SolveOptions

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
    task = pickle.dumps(cluster_task(sources, settings))
    shutil.rmtree(home)
    result = solve_pickled(task)
    outputs = dict(result.outputs)
    for name, content in expected.items():
        assert outputs.pop(name) == content
    assert not outputs and not [*(tmp_path / "out").rglob("*.csv")]
    flight, half, deck, broken, none = result.records
    assert [one.input_sha256 for one in result.records] == digests
    assert digests[4] == "" and len(set(digests)) == 5
    assert flight.status == half.status == deck.status == "solved"
    assert flight.frames > half.frames
    assert broken.error.splitlines() == error[:1]
    assert none.error == f"{home / 'none.dat'}: No such file or directory"
    assert [one.path for one in result.records] == [one.path for one in sources]


def test_a_task_in_a_file_system_that_is_shared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The paths are relative here and absolute there; errors name them as they were given."""
    sources, settings = given(tmp_path)
    monkeypatch.chdir(tmp_path)
    sources = [one._replace(path=str(Path(one.path).relative_to(tmp_path))) for one in sources]
    task = shared_task(sources, replace(settings, folder="out", working="out/w"))
    monkeypatch.chdir(ROOT)
    result = solve_task(task)
    assert result.outputs == {}
    out = tmp_path / "out"
    written = {path.relative_to(out).as_posix() for path in out.rglob("*.*")}
    assert written == {"hill/flight.csv", "half/flight.csv", "case1.lst", "case1.csv"}
    _, _, deck, broken, none = result.records
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
