"""`--cluster`: Dask workers replace local processes; the results are equal, even after a worker was killed."""

from __future__ import annotations

import importlib.util
import json
import logging
import os
import socket
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path
from platform import python_version
from threading import Event, Thread, Timer
from types import SimpleNamespace

import pytest

from periph_sim.interfaces.reports import cluster as of
from periph_sim.interfaces.reports import cluster_worker
from periph_sim.interfaces.reports.cluster_worker import Session
from tests.interfaces.commands.conftest import Run

needs_dask = pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None, reason="the extra dask is not installed: pip install -e '.[dask]'"
)
CASE = """\
name = "small"
duration = "5 us"

[unit.dsp]
firmware = "mine.py"
modules = ["SCI-A"]
[unit.dsp.settings]
dies = false

[host]
frames = 1
period = "40 us"

[[budget]]
name = "work"
measure = "span:work"
max = "{limit}"
"""
# Each run adds a line to the file `runs`: the worker's process and its own. A run waits in the process of the worker
# that the file `hold` names, if this process has made two runs before.
FIRMWARE = """\
import os
import time
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent


@dataclass
class Settings:
    dies: bool


def main(dsp, settings):
    print("said by the firmware")
    mine = f"{os.getppid()} {os.getpid()}\\n"
    with open(HERE / "runs", "a+") as runs:
        runs.seek(0)
        before = runs.read().count(mine)
        runs.write(mine)
    if before >= 2 and str(os.getppid()) in (HERE / "hold").read_text().split():
        (HERE / f"held {os.getppid()}").touch()
        while True:
            time.sleep(60)
    settings.dies and os._exit(3)
    with dsp.span("work"):
        dsp.compute(150)
"""
PROVE = ("prove", "small.toml", "--phases", "0 us to 10 us", "--step", "1", "--json")  # 1500 phases: 3 parts
MOST = 60.0  # seconds; a process that does not answer by then fails the test
Process = subprocess.Popen[bytes]


