"""Comparison of the events of a capture and its replay: their divergences and differences in time.

    expected, found --> compare --> Comparison: the first wrong byte, ACK, event, and the first wrong time

Events are equal if their words are equal ("address 50 write", "ACK"); their times are compared separately. After a
wrong byte or ACK, the comparison continues, because later events still correspond to each other. Any other difference
in words ends it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest

from ..traces.decode import i2c
from ..traces.decode.i2c_table import I2cRowKind
from ..traces.diff.align import align

NOTHING = "nothing more"

BYTE, ACK, EVENT, TIMING = "byte", "ACK", "event", "timing"
KINDS = (BYTE, ACK, EVENT, TIMING)  # kinds of divergences

CONDITIONS = ("START", "repeated START", "STOP", NOTHING)


@dataclass(frozen=True, slots=True)
class Happened:
    """An event in words. at: seconds since the capture began; None if unknown."""

    words: str
    at: Fraction | None


@dataclass(frozen=True, slots=True)
class Change:
    """An entry of the chip's history: a register field that changed, or a CPU access.

    at_s: seconds since the capture began.
    what: the field or the access, for example "I2C-A.I2CSTR.AAS" or "W I2C-A.I2CDXR".
    value: the field's new value, or the word that was read or written.
    """

    at_s: float
    what: str
    value: int


@dataclass(frozen=True, slots=True)
class Divergence:
    """A difference between the capture and the replay.

    index: the number of events before the divergence.
    expected, found: the event in the capture and in the replay, in words.
    capture_s, replay_s: the times of these events in seconds since the capture began; None if there is no event.
    kind: one of KINDS.
    history: the changes of the chip's registers around the divergence.
    cause: a phrase that names the causing statement of the firmware, or another cause; "" if unknown.
    """

    index: int
    expected: str
    found: str
    capture_s: float | None
    replay_s: float | None
    kind: str = EVENT
    history: tuple[Change, ...] = ()
    cause: str = ""


@dataclass(frozen=True, slots=True)
class Comparison:
    """The result of comparing two lists of events.

    agreed: the number of events that occur in both lists in the same order.
    divergence: the first divergence that is not of kind TIMING; None if there is none.
    lag: the largest difference in time, in seconds, among the events before the first difference in words.
    ranked: the first divergence of each kind, in order of time, because an earlier one may cause a later one. TIMING is
        last, because a stretch delays all later events.
    """

    agreed: int
    divergence: Divergence | None
    lag: Fraction
    ranked: tuple[Divergence, ...] = ()


def kind_of(words: str) -> str:
    """Return the kind of a divergence in which an event with these words is wrong: BYTE, ACK or EVENT."""
    if words in CONDITIONS or words.startswith("cut off"):
        return EVENT
    return ACK if words in ("ACK", "NACK") else BYTE


def compare(expected: Sequence[Happened], found: Sequence[Happened], tolerance: Fraction | None = None) -> Comparison:
    """Compare two lists of events. A difference in length is a divergence, too.

    tolerance: the allowed difference in time, in seconds; None: times are not compared.
    """
    lag = Fraction(0)
    parted = False
    first: dict[str, Divergence] = {}
    for index, (was, came) in enumerate(zip_longest(expected, found, fillvalue=Happened(NOTHING, None))):
        times = _seconds(was.at), _seconds(came.at)
        if was.words != came.words:
            kind = kind_of(was.words)
            same = kind == kind_of(came.words) != EVENT
            kind = kind if same else EVENT
            first.setdefault(kind, Divergence(index, was.words, came.words, *times, kind))
            parted = True
            if not same:
                break
        elif was.at is not None and came.at is not None:
            off = came.at - was.at
            if not parted:
                lag = max(lag, abs(off))
            if tolerance is not None and abs(off) > tolerance and TIMING not in first:
                difference = f"{was.words} {float(abs(off) * 1_000_000):.3f} us {'later' if off > 0 else 'earlier'}"
                first[TIMING] = Divergence(index, was.words, difference, *times, TIMING)
    ranked = tuple(sorted(first.values(), key=lambda divergence: (divergence.kind == TIMING, divergence.index)))
    earliest = ranked[0] if ranked and ranked[0].kind != TIMING else None
    return Comparison(_in_both(expected, found) if parted else len(expected), earliest, lag, ranked)


def _in_both(expected: Sequence[Happened], found: Sequence[Happened]) -> int:
    """Return the number of events that occur in both lists in the same order."""
    numbers: dict[str, int] = {}
    rows = [[numbers.setdefault(event.words, len(numbers)) for event in events] for events in (expected, found)]
    return sum(run.length for run in align(*rows))


def _seconds(at: Fraction | None) -> float | None:
    return None if at is None else float(at)


def i2c_words(events: Iterable[i2c.Event], per_second: Fraction, origin: int = 0) -> list[Happened]:
    """Convert I2C events to words. per_second: positions per second. origin: the position where the capture begins."""
    return [Happened(_i2c(event), (event.at - origin) / per_second) for event in events]


def _i2c(event: i2c.Event) -> str:
    way = "read" if event.read else "write"
    if event.kind is I2cRowKind.ADDRESS:
        return f"address {event.value:02X} {way}"
    if event.kind is I2cRowKind.DATA:
        return f"data {way} {event.value:02X}"
    if event.kind is I2cRowKind.CUT:
        return f"cut off after {event.value:0{event.bits}b}"
    return i2c.NAMES[event.kind]


def byte_words(value: int, frame_error: bool, parity_error: bool) -> str:
    """Format a received word and its errors, for example 55, 00 FE (framing error) or 41 PE (parity error)."""
    return f"{value:02X}{' FE' if frame_error else ''}{' PE' if parity_error else ''}"
