"""PUSH and POP, and stack pointer alignment.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
An instruction that pushes two registers, such as PUSH AR1:AR0, stores the second one, here AR0, at the lower address.
`PUSH_ARm_ARn` executes the forms for lower halves, with the number of the first pushed register in n.
POP ACC, PUSH XAR4 and similar instructions are aliases of moves. Source: SPRU430F chapter 6.
"""

# core: compiled

from __future__ import annotations

from .cpu import Cpu, Operation
from .registers import CODE, HIGH16, M16, SPA

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name


def PUSH_ARm_ARn(cpu: Cpu, f: Operation) -> None:
    cpu.push_pair(cpu.xar[f.n] & M16, cpu.xar[f.n + 1] & M16)


def PUSH_AR1H_AR0H(cpu: Cpu, f: Operation) -> None:
    cpu.push_pair(cpu.xar[0] >> 16, cpu.xar[1] >> 16)


def POP_ARm_ARn(cpu: Cpu, f: Operation) -> None:
    pair = cpu.pop_pair()
    cpu.put_ar(f.n, pair)
    cpu.put_ar(f.n + 1, pair >> 16)


def POP_AR1H_AR0H(cpu: Cpu, f: Operation) -> None:
    pair = cpu.pop_pair()
    cpu.xar[0] = cpu.xar[0] & M16 | (pair & M16) << 16
    cpu.xar[1] = cpu.xar[1] & M16 | pair & HIGH16


def PUSH_DBGIER(cpu: Cpu, f: Operation) -> None:
    cpu.push16(cpu.dbgier)


def POP_DBGIER(cpu: Cpu, f: Operation) -> None:
    cpu.dbgier = cpu.pop16()


def PUSH_DP(cpu: Cpu, f: Operation) -> None:
    cpu.push16(cpu.dp)


def POP_DP(cpu: Cpu, f: Operation) -> None:
    cpu.dp = cpu.pop16()


def PUSH_DP_ST1(cpu: Cpu, f: Operation) -> None:
    cpu.push_pair(cpu.whole_st1(), cpu.dp)


def POP_DP_ST1(cpu: Cpu, f: Operation) -> None:
    pair = cpu.pop_pair()
    cpu.dp = pair >> 16
    cpu.put_st1(pair & M16)


def PUSH_IFR(cpu: Cpu, f: Operation) -> None:
    cpu.push16(cpu.whole_ifr())


def POP_IFR(cpu: Cpu, f: Operation) -> None:
    cpu.put_ifr(cpu.pop16())


def PUSH_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.push16(cpu.read16())


def POP_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.pop16())


def PUSH_P(cpu: Cpu, f: Operation) -> None:
    cpu.push32(cpu.p)


def POP_P(cpu: Cpu, f: Operation) -> None:
    cpu.p = cpu.pop32()


def PUSH_RPC(cpu: Cpu, f: Operation) -> None:
    cpu.push32(cpu.rpc)


def POP_RPC(cpu: Cpu, f: Operation) -> None:
    cpu.rpc = cpu.pop32() & CODE


def PUSH_ST0(cpu: Cpu, f: Operation) -> None:
    cpu.push16(cpu.st0())


def POP_ST0(cpu: Cpu, f: Operation) -> None:
    cpu.put_st0(cpu.pop16())


def PUSH_ST1(cpu: Cpu, f: Operation) -> None:
    cpu.push16(cpu.whole_st1())


def POP_ST1(cpu: Cpu, f: Operation) -> None:
    cpu.put_st1(cpu.pop16())


def PUSH_T_ST0(cpu: Cpu, f: Operation) -> None:
    cpu.push_pair(cpu.st0(), cpu.t())


def POP_T_ST0(cpu: Cpu, f: Operation) -> None:
    pair = cpu.pop_pair()
    cpu.put_st0(pair & M16)
    cpu.put_t(pair >> 16)


def PUSH_RB(cpu: Cpu, f: Operation) -> None:
    cpu.push32(cpu.rb)


def POP_RB(cpu: Cpu, f: Operation) -> None:
    cpu.rb = cpu.pop32()


def ASP(cpu: Cpu, f: Operation) -> None:
    """Make SP even. Set SPA in ST1 if SP was odd, else clear SPA."""
    odd = cpu.sp & 1
    cpu.sp = cpu.sp + odd & M16
    cpu.change_st1(SPA, bool(odd))


def NASP(cpu: Cpu, f: Operation) -> None:
    if cpu.whole_st1() & SPA:
        cpu.sp = cpu.sp - 1 & M16
        cpu.change_st1(SPA, False)


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
