"""The guard around user code: firmware, service routines, devices and their files.

    as_firmware_error(error)    returns a FirmwareError with the place of an error of user code; None for other errors
    guard(function, ...)        returns the result; raises FirmwareError, or FirmwareStalled if the call takes too long
    with output_muted(): ...    drops the output of user code in a run that repeats an earlier run

The guard has these effects:

- User code cannot exit. `sys.exit` and other exceptions that are no `Exception` become errors, except Ctrl-C and
  GreenletExit.
- User code cannot compute forever. A call that uses more CPU time than its limit, if it has one, is stopped, and the
  message has its line.
- User code cannot poll for long unnoticed. `warn` writes a sentence during the run.
- User code cannot print twice. A case that is run again for an explanation prints nothing the second time.

`periph_sim.supervisor` detects exits without an exception, such as `os._exit`, from another process.
"""

from __future__ import annotations

import io
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from inspect import isasyncgenfunction, iscoroutinefunction, isgeneratorfunction, signature
from pathlib import Path
from threading import Event, Lock, Thread, get_ident
from types import CodeType, FrameType
from typing import Any, Protocol, TextIO, TypeVar, cast
from weakref import WeakSet

from greenlet import GreenletExit

from ..core.phrases import one_line
from .source_location import is_firmware, is_helper, is_ours

# Stalls ---------------------------------------------------------------------------

PERIOD = 0.1  # seconds between two checks


class NoProgress(BaseException):
    """Raised in user code that lets no simulated time pass. `except Exception` in user code does not catch it."""


class RunWatch(Protocol):
    """User code that is watched for stalls: the firmware of a CPU, or a guarded call.

    thread: the thread that executes the user code now; 0 if none does.
    stall_limit: seconds of CPU time that the user code may take while `instant` returns the same values.
    """

    thread: int
    stall_limit: float

    def instant(self) -> tuple[int, int]:
        """Return two values. At least one of them changes when the user code makes progress."""


class _Watch:
    """The guard of the process against user code that takes too much CPU time at one instant of simulated time.

    A separate thread checks all user code ten times a second. It measures the CPU time of the thread that executes the
    user code. No CPU time passes while that thread blocks, or waits because the machine is loaded. User code in a
    debugger is not stopped. The exception is raised in the executing thread between two bytecodes.

    stops: the threads in which user code was stopped; while the list is empty, `leave` need not be called.
    """

    def __init__(self) -> None:
        self.stops: list[int] = []
        self._cpus: WeakSet[RunWatch] = WeakSet()
        self._lock = Lock()
        self._thread: Thread | None = None
        self._stopping = False  # True while `_stop` checks stalled user code a last time and raises its exception
        self._stopped: set[int] = set()  # threads with a pending or raised exception

    def add(self, cpu: RunWatch) -> None:
        """Check this user code for stalls as long as the object `cpu` exists."""
        with self._lock:
            self._cpus.add(cpu)
            if self._thread is None or not self._thread.is_alive():  # a fork of the process has no such thread
                self._thread = Thread(target=self._check_cpus, name="periph-sim stall watch", daemon=True)
                self._thread.start()

    def leave(self, thread: int) -> None:
        """Catch a pending NoProgress of the calling thread, which no longer executes user code.

        This method uses no lock: an exception between the acquisition and the `with` block would leave it locked.
        """
        try:
            while self._stopping:
                time.sleep(0)
            if thread in self._stopped:
                # After a cancelled exception, the eval breaker of CPython 3.11 stays set.
                # With the eval breaker set, each bytecode is slower, and a traced bytecode never ends.
                # So the pending exception is not cancelled, but raised and caught here.
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
        # Maps the id of user code to its thread and instant, and the CPU time of the thread when that instant began.
        seen: dict[int, tuple[tuple[int, int, int], float]] = {}
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
    """Return the CPU time of a thread, or of the whole process if the system does not provide that of a thread."""
    try:
        return time.clock_gettime(time.pthread_getcpuclockid(thread))
    except (AttributeError, OSError):
        return time.process_time()


def _raise_in(thread: int, what: type[BaseException]) -> None:
    """Raise an exception in a thread at its next bytecode. It replaces a pending exception."""
    import ctypes  # imported here, because it is needed only after a stall

    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(what))


def _debugged(frame: FrameType | None) -> bool:
    """Return True if a debugger traces this frame or a frame that called it, or uses `sys.monitoring`.

    A coverage tool is no debugger.
    """
    monitoring = getattr(sys, "monitoring", None)  # exists from Python 3.12 on
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
)  # files of the simulation that raise errors about wrong names in firmware


class FirmwareError(Exception):
    """Raised if firmware cannot continue, for example after an exception, or a violated rule in a `strict` scene."""


class Misuse(FirmwareError):
    """Raised if the interface of the DSP rejects a call or a value. The report names the statement of the firmware."""


class FirmwareStalled(FirmwareError):
    """Raised if firmware lets no simulated time pass for too long. The run has failed; its case is valid."""


