"""Findings: the results at one extreme in one arithmetic, rows of the report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

# agrees: within the arithmetic's deviation in the working range. exact: no deviation.
# full scale: the converter's last code, as intended.
Happens = Literal["agrees", "exact", "off", "full scale", "saturates", "wraps", "NaN", "refused"]


EVERY = "every"  # instead of an arithmetic if none is involved


@dataclass(frozen=True)
class Finding:
    """begins: the first input at which it happens, in `unit`; None for never. worst: deviation from the reference, LSB.

    arithmetic: its name, or EVERY. overflows: the first input at which an intermediate value exceeded a Q format, with
    or without a visible effect.
    """

    extreme: str
    arithmetic: str
    happens: Happens
    begins: float | None
    unit: str
    worst: float | None = None
    note: str = ""
    overflows: float | None = None
