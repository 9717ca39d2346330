"""Numbers and addresses in assembly text: immediates, shifts, bits, halves of floats, targets of branches.

A branch shows and reads its target address; its field holds the distance.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable

from .encodings import Encoding
from .syntax_part import BadOperand, Evaluate, Part, Values, ranged

CALLS = ("LB", "LC", "LCR", "FFC")
PMA_PAGE = 0x3F_0000  # the program page of C2xLP addresses
IMMEDIATE = r"#(?:[^,|<]|<<(?!\s*#)|(?<!\|)\|(?!\|))+?"  # `<<` and `|` in an expression, not `#16<<#0..15`, `||`


def number_part(token: str, encoding: Encoding) -> Part | None:
    """An immediate "#16s", "#RC" or "#0..31" in field c; None if the form has no field c."""
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

    label = r"|[A-Za-z_$][\w$.]*" if encoding.mnemonic in CALLS else ""  # the target needs no #
    return Part(
        show, IMMEDIATE + label, lambda text, at, evaluate: {"c": _immediate(text, evaluate, least, most) & mask}
    )


def shift_part(token: str, encoding: Encoding) -> Part | None:
    """A shift "#1..16" or "<<2..8" in field s."""
    if "s" not in encoding.fields:
        return None
    prefix = token.rstrip("0123456789.")
    bias, mask = encoding.shift_bias, encoding.fields["s"].mask
    return Part(
        lambda values, at: f"{prefix}{values['s'] + bias}",
        rf"{re.escape(prefix)}[^,|<]+?" + (r"|\d+" if prefix == "#" else ""),
        lambda text, at, evaluate: {
            "s": ranged(evaluate(text.removeprefix(prefix)), bias + _least(encoding), mask + bias, text) - bias
        },
    )


def optional_shift_part(token: str, encoding: Encoding) -> Part | None:
    """`<<#0..15`; if omitted, 0."""
    inner = shift_part(token.removeprefix("<<"), encoding)
    if inner is None:
        return None

    def read(text: str, at: int, evaluate: Evaluate) -> dict[str, int]:
        assert inner is not None and inner.read is not None
        return inner.read(text.strip().removeprefix("<<").strip(), at, evaluate) if text.strip() else {"s": 0}

    return Part(lambda values, at: f"<<{inner.show(values, at)}", rf"|<<\s*(?:{inner.pattern})", read)


def _least(encoding: Encoding) -> int:
    return dict(encoding.at_least).get("s", 0)


def float_of(upper: int) -> float:
    """Return the float32 with this upper half and lower half 0."""
    number: float = struct.unpack("<f", struct.pack("<I", upper << 16))[0]
    return number


def half_of(text: str, evaluate: Evaluate) -> int:
    """Return the upper half of a float32 given as "#2.5", or the bits given as "#0x4020"."""
    inner = text.strip().lstrip("#").strip()
    if re.fullmatch(r"[-+]?(\d+\.\d*|\.\d+|\d+)(e[-+]?\d+)?", inner, re.I) and not re.fullmatch(r"0x.*", inner, re.I):
        try:
            bits = int(struct.unpack("<I", struct.pack("<f", float(inner)))[0])
        except OverflowError:
            raise BadOperand(f"{inner} is too large for a float32") from None
        if bits & 0xFFFF:
            raise BadOperand(f"{inner} needs more than the upper half of a float32")
        return bits >> 16
    return ranged(evaluate(inner), 0, 0xFFFF, text)


def _immediate(text: str, evaluate: Evaluate, least: int, most: int) -> int:
    return ranged(evaluate(text.strip().lstrip("#")), least, most, text)


# Addresses ----------------------------------------------------------------------------------------------------------


def branch_part(token: str, encoding: Encoding) -> Part:
    """off8, off16: the target address of a relative branch."""
    mask = encoding.fields["c"].mask
    half = mask + 1 >> 1

    def show(values: Values, at: int) -> str:
        return f"{at + ((values['c'] ^ half) - half) & 0x3F_FFFF:#08x}"

    def read(text: str, at: int, evaluate: Evaluate) -> dict[str, int]:
        distance = evaluate(text) - at
        if not -half <= distance < half:
            raise BadOperand(f"{text.strip()!r} is {distance} words away; this branch reaches {-half} to {half - 1}")
        return {"c": distance & mask}

    return Part(show, r"[^,|]+?", read)


def address_part(page: int) -> Callable[[str, Encoding], Part]:
    """The low 16 bits of an address in this page."""

    def make(token: str, encoding: Encoding) -> Part:
        prefix = token.rstrip("16pmaPA")
        return Part(
            lambda values, at: f"{prefix}{page | values['c']:#x}",
            rf"{re.escape(prefix)}[^,|()]+?",
            lambda text, at, evaluate: {"c": ranged(evaluate(text[len(prefix) :]), page, page | 0xFFFF, text) & 0xFFFF},
        )

    return make


def _show_half_float(values: Values, at: int) -> str:
    number = float_of(values["i"])
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
# The upper half of a float32 as a number; infinities and NaN as bits, "#0x7FC0".
HALF_FLOAT = Part(_show_half_float, IMMEDIATE, lambda text, at, evaluate: {"i": half_of(text, evaluate)})
# The label of RPTB: the end address of the block, which begins after the two words of RPTB.
BLOCK_END = Part(
    lambda values, at: f"{at + 2 + values['z']:#08x}",
    r"[^,|]+?",
    lambda text, at, evaluate: {"z": ranged(evaluate(text) - at - 2, 0, 127, text)},
)
