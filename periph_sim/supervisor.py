"""Runs a command in a worker process, so that its exit status is a verdict only if the command completed.

    process that was started --fork--> worker: runs the command; its output is written; `complete`
      waits, forwards signals <--pipe-- "pid status", which only `complete` writes
      exits with the status, with 3, or by the worker's signal

User code can end the worker without Python's knowledge. If it does so by `os._exit` or `execv`, nothing is written to
the pipe, and the command exits with status 3 and a message. If a signal ends the worker, as `abort` in C does, the
command ends by the same signal. If the worker's standard output was closed or redirected, 3 replaces status 0 or 1.

Temporary files of outputs, which the worker names by `remove_unless_complete`, are removed if it ends before it is
complete.

SIGTERM and SIGHUP raise KeyboardInterrupt in the worker, as Ctrl-C does. If the waiting process is killed, the worker
receives SIGTERM. Without `fork`, on Windows, the work is done in the process that was started.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from types import FrameType
from typing import NoReturn, TextIO

NO_VERDICT = 3
REPEATED = 1.0  # seconds: a signal of a process group and its forwarded copy arrive within that
FORWARDED = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2")
STOPPING = ("SIGINT", "SIGTERM", "SIGHUP")
PR_SET_PDEATHSIG = 1

can_fork = hasattr(os, "fork")
_temporary_files = -1  # the worker's end of the pipe for their names; -1 if no process waits


class Completion:
    """The worker's end of the pipe. name: of the command, for sentences."""

    def __init__(self, name: str, pipe: int) -> None:
        self.name = name
        self._pipe = pipe
        self._stdout = sys.stdout
        self._copy = _duplicate(1)

    def flaw(self) -> str:
        """Return the reason why output may not have reached the original standard output; "" if it has."""
        if self._stdout is None or self._copy is None:
            return "standard output is closed"
        if self._stdout.closed or sys.stdout is not self._stdout:
            return "user code closed or replaced sys.stdout"
        try:
            self._stdout.flush()
            same = os.path.samestat(os.fstat(1), os.fstat(self._copy))
        except OSError as error:
            return f"standard output: {(error.strerror or 'an error').lower()}"
        return "" if same else "user code redirected standard output"

    def complete(self, status: int) -> None:
        """Report to the waiting process that all output is written, with the exit status.

        If user code has closed the pipe, the waiting process takes the output as incomplete.
        """
        with suppress(OSError):
            os.write(self._pipe, _completed(os.getpid(), status))


def remove_unless_complete(file: str) -> None:
    """Have the waiting process remove this file if the worker ends before its output is complete."""
    if _temporary_files >= 0:
        with suppress(OSError):  # user code has closed the pipe
            os.write(_temporary_files, os.fsencode(os.path.abspath(file)) + b"\0")


def supervise(work: Callable[[], object], name: str) -> NoReturn:
    """Do `work`, a command that ends with SystemExit, in a worker; exit with its status once its output is complete."""
    if not can_fork:
        work()
        sys.exit(0)
    if sys.stderr is None:  # else the next file that is opened would receive what C code writes to standard error
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        os.set_inheritable(2, True)
    done = split(name)
    sys.stderr = StandardError(sys.stderr)
    status = _status_of(work)
    flaw = done.flaw()
    if flaw and status in (0, 1):
        _say(f"{name}: {flaw}, so its output is not complete; exit status {NO_VERDICT} is no verdict")
        status = NO_VERDICT
    done.complete(status)
    left = [one.name for one in threading.enumerate() if one is not threading.main_thread() and not one.daemon]
    if left:  # Python would wait for them as it ends, for ever if they never do
        _say(f"{name}: ended thread {left[0]!r}, which user code started and which was still running")
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError, ValueError):  # there is none, or it is closed
            stream.flush()
    os._exit(status)  # to take all modules apart first would cost more than the second process does


