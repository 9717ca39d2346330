"""The vocabulary of a run, and who listens to it.

Everything recorded is one of the kinds below, has a number, a time in ticks, a place, and
the number of the record that caused it (0: nothing recorded did). Producers ask `wants`
once, when a scene is built; what nobody wants is never made. Edges, flags and accesses can be
wanted of some wires and registers only: these are the subjects of a subscription.

    producer --> Recorder.emit --> sinks (budgets, files, diagrams)
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from enum import Enum
from functools import partial
from typing import NamedTuple


class Kind(Enum):
    EDGE = "edge"  # a wire changed: what = level, who pulled in `text`
    ACCESS = "access"  # a CPU access: what = R or W and the register, value
    FLAG = "flag"  # a register field changed by itself or by an access
    IRQ = "irq"  # interrupt requested, entered, left
    SPAN = "span"  # a stretch of firmware begins (1) or ends (0)
    BUS = "bus"  # what a party on the wire did or saw: START, address, byte, ACK, STOP
    FRAME = "frame"  # a UART frame on the wire
    NOTE = "note"  # a duty broken, something lost, something unknown
    WAIT = "wait"  # firmware begins (1) or ends (0) to wait: what = the fields it polls, or IDLE
    HOLD = "hold"  # a wire stays low, but others pull it now: who in `text`

    __hash__ = object.__hash__  # each is one object; Enum's own hash is a call in Python, made for every record


class Record(NamedTuple):
    """field: of an access, the register field that the firmware named; "" for the whole register."""

    number: int
    tick: int
    kind: Kind
    where: str
    what: str
    value: int
    text: str
    cause: int
    field: str = ""


_made = tuple.__new__  # a Record without the call in Python that its own constructor is

Sink = Callable[[Record], None]
Subjects = Mapping[Kind, Collection[str]]


class Recorder:
    """Numbers records and hands each to the sinks that asked for its kind.

    cause: the record under whose effects the simulation runs now; `core.socket` and
    `core.wire` set it around each delivery.
    """

    def __init__(self) -> None:
        self.cause = 0
        self._number = 0
        self._sinks: dict[Kind, list[Sink]] = {kind: [] for kind in Kind}
        self._of_all: set[Kind] = set()
        self._subjects: dict[Kind, set[str]] = {kind: set() for kind in Kind}

    def subscribe(self, kinds: Iterable[Kind], sink: Sink, only: Subjects | None = None) -> None:
        """`sink` is told of every record of these kinds.

        only: subjects that are enough for it, of kinds that have any: EDGE and FRAME wires; FLAG and ACCESS registers,
        with unit and module ("dsp.I2C-A.I2CSTR").
        It may still be told of others, which other sinks want.
        """
        for kind in kinds:
            self._sinks[kind].append(sink)
            if only is None or kind not in only:
                self._of_all.add(kind)
            else:
                self._subjects[kind].update(only[kind])

    def wants(self, kind: Kind, subject: str | None = None) -> bool:
        """Whether anybody wants records of this kind; of this subject, if one is given."""
        if subject is None:
            return bool(self._sinks[kind])
        return kind in self._of_all or subject in self._subjects[kind]

    def subjects(self, kind: Kind) -> frozenset[str] | None:
        """The subjects that somebody wants; None for all."""
        return None if kind in self._of_all else frozenset(self._subjects[kind])

    def carried(self, action: Callable[[], None]) -> Callable[[], None]:
        """The action, for a later time, as an effect of the record being worked under now."""
        return partial(self._under, self.cause, action) if self.cause else action

    def _under(self, cause: int, action: Callable[[], None]) -> None:
        outer, self.cause = self.cause, cause
        action()
        self.cause = outer

    def emit(
        self, tick: int, kind: Kind, where: str, what: str, value: int = 0, text: str = "", field: str = ""
    ) -> int:
        """The number of the new record; its cause is the record being worked under."""
        self._number = number = self._number + 1
        record = _made(Record, (number, tick, kind, where, what, value, text, self.cause, field))
        for sink in self._sinks[kind]:
            sink(record)
        return number
