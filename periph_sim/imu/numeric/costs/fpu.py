"""The FPU: costs of its instructions, and of software by fastRTS or the compiler's library.

Two-cycle instructions are counted with their delay slot, as in code that waits for each result. The figures of
fastRTS are from its guide V2.10, simulated; that build used the TMU option, which the F28335 lacks, but the same code.
"""

from __future__ import annotations

from . import Cost, Library, derived, exactly, guessed

FPU = "SPRUEO2A"
GUIDE = "FPU fastRTS guide V2.10, with call and return"
NONE = "no figure published; several hundred to over a thousand by experience"

INSTRUCTIONS: dict[str, Cost] = {
    "scaled": derived(4, 8, f"{FPU}: I16TOF32 and MPYF32, with the move from a CPU register"),
    "add": exactly(2, f"{FPU}: ADDF32"),
    "sub": exactly(2, f"{FPU}: SUBF32"),
    "mul": exactly(2, f"{FPU}: MPYF32"),
    "neg": exactly(1, f"{FPU}: NEGF32"),
    "select": derived(2, 9, f"{FPU}: CMPF32 and a conditional MOV32, or MOVST0 and a branch"),
    "clamp": exactly(2, f"{FPU}: MINF32, MAXF32"),
    "to integer, nearest": exactly(2, f"{FPU}: F32TOI16R"),
    "to integer, floor": derived(4, 9, f"{FPU}: F32TOI16 and a correction below zero"),
    "to integer, toward zero": exactly(2, f"{FPU}: F32TOI16"),
}

FASTRTS = Library(
    "FPU and fastRTS",
    "SPRUEO2A; C28x FPU fastRTS guide V2.10",
    {
        **INSTRUCTIONS,
        "div": exactly(25, GUIDE),
        "sqrt": exactly(29, GUIDE),
        "mag": derived(35, 35, "two MPYF32, ADDF32 and sqrt"),
        "sincos": exactly(44, f"{GUIDE}: sincosf"),
        "atan": exactly(49, GUIDE),
        "atan2": exactly(50, GUIDE),
    },
    rom={"sincos": 2, "atan": 3, "atan2": 3},  # a cycle for each number read from a table
)

RTS = Library(
    "the compiler's library",
    "SPRUEO2A; FPU fastRTS guide V2.10 for the division",
    {
        **INSTRUCTIONS,
        "div": exactly(222, "FPU fastRTS guide V2.10, example table: the standard routine"),
        "sincos": guessed(600, 2400, NONE),
        **{kind: guessed(300, 1200, NONE) for kind in ("sqrt", "mag", "atan", "atan2")},
    },
)
