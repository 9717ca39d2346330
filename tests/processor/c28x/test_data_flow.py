"""`data_flow` agrees with what is executed: one register part or memory word is changed before an instruction.

    part --changed--> executed --> after

If the part is not a source, everything else must be equal afterwards; if it is one, only the results may differ.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import NamedTuple

from periph_sim.processor.c28x.data_flow import BITS, PARTS, XAR, data_flow
from periph_sim.processor.c28x.encodings import Encoding
from periph_sim.processor.c28x.execution.registers import IllegalOperation
from tests.processor.c28x.execution.random_instructions import AT, FORMS, Scattered, pair_of, stir

TRIES = 3
HALVES = {"acc": ("AL", "AH"), "p": ("PL", "PH"), "xt": ("TL", "T")}
FLAGS = {"N": "n", "Z": "z", "C": "c", "V": "v", "TC": "tc", "SXM": "sxm", "OVM": "ovm"}
FIELDS = {"OVC": ("ovc", range(-32, 32)), "PM": ("pm", range(8))}
STF = {"NF": (4, 8), "NI": (16, 32), "LVF": (1, 2), "TF": (64,), "RND32": (512,)}
Change = Callable[["Reading"], None]


class Reading(Scattered):
    """A CPU that remembers which words it has read."""

    def __init__(self) -> None:
        super().__init__()
        self.loads: set[int] = set()

    def load16(self, address: int) -> int:
        self.loads.add(address)
        return super().load16(address)


class Effect(NamedTuple):
    parts: dict[str, object]
    cycles: int
    stores: list[tuple[int, int]]
    loads: set[int]


def parts_of(cpu: Reading) -> dict[str, object]:
    found: dict[str, object] = {}
    for name, (low, high) in HALVES.items():
        found[low], found[high] = getattr(cpu, name) & 0xFFFF, getattr(cpu, name) >> 16
    for n in range(8):
        found |= {f"AR{n}": cpu.xar[n] & 0xFFFF, f"AR{n}H": cpu.xar[n] >> 16, f"R{n}H": cpu.r[n]}
    found |= {part: getattr(cpu, name) for part, name in FLAGS.items()}
    found |= {part: getattr(cpu, name) for part, (name, _) in FIELDS.items()}
    found |= {part: cpu.stf & sum(bits) for part, bits in STF.items()}
    found["SHADOW"] = (list(cpu.shadow_r), cpu.shadow_stf, cpu.stf >> 31)
    names = "sp dp rpc rb pc ier ifr dbgier dbgstat repeat left"
    found["SYSTEM"] = [cpu.whole_st1(), *(getattr(cpu, name) for name in names.split())]
    return found


def change(part: str, seed: int) -> Change:
    """Return a function that changes one part; equal seeds give equal changes."""

    def apply(cpu: Reading) -> None:
        draw = random.Random(seed)
        bits = draw.choice((1 << draw.randrange(16), 0xFFFF, 1 + draw.randrange(0xFFFF)))
        for name, halves in HALVES.items():
            if part in halves:
                setattr(cpu, name, getattr(cpu, name) ^ bits << 16 * halves.index(part))
        if part in FLAGS:
            setattr(cpu, FLAGS[part], 1 - getattr(cpu, FLAGS[part]))
        elif part in FIELDS:
            name, values = FIELDS[part]
            setattr(cpu, name, draw.choice([value for value in values if value != getattr(cpu, name)]))
        elif part in STF:
            cpu.stf ^= draw.choice((*STF[part], sum(STF[part])))
        elif part == "SHADOW":
            cpu.shadow_r = [cpu.shadow_r[0] ^ bits, *list(cpu.shadow_r)[1:]]
        elif part.startswith("AR"):
            n = int(part[2])
            cpu.put_xars({n: cpu.xar[n] ^ bits << 16 * part.endswith("H")})
        elif part[0] == "R":
            n = int(part[1])
            cpu.put_floats({n: cpu.r[n] ^ bits << draw.choice((0, 16))})

    return apply


def change_word(address: int, seed: int) -> Change:
    def apply(cpu: Reading) -> None:
        cpu.memory[address] = cpu.load16(address) ^ random.Random(seed).choice((1, 0x8000, 0xFFFF, 0xFF, 0xFF00))

    return apply


def executed(pair: int, seed: int, first: Change | None = None) -> Effect | None:
    """Return the effect of an instruction in a random state, or None if it is refused."""
    draw, cpu = random.Random(seed), Reading()
    stir(cpu, draw)
    cpu.arp, cpu.shadow_r = draw.randrange(8), [draw.getrandbits(32) for _ in range(8)]
    cpu.pc, cpu.memory[AT], cpu.memory[AT + 1] = AT, pair >> 16, pair & 0xFFFF
    if first is not None:
        first(cpu)
    cpu.loads.clear()
    try:
        cycles = cpu.step()
    except IllegalOperation:
        return None
    return Effect(parts_of(cpu), cycles, list(cpu.stores), cpu.loads - {AT, AT + 1})


def different(one: Effect, other: Effect) -> set[str]:
    """Return the parts that differ, with "decided" if cycles or the addresses of stores differ."""
    found = {part for part in PARTS if one.parts[part] != other.parts[part]}
    same = one.cycles == other.cycles and [at for at, _ in one.stores] == [at for at, _ in other.stores]
    return found if same else found | {"decided"}


def mistakes(row: Encoding, draw: random.Random) -> list[str]:
    pair, seed = pair_of(row, draw), draw.getrandbits(32)
    flow, before = data_flow(row, row.values(pair)), executed(pair, seed)
    if before is None:
        return []
    results = {part for part, bit in BITS.items() if (flow.replaces | flow.changes) & bit}
    found = []
    for address in before.loads:
        after = executed(pair, seed, change_word(address, draw.getrandbits(32)))
        if not flow.memory_decides and (after is None or not different(before, after) <= results):
            found.append(f"{row.id}: a word has another effect")
    for part, bit in BITS.items():
        if bit & (flow.pointers | flow.decides | BITS["SYSTEM"]):
            continue
        after = executed(pair, seed, change(part, draw.getrandbits(32)))
        changed = {"refused"} if after is None else different(before, after)
        if flow.sources & bit:
            if not changed <= results | {part}:
                found.append(f"{row.id}: {part} changes {changed - results}")
        elif changed - {part} or (after is not None and after.stores != before.stores):
            found.append(f"{row.id}: {part} is no source, but changes {changed}")
        elif flow.replaces & bit and part in changed:
            found.append(f"{row.id}: {part} is kept")
    return found


def test_each_part_affects_only_the_results_of_instructions_that_have_it_as_a_source():
    draw = random.Random(7)
    assert [one for row in FORMS for _ in range(TRIES) for one in mistakes(row, draw)] == []


def test_sources_and_results_of_some_instructions():
    flows = {row.id: row for row in FORMS}
    add = data_flow(flows["ADD_ACC_loc16"], {"l": 0xA9})
    assert (add.sources, add.pointers) == (sum(BITS[one] for one in ("AL", "AH", "SXM", "OVM")), 0)
    assert add.replaces == sum(BITS[one] for one in ("AL", "AH", "N", "Z", "C"))
    assert data_flow(flows["MOV_AX_loc16"], {"l": 0xC5, "x": 0}).pointers == XAR[5]
    branch = data_flow(flows["SB_off8_COND"], {"k": 13, "c": 2})
    assert (branch.decides, branch.sources) == (BITS["TC"], BITS["TC"])
    assert data_flow(flows["PREAD_loc16_indXAR7"], {"l": 0xA9}).pointers == XAR[7]
    assert data_flow(flows["RPT_loc16"], {"l": 0xA4}).decides == BITS["AR4"]
    assert data_flow(flows["RPT_loc16"], {"l": 0xC4}).memory_decides
