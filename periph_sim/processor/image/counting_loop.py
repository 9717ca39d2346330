"""Counting loops: find the number of further passes of a loop that change only counters, and skip these passes.

    executed pass --> trace; the words that the pass has changed --> counters: value and step
    trace, evaluated again with counters in place of values --> number of passes in which only the counters differ

A counter is a 16-bit word in ACC, in an XARn or in plain RAM that changes by the same amount, its step, in each pass.
An instruction that reads no counter has the same effect in each pass. An instruction that reads a counter must be a
`Sum`, so its result is a counter, too. The flags that a sum sets can differ from those of the traced pass only after an
operand or the exact result has reached or crossed a multiple of 0x8000, or of 0x8000_0000 for a sum of two words.

At the end of the evaluation, each counter must have changed by its step. All other registers and the pipeline must be
as before the traced pass. Then all passes before the first change of a flag take the same cycles and branches, and make
the same accesses.
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
from .memory import first_address, in_plain_ram
from .observers import InstructionWatch

MOST_TRACED = 256  # maximum number of instructions in a trace
COUNTERS = 9  # number of first entries of `ImageCpu.state` that can contain counters: ACC, XAR0 to XAR7
WORD, HALF = 1 << 16, 1 << 15

Place = str | int  # a 16-bit word: the name of a half of a register, or a memory address

XAR = tuple((f"AR{n}", f"AR{n}H") for n in range(8))
# For the name of each register, its words, the low word first.
WORDS: dict[str, tuple[Place, ...]] = {"AL": ("AL",), "AH": ("AH",), "ACC": ("AL", "AH")}
WORDS |= {f"XAR{n}": XAR[n] for n in range(8)} | {f"AR{n}": XAR[n][:1] for n in range(8)}
OPERAND = ("loc", *LOCATIONS)  # names in `encodings.toml` of the operand that an instruction's field l encodes
# The names in the columns `reads` and `writes` of `encodings.toml` that this module can handle, in addition to "stack".
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
    """Raised if a traced pass does more than change counters, so that further passes may have other results."""


class Traced(NamedTuple):
    """An instruction of a traced pass.

    f: the instruction.
    at: the cycle in which the instruction was executed.
    operand: the words of the operand that the instruction's field l (in `encodings.toml`) encodes, the low word first;
        empty if they cannot be counters.
    pointers: mask of the registers from which the address of the operand is computed.
    needs: mask of the registers that the instruction needs in phase D2.
    sp: SP before and after the instruction.
    values: the values after the instruction of ACC and XAR0 to XAR7, and of the operand and pushed words in RAM.
    """

    f: Operation
    at: int
    operand: tuple[Place, ...]
    pointers: int
    needs: int
    sp: tuple[int, int]
    values: Mapping[Place, int]


Store = tuple[int, int, int, int]  # a write to memory: cycle, address, value, and the step of the value


class Number(NamedTuple):
    """An operand or a result of one or two words. value: its value in one pass. step: its change in each pass."""

    value: int
    step: int


def passes_within(number: Number, size: int) -> int:
    """Return the number of further passes before a number reaches or crosses a multiple of `size`.

    Return NEVER if the step of the number is 0; otherwise, return 0 if it is a multiple of `size` already.
    """
    value, step = number
    if not step:
        return NEVER
    rest = value % size
    if not rest:
        return 0
    return (size - 1 - rest) // step if step > 0 else (rest - 1) // -step


# Instructions that count --------------------------------------------------------------------

PLACE = "ACC|AX|ARn|ARm|XARn|XAR[0-7]|loc"
NUMBER = r"simm\d+|uimm\d+|0|1"
COPY = re.compile(rf"({PLACE}) = (?:u\()?({PLACE})\)?")
ADDITION = re.compile(rf"({PLACE}) ([+-])= (?:u\()?({PLACE}|{NUMBER})\)?(?:; if it was not 0: PC = PC \+ simm16)?")
COMPARISON = re.compile(
    rf"flags of ({PLACE})(?: - ({PLACE}|{NUMBER}))?|if ({PLACE}) [=!]= ({PLACE}): PC = PC \+ simm16"
)


class Sum(NamedTuple):
    """The sum that an instruction computes: result = left + sign * right. For a copy, `right` is 0.

    result: the name of the operand that is written, such as "ACC" or "loc"; "" if only the flags are written.
    left: the name of an operand.
    sign: 1 or -1.
    right: the name of an operand, or a number, "1" or "simm16".
    """

    result: str
    left: str
    sign: int
    right: str

    def number(self, c: int) -> int | None:
        """Return the value of `right`; None if it is the name of an operand.

        A signed immediate is extended to 16 bits. c: the value of field c, which contains the immediate.
        """
        if self.right.isdigit():
            return int(self.right)
        kind, immediate, bits = self.right.partition("imm")
        if not immediate:
            return None
        half = 1 << int(bits) - 1
        return (c ^ half) - half & M16 if kind == "s" else c


@cache
def sum_of(encoding: Encoding) -> Sum | None:
    """Return the sum, copy or comparison that an instruction of this form computes; None if it does anything else."""
    op = encoding.op
    if found := COPY.fullmatch(op):
        return Sum(found[1], found[2], 1, "0")
    if found := ADDITION.fullmatch(op):
        return Sum(found[1], found[1], -1 if found[2] == "-" else 1, found[3])
    if found := COMPARISON.fullmatch(op):
        return Sum("", found[1] or found[3], -1, found[2] or found[4] or "0")
    return None


def places_of(name: str, traced: Traced) -> tuple[Place, ...]:
    """Return the words of a named operand, the low word first; an empty tuple if they cannot be counters."""
    if name in OPERAND:
        return traced.operand
    f = traced.f
    numbered = {"AX": ("AL", "AH")[f.x], "ARn": f"AR{f.n}", "ARm": f"AR{f.m}", "XARn": f"XAR{f.n}"}
    return WORDS.get(numbered.get(name, name), ())


def reads(traced: Traced) -> Iterable[Place]:
    """Return the words that an instruction reads and that may be counters. Raise NotCounting if they are unknown."""
    return _used(traced.f.encoding.reads, traced, range(traced.sp[1], traced.sp[0]), traced.needs)


def writes(traced: Traced) -> Iterable[Place]:
    """Return the words that an instruction writes and that may be counters.

    Raise NotCounting if they are unknown, or if the instruction writes a byte, or writes only under a condition.
    """
    encoding = traced.f.encoding
    if "LSB" in encoding.id or "MSB" in encoding.id or ("_COND" in encoding.id and "PC" not in encoding.writes):
        raise NotCounting
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
    """Evaluates a traced pass with counters in place of values.

    counters: for each word that is a counter, its value and step at the present instruction.
    passes: the number of further passes for which the evaluation so far is valid.
    stores: the writes to memory so far.
    """

    def __init__(self, counters: Mapping[Place, Number]) -> None:
        self.counters = dict(counters)
        self.passes = NEVER
        self.stores: list[Store] = []

    def step(self, traced: Traced) -> None:
        """Evaluate the next instruction.

        Raise NotCounting as `reads` and `writes` do, and if the instruction uses a counter as an address, reads a
        counter but does not compute a `Sum`, or computes a sum that cannot be expressed as a counter.
        """
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
        """Compute the result of a sum, and return True. Return False, without effect, if no operand is a counter.

        Raise NotCounting if the result cannot be expressed as a counter.
        """
        left, right, target = (places_of(name, traced) for name in (done.left, done.right, done.result))
        if not any(place in self.counters for place in (*left, *right)):
            return False
        if done.result and not target:
            raise NotCounting
        bound = 1 << 16 * max(len(target), len(left), len(right)) - 1
        constant = done.number(traced.f.c)
        if any(place in target for place in right):
            raise NotCounting  # `right` is overwritten, and the trace has only values after the instruction
        added = self._number(right, _value(right, traced)) if constant is None else Number(constant, 0)
        earlier = _value(target, traced) - done.sign * added.value if target else _value(left, traced)
        before = self._number(left, earlier & 2 * bound - 1)
        exact = Number(before.value + done.sign * added.value, before.step + done.sign * added.step)
        for number in (before, added, exact):
            self._bound(number, bound)
        if target:
            low = Number(exact.value & M16, exact.step)
            if len(target) > 1:  # the upper word must not change, so the lower word must not overflow
                self._bound(low, WORD)
            for place in target:
                self.counters.pop(place, None)
            if exact.step:
                self.counters[target[0]] = low
        return True

    def _number(self, words: Sequence[Place], value: int) -> Number:
        """Return the number in one or two words. Raise NotCounting if there is no word, or the upper one is a counter.

        value: the value of the number. Its step is that of the low word.
        """
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
    """Traces a pass of a loop that begins when this object is made, and advances the counters for skipped passes.

    does_more: True if the traced pass changes more than counters; `polls.TRIES` such passes end the tracing of a loop.
    """

    STATE = State(
        "does_more _moved _stores _state _marks _arp _sp _trace _steps _time _cpu _memory _over",
        cycles="_began",
        made=True,
    )

    def __init__(self, cpu: ImageCpu, time: CpuTime, memory: Ram, over: Callable[[InstructionWatch], None]) -> None:
        """over: a function that is called with this object if the pass is no longer analysed."""
        self.does_more = False
        self._time = time
        self._began = time.cycle
        self._moved = 0  # number of skipped passes for which `move` has advanced the counters
        self._stores: list[Store] = []
        self._cpu = cpu
        self._memory = memory
        self._over = over
        self._state = cpu.state()
        self._marks = None if cpu.marks is None else cpu.marks.both()
        self._arp, self._sp = cpu.arp, cpu.sp  # ARP and SP before the next instruction of the trace
        self._trace: list[Traced] = []
        self._steps: dict[Place, int] = {}  # maps each counter to its step

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        if not self._cpu.polls.counting:
            self._over(self)
            return
        if len(self._trace) == MOST_TRACED or cpu.ovm:  # with OVM = 1, results saturate, so they have no constant step
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
        address = first_address(self._cpu.ea)
        if not in_plain_ram(address):
            return ()
        return (address & ~1, address | 1) if f.wide else (address,)

    # Effects of further passes -----------------------------------------------------------

    def passes(self, changed: Mapping[int, int]) -> int:
        """Return the number of passes, directly after the traced pass, that change nothing but counters.

        changed: for each memory word that the traced pass has changed, its earlier value.
        """
        before, after = self._state, self._cpu.state()
        marks = None if self._cpu.marks is None else self._cpu.marks.both()
        self.does_more = before[COUNTERS:] != after[COUNTERS:] or marks != self._marks
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
        """Return the earlier value and the step of each word that the traced pass has changed."""
        before = register_words(self._state[0], self._state[1:COUNTERS]) | dict(changed)
        words = {address: self._memory.word(address) for address in changed}
        after = register_words(self._cpu.acc, self._cpu.xar) | words
        steps = {place: (after[place] - value + HALF & M16) - HALF for place, value in before.items()}
        return {place: Number(before[place], step) for place, step in steps.items() if step}

    def cut_off(self, cycles: int) -> None:
        """Make the stores of a skipped pass that a reset has interrupted, up to the reset.

        cycles: the number of cycles from the start of this pass to the reset.
        """
        for at, address, value, step in self._stores:
            if at - self._began < cycles:
                self._memory.put(address, value + step * (self._moved + 1) & M16)

    def move(self, passes: int) -> None:
        """Advance the counters as the skipped passes would have done. passes: the number of skipped passes."""
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
