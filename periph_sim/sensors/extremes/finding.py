"""What was found at one extreme in one arithmetic: the rows of the report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

# agrees: within what the arithmetic is off in the working range. exact: off by nothing.
# full scale: the converter's last code, as meant.
Happens = Literal["agrees", "exact", "off", "full scale", "saturates", "wraps", "NaN", "refused"]


EVERY = "every"  # instead of an arithmetic where none is concerned


@dataclass(frozen=True)
class Finding:
    """begins: the first input at which it happens, in `unit`; None where it does not. worst: LSB off the reference.

    arithmetic: its name, or EVERY. overflows: the first input at which a number left a Q format on the
    way, whether it showed or not.
    """

    extreme: str
    arithmetic: str
    happens: Happens
    begins: float | None
    unit: str
    worst: float | None = None
    note: str = ""
    overflows: float | None = None
