"""Firmware that lets no simulated time pass: CPUs go in; one that takes too much CPU time at one instant is stopped.

A thread of the process looks at the running CPUs a few times a second. CPU time, of the thread that simulates, is what
counts: a loaded machine, or firmware that blocks, takes none. A firmware being debugged is left alone. The exception is
raised between two bytecodes of whatever the thread executes, in the main thread or any other, and in worker processes.
"""

from __future__ import annotations

import ctypes
import sys
import time
from threading import Event, Lock, Thread
from types import FrameType
from typing import Protocol
from weakref import WeakSet

PERIOD = 0.1  # seconds between two looks


class NoProgress(BaseException):
    """Raised in firmware that lets no simulated time pass; no `except Exception` of the firmware's swallows it."""


class RunWatch(Protocol):
    """thread: that simulates, while it executes this CPU's firmware; 0 otherwise. stall_limit: seconds of CPU time."""

    thread: int
    stall_limit: float

    def instant(self) -> tuple[int, int]:
        """What changes with simulated time."""


class _Watch:
    """One a process: its thread runs as long as there is a CPU to look at.

    stops: the threads in which it has begun to stop a CPU, at any time; before, nobody needs to `leave`.
    """

    def __init__(self) -> None:
        self.stops: list[int] = []
        self._cpus: WeakSet[RunWatch] = WeakSet()
        self._lock = Lock()
        self._thread: Thread | None = None
        self._stopping = False  # from the look at a CPU to the exception that stops it
        self._stopped: set[int] = set()  # threads with an exception on its way, or raised

    def add(self, cpu: RunWatch) -> None:
        with self._lock:
            self._cpus.add(cpu)
            if self._thread is None or not self._thread.is_alive():  # none yet, or lost in a fork
                self._thread = Thread(target=self._look_on, name="periph-sim stall watch", daemon=True)
                self._thread.start()

    def leave(self, thread: int) -> None:
        """The thread no longer executes firmware: an exception on its way to it ends here.

        No lock: an exception between its acquiring and the block that releases it would keep it for ever.
        """
        try:
            while self._stopping:
                time.sleep(0)
            if thread in self._stopped:
                # To take it back as such would leave CPython 3.11's eval breaker set for good: every later bytecode
                # slower, and a traced one never done. So it is raised, and caught, here.
                _raise_in(thread, NoProgress)
                while True:
                    time.sleep(0)
        except NoProgress:
            pass
        self._stopped.discard(thread)

    def _stop(self, cpu: RunWatch, at: tuple[int, int, int]) -> None:
        self.stops.append(at[0])
        self._stopping = True
        if (cpu.thread, *cpu.instant()) == at and not _debugged(sys._current_frames().get(at[0])):
            self._stopped.add(at[0])
            _raise_in(at[0], NoProgress)
        self._stopping = False

    def _look_on(self) -> None:
        seen: dict[int, tuple[tuple[int, int, int], float]] = {}  # CPU -> where it was, and the CPU time then
        pause = Event()
        while True:
            pause.wait(PERIOD)
            with self._lock:
                cpus = list(self._cpus)
                if not cpus:
                    self._thread = None
                    return
            now: dict[int, tuple[tuple[int, int, int], float]] = {}
            for cpu in cpus:
                thread = cpu.thread
                if thread:
                    at, used = (thread, *cpu.instant()), _cpu_seconds(thread)
                    before = seen.get(id(cpu))
                    now[id(cpu)] = before if before is not None and before[0] == at else (at, used)
                    if used - now[id(cpu)][1] > cpu.stall_limit:
                        now[id(cpu)] = (at, used)
                        self._stop(cpu, at)
            seen = now
            del cpus, cpu


def _cpu_seconds(thread: int) -> float:
    """CPU time of a thread; of the process where the system does not tell."""
    try:
        return time.clock_gettime(time.pthread_getcpuclockid(thread))
    except (AttributeError, OSError):
        return time.process_time()


def _raise_in(thread: int, what: type[BaseException]) -> None:
    """Let the thread raise this at its next bytecode, instead of what was on its way."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(what))


def _debugged(frame: FrameType | None) -> bool:
    """True if a debugger traces one of these frames; a tool that measures coverage traces, too, and is none."""
    monitoring = getattr(sys, "monitoring", None)  # Python 3.12
    if monitoring is not None and monitoring.get_tool(monitoring.DEBUGGER_ID) is not None:
        return True
    while frame is not None:
        tracer = frame.f_trace
        if tracer is not None and not type(tracer).__module__.startswith("coverage"):
            return True
        frame = frame.f_back
    return False


watch = _Watch()
