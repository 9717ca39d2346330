"""pyserial's handler of `f28335://CASE?port=scia&pace=1`: a port at an SCI of a case.

    client's thread --write--> queue --> loop, in its own thread --> SerialLine --> RX
                    <--read--- queue <--                         <--            <-- TX

pace: the number of simulated seconds per second of real time. With pace=0 the loop has no thread: the session runs at
full speed while the client reads, flushes or waits in a write, and the client's time-outs are in simulated time.

Source: pyserial 3.5, serial.serialutil.SerialBase, and its protocol handlers.
"""

from __future__ import annotations

import threading
import time
import warnings
from collections.abc import Callable
from concurrent.futures import Future
from fractions import Fraction
from math import ceil
from typing import Any
from urllib.parse import parse_qs, urlsplit

from serial import PortNotOpenError, SerialBase, SerialException, SerialTimeoutException

from ...core.exact_number import exact_number
from ...core.phrases import counted
from ...scene.case.model import Case
from ...scene.result import Result
from ..errors import OutsideError
from ..serial_line import SerialLine
from ..session import Session
from .backlog import MOST, Backlog
from .case_for_line import case_for_line
from .loop import Door, Loop
from .pacing import Pacer

KEYS = ("port", "pace", "log", "set")
SLOWER = "write more slowly, or give a longer write_timeout"
# Seconds between attempts to queue the rest of a write; real time, or simulated time with pace=0.
WAITED = 0.01
FOREVER = 3600  # with pace=0, simulated seconds after which a flush, or a read with timeout=None, ends


class _Queue(Door):
    """A door between a session and the client, which is code of this process and usually in another thread.

    line: the serial line of the session; None after the end of the session.
    came: bytes from the line that the client has not read.
    changed: a condition variable whose lock protects this object. Threads that wait for it are notified at the end of
        each call of `turn`, and when the session ends.
    """

    def __init__(self, line: SerialLine) -> None:
        self.line: SerialLine | None = line
        # Requests that the next call of `turn` executes: (number of bytes to write, function to call with the line).
        self._requests: list[tuple[int, Callable[[SerialLine], None]]] = []
        self.came = Backlog()
        self.changed = threading.Condition()

    def turn(self) -> None:
        with self.changed:
            assert self.line is not None
            for _, request in self._requests:
                request(self.line)
            self._requests.clear()
            self.came.add(self.line.read())
            self.changed.notify_all()

    def put(self, data: bytes) -> int:
        """Queue bytes, and return how many were accepted. At most a megabyte may wait for the line."""
        with self.changed:
            taken = data[: max(0, MOST - self.waits())]
            self._requests.append((len(taken), lambda line: line.write(taken)))
            return len(taken)

    def read(self, count: int) -> bytes:
        with self.changed:
            return self.came.read(count)

    def waits(self) -> int:
        with self.changed:
            return sum(count for count, _ in self._requests) + (0 if self.line is None else self.line.waiting)

    def is_idle(self) -> bool:
        """Return True if the line has sent everything, so that a break can begin at once."""
        with self.changed:
            return not self._requests and (self.line is None or self.line.is_idle)

    def set(self, baud: int, form: str) -> None:
        """Set rate and format at the next call of `turn`. Raise OutsideError now if they are invalid."""
        with self.changed:
            if self.line is not None:
                self.line.checked(baud, form)
                self._requests.append((0, lambda line: line.set(baud, form)))

    def hold_break(self, on: bool) -> None:
        with self.changed:
            self._requests.append((0, lambda line: line.hold_break(on)))


class ClosedError(PortNotOpenError):  # type: ignore[misc]
    """A closed port was used. The message contains its URL. Programs can catch this as pyserial's PortNotOpenError."""

    def __init__(self, url: str) -> None:
        SerialException.__init__(self, f"{url} is closed; open() restarts its case")


