"""A command runs in a worker process, so that its exit status is a verdict only if the command was completed.

    waiting process                    worker process
        |--fork--------------------------> run the command
    forward signals                        write its output
        |<--pipe: "pid status"------------ complete
    exit with the status, with 3, or by the signal that ended the worker

User code can end the worker without Python's knowledge. If it does so by `os._exit` or `execv`, nothing is written to
the pipe, and the command exits with status 3 and a message. If a signal ends the worker, as `abort` in C does, the
command ends by the same signal. If the worker's standard output was closed or redirected, 3 replaces status 0 or 1.

The worker reports the temporary files of its outputs with `remove_unless_complete`. The waiting process removes them if
the worker ends before its output is complete.

SIGTERM and SIGHUP raise KeyboardInterrupt in the worker, as Ctrl-C does. On Linux, the worker receives SIGTERM if the
waiting process is killed. On Windows, which has no `fork`, the command runs without a worker.
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

STOPPED, NO_VERDICT = 2, 3
REPEATED = 1.0  # maximum time, in seconds, between a signal to the process group and its forwarded copy
FORWARDED = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2")  # sent on to the worker
STOPPING = ("SIGINT", "SIGTERM", "SIGHUP")  # raise KeyboardInterrupt in the worker
PR_SET_PDEATHSIG = 1

can_fork = hasattr(os, "fork")
_temporary_files = -1  # the worker's end of the pipe for names of temporary files; -1 if no process waits


class Completion:
    """The worker's end of the pipe to the waiting process. name: the command's name, for messages."""

    def __init__(self, name: str, pipe: int) -> None:
        self.name = name
        self._pipe = pipe
        self._stdout = sys.stdout
        self._copy: int | None = None
        with suppress(OSError):
            self._copy = os.dup(1)

    def flaw(self) -> str:
        """Return the reason why output may be missing on the original standard output; "" if there is none."""
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
        """Report to the waiting process the exit status, and that all output is written.

        If user code has closed the pipe, nothing is reported, and the output counts as incomplete.
        """
        with suppress(OSError):
            os.write(self._pipe, _completed(os.getpid(), status))


def remove_unless_complete(file: str) -> None:
    """Ask the waiting process to remove a file if the worker ends before its output is complete."""
    if _temporary_files >= 0:
        with suppress(OSError):  # user code has closed the pipe, or the pipe is full
            os.write(_temporary_files, os.fsencode(os.path.abspath(file)) + b"\0")


def supervise(work: Callable[[], object], name: str) -> NoReturn:
    """Run `work` in a worker process and exit with its status, which `work` can set by raising SystemExit.

    name: the command's name, for messages.
    """
    if not can_fork:
        work()
        sys.exit(0)
    if sys.stderr is None:
        # Open descriptor 2. Otherwise, the next opened file would get it, and C code would write messages to this file.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        os.set_inheritable(2, True)
    try:
        done = split(name)
    except KeyboardInterrupt:  # it came before the worker began, so it ends the worker without a traceback
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.raise_signal(signal.SIGINT)
        raise
    sys.stderr = StandardError(sys.stderr)
    status = _status_of(work)
    for number in _numbers(STOPPING):  # from now on, a signal ends the worker without a traceback
        if signal.getsignal(number) is _interrupt:
            signal.signal(number, signal.SIG_DFL)
    flaw = done.flaw()
    if flaw and status in (0, 1):
        _say(f"{name}: {flaw}, so its output is not complete; exit status {NO_VERDICT} is no verdict")
        status = NO_VERDICT
    done.complete(status)
    left = [one.name for one in threading.enumerate() if one is not threading.main_thread() and not one.daemon]
    if left:  # at a normal exit, Python would wait for these threads
        _say(f"{name}: ended thread {left[0]!r}, which user code started and which was still running")
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError, ValueError):  # the stream is None or closed
            stream.flush()
    os._exit(status)  # without the destruction of all modules, which takes longer than the fork


def split(name: str, *, strict: bool = True) -> Completion:
    """Fork. The worker returns from this function. The waiting process exits with the worker's status.

    name: the command's name, for messages.
    strict: what to do if the worker exits without a call of `complete`. True: exit with NO_VERDICT and a message.
        False: exit with the worker's status if it is not 0, otherwise as for True.

    If a signal ends the worker, the waiting process ends by the same signal. If the worker exits with another status
    than it has reported, the waiting process exits with NO_VERDICT.
    """
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, _numbers(FORWARDED))
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # if SIGCHLD were ignored, waitpid would return no status
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
    """Run `work` and return its exit status."""
    try:
        work()
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    except KeyboardInterrupt:  # `work` handles it, except at its beginning and its end
        _say("stopped")
        return STOPPED
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
        with suppress(ProcessLookupError):  # Python may call this handler when `waitpid` has removed the worker already
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
        if said.startswith(f"{worker} ".encode()) and by in _numbers(STOPPING):
            # The worker had already reported its exit status when the signal ended it, so this status is valid.
            os._exit(int(said.split()[1]))
        _die_by(by, name, complete)
    status = os.WEXITSTATUS(how)
    if said == _completed(worker, status) or (status and not complete and not strict):
        os._exit(status)
    why = "after its output" if complete else "before its output was complete"
    _say(f"{name}: user code ended the process with status {status} {why}; exit status {NO_VERDICT} is no verdict")
    os._exit(NO_VERDICT)


def _waiting_in(pipe: int) -> bytes:
    os.set_blocking(pipe, False)  # do not wait for the end of file: a child of the worker may still have the pipe open
    try:
        return os.read(pipe, 1 << 16)
    except BlockingIOError:
        return b""


def _die_by(number: int, name: str, complete: bool) -> NoReturn:
    """End this process by the signal that ended the worker, so that its parent is informed of that signal."""
    if number not in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        why = "after its output" if complete else "before its output was complete"
        _say(f"{name}: {signal.strsignal(number)}: a signal ended the process {why}")
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # no core dump, because it would replace that of the worker
    if number != signal.SIGKILL:
        signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    os._exit(128 + number)


# The worker --------------------------------------------------------------------------------

_stopped_at = float("-inf")


def _interrupt(number: int, _: FrameType | None) -> None:
    """Handle a signal: raise KeyboardInterrupt, unless another signal came up to REPEATED seconds before.

    Ctrl-C reaches the worker twice: as a signal to the process group, and as the copy from the waiting process.
    """
    global _stopped_at
    before, _stopped_at = _stopped_at, time.monotonic()
    if _stopped_at - before > REPEATED:
        raise KeyboardInterrupt


def _end_with(caller: int) -> None:
    """Ask Linux to send SIGTERM to this process when the waiting process ends."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != caller:
            # The waiting process had ended before `prctl` was called, so Linux will not send the signal.
            os._exit(NO_VERDICT)


def _numbers(names: tuple[str, ...]) -> list[signal.Signals]:
    return [signal.Signals[name] for name in names]


def _say(sentence: str) -> None:
    """Write a line to standard error, regardless of what user code did with sys.stderr."""
    with suppress(OSError):
        os.write(2, f"{sentence}\n".encode())


class StandardError:
    """Standard error with write errors ignored, so that they do not change the exit status.

    stream: the standard error of Python; None if it was closed when Python started.
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
