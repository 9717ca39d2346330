"""Forms that the table describes in prose: shifts, compares, branches, the stack, repeats and division; and cycles."""

from __future__ import annotations

import itertools
import random
from typing import NamedTuple

import pytest

from periph_sim.processor.c28x.encodings import Encoding, encodings
from periph_sim.processor.c28x.execution.registers import IllegalOperation
from tests.processor.c28x.execution.flat import Flat, loaded, ran

DRAW = random.Random(13)
WORDS32 = [0, 1, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF, *(DRAW.getrandbits(32) for _ in range(8))]
WORDS16 = [0, 1, 0x7FFF, 0x8000, 0xFFFF, *(DRAW.getrandbits(16) for _ in range(4))]


def signed(value: int, bits: int) -> int:
    return value - (1 << bits) if value >> bits - 1 else value


class Shift(NamedTuple):
    """A shift.

    kind: L is left, A arithmetic right, R logical right, S right as SXM says.
    mask: the bits of T that hold the count; 0 if the source states the count.
    """

    source: str
    bits: int
    kind: str
    mask: int = 0


WIDE_SHIFTS = (("LSL64", "L"), ("LSR64", "R"), ("ASR64", "A"))
SHIFTS = [
    *(Shift(f"LSL ACC,#{n}", 32, "L") for n in (1, 16)),
    *(Shift(f"SFR ACC,#{n}", 32, "S") for n in (1, 16)),
    Shift("LSL ACC,T", 32, "L", 15),
    Shift("LSLL ACC,T", 32, "L", 31),
    Shift("SFR ACC,T", 32, "S", 15),
    Shift("ASRL ACC,T", 32, "A", 31),
    Shift("LSRL ACC,T", 32, "R", 31),
    *(Shift(f"{name} ACC:P,#{n}", 64, kind) for name, kind in WIDE_SHIFTS for n in (1, 16)),
    *(Shift(f"{name} ACC:P,T", 64, kind, 63) for name, kind in WIDE_SHIFTS),
    *(Shift(f"{name} AH,#{n}", 16, kind) for name, kind in (("LSL", "L"), ("LSR", "R"), ("ASR", "A")) for n in (1, 16)),
    *(Shift(f"{name} AH,T", 16, kind, 15) for name, kind in (("LSL", "L"), ("LSR", "R"), ("ASR", "A"))),
]  # fmt: skip


@pytest.mark.parametrize("shift", SHIFTS, ids=[shift.source for shift in SHIFTS])
@pytest.mark.parametrize("sxm", [0, 1])
def test_shifts(shift: Shift, sxm: int):
    for acc in WORDS32:
        t = DRAW.choice((0, 1, 15, 31, 63, DRAW.getrandbits(16)))
        cpu, _ = ran(shift.source, acc=acc, p=0x8765_4321, xt=t << 16, sxm=sxm)
        value = {16: acc >> 16, 32: acc, 64: acc << 32 | 0x8765_4321}[shift.bits]
        count = t & shift.mask if shift.mask else int(shift.source.rpartition("#")[2])
        arithmetic = shift.kind == "A" or (shift.kind == "S" and sxm)
        wide = signed(value, shift.bits) if arithmetic else value
        expected = (wide << count if shift.kind == "L" else wide >> count) & (1 << shift.bits) - 1
        last = wide >> shift.bits - count if shift.kind == "L" else wide >> count - 1 if count else 0
        seen = {16: cpu.acc >> 16, 32: cpu.acc, 64: cpu.acc_p() & (1 << 64) - 1}[shift.bits]
        assert (seen, cpu.c) == (expected, last & 1 if count else 0), (acc, t)
        assert (cpu.n, cpu.z) == (expected >> shift.bits - 1, int(expected == 0))


@pytest.mark.parametrize(
    ("source", "bits"), [("CMPL ACC,@XT", 32), ("CMP AL,@T", 16), ("CMP @T,#0x8000", 16), ("CMPB AL,#255", 16)]
)
def test_compares_have_the_sign_of_the_exact_difference(source: str, bits: int):
    for a in WORDS32 if bits == 32 else WORDS16:
        for b in WORDS32 if bits == 32 else WORDS16:
            cpu, _ = ran(source, acc=a, xt=b if bits == 32 else b << 16)
            first, second = {"CMP @T,#0x8000": (b, 0x8000), "CMPB AL,#255": (a, 255)}.get(source, (a, b))
            exact = signed(first, bits) - signed(second, bits)
            assert (cpu.n, cpu.z, cpu.c) == (int(exact < 0), int(exact == 0), int(first >= second))
            assert cpu.acc == a


