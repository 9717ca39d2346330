"""Analysis of loops that count: how many passes after a traced one differ only in their counters.

    pass --executed--> trace; words that differ before and after it --> counters, each with its step
    trace, repeated with counters in place of values --> number of passes in which nothing else differs

A counter is a word of 16 bits, of ACC, an XARn or plain RAM, that changes by the same step in each pass. An instruction
either reads no counter, so that it has the same effect in each pass, or it is one of FORMS: its result is a counter,
too, and its flags keep their values until an operand, or the exact result, reaches a multiple of half its range. If
each counter ends one step further, and all other registers and the pipeline are as before, the passes up to that bound
take the same cycles and branches, and make the same accesses.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from ...c28x.encodings import LOCATIONS, Encoding
from ...c28x.execution.registers import M16, M32, REGISTER, Cpu, Operation
from ...c28x.hazards import BY_ARP, addressing
from ...core.chip import NEVER
from ...core.state import State
from ...f28335.memory.ram import Ram
from ..cpu_time import CpuTime
from .cpu import L0_AGAIN, L4_AGAIN, LOW_RAM, MIRROR, RAM_FROM, RAM_TO, ImageCpu
from .instruction_watch import InstructionWatch

MOST_TRACED = 256  # instructions of a pass
WORD = 1 << 16
PLAIN_RAM = (range(LOW_RAM), range(RAM_FROM, RAM_TO))

# "RESULT = LEFT + RIGHT", "RESULT = LEFT", or LEFT - RIGHT for its flags alone, as in the column `op` of the table.
FORMS: Mapping[str, str] = {
    "ADDB_ACC_8": "ACC = ACC + c",
    "ADDB_AX_8s": "AX = AX + s8",
    "ADDB_XARn_7": "XARn = XARn + c",
    "ADDL_ACC_loc32": "ACC = ACC + loc",
    "ADDL_loc32_ACC": "loc = loc + ACC",
    "ADD_AX_loc16": "AX = AX + loc",
    "ADD_loc16_16s": "loc = loc + c",
    "ADD_loc16_AX": "loc = loc + AX",
    "BANZ_off16_ARndec": "ARn = ARn - 1",
    "BAR_off16_ARn_ARm_EQ": "ARn - ARm",
    "BAR_off16_ARn_ARm_NEQ": "ARn - ARm",
    "CMPB_AX_8": "AX - c",
    "CMPL_ACC_loc32": "ACC - loc",
    "CMP_AX_loc16": "AX - loc",
    "CMP_loc16_16s": "loc - c",
    "DEC_loc16": "loc = loc - 1",
    "INC_loc16": "loc = loc + 1",
    "MOVL_ACC_loc32": "ACC = loc",
    "MOVL_loc32_ACC": "loc = ACC",
    "MOVU_ACC_loc16": "ACC = loc",
    "MOVZ_ARn_loc16": "XARn = loc",
    "MOV_AX_loc16": "AX = loc",
    "MOV_loc16_ARn": "loc = ARn",
    "MOV_loc16_AX": "loc = AX",
    "SUBB_ACC_8": "ACC = ACC - c",
    "SUBB_XARn_7": "XARn = XARn - c",
    "SUBL_ACC_loc32": "ACC = ACC - loc",
    "SUBL_loc32_ACC": "loc = loc - ACC",
    "SUB_AX_loc16": "AX = AX - loc",
    "SUB_loc16_AX": "loc = loc - AX",
    "TEST_ACC": "ACC - 0",
    **{f"MOVL_XAR{n}_loc32": f"XAR{n} = loc" for n in range(8)},
    **{f"MOVL_loc32_XAR{n}": f"loc = XAR{n}" for n in range(8)},
}
ACC = ("AL", "AH")
COUNTERS = 9  # first entries of a state: ACC and XAR0 to XAR7
XAR = tuple((f"AR{n}", f"AR{n}H") for n in range(8))
AX_FIELDS = {0xA8: ("AH",), 0xA9: ("AL",)}  # operand fields of 16 bits
ACC_FIELDS = (0xA8, 0xA9)  # and of 32 bits
# Names in the columns `reads` and `writes` where no counter can be. Address registers are in `needs` and `makes`.
UNCOUNTED = re.compile(r"X?AR.*|P|PH|PL|T|TL|XT|OVC|ST0|ST1|STF|R[0-7a-f]H|R0H-R7H|SP|DP|PC|RPC|RPTC|RB|IER|address")

Place = str | int  # a word: register name or memory address


class NotCounting(Exception):
    """The pass does more than count; further ones may differ."""


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
    """A value in this pass, and its change in the next."""

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


def in_plain_ram(address: int) -> bool:
    return any(address in zone for zone in PLAIN_RAM)


def signed(value: int, bits: int) -> int:
    half = 1 << bits - 1
    return (value & 2 * half - 1 ^ half) - half


class CountingLoop(InstructionWatch):
    """Trace of the pass of a loop that begins now. does_more: it does more than count, and so will later passes."""

    STATE = State(
        "does_more _moved _stores _state _arp _sp _trace _steps _time _cpu _memory _over",
        cycles="_began",
        made=True,
    )

    def __init__(self, cpu: ImageCpu, time: CpuTime, memory: Ram, over: Callable[[InstructionWatch], None]) -> None:
        """over: called when the trace is no longer needed."""
        super().__init__()
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
        super().executed(f, cpu, cycle)
        if not self._cpu.polls.counting:
            self._over(self)
            return
        if len(self._trace) == MOST_TRACED or cpu.ovm:  # OVM saturates results
            self._cpu.polls.soil()
            return
        operand = self._operand(f)
        values: dict[Place, int] = {"AL": cpu.acc & M16, "AH": cpu.acc >> 16}
        for (low, high), value in zip(XAR, cpu.xar, strict=True):
            values[low], values[high] = value & M16, value >> 16
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
            if f.l < 0xA8:
                return XAR[f.l & 7] if f.wide else XAR[f.l & 7][:1]
            return (ACC if f.l in ACC_FIELDS else ()) if f.wide else AX_FIELDS.get(f.l, ())
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
        counters = dict(self._counters(changed))
        if not counters or any(place in counters for _, place in XAR):
            return 0
        self._steps = {place: number.step for place, number in counters.items()}
        walk = Walk(counters)
        try:
            for traced in self._trace:
                walk.step(traced)
        except NotCounting:
            self.does_more = True
            return 0
        further = {place: Number(number.value + number.step & M16, number.step) for place, number in counters.items()}
        self._stores = walk.stores
        return walk.passes if walk.counters == further else 0

    def _counters(self, changed: Mapping[int, int]) -> Iterable[tuple[Place, Number]]:
        """Yield the words that this pass has changed, with their values before it."""
        acc, xars = self._state[0], self._state[1:COUNTERS]
        pairs: list[tuple[Place, int, int]] = [
            ("AL", acc & M16, self._cpu.acc & M16),
            ("AH", acc >> 16, self._cpu.acc >> 16),
        ]
        for (low, high), before, after in zip(XAR, xars, self._cpu.xar, strict=True):
            pairs += [(low, before & M16, after & M16), (high, before >> 16, after >> 16)]
        pairs += [(address, before, self._memory.word(address)) for address, before in changed.items()]
        for place, before, after in pairs:
            if before != after:
                yield place, Number(before, signed(after - before, 16))

    def cut_off(self, cycles: int) -> None:
        """Make the stores of the next pass up to a reset, which occurs this number of cycles after its begin."""
        for store in self._stores:
            if store.at - self._began < cycles:
                self._memory.put(store.address, store.value + store.step * (self._moved + 1) & M16)

    def move(self, passes: int) -> None:
        """Advance the counters by this number of passes."""
        self._moved = passes
        cpu = self._cpu
        xars = list(cpu.xar)
        for place, step in self._steps.items():
            more = step * passes
            if isinstance(place, int):
                self._memory.put(place, self._memory.word(place) + more & M16)
            elif place == "AL":
                cpu.acc = cpu.acc & ~M16 | cpu.acc + more & M16
            elif place == "AH":
                cpu.acc = cpu.acc + (more << 16) & M32
            else:
                n = int(place[2])
                xars[n] = xars[n] & ~M16 | xars[n] + more & M16
        cpu.xar = xars


class Walk:
    """Repetition of a traced pass with counters in place of values.

    counters: words that count, with their values at this point of the pass. passes: upper bound of the further passes
    for which all of it is true. stores: to memory.
    """

    def __init__(self, counters: Mapping[Place, Number]) -> None:
        self.counters = dict(counters)
        self.passes = NEVER
        self.stores: list[Store] = []

    def step(self, traced: Traced) -> None:
        """Repeat the next instruction. Raise NotCounting if it uses a counter in none of the FORMS."""
        self._execute(traced)
        for place in writes(traced):
            if place in traced.values and isinstance(place, int):
                number = self.counters.get(place)
                self.stores.append(Store(traced.at, place, traced.values[place], number.step if number else 0))

    def _execute(self, traced: Traced) -> None:
        if any(place in self.counters for place in _address_registers(traced.pointers)):
            raise NotCounting
        form = FORMS.get(traced.f.encoding.id)
        if form is not None and self._counts(traced, form.split()):
            return
        for place in reads(traced):
            if place in self.counters:
                raise NotCounting
        for place in writes(traced):
            self.counters.pop(place, None)

    def _counts(self, traced: Traced, form: Sequence[str]) -> bool:
        """Compute the result of a form. Return False if no operand is a counter, so that the result is none."""
        result, (left, *operation) = (form[0], form[2:]) if form[1] == "=" else ("", form)
        sources = [places_of(left, traced)]
        if operation:
            sources.append(places_of(operation[1], traced))
        if not any(place in self.counters for source in sources for place in source):
            return False
        target = places_of(result, traced) if result else ()
        if result and not target:
            raise NotCounting
        width = 16 * max(len(target), *(len(source) for source in sources))
        bound = 1 << width - 1
        sign = -1 if operation and operation[0] == "-" else 1
        if operation:
            right = self._right(operation[1], sources[1], target, traced)
            if result:
                before = self._before(sources[0], _value(target, traced) - sign * right.value & 2 * bound - 1)
            else:
                before = self._number(sources[0], traced)
            exact = Number(before.value + sign * right.value, before.step + sign * right.step)
            for number in (before, right, exact):
                self._bound(number, bound)
            number = Number(exact.value & 2 * bound - 1, exact.step)
        else:
            number = self._number(sources[0], traced)
            self._bound(number, bound)
        if result:
            self._put(target, number)
        return True

    def _right(self, name: str, places: Sequence[Place], target: Sequence[Place], traced: Traced) -> Number:
        if not places:
            return Number(constant(name, traced.f), 0)
        if any(place in target for place in places):
            raise NotCounting
        return self._number(places, traced)

    def _number(self, places: Sequence[Place], traced: Traced) -> Number:
        """Return the number in words that the instruction does not change."""
        return self._before(places, _value(places, traced))

    def _before(self, places: Sequence[Place], value: int) -> Number:
        """Return this value as a number with the step of its low word."""
        if not places:
            raise NotCounting
        if any(place in self.counters for place in places[1:]):
            raise NotCounting
        low = self.counters.get(places[0])
        return Number(value, 0 if low is None else low.step)

    def _put(self, places: Sequence[Place], number: Number) -> None:
        """Set the result. Its upper word stays constant until the lower one overflows."""
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


def constant(name: str, f: Operation) -> int:
    match name:
        case "c":
            return f.c
        case "s8":
            return signed(f.c, 8) & M16
        case "0" | "1":
            return int(name)
    raise NotCounting


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
    for name in _names(traced.f.encoding.reads):
        yield from _words(name, traced, range(traced.sp[1], traced.sp[0]))
    yield from _address_registers(traced.needs)


def writes(traced: Traced) -> Iterable[Place]:
    """Yield the possible counters that it writes. Raise NotCounting if they are not listed, or may stay unwritten."""
    f, encoding = traced.f, traced.f.encoding
    if _writes_in_part(encoding):
        raise NotCounting
    for name in _names(encoding.writes):
        yield from _words(name, traced, range(traced.sp[0], traced.sp[1]))
    yield from _address_registers(f.makes)


def _names(places: Iterable[str]) -> Iterable[str]:
    return (place.partition("@")[0] for place in places)


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
