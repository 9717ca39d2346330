"""Calls that can be made in other processes: the interface between proofs and the worker processes of a command."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import starmap
from typing import Protocol, TypeVar, TypeVarTuple

T = TypeVar("T")
Ts = TypeVarTuple("Ts")


class CallAll(Protocol):
    """Makes calls, and yields their results in order."""

    def __call__(self, work: Callable[[*Ts], T], calls: Sequence[tuple[*Ts]], /) -> Iterable[T]: ...


def call_here(work: Callable[[*Ts], T], calls: Sequence[tuple[*Ts]]) -> Iterable[T]:
    """Make calls in this process, each when its result is asked for."""
    return starmap(work, calls)
