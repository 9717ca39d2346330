"""The guard around user code: firmware, service routines, devices and their files.

    error that user code raised --as_firmware_error--> FirmwareError with its place, or None: it passes unchanged
    guard(function, ...)        --> its result; FirmwareError; FirmwareStalled if it does not return
    with output_muted(): ...    --> prints of user code in a run that repeats an earlier one are dropped

User code may not:

- exit: `sys.exit` becomes an error, as does every exception that is no `Exception`. Only Ctrl-C passes.
- run forever: a call that uses more CPU time than its limit is stopped with its line.
- poll for long without notice: `warn` writes a sentence during the run.
- print twice: a case that is run again for an explanation prints nothing the second time.

Exits that Python does not see, such as `os._exit`, are noticed by `periph_sim.entry` from outside of the process.
"""

from __future__ import annotations

import io
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from inspect import (
    CO_ASYNC_GENERATOR,
    CO_COROUTINE,
    CO_GENERATOR,
    isasyncgenfunction,
    iscoroutinefunction,
    isgeneratorfunction,
    signature,
)
from pathlib import Path
from threading import Event, Lock, Thread, get_ident
from types import CodeType, FrameType, FunctionType
from typing import Any, Protocol, TextIO, TypeVar, cast
from weakref import WeakSet

from greenlet import GreenletExit

from ..core.phrases import one_line
from .source_location import is_firmware, is_helper, is_ours

# Stalls ---------------------------------------------------------------------------

PERIOD = 0.1  # seconds between two checks


class NoProgress(BaseException):
    """Raised in firmware that lets no simulated time pass; `except Exception` in the firmware does not catch it."""


class RunWatch(Protocol):
    """A program whose run is watched for stalls.

    thread: the thread that executes this CPU's firmware; 0 if there is none.
    stall_limit: seconds of CPU time that it may take at one instant.
    """

    thread: int
    stall_limit: float

    def instant(self) -> tuple[int, int]:
        """Return values that change with simulated time."""


