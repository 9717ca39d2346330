"""Delay slots of the FPU: find instructions that read a late result too early, and model the value that they read.

    MPYF32 R0H,R1H,R2H    latency 2p: the late result, R0H, is written only after the next instruction
    NOP                   the delay slot: an instruction that must not use R0H, because the CPU does not wait for R0H
    ADDF32 R3H,R0H,R4H    reads the result

`not_kept` finds instructions in a delay slot that read the register or the flags of the late result. An operation that
was passed to `delay` models the late result: the instruction in the delay slot reads the old value of R0H. The result
is written after this instruction, even if this instruction writes R0H, too. If an interrupt is taken before the delay
slot, the result is written before the interrupt. LUF and LVF are set together with the result.

Source: SPRUEO2A 3.1, 3.2; the column `latency` of `encodings.toml`.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from .decoder import Instruction, decode_at
from .encodings import places
from .execution.cpu import Cpu, Operation
from .execution.registers import LUF, LVF
from .operands import FPU_APART, FPU_FIRST, REGISTER_FIELDS

ALL, EVERY = "R0H-R7H", 0xFF
FLAGS = 1 << 8  # the bit of LUF and LVF in a mask whose bits 0 to 7 are R0H to R7H
NAMES = (*(f"R{number}H" for number in range(8)), "LUF and LVF")
FLAG_BITS = LUF | LVF
CONDITIONS = (12, 13)  # codes of the conditions that test LUF and LVF
AT_ONCE = "RaH"  # in a pair of parallel instructions with the latency "2p/1", the load of RaH has no delay slot
BLOCKS = frozenset(("RPTB_label_RC", "RPTB_label_loc16"))


def late_results(instruction: Instruction) -> int:
    """Return the mask of the FPU registers, and of FLAGS, that this instruction writes only after the next one."""
    encoding = instruction.encoding
    if not encoding.latency:
        return 0
    late = (place for place in places(encoding.writes) if encoding.latency != "2p/1" or place != AT_ONCE)
    return _registers(late, instruction.values) | (FLAGS if "LVF" in encoding.flags else 0)


def read_registers(instruction: Instruction) -> int:
    """Return the mask of the FPU registers, and of FLAGS, that this instruction reads."""
    encoding, values = instruction.encoding, instruction.values
    mask = _registers(places(encoding.reads), values)
    if encoding.id == "MOV32_loc32_ind_0_16":
        number, rest = divmod(values["c"] - FPU_FIRST, FPU_APART)
        mask |= 1 << number if number in range(8) and not rest else 0
    if "w" in values:
        reads_flags = values["w"] in CONDITIONS
    elif encoding.mnemonic == "MOVST0":
        reads_flags = values["g"] & FLAG_BITS != 0
    else:
        reads_flags = "STF@E" in encoding.reads
    return mask | FLAGS if reads_flags else mask


def not_kept(instruction: Instruction, word_at: Callable[[int], int]) -> Iterator[str]:
    """Yield a sentence if this instruction has a late result that the instruction in the delay slot reads.

    For RPTB, check instead the last instruction of the repeated block. The first instruction of the block is then in
    its delay slot.

    word_at: returns the word of program memory at an address.
    """
    if instruction.encoding.id in BLOCKS:
        yield from _around(instruction, word_at)
    elif late_results(instruction):
        behind = _at(instruction.address + instruction.words, word_at)
        if behind is not None:
            yield from _between(instruction, behind)


def _around(block: Instruction, word_at: Callable[[int], int]) -> Iterator[str]:
    first = found = _at(block.address + block.words, word_at)
    end = block.address + block.words + block.values["z"]
    while found is not None and first is not None:
        after = found.address + found.words
        if after >= end:
            yield from _between(found, first)
            return
        found = _at(after, word_at)


def _between(instruction: Instruction, behind: Instruction) -> Iterator[str]:
    early = late_results(instruction) & read_registers(behind)
    if early:
        names = " and ".join(name for number, name in enumerate(NAMES) if early >> number & 1)
        where = f"in the delay slot of {instruction.encoding.mnemonic} at {instruction.address:#08x}"
        who = f"{behind.encoding.mnemonic} at {behind.address:#08x}"
        yield f"{who} reads {names} {where}: the setting fpu_delay_slot selects whether it gets the new result"


def _at(address: int, word_at: Callable[[int], int]) -> Instruction | None:
    return decode_at(address, word_at(address), word_at(address + 1))


def _registers(names: Iterable[str], values: Mapping[str, int]) -> int:
    mask = 0
    for name in names:
        if name in REGISTER_FIELDS:
            mask |= 1 << values[REGISTER_FIELDS[name]]
        elif name == ALL:
            mask |= EVERY
        elif len(name) == 3 and name[0] == "R" and name[2] == "H" and name[1].isdigit():
            mask |= 1 << int(name[1])
    return mask


def delay(f: Operation) -> None:
    """Model the delay slot: make an operation write its late results only after the next operation."""
    f.plain = f.execute
    f.execute = _delayed


def _delayed(cpu: Cpu, f: Operation) -> None:
    """Execute an operation, then write the pending results of the previous operation.

    The late results of the executed operation become pending.
    """
    late, due, flags = f.late, cpu.due, cpu.due_flags
    if not late and not due and not flags:
        f.plain(cpu, f)
        return
    raised = cpu.stf
    number: int
    for number in range(8):
        cpu.before_r[number] = cpu.r[number]
    f.plain(cpu, f)
    for number in range(8):
        value = cpu.r[number]
        if late >> number & 1:
            cpu.r[number] = cpu.before_r[number]
        if due >> number & 1:
            cpu.r[number] = cpu.due_r[number]
        if late >> number & 1:
            cpu.due_r[number] = value
    raised = cpu.stf & ~raised & (LUF | LVF) if late else 0
    cpu.stf = cpu.stf & ~raised | flags
    cpu.due, cpu.due_flags = late, raised


def arrive(cpu: Cpu) -> None:
    """Write the pending late results. Call this function when an interrupt is taken."""
    number: int
    for number in range(8):
        if cpu.due >> number & 1:
            cpu.r[number] = cpu.due_r[number]
    cpu.stf |= cpu.due_flags
    cpu.due = cpu.due_flags = 0
