"""Recorder of register fields: it reads a chip's registers when they may have changed, and records the changed fields.

An input may take effect some cycles after it was given. The cause of a change is the input that took effect last.
"""

# core: compiled

from __future__ import annotations

from typing import final

from .chip import Chip
from .records import Kind, Recorder, Topic
from .registers import Register
from .state import State
from .time import Clock

MAX_INPUTS = 64  # maximum number of waiting inputs; if a chip never wakes, the earliest inputs are dropped


@final
class Input:  # core: freelist 16
    """One input of a chip.

    cycle: the cycle in which the effect of the input begins.
    cause: the number of the record of the input.
    following: the next input in the linked list; None for the last input.
    """

    STATE = State(cycles="cycle", records="cause", made=True)

    __slots__ = ("cause", "cycle", "following")

    cycle: int
    cause: int
    following: Input | None

    def comes_before(self, other: Input) -> bool:
        """Return True if this input has an earlier cycle than `other`, or the same cycle and an earlier record."""
        return self.cycle < other.cycle or (self.cycle == other.cycle and self.cause < other.cause)


@final
class WaitingInputs:
    """The inputs of a chip that have not taken effect yet, in order of their cycles and then of their records.

    last_cause: the number of the record of the last input that took effect.
    """

    STATE = State("_count _last", records="last_cause", chains="_first")

    __slots__ = ("_count", "_first", "_last", "last_cause")

    def __init__(self) -> None:
        self.last_cause = 0
        self._count = 0
        self._first: Input | None = None
        self._last: Input | None = None

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return the values that are compared in place of attributes; see `proof.normal_state`.

        Only the number of cycles until each input takes effect is compared. Inputs that have taken effect have no
        influence on the run: they are only causes of records.
        """
        waiting: list[int] = []
        one = self._first
        while one is not None:
            if one.cycle > cycle:
                waiting.append(one.cycle - cycle)
            one = one.following
        return {"_count": tuple(waiting), "_last": None, "_first": None}

    def add(self, cycle: int, cause: int) -> None:
        """Add an input that takes effect in `cycle`. cause: the number of its record; if it is 0, nothing is added."""
        if not cause:
            return
        given: Input = Input.__new__(Input)
        given.cycle, given.cause = cycle, cause
        before = self._last
        if before is not None and given.comes_before(before):  # rare, because most inputs are added in order
            before, after = None, self._first
            while after is not None and not given.comes_before(after):
                before, after = after, after.following
        if before is None:
            given.following, self._first = self._first, given
        else:
            given.following, before.following = before.following, given
        if given.following is None:
            self._last = given
        self._count += 1
        if self._count > MAX_INPUTS:
            self._take_first()

    def cause_at(self, cycle: int) -> int:
        """Return the number of the record of the last input that took effect by `cycle`. These inputs are removed."""
        while self._first is not None and self._first.cycle <= cycle:
            self.last_cause = self._first.cause
            self._take_first()
        return self.last_cause

    def _take_first(self) -> None:
        """Remove the waiting input that takes effect first."""
        first = self._first
        assert first is not None
        self._first = first.following
        if first.following is None:
            self._last = None
        self._count -= 1


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
    upper: the offset of the upper half of a 32-bit register; 0 for a 16-bit register.
    data: the mask of the field with the data word, if a read of the register yields data; 0 for other registers.
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
        self._read = registers  # the registers that the last call of `look` has read
        self._writes = -1  # the chip's `writes` at the last call of `look`
        # Copy of `Chip.touched`. With it, `look` removes the names that its own reads add.
        self._touched: frozenset[str] = frozenset()

    def look(self, cycle: int) -> bool:
        """Read the registers as a debugger does. Return True if any has changed.

        Names that these reads add to `Chip.touched` are removed, because the run does not depend on the reads.
        """
        chip = self._chip
        if self._some_steady:
            self._read = self._moving if chip.writes == self._writes else self._registers
            self._writes = chip.writes
        touched = chip.touched
        # All other code only adds names to `touched`, so the copy is out of date if and only if the lengths differ.
        if len(touched) != len(self._touched):
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
        """Record the fields that have changed by `cycle`, and each new data word even if it equals the previous one."""
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
    """Return the registers of a chip that a subscriber to FLAG records needs. name: the name of the module."""
    subjects = recorder.subjects(Kind.FLAG)
    wanted = [r for r in chip.MAP if subjects is None or f"{name}.{r.name}" in subjects]
    return [WatchedRegister(register, recorder, name) for register in wanted]
