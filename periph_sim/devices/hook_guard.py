"""Calls into a user's own device: a hook goes in; what it returns comes out, or what is wrong with it, with its line.

A hook that does not return, within so many seconds of CPU time, is stopped as firmware is that makes no progress; so is
the import of its file, and the making of the device.
"""

from __future__ import annotations

from collections.abc import Callable
from threading import get_ident
from typing import TypeVar

from ..processor.error_origin import FirmwareError, FirmwareStalled, Misuse, raised_at
from ..processor.stall_watch import NoProgress, watch

Returned = TypeVar("Returned")


class HookGuard:
    """who: the device's name. stall_limit: seconds of CPU time that one call may take; 0: any.

    thread: that runs a hook, 0 while none does.
    """

    def __init__(self, who: str, stall_limit: float) -> None:
        self.who = who
        self.stall_limit = stall_limit
        self.thread = 0
        self._calls = 0
        if stall_limit:
            watch.add(self)

    def instant(self) -> tuple[int, int]:
        """Another one for each call."""
        return self._calls, 0

    def __call__(self, hook: Callable[..., object], *arguments: object) -> object:
        """What the hook returns. FirmwareError with file and line for what it raises, FirmwareStalled for no end."""
        try:
            return self.in_time(hook, *arguments)
        except FirmwareStalled:
            raise
        except Exception as error:
            at = raised_at(error)
            if not at:
                raise
            what = str(error) if isinstance(error, Misuse) else f"{type(error).__name__}: {error}"
            raise FirmwareError(f"device {self.who}, {at}: {what}") from None

    def in_time(self, hook: Callable[..., Returned], *arguments: object) -> Returned:
        """What the hook returns, or raises. FirmwareStalled with file and line for no end."""
        try:
            return self._watched(hook, *arguments)
        except NoProgress as stopped:
            at, limit = raised_at(stopped), f"{self.stall_limit:g} s of CPU time"
            raise FirmwareStalled(f"device {self.who} did not return within {limit} at {at}") from None

    def _watched(self, hook: Callable[..., Returned], *arguments: object) -> Returned:
        if not self.stall_limit or self.thread:  # a hook that calls a hook is one call
            return hook(*arguments)
        self._calls += 1
        self.thread = get_ident()
        try:
            return hook(*arguments)
        finally:
            self.thread = 0
            watch.leave(get_ident())
