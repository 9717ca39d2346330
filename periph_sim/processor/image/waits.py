"""Waits of an image: what a loop waits for, and for how long.

A wait is described by the registers and bits that its loop reads. The bits are those of the loop's first bit test or
mask; without one, all bits of a register. A loop that reads no register, and has an exit, waits for memory: its words
are named by the symbols before them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from ...core.records import Kind, Recorder
from ...core.registers import Register
from ...core.state import State
from ...core.time import Clock
from ...f28335.memory.address_space import Content, area_at, full_name
from ..c28x.decoder import Instruction, sweep
from ..image_files.constants import Known, accesses
from ..image_files.model import Image
from ..operand import Operand
from ..processor import Awaited
from .cpu import ImageCpu

LONGEST = 64  # words of a loop that is examined
ALL = 0xFFFF
MEMORY = "memory"  # unknown words


class LoopRange(NamedTuple):
    """The addresses of a loop's first and last instructions."""

    first: int
    branch: int


def awaited(
    cpu: ImageCpu, loop: LoopRange, operands: Sequence[Operand], elsewhere: Sequence[int], unit: str, image: Image
) -> Awaited:
    """Return what a loop waits for that reads these registers of modules, and these unmodelled words."""
    if not operands and not elsewhere:
        names = [_name(image, address) for address in _memory_read(cpu, loop)] if _may_end(cpu, loop) else None
        return Awaited("" if names is None else " and ".join(names or [MEMORY]), "", names is not None)
    mask = mask_of(loop.first, _words(cpu, loop))
    texts = [f"{operand.name}.{fields_of(operand.register, mask)}" for operand in operands]
    names = list(dict.fromkeys(f"{full_name(address)} & {mask:#06x}" for address in elsewhere))
    unanswered = _unanswered(cpu, elsewhere, unit) if elsewhere else ""
    return Awaited(" and ".join(dict.fromkeys([*texts, *names])), unanswered)


def _unanswered(cpu: ImageCpu, addresses: Sequence[int], unit: str) -> str:
    """Return why these words keep their values, and what to add to the case; "" if a stub will answer later."""
    memory = cpu.elsewhere
    if any(address in memory.to_come for address in addresses):
        return ""
    answers = [memory.stubs[address] for address in addresses if address in memory.stubs]
    if answers:
        return (
            f"its [[unit.{unit}.stub]] answers {answers[0]:#06x}; give a value that ends the wait, "
            "or a later one by a further stub with after"
        )
    register = full_name(addresses[0])
    return f'it is not modelled; answer it by [[unit.{unit}.stub]] with register = "{register}" and a value'


def fields_of(register: Register, mask: int) -> str:
    """Return the fields of a register that have bits of the mask; "all" for a full mask or no field."""
    if mask == ALL:
        return "all"
    return "+".join(field.name for field in register.fields if field.mask & mask) or "all"


@lru_cache(maxsize=256)
def mask_of(first: int, words: tuple[int, ...]) -> int:
    """Return the bits that a loop of these words tests. first: its first address."""
    for one in _instructions(first, words):
        mnemonic, values = one.encoding.mnemonic, one.values
        if mnemonic == "TBIT" and "b" in values:
            return 1 << values["b"]
        if mnemonic in ("AND", "ANDB") and "c" in values:
            return values["c"]
    return ALL


def _words(cpu: ImageCpu, loop: LoopRange) -> tuple[int, ...]:
    """Return the words of a loop, and one more; none of a long one."""
    if loop.branch - loop.first >= LONGEST:
        return ()
    return tuple([cpu.word_at(address) for address in range(loop.first, loop.branch + 2)])


def _instructions(first: int, words: tuple[int, ...]) -> Iterator[Instruction]:
    """Yield the instructions in these words; the last word only completes an instruction."""
    for found in sweep(first, words):
        if isinstance(found, int) or found.address >= first + len(words) - 1:
            return
        yield found


def _may_end(cpu: ImageCpu, loop: LoopRange) -> bool:
    """Return True if the loop has an exit; a loop without one is the end of a program."""
    for one in _instructions(loop.first, _words(cpu, loop)):
        goal = one.target
        if goal is None or one.is_call or not one.goes_on:
            continue
        if one.address == loop.branch or not loop.first <= goal <= loop.branch:
            return True
    return False


def _memory_read(cpu: ImageCpu, loop: LoopRange) -> list[int]:
    """Return the words of RAM that the loop reads, as far as its instructions determine their addresses."""
    found = accesses(_instructions(loop.first, _words(cpu, loop)), frozenset(), Known(cpu.dp, cpu.xar, cpu.sp))
    read = dict.fromkeys(one.address for one in found if "r" in one.how)
    return [address for address in read if (area := area_at(address)) is not None and area.content is Content.RAM]


def _name(image: Image, address: int) -> str:
    """Return the name of a word by the symbol at or before it in its section; else its address."""
    section = next((one for one in image.sections if one.runs_at(address)), None)
    if section is not None:
        before = [at for at in image.symbol_at if section.run <= at <= address]
        if before:
            offset = address - max(before)
            return image.symbol_at[max(before)] + (f"+{offset}" if offset else "")
    return f"{address:#06x}"


LCR_WORDS = 2


class UnmodelledWait(NamedTuple):
    """A wait for unmodelled registers, which continues across interrupts.

    since: the cycle at which it began. addresses: the unmodelled words that it reads.

    sp: the stack pointer in the loop. routines: number of service routines active there.
    """

    since: int
    loop: LoopRange
    sp: int
    routines: int
    addresses: list[int]

    def goes_on(self, cpu: ImageCpu) -> bool:
        """Return True if the program is in the loop, in a function that it calls, or in a routine that interrupts it.

        Call it at each entry of a service routine, too, and drop a wait that is over there.
        """
        routines = cpu.polls.routines
        if routines != self.routines:
            return routines > self.routines
        first, branch = self.loop
        if first <= cpu.pc <= branch:
            return cpu.sp == self.sp
        return cpu.sp > self.sp and first < cpu.rpc <= branch + LCR_WORDS


IDLE = "IDLE"
ENDLESS = "endless loop"  # one that reads no register


class WaitRecords:
    """WAIT records of an image, in the same form as those of Python firmware."""

    STATE = State("_what")

    def __init__(self, recorder: Recorder, clock: Clock, unit: str) -> None:
        self._recorder, self._clock, self._unit = recorder, clock, unit
        self._what = ""

    def begins(self, what: str, cycle: int, place: str) -> None:
        """Record the begin of a wait for `what`, or in IDLE; "": an endless loop that reads no register."""
        self._what = what or ENDLESS
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self._unit, self._what, 1, place)

    def ends(self, cycle: int) -> None:
        """Record the end of the last wait."""
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self._unit, self._what, 0)
