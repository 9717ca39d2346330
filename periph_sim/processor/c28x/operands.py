"""Operands in assembly text. The syntax of a form, a row of `encodings.toml`, is split into parts.

A part converts the fields of an operand to text, and the text of an operand to fields:

    "MOV loc16,#16"        ->  parts "MOV ", loc16, ",", #16
    show  {l: 0x41, c: 7}  ->  "MOV *-SP[1],#7"
    read  "*-SP[1]", "#7"  ->  {l: 0x41}, {c: 7}

In the text of a relative branch, the operand is the target address; in the field, it is the distance to the target.

Source: SPRU430F chapter 6, SPRUEO2A chapter 4 (syntax); the operand kinds are those of `encodings.toml`.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Mapping
from functools import cache
from typing import NamedTuple

from .encodings import WIDE, Encoding, fixed_operands, is_operand, operand_texts

Values = Mapping[str, int]  # maps the letter of a field to its value
Evaluate = Callable[[str], int]  # returns the value of an expression
Read = Callable[[str, int, Evaluate], dict[str, int]]  # (text, address of the instruction, evaluate) -> field values


class BadInstruction(ValueError):
    """Raised if a text is no instruction, or is no valid operand of an instruction. The message is one sentence."""


class Part(NamedTuple):
    """A part of the syntax of a form: an operand, or a literal text.

    show: returns the text; its arguments are the field values and the address of the instruction.
    pattern: a regular expression for the texts that `read` accepts; "" for a literal text.
    read: parses the text of an operand, see `Read`; None for a literal text.
    literal: the literal text; "" for an operand.
    """

    show: Callable[[Values, int], str]
    pattern: str
    read: Read | None = None
    literal: str = ""


def literal(text: str) -> Part:
    """Return the `Part` for text that the syntax of a form contains as it is, such as a mnemonic or a comma."""
    return Part(lambda values, at: text, "", None, text)


def ranged(number: int, least: int, most: int, text: str) -> int:
    """Return a number if it is from `least` to `most`; else raise BadInstruction with a message that quotes `text`."""
    if not least <= number <= most:
        raise BadInstruction(f"{text.strip()!r} is {number}, outside {least} to {most}")
    return number


CALLS = ("LB", "LC", "LCR", "FFC")
LARGEST_FLOAT32 = (2 - 2**-23) * 2.0**127
PMA_PAGE = 0x3F_0000  # the upper bits of program addresses in C2xLP instructions
# `<<` and `|` can be operators of an expression. But `<<` before `#` begins a shift operand, and `||` begins a parallel
# instruction, so these two end the expression.
IMMEDIATE = r"#(?:[^,|<]|<<(?!\s*#)|(?<!\|)\|(?!\|))+?"


def number_part(token: str, encoding: Encoding) -> Part | None:
    """Return the `Part` for a number in field c, such as "#16s", "#RC" or "#0..31"; None if the form has no field c."""
    if "c" not in encoding.fields:
        return None
    mask = encoding.fields["c"].mask
    signed = token.endswith("s")
    least = -(mask + 1 >> 1) if signed or token == "#16" else 0
    most = mask >> 1 if token == "#8s" else mask

    def show(values: Values, at: int) -> str:
        number = values["c"]
        if signed:
            return f"#{number - mask - 1 if number > mask >> 1 else number}"
        return f"#{number}" if number < 10 else f"#{number:#x}"

    label = r"|[A-Za-z_$][\w$.]*" if encoding.mnemonic in CALLS else ""  # a label may be written without #
    return Part(
        show, IMMEDIATE + label, lambda text, at, evaluate: {"c": _immediate(text, evaluate, least, most) & mask}
    )


def shift_part(token: str, encoding: Encoding) -> Part | None:
    """Return the `Part` for a shift count in field s, such as "#1..16" or "<<2..8"; None if the form has no field s.

    The largest shift count is encoded by ones in all bits of the field.
    """
    if "s" not in encoding.fields:
        return None
    prefix = token.rstrip("0123456789.")
    least, most = map(int, token.removeprefix(prefix).split(".."))
    bias = most - encoding.fields["s"].mask
    return Part(
        lambda values, at: f"{prefix}{values['s'] + bias}",
        rf"{re.escape(prefix)}[^,|<]+?" + (r"|\d+" if prefix == "#" else ""),
        lambda text, at, evaluate: {"s": ranged(evaluate(text.removeprefix(prefix)), least, most, text) - bias},
    )


def optional_shift_part(token: str, encoding: Encoding) -> Part | None:
    """Return the `Part` for a shift `<<#0..15` in field s, which may be omitted; None if the form has no field s.

    If the shift is omitted in the source line, field s is 0.
    """
    inner = shift_part(token.removeprefix("<<"), encoding)
    return inner and _optional(inner, "<<", {"s": 0}, lambda values, at: f"<<{inner.show(values, at)}")


def _optional(inner: Part, prefix: str, omitted: dict[str, int], show: Callable[[Values, int], str]) -> Part:
    """Return a `Part` for `prefix` and then `inner`. Both may be omitted; the field values are then `omitted`."""

    def read(text: str, at: int, evaluate: Evaluate) -> dict[str, int]:
        given = text.strip().removeprefix(prefix).strip()
        return inner.read(given, at, evaluate) if given and inner.read else omitted

    return Part(show, rf"|\s*{prefix}\s*(?:{inner.pattern})", read)


def half_of(text: str, evaluate: Evaluate) -> int:
    """Return the upper half of a float32. text: the float, "#2.5", or the upper half itself, "#0x4020"."""
    inner = text.strip().lstrip("#").strip()
    if re.fullmatch(r"[-+]?(\d+\.\d*|\.\d+|\d+)(e[-+]?\d+)?", inner, re.I) and not re.fullmatch(r"0x.*", inner, re.I):
        if abs(float(inner)) > LARGEST_FLOAT32:
            raise BadInstruction(f"{inner} is too large for a float32")
        bits = int(struct.unpack("<I", struct.pack("<f", float(inner)))[0])
        if bits & 0xFFFF:
            raise BadInstruction(f"{inner} needs more than the upper half of a float32")
        return bits >> 16
    return ranged(evaluate(inner), 0, 0xFFFF, text)


def _immediate(text: str, evaluate: Evaluate, least: int, most: int) -> int:
    return ranged(evaluate(text.strip().lstrip("#")), least, most, text)


# Addresses ----------------------------------------------------------------------------------------------------------


def branch_part(token: str, encoding: Encoding) -> Part:
    """Return the `Part` for off8 or off16, the target address of a relative branch."""
    mask = encoding.fields["c"].mask
    half = mask + 1 >> 1

    def show(values: Values, at: int) -> str:
        return f"{at + ((values['c'] ^ half) - half) & 0x3F_FFFF:#08x}"

    def read(text: str, at: int, evaluate: Evaluate) -> dict[str, int]:
        distance = evaluate(text) - at
        if not -half <= distance < half:
            raise BadInstruction(
                f"{text.strip()!r} is {distance} words away; this branch reaches {-half} to {half - 1}"
            )
        return {"c": distance & mask}

    return Part(show, r"[^,|]+?", read)


def address_part(page: int) -> Callable[[str, Encoding], Part]:
    """Return a function that makes the `Part` for an address. It is called with a token, such as "0:pma", and the form.

    Field c has the low 16 bits of the address. page: its upper bits, which the instruction does not contain.
    """

    def make(token: str, encoding: Encoding) -> Part:
        prefix = token.rstrip("16pmaPA")
        return Part(
            lambda values, at: f"{prefix}{page | values['c']:#x}",
            rf"{re.escape(prefix)}[^,|()]+?",
            lambda text, at, evaluate: {"c": ranged(evaluate(text[len(prefix) :]), page, page | 0xFFFF, text) & 0xFFFF},
        )

    return make


def _show_half_float(values: Values, at: int) -> str:
    number: float = struct.unpack("<f", struct.pack("<I", values["i"] << 16))[0]
    return f"#{number!r}" if number - number == 0 else f"#{values['i']:#06x}"


BIT = Part(
    lambda values, at: f"#{values['b']}",
    IMMEDIATE,
    lambda text, at, evaluate: {"b": _immediate(text, evaluate, 0, 15)},
)
HALF = Part(
    lambda values, at: f"#{values['i']:#06x}",
    IMMEDIATE,
    lambda text, at, evaluate: {"i": _immediate(text, evaluate, 0, 0xFFFF)},
)
# The upper half of a float32, shown as a float; infinities and NaN are shown as bits, "#0x7FC0".
HALF_FLOAT = Part(_show_half_float, IMMEDIATE, lambda text, at, evaluate: {"i": half_of(text, evaluate)})
# The label of RPTB: the address after the block. The block begins after the two words of RPTB.
BLOCK_END = Part(
    lambda values, at: f"{at + 2 + values['z']:#08x}",
    r"[^,|]+?",
    lambda text, at, evaluate: {"z": ranged(evaluate(text) - at - 2, 0, 127, text)},
)


CONDITIONS = ["NEQ", "EQ", "GT", "GEQ", "LT", "LEQ", "HI", "HIS", "LO", "LOS", "NOV", "OV", "NTC", "TC", "NBIO", "UNC"]
CONDITION_NAMES = {name: code for code, name in enumerate(CONDITIONS)} | {"C": 7, "NC": 8}
FPU_CONDITIONS = {"NEQ": 0, "EQ": 1, "GT": 2, "GEQ": 3, "LT": 4, "LEQ": 5, "TF": 10, "NTF": 11, "LU": 12, "LV": 13}
FPU_CONDITIONS |= {"UNC": 14, "UNCF": 15}
FPU_CONDITION_NAMES = {code: name for name, code in FPU_CONDITIONS.items()}
STATUS_BITS = ["SXM", "OVM", "TC", "C", "INTM", "DBGM", "PAGE0", "VMAP"]  # bits 0 to 7 of field y of SETC and CLRC
STF_BITS = {"LVF": 0, "LUF": 1, "NF": 2, "ZF": 3, "NI": 4, "ZI": 5, "TF": 6, "RNDF32": 9}
MOVST0_BITS = {"LVF": 0, "LUF": 1, "NF": 2, "NI": 3, "ZF": 4, "ZI": 5, "TF": 7}
PRODUCT_SHIFTS = ("+1", "0", "-1", "-2", "-3", "-4", "-5", "-6")
PRODUCT_SHIFT_CODES = {text: code for code, text in enumerate(PRODUCT_SHIFTS)} | {"1": 0, "#0": 1}
INTERRUPTS = [f"INT{n}" for n in range(1, 15)] + ["DLOGINT", "RTOSINT"]
OPERANDS = {
    "loc32": "memory or a register of 32 bits",
    "mem16": "memory",
    "mem32": "memory",
    "reg32": "a register of 32 bits",
}
FPU_FIRST, FPU_APART = 0x0F12, 4  # a move with the address FPU_FIRST + n * FPU_APART accesses RnH
UNCF = 15
REGISTER_FIELDS = {"RaH": "p", "RbH": "q", "RcH": "r", "RdH": "t", "ReH": "u", "RfH": "v"}


@cache
def parts_of(encoding: Encoding) -> tuple[Part, ...]:
    """Return the parts of a form's syntax."""
    parts = [literal(encoding.mnemonic)]
    rest = encoding.syntax.removeprefix(encoding.mnemonic)
    while rest:
        for token, make in _TOKENS:
            found = token.match(rest)
            if found is None:
                continue
            part = make if isinstance(make, Part) else make(found.group(), encoding)
            if part is not None:
                parts.append(part)
                rest = rest[found.end() :]
                break
        else:
            before = parts.pop().literal if parts[-1].literal else ""
            parts.append(literal(before + rest[0]))
            rest = rest[1:]
    return tuple(parts)


