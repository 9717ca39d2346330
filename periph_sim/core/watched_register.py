"""Registers whose fields are recorded, with their last values and one topic for each field."""

# core: compiled

from __future__ import annotations

from typing import final

from .records import Kind, Recorder, Topic
from .registers import Register
from .state import State


@final
class WatchedField:
    """A recorded field of a register."""

    __slots__ = ("lsb", "mask", "topic")

    mask: int
    lsb: int
    topic: Topic


@final
class WatchedRegister:
    """A register whose fields are recorded.

    value: the value read last; was: the one before.
    upper: offset of the upper half of a 32-bit register; 0 for others.
    data: mask of the field that takes a word at a time; 0 without one.
    """

    STATE = State("value")

    __slots__ = ("data", "fields", "offset", "upper", "value", "was")

    offset: int
    upper: int
    data: int

    def __init__(self, register: Register, recorder: Recorder, name: str) -> None:
        self.offset = register.offset
        self.upper = register.offset + 1 if register.width == 32 else 0
        self.value = self.was = 0
        self.data = register[register.data].mask if register.data else 0
        self.fields: list[WatchedField] = []
        for what, mask, lsb in register.named_fields:
            field = WatchedField()
            field.mask, field.lsb, field.topic = mask, lsb, recorder.topic(Kind.FLAG, name, what)
            self.fields.append(field)
