"""Guard against firmware that lets no simulated time pass: too much CPU time at one instant stops it.

A thread of the process checks the running CPUs ten times a second. Only CPU time of the simulating thread counts: a
loaded machine, or firmware that blocks, takes none. Firmware in a debugger is not stopped. The exception is raised
between two bytecodes of the simulating thread, which may be any thread, also of a worker process.
"""

from __future__ import annotations

import ctypes
import sys
import time
from threading import Event, Lock, Thread
from types import FrameType
from typing import Protocol
from weakref import WeakSet

PERIOD = 0.1  # seconds between two checks


class NoProgress(BaseException):
    """Raised in firmware that lets no simulated time pass; `except Exception` in the firmware does not catch it."""


class RunWatch(Protocol):
    """thread: the thread that executes this CPU's firmware; 0 if none. stall_limit: seconds of CPU time."""

    thread: int
    stall_limit: float

    def instant(self) -> tuple[int, int]:
        """Return values that change with simulated time."""


class _Watch:
    """The guard of the process; its thread runs as long as there is a CPU to check.

    stops: threads in which it has ever begun to stop a CPU; without any, `leave` need not be called.
    """

    def __init__(self) -> None:
        self.stops: list[int] = []
        self._cpus: WeakSet[RunWatch] = WeakSet()
        self._lock = Lock()
        self._thread: Thread | None = None
        self._stopping = False  # from the check of a CPU to the exception that stops it
        self._stopped: set[int] = set()  # threads with a pending or raised exception

    def add(self, cpu: RunWatch) -> None:
        """Check this CPU as long as it exists."""
        with self._lock:
            self._cpus.add(cpu)
            if self._thread is None or not self._thread.is_alive():  # none yet, or lost in a fork
                self._thread = Thread(target=self._check_cpus, name="periph-sim stall watch", daemon=True)
                self._thread.start()

    def leave(self, thread: int) -> None:
        """Catch a pending exception of the thread, which no longer executes firmware.

        No lock: an exception between its acquisition and the `with` block would leave it locked.
        """
        try:
            while self._stopping:
                time.sleep(0)
            if thread in self._stopped:
                # Cancelling it would leave CPython 3.11's eval breaker set: each later bytecode would be slower, and
                # a traced one would never end. So it is raised, and caught, here.
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

    def _check_cpus(self) -> None:
        seen: dict[int, tuple[tuple[int, int, int], float]] = {}  # CPU -> its instant, and the CPU time then
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
    """Return the CPU time of a thread; the process's if the system does not provide it."""
    try:
        return time.clock_gettime(time.pthread_getcpuclockid(thread))
    except (AttributeError, OSError):
        return time.process_time()


def _raise_in(thread: int, what: type[BaseException]) -> None:
    """Raise this in the thread at its next bytecode; it replaces a pending exception."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(what))


def _debugged(frame: FrameType | None) -> bool:
    """Return True if a debugger traces one of these frames; a coverage tool is not one."""
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