class FirmwareLost(FirmwareStalled):
    """Raised if an image or C code cannot continue, for example at an illegal instruction. The run has failed."""


class InterruptFault(FirmwareError):
    """Raised if the context or the vector of an interrupt is not in RAM."""


def flaw_of(function: Callable[..., object], arguments: int) -> str:
    """Return why a function cannot be called as user code, such as "is async"; "" if it can be called.

    arguments: the number of arguments of the call.
    """
    plain = getattr(function, "__func__", function)
    if iscoroutinefunction(plain):
        return "is async"
    if isgeneratorfunction(plain) or isasyncgenfunction(plain):
        return "is a generator (it has a yield), so calling it runs nothing"
    try:
        signature(function).bind(*[None] * arguments)
    except TypeError:
        return f"takes {signature(function)}"
    except ValueError:  # the function is a builtin without a signature
        return ""
    return ""


def defined_at(function: object) -> str:
    """Return the place of a definition, "line 3 of blink.py"; "" if the function is not written in Python."""
    code = getattr(function, "__code__", None)
    return f"line {code.co_firstlineno} of {Path(code.co_filename).name}" if isinstance(code, CodeType) else ""


def raised_at(error: BaseException) -> str:
    """Return the line of the firmware that has caused an exception, "line 7 of blink.py".

    Return "" if the simulation itself has caused it, or if no line of firmware was being executed.
    """
    place = ""
    ours = False
    refused = isinstance(error, Misuse | NoProgress)  # raised in the simulation, but caused by the firmware
    step = error.__traceback__
    while step is not None:
        code = step.tb_frame.f_code
        ours = is_ours(code.co_filename) and not code.co_filename.endswith(FIRMWARE_VIEW)
        # An error in start-up code is reported at the line of the firmware that calls it.
        if is_firmware(code.co_filename) and not (place and is_helper(code.co_filename)):
            place = f"line {step.tb_lineno} of {Path(code.co_filename).name}"
        step = step.tb_next
    return "" if ours and not refused else place


Returned = TypeVar("Returned")

PASSES = (KeyboardInterrupt, GreenletExit, NoProgress)
NO_EXIT = "user code cannot end the command; return, or raise an error, instead of exiting"


def as_firmware_error(error: BaseException, who: str) -> FirmwareError | None:
    """Return a FirmwareError, with the place, for an error that user code has raised.

    Return None if `error` must not be changed: for Ctrl-C, for GreenletExit and NoProgress, which end firmware, for a
    FirmwareError that is no Misuse, and for an error without a line of firmware (`raised_at`), which the simulation
    itself has caused. who: the name of the user code.
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

    who: the name of the user code in messages.
    stall_limit: seconds of CPU time that one call may take; 0 if unlimited.
    thread: the thread that executes a call now; 0 if none does.
    """

    def __init__(self, who: str, stall_limit: float) -> None:
        self.who = who
        self.stall_limit = stall_limit
        self.thread = 0
        self._calls = 0
        if stall_limit:
            watch.add(self)

    def instant(self) -> tuple[int, int]:
        """Return values that stay the same during one guarded call, and differ from those during other calls."""
        return self._calls, 0

    def __call__(self, function: Callable[..., Returned], *arguments: object) -> Returned:
        """Return the result of a call. Raise FirmwareError for its exception, FirmwareStalled if it takes too long."""
        try:
            return self.in_time(function, *arguments)
        except BaseException as error:
            found = as_firmware_error(error, self.who)
            if found is None:
                raise
            raise found from None

    def in_time(self, function: Callable[..., Returned], *arguments: object) -> Returned:
        """Return the result of a call, or raise its exception. Raise FirmwareStalled if the call takes too long."""
        if not self.stall_limit or self.thread:  # the time of a nested call counts for the outer call
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
    """A text stream that drops all text written to it."""

    def write(self, text: str) -> int:
        return len(text)


class _Aside:
    """A stream that writes to standard error. Its close method and a with statement leave standard error open."""

    def close(self) -> None:
        pass

    def __enter__(self) -> _Aside:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __getattr__(self, name: str) -> Any:
        return getattr(sys.stderr, name)


@contextmanager
def output_aside() -> Iterator[None]:
    """Within the block, let user code print to standard error, because standard output belongs to the command.

    Inside an `output_muted` block, the output stays muted.
    """
    if isinstance(sys.stdout, _Nowhere):
        yield
        return
    with redirect_stdout(_Nowhere() if sys.stderr is None else cast("TextIO", _Aside())):
        yield


def warn(sentence: str) -> None:
    """Write a sentence about user code to standard error at once, except in a run that repeats an earlier run."""
    if sys.stderr is not None and not isinstance(sys.stdout, _Nowhere):
        print(sentence, file=sys.stderr, flush=True)


@contextmanager
def output_muted() -> Iterator[None]:
    """Drop the output of the block, which runs a case again, because the earlier run has printed the same."""
    with redirect_stdout(_Nowhere()):
        yield
