"""Records of the fields of a chip's registers, which are read after each input that may have changed them."""

# core: compiled

from __future__ import annotations

from typing import final

from .chip import Chip
from .chip_input import WaitingInputs
from .records import Kind, Recorder, Topic
from .registers import Register
from .state import State
from .time import Clock


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

    value: the value that was read last.
    was: the value that was read before `value`.
    upper: offset of the upper half of a 32-bit register; 0 for others.
    data: mask of the field that receives a word at a time; 0 if there is none.
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


@final
class FlagRecorder:
    """Records the fields of some registers of a chip."""

    STATE = State("_registers")

    __slots__ = (
        "_chip",
        "_clock",
        "_loads_data",
        "_moving",
        "_read",
        "_recorder",
        "_registers",
        "_some_steady",
        "_touched",
        "_writes",
    )

    _loads_data: bool
    _some_steady: bool

    def __init__(self, chip: Chip, clock: Clock, recorder: Recorder, registers: list[WatchedRegister]) -> None:
        self._chip = chip
        self._clock = clock
        self._recorder = recorder
        self._registers = registers
        self._moving = [r for r in registers if r.offset not in chip.steady or r.upper not in (0, *chip.steady)]
        self._some_steady = len(self._moving) < len(registers)
        self._loads_data = any(register.data for register in registers)
        self._read = registers  # the registers that `look` read last
        self._writes = -1  # the chip's `writes` at that time
        self._touched: frozenset[str] = frozenset()  # the chip's `touched` before these reads

    def look(self, cycle: int) -> bool:
        """Read the registers as a debugger does. Return True if any has changed.

        Questions that only these reads depend on are not added to `touched`.
        """
        chip = self._chip
        if self._some_steady:
            self._read = self._moving if chip.writes == self._writes else self._registers
            self._writes = chip.writes
        touched = chip.touched
        if len(touched) != len(self._touched):  # the set only grows, except for the names removed below
            self._touched = frozenset(touched)
        moved = False
        register: WatchedRegister
        for register in self._read:
            register.was = register.value
            register.value = chip.peek(cycle, register.offset)
            if register.upper:
                register.value |= chip.peek(cycle, register.upper) << 16
            if register.value != register.was:
                moved = True
        if len(touched) != len(self._touched):
            touched.intersection_update(self._touched)
        return moved

    def record(self, cycle: int, waiting: WaitingInputs) -> None:
        """Record the fields that have changed by `cycle`."""
        if self._recorder.cause:
            waiting.last_cause = self._recorder.cause
        loaded = 0
        if self._loads_data:
            loaded, self._chip.loaded = self._chip.loaded, 0
        if not self.look(cycle) and not loaded:
            return
        tick = self._clock.tick(cycle)
        register: WatchedRegister
        for register in self._read:
            changed: int = register.was ^ register.value
            if register.data and loaded >> register.offset & 1:
                changed |= register.data
            if changed:
                field: WatchedField
                for field in register.fields:
                    if changed & field.mask:
                        field.topic.emit(tick, (register.value & field.mask) >> field.lsb)


def watched_registers(chip: Chip, recorder: Recorder, name: str) -> list[WatchedRegister]:
    """Return the registers of a chip with fields that a subscriber wants. name: the name of the module."""
    subjects = recorder.subjects(Kind.FLAG)
    wanted = [r for r in chip.MAP if subjects is None or f"{name}.{r.name}" in subjects]
    return [WatchedRegister(register, recorder, name) for register in wanted]
