"""Names of the kinds of arithmetic: "float64", "float32", "q16", "q12 saturating", "q16 rounded".

name --> scalar(name)   the arithmetic, with the operations of `arithmetic.Arithmetic`
     --> library(name)  the costs of the operations on the F28335
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from ...core.input_error import InputError
from ...core.phrases import did_you_mean
from .arithmetic import Arithmetic
from .float64 import Float64
from .q import Q, RoundedQ

if TYPE_CHECKING:
    from .estimate import Library

EXAMPLES = ("float64", "float32", "q16", "q16 rounded", "q16 saturating")


class NoSuchArithmetic(InputError):
    """There is no arithmetic with this name. The message is one sentence."""


def scalar(name: str) -> Arithmetic[Any]:
    """Return the arithmetic with this name.

    Raise NoSuchArithmetic if no arithmetic has this name, and DoesNotFit if the number of bits is impossible.
    """
    if name == "float64":
        return Float64()
    if name == "float32":
        from .float32 import Float32  # This import is here, because it imports numpy, which takes long.

        return Float32()
    found = re.fullmatch(r"q(\d{1,3})( saturating| rounded)?", name)
    if found is None:
        raise NoSuchArithmetic(f"there is no arithmetic {name!r}; {did_you_mean(name, EXAMPLES)}")
    bits = int(found[1])
    if found[2] is None:
        return Q(bits)
    # The saturating product of IQmath, IQrsmpy, also rounds.
    return RoundedQ(bits, "wrap" if found[2] == " rounded" else "saturate")


def library(name: str) -> Library:
    """Return the library that implements an arithmetic on the F28335: IQmath, the FPU with fastRTS, or software."""
    from .estimate import DOUBLE, FASTRTS, IQMATH, ROUNDED, SATURATED

    if name == "float32":
        return FASTRTS
    a = scalar(name)
    if not isinstance(a, Q):
        return DOUBLE
    if a.saturates:
        return SATURATED
    return ROUNDED if isinstance(a, RoundedQ) else IQMATH
