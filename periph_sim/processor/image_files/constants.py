"""Find accesses to constant memory addresses in code, without executing the code.

    MOVW DP,#0x1C5        DP = 0x1C5
    MOVL XAR4,#0x0085F0   XAR4 = 0x0085F0
    MOVL @0x2,XAR4        write of 0x0085F0 to 0x1C5 << 6 | 2

The values of DP, SP and XAR0 to XAR7 are tracked within a function and over its forward branches. A value is unknown if
it comes from memory, from an argument, or from most arithmetic. Accesses to unknown addresses are not found.

Source: SPRU430F chapter 5 (addresses).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ..c28x.decoder import Instruction
from ..c28x.encodings import places
from ..c28x.execution.cpu import REGISTER, WRITES
from ..c28x.execution.engine import Engine
from ..c28x.execution.operations import operation
from ..c28x.execution.registers import Registers
from ..c28x.pipeline import BY_ARP, FIELDS, MASKS, MOVING, POPS, PUSHES, REGISTERS, SP, addressing, registers_in

FPU_REGISTERS = range(0x0F00, 0x0F30)  # a move with an address in this range accesses an FPU register
XARS = 0xFF  # mask of XAR0 to XAR7


class Access(NamedTuple):
    """Access to memory at a constant address.

    width: 16 or 32 bits.
    how: "r" for a read, "w" for a write, "rw" for both.
    value: the value of the address register that MOVL writes, if it is known; otherwise None.
    """

    address: int
    width: int
    how: str
    value: int | None
    instruction: Instruction


class _Cpu(Engine):
    """A CPU without memory. known: the mask of those of the registers REGISTERS whose values are known."""

    def __init__(self) -> None:
        super().__init__()
        self.known = 0

    def load16(self, address: int) -> int:
        return 0

    def store16(self, address: int, value: int) -> None:
        """Discard the value."""


def accesses(
    instructions: Iterable[Instruction | int], functions: frozenset[int], begin: Registers | None = None
) -> Iterator[Access]:
    """Yield every access that has a known address.

    instructions: the result of `sweep`: instructions, and the addresses of words that are no instructions.
    functions: the addresses at which functions begin. All register values are unknown there.
    begin: the registers before the first instruction; None if their values are unknown.
    """
    cpu, nothing = _Cpu(), (0, 0, 0, [0] * 8)
    if begin is not None:
        cpu.known, cpu.dp, cpu.sp, cpu.xar = REGISTERS, begin.dp, begin.sp, list(begin.xar)
    waiting: dict[
        int, tuple[int, int, int, list[int]]
    ] = {}  # for the target of each forward branch: `known`, DP, SP, XARs
    reached = True
    for instruction in instructions:
        if isinstance(instruction, int) or instruction.address in functions:
            cpu.known, reached = 0, True
            waiting.clear()
            if isinstance(instruction, int):
                continue
        arrived = waiting.pop(instruction.address, nothing)
        if not reached:
            cpu.known, cpu.dp, cpu.sp, cpu.xar = arrived
        yield from _executed(instruction, cpu)
        goal = instruction.target
        if instruction.is_call:
            cpu.known = 0
        elif goal is not None and goal > instruction.address:
            waiting.setdefault(goal, (cpu.known, cpu.dp, cpu.sp, list(cpu.xar)))
        reached = instruction.goes_on


def _executed(instruction: Instruction, cpu: _Cpu) -> Iterator[Access]:
    """Yield the accesses of an instruction to known addresses, and execute its effects on the registers."""
    encoding, f = instruction.encoding, operation(instruction)
    width, numbers = 32 if f.wide else 16, {"n": f.n, "m": f.m}
    if f.l in MOVING:
        cpu.known &= ~XARS
    elif f.l >= 0 and f.l not in (PUSHES, POPS) and not addressing(f.l) & ~cpu.known:
        is_known = encoding.id.startswith("MOVL_loc32_XAR") and cpu.known >> f.n & 1
        value = cpu.xar[f.n] if is_known else None
        cpu.begin(f)
        if cpu.ea != REGISTER and encoding.accesses:
            yield Access(cpu.ea, width, encoding.accesses, value, instruction)
    if f.absolute and f.c not in FPU_REGISTERS:
        yield Access(f.c, width, "w" if f.absolute == WRITES else "r", None, instruction)
    written = registers_in(encoding.writes, numbers)
    if f.accesses & WRITES and 0xA0 <= f.l < 0xA8:
        written |= 1 << (f.l & 7)
    if written & BY_ARP:
        written |= XARS
    # These instructions keep a part of the register that they write.
    kept = [name for name in places(encoding.writes) if name.startswith("AR") or encoding.id == "MOV_DP_10"]
    needed = [*places(encoding.reads), *kept]
    is_computed = all(name in MASKS or name in FIELDS for name in needed)
    if written and is_computed and not registers_in(needed, numbers) & ~cpu.known:
        cpu.finish(f)
        cpu.known |= written & REGISTERS
    else:
        cpu.known &= ~written
    if written & SP or f.l in (PUSHES, POPS):
        cpu.known &= ~SP
