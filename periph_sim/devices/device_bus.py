"""The environment of a user's own device: time, the clock line, pins, notes and random numbers.

    class Device:                        a file beside the case, named by `model = "my_device.py"`
        def __init__(self, bus): ...     bus: a `DeviceBus`; (self, bus, settings) with a dataclass Settings in the file
        def on_address(self, read): ...  addressed: return False to leave it unacknowledged
        def on_write(self, byte): ...    a byte was received: return False to leave it unacknowledged
        def on_read(self): ...           return the byte to send
        def on_stop(self): ...           STOP, or the START that ends the transfer

Only on_write or on_read is mandatory.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from random import Random

from ..core.chip import Note
from ..core.settings import duration
from ..core.wire import Wire
from ..processor.user_code import Misuse, UserCode
from .targets import TargetContext


class DevicePin:
    """A wire of the case that the device reads, and drives with an open drain.

    The device is a party on the wire, so no byte or frame is skipped there, and the level is the present one.
    """

    def __init__(self, wire: Wire, who: str) -> None:
        self._wire = wire
        self._pin = wire.attach(who)

    @property
    def level(self) -> int:
        return self._wire.level

    def drive(self, level: int) -> None:
        """Pull the wire low (0) or release it (1)."""
        if level not in (0, 1):
            raise Misuse(f"drive was given {level!r}; expected 0 or 1")
        self._pin.drive(level)


class DeviceBus:
    """random: its own generator, equal in every run of one case."""

    def __init__(self, place: TargetContext, per_second: int, guard: UserCode) -> None:
        self.random: Random = place.random
        self._guard = guard
        self._place = place
        self._per_second = per_second

    @property
    def now(self) -> Fraction:
        """Seconds since the run began, exact."""
        return Fraction(self._place.kernel.now - self._place.start, self._per_second)

    def stretch(self, length: str) -> None:
        """Hold SCL low for a length such as "20 us". When a hook is called SCL has just fallen."""
        self._place.hold_clock(self._ticks(length))

    def after(self, length: str, callback: Callable[[], None]) -> None:
        """Call a function after a length such as "1 ms"."""
        kernel = self._place.kernel

        def call() -> None:
            self._guard(callback)

        kernel.call_at(kernel.now + self._ticks(length), call)

    def pin(self, name: str) -> DevicePin:
        """A pin of this device on a wire that a unit's `pins` name."""
        try:
            return DevicePin(self._place.wire(name), self._place.who)
        except ValueError as error:
            raise Misuse(str(error)) from None

    def note(self, text: str) -> None:
        """Show a sentence among the notes of the run."""
        self._place.note(Note("device", str(text), self._place.who))

    def _ticks(self, length: str) -> int:
        try:
            return self._place.ticks(duration(length))
        except ValueError as error:
            raise Misuse(str(error)) from None
