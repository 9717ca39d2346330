"""Runs written as text, words with positions such as `START 0, address 53 W 10`, and the diff of two runs."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from periph_sim.traces.diff import TraceDiff, compared
from periph_sim.traces.diff.matching import Event, Group, Pairing

MHZ = Fraction(10**6)


def event(word: str, at: int) -> Event:
    kind = next((k for k in ("repeated START", "address", "byte") if word.startswith(k)), word)
    return Event(kind, word, at)


def group(text: str) -> Group:
    """Parse a group such as `START 0, address 53 W 10, ACK 19`: words with their positions."""
    found = []
    for part in text.split(","):
        word, _, at = part.strip().rpartition(" ")
        found.append(event(word, int(at)))
    return found


def diffed(
    a: Sequence[Group],
    b: Sequence[Group],
    tolerance: Fraction | None = None,
    rates: tuple[Fraction, Fraction] = (MHZ, MHZ),
) -> TraceDiff:
    return compared(Pairing(rates).pairs(a, b), ("a", "b"), rates, tolerance)


def differences(diff: TraceDiff) -> list[str]:
    """The differing events of a diff as text: `-byte 12`, `+ACK`, `ACK > NACK`."""
    found = []
    for entry in diff.entries:
        if entry.b is None:
            found.append(f"-{entry.a.word}")
        elif entry.a is None:
            found.append(f"+{entry.b.word}")
        elif entry.changed:
            found.append(f"{entry.a.word} > {entry.b.word}")
    return found
