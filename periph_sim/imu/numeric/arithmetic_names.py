"""Names of arithmetics: "float64", "float32", "q16", "q12 saturating", "q16 rounded".

name --> scalar(name)   one number at a time, as firmware does
     --> library(name)  the costs of its operations
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple

from ...core.input_error import InputError
from ...core.suggest import did_you_mean
from .arithmetic import Arithmetic
from .float64 import Float64
from .q import Overflow, Product, Q, RoundedQ

if TYPE_CHECKING:
    from .estimate import Library

EXAMPLES = ("float64", "float32", "q16", "q16 rounded", "q16 saturating")


class NoSuchArithmetic(InputError):
    """There is no arithmetic with this name. The message is one sentence."""


class Format(NamedTuple):
    """A Q format. If products saturate, they are also rounded, as by IQrsmpy."""

    bits: int
    overflow: Overflow
    product: Product


def format_of(name: str) -> Format | None:
    """Return the Q format with a name; None for float32 and float64. Raise NoSuchArithmetic for any other name."""
    if name in ("float32", "float64"):
        return None
    found = re.fullmatch(r"q(\d{1,3})( saturating| rounded)?", name)
    if found is None:
        raise NoSuchArithmetic(f"there is no arithmetic {name!r}; {did_you_mean(name, EXAMPLES)}")
    if found[2] == " saturating":
        return Format(int(found[1]), "saturate", "rounded")
    return Format(int(found[1]), "wrap", "rounded" if found[2] else "cut")


def scalar(name: str) -> Arithmetic[Any]:
    """Return the arithmetic with a name.

    Raise NoSuchArithmetic if there is none, and DoesNotFit if the number of bits is impossible.
    """
    q = format_of(name)
    if q is not None:
        return (Q if q.product == "cut" else RoundedQ)(q.bits, q.overflow)
    if name == "float64":
        return Float64()
    from .float32 import Float32  # imported here, because it uses numpy even for one number

    return Float32()


def library(name: str) -> Library:
    """Return the implementation on the F28335: IQmath, the FPU with fastRTS, or software."""
    from .estimate import DOUBLE, FASTRTS, IQMATH, ROUNDED, SATURATED

    q = format_of(name)
    if q is None:
        return DOUBLE if name == "float64" else FASTRTS
    if q.overflow == "saturate":
        return SATURATED
    return IQMATH if q.product == "cut" else ROUNDED
