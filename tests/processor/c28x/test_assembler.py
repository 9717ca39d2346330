"""Every form is assembled, and decoded again by the decoder, which reads the same table.

The source lines of a form are generated from the manual's operand kinds [SPRU430F 5, 6; SPRUEO2A 2, 4], not from what
the assembler accepts: "MOVL loc32,ACC"  ->  "MOVL @XAR0,ACC", "MOVL *SP++,ACC", ...
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence

import pytest

from periph_sim.processor.c28x.assembler import evaluate, parse
from periph_sim.processor.c28x.decoder import decode_at
from periph_sim.processor.c28x.encodings import Encoding, encodings
from periph_sim.processor.c28x.operands import BadInstruction
from tests.processor.c28x.test_decoder import SHOWN

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
    """Return both ends of a range and some numbers between, as text."""
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
    """Yield source lines of a form: each text of each operand, combined with the first and the last of the others."""
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


AT = 0x8000
FORMS = [row for row in encodings() if not row.alias_of]


def words(source: str, at: int = AT, **symbols: int) -> tuple[int, ...]:
    return parse(source, at, symbols).words(at, symbols)


@pytest.mark.parametrize(("expected", "source"), SHOWN, ids=[text for _, text in SHOWN])
def test_words(expected: tuple[int, ...], source: str):
    assert words(source) == expected


@pytest.mark.parametrize("row", FORMS, ids=[row.id for row in FORMS])
def test_both_ends_of_every_field_are_decoded_and_assembled_again(row: Encoding):
    for end in (0, 1):
        assert_round_trip(row, row.pair({name: place.mask * end for name, place in row.fields.items()}))


def assert_round_trip(row: Encoding, pair: int) -> None:
    found = decode_at(AT, pair >> 16, pair & 0xFFFF)
    if found is None:  # a condition or a register that the form does not have
        assert {"w", "l"} & row.fields.keys()
        return
    again = words(found.text)
    back = decode_at(AT, again[0], again[-1])
    assert back is not None
    assert (back.text, back.words) == (found.text, len(again))
    assert back.words < found.words or back.encoding is found.encoding
    if back.encoding is found.encoding:
        field = found.values.get("l")
        both_shown_alike = "32" in row.syntax and field in (0xA8, 0xAA)  # ACC and P have two encodings each
        assert back.values == (found.values | {"l": field + 1} if both_shown_alike else found.values)


def test_the_shortest_form_is_taken():
    assert words("MOV @AL,#0") == (0x2BA9,)
    assert words("MOV @AL,#1") == (0x28A9, 1)
    assert words("NOP") == (0x7700,)


def test_case_and_spaces_are_free():
    assert words("  mpyf32   r0h , R1H,r2h||  addf32 R3H,R4H,R5H ") == words("MPYF32 R0H,R1H,R2H || ADDF32 R3H,R4H,R5H")
    assert words("mov al, *+xar4[ 3 ]") == (0x92DC,)


@pytest.mark.parametrize(
    ("short", "written_out"),
    [
        ("ADD AL,AH", "ADD AL,@AH"),
        ("MOVZ AR4,SP", "MOVZ AR4,@SP"),
        ("ADDL XAR4,ACC", "ADDL @XAR4,ACC"),
        ("TBIT AL,#3", "TBIT @AL,#3"),
        ("LSR AL,6", "LSR AL,#6"),
        ("LSL ACC,T", "LSL ACC,T"),
        ("SPM #0", "SPM 0"),
        ("LCR there", "LCR #there"),
        ("MOV ACC,#1000", "MOV ACC,#1000<<#0"),
        ("XOR ACC,#1<<3", "XOR ACC,#1<<#3"),
    ],
)
def test_short_forms_that_compilers_write(short: str, written_out: str):
    """The @ before a register, the # before a shift count or call target, and a shift by 0 may be omitted."""
    assert words(short, there=0x33_8000) == words(written_out, there=0x33_8000)


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("MOV32 R0H,ACC", (0xBDA9, 0x0F12)),
        ("MOV32 R7H,@XAR3", (0xBDA3, 0x0F2E)),
        ("MOV32 XT,R1H", (0xBFAC, 0x0F16)),
        ("MOV32 @P,R2H", (0xBFAB, 0x0F1A)),
    ],
)
def test_moves_between_cpu_and_fpu_registers_contain_the_address_of_the_fpu_register(
    source: str, expected: tuple[int, ...]
):
    """R0H is at 0x0F12, and each further register is four words higher [SPRUEO2A, MOV32]."""
    assert words(source) == expected


