"""Worker processes start with the current folder and environment, and with the package already imported."""

from __future__ import annotations

import os
import signal
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_all_start_methods
from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest

from periph_sim.interfaces.reports import processes as of
from periph_sim.interfaces.reports.processes import processes


def process_state() -> tuple[str, str, list[str]]:
    """Return the folder, a variable and the firmware modules of the process that calls this."""
    return os.getcwd(), os.environ.get("PERIPH_SIM_TRIED", ""), [name for name in sys.modules if "_firmware_" in name]


def imported() -> set[str]:
    """Return those of the modules to be imported that the process had before it received work."""
    return set(of.IMPORTED) & BEFORE


BEFORE = set(sys.modules)


@pytest.mark.parametrize("start", [one for one in get_all_start_methods() if one != "fork"])
def test_workers_have_the_current_folder_and_environment(
    start: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of, "SERVER", start)  # other start methods are used without a fork server
    monkeypatch.setattr(of, "get_all_start_methods", lambda: ["spawn"] if start == "spawn" else [start])
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        monkeypatch.setenv("PERIPH_SIM_TRIED", name)
        with processes(1) as pool:
            assert pool.submit(process_state).result() == (str(tmp_path / name), name, [])


@pytest.mark.skipif(of.SERVER not in get_all_start_methods(), reason="no server forks here")
def test_workers_have_the_package_imported() -> None:
    with processes(1) as pool:
        assert pool.submit(imported).result() == set(of.IMPORTED)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_while_a_worker_starts_ends_the_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    """The signal comes before the worker is started, and raises KeyboardInterrupt when the pool knows the worker."""
    start, workers = ProcessPoolExecutor._adjust_process_count, list[BaseProcess]()

    def interrupted(pool: ProcessPoolExecutor) -> None:
        signal.raise_signal(signal.SIGINT)
        start(pool)
        workers.extend(pool._processes.values())

    monkeypatch.setattr(ProcessPoolExecutor, "_adjust_process_count", interrupted)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt), processes(1) as pool:
            pool.submit(os.getpid)
    finally:
        signal.signal(signal.SIGINT, before)
    (worker,) = workers
    worker.join()
    assert worker.exitcode == -signal.SIGKILL


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_worker_can_be_ended_by_ctrl_c() -> None:
    with processes(1) as pool:
        assert pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, []).result() == set()
        assert pool.submit(signal.getsignal, signal.SIGINT).result() == signal.SIG_DFL
