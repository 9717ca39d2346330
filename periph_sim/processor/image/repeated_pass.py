"""Repetition of a traced pass of a loop with counters in place of values.

    counters before the pass --each instruction--> counters after it, and for how many passes all of it is true

An instruction either reads no counter, so that it has the same effect in each pass, or it is a `Sum`: its result is a
counter, too, and its flags keep their values until an operand, or the exact result, reaches a multiple of half its
range.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import NamedTuple

from ...core.chip import NEVER
from ..c28x.encodings import LOCATIONS, Encoding, places
from ..c28x.execution.cpu import Operation
from ..c28x.execution.registers import M16

WORD = 1 << 16
ACC = ("AL", "AH")
XAR = tuple((f"AR{n}", f"AR{n}H") for n in range(8))
# Names in the columns `reads` and `writes` where no counter can be. Address registers are in `needs` and `makes`.
UNCOUNTED = re.compile(r"X?AR.*|P|PH|PL|T|TL|XT|OVC|ST0|ST1|STF|R[0-7a-f]H|R0H-R7H|SP|DP|PC|RPC|RPTC|RB|IER|address")

Place = str | int  # a word: register name or memory address


class NotCounting(Exception):
    """The pass does more than count, so further passes may differ."""


class Traced(NamedTuple):
    """An instruction of a pass.

    at: the cycle in which it was executed. operand: the words that its operand field names, low one first; empty if no
    counter can be there. pointers: mask of the address registers that form the operand's address. needs: mask of those
    that it needs in D2. sp: before and after it. values: of words, after it.
    """

    f: Operation
    at: int
    operand: tuple[Place, ...]
    pointers: int
    needs: int
    sp: tuple[int, int]
    values: Mapping[Place, int]


class Store(NamedTuple):
    """A word of memory that an instruction writes: cycle, address, value, and its change in the next pass."""

    at: int
    address: int
    value: int
    step: int


class Number(NamedTuple):
    """A value in this pass, and its change in the next pass."""

    value: int
    step: int


def passes_within(number: Number, unit: int) -> int:
    """Return for how many passes the number stays strictly between two multiples of `unit`."""
    value, step = number
    if not step:
        return NEVER
    rest = value % unit
    if not rest:
        return 0
    return (unit - 1 - rest) // step if step > 0 else (rest - 1) // -step


class RepeatedPass:
    """Repetition of a traced pass with counters in place of values.

    counters: words that count, with their values at this point of the pass. passes: upper bound of the further passes
    for which all of it is true. stores: to memory.
    """

    def __init__(self, counters: Mapping[Place, Number]) -> None:
        self.counters = dict(counters)
        self.passes = NEVER
        self.stores: list[Store] = []

    def step(self, traced: Traced) -> None:
        """Repeat the next instruction. Raise NotCounting if it uses a counter and is no `Sum`."""
        self._execute(traced)
        for place in writes(traced):
            if place in traced.values and isinstance(place, int):
                number = self.counters.get(place)
                self.stores.append(Store(traced.at, place, traced.values[place], number.step if number else 0))

    def _execute(self, traced: Traced) -> None:
        if any(place in self.counters for place in _address_registers(traced.pointers)):
            raise NotCounting
        done = sum_of(traced.f.encoding)
        if done is not None and self._counts(traced, done):
            return
        for place in reads(traced):
            if place in self.counters:
                raise NotCounting
        for place in writes(traced):
            self.counters.pop(place, None)

    def _counts(self, traced: Traced, done: Sum) -> bool:
        """Compute the result of a sum, which is a counter, too. Return False if no operand is a counter."""
        left, right = places_of(done.left, traced), places_of(done.right, traced)
        if not any(place in self.counters for place in (*left, *right)):
            return False
        target = places_of(done.result, traced)
        if done.result and not target:
            raise NotCounting
        width = 16 * max(len(target), len(left), len(right))
        bound = 1 << width - 1
        if done.sign:
            added = self._right(done, right, target, traced)
            if done.result:
                before = self._before(left, _value(target, traced) - done.sign * added.value & 2 * bound - 1)
            else:
                before = self._number(left, traced)
            exact = Number(before.value + done.sign * added.value, before.step + done.sign * added.step)
            for number in (before, added, exact):
                self._bound(number, bound)
            number = Number(exact.value & 2 * bound - 1, exact.step)
        else:
            number = self._number(left, traced)
            self._bound(number, bound)
        if done.result:
            self._put(target, number)
        return True

    def _right(self, done: Sum, places: Sequence[Place], target: Sequence[Place], traced: Traced) -> Number:
        constant = done.number(traced.f.c)
        if constant is not None:
            return Number(constant, 0)
        if any(place in target for place in places):
            raise NotCounting
        return self._number(places, traced)

    def _number(self, places: Sequence[Place], traced: Traced) -> Number:
        """Return the number in words that the instruction does not change."""
        return self._before(places, _value(places, traced))

    def _before(self, places: Sequence[Place], value: int) -> Number:
        """Return this value as a number with the step of its low word."""
        if not places or any(place in self.counters for place in places[1:]):
            raise NotCounting
        low = self.counters.get(places[0])
        return Number(value, 0 if low is None else low.step)

    def _put(self, places: Sequence[Place], number: Number) -> None:
        """Make the result a counter, or none if its step is 0.

        The upper word must not change, so the passes are limited to those before the lower word overflows.
        """
        low = Number(number.value & M16, number.step)
        if len(places) > 1:
            self._bound(low, WORD)
        for place in places:
            self.counters.pop(place, None)
        if number.step:
            self.counters[places[0]] = low

    def _bound(self, number: Number, unit: int) -> None:
        self.passes = min(self.passes, passes_within(number, unit))


def _value(places: Sequence[Place], traced: Traced) -> int:
    value = 0
    for at, place in enumerate(places):
        value |= traced.values[place] << 16 * at
    return value


def places_of(name: str, traced: Traced) -> tuple[Place, ...]:
    """Return the words of an operand, low one first; none for a number, or where no counter can be."""
    f = traced.f
    match name:
        case "ACC":
            return ACC
        case "AX":
            return (ACC[f.x],)
        case "loc":
            return traced.operand
        case "ARn":
            return XAR[f.n][:1]
        case "ARm":
            return XAR[f.m][:1]
        case "XARn":
            return XAR[f.n]
    return XAR[int(name[3])] if name.startswith("XAR") else ()


def reads(traced: Traced) -> Iterable[Place]:
    """Yield the possible counters that an instruction reads. Raise NotCounting if the table does not list them."""
    for name in places(traced.f.encoding.reads):
        yield from _words(name, traced, range(traced.sp[1], traced.sp[0]))
    yield from _address_registers(traced.needs)


def writes(traced: Traced) -> Iterable[Place]:
    """Yield the possible counters that it writes. Raise NotCounting if they are not listed, or may stay unwritten."""
    f, encoding = traced.f, traced.f.encoding
    if _writes_in_part(encoding):
        raise NotCounting
    for name in places(encoding.writes):
        yield from _words(name, traced, range(traced.sp[0], traced.sp[1]))
    yield from _address_registers(f.makes)


def _words(name: str, traced: Traced, stack: Iterable[int]) -> Iterable[Place]:
    if name in ("ACC", "AL", "AX"):
        return ACC if name != "AX" else (ACC[traced.f.x],)
    if name in LOCATIONS:
        return traced.operand
    if name == "stack":
        return stack
    if UNCOUNTED.fullmatch(name):
        return ()
    raise NotCounting


def _address_registers(mask: int) -> Iterable[Place]:
    for n in range(8):
        if mask >> n & 1:
            yield from XAR[n]


def _writes_in_part(encoding: Encoding) -> bool:
    """Return True for writes of bytes and conditional writes."""
    return any(part in encoding.id for part in ("LSB", "MSB")) or (
        "_COND" in encoding.id and "PC" not in encoding.writes
    )


PLACE = "ACC|AX|ARn|ARm|XARn|XAR[0-7]|loc"
NUMBER = r"simm\d+|uimm\d+|0|1"
COPY = re.compile(rf"({PLACE}) = (?:u\()?({PLACE})\)?")
ADDITION = re.compile(rf"({PLACE}) ([+-])= (?:u\()?({PLACE}|{NUMBER})\)?(?:; if it was not 0: PC = PC \+ simm16)?")
COMPARISON = re.compile(
    rf"flags of ({PLACE})(?: - ({PLACE}|{NUMBER}))?|if ({PLACE}) [=!]= ({PLACE}): PC = PC \+ simm16"
)


class Sum(NamedTuple):
    """result = left + sign * right.

    result: a place, or "" if only the flags are written. right: a place or a number. sign: 1, -1, or 0 for a copy.
    """

    result: str
    left: str
    sign: int
    right: str

    def number(self, c: int) -> int | None:
        """Return the right side if it is a number, in 16 bits if it is signed; None for a place. c: field c."""
        if self.right.isdigit():
            return int(self.right)
        kind, immediate, bits = self.right.partition("imm")
        if not immediate:
            return None
        half = 1 << int(bits) - 1
        return (c ^ half) - half & 0xFFFF if kind == "s" else c


@cache
def sum_of(encoding: Encoding) -> Sum | None:
    """Return what a form computes; None if it is more than one sum, copy or comparison."""
    op = encoding.op
    if found := COPY.fullmatch(op):
        return Sum(found[1], found[2], 0, "")
    if found := ADDITION.fullmatch(op):
        return Sum(found[1], found[1], -1 if found[2] == "-" else 1, found[3])
    if found := COMPARISON.fullmatch(op):
        return Sum("", found[1] or found[3], -1, found[2] or found[4] or "0")
    return None
