"""An I2CDriver adapter that is connected to a case's bus. Programs can open its serial port within a block.

program --/dev/pts/N, or LINK--> thread, which owns the session --I2cDriver--> SDA, SCL
"""

from __future__ import annotations

import os
import select
import threading
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

from ...scene.case.model import Case
from ...scene.result import Result
from ..session import Session
from .i2cdriver_adapter import I2cDriver

STEP = "1 ms"  # simulated time by which each step advances the session during a capture
TURN = 0.001  # real time in seconds from one step to the next during a capture


class I2cDriverPort:
    """A context manager that runs a session with an adapter in a thread.

    path: the path that programs open.
    result: the result of the run, after the block.
    case, outside, log: as in a `Session`.
    link: the path of a symbolic link to `path`, or None.
    run_up: the simulated time that passes before a program can open the port.
    pause: the simulated time that passes before each START, because a program's own pauses do not advance simulated
        time. During a capture, simulated time advances by itself.

    Raise BadCase and OutsideError like a `Session`, and OutsideError if `link` exists (see `PseudoTerminal`). Later
    errors are raised at the end of the block.
    """

    path: str
    result: Result

    def __init__(
        self,
        case: Case | str | Path,
        outside: Sequence[str] | None = None,
        *,
        link: str | Path | None = None,
        log: str | Path | None = None,
        run_up: str = "1 ms",
        pause: str = "100 us",
    ) -> None:
        self._link = None if link is None else Path(link)
        self._thread = _Thread(case, outside, log, run_up, pause)

    def __enter__(self) -> I2cDriverPort:
        thread = self._thread
        self.path = thread.open_port(self._link)
        try:
            thread.start()
            thread.ready.wait()
            if thread.failed is not None:
                raise thread.failed
        except Exception:
            thread.end()
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._thread.end()
        if self._thread.failed is not None:
            raise self._thread.failed
        assert self._thread.result is not None
        self.result = self._thread.result


class _Thread(threading.Thread):
    """The thread that builds, runs and ends the session. Firmware must run in the thread that builds it.

    failed: the error that ended the session early, or None.
    """

    def __init__(
        self,
        case: Case | str | Path,
        outside: Sequence[str] | None,
        log: str | Path | None,
        run_up: str,
        pause: str,
    ) -> None:
        super().__init__(name="i2cdriver", daemon=True)
        self._asked = (case, outside, log, run_up, pause)
        self.ready = threading.Event()
        self.failed: Exception | None = None
        self.result: Result | None = None

    def open_port(self, link: Path | None) -> str:
        """Open the pseudo-terminal. Return its path, or that of the link if there is one."""
        from ..live.pseudo_terminal import PseudoTerminal

        self._terminal = PseudoTerminal(link)
        self._wake_read, self._wake_write = os.pipe()
        return self._terminal.path if link is None else str(link)

    def end(self) -> None:
        os.write(self._wake_write, b".")
        if self.ident is not None:
            self.join()
        for file in (self._wake_read, self._wake_write):
            os.close(file)
        self._terminal.close()

    def run(self) -> None:
        case, outside, log, run_up, pause = self._asked
        try:
            with Session(case, outside, log=log) as session:
                session.advance(session.ticks(run_up))
                adapter = I2cDriver(session, session.ticks(pause))
                self.ready.set()
                while self._turn(session, adapter):
                    pass
                self.result = session.finish()
        except Exception as error:
            self.failed = error
        self.ready.set()

    def _turn(self, session: Session, adapter: I2cDriver) -> bool:
        """Wait for commands of the client, or for a step of a capture, and send the answers.

        Return False if the block was left.
        """
        files = [self._terminal.file, self._wake_read]
        ready, _, _ = select.select(files, [], [], TURN if adapter.capturing else None)
        if self._wake_read in ready:
            return False
        if ready:
            return self._give(adapter.receive(self._terminal.read()))
        session.advance(session.now + session.ticks(STEP))
        return self._give(adapter.captured())

    def _give(self, data: bytes) -> bool:
        """Send all data. Wait while the client reads none of it. Return False if the block was left meanwhile."""
        while data:
            ready, writable, _ = select.select([self._wake_read], [self._terminal.file], [])
            if ready:
                return False
            if writable:
                data = data[self._terminal.write(data) :]
        return True
