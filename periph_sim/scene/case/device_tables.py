"""The tables [device.NAME] and [watch.NAME], whose keys depend on a model or kind, and the tables of disturbances."""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import Annotated, Any, Literal

from msgspec import Meta

from ...core.convert import Before
from ...core.table import Duration, DurationRange, Share, Table
from .scalars import Address, Byte, Length

ByteNumber = Annotated[int, Meta(ge=0)]
PhaseNumber = Annotated[int, Meta(ge=1)]
Access = Literal["read", "write", "any"]


class Strikes(Table, frozen=True, kw_only=True):
    """The bytes that a stretch or a fault affects, and the time during which bytes are affected."""

    bytes: tuple[ByteNumber, ...] = ()
    access: Access = "any"
    phases: tuple[PhaseNumber, ...] = ()
    share: Share = Fraction(1)
    after: Duration = Fraction(0)
    until: Duration | None = None


class StretchTable(Strikes, frozen=True, kw_only=True):
    """Clock stretching: the bytes after which SCL is held low, and for how long.

    In a case file, a duration in place of this table means that SCL is held low for this time after every byte.
    """

    length: DurationRange


def _length_alone(value: object) -> object:
    return {"length": value} if isinstance(value, str) else value


STRETCH = Annotated[StretchTable, Before(_length_alone, DurationRange | StretchTable)]
OWN = {"nack": (), "wrong": ("value",), "flip": ("bit",), "hold": ("length", "clocks"), "off": ()}
WHICH_BYTES = ("bytes", "access", "phases", "share")  # the keys that a fault of kind "off" does not have


class DeviceFault(Strikes, frozen=True, kw_only=True):
    """A fault of a device: the kind of fault, the bytes and the time that it affects, and the keys of this kind."""

    kind: Literal["nack", "wrong", "flip", "hold", "off"]
    value: Byte | None = None
    bit: Annotated[int, Meta(ge=0, le=7)] | None = None
    length: Length | None = None
    clocks: Annotated[int, Meta(ge=1)] | None = None

    def check_together(self, given: Set[str]) -> None:
        others = {key for kind, keys in OWN.items() for key in keys} - set(OWN[self.kind])
        if self.kind == "off":
            others |= set(WHICH_BYTES)
        foreign = sorted(others & given)
        if foreign:
            raise ValueError(f"a fault of kind {self.kind!r} has no {' and no '.join(foreign)}; leave it out")
        if self.kind == "wrong" and self.value is None:
            raise ValueError("a wrong byte needs its value, value = 0xFF for instance")
        if self.kind == "hold" and (self.length is None) == (self.clocks is None):
            raise ValueError("SDA is held either for a length or for a number of clocks; give one of them")
        if self.kind in ("wrong", "flip") and (self.access == "write" or 0 in self.bytes):
            raise ValueError(f"a fault of kind {self.kind!r} is about bytes that the device sends, 1 and up of a read")
        if self.until is not None and self.until <= self.after:
            raise ValueError("until comes before after, so nothing would happen; make it later")


class BusParty(Table, frozen=True, kw_only=True):
    """Keys of each chip and device. output_delay: the time from a fall of SCL until the chip or device changes SDA."""

    output_delay: Length = Fraction(300, 10**9)
    stretch: STRETCH | None = None
    fault: tuple[DeviceFault, ...] = ()


class DeviceTable(BusParty, frozen=True, kw_only=True):
    """A device on the bus. model: a name in `devices.targets`, or a Python file. Each model adds keys of its own."""

    OTHERS = "own"

    model: str
    address: Address | None = None
    own: dict[str, Any] = {}  # the keys that the device's model adds


class WatchTable(Table, frozen=True, kw_only=True):
    """A watcher of a wire. kind: a name in `devices.watchers`. Each kind adds keys of its own."""

    OTHERS = "own"

    kind: str
    wire: str
    tolerance: Length
    why: str = ""
    own: dict[str, Any] = {}  # the keys that the watcher's kind adds
