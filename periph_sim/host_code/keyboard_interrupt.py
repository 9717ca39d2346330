"""Ctrl-C while C code runs: SIGINT goes in; KeyboardInterrupt comes out where Python may raise it.

Python calls its handler as a function begins, so as C calls back: an exception raised there, before the function's
`try`, would be printed and dropped by ctypes. In C code SIGINT is therefore kept, and raised by `raise_if_kept`.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType

_in_c = _kept = False
_programs = 0  # within `kept_in_c`
_before: Callable[[int, FrameType | None], object] = signal.default_int_handler


def enter_c() -> None:
    """C code runs from here on."""
    global _in_c
    _in_c = True


def leave_c() -> None:
    """Python code runs again. KeyboardInterrupt if SIGINT came meanwhile."""
    global _in_c, _kept
    _in_c = False
    if _kept:
        _kept = False
        _before(signal.SIGINT, None)


@contextmanager
def kept_in_c() -> Iterator[None]:
    """Within the block SIGINT is kept while C code runs; nothing changes outside of the main thread."""
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
