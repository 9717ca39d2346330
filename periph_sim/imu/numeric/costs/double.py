"""float64 in software ("long double" of the C28x compiler): without published figures, so all are guesses.

Each operation is a call that unpacks, computes on 53 bits with 32-bit instructions, normalises and packs. The ranges
are wide on purpose: they show the order of magnitude compared with the others, and are not for planning.
"""

from __future__ import annotations

from . import OPERANDS, Library, guessed

GUESS = "a guess: no figure published for 64-bit software floating point on the C28x"
SIMPLE = {
    "neg": (2, 10),
    "select": (40, 120),
    "clamp": (80, 240),
    "add": (80, 250),
    "sub": (80, 250),
    "mul": (100, 350),
}
LONG = {"div": (500, 2000), "sqrt": (500, 3000), "sincos": (3000, 16000)}
LONGEST = (1500, 8000)

RANGES = {**{kind: (60, 300) for kind in OPERANDS if "integer" in kind or kind == "scaled"}, **SIMPLE, **LONG}

DOUBLE = Library(
    "float64 in software",
    GUESS,
    {kind: guessed(*RANGES.get(kind, LONGEST), GUESS) for kind in OPERANDS},
)
