"""`vopd batch --dask` on a scheduler and two workers that run as processes on this machine."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from tests.kit.batch import contents, mixed_sources, small_decks
from tests.kit.command import CASE_1, ROOT, vopd

pytestmark = [
    pytest.mark.skipif(find_spec("distributed") is None, reason="needs dask.distributed"),
    pytest.mark.cluster,
]
ENVIRONMENT = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), *filter(None, sys.path)])}


class Cluster:
    """A scheduler, and workers that can be added and killed."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.processes: list[subprocess.Popen[bytes]] = []
        self._file = place / "scheduler.json"
        options = ("--port", "0", "--host", "127.0.0.1", "--no-dashboard", "--no-show")
        self._start("dask_scheduler", *options, "--scheduler-file", str(self._file))
        until(self._file.exists)

    @property
    def address(self) -> str:
        import json

        return str(json.loads(self._file.read_text())["address"])

    def worker(self, path: Path = ROOT) -> subprocess.Popen[bytes]:
        """A worker that imports the package from a folder."""
        options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--memory-limit", "0")
        before = self._workers()
        process = self._start("dask_worker", self.address, *options, path=path)
        until(lambda: self._workers() > before)
        return process

    def _workers(self) -> int:
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            return len(client.nthreads())

    def _start(self, program: str, *options: str, path: Path = ROOT) -> subprocess.Popen[bytes]:
        paths = [str(path), *(one for one in sys.path if one and one != str(ROOT))]
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{program}", *options],
            cwd=self.place, env=ENVIRONMENT | {"PYTHONPATH": os.pathsep.join(paths)},
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.processes.append(process)
        return process

    def close(self) -> None:
        """End all of it."""
        for process in self.processes:
            process.kill()
            process.wait(30)


def until(is_so: Callable[[], Any]) -> None:
    end = time.monotonic() + 60.0
    while not is_so():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    place = tmp_path / "cluster"
    place.mkdir()
    made = Cluster(place)
    yield made
    made.close()