def test_interrupts_are_switched_by_a_bit_of_setc_and_clrc():
    """They also take the cycles of SETC and CLRC for that bit [SPRU430F, DINT, EINT]."""
    for name, source in (("DINT", "SETC INTM"), ("EINT", "CLRC INTM")):
        row, other = parse(name, AT, {}).encoding, parse(source, AT, {}).encoding
        assert words(name) == words(source)
        assert row.cycles == other.cycles_of({"y": 0x10})[0] == 2


def test_push_and_pop_of_32_bits_are_movl_instructions():
    assert words("PUSH XAR4") == words("MOVL *SP++,XAR4")
    assert words("POP ACC") == words("MOVL ACC,*--SP")


def test_a_data_symbol_gives_the_offset_in_its_page_and_a_code_symbol_the_distance():
    assert words("MOV @I2CMDR,#0x4600", I2CMDR=0x7909) == (0x2809, 0x4600)
    assert words("SB wait,NTC", wait=AT - 3) == (0x6CFD,)
    assert words("LCR #main", main=0x33_8000) == (0x7673, 0x8000)


def test_the_range_of_a_later_symbol_is_checked_when_its_value_is_known():
    parsed = parse("SB later,EQ", AT, {})
    assert parsed.words(AT, {"later": AT + 2}) == (0x6102,)
    with pytest.raises(BadInstruction, match="reaches -128 to 127"):
        parsed.words(AT, {"later": AT + 200})
    with pytest.raises(BadInstruction, match="'later' is not defined"):
        parsed.words(AT, {})


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("MOVV AL,@AR4", "there is no instruction 'MOVV'; did you mean"),
        ("MOVB AL", "has none of the operands of MOVB: MOVB ACC,#8"),
        ("ADDB ACC,#256", "'#256' is 256, outside 0 to 255"),
        ("ADDB AL,#200", "outside -128 to 127"),
        ("LSL ACC,#17", "outside 1 to 16"),
        ("ADD ACC,@AL<<#0", "outside 1 to 15"),
        ("MOV AL,*-SP[64]", "outside 0 to 63"),
        ("ADDF32 R0H,#0.1,R1H", "more than the upper half"),
        ("ADDF32 R0H,#1e39,R1H", "1e39 is too large for a float32"),
        ("ADDF32 R0H,#-1e400,R1H", "-1e400 is too large for a float32"),
        ("LCR #0x400000", "outside 0 to"),
        ("MOVW DP,#1 +", "not a number"),
        ("SETFLG RND=2", "not a flag of STF"),
        ("I16TOF32 R0H,@AL", "'@AL' is not an operand of I16TOF32, whose mem16 is memory"),
        ("MOVL ACC,@SP", "'@SP' is not an operand of MOVL, whose loc32 is memory or a register of 32 bits"),
        ("MOV32 STF,@ACC", "whose mem32 is memory"),
        ("MOV32 R0H,@SP", "whose mem32 is memory"),
    ],
)
def test_refused_in_one_sentence(source: str, sentence: str):
    with pytest.raises(BadInstruction) as error:
        words(source)
    assert sentence in str(error.value)


