"""How late straight-line code between waits can be: a calm run's waits go in, the chain that makes it latest comes out.

    flag k on the bus --filter, poll pass--> code k --> [wait k+1: flag long there] --> code k+1 --> ... --> point

If every wait from k+1 on finds its flag there, the code behind flag k runs through; the latest chain of all k is the
worst case, and nothing but interrupts makes it later. A chain begins with an edge on the bus, so its end is counted
against another instant of the bus.
"""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

from msgspec import Struct

from .terms import Term, total
from .undisturbed_run import UndisturbedRun, Wait


class LatestChain(Struct, frozen=True, dict=True):
    """The latest chain to a point. edge: where it begins. terms: from there on, without interrupts."""

    edge: int
    terms: tuple[Term, ...]

    @cached_property
    def length(self) -> int:
        """Ticks of its terms."""
        return total(self.terms)

    @property
    def end(self) -> int:
        """When the point is reached, counted in the calm run's ticks."""
        return self.edge + self.length


def chains(calm: UndisturbedRun, waits: list[Wait], point: int, name: str) -> list[LatestChain]:
    """The chains of these waits, which are in order, to the code at `point`; name: what is done there."""
    if not waits:
        return []
    last = waits[-1]
    codes = [_code(calm, one.end, of.first, f"{one.place} to {of.place}", of.into) for one, of in pairwise(waits)]
    codes.append(_code(calm, last.end, point, f"{last.place} to {name}"))
    return [
        LatestChain(wait.edge, (*_noticed(calm, wait), *codes[k:]))
        for k, wait in enumerate(waits)
        if wait.edge is not None
    ]


def _noticed(calm: UndisturbedRun, wait: Wait) -> tuple[Term, Term]:
    """From an edge on the bus to the end of the wait for its flag; a wait is part of many chains."""
    if wait.first not in calm.wait_terms:
        flags = " or ".join(field.rpartition(".")[2] for field in wait.fields)
        length = "poll_pass" if wait.pass_cycles is None else "pass_cycles"
        reads = f"{wait.reads} read{'s' * (wait.reads > 1)} a pass"
        calm.wait_terms[wait.first] = (
            Term(
                f"{flags} behind its edge",
                calm.longest_delay(wait),
                "noise_filter_cycles x (IPSC + 1), and an edge within a cycle",
            ),
            Term(
                f"poll pass for {flags}",
                calm.ticks(calm.pass_cycles(wait) - 1),
                f"{length} less 1, {reads}; {wait.place}",
            ),
        )
    return calm.wait_terms[wait.first]


def _code(calm: UndisturbedRun, begin: int, end: int, what: str, into: int = 0) -> Term:
    """The code between two instants, and what of a pass comes before the read that ends the wait behind it.

    One piece of code is part of as many chains as there are waits before it.
    """
    key = begin, end, what, into
    if key not in calm.code_terms:
        calm.code_terms[key] = _code_term(calm, *key)
    return calm.code_terms[key]


def _code_term(calm: UndisturbedRun, begin: int, end: int, what: str, into: int) -> Term:
    spans = [n for n, times in calm.spans.items() if any(begin <= b and e <= end for b, e in times)]
    within = f" with {' and '.join(spans)}" * bool(spans)
    source = "straight-line code, measured in a run without host"
    return Term(f"code {what}{within}", calm.lasting(begin, end) + into, source, calm.unproven(begin, end))


def waits_between(calm: UndisturbedRun, begin: int, end: int) -> list[Wait]:
    """The waits that ended between two instants."""
    return [wait for wait in calm.waits if begin <= wait.end <= end]
