"""Instants of a run by label, noted as its records are made.

    FLAG, IRQ, BUS, NOTE --> label --> ticks, values        label: place, thing, value

Neither edges nor who holds a wire are listened to: recorded edges would keep a bus at edges.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...core.records import UNHEARD, Kind, Listener, Recorder

Ints = NDArray[np.int64]

KINDS = (Kind.FLAG, Kind.IRQ, Kind.BUS, Kind.NOTE)
ON_BUS = ("address", "byte")  # what has a value, with its ACK as the last bit
# Registers that hold data: what is in them is compared as values, not as a flag that is set.
DATA = ("I2CDXR", "I2CDRR", "SCIRXBUF", "SCIRXEMU", "SCITXBUF")


@dataclass(frozen=True, order=True)
class Label:
    """A kind of occurrence. stream: occurrences among which order counts. value: of a flag; else 0."""

    stream: str
    what: str
    value: int = 0


Topic = tuple[Kind, str, str]
Met = dict[Topic, frozenset[int]]


def sort_of(kind: Kind, what: str, value: int) -> int:
    """Return the sort of a record: ACK 0 or NACK 1 of bytes, 0 or set of flags, left or entered of interrupts."""
    if kind is Kind.BUS:
        return value & 1 if what in ON_BUS else 0
    return 0 if kind is Kind.NOTE else min(value, 1)


class MomentListener(Listener):
    """Keeps time and value of every record of its kinds, 16 bytes each."""

    def __init__(self) -> None:
        self._topics: list[Topic] = []
        self._kept: list[tuple[array[int], array[int]]] = []

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(KINDS, self)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if kind not in KINDS:
            return UNHEARD
        self._topics.append((kind, where, what))
        self._kept.append((array("q"), array("q")))
        return len(self._topics) - 1

    def hear(self, tag: int, tick: int, value: int) -> None:
        ticks, values = self._kept[tag]
        ticks.append(tick)
        values.append(value)

    def moments(self) -> dict[Label, Ints]:
        """Ticks of each label, in the order in which they came."""
        found: dict[Label, Ints] = {}
        for (kind, where, what), (ticks, values) in zip(self._topics, self._kept, strict=True):
            if not ticks or (kind is Kind.FLAG and what.partition(".")[0] in DATA):
                continue
            stream, at = f"{where} {kind.value}", np.array(ticks, np.int64)
            told = np.array(values, np.int64)
            if kind is Kind.IRQ:
                for value, name in ((1, f"{what} entered"), (0, f"{what} left")):
                    found[Label(stream, name)] = at[told == value]
            elif kind is Kind.FLAG:
                for value in np.unique(told).tolist():
                    found[Label(stream, what, value)] = at[told == value]
            else:
                found[Label(stream, what)] = at
        return {label: at for label, at in found.items() if len(at)}

    def met(self) -> Met:
        """Return the sorts of each record that there were."""
        found: dict[Topic, frozenset[int]] = {}
        for (kind, where, what), (_, values) in zip(self._topics, self._kept, strict=True):
            found[kind, where, what] = frozenset(sort_of(kind, what, value) for value in set(values))
        return found

    def data(self) -> dict[str, Ints]:
        """Bytes by where they were seen: on the bus with their ACKs, and in each register of data, as it changed."""
        found: dict[str, Ints] = {}
        on_bus: dict[str, list[tuple[array[int], array[int]]]] = {}
        for (kind, where, what), kept in zip(self._topics, self._kept, strict=True):
            if kind is Kind.BUS and what in ON_BUS:
                on_bus.setdefault(where, []).append(kept)
            elif kind is Kind.FLAG and what.partition(".")[0] in DATA:
                found[f"{where}.{what}"] = np.array(kept[1], np.int64)
        for where, columns in on_bus.items():
            ticks = np.concatenate([np.array(at, np.int64) for at, _ in columns])
            values = np.concatenate([np.array(of, np.int64) for _, of in columns])
            found[f"{where} bytes"] = values[np.argsort(ticks, kind="stable")]
        return found
