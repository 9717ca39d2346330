"""Cycles of each instruction of a function with their reasons, as text and as JSON.

Instructions are counted in the order of their addresses, as if no conditional branch were taken. The cycles of a taken
branch are only shown, in front of those that are counted. A stall is counted if an earlier instruction writes a
register or a word that the instruction needs. Stalls for words that are accessed through pointers, and wait states of
modules and memory, are not counted, because they are known only in a run.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ...core.phrases import did_you_mean
from ...core.text_table import paragraph, text_table
from ..c28x.decoder import UNC, Instruction, decode_at
from ..c28x.execution.operations import operation
from ..c28x.pipeline import DP, NAMES, POPS, PUSHES, SP, Pipeline, hazards, registers_in
from .debug_info import Function, FunctionMap
from .model import BadImage, Image

WAITED = range(0xC000, 0x1_0000)  # L4 to L7, where a fetch of 32 bits takes 2 cycles
OPEN = {"MOVL *SP++,ACC": "push_acc_cycles"}  # for an instruction, the option that determines its cycles
UNC_BRANCH = "B_off16_COND"


class Row(NamedTuple):
    """The cycles of one instruction.

    text: the instruction in assembler syntax.
    published: the cycles in the manual's table. "7/4" means 7 cycles if a branch is taken, 4 if it is not.
    stall: the additional cycles that the instruction waits in the pipeline.
    why: the reasons for the stall, the wait states of the fetch, and the option on which the cycles depend.
    line: the number of the source line; "" if it is unknown.
    """

    address: int
    text: str
    published: str
    stall: int
    why: str
    line: str


class FunctionCycles(NamedTuple):
    """Cycles of a function. least: the sum of the cycles of all rows if no conditional branch is taken."""

    function: Function
    rows: tuple[Row, ...]
    least: int


def function_cycles(image: Image, name: str) -> FunctionCycles:
    """Return the cycles of a function. Raise BadImage if no function has this name."""
    found = FunctionMap(image)
    functions = {function.name: function for function in found.functions}
    if name not in functions:
        raise BadImage(f"there is no function {name!r}; {did_you_mean(name, functions)}")
    function = functions[name]
    code = {section.run + offset: word for section in image.code for offset, word in enumerate(section.words)}
    pages = {DP: 0, SP: 0}  # number of changes of DP and SP; without a change, equal operands have equal addresses
    pipeline, rows, least = Pipeline(), [], 0
    address = function.address
    while address < function.address + function.size:
        first, second = code.get(address, 0), code.get(address + 1, 0)
        one = decode_at(address, first, second)
        if one is None:
            rows.append(Row(address, f".word {first:#06x}", "", 0, "not an instruction", ""))
            address += 1
            continue
        f = operation(one)
        f.needs, f.makes = hazards(one.encoding, f.l, f.n, f.m)
        pending = pipeline.pending
        registers = pipeline.stall(f, 0)
        unready = f.needs & (pending | pending >> 10 | pending >> 20)
        waited = " and ".join(name for bit, name in enumerate(NAMES) if unready >> bit & 1)
        why = [f"waits for {waited}"] if registers else []
        words = _word(one, f.wide, pages)
        late = pipeline.read(words[0], words[1]) if words and "r" in one.encoding.accesses else 0
        if late:
            why.append("reads what was just written")
        if words and "w" in one.encoding.accesses:
            pipeline.wrote(words[0], words[1], 1 if f.at_once else f.cycles)
        always = "k" in one.values and f.k == UNC
        taken = f.cycles
        cycles = taken if always else f.not_taken
        pipeline.issued(f, cycles)
        if address in WAITED:
            why.append("fetched with 1 wait state")
        option = "b_unc_cycles" if always and one.encoding.id == UNC_BRANCH else OPEN.get(one.text, "")
        if option:
            why.append(f"open: {option}")
        source = found.debug.line_at(address)
        published = str(cycles) if cycles == taken else f"{taken}/{cycles}"
        line = str(source.line) if source else ""
        rows.append(Row(address, one.text, published, registers + late, ", ".join(why), line))
        least += cycles + registers + late
        if not one.goes_on:
            pipeline.drain()
        for register in pages:
            pages[register] += (f.makes | _written(one)) & register > 0
        address += one.words
    return FunctionCycles(function, tuple(rows), least)


def _word(found: Instruction, wide: bool, pages: Mapping[int, int]) -> tuple[int, int] | None:
    """Return (key, number of words) of an operand that is addressed by DP or SP; None for other operands.

    Two operands with equal keys have equal addresses.

    wide: True if the operand has 32 bits.
    pages: for each of the masks DP and SP, the number of changes of this register so far.
    """
    field = found.values.get("l", 0xFF)
    if field >= 0x80:
        return None
    place = 0x40 - (field & 0x3F) if field >= 0x40 else field
    page = pages[SP if field >= 0x40 else DP] * 4 + (field >= 0x40)
    return page << 8 | place & ~int(wide), 1 + wide


def _written(found: Instruction) -> int:
    """Return the mask of those of the registers DP and SP that an instruction writes."""
    moved = SP if found.values.get("l") in (PUSHES, POPS) else 0
    return registers_in(found.encoding.writes, {"n": 0, "m": 0}) & (DP | SP) | moved


def cycles_text(found: FunctionCycles) -> str:
    """Return a table with one line for each instruction, and the total below it."""
    rows = [
        (f"{row.address:#08x}", row.text, row.published, str(row.stall or ""), row.why, row.line) for row in found.rows
    ]
    stalls = sum(row.stall for row in found.rows)
    return "\n".join(
        [
            *text_table(("address", "instruction", "cycles", "stall", "why", "line"), rows, right=(2, 3)),
            "",
            *paragraph(
                f"{found.function.name}: {found.least} cycles with no condition true, {stalls} of them stalls by rule. "
                "cycles: published, taken/not taken. Not included: wait states of registers, accesses through pointers."
            ),
        ]
    )


def cycles_as_json(found: FunctionCycles) -> dict[str, object]:
    """Return the cycles as a dictionary."""
    function = found.function
    rows = [row._asdict() for row in found.rows]
    return {"function": function.name, "address": function.address, "cycles": found.least, "rows": rows}
