"""Run programs with words that are marked as data from the start, and return the marks at the end."""

from __future__ import annotations

import random
from typing import Any

from periph_sim.core.options import Value
from periph_sim.processor.c28x.data_flow import BITS
from periph_sim.processor.image.data_marks import DataMarks
from periph_sim.processor.image_files.model import Image, Section
from periph_sim.processor.user_code import FirmwareError
from tests.processor.image.rig import HEAD, Rig

DATA, OTHER, FREE = range(0x8200, 0x8210), range(0x8210, 0x8220), range(0x8220, 0x8300)
BEGIN = " MOVL XAR4,#0x8200\n MOVL XAR5,#0x8220\n"


def marked(source: str, *modules: str, frames: bool = False, **options: Value) -> tuple[DataMarks, Rig]:
    """Run a program in which the words of DATA are marked, and return the marks at its end and the unit.

    frames: True if a frame has begun before.
    """
    rig = Rig(HEAD + source + " ESTOP0", *modules, **options)
    for address in (*DATA, *OTHER):
        rig.cpu.fill(address, 0x1234)
    rig.cpu.marks = DataMarks(DATA)
    if frames:
        rig.cpu.marks.frame_begins()
    rig.run()
    assert rig.program.finished
    return rig.cpu.marks, rig


def words(marks: DataMarks) -> set[int]:
    return {address for address, mark in enumerate(marks.memory) if mark} - {*DATA}


def ran(code: list[int], values: list[int], seed: int) -> tuple[Rig, str]:
    """Run code on these values of DATA from random registers; return the unit and how the run ended."""
    rig = Rig(Image("assembled", 0x9000, (Section(".text", 0x9000, 0x9000, len(code), code, code=True),)))
    draw, cpu = random.Random(seed), rig.cpu
    for address in (*OTHER, *FREE, *range(0x400, 0x500), *range(0x4, 0x10)):
        cpu.fill(address, draw.getrandbits(16))
    for address, value in zip(DATA, values, strict=True):
        cpu.fill(address, value)
    cpu.acc, cpu.p, cpu.xt = (draw.getrandbits(32) for _ in range(3))
    cpu.put_st0(draw.getrandbits(16) & 0xFFFF)
    cpu.r = [draw.getrandbits(32) for _ in range(8)]
    cpu.xar = [draw.randrange(8), draw.randrange(8), 0x8212, 0x8218, 0x8200, 0x8240, 0x8260, 0x8280]
    cpu.dp, cpu.sp = 0x8240 >> 6, 0x440
    cpu.marks = DataMarks(DATA)
    try:
        rig.run(60_000)
    except FirmwareError as error:
        return rig, str(error).partition(", ACC=")[0]
    return rig, f"at {rig.program.returned_at}"


def known(rig: Rig) -> dict[Any, object]:
    """Return the words and parts of registers that have no mark, and the marks."""
    marks, cpu = rig.cpu.marks, rig.cpu
    assert marks is not None
    halves = {"acc": ("AL", "AH"), "p": ("PL", "PH"), "xt": ("TL", "T")}
    found: dict[Any, object] = {}
    for name, (low, high) in halves.items():
        found[low], found[high] = getattr(cpu, name) & 0xFFFF, getattr(cpu, name) >> 16
    for n in range(8):
        found |= {f"AR{n}": cpu.xar[n] & 0xFFFF, f"AR{n}H": cpu.xar[n] >> 16, f"R{n}H": cpu.r[n]}
    found |= {"N": cpu.n, "Z": cpu.z, "C": cpu.c, "V": cpu.v, "TC": cpu.tc, "OVC": cpu.ovc, "PM": cpu.pm}
    found = {part: value for part, value in found.items() if not marks.registers & BITS[part]}
    plain = (*range(0x800), *DATA, *OTHER, *FREE)
    memory = list(marks.memory)
    found |= {address: rig.word(address) for address in plain if not memory[address]}
    return found | {"sp": cpu.sp, "dp": cpu.dp, "st1": cpu.whole_st1(), "marks": (marks.registers, memory)}
