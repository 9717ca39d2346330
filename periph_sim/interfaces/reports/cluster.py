"""Executor that makes the calls of a command on the workers of a Dask cluster, in place of a pool of `processes`.

    command --submit--> ClusterExecutor --> Dask scheduler --> Dask workers --> processes (see `cluster_worker`)

If a worker ends, Dask repeats its unfinished calls on other workers. If the cluster itself fails, the calls raise
ClusterError. Otherwise, calls behave as in a pool of processes: for instance, a call raises BrokenProcessPool if
firmware ends the process of the call.
"""

from __future__ import annotations

import logging
import os
import pickle
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, closing, contextmanager, suppress
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from platform import python_version
from threading import Event, Lock, Thread
from time import monotonic
from typing import Any, ParamSpec, TypeVar
from uuid import uuid4

from ...core.input_error import InputError
from ...proof.dependencies import package_digest
from .cluster_worker import PREFIX, Kind, Reply, Session
from .processes import DIED, processes

CONNECT = 10  # seconds within which a scheduler must answer when a command connects
LOST = 30.0  # seconds without an answer of the scheduler, or without any worker, after which a command stops
LOGGERS = ("distributed", "distributed.client", "tornado", "tornado.application", "asyncio")
LOOK = 1.0  # seconds between two checks of the cluster

# The call that a worker makes, as source text, because a Dask worker ends if it receives a function that it cannot
# import.
CALL = "__import__('periph_sim.interfaces.reports.cluster_worker', fromlist=['run_part']).run_part(*arguments)"
GONE = "does not answer any more"

P = ParamSpec("P")
T = TypeVar("T")


class ClusterError(InputError):
    """Error for a cluster that cannot be used, or can no longer be used. The message is one sentence."""


