"""A user's own device on the bus: a `Target` around an object with hooks.

See `device_bus` for the hooks. Return values of hooks are checked: a wrong value is reported with the hook's place.
"""

from __future__ import annotations

from collections.abc import Callable

from ..bus.i2c.target_side import Stretches
from ..processor.user_code import FirmwareError, UserCode, defined_at

HOOKS = {"on_address": 1, "on_write": 1, "on_read": 0, "on_stop": 0}  # and their arguments
NEEDED = ("on_write", "on_read")  # at least one of them


class PythonTarget:
    """guard: calls the hooks. make: builds the user's object, again when power returns. It is its own reply."""

    ack = True
    stretches: Stretches = ()

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
        """Call a hook. False means NACK; True, or None, ACK."""
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
