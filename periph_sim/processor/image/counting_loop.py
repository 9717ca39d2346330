"""Counting loops: how many passes after a traced one differ only in their counters.

    pass --executed--> trace; words that differ before and after it --> counters, each with its step
    trace --repeated with counters in place of values--> number of passes in which nothing else differs

A counter is a word of 16 bits, of ACC, an XARn or plain RAM, that changes by the same step in each pass. An instruction
either reads no counter, so that it has the same effect in each pass, or it is a `Sum`: its result is a counter, too,
and its flags keep their values until an operand, or the exact result, reaches a multiple of half its range. If each
counter ends one step further, and all other registers and the pipeline are as before, the passes up to that bound take
the same cycles and branches, and make the same accesses.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from typing import NamedTuple

from ...core.chip import NEVER
from ...core.state import State
from ...f28335.memory.ram import Ram
from ..c28x.encodings import LOCATIONS, Encoding, operand_texts, places
from ..c28x.execution.cpu import REGISTER, Cpu, Operation
from ..c28x.execution.registers import M16
from ..c28x.pipeline import BY_ARP, addressing
from ..cpu_time import CpuTime
from .cpu import ImageCpu
from .memory import L0_AGAIN, L4_AGAIN, MIRROR, in_plain_ram
from .observers import InstructionWatch

MOST_TRACED = 256  # maximum number of instructions in a traced pass
COUNTERS = 9  # first entries of a state: ACC and XAR0 to XAR7
WORD, HALF = 1 << 16, 1 << 15

Place = str | int  # a word: register name or memory address

XAR = tuple((f"AR{n}", f"AR{n}H") for n in range(8))
# By register, the words in which a counter can be, low one first.
WORDS: dict[str, tuple[Place, ...]] = {"AL": ("AL",), "AH": ("AH",), "ACC": ("AL", "AH")}
WORDS |= {f"XAR{n}": XAR[n] for n in range(8)} | {f"AR{n}": XAR[n][:1] for n in range(8)}
OPERAND = ("loc", *LOCATIONS)  # names of the words at an instruction's operand field
# Names in the columns `reads` and `writes`, except the stack, whose effects are known here.
KNOWN = re.compile(
    r"(loc|mem)(16|32)|ACC|AL|AX|X?AR.*|P|PH|PL|T|TL|XT|OVC|ST0|ST1|STF|R[0-7a-f]H|R0H-R7H|SP|DP|PC|RPC|RPTC|RB|IER"
    r"|address"
)


def register_words(acc: int, xar: Sequence[int]) -> dict[Place, int]:
    """Return the words of ACC and XAR0 to XAR7 by their names."""
    words: dict[Place, int] = {"AL": acc & M16, "AH": acc >> 16}
    for (low, high), value in zip(XAR, xar, strict=True):
        words[low], words[high] = value & M16, value >> 16
    return words


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


Store = tuple[int, int, int, int]  # a word that an instruction writes: cycle, address, value, change in the next pass


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


# Instructions that count --------------------------------------------------------------------

PLACE = "ACC|AX|ARn|ARm|XARn|XAR[0-7]|loc"
NUMBER = r"simm\d+|uimm\d+|0|1"
COPY = re.compile(rf"({PLACE}) = (?:u\()?({PLACE})\)?")
ADDITION = re.compile(rf"({PLACE}) ([+-])= (?:u\()?({PLACE}|{NUMBER})\)?(?:; if it was not 0: PC = PC \+ simm16)?")
COMPARISON = re.compile(
    rf"flags of ({PLACE})(?: - ({PLACE}|{NUMBER}))?|if ({PLACE}) [=!]= ({PLACE}): PC = PC \+ simm16"
)


class Sum(NamedTuple):
    """result = left + sign * right; a copy adds 0.

    result: a place, or "" if only the flags are written. right: a place or a number. sign: 1 or -1.
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
        return (c ^ half) - half & M16 if kind == "s" else c


@cache
def sum_of(encoding: Encoding) -> Sum | None:
    """Return what a form computes; None if it is more than one sum, copy or comparison."""
    op = encoding.op
    if found := COPY.fullmatch(op):
        return Sum(found[1], found[2], 1, "0")
    if found := ADDITION.fullmatch(op):
        return Sum(found[1], found[1], -1 if found[2] == "-" else 1, found[3])
    if found := COMPARISON.fullmatch(op):
        return Sum("", found[1] or found[3], -1, found[2] or found[4] or "0")
    return None


