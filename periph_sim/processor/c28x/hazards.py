"""Registers that an instruction needs early or writes late, as two masks.

    needs   read, or written, in phase D2: XAR0 to XAR7 as bits 0 to 7, DP 8, SP 9; 10 for XAR(ARP)
    makes   written in phase E, three phases after D2

An instruction that needs a register still to be written waits: `pipeline` counts the cycles.

An instruction of several cycles does its last operation in the last of them (PUSH loc16 reads, then writes), with two
exceptions. A jump or call passes D2 once, in its first cycle; in the others the CPU fetches from the target
[SPRU430F 4.3.2], while the pushed words go on to W. And some instructions stay in D2 until they have left phase E or W
themselves, as their cycles show: NORM takes N + 4 for N + 1 passes, one per pass and the three phases from D2 to
E; POP DP:ST1 takes 5, D2 to W, since ST1 applies from the next instruction on; PWRITE takes N + 5, one per pass and the
four phases to W. After these nothing waits.
Source: SPRU430F 4.4.2, 5.x; TI wiki "C28x Pipeline Conflicts"; the columns `reads` and `writes` of `encodings.toml`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache

from .encodings import Encoding
from .operand_field import SP_FIELD

DP, SP, BY_ARP = 1 << 8, 1 << 9, 1 << 10
REGISTERS = 0x3FF  # without XAR(ARP)
NUMBERED = re.compile(r"X?AR([0-7])$")
FIELDS = {"ARn": "n", "XARn": "n", "ARm": "m"}
HELD = frozenset(["NORM", "PWRITE"])  # mnemonics; and POP of ST1
BY_ARP_FROM, PUSHES, POPS, CIRCULAR = 0xAE, 0xBD, 0xBE, 0xBF


@cache
def hazards(encoding: Encoding, field: int, n: int, m: int) -> tuple[int, int]:
    """Return (needs, makes) for the values of fields l, n and m, -1 if absent."""
    numbers = {"n": n, "m": m}
    needs = _in_phase("D2", (*encoding.reads, *encoding.writes), numbers)
    makes = 0 if is_held(encoding) else _in_phase("E", encoding.writes, numbers)
    if field >= 0:
        needs |= addressing(field)
        register = _register(field)
        if "r" in encoding.accesses:
            needs |= register
        if "w" in encoding.accesses:
            makes |= register
    return needs, makes & REGISTERS


def is_held(encoding: Encoding) -> bool:
    """Return True if it stays in D2 until its writes are done."""
    return encoding.mnemonic in HELD or (encoding.mnemonic == "POP" and "ST1@D2" in encoding.writes)


def writes_at_once(encoding: Encoding) -> bool:
    """Return True if its memory write leaves D2 in the first of its cycles."""
    return "PC" in encoding.writes or is_held(encoding)


def _in_phase(phase: str, places: Iterable[str], numbers: Mapping[str, int]) -> int:
    """Return the registers used in a phase, from places of the table."""
    mask = 0
    for place in places:
        name, _, when = place.partition("@")
        if when != phase:
            continue
        numbered = NUMBERED.match(name)
        if numbered:
            mask |= 1 << int(numbered[1])
        elif name in FIELDS:
            mask |= 1 << numbers[FIELDS[name]]
        elif name in ("XAR[ARP]", "AR[ARP]"):
            mask |= BY_ARP
        elif name in ("DP", "SP"):
            mask |= DP if name == "DP" else SP
    return mask


def addressing(field: int) -> int:
    """Return the registers that an operand's address depends on [SPRU430F Table 5-1]."""
    if field < 0x40:
        return DP
    if field < 0x80 or field in (PUSHES, POPS):
        return SP
    if field >= 0xC0 or 0x80 <= field < 0x90:
        return 1 << (field & 7)
    if field < 0xA0:
        return 1 << (field & 7) | 1 << (field >> 3 & 1)  # AR0 or AR1 as index
    if field < BY_ARP_FROM:
        return 0
    if field == CIRCULAR:
        return 1 << 6 | 1 << 1
    return BY_ARP | (1 if field in (0xAE, 0xAF, 0xBB, 0xBC) else 0)


def _register(field: int) -> int:
    """Return the register that a field names, if it is an XAR or SP."""
    if 0xA0 <= field < 0xA8:
        return 1 << (field & 7)
    return SP if field == SP_FIELD else 0
