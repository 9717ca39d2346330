"""Every form whose op is a formula gives the results of a second, independent implementation.

States are random or at the ends of each range. The columns `op` and `flags` of encodings.toml are evaluated with
unbounded integers, without the product's functions that execute them:

    "ACC += x16(loc) << s"  +  "N Z C V OVC"  +  state before  ->  registers, operand and flags after

Forms whose op is prose cannot be evaluated; test_by_hand.py and test_by_table.py test them.
"""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import pytest

from periph_sim.processor.c28x.decoder import Instruction
from periph_sim.processor.c28x.encodings import Encoding, encodings
from periph_sim.processor.c28x.execution.operations import form_of, operation
from tests.processor.c28x.execution.flat import Flat

STATEMENT = re.compile(r"(ACC:P|ACC|AX|P|PH|PL|T|TL|XT|XAR\d|XARn|AR6|AR7|loc|DP|SP|PM|OVC) (=|\+=|-=|&=|\|=|\^=) (.+)")
DIFFERENCE = re.compile(r"(ACC|AX) - (loc|u\(loc\))( - !C)?")  # subtractions that are not written as -=
WIDTH = {"ACC": 32, "P": 32, "XT": 32, "loc": 0, "AX": 16, "T": 16, "PH": 16, "PL": 16, "TL": 16, "ACC:P": 64}
WIDTH |= {"AR6": 16, "AR7": 16, "DP": 16, "SP": 16, "PM": 3, "OVC": 6, "XARn": 32} | {f"XAR{n}": 32 for n in range(8)}
FLAGGED = ("ACC:P", "ACC", "AX", "loc", "P")  # if several of them are written, N and Z describe the first of these


class Before(NamedTuple):
    """The state before an instruction.

    registers: ACC to SXM.
    loc: the operand, of `bits` bits.
    values: the fields of the form.
    """

    registers: Mapping[str, int]
    loc: int
    bits: int
    values: Mapping[str, int]


class CannotRead(Exception):
    """The op is prose."""


def signed(value: int, bits: int) -> int:
    value &= (1 << bits) - 1
    return value - (1 << bits) if value >> bits - 1 else value


def names(before: Before) -> dict[str, object]:
    """Return the numbers and functions that an op may use, by name."""
    r, values = before.registers, before.values
    p_shift = r["PM"]
    p = signed(r["P"], 32)
    x = values.get("x", 0)
    c = values.get("c", 0)
    return {
        **r,
        "loc": before.loc,
        "s_field": values.get("s", 0),
        "AX": r["ACC"] >> 16 * x & 0xFFFF,
        "T": r["XT"] >> 16,
        "Psh": (p << 1 if p_shift == 0 else p >> p_shift - 1) & 0xFFFFFFFF,
        "imm16": c, "uimm16": c, "uimm8": c, "uimm7": c, "uimm10": c, "uimm22": c,
        "simm16": signed(c, 16), "simm8": signed(c, 8),
        "ARn": r["XAR"][values.get("n", 0)] & 0xFFFF if "n" in values else 0,
        "XARn": r["XAR"][values.get("n", 0)] if "n" in values else 0,
        **{f"XAR{n}": r["XAR"][n] for n in range(8)},
        **{f"AR{n}": r["XAR"][n] & 0xFFFF for n in range(8)},
        "PH": r["P"] >> 16, "PL": r["P"] & 0xFFFF, "TL": r["XT"] & 0xFFFF,
        "x16": lambda v: (signed(v, 16) if r["SXM"] else v & 0xFFFF),
        "s": lambda v: signed(v, 16), "u": lambda v: v,
        "s32": lambda v: signed(v, 16), "s64": lambda v: signed(v, 32), "u64": lambda v: v,
        "low16": lambda v: v & 0xFFFF, "high16": lambda v: v >> 16 & 0xFFFF,
        "low32": lambda v: v & 0xFFFFFFFF, "high32": lambda v: v >> 32 & 0xFFFFFFFF,
        "PMlow": lambda t: (t << 1 if p_shift == 0 else (t & (1 << 38) - 1) >> p_shift - 1) & 0xFFFFFFFF,
        "NC": 1 - r["C"], "ACCP": r["ACC"] << 32 | r["P"],
    }  # fmt: skip


