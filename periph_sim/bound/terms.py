"""What a bound is made of: terms with their sources add up to it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


class BadBound(ValueError):
    """A case for which there is no closed form; one sentence."""


@dataclass(frozen=True)
class Term:
    """A part of a sum. ticks: negative where it is taken off. source: the parameter or document it comes from."""

    what: str
    ticks: int
    source: str


@dataclass(frozen=True)
class Bound:
    """The worst case of one measure: the sum of its terms, but never less than `floor`.

    measure: as a budget names it. least: it is the smallest value that is bounded, from below.
    """

    name: str
    measure: str
    terms: tuple[Term, ...]
    floor: Term | None = None
    least: bool = False

    @property
    def sum(self) -> int:
        return total(self.terms)

    @property
    def ticks(self) -> int:
        return self.sum if self.floor is None else max(self.sum, self.floor.ticks)


def total(terms: Iterable[Term]) -> int:
    return sum(term.ticks for term in terms)
