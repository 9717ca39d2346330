"""Conditions of waits, declared as bits of a register and their value: passes need no Python.

i2c.I2CSTR.when(XRDY=1)                 i2c.I2CSTR.XRDY == 1
i2c.I2CSTR.when(mask=0x18, value=0x8)   i2c.I2CSTR.all & 0x18 == 0x8
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..error_origin import Misuse
from ..operand import Operand
from ..source_location import SourceLocation
from .accesses import Accesses

EQUAL, UNEQUAL, BELOW, ABOVE = range(4)  # how the bits compare with the value


@final
class Condition:
    """A comparison of bits of a register with a value: `holds` makes the read of a pass of a wait."""

    __slots__ = ("_accesses", "_mask", "_operand", "_test", "_value", "_where")

    def __init__(
        self,
        accesses: Accesses,
        operand: Operand,
        mask: int,
        value: int,
        test: int = EQUAL,
        where: SourceLocation | None = None,
    ) -> None:
        """mask, value: unshifted, as in the register. where: its statement in the firmware, if known."""
        self._accesses = accesses
        self._operand = operand
        self._mask = mask
        self._value = value
        self._test = test
        self._where = where

    def holds(self) -> bool:
        """Read the register, and return True if the condition is true; the cycles of the read pass."""
        bits, test = self._accesses.read(self._operand, self._where) & self._mask, self._test
        if test == EQUAL:
            return bits == self._value
        if test == UNEQUAL:
            return bits != self._value
        return bits < self._value if test == BELOW else bits > self._value

    def __call__(self) -> bool:
        return self.holds()

    def __bool__(self) -> bool:
        raise Misuse(f"a condition on {self._operand} has no value by itself; give it to dsp.spin, or call it")