def python_of(expression: str) -> str:
    text = re.sub(r"\bT\((\d+):0\)", lambda found: f"(T & {(1 << int(found[1]) + 1) - 1})", expression)
    text = re.sub(r"\bAX\(2:0\)", "(AX & 7)", text)
    text = re.sub(r"\bloc\(15:10\)", "(loc >> 10)", text)
    text = re.sub(r"\bloc\(5:0\)", "(loc & 63)", text)
    text = text.replace("!C", "NC").replace("ACC:P", "ACCP")
    text = re.sub(r"<< \(?s\+1\)?", "<< (s_field+1)", text)
    text = re.sub(r"<< s\b", "<< s_field", text)
    if not re.fullmatch(r"[\w\s+\-*&|^~<>()]+", text) or not set(re.findall(r"[A-Za-z]\w*", text)) <= KNOWN:
        raise CannotRead(expression)
    return text


ZEROS: Mapping[str, Any] = {
    **dict.fromkeys(("PM", "P", "ACC", "XT", "SXM", "OVM", "C", "V", "OVC", "DP", "SP"), 0), "XAR": [0] * 8
}  # fmt: skip
KNOWN = set(names(Before(ZEROS, 0, 16, {"n": 0})))


class After(NamedTuple):
    """The state after an instruction: the value of each written place, and of each flag that the form writes."""

    written: dict[str, int]
    flags: dict[str, int]


def read(op: str, flags: str, before: Before) -> After:
    """Evaluate a form. Raise CannotRead if its op is prose."""
    statements = [re.sub(r" \((carry|borrow)[^)]*\)", "", part.strip()) for part in op.split(";")]
    statements = [part for part in statements if not re.fullmatch(r"OVCU [+-]= (carry|borrow)", part)]
    parsed = [STATEMENT.fullmatch(part.partition(", ")[0]) for part in statements]
    if not all(parsed):
        raise CannotRead(op)
    state = names(before)
    result = After({}, {})
    exact: dict[str, tuple[int, int]] = {}
    for found in parsed:
        assert found is not None
        goal, how, expression = found.groups()
        own = state["ACCP" if goal == "ACC:P" else goal]
        assert isinstance(own, int)
        width = WIDTH[goal] or before.bits
        sides = DIFFERENCE.fullmatch(expression)
        if how in ("+=", "-="):
            adds, operand, third = how == "+=", expression.removesuffix(" + C"), "C" * expression.endswith(" + C")
        elif sides:
            adds, operand, third = False, sides[2], "NC" * bool(sides[3])
            own = evaluated(sides[1], state)
        else:
            value = evaluated(expression, state)
        if how in ("+=", "-=") or sides:
            sum_of = own, evaluated(operand, state), evaluated(third, state) if third else 0
            value = arithmetic(sum_of, adds, width, flags, before, result.flags)
        elif how != "=":
            value = {"&=": int.__and__, "|=": int.__or__, "^=": int.__xor__}[how](own, value)
        value &= (1 << width) - 1
        result.written[goal] = value
        state["ACCP" if goal == "ACC:P" else goal] = value
        exact[goal] = (value, width)
    flag_n_and_z(flags, exact, before, result.flags)
    return result


def evaluated(expression: str, state: dict[str, object]) -> int:
    value = eval(python_of(expression), {"__builtins__": {}}, state)
    assert isinstance(value, int)
    return value


def arithmetic(
    operands: tuple[int, int, int], adds: bool, width: int, flags: str, before: Before, into: dict[str, int]
) -> int:
    """Return a + b + carry, or a - b - borrow, and set its flags, with unbounded integers."""
    names_of = flags.split()
    ones = (1 << width) - 1
    a, b, third = operands
    sign = 1 if adds else -1
    unsigned = (a & ones) + sign * ((b & ones) + third)
    true = signed(a, width) + sign * (signed(b, width) + third)
    value = unsigned & ones
    carry = int(unsigned > ones) if adds else int(unsigned >= 0)
    if "C" in names_of:
        into["C"] = carry
    elif "C:set-only" in names_of:
        into["C"] = before.registers["C"] | carry
    elif "C:clear-only" in names_of:
        into["C"] = before.registers["C"] & carry
    overflow = true != signed(true, width)
    if "V" in names_of:
        into["V"] = before.registers["V"] | int(overflow)
    if "OVCU" in names_of:
        into["OVC"] = signed(before.registers["OVC"] + (carry if adds else carry - 1), 6)
    elif "OVC" in names_of and overflow:
        if before.registers["OVM"]:
            return ones >> 1 if true > 0 else (ones >> 1) + 1
        into["OVC"] = signed(before.registers["OVC"] + (1 if true > 0 else -1), 6)
    return value


def flag_n_and_z(flags: str, written: Mapping[str, tuple[int, int]], before: Before, into: dict[str, int]) -> None:
    names_of = flags.split()
    if "nz@AX" in names_of or "nz@ACC" in names_of:
        return  # the operand is memory here
    goal = next((name for name in FLAGGED if name in written), None)
    if goal is None:
        return
    value, width = written[goal]
    if "N" in names_of or "N=0" in names_of:
        into["N"] = value >> width - 1 if "N" in names_of else 0
    if "Z" in names_of or "Z=1" in names_of:
        into["Z"] = int(value == 0)


