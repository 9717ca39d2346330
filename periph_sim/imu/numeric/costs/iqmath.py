"""IQmath on the C28x: published cycles of V1.4.1 and V1.70, and instruction counts for single instructions.

The additional cost of tables in ROM is the difference of the two figures in each source's comments (V1.4).
"""

from __future__ import annotations

from . import Library, derived, exactly

GUIDE = "IQmath guide V1.70, Q24, with LCR and LRETR"
ONE = "SPRU430E: one instruction"

IQMATH = Library(
    "IQmath",
    "IQmath module user's guide V1.4.1 and V1.70",
    {
        "scaled": exactly(7, f"{GUIDE}: IQmpyIQX"),
        "add": exactly(1, f"{ONE}, ADDL"),
        "sub": exactly(1, f"{ONE}, SUBL"),
        "neg": exactly(1, f"{ONE}, NEG"),
        "mul": exactly(6, f"{GUIDE}: IQmpy, in line"),
        "div": exactly(63, GUIDE),
        "sqrt": exactly(63, GUIDE),
        "mag": exactly(86, GUIDE),
        "sincos": exactly(46 + 44, f"{GUIDE}: IQsin, IQcos"),
        "atan": exactly(109, GUIDE),
        "atan2": exactly(109, GUIDE),
        "select": derived(3, 9, "CMPL, a conditional branch of 7 or 4, MOVL; or a conditional MOVL"),
        "clamp": exactly(7, f"{GUIDE}: IQsat"),
        "to integer, nearest": derived(2, 4, "ADDL, shift"),
        "to integer, floor": derived(1, 3, "shift"),
        "to integer, toward zero": exactly(14, f"{GUIDE}: IQint"),
    },
    rom={"sincos": 4, "atan": 6, "atan2": 6, "div": 8, "sqrt": 4, "mag": 4},
    with_operands=frozenset({"mul"}),
)

ROUNDED = Library(
    "IQmath, rounded products",
    IQMATH.source,
    {**IQMATH.costs, "mul": exactly(17, f"{GUIDE}: IQrmpy")},
    IQMATH.rom,
    IQMATH.with_operands,
)

SATURATED = Library(
    "IQmath, saturated products",
    IQMATH.source,
    {**IQMATH.costs, "mul": exactly(21, f"{GUIDE}: IQrsmpy")},
    IQMATH.rom,
    IQMATH.with_operands,
)
