"""The column `depends` of the table agrees with what is executed.

    state before --SXM = 0--> executed --> after   equal but for SXM itself, which is kept: SXM has no effect
                 --SXM = 1--> executed --> after

Status bits that the column omits have no effect on the instruction, and those that it names have one.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Mapping

from periph_sim.processor.c28x.decoder import decode
from periph_sim.processor.c28x.encodings import Encoding
from periph_sim.processor.c28x.execution.registers import IllegalOperation
from tests.processor.c28x.execution.random_instructions import AT, FORMS, Scattered, stir

TRIES = 12  # for bits that must have no effect
MOST_TRIES = 3000  # to find an effect of a named bit
DIRECT = 0x05  # an operand whose address does not depend on ARP and SP
REGISTERS = {"SXM": "sxm", "OVM": "ovm", "TC": "tc", "C": "c", "Z": "z", "N": "n", "V": "v"}
REGISTERS |= {"ARP": "arp", "PM": "pm", "OVC": "ovc"}
ST1_BITS = {"SPA": 4}
STF_BITS = {"ZF": 3, "NF": 2, "TF": 6, "LUF": 1, "LVF": 0, "RND32": 9}
STATUS = {*REGISTERS, *ST1_BITS, *STF_BITS}
VALUES = {"ARP": (1, 2), "PM": (0, 4), "OVC": (-3, 5)}  # two values of each; all other bits take 0 and 1
CONDITIONS = {"COND": {"N", "Z", "C", "V", "TC"}, "CNDF": {"ZF", "NF", "TF", "LUF", "LVF"}}
WHOLE = ("ST0", "ST1", "STF", "regs")  # status registers that are stored or loaded as a whole

State = Mapping[str, int]


def put(cpu: Scattered, name: str, value: int) -> None:
    if name in REGISTERS:
        setattr(cpu, REGISTERS[name], value)
    elif name in ST1_BITS:
        cpu.st1 = cpu.st1 & ~(1 << ST1_BITS[name]) | value << ST1_BITS[name]
    else:
        cpu.stf = cpu.stf & ~(1 << STF_BITS[name]) | value << STF_BITS[name]


def status(cpu: Scattered) -> State:
    return {
        **{name: getattr(cpu, where) for name, where in REGISTERS.items()},
        **{name: cpu.st1 >> bit & 1 for name, bit in ST1_BITS.items()},
        **{name: cpu.stf >> bit & 1 for name, bit in STF_BITS.items()},
    }


def executed(pair: int, seed: int, given: State) -> tuple[object, State, State] | None:
    """Execute one instruction; return its results and the status before and after it, or None if it is refused."""
    draw, cpu = random.Random(seed), Scattered()
    stir(cpu, draw)
    cpu.arp, cpu.sp = draw.randrange(8), draw.randrange(0x400, 0x7F00)
    for name, value in given.items():
        put(cpu, name, value)
    cpu.pc, cpu.memory[AT], cpu.memory[AT + 1] = AT, pair >> 16, pair & 0xFFFF
    before = status(cpu)
    try:
        taken = cpu.step()
    except IllegalOperation:
        return None
    left = (
        taken, cpu.acc, cpu.p, cpu.xt, list(cpu.xar), cpu.dp, cpu.sp, cpu.rpc, cpu.pc, list(cpu.r), cpu.ea, cpu.repeat,
        cpu.rb, list(cpu.stores),
    )  # fmt: skip
    return left, before, status(cpu)


def decide(row: Encoding, names: Collection[str], draw: random.Random) -> bool:
    """True if these status bits, set to one value or the other, make a difference from a random state."""
    pair = 0
    while decode(pair >> 16, pair & 0xFFFF) is not row:
        pair = row.value | draw.getrandbits(32) & ~row.mask
        if "l" in row.fields:
            place = row.fields["l"]
            pair = pair & ~(place.mask << place.shift) | DIRECT << place.shift
    seed = draw.getrandbits(32)
    one, other = (executed(pair, seed, {name: VALUES.get(name, (0, 1))[at] for name in names}) for at in (0, 1))
    if one is None or other is None:
        return one is not other
    alike = (  # equal, or changed by the same amount
        one[2][name] == other[2][name] or one[2][name] - one[1][name] == other[2][name] - other[1][name]
        for name in STATUS
    )
    return one[0] != other[0] or not all(alike)


def named(row: Encoding) -> set[str]:
    """Return the status that the row says it reads."""
    words = [*row.depends.split(), *(place.partition("@")[0] for place in row.reads)]
    return set().union(*(CONDITIONS.get(word, {word}) for word in words)) & STATUS


PLAIN = [row for row in FORMS if not {place.partition("@")[0] for place in (*row.reads, *row.writes)} & {*WHOLE}]


def test_status_that_is_not_named_has_no_effect():
    draw = random.Random(1)
    others = {row.id: sorted(STATUS - named(row)) for row in PLAIN}
    assert [row.id for row in PLAIN if any(decide(row, others[row.id], draw) for _ in range(TRIES))] == []


def test_status_that_is_named_has_an_effect():
    draw = random.Random(2)
    pairs = [(row, name) for row in PLAIN for name in sorted(named(row))]
    idle = [(row.id, name) for row, name in pairs if not any(decide(row, [name], draw) for _ in range(MOST_TRIES))]
    assert (idle, len(pairs) > 100) == ([], True)
