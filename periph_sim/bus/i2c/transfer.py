"""A transfer on an I2C bus: what is asked of a controller goes in; what came of it stands beside it afterwards.

BusTiming                 how a controller clocks
Transfer --> Phases       START to STOP, and what lies between two STARTs
"""

# core: compiled

from __future__ import annotations

from typing import final

from msgspec import Struct

from ...core.time import NO_TIME


class BusTiming(Struct, frozen=True):
    """All in ticks; each what the controller does, not a limit. filter: a level of SDA that lasts less is not seen."""

    low: int  # SCL let go this long after it fell
    high: int  # SCL falls this long after it rose
    hold: int  # SDA changes this long after SCL fell
    start_hold: int  # SDA falls to SCL falls, START
    start_setup: int  # SCL rises to SDA falls, repeated START
    stop_setup: int  # SCL rises to SDA rises, STOP
    free: int  # STOP to the next START, at least
    filter: int = 0


@final
class Phase:
    """One addressed part of a transfer: START or repeated START, address, bytes.

    address: the 7-bit address, right-aligned. data: the bytes to write, or what is
    expected of a read (compared, None where nothing is expected). count: bytes to read.
    address_byte: sent instead of address and R/W (general call, START byte).

    What came of it: acked; got; acks, of data bytes, whoever gave them; start_at: SDA fell; answer_from: SCL fell after
    the address's ACK; answer_at: SCL rose for the first data bit; stretch: the longest time that the other side held
    SCL low beyond `low`.
    """

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
    """What happens between a START and its STOP, and what came of it. lost: arbitration."""

    __slots__ = ("lost", "name", "phases", "stop_at")

    def __init__(self, name: str, phases: list[Phase], stop_at: int = NO_TIME, lost: bool = False) -> None:
        self.name = name
        self.phases = phases
        self.stop_at = stop_at
        self.lost = lost

    @property
    def acked(self) -> bool:
        """True if every address was acknowledged."""
        return self.all_acked()

    @property
    def wire_bytes(self) -> int:
        """Bytes on the wire, addresses included."""
        count = 0
        for phase in self.phases:
            if phase.start_at != NO_TIME:
                count += 1 + len(phase.acks)
        return count

    def all_acked(self) -> bool:
        """As `acked`, to be called."""
        acked = not self.lost
        phase: Phase
        for phase in self.phases:
            acked = acked and phase.acked
        return acked
