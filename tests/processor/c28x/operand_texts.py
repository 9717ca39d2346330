"""Texts of operands, by the operand kinds of a syntax: a syntax goes in; lines of source that have that form come out.

    "MOVL loc32,ACC"  ->  "MOVL @XAR0,ACC", "MOVL *SP++,ACC", ...

Written from the manual's operand kinds [SPRU430F 5, 6; SPRUEO2A 2, 4], with no look at what the assembler takes.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence

MEMORY = [
    *("@0", "@0x3F", "@5", "*-SP[0]", "*-SP[1]", "*-SP[63]", "*SP++", "*--SP"),
    *("*", "*++", "*--", "*0++", "*0--", "*BR0++", "*BR0--", "*AR6%++"),
    *(text.format(n=n) for n in range(8) for text in ("*XAR{n}", "*XAR{n}++", "*--XAR{n}", "*,ARP{n}")),
    *(text.format(n=n) for n in range(8) for text in ("*+XAR{n}[AR0]", "*+XAR{n}[AR1]", "*+XAR{n}[0]", "*+XAR{n}[7]")),
]
NAMES16 = ["AL", "AH", "PL", "PH", "T", "SP", *(f"AR{n}" for n in range(8))]
NAMES32 = ["ACC", "P", "XT", *(f"XAR{n}" for n in range(8))]
WORDS = [*NAMES16, *(f"@{name}" for name in NAMES16)]
PAIRS = [*NAMES32, *(f"@{name}" for name in NAMES32)]
CONDITIONS = [
    "NEQ",
    "EQ",
    "GT",
    "GEQ",
    "LT",
    "LEQ",
    "HI",
    "HIS",
    "C",
    "LO",
    "NC",
    "LOS",
    "NOV",
    "OV",
    "NTC",
    "TC",
    "NBIO",
    "UNC",
]
FPU_CONDITIONS = ["NEQ", "EQ", "GT", "GEQ", "LT", "LEQ", "TF", "NTF", "LU", "LV", "UNC", "UNCF"]
REGISTERS = [str(n) for n in range(8)]


def numbers(least: int, most: int) -> list[str]:
    """A range, both ends and some between."""
    return [
        str(number) for number in sorted({least, least + 1, (least + most) // 2, most - 1, most}) if number >= least
    ]


def each(found: re.Match[str], prefix: str = "#") -> list[str]:
    return [f"{prefix}{number}" for number in range(int(found["least"]), int(found["most"]) + 1)]


def signed(bits: int) -> list[str]:
    return [f"#{text}" for text in numbers(-(1 << bits - 1), (1 << bits - 1) - 1)]


def unsigned(bits: int) -> list[str]:
    return [f"#{text}" for text in numbers(0, (1 << bits) - 1)]


KINDS: tuple[tuple[str, Callable[[re.Match[str], int], Sequence[str]]], ...] = (
    (r"loc16", lambda found, at: [*MEMORY, *WORDS]),
    (r"loc32", lambda found, at: [*MEMORY, *PAIRS]),
    (r"mem16|mem32", lambda found, at: MEMORY),
    (r"reg32", lambda found, at: PAIRS),
    (r"\{\*ind\}", lambda found, at: ["", *MEMORY]),
    (r"\{,CNDF\}", lambda found, at: ["", *(f",{name}" for name in FPU_CONDITIONS)]),
    (r"CNDF", lambda found, at: FPU_CONDITIONS),
    (r"COND", lambda found, at: CONDITIONS),
    (r"\bAX\b", lambda found, at: ["AL", "AH"]),
    (r"(?<=AR)[nm]\b|(?<=ARP)n\b|(?<=R)[a-f](?=H)|(?<=R)\(c\)(?=H)", lambda found, at: REGISTERS),
    (r"mode", lambda found, at: ["SXM", "INTM,DBGM", "SXM,OVM,TC,C,INTM,DBGM,PAGE0,VMAP", "0x10"]),
    (r"FLAG,VALUE", lambda found, at: ["RNDF32=1", "LVF=0,LUF=0,NF=1,ZF=1,NI=0,ZI=1,TF=0,RNDF32=1", "8=1"]),
    (r"\bFLAG\b", lambda found, at: ["NF,ZF", "LVF,LUF,NF,NI,ZF,ZI,TF", "0x14"]),
    (r"INTx", lambda found, at: [*(f"INT{n}" for n in range(1, 15)), "DLOGINT", "RTOSINT"]),
    (r"<<#0\.\.15", lambda found, at: ["", *(f"<<#{n}" for n in range(16))]),
    (r"<<#16", lambda found, at: ["<<#16"]),
    (r"#0\.0", lambda found, at: ["#0.0"]),
    (r"#16F(Hi|Lo)Hex", lambda found, at: unsigned(16)),
    (r"#16FHi", lambda found, at: ["#0x4020", "#2.5", "#-1.5", "#0.0", "#0x7F80", "#0xFFFF"]),
    (r"#bit", lambda found, at: [f"#{n}" for n in range(16)]),
    (r"#(?P<least>\d+)\.\.(?P<most>\d+)", lambda found, at: each(found)),
    (r"(?<=<<)(?P<least>\d)\.\.(?P<most>8)", lambda found, at: each(found, "")),
    (r"#16s", lambda found, at: signed(16)),
    (r"#8s", lambda found, at: signed(8)),
    (r"#16\b", lambda found, at: [*unsigned(16), *signed(16)]),
    (r"#RC", lambda found, at: unsigned(16)),
    (r"#(?P<bits>8|7|10|22)\b", lambda found, at: unsigned(int(found["bits"]))),
    (r"off8", lambda found, at: numbers(at - 128, at + 127)),
    (r"off16", lambda found, at: numbers(at - 32768, at + 32767)),
    (r"label", lambda found, at: numbers(at + 2, at + 2 + 127)),
    (r"\(0:16\)", lambda found, at: [f"(0:{text})" for text in numbers(0, 0xFFFF)]),
    (r"0:pma", lambda found, at: [f"0:{text}" for text in numbers(0, 0xFFFF)]),
    (r"\bPA\b", lambda found, at: numbers(0, 0xFFFF)),
    (r"\bpma\b", lambda found, at: numbers(0x3F_0000, 0x3F_FFFF)),
    (r"\bpm\b", lambda found, at: ["+1", "0", "-1", "-2", "-3", "-4", "-5", "-6"]),
)
KIND = re.compile("|".join(f"(?:{re.sub('[?]P<[a-z]+>', '?:', pattern)})" for pattern, _ in KINDS))


def lines(syntax: str, at: int) -> Iterator[str]:
    """Source of this form at an address: each text of each operand, beside the first and the last of the others."""
    mnemonic, _, rest = syntax.partition(" ")
    pieces: list[Sequence[str]] = []
    behind = 0
    for found in KIND.finditer(rest):
        pieces.append((rest[behind : found.start()],))
        pieces.append(texts(rest, found, at))
        behind = found.end()
    pieces.append((rest[behind:],))
    for place, piece in enumerate(pieces):
        for text in piece:
            for end in (0, -1):
                yield f"{mnemonic} " + "".join(
                    text if other == place else texts_of[end] for other, texts_of in enumerate(pieces)
                )


def texts(rest: str, found: re.Match[str], at: int) -> Sequence[str]:
    for pattern, make in KINDS:
        again = re.compile(pattern).match(rest, found.start())
        if again is not None and again.end() == found.end():
            return make(again, at)
    raise AssertionError(f"{found.group()} of {rest}")
