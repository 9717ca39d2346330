"""A write to a register on its way: issued by the CPU, but not yet effective."""

# core: compiled

from __future__ import annotations

from typing import final

from ..core.state import State
from .operand import Operand
from .source_location import SourceLocation


@final
class Posted:  # core: freelist 4
    """A posted write. where, cause: place and record of the instruction that issued it; where is None if unused.

    following: the write that lands next.
    """

    STATE = State("operand value where", cycles="lands", records="cause", made=True)

    __slots__ = ("cause", "following", "lands", "operand", "value", "where")

    lands: int
    operand: Operand
    value: int
    where: SourceLocation | None
    cause: int
    following: Posted | None