# Registers, modes and conditions ------------------------------------------------------------------------------------


def _operand(token: str, encoding: Encoding) -> Part:
    wide = token in WIDE

    def read(text: str, at: int, evaluate: Evaluate) -> dict[str, int]:
        field = field_of(text, evaluate)
        if not is_operand(token, field):
            raise BadInstruction(
                f"{text!r} is not an operand of {encoding.mnemonic}, whose {token} is {OPERANDS[token]}"
            )
        return {"l": field}

    def field_of(text: str, evaluate: Evaluate) -> int:
        spaceless = "".join(text.split())
        names = fixed_operands(wide)
        found = names.get(spaceless.upper(), names.get(f"@{spaceless.upper()}"))  # a register needs no @
        if found is not None:
            return found
        if spaceless.startswith("@"):  # the text is an address; field l is the offset of this address in its data page
            return evaluate(spaceless[1:]) & 0x3F
        stack = re.fullmatch(r"\*-SP\[(.+)\]", spaceless, re.I)
        if stack:
            return 0x40 | ranged(evaluate(stack[1]), 0, 63, text)
        indexed = re.fullmatch(r"\*\+XAR([0-7])\[(.+)\]", spaceless, re.I)
        if indexed:
            return 0xC0 | ranged(evaluate(indexed[2]), 0, 7, text) << 3 | int(indexed[1])
        raise BadInstruction(f"{text!r} is not an operand in memory or a register")

    return Part(lambda values, at: operand_texts(wide)[values["l"]], r"\*\s*,\s*ARP[0-7]|[^,|<#]+?", read)


