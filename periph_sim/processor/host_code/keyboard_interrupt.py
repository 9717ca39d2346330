"""Ctrl-C while C code runs: SIGINT is deferred until Python may raise KeyboardInterrupt.

Python calls its handler when a function begins, so also when C calls back: an exception raised there, before the
function's `try`, would be printed and dropped by ctypes. While C code runs, SIGINT is stored; `leave_c` then raises
KeyboardInterrupt.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType

_in_c = _kept = False
_programs = 0  # programs within `kept_in_c`
_before: Callable[[int, FrameType | None], object] = signal.default_int_handler


def enter_c() -> None:
    """Mark that C code runs."""
    global _in_c
    _in_c = True


def leave_c() -> None:
    """Mark that Python code runs. Raise KeyboardInterrupt if SIGINT came meanwhile."""
    global _in_c, _kept
    _in_c = False
    if _kept:
        _kept = False
        _before(signal.SIGINT, None)


@contextmanager
def kept_in_c() -> Iterator[None]:
    """Defer SIGINT in C code within the block; no effect outside the main thread."""
    global _programs, _before
    before = signal.getsignal(signal.SIGINT)
    if current_thread() is not main_thread() or not callable(before):
        yield
        return
    if not _programs:
        _before = before
        signal.signal(signal.SIGINT, _handle)
    _programs += 1
    try:
        yield
    finally:
        _programs -= 1
        if not _programs:
            signal.signal(signal.SIGINT, _before)


def _handle(number: int, frame: FrameType | None) -> None:
    global _kept
    if _in_c:
        _kept = True
    else:
        _before(number, frame)
