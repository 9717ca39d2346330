"""Estimate of the cycles that a model takes, from the counts of its operations and the costs of a library.

    {"gyroscope": {"mul": 15, ...}, ...}, costs --> Estimate --> cycles in total and per part, rest of a measured time

The estimate includes the operations of the equations, and loads and stores of their operands. A load or store is
assumed to take one cycle per number, in memory without wait states; no number is assumed to stay in a register. The
estimate does not include the rest of the program, such as noise, conversions between blocks, function prologues and
interrupts.

A cost is a range. If there is a published figure, both ends of the range are this figure. Otherwise, the range is
derived from published figures of instructions, or it is a guess and marked as a guess. Figures are for code and data
in memory without wait states. The tables of a library may be in the boot ROM, which has one wait state; the additional
cost is listed separately.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from fractions import Fraction
from typing import Literal

from msgspec import Struct, field

Tables = Literal["RAM", "boot ROM"]

# For each operation, the number of its operands and results, each of which is loaded or stored.
OPERANDS = {
    "scaled": 2,
    "add": 3,
    "sub": 3,
    "mul": 3,
    "div": 3,
    "neg": 2,
    "sqrt": 2,
    "mag": 3,
    "sincos": 3,
    "atan": 2,
    "atan2": 3,
    "select": 5,
    "clamp": 4,
    "to integer, nearest": 2,
    "to integer, floor": 2,
    "to integer, toward zero": 2,
}


class Cost(Struct, frozen=True):
    """A cost in SYSCLKOUT cycles, from low to high.

    source: the document from which the cost is taken, or how it was derived.
    guessed: True if the cost is based on experience and not on a published figure.
    """

    low: int
    high: int
    source: str
    guessed: bool = False


def exactly(cycles: int, source: str) -> Cost:
    return Cost(cycles, cycles, source)


class Library(Struct, frozen=True):
    """The costs of the operations of a library.

    costs: the cost of each operation.
    rom: the additional cycles of each operation if the tables of the library are in the boot ROM. Operations without an
        entry have none.
    with_operands: the operations whose cost includes loads and stores.
    """

    name: str
    source: str
    costs: Mapping[str, Cost]
    rom: Mapping[str, int] = field(default_factory=dict)
    with_operands: frozenset[str] = frozenset()


FPU = "SPRUEO2A"
FASTRTS_GUIDE = "FPU fastRTS guide V2.10, with call and return"
NO_FIGURE = "no figure published; several hundred to over a thousand by experience"

INSTRUCTIONS: dict[str, Cost] = {
    "scaled": Cost(4, 8, f"{FPU}: I16TOF32 and MPYF32, with the move from a CPU register"),
    "add": exactly(2, f"{FPU}: ADDF32"),
    "sub": exactly(2, f"{FPU}: SUBF32"),
    "mul": exactly(2, f"{FPU}: MPYF32"),
    "neg": exactly(1, f"{FPU}: NEGF32"),
    "select": Cost(2, 9, f"{FPU}: CMPF32 and a conditional MOV32, or MOVST0 and a branch"),
    "clamp": exactly(2, f"{FPU}: MINF32, MAXF32"),
    "to integer, nearest": exactly(2, f"{FPU}: F32TOI16R"),
    "to integer, floor": Cost(4, 9, f"{FPU}: F32TOI16 and a correction below zero"),
    "to integer, toward zero": exactly(2, f"{FPU}: F32TOI16"),
}

FASTRTS = Library(
    "FPU and fastRTS",
    "SPRUEO2A; C28x FPU fastRTS guide V2.10",
    {
        **INSTRUCTIONS,
        "div": exactly(25, FASTRTS_GUIDE),
        "sqrt": exactly(29, FASTRTS_GUIDE),
        "mag": Cost(35, 35, "two MPYF32, ADDF32 and sqrt"),
        "sincos": exactly(44, f"{FASTRTS_GUIDE}: sincosf"),
        "atan": exactly(49, FASTRTS_GUIDE),
        "atan2": exactly(50, FASTRTS_GUIDE),
    },
    rom={"sincos": 2, "atan": 3, "atan2": 3},  # one cycle for each number that is read from a table
)

RTS = Library(
    "the compiler's library",
    "SPRUEO2A; FPU fastRTS guide V2.10 for the division",
    {
        **INSTRUCTIONS,
        "div": exactly(222, "FPU fastRTS guide V2.10, example table: the standard routine"),
        "sincos": Cost(600, 2400, NO_FIGURE, guessed=True),
        **{kind: Cost(300, 1200, NO_FIGURE, guessed=True) for kind in ("sqrt", "mag", "atan", "atan2")},
    },
)


IQMATH_GUIDE = "IQmath guide V1.70, Q24, with LCR and LRETR"
ONE_INSTRUCTION = "SPRU430E: one instruction"

IQMATH = Library(
    "IQmath",
    "IQmath module user's guide V1.4.1 and V1.70",
    {
        "scaled": exactly(7, f"{IQMATH_GUIDE}: IQmpyIQX"),
        "add": exactly(1, f"{ONE_INSTRUCTION}, ADDL"),
        "sub": exactly(1, f"{ONE_INSTRUCTION}, SUBL"),
        "neg": exactly(1, f"{ONE_INSTRUCTION}, NEG"),
        "mul": exactly(6, f"{IQMATH_GUIDE}: IQmpy, in line"),
        "div": exactly(63, IQMATH_GUIDE),
        "sqrt": exactly(63, IQMATH_GUIDE),
        "mag": exactly(86, IQMATH_GUIDE),
        "sincos": exactly(46 + 44, f"{IQMATH_GUIDE}: IQsin, IQcos"),
        "atan": exactly(109, IQMATH_GUIDE),
        "atan2": exactly(109, IQMATH_GUIDE),
        "select": Cost(3, 9, "CMPL, a conditional branch of 7 or 4, MOVL; or a conditional MOVL"),
        "clamp": exactly(7, f"{IQMATH_GUIDE}: IQsat"),
        "to integer, nearest": Cost(2, 4, "ADDL, shift"),
        "to integer, floor": Cost(1, 3, "shift"),
        "to integer, toward zero": exactly(14, f"{IQMATH_GUIDE}: IQint"),
    },
    rom={"sincos": 4, "atan": 6, "atan2": 6, "div": 8, "sqrt": 4, "mag": 4},
    with_operands=frozenset({"mul"}),
)

ROUNDED = Library(
    "IQmath, rounded products",
    IQMATH.source,
    {**IQMATH.costs, "mul": exactly(17, f"{IQMATH_GUIDE}: IQrmpy")},
    IQMATH.rom,
    IQMATH.with_operands,
)

SATURATED = Library(
    "IQmath, saturated products",
    IQMATH.source,
    {**IQMATH.costs, "mul": exactly(21, f"{IQMATH_GUIDE}: IQrsmpy")},
    IQMATH.rom,
    IQMATH.with_operands,
)


GUESS = "a guess: no figure published for 64-bit software floating point on the C28x"
RANGES = {  # the lowest and the highest cost of each operation of float64 in software, in cycles
    **dict.fromkeys(("scaled", *(kind for kind in OPERANDS if "integer" in kind)), (60, 300)),
    "neg": (2, 10),
    "select": (40, 120),
    "clamp": (80, 240),
    "add": (80, 250),
    "sub": (80, 250),
    "mul": (100, 350),
    "div": (500, 2000),
    "sqrt": (500, 3000),
    "sincos": (3000, 16000),
    **dict.fromkeys(("mag", "atan", "atan2"), (1500, 8000)),
}

DOUBLE = Library("float64 in software", GUESS, {kind: Cost(*RANGES[kind], GUESS, guessed=True) for kind in OPERANDS})


SYSCLK = 150_000_000  # SYSCLKOUT of the dissertation's board in Hz
# The time in seconds in which the dissertation's firmware computed the models once. Section 5.4 measured it on a GPIO
# pin, with code in RAM.
MEASURED = Fraction(250, 1_000_000)


class Estimate(Struct, frozen=True):
    """The estimated cycles of a model.

    tables: the memory that contains the tables of the library.
    parts: the cycles of each part of the model, as (low, high), by the name of the part.
    counts: the number of operations of each kind in all parts together.
    """

    library: Library
    tables: Tables
    parts: Mapping[str, tuple[int, int]]
    counts: Mapping[str, int]

    @property
    def low(self) -> int:
        """The cycles of all operations and their loads and stores, if each cost is at the lower end of its range."""
        return sum(low for low, _ in self.parts.values())

    @property
    def high(self) -> int:
        return sum(high for _, high in self.parts.values())

    @property
    def guessed(self) -> bool:
        """True if the cost of any operation in `counts` is a guess."""
        return any(self.library.costs[kind].guessed for kind in self.counts)

    def seconds(self) -> Fraction:
        """Return the estimated time in seconds, which is the middle of the range from `low` to `high`."""
        return Fraction(self.low + self.high, 2) / SYSCLK

    def left_of(self, measured: Fraction = MEASURED) -> tuple[int, int]:
        """Return the least and the most cycles of a measured time that the estimate does not explain.

        A number is negative if the estimate is longer than the measured time.

        measured: the measured time in seconds.
        """
        cycles = round(measured * SYSCLK)
        return cycles - self.high, cycles - self.low


def estimate(counts: Mapping[str, Mapping[str, int]], library: Library, tables: Tables = "RAM") -> Estimate:
    """Estimate the cycles of a model.

    counts: the number of operations of each kind, by the part of the model.
    tables: the memory that contains the tables of the library.
    """
    parts: dict[str, tuple[int, int]] = {}
    total: Counter[str] = Counter()
    for part, kinds in counts.items():
        low = high = 0
        for kind, count in sorted(kinds.items()):
            cost, operands = library.costs[kind], 0 if kind in library.with_operands else OPERANDS[kind]
            more = operands + (library.rom.get(kind, 0) if tables == "boot ROM" else 0)
            low, high = low + count * (cost.low + more), high + count * (cost.high + more)
            total[kind] += count
        parts[part] = low, high
    return Estimate(library, tables, parts, total)
