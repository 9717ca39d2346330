"""Branches, calls and returns.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
A branch that is not taken sets `Cpu.cycles` to `Operation.not_taken`. Source: SPRU430F chapter 6.
"""

# core: compiled

from __future__ import annotations

from .cpu import Cpu, Operation
from .registers import CODE, M16, M32, PMA

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name


def _branch(cpu: Cpu, f: Operation, taken: bool, half: int = 0x8000) -> None:
    """If `taken`, jump from this instruction by the signed distance in field c. half: the sign bit of field c."""
    _jump(cpu, f, taken, f.address + ((f.c ^ half) - half) & CODE)


def _jump(cpu: Cpu, f: Operation, taken: bool, goal: int) -> None:
    """If `taken`, jump to `goal`."""
    if taken:
        cpu.pc = goal
    else:
        cpu.cycles = f.not_taken


def B_off16_COND(cpu: Cpu, f: Operation) -> None:
    _branch(cpu, f, cpu.condition(f.k))


def SB_off8_COND(cpu: Cpu, f: Operation) -> None:
    _branch(cpu, f, cpu.condition(f.k), 0x80)


def BANZ_off16_ARndec(cpu: Cpu, f: Operation) -> None:
    count = cpu.xar[f.n] & M16
    cpu.put_ar(f.n, count - 1)
    _branch(cpu, f, count != 0)


def BAR_off16_ARn_ARm_EQ(cpu: Cpu, f: Operation) -> None:
    _branch(cpu, f, (cpu.xar[f.n] ^ cpu.xar[f.m]) & M16 == 0)


def BAR_off16_ARn_ARm_NEQ(cpu: Cpu, f: Operation) -> None:
    _branch(cpu, f, (cpu.xar[f.n] ^ cpu.xar[f.m]) & M16 != 0)


def _goal(cpu: Cpu, f: Operation) -> int:
    """Return the address in field c or, if the form has no field c, the address in XARn."""
    return f.c if f.c >= 0 else cpu.xar[f.n] & CODE


def LB_22(cpu: Cpu, f: Operation) -> None:
    cpu.pc = _goal(cpu, f)


# Calls --------------------------------------------------------------------------------------------------------------


def LCR_22(cpu: Cpu, f: Operation) -> None:
    cpu.push_pair(cpu.rpc & M16, cpu.rpc >> 16)
    cpu.rpc, cpu.pc = f.next, _goal(cpu, f)


def LRETR(cpu: Cpu, f: Operation) -> None:
    cpu.pc = cpu.rpc
    cpu.rpc = cpu.pop_pair() & CODE


def LC_22(cpu: Cpu, f: Operation) -> None:
    cpu.push_pair(f.next & M16, f.next >> 16)
    cpu.pc = _goal(cpu, f)


def LRET(cpu: Cpu, f: Operation) -> None:
    cpu.pc = cpu.pop_pair() & CODE


def LRETE(cpu: Cpu, f: Operation) -> None:
    LRET(cpu, f)
    cpu.change_st1(1, False)


def FFC_XARn_22(cpu: Cpu, f: Operation) -> None:
    cpu.xar[f.n], cpu.pc = f.next, f.c


# C2xLP --------------------------------------------------------------------------------------------------------------


def XB_indAL(cpu: Cpu, f: Operation) -> None:
    cpu.pc = PMA | cpu.ax(0)


def XB_pma_COND(cpu: Cpu, f: Operation) -> None:
    _jump(cpu, f, cpu.condition(f.k), PMA | f.c)


def XB_pma_ind_ARPn(cpu: Cpu, f: Operation) -> None:
    cpu.pc, cpu.arp = PMA | f.c, f.n


def XCALL_indAL(cpu: Cpu, f: Operation) -> None:
    cpu.push16(f.next & M16)
    cpu.pc = PMA | cpu.ax(0)


def XCALL_pma_ind_ARPn(cpu: Cpu, f: Operation) -> None:
    cpu.push16(f.next & M16)
    cpu.pc, cpu.arp = PMA | f.c, f.n


def XCALL_pma_COND(cpu: Cpu, f: Operation) -> None:
    taken = cpu.condition(f.k)
    if taken:
        cpu.push16(f.next & M16)
    _jump(cpu, f, taken, PMA | f.c)


def XRETC_COND(cpu: Cpu, f: Operation) -> None:
    if cpu.condition(f.k):
        cpu.pc = PMA | cpu.pop16()
    else:
        cpu.cycles = f.not_taken


def XBANZ_pma_ind(cpu: Cpu, f: Operation) -> None:
    """Branch if AR(ARP) is not 0. Then step XAR(ARP), with the mode in b, and set ARP if the form has field n."""
    taken = cpu.xar[cpu.arp] & M16 != 0
    cpu.xar[cpu.arp] = cpu.xar[cpu.arp] + cpu.step_of(f.b, 1) & M32
    if f.n >= 0:
        cpu.arp = f.n
    _jump(cpu, f, taken, PMA | f.c)


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