def places_of(name: str, traced: Traced) -> tuple[Place, ...]:
    """Return the words of an operand, low one first; none for a number, or where no counter can be."""
    if name in OPERAND:
        return traced.operand
    f = traced.f
    numbered = {"AX": ("AL", "AH")[f.x], "ARn": f"AR{f.n}", "ARm": f"AR{f.m}", "XARn": f"XAR{f.n}"}
    return WORDS.get(numbered.get(name, name), ())


def reads(traced: Traced) -> Iterable[Place]:
    """Return the possible counters that an instruction reads. Raise NotCounting if the table does not list them."""
    return _used(traced.f.encoding.reads, traced, range(traced.sp[1], traced.sp[0]), traced.needs)


def writes(traced: Traced) -> Iterable[Place]:
    """Return the possible counters that it writes. Raise NotCounting if they are not listed, or may stay unwritten."""
    encoding = traced.f.encoding
    if "LSB" in encoding.id or "MSB" in encoding.id or ("_COND" in encoding.id and "PC" not in encoding.writes):
        raise NotCounting  # it writes a byte, or under a condition
    return _used(encoding.writes, traced, range(traced.sp[0], traced.sp[1]), traced.f.makes)


def _used(column: Iterable[str], traced: Traced, stack: Iterable[int], registers: int) -> Iterable[Place]:
    for name in places(column):
        if name != "stack" and not KNOWN.fullmatch(name):
            raise NotCounting
        yield from stack if name == "stack" else places_of(name, traced)
    yield from _address_registers(registers)


def _address_registers(mask: int) -> Iterable[Place]:
    for n in range(8):
        if mask >> n & 1:
            yield from XAR[n]


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
        if any(place in self.counters for place in _address_registers(traced.pointers)):
            raise NotCounting
        done = sum_of(traced.f.encoding)
        if done is None or not self._counts(traced, done):
            if any(place in self.counters for place in reads(traced)):
                raise NotCounting
            for place in writes(traced):
                self.counters.pop(place, None)
        for place in writes(traced):
            if place in traced.values and isinstance(place, int):
                number = self.counters.get(place)
                self.stores.append((traced.at, place, traced.values[place], number.step if number else 0))

    def _counts(self, traced: Traced, done: Sum) -> bool:
        """Compute the result of a sum, which is a counter, too. Return False if no operand is a counter."""
        left, right, target = (places_of(name, traced) for name in (done.left, done.right, done.result))
        if not any(place in self.counters for place in (*left, *right)):
            return False
        if done.result and not target:
            raise NotCounting
        bound = 1 << 16 * max(len(target), len(left), len(right)) - 1
        constant = done.number(traced.f.c)
        if any(place in target for place in right):
            raise NotCounting  # its earlier value was not traced
        added = self._number(right, _value(right, traced)) if constant is None else Number(constant, 0)
        earlier = _value(target, traced) - done.sign * added.value if target else _value(left, traced)
        before = self._number(left, earlier & 2 * bound - 1)
        exact = Number(before.value + done.sign * added.value, before.step + done.sign * added.step)
        for number in (before, added, exact):
            self._bound(number, bound)
        if target:
            low = Number(exact.value & M16, exact.step)
            if len(target) > 1:  # its upper word must not change, so the lower one must not overflow
                self._bound(low, WORD)
            for place in target:
                self.counters.pop(place, None)
            if exact.step:
                self.counters[target[0]] = low
        return True

    def _number(self, words: Sequence[Place], value: int) -> Number:
        """Return the value of these words as a number with the step of the low one."""
        if not words or any(place in self.counters for place in words[1:]):
            raise NotCounting
        low = self.counters.get(words[0])
        return Number(value, 0 if low is None else low.step)

    def _bound(self, number: Number, unit: int) -> None:
        self.passes = min(self.passes, passes_within(number, unit))


def _value(words: Sequence[Place], traced: Traced) -> int:
    return sum(traced.values[place] << 16 * at for at, place in enumerate(words))


# The loop -----------------------------------------------------------------------------------


