"""A transfer on an I2C bus: what is asked of a controller goes in; what came of it stands beside it afterwards.

BusTiming                 how a controller clocks
Transfer --> Phases       START to STOP, and what lies between two STARTs
"""

from __future__ import annotations

from msgspec import Struct, field

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


class Phase(Struct):
    """One addressed part of a transfer: START or repeated START, address, bytes.

    address: the 7-bit address, right-aligned. data: the bytes to write, or what is
    expected of a read (compared, None where nothing is expected). count: bytes to read.
    """

    address: int
    read: bool
    data: bytes = b""
    count: int = 0
    expect: bytes | None = None
    address_byte: int | None = None  # sent instead of address and R/W (general call, START byte)
    # What came of it:
    acked: bool = False
    got: bytearray = field(default_factory=bytearray)
    acks: list[bool] = field(default_factory=list)  # of data bytes, whoever gave them
    start_at: int = NO_TIME  # SDA fell
    answer_from: int = NO_TIME  # SCL fell after the address's ACK
    answer_at: int = NO_TIME  # SCL rose for the first data bit
    stretch: int = 0  # longest time the other side held SCL low beyond `low`


class Transfer(Struct):
    """What happens between a START and its STOP, and what came of it."""

    name: str
    phases: list[Phase]
    stop_at: int = NO_TIME
    lost: bool = False  # arbitration lost

    @property
    def acked(self) -> bool:
        """True if every address was acknowledged."""
        return not self.lost and all(p.acked for p in self.phases)

    @property
    def wire_bytes(self) -> int:
        """Bytes on the wire, addresses included."""
        return sum(1 + len(p.acks) for p in self.phases if p.start_at != NO_TIME)
