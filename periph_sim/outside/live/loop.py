"""Loop that advances a session in steps, in the session's thread. A pacer delays each step until it is due.

doors --turn--> session --advance by a step--> doors --turn--> ...      until it is stopped, or reaches a given tick

A door is a connection between the session and clients. Between the steps, the doors transfer bytes.
"""

from __future__ import annotations

import select
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Protocol

from ..session import Session
from .pacing import Pacer

STEP = "1 ms"  # simulated time of a step; a byte waits at most this long for the next transfer by a door


class Door(Protocol):
    """A connection between a session and clients, which the loop serves between steps."""

    def files(self) -> Sequence[int]:
        """Return the numbers of the files whose input the loop waits for."""
        return ()

    def turn(self) -> None:
        """Transfer bytes in both directions. The loop calls this between steps.

        An implementation may advance the session, for example to execute an I2C transfer.
        """


class Loop:
    """Loop that advances a session in steps.

    step: the simulated time of a step.
    stopped: an event that ends `run` after the present step. Any thread or signal handler may set it.
    """

    def __init__(
        self,
        session: Session,
        pacer: Pacer,
        doors: Sequence[Door],
        step: str = STEP,
        stopped: threading.Event | None = None,
    ) -> None:
        self._session = session
        self._pacer = pacer
        self._doors = doors
        self._step = max(1, session.ticks(step))
        self.stopped = stopped or threading.Event()

    def run(self, until: int | None = None) -> None:
        """Run until `stopped` is set or tick `until` is reached. until: None for no limit."""
        session = self._session
        while not self.stopped.is_set() and (until is None or session.now < until):
            due = session.now + self._step
            due = due if until is None else min(due, until)
            self._wait(due)
            self._turn()
            if session.now < due:
                session.advance(due)
            self._pacer.reached(session.now)
        self._turn()

    def _wait(self, due: int) -> None:
        """Wait for the real time of tick `due`, the end of a step. Meanwhile, the doors transfer bytes that arrive."""
        left = self._pacer.wait(due)
        while left > 0 and not self.stopped.is_set():
            files = [file for door in self._doors for file in door.files()]
            if not files:
                time.sleep(left)  # on Windows, select requires at least one file
            elif select.select(files, [], [], left)[0]:
                self._turn()
            left = self._pacer.wait(max(due, self._session.now))

    def _turn(self) -> None:
        for door in self._doors:
            door.turn()


@contextmanager
def signals_calling(on_signal: Callable[[int, Any], None]) -> Iterator[None]:
    """Call a function on Ctrl-C and on SIGTERM, within a `with` block.

    SIGTERM is needed because commands that a shell runs in the background ignore Ctrl-C.
    """
    before = {number: signal.signal(number, on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