class Cluster:
    """A scheduler and two workers on loopback, each with one thread and without a nanny."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.ended: list[Process] = []
        self.file = folder / "scheduler.json"
        self.log = (folder / "log").open("wb")
        self.workers: list[Process] = []

    def start(self) -> None:
        self.scheduler = self._start("dask_scheduler", "--port", "0")
        wait_for(lambda: self.file.exists() and self.file.read_text().endswith("}"))
        self.address: str = json.loads(self.file.read_text())["address"]

    def with_workers(self, count: int) -> Cluster:
        """Start workers in place of those that a test has killed."""
        self.workers = [worker for worker in self.workers if worker.poll() is None]
        options = ("--nthreads", "1", "--no-nanny", "--local-directory", str(self.folder))
        self.workers += [self._start("dask_worker", *options) for _ in range(count - len(self.workers))]
        wait_for(self._has_these_workers)
        return self

    def _has_these_workers(self) -> bool:
        """True if exactly these workers are registered: one that registers later might get no part."""
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            try:
                return {*client.run(os.getpid).values()} == {worker.pid for worker in self.workers}
            except OSError:  # a worker that was killed is still registered
                return False

    def _start(self, what: str, *options: str) -> Process:
        common = ("--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(self.file))
        started = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{what}", *common, *options], stdout=self.log, stderr=self.log
        )
        self.ended.append(started)
        return started

    def end(self) -> None:
        for process in reversed(self.ended):
            process.kill()
            process.wait()
        self.log.close()


def wait_for(is_true: Callable[[], bool]) -> None:
    until = time.monotonic() + MOST
    while not is_true():
        assert time.monotonic() < until
        time.sleep(0.02)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    found = Cluster(tmp_path_factory.mktemp("cluster"))
    try:
        found.start()
        yield found
    finally:
        found.end()


@pytest.fixture
def case(here: Path) -> Path:
    (here / "mine.py").write_text(FIRMWARE, encoding="utf-8")
    (here / "small.toml").write_text(CASE.format(limit="30 us"), encoding="utf-8")
    (here / "runs").touch()
    (here / "hold").touch()
    return here


def workers_of(folder: Path) -> Counter[int]:
    """Return the number of runs in the processes of each worker."""
    return Counter(int(line.split()[0]) for line in (folder / "runs").read_text().splitlines())


@needs_dask
@pytest.mark.parametrize(
    "arguments",
    [
        (
            "sweep",
            "small.toml",
            "--vary",
            "unit.dsp.settings.dies=false, true, 7",
            "--json",
        ),
        ("check", "small.toml", "broken.toml", "dying.toml", "--json"),
    ],
    ids=["sweep", "check"],
)
def test_results_are_those_without_a_cluster(
    case: Path, cluster: Cluster, periph_sim: Run, arguments: tuple[str, ...]
) -> None:
    """Firmware that ends its process fails its own run or case only."""
    (case / "broken.toml").write_text(CASE.format(limit="0.5 us"), encoding="utf-8")
    (case / "dying.toml").write_text(CASE.format(limit="30 us").replace("false", "true"), encoding="utf-8")
    alone = periph_sim(*arguments, "--jobs", "2")
    (case / "runs").write_text("")
    outcome = periph_sim(*arguments, "--cluster", cluster.with_workers(2).address)
    assert outcome.json_object == alone.json_object and outcome.status == alone.status != 0
    assert workers_of(case).keys() <= {worker.pid for worker in cluster.workers} and workers_of(case)


@needs_dask
def test_a_changed_case_is_read_again_by_the_same_workers(case: Path, cluster: Cluster, periph_sim: Run) -> None:
    verdicts = []
    for limit in ("30 us", "0.5 us"):
        (case / "small.toml").write_text(CASE.format(limit=limit), encoding="utf-8")
        outcome = periph_sim(
            "prove", "small.toml", "--phases", "0 us to 1 us", "--json", "--cluster", cluster.with_workers(1).address
        )
        verdicts.append(outcome.json_object["budgets"]["work"]["verdict"])
    assert verdicts == ["held", "broken"]


@needs_dask
def test_a_worker_with_another_version_is_refused(
    case: Path, cluster: Cluster, periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of, "package_digest", lambda: "0" * 32)
    sweep = ("sweep", "small.toml", "--vary", "seed=1", "--cluster", cluster.with_workers(1).address)
    who = f"a worker of the Dask scheduler at {cluster.address}"
    why = "has another version of periph_sim than this command; install the same"
    assert periph_sim.refused(*sweep) == f"{who} {why}"
    monkeypatch.setattr(of, "CALL", of.CALL.replace("cluster_worker", "of_later"))
    why = "cannot run this command (No module named 'periph_sim.interfaces.reports.of_later')"
    assert periph_sim.refused(*sweep) == f"{who} {why}; install the same version of periph_sim there"


def test_a_worker_with_another_python_is_refused() -> None:
    session = Session("", "", {}, "3.9.1", of.package_digest())
    assert cluster_worker._why_refused(session).endswith(", and this command runs in Python 3.9.1; use the same")
    assert not cluster_worker._why_refused(replace(session, python=python_version()))


class OneThread:
    """A client of Dask whose scheduler and worker are a thread of this process."""

    scheduler = SimpleNamespace(ncores=None)

    def get_executor(self, pure: bool) -> ThreadPoolExecutor:
        self.pool = ThreadPoolExecutor(1)
        return self.pool

    def sync(self, call: object, callback_timeout: float) -> dict[str, int]:
        return {"here": 1}

    def close(self, timeout: float) -> None:
        self.pool.shutdown()


def test_the_executor_passes_all_arguments() -> None:
    with closing(of.ClusterExecutor(OneThread(), "here")) as executor:
        assert executor.submit(sorted, [1, 3, 2], reverse=True).result(MOST) == [3, 2, 1]
        assert executor.submit(sorted, [1, 3, 2]).result(MOST) == [1, 2, 3]
        assert [*executor.map(pow, [2, 3], [3, 2])] == [8, 9]


@contextmanager
def when_held(
    case: Path, cluster: Cluster, workers: Sequence[Process], act: Callable[[], object], monkeypatch: pytest.MonkeyPatch
) -> Iterator[None]:
    """Call `act` when each of these workers waits in its third part and the results of all other begun parts arrived.

    A part has 25 phases and is one run. There are many parts, so that every worker gets a third one on a busy machine.
    """
    come: list[of.ClusterExecutor] = []
    ended = Event()
    settle = of.ClusterExecutor._settle
    monkeypatch.setattr(of.ClusterExecutor, "_settle", lambda *one: (settle(*one), come.append(one[0])))
    monkeypatch.setattr("periph_sim.interfaces.reports.coverage.PART", 25)
    (case / "runs").write_text("")
    (case / "hold").write_text(" ".join(str(worker.pid) for worker in workers))

    def is_held() -> bool:
        begun = sum(workers_of(case)[worker.pid] for worker in cluster.workers)
        return len([*case.glob("held *")]) == len(workers) and begun == len(come) + len(workers)

    def wait_and_act() -> None:
        try:
            wait_for(is_held)
        finally:
            act()
        if not ended.wait(MOST / 3):
            come[0]._lose("is lost, and it was not noticed")

    actor = Thread(target=wait_and_act)
    actor.start()
    try:
        yield
    finally:
        ended.set()
        actor.join()
    assert len([*case.glob("held *")]) == len(workers)


@needs_dask
def test_a_killed_worker_costs_its_unfinished_part_only(
    case: Path, cluster: Cluster, periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    killed, other = cluster.with_workers(2).workers
    with when_held(case, cluster, [killed], killed.kill, monkeypatch):
        outcome = periph_sim(*PROVE, "--cluster", cluster.address)
    runs = workers_of(case)
    answer = outcome.json_object
    assert answer == periph_sim(*PROVE, "--jobs", "1").json_object and outcome.status == 0
    assert (runs[killed.pid], runs[other.pid]) == (3, answer["runs"] - 2)


def test_a_cluster_and_jobs_exclude_each_other(case: Path, periph_sim: Run) -> None:
    for arguments in (PROVE, ("sweep", "small.toml", "--vary", "seed=1"), ("check", "small.toml")):
        assert periph_sim.refused(*arguments, "--cluster", "127.0.0.1:1", "--jobs", "2").endswith(
            "--cluster with --jobs: a cluster has its own workers; remove one of them"
        )


@pytest.mark.parametrize("arguments", [PROVE, ("sweep", "small.toml", "--vary", "seed=1"), ("check", "small.toml")])
def test_without_dask_the_error_says_how_to_install_it(
    case: Path, periph_sim: Run, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...]
) -> None:
    monkeypatch.setattr(of, "find_spec", lambda name: None)
    message = "--cluster needs Dask, which is not installed; use: pip install 'periph-sim[dask]'"
    assert periph_sim.refused(*arguments, "--cluster", "127.0.0.1:1") == message


@contextmanager
def ended_after(seconds: float, end: Callable[[], object]) -> Iterator[None]:
    """Call `end` if the block takes longer than this, so that the test fails instead of hanging."""
    timer = Timer(seconds, end)
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


@needs_dask
def test_an_address_without_a_scheduler_is_an_error(
    case: Path, periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing listens at the address, or a server never answers, or the address has no port."""
    monkeypatch.setattr(of, "CONNECT", 0.3)
    with socket.create_server(("127.0.0.1", 0)) as server, ended_after(MOST / 3, server.close):
        silent = f"127.0.0.1:{server.getsockname()[1]}"
        closed = socket.create_server(("127.0.0.1", 0))
        nothing = f"127.0.0.1:{closed.getsockname()[1]}"
        closed.close()
        for address in (silent, nothing, "127.0.0.1"):
            message = periph_sim.refused("sweep", "small.toml", "--vary", "seed=1", "--cluster", address)
            assert message.startswith(f"--cluster {address}: no Dask scheduler answers (")
            assert address != silent or "(no answer within 0.3 s)" in message


