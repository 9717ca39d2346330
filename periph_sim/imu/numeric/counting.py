"""An arithmetic that computes like another one and counts the operations.

    equations --> Counting(Q(16)) --> the numbers of Q(16), and {"mul": 113, "add": 101, "sincos": 5, ...}

The models have no branches that depend on numbers, so the counts are those of every sample.
"""

from __future__ import annotations

from collections import Counter
from typing import Any, Generic, TypeVar

from .arithmetic import Arithmetic, Rounding

T = TypeVar("T")


class Counting(Generic[T]):
    """counts: number of operations of each kind since the last `pop_counts`."""

    def __init__(self, a: Arithmetic[T]) -> None:
        self.a = a
        self.name = a.name
        self.counts: Counter[str] = Counter()

    def pop_counts(self) -> Counter[str]:
        """Return the counts so far and reset them."""
        counts, self.counts = self.counts, Counter()
        return counts

    def constant(self, value: float) -> T:
        return self.a.constant(value)

    def value(self, x: T) -> Any:
        return self.a.value(x)

    def scaled(self, count: T, lsb: float) -> T:
        self.counts["scaled"] += 1
        return self.a.scaled(count, lsb)

    def add(self, x: T, y: T) -> T:
        self.counts["add"] += 1
        return self.a.add(x, y)

    def sub(self, x: T, y: T) -> T:
        self.counts["sub"] += 1
        return self.a.sub(x, y)

    def mul(self, x: T, y: T) -> T:
        self.counts["mul"] += 1
        return self.a.mul(x, y)

    def div(self, x: T, y: T) -> T:
        self.counts["div"] += 1
        return self.a.div(x, y)

    def neg(self, x: T) -> T:
        self.counts["neg"] += 1
        return self.a.neg(x)

    def sqrt(self, x: T) -> T:
        self.counts["sqrt"] += 1
        return self.a.sqrt(x)

    def mag(self, x: T, y: T) -> T:
        self.counts["mag"] += 1
        return self.a.mag(x, y)

    def sincos(self, x: T) -> tuple[T, T]:
        self.counts["sincos"] += 1
        return self.a.sincos(x)

    def atan(self, x: T) -> T:
        self.counts["atan"] += 1
        return self.a.atan(x)

    def atan2(self, y: T, x: T) -> T:
        self.counts["atan2"] += 1
        return self.a.atan2(y, x)

    def select_greater(self, x: T, y: T, yes: T, no: T) -> T:
        self.counts["select"] += 1
        return self.a.select_greater(x, y, yes, no)

    def clamp(self, x: T, low: T, high: T) -> T:
        self.counts["clamp"] += 1
        return self.a.clamp(x, low, high)

    def to_integer(self, x: T, rounding: Rounding) -> T:
        self.counts[f"to integer, {rounding}"] += 1
        return self.a.to_integer(x, rounding)
