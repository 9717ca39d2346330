"""Pairing of the events of two captures, in order, by their words and not by their times.

The word of an event is a text with its content. Two events with the same word are equal. Words are, for example:

    I2C   START, address 53 W, ACK, byte 1D, ACK, STOP     a group of events is a transfer
    UART  41, 0D FE, break                                 a group of events is one frame or break

Two captures of the same behaviour have the same words, even if their rates and timing differ.

    groups of A, groups of B --equal groups--> --equal events--> --events of the same class--> pairs

First, equal groups are paired, which covers most of a long capture. Then the events between these groups are paired one
by one if all are of the same classes in both captures, or if enough of them are equal. Otherwise similar groups are
paired, or groups with equal addresses if there are too many groups to compare them all. If one of several equal events
is missing, times decide which of them it is. In a pair of groups, the events that are not equal are paired if they are
of the same class (a byte with a byte, ACK with NACK), and count as changed. All other events are missing (only in A) or
inserted (only in B).

    A   read 6 of 68    read 6 of 53    read 6 of 1E
    B   53 NACK         read 1 of 53                     -->  only the reads of 53 are paired

The similarity of two groups is the share of words that they have in common. Two groups can be paired if this share is
at least a half, or if their sequences of addresses or of classes of events are equal. Of all pairings that keep the
order, the pairing with the greatest total similarity is chosen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Sequence
from fractions import Fraction
from itertools import chain
from operator import attrgetter
from typing import NamedTuple, TypeVar

import numpy as np

from ..capture.capture import Capture
from ..decode import i2c, uart
from ..decode.i2c_table import I2cRowKind
from ..decode.uart import UartRowKind
from .align import Run, align, numbered, place_by_time


class Event(NamedTuple):
    """An event.

    kind: the kind of the event, such as `byte`.
    word: the text that is compared, such as `byte 1D`.
    at: the position of the event in the capture.
    """

    kind: str
    word: str
    at: int


Group = list[Event]


def i2c_groups(capture: Capture, scl: str | int, sda: str | int) -> list[Group]:
    """Return each transfer of a capture as a group, from the first START on.

    Raise LookupError if a channel is missing or ambiguous.
    """
    groups: list[Group] = []
    for event in i2c.events(capture, scl, sda):
        if event.kind is I2cRowKind.START:
            groups.append([])
        groups[-1].append(_i2c_event(event))
    return groups


def uart_groups(capture: Capture, channel: str | int, line: uart.Line) -> list[Group]:
    """Return each frame, cut frame and break of a line as a group. Rejected starts are left out.

    The same errors are raised as by `decode.uart.events`.
    """
    digits = (line.bits + 3) // 4
    events = uart.events(capture, channel, line)
    return [[_uart_event(event, digits)] for event in events if event.kind is not UartRowKind.REJECTED]


def _i2c_event(event: i2c.Event) -> Event:
    kind = i2c.NAMES[event.kind]
    detail = ""
    if event.kind is I2cRowKind.ADDRESS:
        detail = f" {event.value:02X} {'R' if event.read else 'W'}"
    elif event.kind is I2cRowKind.DATA:
        detail = f" {event.value:02X}"
    elif event.kind is I2cRowKind.CUT:
        detail = f" {event.value:0{event.bits}b}"
    return Event(kind, kind + detail, event.at)


def _uart_event(event: uart.Event, digits: int) -> Event:
    if event.kind is UartRowKind.FRAME:
        word = f"{event.value:0{digits}X}{' PE' * event.parity_error}{' FE' * event.frame_error}"
        return Event("frame", word, event.at)
    if event.kind is UartRowKind.BREAK:
        return Event("break", "break", event.at)
    received = f"{event.value:0{event.bits}b}"[::-1] if event.bits else ""
    return Event("cut frame", f"cut frame {received}", event.at)


ENOUGH = 0.5  # minimum similarity of two groups that can be paired
HEADS = {"START", "repeated START", "address"}
CLASSES = {"NACK": "ACK", "repeated START": "START", "cut byte": "byte", "cut frame": "frame"}


def similar_runs(a: Sequence[Group], b: Sequence[Group]) -> list[Run]:
    """Return the pairs of similar groups as runs of length 1. The time that this takes grows with len(a) * len(b)."""
    score = [[similarity(one, other) for other in b] for one in a]
    best = [[0.0] * (len(b) + 1) for _ in range(len(a) + 1)]
    for i in reversed(range(len(a))):
        for j in reversed(range(len(b))):
            paired = best[i + 1][j + 1] + score[i][j] if score[i][j] >= ENOUGH else 0.0
            best[i][j] = max(paired, best[i + 1][j], best[i][j + 1])
    found: list[Run] = []
    i = j = 0
    while i < len(a) and j < len(b):
        if score[i][j] >= ENOUGH and best[i][j] == best[i + 1][j + 1] + score[i][j]:
            found.append(Run(i, j, 1))
            i, j = i + 1, j + 1
        elif best[i][j] == best[i + 1][j]:
            i += 1
        else:
            j += 1
    return found


def similarity(a: Group, b: Group) -> float:
    """Return the similarity of two groups, from 0 for no common word to 1 for the same words in any order.

    The similarity is at least ENOUGH if the sequences of addresses, or of classes of events, are equal.
    """
    common = Counter(event.word for event in a) & Counter(event.word for event in b)
    share = 2 * common.total() / (len(a) + len(b))
    same = shape(a) == shape(b) or (head(a) == head(b) != ())
    return max(share, ENOUGH if same else 0.0)


def head(group: Group) -> tuple[str, ...]:
    """Return the words of the group's STARTs and addresses, in order."""
    return tuple(event.word for event in group if event.kind in HEADS)


