"""Calls in worker processes: the number at a time, and the other calls after one has failed."""

from __future__ import annotations

import gc
import os
import sys
import weakref
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.reports.baselines.workers import workers

MODULE = sys.modules[workers.__module__]


class Threads:
    """A replacement of ThreadPoolExecutor that records its use and makes each call at once."""

    asked: list[Any] = []

    def __init__(self, count: int) -> None:
        Threads.asked = [count]

    def __enter__(self) -> Threads:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def submit(self, work: Callable[[], Any]) -> Future[Any]:
        done: Future[Any] = Future()
        done.set_result(work())
        return done

    def shutdown(self, **how: bool) -> None:
        Threads.asked.append(how)


@pytest.fixture(autouse=True)
def replacements(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MODULE, "ThreadPoolExecutor", Threads)
    monkeypatch.setattr(MODULE, "call_alone", lambda work, *arguments: ("alone", work(*arguments)))
    monkeypatch.setattr(MODULE, "end_workers", lambda: Threads.asked.append("workers ended"))


def name(path: Path, ending: str) -> str:
    return path.name + ending


@pytest.mark.parametrize(
    ("jobs", "calls", "cores", "at_a_time"),
    [
        *[(None, 9, 4, 4), (None, 3, 4, 3), (None, 9, None, 1), (3, 9, 4, 3), (3, 2, 4, 2), (5, 9, 4, 5)],
        *[(1, 9, 4, 0), (None, 1, 4, 0), (4, 1, 4, 0), (None, 0, 4, 0)],
    ],
)
def test_one_job_or_one_call_runs_in_this_process_and_others_in_worker_processes(
    monkeypatch: pytest.MonkeyPatch, jobs: int | None, calls: int, cores: int | None, at_a_time: int
):
    """An at_a_time of 0 means calls in this process."""
    Threads.asked = []
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    with workers(jobs, calls) as start:
        assert start(name, Path("a"), "b")() == (("alone", "ab") if at_a_time else "ab")
    assert Threads.asked == ([at_a_time] if at_a_time else [])


def test_an_error_or_ctrl_c_cancels_pending_calls_and_ends_running_ones():
    for error in (KeyboardInterrupt, ValueError):
        with pytest.raises(error), workers(2, 9):
            raise error
        assert Threads.asked == [2, {"wait": False, "cancel_futures": True}, "workers ended"]


def test_garbage_of_earlier_runs_is_collected_before_worker_threads_start():
    class Ring:
        pass

    ring: Any = Ring()
    ring.itself, gone = ring, weakref.ref(ring)
    gc.disable()
    try:
        del ring
        with workers(2, 2):
            assert gone() is None
    finally:
        gc.enable()
