"""What a case says of the devices on its bus: [device.NAME] with its disturbances, and those that chips have too."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from ...core.settings import Duration, DurationRange, Share, Table
from .scalars import Address, Byte, Length

ByteNumber = Annotated[int, Field(ge=0)]
PhaseNumber = Annotated[int, Field(ge=1)]
Access = Literal["read", "write", "any"]


class Strikes(Table):
    """Which bytes a stretch or a fault strikes, and from when to when."""

    bytes: tuple[ByteNumber, ...] = ()
    access: Access = "any"
    phases: tuple[PhaseNumber, ...] = ()
    share: Share = Fraction(1)
    after: Duration = Fraction(0)
    until: Duration | None = None


class StretchTable(Strikes):
    """Which bytes are stretched, and for how long. A text is a length alone: each byte, the address too."""

    length: DurationRange


def _length_alone(value: object) -> object:
    return {"length": value} if isinstance(value, str) else value


STRETCH = Annotated[StretchTable, BeforeValidator(_length_alone, json_schema_input_type=DurationRange | StretchTable)]
OWN = {"nack": (), "wrong": ("value",), "flip": ("bit",), "hold": ("length", "clocks"), "off": ()}
WHICH_BYTES = ("bytes", "access", "phases", "share")  # an outage strikes them all


class DeviceFault(Strikes):
    """A way in which a device is faulty: `kind`, when, and the keys of that kind."""

    kind: Literal["nack", "wrong", "flip", "hold", "off"]
    value: Byte | None = None
    bit: Annotated[int, Field(ge=0, le=7)] | None = None
    length: Length | None = None
    clocks: Annotated[int, Field(ge=1)] | None = None

    @model_validator(mode="after")
    def _keys_of_its_kind(self) -> DeviceFault:
        others = {key for kind, keys in OWN.items() for key in keys} - set(OWN[self.kind])
        if self.kind == "off":
            others |= set(WHICH_BYTES)
        foreign = sorted(others & self.model_fields_set)
        if foreign:
            raise ValueError(f"a fault of kind {self.kind!r} has no {' and no '.join(foreign)}; leave it out")
        if self.kind == "wrong" and self.value is None:
            raise ValueError("a wrong byte needs its value, value = 0xFF for instance")
        if self.kind == "hold" and (self.length is None) == (self.clocks is None):
            raise ValueError("SDA is held either for a length or for so many clocks; give one of them")
        if self.kind in ("wrong", "flip") and (self.access == "write" or 0 in self.bytes):
            raise ValueError(f"a fault of kind {self.kind!r} is about bytes that the device sends, 1 and up of a read")
        if self.until is not None and self.until <= self.after:
            raise ValueError("until comes before after, so nothing would happen; make it later")
        return self


class BusParty(Table):
    """What every target on SDA and SCL may be given. output_delay: UM10204 section 3.1.1, hold time of its own SDA."""

    output_delay: Length = Fraction(300, 10**9)
    stretch: STRETCH | None = None
    fault: tuple[DeviceFault, ...] = ()


class DeviceTable(BusParty):
    """A device of `devices.targets`, or of a Python file. Its model has keys of its own, which stand beside these."""

    model_config = ConfigDict(extra="allow", arbitrary_types_allowed=True, frozen=True)

    model: str
    address: Address | None = None

    @property
    def own(self) -> dict[str, Any]:
        """The keys that are its model's."""
        return dict(self.model_extra or {})
