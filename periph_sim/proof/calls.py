"""Calls that can be made in other processes. A proof passes them to a function that the command chooses."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import starmap
from typing import Protocol, TypeVar, TypeVarTuple

T = TypeVar("T")
Ts = TypeVarTuple("Ts")


class CallAll(Protocol):
    """A function that calls `work` with each tuple of arguments in `calls`, and yields the results in this order."""

    def __call__(self, work: Callable[[*Ts], T], calls: Sequence[tuple[*Ts]], /) -> Iterable[T]: ...


call_here: CallAll = starmap  # makes the calls in this process, each when its result is requested
