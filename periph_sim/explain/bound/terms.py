"""What a bound is made of: terms with their sources add up to it."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from msgspec import Struct


class BadBound(ValueError):
    """A case for which there is no closed form; one sentence."""


class Term(Struct, frozen=True):
    """A part of a sum. ticks: negative where it is taken off. source: the parameter or document it comes from.

    unproven: why it is no bound on what it stands for; empty if it is one.
    """

    what: str
    ticks: int
    source: str
    unproven: str = ""

    def taken_off(self) -> Term:
        return Term(self.what, -self.ticks, self.source, self.unproven)


class Bound(Struct, frozen=True):
    """The worst case of one measure: the sum of its terms, but never less than `floor`.

    measure: as a budget names it. least: it is the smallest value that is bounded, from below. counted: its terms are
    no times but counts. special: says what another one says of one chip, or in other words. part: of all values from
    the start of a run, at least so many are within it.
    """

    name: str
    measure: str
    terms: tuple[Term, ...]
    floor: Term | None = None
    least: bool = False
    counted: bool = False
    special: bool = False
    part: Fraction = Fraction(1)

    @property
    def unproven(self) -> str:
        """Why the sum is no bound: what its terms say; empty if it is one."""
        return reasons(self.terms)

    @property
    def sum(self) -> int:
        return total(self.terms)

    @property
    def ticks(self) -> int:
        return self.sum if self.floor is None else max(self.sum, self.floor.ticks)


def total(terms: Iterable[Term]) -> int:
    return sum(term.ticks for term in terms)


def reasons(terms: Iterable[Term]) -> str:
    """What makes these terms no bounds, each reason once; empty if all are bounds."""
    return "; ".join(dict.fromkeys(term.unproven for term in terms if term.unproven))