class CountingLoop(InstructionWatch):
    """Trace of the pass of a loop that begins now. does_more: it does more than count, and so will later passes."""

    STATE = State(
        "does_more _moved _stores _state _arp _sp _trace _steps _time _cpu _memory _over",
        cycles="_began",
        made=True,
    )

    def __init__(self, cpu: ImageCpu, time: CpuTime, memory: Ram, over: Callable[[InstructionWatch], None]) -> None:
        """over: called when the trace is no longer needed."""
        self.does_more = False
        self._time = time
        self._began = time.cycle
        self._moved = 0  # passes that were skipped
        self._stores: list[Store] = []
        self._cpu = cpu
        self._memory = memory
        self._over = over
        self._state = cpu.state()
        self._arp, self._sp = cpu.arp, cpu.sp  # before the next instruction
        self._trace: list[Traced] = []
        self._steps: dict[Place, int] = {}  # by word: what a pass adds to it

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        if not self._cpu.polls.counting:
            self._over(self)
            return
        if len(self._trace) == MOST_TRACED or cpu.ovm:  # OVM saturates results
            self._cpu.polls.soil()
            return
        operand = self._operand(f)
        values = register_words(cpu.acc, cpu.xar)
        for place in (*operand, *range(self._sp, cpu.sp)):
            if isinstance(place, int) and in_plain_ram(place):
                values[place] = self._memory.word(place)
        in_memory = f.l >= 0 and cpu.ea != REGISTER
        pointers = self._named(addressing(f.l)) if in_memory else 0
        self._trace.append(
            Traced(f, self._time.cycle, operand, pointers, self._named(f.needs), (self._sp, cpu.sp), values)
        )
        self._arp, self._sp = cpu.arp, cpu.sp

    def _named(self, mask: int) -> int:
        return mask | 1 << self._arp if mask & BY_ARP else mask

    def _operand(self, f: Operation) -> tuple[Place, ...]:
        if f.l < 0:
            return ()
        if self._cpu.ea == REGISTER:
            return WORDS.get(operand_texts(f.wide)[f.l].removeprefix("@"), ())
        address = self._cpu.ea
        if L0_AGAIN <= address < L4_AGAIN:
            address -= MIRROR
        if not in_plain_ram(address):
            return ()
        return (address & ~1, address | 1) if f.wide else (address,)

    # Effects of further passes -----------------------------------------------------------

    def passes(self, changed: Mapping[int, int]) -> int:
        """Return how many passes after this one only count. changed: words that it changed, with earlier values."""
        before, after = self._state, self._cpu.state()
        self.does_more = before[COUNTERS:] != after[COUNTERS:]
        if self.does_more:
            return 0
        counters = self._counters(changed)
        if not counters or any(place in counters for _, place in XAR):
            return 0
        self._steps = {place: number.step for place, number in counters.items()}
        repeated = RepeatedPass(counters)
        try:
            for traced in self._trace:
                repeated.step(traced)
        except NotCounting:
            self.does_more = True
            return 0
        further = {place: Number(number.value + number.step & M16, number.step) for place, number in counters.items()}
        self._stores = repeated.stores
        return repeated.passes if repeated.counters == further else 0

    def _counters(self, changed: Mapping[int, int]) -> dict[Place, Number]:
        """Return the words that this pass has changed, with their values before it."""
        before = register_words(self._state[0], self._state[1:COUNTERS]) | dict(changed)
        words = {address: self._memory.word(address) for address in changed}
        after = register_words(self._cpu.acc, self._cpu.xar) | words
        steps = {place: (after[place] - value + HALF & M16) - HALF for place, value in before.items()}
        return {place: Number(before[place], step) for place, step in steps.items() if step}

    def cut_off(self, cycles: int) -> None:
        """Make the stores of the next pass up to a reset, which occurs this number of cycles after its begin."""
        for at, address, value, step in self._stores:
            if at - self._began < cycles:
                self._memory.put(address, value + step * (self._moved + 1) & M16)

    def move(self, passes: int) -> None:
        """Advance the counters by this number of passes."""
        self._moved = passes
        cpu = self._cpu
        words = register_words(cpu.acc, cpu.xar)
        for place, step in self._steps.items():
            if isinstance(place, int):
                self._memory.put(place, self._memory.word(place) + step * passes & M16)
            else:
                words[place] = words[place] + step * passes & M16
        cpu.acc = words["AL"] | words["AH"] << 16
        cpu.xar = [words[low] | words[high] << 16 for low, high in XAR]