def _optional_operand(token: str, encoding: Encoding) -> Part:
    """Return the `Part` for the operand of NOP, which may be omitted."""
    inner = _operand("loc16", encoding)
    return _optional(inner, "", {"l": 0}, lambda values, at: inner.show(values, at) if values["l"] else "")


def _numbered(prefix: str, field: str, suffix: str = "") -> Part:
    """Return the `Part` for a register with a number in its name, such as AR3, ARP3 or R3H."""
    return Part(
        lambda values, at: f"{prefix}{values[field]}{suffix}",
        rf"{prefix}[0-7]{suffix}",
        lambda text, at, evaluate: {field: int(text[len(prefix)])},
    )


def _one_of(field: str, names: Mapping[str, int], shown: Callable[[int], str]) -> Part:
    pattern = "|".join(re.escape(name) for name in sorted(names, key=len, reverse=True))
    return Part(
        lambda values, at: shown(values[field]), pattern, lambda text, at, evaluate: {field: names[text.upper()]}
    )


def _bit_names(field: str, bits: Mapping[str, int]) -> Part:
    """Return the `Part` for a mask, whose text lists the names of its bits: "NF,ZF". A number stands for unnamed bits.

    bits: for each name, the number of its bit.
    """

    def show(values: Values, at: int) -> str:
        names = [name for name, bit in bits.items() if values[field] >> bit & 1]
        rest = values[field] & ~sum(1 << bit for bit in bits.values())
        return ",".join([*names, *([f"{rest:#x}"] if rest or not names else [])])

    def read(text: str, at: int, evaluate: Evaluate) -> dict[str, int]:
        mask = 0
        for name in text.split(","):
            bit = bits.get(name.strip().upper())
            mask |= evaluate(name) if bit is None else 1 << bit
        return {field: mask}

    return Part(show, r"[^|#]+?", read)


