"""Every form whose op is a formula, from random states and from the ends of each range, against a second reading."""

from __future__ import annotations

import random

import pytest

from periph_sim.processor.c28x.decoder import Instruction
from periph_sim.processor.c28x.encodings import Encoding, encodings
from periph_sim.processor.c28x.execution.operations import form_of, operation
from tests.processor.c28x.execution.flat import Flat
from tests.processor.c28x.execution.second_reading import Before, CannotRead, read

FORMS = [row for row in encodings() if not row.alias_of and row.kind in ("core", "c2xlp")]
DIRECT = 0x05
PAGE = 0x9000 >> 6
AT = PAGE << 6 | DIRECT
ENDS16 = (0, 1, 0x7FFF, 0x8000, 0xFFFF)
ENDS32 = (0, 1, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF)
RANDOM_STATES = 40


def readable(row: Encoding) -> bool:
    registers = {"PM": 0, "P": 0, "ACC": 0, "XT": 0, "SXM": 0, "OVM": 0, "C": 0, "V": 0, "OVC": 0, "DP": 0, "SP": 0}
    try:
        read(row.op, row.flags, Before({**registers, "XAR": [0] * 8}, 0, 16, dict.fromkeys(row.fields, 0)))
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


def seen(cpu: Flat, place: str, row: Encoding, values: dict[str, int], wide: bool) -> int:
    match place:
        case "AX":
            return cpu.acc >> 16 * values["x"] & 0xFFFF
        case "T":
            return cpu.xt >> 16
        case "TL":
            return cpu.xt & 0xFFFF
        case "PH":
            return cpu.p >> 16
        case "PL":
            return cpu.p & 0xFFFF
        case "AR6" | "AR7":
            return cpu.xar[int(place[-1])] & 0xFFFF
        case "XARn":
            return cpu.xar[values["n"]]
        case "ACC:P":
            return cpu.acc_p() & (1 << 64) - 1
        case "OVC":
            return cpu.ovc & 0x3F
        case "loc":
            return cpu.load32(AT) if wide else cpu.load16(AT)
    if place.startswith("XAR"):
        return cpu.xar[int(place[-1])]
    return int(getattr(cpu, place.lower()))


def test_how_many_forms_are_read_twice():
    """The rest is prose in the table: their tests are by hand."""
    assert len(READABLE) == 167


@pytest.mark.parametrize("row", READABLE, ids=[row.id for row in READABLE])
def test_both_readings_agree(row: Encoding):
    draw = random.Random(row.id)
    for _ in range(RANDOM_STATES):
        cpu = state(draw)
        values = {
            name: draw.randrange(place.mask + 1) if draw.random() < 0.6 else draw.choice((0, place.mask))
            for name, place in row.fields.items()
        }
        for name, least in row.at_least:
            values[name] = max(values[name], least)
        for name, most in row.at_most:
            values[name] = min(values[name], most)
        values["l"] = DIRECT
        pair = row.pair({name: number for name, number in values.items() if name in row.fields})
        f = operation(Instruction(0x8000, pair, row))
        loc = cpu.load32(AT) if f.wide else cpu.load16(AT)
        before = registers_of(cpu)
        expected = read(row.op, row.flags, Before(before, loc, 32 if f.wide else 16, values))
        cpu.pc = 0x8000
        cpu.begin(f)
        assert cpu.finish(f) == row.cycles
        told = f"{f.encoding.id} {values} {before} loc={loc:#x}"
        for place, value in expected.written.items():
            assert seen(cpu, place, row, values, f.wide) == value, f"{place}: {told}"
        after = registers_of(cpu)
        for flag, value in expected.flags.items():
            assert after[flag] == value, f"{flag}: {told}"
        written = {place.replace("AX", "ACC") for place in expected.written}
        written |= {{"T": "XT", "TL": "XT", "PH": "P", "PL": "P"}.get(place, place) for place in written}
        whole = {"XAR"} if any("AR" in place for place in written) else set()
        untouched = before.keys() - expected.flags.keys() - written - whole
        assert {name: after[name] for name in untouched} == {name: before[name] for name in untouched}, told


def test_every_form_has_a_function():
    for row in encodings():
        if not row.alias_of:
            assert form_of(row).encoding is row
