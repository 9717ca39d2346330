"""A case's bus as an I2CDriver at a serial port: a case goes in; within the block programs open the path.

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
from ..errors import OutsideError
from ..session import Session
from .i2cdriver_adapter import I2cDriver

AT_ONCE = 4096  # bytes
STEP = "1 ms"  # of simulated time, while a capture waits for others
TURN = 0.001  # seconds of real time from one such step to the next


class I2cDriverPort:
    """A context manager. path: what programs open. result: what the time came to, once the block is left.

    case, outside, log: as a Session has them. link: a name for the path, made as a symbolic link. run_up: what passes
    before a program can open it. pause: what passes before each START, since a program's own pauses move no simulated
    time; in a capture time passes by itself. BadCase and OutsideError as of a Session, OutsideError for a link that is
    taken; what goes wrong later is raised as the block is left.
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
        self.path = thread.open_port()
        try:
            if self._link is not None:
                self._make_link(self._link)
            thread.start()
            thread.ready.wait()
            if thread.failed is not None:
                raise thread.failed
        except Exception:
            self._leave()
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._leave()
        if self._thread.failed is not None:
            raise self._thread.failed
        assert self._thread.result is not None
        self.result = self._thread.result

    def _make_link(self, link: Path) -> None:
        try:
            link.symlink_to(self.path)
        except OSError as error:
            self._link = None
            raise OutsideError(f"{link}: {error.strerror}; give the link another name") from None
        self.path = str(link)

    def _leave(self) -> None:
        self._thread.end()
        if self._link is not None:
            self._link.unlink(missing_ok=True)


class _Thread(threading.Thread):
    """All of the session's life: firmware runs in the thread that built it. failed: what ended it before its time."""

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
        self._files: list[int] = []
        self.ready = threading.Event()
        self.failed: Exception | None = None
        self.result: Result | None = None

    def open_port(self) -> str:
        import tty

        self._port, kept = os.openpty()  # kept open, so that the last client's leaving is no end
        self._told, self._tell = os.pipe()
        self._files = [self._port, kept, self._told, self._tell]
        tty.setraw(kept)
        os.set_blocking(self._port, False)
        return os.ttyname(kept)

    def end(self) -> None:
        os.write(self._tell, b".")
        if self.ident is not None:
            self.join()
        for file in self._files:
            os.close(file)

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
        """False where the block was left."""
        ready, _, _ = select.select([self._port, self._told], [], [], TURN if adapter.capturing else None)
        if self._told in ready:
            return False
        if ready:
            return self._give(adapter.take(os.read(self._port, AT_ONCE)))
        session.advance(session.now + session.ticks(STEP))
        return self._give(adapter.captured())

    def _give(self, data: bytes) -> bool:
        """A client that does not read is waited for; False where the block was left meanwhile."""
        while data:
            ready, writable, _ = select.select([self._told], [self._port], [])
            if ready:
                return False
            if writable:
                data = data[os.write(self._port, data) :]
        return True
