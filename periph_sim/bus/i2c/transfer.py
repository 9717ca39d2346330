"""A transfer on an I2C bus: the request to a controller, and its result afterwards.

BusTiming                 a controller's clocking
Transfer --> Phases       START to STOP, divided by repeated STARTs
"""

# core: compiled

from __future__ import annotations

from typing import final

from msgspec import Struct

from ...core.state import State
from ...core.time import NO_TIME


class BusTiming(Struct, frozen=True):
    """The durations of a controller's timing, in ticks. filter: the controller ignores shorter levels of SDA."""

    low: int  # from the fall of SCL to its release
    high: int  # from the rise of SCL to its fall
    hold: int  # from the fall of SCL to the change of SDA
    start_hold: int  # from the fall of SDA to the fall of SCL, in a START
    start_setup: int  # from the rise of SCL to the fall of SDA, in a repeated START
    stop_setup: int  # from the rise of SCL to the rise of SDA, in a STOP
    free: int  # minimum time from a STOP to the next START
    filter: int = 0


@final
class Phase:
    """One addressed part of a transfer: START or repeated START, address, bytes.

    address: the 7-bit address, right-aligned.
    read: True if the R/W bit is 1.
    data: the bytes to write.
    count: the number of bytes to read.
    expect: the bytes that a read should return, or None if they are not compared.
    address_byte: a byte that is sent instead of address and R/W, for a general call or a START byte.

    Results:
    acked: True if the address was acknowledged.
    got: the bytes that were read.
    acks: for each data byte, True if the receiving side acknowledged it.
    start_at: the tick of the fall of SDA.
    answer_from: the tick of the fall of SCL after the acknowledge of the address.
    answer_at: the tick of the rise of SCL for the first data bit.
    stretch: the longest time for which another party held SCL low after the master's release of SCL.
    """

    STATE = State(
        "address read data count expect address_byte acked got acks stretch",
        ticks="start_at answer_from answer_at",
        made=True,
        expires="start_at answer_from answer_at",
    )

    __slots__ = (
        "acked",
        "acks",
        "address",
        "address_byte",
        "answer_at",
        "answer_from",
        "count",
        "data",
        "expect",
        "got",
        "read",
        "start_at",
        "stretch",
    )

    got: bytearray

    def __init__(
        self,
        address: int,
        read: bool,
        data: bytes = b"",
        count: int = 0,
        expect: bytes | None = None,
        address_byte: int | None = None,
        acked: bool = False,
        got: bytearray | None = None,
        start_at: int = NO_TIME,
        answer_from: int = NO_TIME,
        answer_at: int = NO_TIME,
        stretch: int = 0,
    ) -> None:
        self.address = address
        self.read = read
        self.data = data
        self.count = count
        self.expect = expect
        self.address_byte = address_byte
        self.acked = acked
        self.got = bytearray() if got is None else got
        self.acks: list[bool] = []
        self.start_at = start_at
        self.answer_from = answer_from
        self.answer_at = answer_at
        self.stretch = stretch


@final
class Transfer:
    """The phases between a START and its STOP, and their results.

    lost: True if the controller lost arbitration, or if it had to clear the bus before a repeated START, because the
        STOP of the bus clear ends the transfer.
    """

    STATE = State("name phases lost", ticks="stop_at", made=True, expires="stop_at")

    __slots__ = ("lost", "name", "phases", "stop_at")

    def __init__(self, name: str, phases: list[Phase], stop_at: int = NO_TIME, lost: bool = False) -> None:
        self.name = name
        self.phases = phases
        self.stop_at = stop_at
        self.lost = lost

    @property
    def acked(self) -> bool:
        """True if every address was acknowledged and the transfer was not lost."""
        acked = not self.lost
        phase: Phase
        for phase in self.phases:
            acked = acked and phase.acked
        return acked

    @property
    def wire_bytes(self) -> int:
        """The number of bytes on the wire so far. An address counts from its START, a data byte after its ACK bit."""
        count = 0
        for phase in self.phases:
            if phase.start_at != NO_TIME:
                count += 1 + len(phase.acks)
        return count
