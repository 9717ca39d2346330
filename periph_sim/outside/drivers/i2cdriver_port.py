"""An I2CDriver adapter that is connected to a case's bus. Programs can open its serial port within a `with` block.

program --/dev/pts/N, or LINK--> I2cDriverDoor, in the thread that owns the session --> SDA, SCL
"""

from __future__ import annotations

import os
import select
import threading
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from ...scene.case.model import Case
from ...scene.result import Result
from ..session import Session

if TYPE_CHECKING:
    from ..live.i2cdriver_door import I2cDriverDoor

STEP = "1 ms"  # simulated time by which each step advances the session during a capture
TURN = 0.001  # real time in seconds from one step to the next during a capture


class I2cDriverPort:
    """A context manager that runs a session with an adapter in a thread.

    path: the path that programs open: `link`, or that of the terminal if `link` is None.
    result: the result of the run, after the block.
    case, outside, log: as in a `Session`.
    link: the path of a symbolic link to `path`, or None.
    run_up: the simulated time that passes before a program can open the port.
    pause: the simulated time that passes before each START, because a program's own pauses do not advance simulated
        time. During a capture, simulated time advances by itself.

    Raise BadCase and OutsideError like a `Session`, and OutsideError if `link` exists (see `TerminalDoor`). An error
    that ends the session within the block is raised at the end of the block.
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
        self._failed: Exception | None = None  # the error that ended the session early
        self._ready = threading.Event()
        # Firmware runs in the thread that built it, so this thread builds, runs and ends the session.
        arguments = case, outside, log, None if link is None else Path(link), run_up, pause
        self._thread = threading.Thread(target=self._run, args=arguments, name="i2cdriver", daemon=True)

    def __enter__(self) -> I2cDriverPort:
        self._wake_read, self._wake_write = os.pipe()
        self._thread.start()
        self._ready.wait()
        if self._failed is not None:
            self._end()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._end()

    def _end(self) -> None:
        os.write(self._wake_write, b".")
        self._thread.join()
        for file in (self._wake_read, self._wake_write):
            os.close(file)
        if self._failed is not None:
            raise self._failed

    def _run(
        self,
        case: Case | str | Path,
        outside: Sequence[str] | None,
        log: str | Path | None,
        link: Path | None,
        run_up: str,
        pause: str,
    ) -> None:
        try:
            from ..live.i2cdriver_door import I2cDriverDoor  # imported here, because Windows has no pseudo-terminals

            with Session(case, outside, log=log) as session:
                session.advance(session.ticks(run_up))
                with closing(I2cDriverDoor(session, link, pause)) as door:
                    self.path = door.path if link is None else str(link)
                    self._ready.set()
                    self._serve(session, door)
                    self.result = session.finish()
        except Exception as error:
            self._failed = error
        self._ready.set()

    def _serve(self, session: Session, door: I2cDriverDoor) -> None:
        """Let the door transfer bytes until the `with` block is left.

        Simulated time passes only while commands of the client use the lines, and while the client captures the bus.
        """
        while True:
            writes = [door.file] if len(door.back) else []
            turn = TURN if door.adapter.capturing else None
            ready, writable, _ = select.select([self._wake_read, *door.files()], writes, [], turn)
            if self._wake_read in ready:
                return
            if not ready and not writable:
                session.advance(session.now + session.ticks(STEP))
            door.turn()