CONDITIONS = {
    "NEQ": lambda z, n, c, v, tc: not z, "EQ": lambda z, n, c, v, tc: z, "GT": lambda z, n, c, v, tc: not z and not n,
    "GEQ": lambda z, n, c, v, tc: not n, "LT": lambda z, n, c, v, tc: n, "LEQ": lambda z, n, c, v, tc: z or n,
    "HI": lambda z, n, c, v, tc: c and not z, "HIS": lambda z, n, c, v, tc: c, "LO": lambda z, n, c, v, tc: not c,
    "LOS": lambda z, n, c, v, tc: not c or z, "NOV": lambda z, n, c, v, tc: not v, "OV": lambda z, n, c, v, tc: v,
    "NTC": lambda z, n, c, v, tc: not tc, "TC": lambda z, n, c, v, tc: tc, "UNC": lambda z, n, c, v, tc: True,
}  # fmt: skip
COST = {"SB": (7, 4), "B": (7, 4), "BF": (4, 4)}  # cycles if taken, if not taken [SPRU430F]


@pytest.mark.parametrize("name", CONDITIONS)
@pytest.mark.parametrize("branch", COST)
def test_branches_by_all_conditions_and_their_cycles(branch: str, name: str):
    for bits in range(32):
        z, n, c, v, tc = (bits >> place & 1 for place in range(5))
        cpu = loaded(f"{branch} 0x8010,{name}")
        cpu.z, cpu.n, cpu.c, cpu.v, cpu.tc = z, n, c, v, tc
        cycles = cpu.step()
        taken = bool(CONDITIONS[name](z, n, c, v, tc))
        assert cpu.pc == (0x8010 if taken else 0x8000 + (1 if branch == "SB" else 2))
        assert cycles == (4 if (branch, name) == ("SB", "UNC") else COST[branch][0 if taken else 1])
        assert cpu.v == (0 if "OV" in name else v)


PAIRS = {
    "AR1:AR0": (0x1000_0001, 0x2000_0002), "AR1H:AR0H": (0x1000_0001, 0x2000_0002), "DP": 0x1C5, "P": 0x1234_5678,
    "ST0": 0, "T:ST0": 0, "RPC": 0x12_3456, "RB": 0x4000_0001, "XAR5": 0x1234_5678, "ACC": 0, "@AL": 0, "ST1": 0,
    "DP:ST1": 0x1C5, "AR3:AR2": 0, "AR5:AR4": 0, "DBGIER": 0, "IFR": 0, "XT": 5,
}  # fmt: skip


def state_of(cpu: Flat) -> list[object]:
    registers = [cpu.acc, cpu.p, cpu.xt, list(cpu.xar), cpu.dp, cpu.rpc, cpu.rb, cpu.st0(), cpu.whole_st1(), cpu.dbgier]
    return [*registers, cpu.ifr, cpu.sp]


@pytest.mark.parametrize("name", PAIRS)
def test_pop_restores_what_push_stored(name: str):
    cpu = loaded(f"PUSH {name}\nPOP {name}")
    cpu.acc, cpu.p, cpu.xt, cpu.xar = 0x8765_4321, 0x1234_5678, 0x0BAD_CAFE, [0x1111_1111 * n + n for n in range(8)]
    cpu.dp, cpu.rpc, cpu.rb, cpu.dbgier, cpu.ifr = 0x1C5, 0x12_3456, 0x4123_4567, 3, 5
    cpu.put_st0(0x5283)
    before = state_of(cpu)
    cpu.step()
    pushed = cpu.sp - 0x400
    stored = [cpu.memory[0x400 + at] for at in range(pushed)]
    cpu.acc ^= 0x5555 if name == "@AL" else 0
    cpu.step()
    if name in ("@AL", "ACC"):  # POP also sets N and Z
        assert (cpu.acc, cpu.n, cpu.z) == (0x8765_4321, int(name == "ACC"), 0)
        cpu.put_st0(0x5283)
    assert state_of(cpu) == before
    assert pushed == len(stored) == (1 if name in ("DP", "ST0", "ST1", "@AL", "DBGIER", "IFR") else 2)


def test_repeat_runs_once_more_than_its_count_and_costs_a_cycle_a_pass():
    cpu, cycles = ran("RPT #9\nNOP")
    assert cycles == 1 + 10
    cpu, cycles = ran("RPT @AL\nADDB ACC,#1", acc=3)  # ADDB is not repeatable, so it runs once
    assert (cpu.acc, cycles) == (4, 4 + 1)


