"""Execution of calls of a command by a worker of a Dask cluster, in a process that the worker starts for the command.

    Dask worker --request--> process with the folder of the command --> the function --reply--> Dask worker

The process has run nothing before this command, so it reads all files of the case anew. If firmware ends the process,
the worker continues. `multiprocessing` cannot start this process, because a Dask worker with a nanny is a daemon
process of `multiprocessing`, which must not have children. Therefore `subprocess` starts it and connects it by pipes.

A process without a request for IDLE seconds is ended. A process ends itself when its worker ends, even by SIGKILL.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from queue import SimpleQueue
from signal import SIG_DFL, SIGINT, signal
from threading import Lock, Thread, Timer
from typing import Any, BinaryIO

PREFIX = "PERIPH_SIM_"  # the process receives the environment variables of the command that begin with this
IDLE = 10.0  # seconds without a request after which a process is ended
BEGIN = (
    "import os, pickle, sys; requests = os.fdopen(os.dup(0), 'rb'); sys.path = pickle.load(requests); "
    "from periph_sim.interfaces.reports.cluster_worker import serve; serve(requests)"
)
CUT_OFF = (OSError, EOFError, pickle.UnpicklingError)  # errors of a pipe to a process that has ended


class Kind(Enum):
    """Kinds of replies.

    RESULT: the function has returned.
    ERROR: the function has raised an error.
    DIED: the process has ended before it replied.
    REFUSED: the process cannot be started, or its versions differ from those of the command.
    """

    RESULT = "result"
    ERROR = "error"
    DIED = "died"
    REFUSED = "refused"


Reply = tuple[Kind, bytes]  # the kind; the pickled result or error, a sentence in UTF-8 if refused, or b"" if died


@dataclass(frozen=True)
class Session:
    """A command that uses the cluster.

    name: a unique name.
    folder: the current folder of the command.
    environment: the environment variables of the command whose names begin with PREFIX.
    python: the version of Python that runs the command.
    package: the digest of the command's periph_sim.
    """

    name: str
    folder: str
    environment: dict[str, str]
    python: str
    package: str


# In the Dask worker -------------------------------------------------------------


class _Process:
    """A process for the requests of a session. The constructor raises OSError if the process cannot be started."""

    def __init__(self, session: Session) -> None:
        others = {name: value for name, value in os.environ.items() if not name.startswith(PREFIX)}
        self._popen = subprocess.Popen(
            [sys.executable, "-c", BEGIN],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            cwd=session.folder,
            env=others | session.environment,
        )
        self._timer: Timer | None = None
        self._first = pickle.dumps(sys.path) + pickle.dumps(session)

    def request(self, payload: bytes) -> Reply:
        """Send a request and wait for the reply, which has kind DIED if the process ends before it replies."""
        requests, replies = self._popen.stdin, self._popen.stdout
        assert requests is not None and replies is not None
        try:
            requests.write(self._first + pickle.dumps(payload))
            requests.flush()
            self._first = b""
            reply: Reply = pickle.load(replies)
        except CUT_OFF:
            return Kind.DIED, b""
        return reply

    def end_later(self, end: Callable[[], None]) -> None:
        """Call `end` in IDLE seconds, unless `use` is called before."""
        self._timer = Timer(IDLE, end)
        self._timer.daemon = True
        self._timer.start()

    def use(self) -> None:
        if self._timer is not None:
            self._timer.cancel()

    def end(self) -> None:
        self._popen.kill()
        self._popen.communicate()


_unused: dict[str, list[_Process]] = {}  # a dictionary from the names of sessions to processes without a request
_lock = Lock()


def run_part(sent: bytes, payload: bytes, is_alone: bool) -> Reply:
    """Execute a request of a session in a process, and return the reply.

    sent: the pickled session.
    payload: the function and its arguments, pickled as one tuple.
    is_alone: True to use a new process, which serves no other request.
    """
    session: Session = pickle.loads(sent)
    try:
        process = _Process(session) if is_alone else _take(session)
    except OSError as error:
        return Kind.REFUSED, f"cannot start a process in {session.folder} ({error.strerror})".encode()
    kind, data = process.request(payload)
    if is_alone or kind not in (Kind.RESULT, Kind.ERROR):
        process.end()
    else:
        _put_back(session, process)
    return kind, data


def _take(session: Session) -> _Process:
    with _lock:
        unused = _unused.get(session.name)
        process = unused.pop() if unused else None
    if process is None:
        return _Process(session)
    process.use()
    return process


def _put_back(session: Session, process: _Process) -> None:
    def end() -> None:
        with _lock:
            is_unused = process in _unused.get(session.name, ())
            if is_unused:
                _unused[session.name].remove(process)
        if is_unused:
            process.end()

    process.end_later(end)
    with _lock:
        _unused.setdefault(session.name, []).append(process)


# In the process of a session ----------------------------------------------------


def serve(requests: BinaryIO) -> None:
    """Execute requests until their stream is closed, and write the replies to standard output.

    User code has empty standard input, and its output goes to standard error.
    """
    signal(SIGINT, SIG_DFL)
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    session: Session = pickle.load(requests)
    refused = _why_refused(session)
    waiting: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_read, args=(requests, waiting), name="periph-sim requests", daemon=True).start()
    while True:
        payload = waiting.get()
        reply = (Kind.REFUSED, refused.encode()) if refused else _execute(payload)
        pickle.dump(reply, replies)
        replies.flush()


def _read(requests: BinaryIO, waiting: SimpleQueue[bytes]) -> None:
    """Put requests into a queue. End this process as soon as its worker has ended, also in the middle of a request."""
    try:
        while True:
            waiting.put(pickle.load(requests))
    except CUT_OFF:
        os._exit(1)


def _why_refused(session: Session) -> str:
    from platform import python_version

    from ...proof.dependencies import package_digest

    if session.python != python_version():
        return f"has Python {python_version()}, and this command runs in Python {session.python}; use the same"
    if session.package != package_digest():
        return "has another version of periph_sim than this command; install the same"
    return ""


def _execute(payload: bytes) -> Reply:
    try:
        work, arguments = pickle.loads(payload)
        return Kind.RESULT, pickle.dumps(work(*arguments))
    except Exception as error:
        return Kind.ERROR, _pickled(error)


def _pickled(error: Exception) -> bytes:
    try:
        found: Any = pickle.dumps(error)
        pickle.loads(found)
        return bytes(found)
    except Exception:  # for example, the class of the error requires arguments that the pickled error does not contain
        return pickle.dumps(RuntimeError(f"{type(error).__name__}: {error}"))