class Serial(SerialBase):  # type: ignore[misc]
    """A port like `serial.Serial` whose other side is an SCI of a case.

    result: the result of the run, after the port is closed.
    pacer: the pacer of the session, which measures the lateness.
    lost: number of discarded bytes from the SCI, after the port is closed. At most a megabyte waits for the client.
    unsent: number of written bytes whose frames had not begun when the session ended, after the port is closed.

    While a megabyte waits for the line, a write blocks, for at most `write_timeout`. `set=...` in a URL changes a key
    of the case, and may be repeated.
    """

    is_open: bool
    result: Result | None
    lost: int
    unsent: int
    case: Case
    pacer: Pacer
    _loop: Loop | None
    _thread: threading.Thread | None

    def open(self) -> None:
        if self._port is None:
            raise SerialException("no port was given; give f28335://CASE?port=scia")
        if self.is_open:
            raise SerialException("the port is open already")
        try:
            self._begin(str(self._port))
        except (OutsideError, ValueError) as error:
            raise SerialException(str(error)) from None
        self.is_open = True

    def _begin(self, url: str) -> None:
        asked = urlsplit(url)
        every = parse_qs(asked.query, keep_blank_values=True)
        given = {key: values[-1] for key, values in every.items()}
        if unknown := [key for key in given if key not in KEYS]:
            raise OutsideError(f"{url}: there is no {unknown[0]!r} in such a URL; it has {', '.join(KEYS)}")
        try:
            pace = exact_number(given.get("pace", "1"))
        except ValueError:
            raise OutsideError(f"{url}: pace {given['pace']!r}: expected a number, as in pace=1") from None
        path, port = asked.netloc + asked.path, given.get("port", "scia")
        changes = tuple(every.get("set", ()))
        self.result, self.lost, self.unsent = None, 0, 0
        self._failed = ""
        self._stopped = threading.Event()
        self._thread = None
        if not pace:
            self._build(path, port, pace, given.get("log"), changes)
            return
        built: Future[None] = Future()

        def live() -> None:
            """Build, run and end the session in one thread, because firmware must stay in the thread that starts it."""
            try:
                self._build(path, port, pace, given.get("log"), changes)
            except BaseException as error:
                built.set_exception(error)
                return
            built.set_result(None)
            try:
                assert self._loop is not None
                self._loop.run()
            except Exception as error:
                self._failed = str(error)
                with self._queue.changed:
                    self._queue.changed.notify_all()
            self._end()

        self._thread = threading.Thread(target=live, daemon=True)
        self._thread.start()
        built.result()  # raises an error of `_build` again, in the client's thread

    def _build(self, path: str, port: str, pace: Fraction, log: str | None, changes: tuple[str, ...]) -> None:
        self.case = case_for_line(path, port, changes)
        self._pace = pace
        self._session = Session(self.case, log=log)
        self._queue = _Queue(self._session.serial(port, self._baudrate, self._form()))
        self.pacer = Pacer(self._session.ticks_per_second, pace)
        self._loop = Loop(self._session, self.pacer, [self._queue], stopped=self._stopped)

    def _end(self) -> None:
        """End the session and delete all references to it. Only the thread that ran the session may call this."""
        self.result = self._session.finish()
        self.lost = self._queue.came.lost
        with self._queue.changed:
            self.unsent = self._queue.waits()
            self._queue.line = None
            self._queue.changed.notify_all()
        self._loop = None
        del self._session

    def close(self) -> None:
        if not self.is_open:
            return
        self.is_open = False
        if self._thread is None:
            self._end()
        else:
            self._stopped.set()
            self._thread.join()
        if self.lost:
            said = f"{self._port}: {self.lost} unread bytes of the SCI were discarded, since only a megabyte is kept"
            warnings.warn(said, RuntimeWarning, stacklevel=2)
        if self.unsent and not self._failed:
            said = f"{self._port} was closed before it had sent {counted(self.unsent, 'byte')}; call flush() first"
            warnings.warn(said, RuntimeWarning, stacklevel=2)

    def clock(self) -> float:
        """Return the reading of a clock that counts simulated seconds from an arbitrary instant.

        If pace=0, this is the time of the session. Otherwise, it is computed from the computer's clock.
        """
        if self._thread is None:
            return self._session.now / self._session.ticks_per_second
        return time.monotonic() * float(self._pace)

    # Called by clients -----------------------------------------------------------

    @property
    def in_waiting(self) -> int:
        self._must_be_open()
        if self._thread is None:
            self._queue.turn()
        return len(self._queue.came)

    @property
    def out_waiting(self) -> int:
        self._must_be_open()
        return self._queue.waits()

    def read(self, size: int = 1) -> bytes:
        self._must_be_open()
        self._wait_until(lambda: len(self._queue.came) >= size, self._timeout)
        return self._queue.read(size)

    def write(self, data: Any) -> int:
        self._must_be_open()
        sent = bytes(data)
        timeout = self._write_timeout
        clock = self.clock if self._thread is None else time.monotonic
        end = None if timeout is None else clock() + timeout
        done = self._queue.put(sent)
        while done < len(sent):
            if end is not None and clock() >= end:
                raise SerialTimeoutException(
                    f"{done} of {len(sent)} bytes were written, and a megabyte waits; {SLOWER}"
                )
            self._wait_until(lambda: self._queue.waits() < MOST, WAITED)
            self._must_be_open()
            done += self._queue.put(sent[done:])
        return len(sent)

    def flush(self) -> None:
        """Wait until the frames of all written bytes have begun. The last frame may not have ended yet.

        If pace=0, wait at most FOREVER simulated seconds.
        """
        self._must_be_open()
        self._wait_until(lambda: not self._queue.waits(), None)

    def reset_input_buffer(self) -> None:
        self._must_be_open()
        self._queue.read(len(self._queue.came))

    def reset_output_buffer(self) -> None:
        """Do nothing, because bytes cannot be taken back from the line's queue."""
        self._must_be_open()

    def _wait_until(self, over: Callable[[], bool], timeout: float | None) -> None:
        """Wait until `over` returns True, the time `timeout` is over, or the session fails.

        timeout: with pace=0, in simulated seconds; None means FOREVER. With other paces, in seconds of real time; None
            means no limit.

        If the session fails, this method raises SerialException with pace=0, and returns with other paces.
        """
        if self._thread is not None:
            with self._queue.changed:
                self._queue.changed.wait_for(lambda: over() or self._failed, timeout)
            return
        session = self._session
        end = session.now + ceil((FOREVER if timeout is None else timeout) * session.ticks_per_second)
        step = session.ticks("100 us")
        self._queue.turn()
        while not over() and session.now < end:
            try:
                session.advance(min(session.now + step, end))
            except Exception as error:
                self._failed = str(error)
                raise SerialException(self._failed) from error
            self._queue.turn()

    def _must_be_open(self) -> None:
        if not self.is_open:
            raise ClosedError(str(self._port))
        if self._failed:
            raise SerialException(self._failed)

    # Called by pyserial ------------------------------------------------------

    def _form(self) -> str:
        return f"{self._bytesize}{str(self._parity).lower()}{self._stopbits:g}"

    def _reconfigure_port(self, *_: Any, **__: Any) -> None:
        if self.is_open:
            try:
                self._queue.set(self._baudrate, self._form())
            except OutsideError as error:
                raise ValueError(str(error)) from None

    def _update_break_state(self) -> None:
        self._must_be_open()
        self._queue.hold_break(self._break_state)

    def send_break(self, duration: float = 0.25) -> None:
        """Send a break after all written bytes. duration: in seconds of real time; in simulated seconds if pace=0."""
        self._must_be_open()
        self._wait_until(self._queue.is_idle, None)
        if self._thread is not None:
            super().send_break(duration)
            return
        if not self._queue.is_idle():
            raise SerialException(f"a break cannot begin: bytes are on their way after {FOREVER} simulated seconds")
        assert self._queue.line is not None
        self._queue.line.send_break(f"{duration * 1e6:.0f} us")

    def _update_rts_state(self) -> None:
        """Do nothing, because an SCI has no RTS line."""

    _update_dtr_state = _update_rts_state
    cts = dsr = ri = cd = property(lambda self: False)


def serial_class_for_url(url: str) -> tuple[str, type[Serial]]:
    return url, Serial