def batch(*arguments: str | Path) -> tuple[int, str]:
    """`vopd batch` in a process of its own: dask leaves threads behind in one."""
    ran = subprocess.run(
        [sys.executable, "-m", "vopd", "batch", *map(str, arguments)],
        env=ENVIRONMENT, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    return ran.returncode, ran.stderr


def test_the_same_bytes_as_one_process(cluster: Cluster, tmp_path: Path) -> None:
    """Decks and flights, those that fail too; one project has a file in another folder."""
    inputs = mixed_sources(tmp_path / "in")
    shutil.move(inputs / "hill" / "track.csv", inputs / "track.csv")
    project = inputs / "hill" / "flight.toml"
    project.write_text(project.read_text().replace('"track.csv"', '"../track.csv"'))
    cluster.worker()
    cluster.worker()
    assert vopd("batch", inputs, "-d", tmp_path / "one").status == 3
    status, messages = batch(inputs, "-d", tmp_path / "out", "--dask", cluster.address)
    assert status == 3, messages
    assert contents(tmp_path / "out") == contents(tmp_path / "one")
    status, messages = batch(inputs, "-d", tmp_path / "out", "--dask", cluster.address, "--resume")
    assert status == 3 and contents(tmp_path / "out") == contents(tmp_path / "one")


def test_the_same_bytes_in_a_shared_file_system(cluster: Cluster, tmp_path: Path) -> None:
    """The workers run in another folder than the command, which names all by relative paths."""
    inputs = mixed_sources(tmp_path / "in")
    (inputs / "second.dat").symlink_to(tmp_path / "nowhere")
    cluster.worker()
    cluster.worker()
    commands = (("one",), ("out", "--dask", cluster.address, "--shared-filesystem"))
    for options in commands:
        ran = subprocess.run(
            [sys.executable, "-m", "vopd", "batch", "in", "-d", *options],
            cwd=tmp_path, env=ENVIRONMENT, capture_output=True, text=True, timeout=120,
        )  # fmt: skip
        assert ran.returncode == 3, ran.stderr
    assert contents(tmp_path / "out") == contents(tmp_path / "one")


def test_an_output_that_a_worker_cannot_write_ends_the_batch(
    cluster: Cluster, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    (out / "case1.lst").mkdir(parents=True)
    cluster.worker()
    shared = ("--dask", cluster.address, "--shared-filesystem")
    status, messages = batch(CASE_1, "-d", out, *shared)
    assert status == 1 and "case1.lst: cannot be written" in messages
    assert "Traceback" not in messages


def refused_later(cluster: Cluster, tmp_path: Path, other: Path) -> str:
    """What is said of a worker that joins during a batch; all sources are solved."""
    good = cluster.worker()
    running = begun(cluster, tmp_path)
    good.send_signal(signal.SIGSTOP)  # so that there is work left
    bad = cluster.worker(other)
    good.send_signal(signal.SIGCONT)
    _, messages = running.communicate(timeout=120)
    assert running.returncode == 0 and "Traceback" not in messages, messages
    assert vopd("batch", tmp_path / "in", "-d", tmp_path / "one").status == 0
    assert contents(tmp_path / "out") == contents(tmp_path / "one")
    bad.kill()
    return messages


def test_a_worker_of_another_version_joins_later(cluster: Cluster, tmp_path: Path) -> None:
    other = tmp_path / "other"
    shutil.copytree(ROOT / "vopd", other / "vopd")
    (other / "vopd" / "version.py").write_text('"""Another."""\n\n__version__ = "0.0.1"\n')
    messages = refused_later(cluster, tmp_path, other)
    assert messages.count("has vopd 0.0.1") == 1 and "it is sent nothing more" in messages


def test_a_worker_without_the_package_joins_later(cluster: Cluster, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "vopd.py").write_text("raise ImportError('no such package here')\n")
    messages = refused_later(cluster, tmp_path, other)
    assert messages.count("cannot import vopd: no such package here") == 1


def begun(cluster: Cluster, tmp_path: Path) -> subprocess.Popen[str]:
    """A batch from `in` to `out` whose first task has come back; several are left."""
    inputs = small_decks(tmp_path / "in", 60)
    for project in range(12):  # each is a task by itself
        shutil.copytree(ROOT / "examples" / "hill", inputs / f"hill{project}")
    out = tmp_path / "out"
    running = subprocess.Popen(
        [sys.executable, "-m", "vopd", "batch", inputs, "-d", out, "--dask", cluster.address],
        env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    until(lambda: list(out.rglob("*.csv")))
    assert running.poll() is None and not (out / "summary.jsonl").exists()
    return running


def test_a_worker_is_killed(cluster: Cluster, tmp_path: Path) -> None:
    """What it was solving is solved by the other."""
    cluster.worker()
    killed = cluster.worker()
    running = begun(cluster, tmp_path)
    killed.send_signal(signal.SIGKILL)
    _, messages = running.communicate(timeout=120)
    assert running.returncode == 0, messages
    assert vopd("batch", tmp_path / "in", "-d", tmp_path / "one").status == 0
    assert contents(tmp_path / "out") == contents(tmp_path / "one")


def test_the_scheduler_is_killed(cluster: Cluster, tmp_path: Path) -> None:
    """The command says so, and goes on later, here without a cluster."""
    worker = cluster.worker()
    running = begun(cluster, tmp_path)
    worker.send_signal(signal.SIGSTOP)  # so that it does not end before
    cluster.processes[0].kill()
    _, messages = running.communicate(timeout=120)
    assert running.returncode == 1 and "the scheduler was lost" in messages
    assert "Traceback" not in messages
    assert vopd("batch", tmp_path / "in", "-d", tmp_path / "out", "--resume").status == 0
    assert vopd("batch", tmp_path / "in", "-d", tmp_path / "one").status == 0
    assert contents(tmp_path / "out") == contents(tmp_path / "one")


def greet(server: socket.socket) -> None:
    """Answer as a server of the web does, or of shells: dask takes the first bytes for a size."""
    with suppress(OSError):
        while True:
            caller, _ = server.accept()
            with caller:
                caller.sendall(b"HTTP/1.0 400 Bad Request\r\n\r\n")


def test_no_scheduler_no_workers_another_version(cluster: Cluster, tmp_path: Path) -> None:
    """Each is one message, and no folder is made."""
    out = tmp_path / "out"

    def refused(address: str) -> str:
        status, messages = batch(CASE_1, "-d", out, "--dask", address)
        assert status == 1 and not out.exists() and "Traceback" not in messages
        return messages

    assert "no scheduler answers" in refused("tcp://127.0.0.1:9")
    with socket.create_server(("127.0.0.1", 0)) as other_server:
        Thread(target=greet, args=(other_server,), daemon=True).start()
        port = other_server.getsockname()[1]
        assert "no scheduler answers" in refused(f"tcp://127.0.0.1:{port}")
    for address in ("nonsense", "tcp://127.0.0.1:99999", "mail://127.0.0.1:9"):
        assert "not an address such as" in refused(address)
    assert "the cluster has no workers" in refused(cluster.address)
    other = tmp_path / "other"
    shutil.copytree(ROOT / "vopd", other / "vopd")
    (other / "vopd" / "version.py").write_text('"""Another."""\n\n__version__ = "0.0.1"\n')
    worker = cluster.worker(other)
    assert "has vopd 0.0.1" in refused(cluster.address)
    worker.kill()
    worker.wait(30)
    shutil.rmtree(other / "vopd")
    (other / "vopd.py").write_text("raise ImportError('no such package here')\n")
    until(lambda: cluster._workers() == 0)
    cluster.worker(other)
    assert "cannot import vopd" in refused(cluster.address)


@pytest.mark.parametrize("unseen", ["out", "in"])
def test_a_worker_that_does_not_see_a_folder(cluster: Cluster, tmp_path: Path, unseen: str) -> None:
    """Its Python is told so, in place of another machine where the folder is not mounted."""
    inputs, out = small_decks(tmp_path / "in", 3), tmp_path / "out"
    other = tmp_path / "other"
    other.mkdir()
    (other / "vopd").symlink_to(ROOT / "vopd")
    (other / "sitecustomize.py").write_text(
        "import os\n"
        "stat = os.stat\n"
        "def of_others(path, *args, **options):\n"
        f"    if str(path).startswith({str(tmp_path / unseen)!r}):\n"
        "        raise FileNotFoundError(2, 'No such file or directory', str(path))\n"
        "    return stat(path, *args, **options)\n"
        "os.stat = of_others\n"
    )
    cluster.worker()
    cluster.worker(other)
    shared = ("--dask", cluster.address, "--shared-filesystem")
    status, messages = batch(inputs, "-d", out, *shared)
    assert status == 1 and "Traceback" not in messages
    assert "does not see" in messages and str(tmp_path / unseen) in messages
    assert not [one for one in out.rglob("*") if one.is_file()]
    status, messages = batch(inputs, "-d", out, "--dask", cluster.address)
    assert status == 0, messages  # bytes travel instead


def test_a_shared_file_system_is_one_of_a_cluster(tmp_path: Path) -> None:
    ran = vopd("batch", CASE_1, "-d", tmp_path / "out", "--shared-filesystem")
    assert ran.status == 2 and "is for --dask" in ran.stderr


def test_jobs_and_dask_exclude_each_other(tmp_path: Path) -> None:
    ran = vopd("batch", CASE_1, "-d", tmp_path / "out", "--dask", "x", "--jobs", "2")
    assert ran.status == 2
