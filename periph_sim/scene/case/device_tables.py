"""The tables of devices, their stretches and faults, and watched wires.

The tables [device.NAME] and [watch.NAME] have further keys, which depend on the model of the device or the kind of
watcher.
"""

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


class FaultTrigger(Table, frozen=True, kw_only=True):
    """The bytes that a stretch or a fault affects, and the time during which bytes are affected.

    bytes: numbers of affected bytes: `[3]`; 0 is the address; all if omitted
    access: affected accesses: `"read"`, `"write"` or `"any"`
    phases: numbers of affected phases: `[1, 4]`; all if omitted. A phase is a START with this address. Phases that
        match `access` are numbered from 1
    share: probability that each of these bytes is affected
    after: time from which bytes are affected
    until: time up to which bytes are affected; the end of the run if omitted
    """

    bytes: tuple[ByteNumber, ...] = ()
    access: Access = "any"
    phases: tuple[PhaseNumber, ...] = ()
    share: Share = Fraction(1)
    after: Duration = Fraction(0)
    until: Duration | None = None


class StretchTable(FaultTrigger, frozen=True, kw_only=True):
    """Clock stretching: SCL is held low before the ACK of a received byte or the first bit of a sent byte.

    A duration in place of this table holds SCL low for this time at every byte.

    length: duration or range of each hold
    """

    length: DurationRange


def _length_alone(value: object) -> object:
    return {"length": value} if isinstance(value, str) else value


STRETCH = Annotated[StretchTable, Before(_length_alone, DurationRange | StretchTable)]
# OWN maps each kind of fault to the keys that no other kind has.
OWN = {"nack": (), "wrong": ("value",), "flip": ("bit",), "hold": ("length", "clocks"), "off": ()}
WHICH_BYTES = ("bytes", "access", "phases", "share")  # the keys that a fault of kind "off" does not have


class DeviceFault(FaultTrigger, frozen=True, kw_only=True):
    """A fault of a device.

    kind: `"nack"`: a byte is neither acknowledged nor stored. `"wrong"`: `value` is sent. `"flip"`: one bit of a
        sent byte is wrong. `"hold"`: SDA is held low, beginning just before the ACK of a received byte or the first bit
        of a sent byte. `"off"`: no power from `after` to `until`, and volatile contents are lost.
    value: byte of `"wrong"`
    bit: wrong bit of `"flip"`, 7 to 0; random if omitted
    length: duration of `"hold"`
    clocks: number of SCL falls after which `"hold"` ends
    """

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
            raise ValueError("'until' is not later than 'after', so nothing would happen; make 'until' later")


class BusParty(Table, frozen=True, kw_only=True):
    """Keys of each chip and device.

    output_delay: time from an SCL fall to the SDA change
    stretch: clock stretching, `[device.NAME.stretch]`, or a duration for each byte: `"20 us"`
    fault: faults, `[[device.NAME.fault]]`
    """

    output_delay: Length = Fraction(300, 10**9)
    stretch: STRETCH | None = None
    fault: tuple[DeviceFault, ...] = ()


class DeviceTable(BusParty, frozen=True, kw_only=True):
    """A device on SDA and SCL. Its model adds keys.

    model: `"24c02"` to `"24lc512"`, `"isl12026"`, `"x1226"`, `"registers"`, or a `.py` file with your class
    address: 7 bits, right-aligned; memory 0x50, clock 0x6F if omitted
    """

    OTHERS = "own"

    model: str
    address: Address | None = None
    own: dict[str, Any] = {}  # the keys that the device's model adds


class WatchTable(Table, frozen=True, kw_only=True):
    """Expected edges of a wire, such as that of an LED. Its kind adds keys.

    Each watch makes a budget, which has the name of the watch and the measure `watch:NAME`. A missing or wrong edge
    breaks it.

    kind: `"edges"` or `"blink"`
    wire: a name in `pins`
    tolerance: largest deviation of an edge or period
    why: reason, shown with the verdict
    """

    OTHERS = "own"

    kind: str
    wire: str
    tolerance: Length
    why: str = ""
    own: dict[str, Any] = {}  # the keys that the watcher's kind adds