class ClusterExecutor(Executor):
    """An executor whose calls are made by the workers of a Dask cluster.

    client: a `Client` of Dask. Its type is Any, because Dask is an optional dependency.
    address: the address of the scheduler, for messages.
    """

    def __init__(self, client: Any, address: str) -> None:
        variables = {name: value for name, value in os.environ.items() if name.startswith(PREFIX)}
        session = Session(uuid4().hex, os.getcwd(), variables, python_version(), package_digest())
        self._session = pickle.dumps(session)
        self._client = client
        self._dask = client.get_executor(pure=False)
        self._address = address
        self._lock = Lock()
        # For each call without a result, its future of Dask; None while the call is being sent. An entry is removed
        # when the result is there, because Dask repeats even a finished call if its worker ends while the future of
        # Dask still exists.
        self._pending: dict[Future[Any], Future[Reply] | None] = {}
        self._lost = ""  # the reason why the cluster can no longer be used
        self._closed = Event()
        self._watch = Thread(target=self._look, name="periph-sim cluster watch", daemon=True)
        self._watch.start()

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Start a call in a process that serves calls of this executor only."""
        return self._submit(partial(fn, **kwargs), args, is_alone=False)

    def submit_alone(self, fn: Callable[..., T], /, *args: object) -> Future[T]:
        """Start a call in a new process, which makes no other call."""
        return self._submit(fn, args, is_alone=True)

    def cancel(self) -> None:
        """Cancel all calls that have no result yet. Workers finish those that they have begun."""
        with self._lock:
            pending = list(self._pending)
        for future in pending:
            future.cancel()

    def close(self) -> None:
        """Cancel all calls and end the connection."""
        self.cancel()
        self._closed.set()
        with suppress(Exception):
            self._client.close(timeout=CONNECT)
        self._watch.join(CONNECT)

    def _submit(self, fn: Callable[..., T], arguments: tuple[object, ...], *, is_alone: bool) -> Future[T]:
        future: Future[T] = Future()
        payload = pickle.dumps((fn, arguments))
        with self._lock:
            if self._lost:
                future.set_exception(ClusterError(self._lost))
                return future
            self._pending[future] = None
        try:
            sent = self._dask.submit(eval, CALL, {"arguments": (self._session, payload, is_alone)})
        except Exception:
            self._lose(GONE)
            return future
        with self._lock:
            self._pending[future] = sent
        future.add_done_callback(self._forget)
        sent.add_done_callback(lambda sent: self._settle(future, sent))
        return future

    def _forget(self, future: Future[Any]) -> None:
        with self._lock:
            sent = self._pending.pop(future, None)
        if sent is not None and future.cancelled():
            sent.cancel()

    def _settle(self, future: Future[Any], sent: Future[Reply]) -> None:
        """Set the result of a call from its future of Dask. Dask calls this method in one of its own threads."""
        if future.done():  # the call was cancelled, or the cluster was lost
            return
        if sent.cancelled():
            self._lose(GONE)
            return
        with suppress(Exception):  # the call was cancelled meanwhile, or the cluster was lost
            try:
                future.set_result(self._result_of(sent))
            except BaseException as error:
                future.set_exception(error)

    def _result_of(self, sent: Future[Reply]) -> object:
        error = sent.exception()
        if error is not None:
            raise ClusterError(self._why(error)) from None
        kind, data = sent.result()
        if kind is Kind.DIED:
            raise BrokenProcessPool(DIED)
        if kind is Kind.REFUSED:
            raise ClusterError(f"a worker of the Dask scheduler at {self._address} {data.decode()}")
        found = pickle.loads(data)
        if kind is Kind.ERROR:
            raise found
        return found

    def _why(self, error: BaseException) -> str:
        """Return a sentence for an error that a worker, or the scheduler, raised before a process could reply."""
        if type(error).__name__ == "KilledWorker":
            return (
                f"one worker after the other of the Dask scheduler at {self._address} ended while it ran the same part"
            )
        fix = "install the same version of periph_sim there"
        return f"a worker of the Dask scheduler at {self._address} cannot run this command ({_reason(error)}); {fix}"

    def _look(self) -> None:
        """Check regularly that the scheduler answers and has workers, until the executor is closed.

        If the scheduler has not answered for LOST seconds, or has had no worker for LOST seconds, give the cluster up.
        """
        worked_at = monotonic()
        while not self._closed.wait(LOOK):
            try:
                workers = self._client.sync(self._client.scheduler.ncores, callback_timeout=LOST)
            except Exception:
                self._lose(GONE)
                return
            if workers:
                worked_at = monotonic()
            elif monotonic() - worked_at > LOST:
                fix = f"start one with `dask worker {self._address}`"
                self._lose(f"has had no worker for {LOST:g} s; {fix}")
                return

    def _lose(self, reason: str) -> None:
        """Give the cluster up: all calls without a result, and all later calls, raise ClusterError.

        reason: the end of the message.
        """
        with self._lock:
            if self._lost or self._closed.is_set():
                return
            self._lost = f"the Dask scheduler at {self._address} {reason}"
            pending = list(self._pending)
        for future in pending:
            with suppress(Exception):  # the result came, or the call was cancelled, meanwhile
                future.set_exception(ClusterError(self._lost))


def connected(address: str) -> AbstractContextManager[ClusterExecutor]:
    """Return a context that is connected to a Dask scheduler. Raise ClusterError at once if Dask is not installed.

    Entering the context raises ClusterError if there is no scheduler at this address.
    """
    if find_spec("distributed") is None:
        raise ClusterError("--cluster needs Dask, which is not installed; use: pip install 'periph-sim[dask]'")
    return _connected(address)


@contextmanager
def _connected(address: str) -> Iterator[ClusterExecutor]:
    import_module("distributed")  # comes before the loop, because this import sets the levels of loggers, too
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        client = _client(address)
    except Exception as error:
        reason = _reason(error)
        expected = "expected the address of a scheduler, for instance 10.0.0.5:8786"
        raise ClusterError(f"--cluster {address}: no Dask scheduler answers ({reason}); {expected}") from None
    with closing(ClusterExecutor(client, address)) as executor:
        yield executor


def _client(address: str) -> Any:
    """Return a client of the scheduler at this address.

    The client is made in a thread, so that the time limit CONNECT always applies. Dask itself waits forever if the
    server at the address is of another kind, such as an HTTP server.
    """
    made: Future[Any] = Future()

    def make() -> None:
        try:
            made.set_result(import_module("distributed").Client(address, timeout=CONNECT, set_as_default=False))
        except Exception as error:
            made.set_exception(error)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # warnings about differing versions of Dask
        Thread(target=make, name="periph-sim cluster connection", daemon=True).start()
        try:
            return made.result(CONNECT + 1)
        except TimeoutError as error:
            raise TimeoutError(str(error) or f"no answer within {CONNECT} s") from None


def _reason(error: BaseException) -> str:
    """Return the first line of an error's message, or the name of the error's class if the message is empty."""
    return next(iter(str(error).splitlines()), "") or type(error).__name__


@contextmanager
def worker_pool(jobs: int, cluster: ClusterExecutor | None) -> Iterator[Executor]:
    """Yield the cluster, or a pool of `jobs` processes if `cluster` is None.

    At the end of the block, calls that have not begun are cancelled.
    """
    if cluster is None:
        with processes(jobs) as pool:
            yield pool
        return
    try:
        yield cluster
    finally:
        cluster.cancel()