@needs_dask
def test_without_any_worker_the_command_stops(
    case: Path, cluster: Cluster, periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of, "LOOK", 0.1)
    monkeypatch.setattr(of, "LOST", 5.0)
    workers = cluster.with_workers(1).workers

    def kill() -> None:
        for worker in workers:
            worker.kill()
        monkeypatch.setattr(of, "LOST", 1.0)

    with when_held(case, cluster, workers, kill, monkeypatch):
        outcome = periph_sim(*PROVE, "--cluster", cluster.address)
    why = f"the Dask scheduler at {cluster.address} has had no worker for 1 s"
    answer = outcome.json_object
    assert answer["stopped"] == f"{why}; start one with `dask worker {cluster.address}`"
    assert outcome.status == 2 and outcome.err.endswith(f"Error: {answer['stopped']}\n")
    assert 25 <= answer["phases"]["run"] < 1500


@needs_dask
def test_the_finished_parts_are_kept_if_the_scheduler_is_killed(
    case: Path, cluster: Cluster, periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """This must be the last test, because it ends the cluster. The saved part is continued without a cluster."""
    workers = cluster.with_workers(1).workers
    with when_held(case, cluster, workers, cluster.scheduler.kill, monkeypatch):
        outcome = periph_sim(*PROVE, "--save", "--cluster", cluster.address)
    answer = outcome.json_object
    why = f"the Dask scheduler at {cluster.address} does not answer any more"
    assert (outcome.status, answer["stopped"]) == (2, why)
    assert (
        outcome.err.endswith(f"\nError: {why}\n")
        and "Traceback" not in outcome.err
        and "distributed" not in outcome.err
    )
    assert not any(logging.getLogger(name).isEnabledFor(logging.CRITICAL) for name in of.LOGGERS)
    assert 25 <= answer["phases"]["run"] < 1500
    saved = json.loads((case / "coverage" / "small.json").read_text())
    assert 1 <= saved["finished"] < saved["parts"]
    whole = periph_sim(*PROVE, "--save", "--jobs", "1").json_object
    assert {**whole, "written": []} == periph_sim(*PROVE, "--jobs", "1").json_object
