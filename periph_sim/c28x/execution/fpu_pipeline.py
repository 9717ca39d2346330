"""Results of the FPU that come one instruction late, for who wants to see what a program without delay slots reads.

    MPYF32 R0H,...   executed: R0H keeps its old value, the product is due
    the next one     reads R0H as it was; behind it the product is there, whatever it wrote to R0H itself
    an interrupt     between the two lets the product arrive

LUF and LVF come with the result. Operations that nobody has made `delay` write at once. Source: SPRUEO2A 3.1, 3.2.
"""

# core: compiled

from __future__ import annotations

from .registers import LUF, LVF, Cpu, Operation

__all__ = ("arrive", "delay")


def delay(f: Operation) -> None:
    """Have this operation, any of a program, heed late results: its own and those of the one before."""
    f.plain = f.execute
    f.execute = delayed


def delayed(cpu: Cpu, f: Operation) -> None:
    """Execute an operation; then what is due arrives, and what it writes late is due."""
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
    """What is due arrives: something else than the next instruction comes."""
    number: int
    for number in range(8):
        if cpu.due >> number & 1:
            cpu.r[number] = cpu.due_r[number]
    cpu.stf |= cpu.due_flags
    cpu.due = cpu.due_flags = 0