@pytest.mark.parametrize("mnemonic", ["SETC", "CLRC"])
def test_setc_and_clrc_take_a_second_cycle_if_intm_or_dbgm_is_among_the_bits(mnemonic: str):
    """SPRU430F, SETC and CLRC mode: 1, 2. DINT is SETC INTM and EINT CLRC INTM."""
    names = ("SXM", "OVM", "TC", "C", "INTM", "DBGM", "VMAP")
    chosen = [mask for size in range(1, 8) for mask in itertools.combinations(names, size)]
    took = {mask: ran(f"{mnemonic} {','.join(mask)}")[1] for mask in chosen}
    assert took == {mask: 2 if "INTM" in mask or "DBGM" in mask else 1 for mask in chosen}


REPEATED = [row for row in encodings() if row.repeated and row.mnemonic not in ("IN", "OUT", "UOUT")]


@pytest.mark.parametrize("row", REPEATED, ids=[row.id for row in REPEATED])
@pytest.mark.parametrize("count", [0, 5])
def test_cycles_of_a_repeated_instruction_are_those_of_the_table(row: Encoding, count: int):
    """RPT #0 executes the instruction once, in N + k cycles with N = 0 [SPRU430F chapter 6, CYC; SPRUEO2A MACF32]."""
    pair = row.pair({name: 0x84 if name == "l" else 1 for name in row.fields})
    words = (pair >> 16, pair & 0xFFFF)[: row.words]
    cpu, at = loaded(f"RPT #{count}"), 0x8001
    for word in words:
        cpu.memory[at] = word
        at += 1
    cpu.step()
    took = cpu.step()
    while cpu.left:
        took += cpu.step()
    assert took == count + row.repeated


def test_repeated_program_reads_advance_a_copy_of_xar7():
    cpu = loaded("MOVL XAR7,#0x9000\nMOVL XAR6,#0xA000\nRPT #3\nPREAD *XAR6++,*XAR7\nESTOP0")
    cpu.memory |= {0x9000 + at: 10 + at for at in range(4)}
    cycles = 0
    while not cpu.stopped:
        cycles += cpu.step()
    assert [cpu.memory[0xA000 + at] for at in range(4)] == [10, 11, 12, 13]
    assert (cpu.xar[7], cpu.xar[6], cycles - 4) == (0x9000, 0xA004, 1 + 1 + 1 + 3 + 2)


def test_a_repeated_block_has_no_cost_at_its_end():
    cpu, cycles = ran("RPTB 0x800A,#4\n" + "ADDB ACC,#1\n" * 8)
    assert (cpu.acc, cycles, cpu.rb >> 30) == (5 * 8, 1 + 5 * 8, 0)


def test_division_by_repeated_conditional_subtraction():
    for _ in range(20):
        dividend, divisor = DRAW.getrandbits(16), DRAW.randrange(1, 1 << 15)
        cpu, _ = ran("RPT #15\nSUBCU ACC,@T", acc=dividend, xt=divisor << 16)
        assert divmod(dividend, divisor) == (cpu.acc & 0xFFFF, cpu.acc >> 16)
        dividend, divisor = DRAW.getrandbits(32), DRAW.randrange(1, 1 << 31)
        cpu, _ = ran("MOVB ACC,#0\nRPT #31\nSUBCUL ACC,@XT", p=dividend, xt=divisor)
        assert divmod(dividend, divisor) == (cpu.p, cpu.acc)


def test_norm_shifts_redundant_sign_bits_out_and_counts_them():
    for acc, count in ((1, 30), (0xFFFF_FFFF, 31), (0x4000_0000, 0), (0x0001_0000, 14)):
        cpu, _ = ran("RPT #31\nNORM ACC,XAR2++", acc=acc)
        assert (cpu.acc, cpu.xar[2], cpu.tc) == (acc << count & 0xFFFF_FFFF, count, 1)


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("ITRAP0", "illegal instruction"),
        ("ITRAP1", "erased flash"),
        ("SETC AMODE", "C2xLP"),
        ("SETC PAGE0", "C27x"),
        ("OUT *(5),@AL", "I/O space"),
        ("B 0x8000,NBIO", "NBIO"),
        ("DMOV @AL", "also writes the next address"),
    ],
)
def test_illegal_or_unmodelled_instructions_are_refused(source: str, sentence: str):
    with pytest.raises(IllegalOperation, match=sentence):
        loaded(source).step()