FORMS = [row for row in encodings() if not row.alias_of and row.kind in ("core", "c2xlp")]
DIRECT = 0x05
PAGE = 0x9000 >> 6
AT = PAGE << 6 | DIRECT
ENDS16 = (0, 1, 0x7FFF, 0x8000, 0xFFFF)
ENDS32 = (0, 1, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF)
RANDOM_STATES = 40


def readable(row: Encoding) -> bool:
    try:
        read(row.op, row.flags, Before(ZEROS, 0, 16, dict.fromkeys(row.fields, 0)))
    except CannotRead:
        return False
    return True


READABLE = [row for row in FORMS if readable(row)]


def number(draw: random.Random, ends: tuple[int, ...], bits: int) -> int:
    return draw.choice(ends) if draw.random() < 0.5 else draw.getrandbits(bits)


def state(draw: random.Random) -> Flat:
    cpu = Flat()
    cpu.acc, cpu.p, cpu.xt = (number(draw, ENDS32, 32) for _ in range(3))
    cpu.xar = [number(draw, ENDS32, 32) for _ in range(8)]
    cpu.sxm, cpu.ovm, cpu.tc, cpu.c, cpu.z, cpu.n, cpu.v = (draw.getrandbits(1) for _ in range(7))
    cpu.pm, cpu.ovc = draw.randrange(8), draw.randrange(-32, 32)
    cpu.dp, cpu.sp = PAGE, draw.randrange(0x400, 0x700)
    cpu.memory = {AT & ~1: number(draw, ENDS16, 16), AT | 1: number(draw, ENDS16, 16)}
    return cpu


def registers_of(cpu: Flat) -> dict[str, object]:
    return {
        "ACC": cpu.acc, "P": cpu.p, "XT": cpu.xt, "XAR": list(cpu.xar), "DP": cpu.dp, "SP": cpu.sp, "PM": cpu.pm,
        "OVC": cpu.ovc, "SXM": cpu.sxm, "OVM": cpu.ovm, "C": cpu.c, "V": cpu.v, "N": cpu.n, "Z": cpu.z, "TC": cpu.tc,
    }  # fmt: skip


def test_count_of_forms_that_are_compared():
    """All other forms are prose in the table; they are tested by hand."""
    assert len(READABLE) == 167


@pytest.mark.parametrize("row", READABLE, ids=[row.id for row in READABLE])
def test_both_implementations_agree(row: Encoding):
    draw = random.Random(row.id)
    for _ in range(RANDOM_STATES):
        cpu = state(draw)
        values = {
            name: draw.randrange(place.mask + 1) if draw.random() < 0.6 else draw.choice((0, place.mask))
            for name, place in row.fields.items()
        }
        for name, allowed in row.bounds.items():
            values[name] = min(max(values[name], allowed.start), allowed.stop - 1)
        values["l"] = DIRECT
        pair = row.pair({name: number for name, number in values.items() if name in row.fields})
        f = operation(Instruction(0x8000, pair, row))
        loc = cpu.load32(AT) if f.wide else cpu.load16(AT)
        before = registers_of(cpu)
        expected = read(row.op, row.flags, Before(before, loc, 32 if f.wide else 16, values))
        cpu.pc = 0x8000
        cpu.begin(f)
        assert cpu.finish(f) == row.cycles
        case = f"{f.encoding.id} {values} {before} loc={loc:#x}"
        after = registers_of(cpu)
        now = names(Before(after, cpu.load32(AT) if f.wide else cpu.load16(AT), 0, values))
        now["OVC"] = cpu.ovc & 0x3F
        for place, value in expected.written.items():
            assert now[{"ACC:P": "ACCP"}.get(place, place)] == value, f"{place}: {case}"
        for flag, value in expected.flags.items():
            assert after[flag] == value, f"{flag}: {case}"
        written = {place.replace("AX", "ACC") for place in expected.written}
        written |= {{"T": "XT", "TL": "XT", "PH": "P", "PL": "P"}.get(place, place) for place in written}
        whole = {"XAR"} if any("AR" in place for place in written) else set()
        untouched = before.keys() - expected.flags.keys() - written - whole
        assert {name: after[name] for name in untouched} == {name: before[name] for name in untouched}, case


def test_every_form_has_a_function():
    for row in encodings():
        if not row.alias_of:
            assert form_of(row).encoding is row