def shape(group: Group) -> tuple[str, ...]:
    """Return the classes of the group's events, in order."""
    return tuple(class_of(event.kind) for event in group)


def class_of(kind: str) -> str:
    """Return the class of a kind of event, such as "ACK" for ACK and NACK.

    Events of the same class can be paired as changed.
    """
    return CLASSES.get(kind, kind)


T = TypeVar("T")
Pair = tuple[Event | None, Event | None]  # an event of A and an event of B; None for a missing event
FEW_EVENTS = 5_000  # maximum number of events that are aligned one by one, regardless of their groups
FEW_GROUPS = 60  # every group of A is compared with every group of B if this takes at most FEW_GROUPS**2 comparisons


class Pairing:
    """Pairs the events of two captures. rates: the numbers of positions per second of A and B."""

    def __init__(self, rates: tuple[Fraction, Fraction]) -> None:
        self._rates = tuple(map(float, rates))  # floats suffice: times only decide between equal events

    def pairs(self, a: Sequence[Group], b: Sequence[Group]) -> Iterator[Pair]:
        """Yield all events of both captures in pairs, in order."""
        for run, left, right in _between(self._aligned(a, b, _text, _begin), a, b):
            yield from self._block(left, right)
            for one, other in zip(a[run.a : run.a + run.length], b[run.b : run.b + run.length], strict=True):
                yield from zip(one, other, strict=True)

    def _block(self, a: Sequence[Group], b: Sequence[Group]) -> Iterator[Pair]:
        """Pair the events of groups that are not equal.

        If A and B have the same number of groups, and corresponding groups have events of the same classes in the same
        order, events are paired in this order. Otherwise, if there are at most FEW_EVENTS events, single events are
        aligned. The result is used if the number of pairs of equal events is at least half of the number of all other
        pairs. Otherwise, similar groups are paired or, if there are more groups than FEW_GROUPS allows, groups with
        equal STARTs and addresses.
        """
        if len(a) == len(b) and all(shape(one) == shape(other) for one, other in zip(a, b, strict=True)):
            for one, other in zip(a, b, strict=True):
                yield from zip(one, other, strict=True)
            return
        if sum(map(len, a)) + sum(map(len, b)) <= FEW_EVENTS:
            found = [*self._events([*chain.from_iterable(a)], [*chain.from_iterable(b)])]
            same = sum(one is not None and other is not None and one.word == other.word for one, other in found)
            if same >= ENOUGH * (len(found) - same):
                yield from found
                return
        few = len(a) * len(b) <= FEW_GROUPS**2
        runs = similar_runs(a, b) if few else self._aligned(a, b, head, _begin)
        for run, left, right in _between(runs, a, b):
            if few or not runs or not left or not right:
                yield from ((event, None) for group in left for event in group)
                yield from ((None, event) for group in right for event in group)
            else:
                yield from self._block(left, right)
            for one, other in zip(a[run.a : run.a + run.length], b[run.b : run.b + run.length], strict=True):
                yield from self._events(one, other)

    def _events(self, a: Sequence[Event], b: Sequence[Event]) -> Iterator[Pair]:
        runs = self._aligned(a, b, attrgetter("word"), attrgetter("at"))
        for run, left, right in _between(runs, a, b):
            yield from _unlike(left, right)
            yield from zip(a[run.a : run.a + run.length], b[run.b : run.b + run.length], strict=True)

    def _aligned(
        self, a: Sequence[T], b: Sequence[T], key: Callable[[T], Hashable], at: Callable[[T], int]
    ) -> list[Run]:
        """Return the runs of items with equal keys.

        key: a function that returns the key of an item.
        at: a function that returns the position of an item.
        """
        one, other = numbered(map(key, a), map(key, b))
        times_a, times_b = (np.array([*map(at, items)]) / rate for items, rate in zip((a, b), self._rates, strict=True))
        return place_by_time(align(one, other), one, other, times_a, times_b)


def _unlike(a: Sequence[Event], b: Sequence[Event]) -> Iterator[Pair]:
    """Pair events that are not equal, in order.

    Events whose kinds have the same class (`class_of`), such as ACK and NACK, are paired; others are paired with None.
    """
    classes = align(*numbered([class_of(event.kind) for event in a], [class_of(event.kind) for event in b]))
    for run, left, right in _between(classes, a, b):
        yield from ((event, None) for event in left)
        yield from ((None, event) for event in right)
        yield from zip(a[run.a : run.a + run.length], b[run.b : run.b + run.length], strict=True)


def _between(runs: list[Run], a: Sequence[T], b: Sequence[T]) -> Iterator[tuple[Run, Sequence[T], Sequence[T]]]:
    """Yield each run with the items of both sequences between the previous run and this run.

    An empty run at the end of both sequences is yielded last.
    """
    at_a = at_b = 0
    for run in [*runs, Run(len(a), len(b), 0)]:
        yield run, a[at_a : run.a], b[at_b : run.b]
        at_a, at_b = run.a + run.length, run.b + run.length


def _text(group: Group) -> tuple[str, ...]:
    return tuple(event.word for event in group)


def _begin(group: Group) -> int:
    return group[0].at
