"""Tables of PIE registers, vectors and line names.

Source: SPRUFB0D section 8, Tables 111 to 117. The PIE control registers are not EALLOW-protected (Table 94); the vector
table is protected (Table 86).
"""

from __future__ import annotations

from ...core.registers import Register, RegisterMap, Tie, field

BASE = 0x0CE0
GROUPS = 12

PIECTRL = Register(
    "PIECTRL",
    0x0,
    "SPRUFB0D Table 114",
    (
        field("PIEVECT", "15:1", "R", doc="address of the last vector fetched from the table, without its bit 0"),
        field("ENPIE", "0", doc="1: vectors come from the PIE's table, 0: from boot ROM"),
    ),
)
PIEACK = Register(
    "PIEACK",
    0x1,
    "SPRUFB0D Figure 85, Table 115",
    (field("PIEACK", "11:0", "R/W1C", 0xFFF, doc="bit x - 1: group x has interrupted and waits for an acknowledge"),),
)


def _pieier(group: int) -> Register:
    bits = tuple(field(f"INTx{y}", f"{y - 1}", doc=f"1: line {y} may interrupt") for y in range(8, 0, -1))
    return Register(f"PIEIER{group}", 2 * group, "SPRUFB0D section 8.5.2", bits)


def _pieifr(group: int) -> Register:
    bits = tuple(field(f"INTx{y}", f"{y - 1}", doc=f"1: line {y} pending", tie=Tie.HARDWARE) for y in range(8, 0, -1))
    return Register(f"PIEIFR{group}", 2 * group + 1, "SPRUFB0D Table 116", bits, read_acts=True)


PIEIER: tuple[Register, ...] = tuple(_pieier(group) for group in range(1, GROUPS + 1))
PIEIFR: tuple[Register, ...] = tuple(_pieifr(group) for group in range(1, GROUPS + 1))

MAP = RegisterMap("PIE", "SPRUFB0D section 8", (PIECTRL, PIEACK, *PIEIER, *PIEIFR))

VECTOR_TABLE = range(0x0D00, 0x0E00)  # addresses of the vectors; they are EALLOW-protected
BOOT_ROM_VECTORS = 0x3FFFC0

# Group and line of every interrupt that the PIE multiplexes (Table 111).
LINES: dict[str, tuple[int, int]] = {
    "SEQ1INT": (1, 1),
    "SEQ2INT": (1, 2),
    "XINT1": (1, 4),
    "XINT2": (1, 5),
    "ADCINT": (1, 6),
    "TINT0": (1, 7),
    "WAKEINT": (1, 8),
    **{f"EPWM{n}_TZINT": (2, n) for n in range(1, 7)},
    **{f"EPWM{n}_INT": (3, n) for n in range(1, 7)},
    **{f"ECAP{n}_INT": (4, n) for n in range(1, 7)},
    "EQEP1_INT": (5, 1),
    "EQEP2_INT": (5, 2),
    "SPIRXINTA": (6, 1),
    "SPITXINTA": (6, 2),
    "MRINTB": (6, 3),
    "MXINTB": (6, 4),
    "MRINTA": (6, 5),
    "MXINTA": (6, 6),
    **{f"DINTCH{n}": (7, n) for n in range(1, 7)},
    "I2CINT1A": (8, 1),
    "I2CINT2A": (8, 2),
    "SCIRXINTC": (8, 5),
    "SCITXINTC": (8, 6),
    "SCIRXINTA": (9, 1),
    "SCITXINTA": (9, 2),
    "SCIRXINTB": (9, 3),
    "SCITXINTB": (9, 4),
    "ECAN0INTA": (9, 5),
    "ECAN1INTA": (9, 6),
    "ECAN0INTB": (9, 7),
    "ECAN1INTB": (9, 8),
    "XINT3": (12, 1),
    "XINT4": (12, 2),
    "XINT5": (12, 3),
    "XINT6": (12, 4),
    "XINT7": (12, 5),
    "LVF": (12, 7),
    "LUF": (12, 8),
}

# Vector numbers of interrupts without a group (Table 112). 1 to 12 belong to the groups.
CPU_VECTORS: dict[str, int] = {
    "RESET": 0,
    "INT13": 13,
    "INT14": 14,
    "DATALOG": 15,
    "RTOSINT": 16,
    "EMUINT": 17,
    "NMI": 18,
    "ILLEGAL": 19,
    **{f"USER{n}": 19 + n for n in range(1, 13)},
}


def line_vector(group: int, line: int) -> int:
    """Return the address of a line's vector in the PIE's table. group: 1 to 12. line: 1 to 8."""
    return 0x0D40 + 16 * (group - 1) + 2 * (line - 1)


def vector_address(number: int) -> int:
    """Return the address of vector 0 to 31. Vector 0, for reset, is in boot ROM, the others are in the PIE's table."""
    return VECTOR_TABLE.start + 2 * number if number else BOOT_ROM_VECTORS


# For the name of each interrupt, the address of its vector.
VECTORS: dict[str, int] = {
    **{name: vector_address(number) for name, number in CPU_VECTORS.items()},
    **{name: line_vector(group, line) for name, (group, line) in LINES.items()},
}