def _flags_and_values(token: str, encoding: Encoding) -> Part:
    """Return the `Part` for flags of STF with new values, "RNDF32=1,TF=0". A flag that is not selected is "TF=1?"."""

    def show(values: Values, at: int) -> str:
        named = {bit: name for name, bit in STF_BITS.items()}
        chosen = [bit for bit in range(11) if (values["g"] | values["h"]) >> bit & 1]
        return ",".join(
            f"{named.get(bit, bit)}={values['h'] >> bit & 1}{'' if values['g'] >> bit & 1 else '?'}" for bit in chosen
        )

    def read(text: str, at: int, evaluate: Evaluate) -> dict[str, int]:
        mask = value = 0
        for pair in filter(None, (one.strip() for one in text.split(","))):
            name, equals, number = pair.partition("=")
            one = number.strip().rstrip("?")
            if not equals or one not in ("0", "1"):
                raise BadInstruction(f"{pair!r} is not a flag of STF with its value, such as RNDF32=1")
            bit = STF_BITS.get(name.strip().upper())
            bit = ranged(evaluate(name), 0, 10, pair) if bit is None else bit
            mask |= (not number.strip().endswith("?")) << bit
            value |= int(one) << bit
        return {"g": mask, "h": value}

    return Part(show, r"[^|#]*?", read)


