"""FPU results that are written one instruction late, to show what a program that violates delay slots reads.

    MPYF32 R0H,...        executed: R0H keeps its old value, the product is pending
    next instruction      reads the old R0H; after it R0H is the product, even if the instruction wrote R0H itself
    interrupt             between the two: the product is written first

LUF and LVF are set with the result. Operations not passed to `delay` write at once. Source: SPRUEO2A 3.1, 3.2.
"""

# core: compiled

from __future__ import annotations

from .cpu import Cpu, Operation
from .registers import LUF, LVF

__all__ = ("arrive", "delay")


def delay(f: Operation) -> None:
    """Make this operation model late results: its own and those of the one before."""
    f.plain = f.execute
    f.execute = delayed


def delayed(cpu: Cpu, f: Operation) -> None:
    """Execute an operation; then write pending results, and make its own late results pending."""
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
    """Write pending results at once, because an interrupt follows and not the next instruction."""
    number: int
    for number in range(8):
        if cpu.due >> number & 1:
            cpu.r[number] = cpu.due_r[number]
    cpu.stf |= cpu.due_flags
    cpu.due = cpu.due_flags = 0
