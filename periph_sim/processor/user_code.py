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
from threading import get_ident
from types import CodeType, FunctionType
from typing import BinaryIO, TypeVar

from greenlet import GreenletExit

from ..core.shorten import one_line
from .source_location import is_firmware, is_helper, is_ours
from .stall_watch import NoProgress, watch

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
        try:
            return self._watched(function, *arguments)
        except NoProgress as stopped:
            at, limit = raised_at(stopped), f"{self.stall_limit:g} s of CPU time"
            raise FirmwareStalled(f"{self.who} did not return within {limit} at {at}") from None

    def _watched(self, function: Callable[..., Returned], *arguments: object) -> Returned:
        if not self.stall_limit or self.thread:  # a nested call belongs to the call around it
            return function(*arguments)
        self._calls += 1
        self.thread = get_ident()
        try:
            return function(*arguments)
        finally:
            self.thread = 0
            watch.leave(get_ident())


class _Nowhere(io.TextIOBase):
    """A text stream that drops what is written to it."""

    def write(self, text: str) -> int:
        return len(text)


class _Aside(io.TextIOBase):
    """A text stream that writes to standard error, and leaves that open when it is closed."""

    def write(self, text: str) -> int:
        return 0 if sys.stderr is None else sys.stderr.write(text)

    def flush(self) -> None:
        if sys.stderr is not None:
            sys.stderr.flush()

    def fileno(self) -> int:
        return sys.stderr.fileno()

    @property
    def buffer(self) -> BinaryIO:
        return sys.stderr.buffer

    def __getattr__(self, name: str) -> object:
        """Return what else a text stream has, such as `line_buffering`, from standard error."""
        return getattr(sys.stderr, name)


@contextmanager
def output_aside() -> Iterator[None]:
    """Print to standard error within the block, in which user code runs: standard output is the command's own."""
    if isinstance(sys.stdout, _Nowhere):
        yield
        return
    with redirect_stdout(_Aside()):
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
