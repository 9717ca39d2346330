"""A user's own device on the bus: a `Target` that calls the hooks of a Python object. The object gets a `DeviceBus`.

    class Device:                        in the file that the case names: `model = "my_device.py"`
        def __init__(self, bus): ...     bus: a `DeviceBus`; (self, bus, settings) with a dataclass Settings in the file
        def on_address(self, read): ...  called at the device's address; return False for NACK
        def on_write(self, byte): ...    called with each received byte; return False for NACK
        def on_read(self): ...           return the next byte to send
        def on_stop(self): ...           called at a STOP while the device is addressed, not at a repeated START

on_write or on_read, or both, must exist. A device without on_write does not acknowledge its address for a write. A
device without on_read does not acknowledge its address for a read. If a hook returns a wrong value, the error message
names the line of the hook.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from random import Random

from ..core.chip import Note
from ..core.table import duration
from ..core.wire import Wire
from ..processor.user_code import FirmwareError, Misuse, UserCode, defined_at
from .targets import PlainReply, TargetContext


class DevicePin:
    """A wire, named in the case, that the device reads and drives with an open drain.

    level: the present level of the wire. A call of `drive` changes it only after the hook that made the call has
        returned. It is right at every instant, because every edge is simulated on a wire to which a device is attached.
        On other wires, the edges of a byte or frame may be skipped.
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
    """The environment of the device: time, the clock line, pins, notes and random numbers.

    random: the device's own generator of random numbers. It gives the same numbers in every run of a case.
    """

    def __init__(self, place: TargetContext, per_second: int, guard: UserCode) -> None:
        self.random: Random = place.random
        self._pins: dict[str, DevicePin] = {}
        self._guard = guard
        self._place = place
        self._per_second = per_second

    @property
    def now(self) -> Fraction:
        """Exact time in seconds since the run began."""
        return Fraction(self._place.kernel.now - self._place.start, self._per_second)

    def stretch(self, length: str) -> None:
        """Hold SCL low from now on for a length such as "20 us".

        The hooks on_address, on_write and on_read run just after a fall of SCL, so a call from them extends the low
        phase before the ACK bit (on_address, on_write) or before the first bit of the byte to send (on_read). In other
        functions, such as those given to `after`, SCL may be high. It then falls at once, also on an idle bus.
        """
        self._place.hold_clock(self._ticks(length))

    def after(self, length: str, callback: Callable[[], None]) -> None:
        """Call a function after a length of simulated time such as "1 ms"."""
        kernel = self._place.kernel

        def call() -> None:
            self._guard(callback)

        kernel.call_at(kernel.now + self._ticks(length), call)

    def pin(self, name: str) -> DevicePin:
        """Return this device's pin on the wire `name`, which a unit's `pins` must contain.

        Repeated calls return the same object. Raise Misuse if there is no such wire.
        """
        try:
            if name not in self._pins:
                self._pins[name] = DevicePin(self._place.wire(name), self._place.who)
            return self._pins[name]
        except ValueError as error:
            raise Misuse(str(error)) from None

    def note(self, text: str) -> None:
        """Add a sentence to the notes of the run, which its report lists."""
        self._place.note(Note("device", str(text), self._place.who))

    def _ticks(self, length: str) -> int:
        try:
            return self._place.ticks(duration(length))
        except ValueError as error:
            raise Misuse(str(error)) from None


HOOKS = {"on_address": 1, "on_write": 1, "on_read": 0, "on_stop": 0}  # number of arguments of each hook
NEEDED = ("on_write", "on_read")  # at least one of these hooks must exist


class PythonTarget(PlainReply):
    """A device that a Python object of the user emulates. `answer` returns this object itself as the reply.

    guard: the `UserCode` that calls the object's hooks and reports errors in them.
    make: a function that builds the object. It is called at the start, and again when power returns.
    """

    def __init__(self, guard: UserCode, address: int, make: Callable[[], object]) -> None:
        self.addresses = (address,)
        self._guard = guard
        self._make = make
        self.power_on()

    def power_on(self) -> None:
        device = self._guard(self._make)
        self._hooks: dict[str, Callable[..., object]] = {
            name: getattr(device, name) for name in HOOKS if hasattr(device, name)
        }

    def answer(self, address_byte: int) -> PythonTarget | None:
        if address_byte >> 1 not in self.addresses:
            return None
        read = bool(address_byte & 1)
        hook = "on_read" if read else "on_write"
        acked = self._acked("on_address", read) and hook in self._hooks
        return self if acked else None

    def receive_byte(self, byte: int, value: int) -> bool:
        return self._acked("on_write", value)

    def send_byte(self, byte: int) -> int:
        value = self._call("on_read")
        if not isinstance(value, int) or not 0 <= value <= 0xFF:
            raise self._wrong("on_read", value, "a byte, 0 to 0xFF")
        return int(value)

    def on_end(self, stop: bool, whole: bool) -> None:
        if stop:
            self._call("on_stop")

    def _acked(self, name: str, argument: object) -> bool:
        """Call a hook, and return True for ACK: the hook returned True or None, or the device has no such hook."""
        value = self._call(name, argument)
        if value is not None and not isinstance(value, bool):
            raise self._wrong(name, value, "True or False")
        return value is not False

    def _call(self, name: str, *arguments: object) -> object:
        hook = self._hooks.get(name)
        return None if hook is None else self._guard(hook, *arguments)

    def _wrong(self, name: str, value: object, expected: str) -> FirmwareError:
        at = defined_at(getattr(self._hooks[name], "__func__", self._hooks[name]))
        return FirmwareError(f"{self._guard.who}: {name}, {at}, returned {value!r}; expected {expected}")
