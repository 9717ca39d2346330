"""Counting loops: how many passes after a traced one differ only in their counters.

    pass --executed--> trace; words that differ before and after it --> counters, each with its step
    trace --repeated with counters in place of values--> number of passes in which nothing else differs

A counter is a word of 16 bits, of ACC, an XARn or plain RAM, that changes by the same step in each pass. If each
counter ends one step further, and all other registers and the pipeline are as before, the passes up to the bound that
`repeated_pass` returns take the same cycles and branches, and make the same accesses.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from ...core.state import State
from ...f28335.memory.ram import Ram
from ..c28x.execution.cpu import REGISTER, Cpu, Operation
from ..c28x.execution.registers import M16, M32
from ..c28x.hazards import BY_ARP, addressing
from ..cpu_time import CpuTime
from .cpu import ImageCpu
from .instruction_watch import InstructionWatch
from .memory import L0_AGAIN, L4_AGAIN, MIRROR, in_plain_ram
from .repeated_pass import ACC, XAR, NotCounting, Number, Place, RepeatedPass, Store, Traced

MOST_TRACED = 256  # instructions of a pass
HALF = 1 << 15  # of a word
COUNTERS = 9  # first entries of a state: ACC and XAR0 to XAR7
AX_FIELDS = {0xA8: ("AH",), 0xA9: ("AL",)}  # operand fields of 16 bits
ACC_FIELDS = (0xA8, 0xA9)  # and of 32 bits


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
                yield place, Number(before, (after - before + HALF & M16) - HALF)

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
