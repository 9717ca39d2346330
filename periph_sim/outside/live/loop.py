"""Loop that advances a session in steps, in the session's thread. A pacer delays each step until it is due.

doors --turn--> session --advance by a step--> doors --turn--> ...      until `stop`, or a tick

A door is a connection between the session and clients. Between the steps, the doors transfer bytes.
"""

from __future__ import annotations

import select
import signal
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
        """Transfer bytes in both directions. The loop calls this between steps. The door may advance the session."""


class Loop:
    """Loop that advances a session in steps. step: the simulated time of a step."""

    def __init__(self, session: Session, pacer: Pacer, doors: Sequence[Door], step: str = STEP) -> None:
        self._session = session
        self._pacer = pacer
        self._doors = doors
        self._step = max(1, session.ticks(step))
        self._stopped = False

    def stop(self) -> None:
        """End `run` after the present step. Any thread or signal handler may call this."""
        self._stopped = True

    def run(self, until: int | None = None) -> None:
        """Run until tick `until` or until `stop` is called; if `until` is None, until `stop` is called."""
        session = self._session
        while not self._stopped and (until is None or session.now < until):
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
        while left > 0 and not self._stopped:
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
    """Within a block, call a function on Ctrl-C and on SIGTERM.

    SIGTERM is needed because commands that a shell runs in the background ignore Ctrl-C.
    """
    before = {number: signal.signal(number, on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