class _Watch:
    """The guard of the process against user code that takes too much CPU time at one instant of simulated time.

    Its thread runs as long as there is a CPU to check, ten times a second. Only CPU time of the simulating thread
    counts: a loaded machine, or firmware that blocks, takes none. Firmware in a debugger is not stopped. The exception
    is raised between two bytecodes of the simulating thread, which may be any thread, also of a worker process.

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
    import ctypes  # only for a stall

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


# Errors ---------------------------------------------------------------------------

FIRMWARE_VIEW = (
    str(Path("processor", "python", "register_view.py")),
    str(Path("processor", "python", "firmware_view.py")),
)  # these reject wrong names


class FirmwareError(Exception):
    """Firmware that cannot continue: it raised, or it violated a rule of a scene with `strict`."""


class Misuse(FirmwareError):
    """A call or a value that the DSP's interface rejects. Reported with the firmware's statement."""


class FirmwareStalled(FirmwareError):
    """Firmware that let no simulated time pass for too long. The run fails; it is no mistake in the use of the tool."""


class FirmwareLost(FirmwareStalled):
    """Compiled code that cannot continue, as at an illegal instruction. The run fails there."""


class InterruptFault(FirmwareError):
    """An interrupt whose context or vector is outside of memory."""


def flaw_of(function: Callable[..., object], arguments: int) -> str:
    """Return, as a clause, why a function cannot be firmware with this number of arguments; empty if it can."""
    plain = getattr(function, "__func__", function)
    if _takes(plain, arguments + (plain is not function)):
        return ""
    if iscoroutinefunction(plain):
        return "is async"
    if isgeneratorfunction(plain) or isasyncgenfunction(plain):
        return "is a generator (it has a yield), so calling it runs nothing"
    try:
        signature(function).bind(*[None] * arguments)
    except TypeError:
        return f"takes {signature(function)}"
    except ValueError:  # a builtin without a signature
        return ""
    return ""


RUNS_NOTHING = CO_COROUTINE | CO_GENERATOR | CO_ASYNC_GENERATOR  # a call of such a function executes none of its code


def _takes(function: object, arguments: int) -> bool:
    """Return True for an ordinary function, checked by its code alone; a signature takes 30 times as long."""
    if type(function) is not FunctionType or function.__dict__:  # attributes set by a decorator
        return False
    code = function.__code__
    least = code.co_argcount - len(function.__defaults__ or ())
    return least <= arguments <= code.co_argcount and not (code.co_kwonlyargcount or code.co_flags & RUNS_NOTHING)


def defined_at(function: object) -> str:
    """Return the place of a definition, "line 3 of blink.py"; empty if the function is not written in Python."""
    code = getattr(function, "__code__", None)
    return f"line {code.co_firstlineno} of {Path(code.co_filename).name}" if isinstance(code, CodeType) else ""


def raised_at(error: BaseException) -> str:
    """Return the origin of an exception in the firmware, "line 7 of blink.py"; empty if the fault is our own."""
    place = ""
    ours = False
    refused = isinstance(error, Misuse | NoProgress)  # raised by us, about the firmware
    step = error.__traceback__
    while step is not None:
        code = step.tb_frame.f_code
        ours = is_ours(code.co_filename) and not code.co_filename.endswith(FIRMWARE_VIEW)
        if is_firmware(code.co_filename) and not (place and is_helper(code.co_filename)):  # its caller is to blame
            place = f"line {step.tb_lineno} of {Path(code.co_filename).name}"
        step = step.tb_next
    return "" if ours and not refused else place


Returned = TypeVar("Returned")

PASSES = (KeyboardInterrupt, GreenletExit, NoProgress)
NO_EXIT = "user code cannot end the command; return, or raise an error, instead of exiting"


def as_firmware_error(error: BaseException, who: str) -> FirmwareError | None:
    """Return the FirmwareError, with its place, for an error raised in user code.

    Return None if `error` passes unchanged: Ctrl-C, an error that names its place already, and faults of our own.
    """
    if isinstance(error, PASSES):
        return None
    at = raised_at(error)
    if isinstance(error, Misuse):
        return FirmwareError(f"{who}{f', {at}' if at else ''}: {message_of(error)}")
    if isinstance(error, FirmwareError) or (isinstance(error, Exception) and not at):
        return None
    return FirmwareError(f"{who}: {type(error).__name__}{f' at {at}' if at else ''}: {message_of(error)}")


def message_of(error: BaseException) -> str:
    """Return the message of an exception in one printable line, without the quotes that a KeyError puts around it."""
    if isinstance(error, SystemExit):
        return NO_EXIT
    return one_line(str(error.args[0]) if len(error.args) == 1 else str(error)) or "no message"


class UserCode:
    """A guard that calls functions of one piece of user code.

    who: its name in messages. stall_limit: seconds of CPU time that one call may take; 0: unlimited.
    thread: the thread that is in a call; 0 if none is.
    """

    def __init__(self, who: str, stall_limit: float) -> None:
        self.who = who
        self.stall_limit = stall_limit
        self.thread = 0
        self._calls = 0
        if stall_limit:
            watch.add(self)

    def instant(self) -> tuple[int, int]:
        """Return a different value in each call."""
        return self._calls, 0

    def __call__(self, function: Callable[..., Returned], *arguments: object) -> Returned:
        """Return the result. Raise FirmwareError, with its place, for an exception; FirmwareStalled for a timeout."""
        try:
            return self.in_time(function, *arguments)
        except BaseException as error:
            found = as_firmware_error(error, self.who)
            if found is None:
                raise
            raise found from None

    def in_time(self, function: Callable[..., Returned], *arguments: object) -> Returned:
        """Return the result. The function's exceptions pass. Raise FirmwareStalled, with the line, for a timeout."""
        if not self.stall_limit or self.thread:  # a nested call belongs to the call around it
            return function(*arguments)
        self._calls += 1
        self.thread = get_ident()
        try:
            try:
                return function(*arguments)
            finally:
                self.thread = 0
                watch.leave(get_ident())
        except NoProgress as stopped:
            at, limit = raised_at(stopped), f"{self.stall_limit:g} s of CPU time"
            raise FirmwareStalled(f"{self.who} did not return within {limit} at {at}") from None


class _Nowhere(io.TextIOBase):
    """A text stream that drops what is written to it."""

    def write(self, text: str) -> int:
        return len(text)


class _Aside:
    """Standard error, which stays open if this is closed."""

    def close(self) -> None:
        pass

    def __getattr__(self, name: str) -> Any:
        return getattr(sys.stderr, name)


@contextmanager
def output_aside() -> Iterator[None]:
    """Print to standard error within the block, in which user code runs: standard output is the command's own."""
    if isinstance(sys.stdout, _Nowhere):
        yield
        return
    with redirect_stdout(_Nowhere() if sys.stderr is None else cast("TextIO", _Aside())):
        yield


def warn(sentence: str) -> None:
    """Write a sentence about user code to standard error at once; nothing in a run that repeats an earlier one."""
    if sys.stderr is not None and not isinstance(sys.stdout, _Nowhere):
        print(sentence, file=sys.stderr, flush=True)


@contextmanager
def output_muted() -> Iterator[None]:
    """Discard the output of a block that runs a case again, since its earlier run has printed the same."""
    with redirect_stdout(_Nowhere()):
        yield