@pytest.mark.parametrize(
    ("source", "least", "most"),
    [
        ("MOVB ACC,#{}", 0, 255), ("ADDB AL,#{}", -128, 127), ("MOV AL,#{}", -0x8000, 0xFFFF), ("RPT #{}", 0, 255),
        ("MOVZ DP,#{}", 0, 1023), ("MOVW DP,#{}", -0x8000, 0xFFFF), ("MOVL XAR4,#{}", 0, 0x3F_FFFF),
        ("ADDB XAR4,#{}", 0, 127),
        ("LSL ACC,#{}", 1, 16), ("LSR AL,#{}", 1, 16), ("TBIT @0,#{}", 0, 15), ("MOV AL,*-SP[{}]", 0, 63),
        ("MOV AL,*+XAR4[{}]", 0, 7), ("TRAP #{}", 0, 31), ("MOVIZ R0H,#{:#x}", 0, 0xFFFF), ("LCR #{}", 0, 0x3F_FFFF),
        ("SETFLG {}=1", 0, 10), ("XB {},UNC", 0x3F_0000, 0x3F_FFFF), ("MOV *(0:{}),@AL", 0, 0xFFFF),
        ("RPTB {},#1", AT + 2, AT + 129), ("SB {},EQ", AT - 128, AT + 127), ("B {},EQ", AT - 0x8000, AT + 0x7FFF),
        ("MPY P,T,#{}", -0x8000, 0xFFFF), ("ADD @0,#{}", -0x8000, 0xFFFF), ("MOVB AL.LSB,*+XAR4[{}]", 0, 7),
    ],
)  # fmt: skip
def test_a_number_is_accepted_from_the_minimum_to_the_maximum_of_its_field(source: str, least: int, most: int):
    for number in (least, most):
        words(source.format(number))
    for number in (least - 1, most + 1):
        with pytest.raises(BadInstruction):
            words(source.format(number))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0x7900 + 2", 0x7902),
        ("1F2h", 0x1F2),
        ("'A'", 65),
        ("(table+4)&0x3F", 5),
        ("$ - 2", AT - 2),
        ("~1", -2),
        ("9/2", 4),
        ("-9/2", -5),
        ("9%4", 1),
        ("2*3+1", 7),
        ("2+3*4", 14),
        ("+5", 5),
        ("-5", -5),
        ("7-2-1", 4),
        ("6&3", 2),
        ("6|1", 7),
        ("6^3", 5),
        ("16>>2", 4),
        ("1<<0", 1),
        ("1<<64", 1 << 64),
        ("8>>64", 0),
        ("1h", 1),
        ("_a.b$c", 7),
        ("';'", 59),
        ("0b11", 3),
    ],
)
def test_expressions(text: str, value: int):
    assert evaluate(text, {"table": 0x41, "_a.b$c": 7}, AT) == value


@pytest.mark.parametrize(
    "text",
    [
        "",
        "1 +",
        "1/0",
        "1%0",
        "1 << 65",
        "1 >> 65",
        "1 << -1",
        "x",
        "not 1",
        "1 < 2",
        "1 and 1",
        "f(1)",
        "[1]",
        "1.5",
        "a b",
        "'",
        "9**9",
        "None",
    ],
)
def test_malformed_expressions_are_refused(text: str):
    with pytest.raises(BadInstruction):
        evaluate(text, {}, AT)


# Every form with every operand --------------------------------------------------------------------------------------

SYNTAXES = [
    *((row.id, row.syntax) for row in encodings()),
    *((f"{row.id} also", row.also) for row in encodings() if row.also),
]


@pytest.mark.parametrize(("form", "syntax"), SYNTAXES, ids=[form for form, _ in SYNTAXES])
def test_decoding_and_assembling_again_gives_the_same_words(form: str, syntax: str):
    for source in dict.fromkeys(lines(syntax, AT)):
        first = words(source)
        found = decode_at(AT, first[0], first[-1])
        assert found is not None and found.words == len(first), f"{source!r} of {form} is no instruction"
        assert found.text == source or words(found.text) == first, f"{source!r} of {form} is shown as {found.text!r}"