def split(name: str, *, strict: bool = True) -> Completion:
    """Fork: returns in the worker. The waiting process exits with the worker's status.

    strict: a status other than 0 needs completion, too.
    """
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, _numbers(FORWARDED))
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # ignored, as some callers leave it, it takes the status away
    global _temporary_files
    reader, writer = os.pipe()
    names, _temporary_files = os.pipe()
    os.set_blocking(_temporary_files, False)
    caller = os.getpid()
    worker = os.fork()
    if worker:
        os.close(writer)
        _wait(worker, reader, names, mask, name, strict)
    os.close(reader)
    os.close(names)
    _end_with(caller)
    for number in _numbers(STOPPING):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _interrupt)
    signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    return Completion(name, writer)


def _status_of(work: Callable[[], object]) -> int:
    """Return the exit status that `work` ends with."""
    try:
        work()
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    except BaseException:
        import traceback

        traceback.print_exc()
        return NO_VERDICT
    return 0


def _completed(worker: int, status: int) -> bytes:
    return f"{worker} {status}\n".encode()


# The waiting process ---------------------------------------------------------------------


def _wait(worker: int, reader: int, names: int, mask: Iterable[int], name: str, strict: bool) -> NoReturn:
    def forward(number: int, _: FrameType | None) -> None:
        with suppress(ProcessLookupError):  # a signal that comes as the worker ends is handled after the wait for it
            os.kill(worker, number)

    for number in _numbers(FORWARDED):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, forward)
    signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    _, how = os.waitpid(worker, 0)
    said = _waiting_in(reader)
    complete = bool(said)
    if not complete:
        for file in _waiting_in(names).split(b"\0")[:-1]:
            with suppress(OSError):
                os.unlink(file)
    if os.WIFSIGNALED(how):
        by = os.WTERMSIG(how)
        if said.startswith(f"{worker} ".encode()) and by in _numbers(STOPPING):  # it was about to exit
            os._exit(int(said.split()[1]))
        _die_by(by, name, complete)
    status = os.WEXITSTATUS(how)
    if said == _completed(worker, status) or (status and not complete and not strict):
        os._exit(status)
    why = "after its output" if complete else "before its output was complete"
    _say(f"{name}: user code ended the process with status {status} {why}; exit status {NO_VERDICT} is no verdict")
    os._exit(NO_VERDICT)


def _waiting_in(pipe: int) -> bytes:
    os.set_blocking(pipe, False)  # a process that the worker left behind may have the other end
    try:
        return os.read(pipe, 1 << 16)
    except BlockingIOError:
        return b""


def _die_by(number: int, name: str, complete: bool) -> NoReturn:
    """End by the signal that ended the worker, which the caller then sees as the cause."""
    if number not in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        why = "after its output" if complete else "before its output was complete"
        _say(f"{name}: {signal.strsignal(number)}: a signal ended the process {why}")
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # the worker's core is the one of interest
    if number != signal.SIGKILL:
        signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    os._exit(128 + number)


# The worker --------------------------------------------------------------------------------

_stopped_at = float("-inf")


def _interrupt(number: int, _: FrameType | None) -> None:
    """Raise KeyboardInterrupt, once for a signal that comes twice."""
    global _stopped_at
    before, _stopped_at = _stopped_at, time.monotonic()
    if _stopped_at - before > REPEATED:
        raise KeyboardInterrupt


def _end_with(caller: int) -> None:
    """Ask for SIGTERM as the waiting process ends, where the system can send it."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != caller:  # it ended before
            os._exit(NO_VERDICT)


def _duplicate(descriptor: int) -> int | None:
    try:
        return os.dup(descriptor)
    except OSError:
        return None


def _numbers(names: tuple[str, ...]) -> list[signal.Signals]:
    return [signal.Signals[name] for name in names]


def _say(sentence: str) -> None:
    """Write a line to standard error, regardless of what user code did with sys.stderr."""
    with suppress(OSError):
        os.write(2, f"{sentence}\n".encode())


class StandardError:
    """Standard error whose failures are ignored: a verdict on standard output does not depend on it.

    stream: None if it was closed when Python started.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        with suppress(OSError):
            if self._stream is not None:
                self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        with suppress(OSError):
            if self._stream is not None:
                self._stream.flush()

    def isatty(self) -> bool:
        return self._stream is not None and self._stream.isatty()

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)