REGISTER_BY_ADDRESS = Part(  # R0H to R7H in moves that encode the register by an address
    lambda values, at: f"R{(values['c'] - FPU_FIRST) // FPU_APART}H",
    "R[0-7]H",
    lambda text, at, evaluate: {"c": FPU_FIRST + FPU_APART * int(text[1])},
)
FPU_CONDITION = _one_of("w", FPU_CONDITIONS, FPU_CONDITION_NAMES.__getitem__)
OPTIONAL_FPU_CONDITION = _optional(  # `,CNDF`, where UNCF may be omitted
    FPU_CONDITION,
    ",",
    {"w": UNCF},
    lambda values, at: "" if values["w"] == UNCF else f",{FPU_CONDITION_NAMES[values['w']]}",
)
_TOKENS: tuple[tuple[re.Pattern[str], Part | Callable[[str, Encoding], Part | None]], ...] = tuple(
    (re.compile(token), make)
    for token, make in (
        (r"(loc|mem)(16|32)|reg32", _operand),
        (r"R\(c\)H", REGISTER_BY_ADDRESS),
        (r"\{\*ind\}", _optional_operand),
        (r"\{,CNDF\}", OPTIONAL_FPU_CONDITION),
        (r"CNDF", FPU_CONDITION),
        (r"COND", _one_of("k", CONDITION_NAMES, CONDITIONS.__getitem__)),
        (r"AX", _one_of("x", {"AL": 0, "AH": 1}, ("AL", "AH").__getitem__)),
        (r"ARPn", _numbered("ARP", "n")),
        (r"ARn", _numbered("AR", "n")),
        (r"ARm", _numbered("AR", "m")),
        (r"R[a-f]H", lambda token, encoding: _numbered("R", REGISTER_FIELDS[token], "H")),
        (r"mode", _bit_names("y", {name: bit for bit, name in enumerate(STATUS_BITS)})),
        (r"FLAG,VALUE", _flags_and_values),
        (r"FLAG", _bit_names("g", MOVST0_BITS)),
        (r"INTx", _one_of("c", {name: code for code, name in enumerate(INTERRUPTS)}, INTERRUPTS.__getitem__)),
        (r"<<#0\.\.15", optional_shift_part),
        (r"<<#16", literal("<<#16")),
        (r"#0\.0", literal("#0.0")),
        (r"#16F(Hi|Lo)Hex", HALF),
        (r"#16FHi", HALF_FLOAT),
        (r"#bit", BIT),
        (r"#0\.\.31", number_part),
        (r"#\d+\.\.\d+", shift_part),
        (r"<<\d\.\.8", shift_part),
        (r"#(RC|8s|16s|8|16|7|10|22)", number_part),
        (r"off(8|16)", branch_part),
        (r"label", BLOCK_END),
        (r"0:(16|pma)", address_part(0)),
        (r"PA", address_part(0)),
        (r"pma", address_part(PMA_PAGE)),
        (r"pm", _one_of("s", PRODUCT_SHIFT_CODES, PRODUCT_SHIFTS.__getitem__)),
    )
)
