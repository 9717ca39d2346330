"""Settings of the GPIO control registers: routes, samplers and notes derived from MUX, QSEL and CTRL.

    stored --2 cycles--> active --activate--> routes, select, periods

Source: SPRUFB0D sections 6.4 to 6.6, Tables 42 to 49.
"""

# core: compiled

from __future__ import annotations

from functools import lru_cache

from ...core.chip import Chip, Note
from ...core.state import State
from ...form.c_types import BigInt
from . import register_map as at
from .register_map import PINS
from .routes import Routes, idle_level, note_for, routes_of

ALL = (1 << PINS) - 1
SYNCHRONISED_ONLY = 64  # this pin and all above: port C has no QSEL
GROUPS = 8  # of eight pins that share a sampling period
DIRECTIONS = tuple(at.GPIO[f"GP{port}DIR"].offset for port in "ABC")
PULL_UPS = tuple(at.GPIO[f"GP{port}PUD"].offset for port in "ABC")
CONTROLS = tuple(at.GPIO[f"GP{port}CTRL"].offset for port in "AB")

STEADY = tuple(  # all but GPxDAT, which shows the pads
    register.offset + word
    for register in at.GPIO
    for word in range(register.width // 16)
    if not register.name.endswith("DAT")
)


def _pairs(name: str, pins: int) -> tuple[tuple[int, int], ...]:
    """Return (register offset, shift) of the two bits of each pin in GPxMUXn or GPxQSELn."""
    places = ((port, half, i) for port in "ABC" for half in (1, 2) for i in range(16))
    first = list(places)[:pins]
    return tuple((at.GPIO[f"GP{port}{name}{half}"].offset, 2 * i) for port, half, i in first)


MUX = _pairs("MUX", PINS)
SELECT = _pairs("QSEL", SYNCHRONISED_ONLY)
CONFIGURED = tuple(dict.fromkeys(offset for offset, _ in MUX + SELECT))  # the registers of both
SAMPLES = {1: 3, 2: 6}  # QSEL: the required number of equal samples
ASYNCHRONOUS = 3  # QSEL
AT_RESET = {register.offset: register.reset for register in at.GPIO}


class PinSettings:  # core: python
    """Settings of all pins, from the values of the registers in CONFIGURED.

    mux: the multiplexer value of each pin, 0 to 3.
    sampled: (pin, samples) for each pin with a sampling qualifier.
    asynchronous: mask of the pins without synchronisation and qualification.
    """

    def __init__(self, values: tuple[int, ...]) -> None:
        value_at = dict(zip(CONFIGURED, values, strict=True))
        self.mux = tuple(value_at[offset] >> shift & 3 for offset, shift in MUX)
        select = [value_at[offset] >> shift & 3 for offset, shift in SELECT]
        self.routes = routes_of(self.mux)
        self.sampled = tuple((pin, SAMPLES[each]) for pin, each in enumerate(select) if each in SAMPLES)
        self.asynchronous = sum(1 << pin for pin, each in enumerate(select) if each == ASYNCHRONOUS)
        self._notes = [(pin, note) for pin, each in enumerate(self.mux) if (note := note_for(pin, each)) is not None]

    def new_notes(self, before: tuple[int, ...]) -> list[Note]:
        """Return the notes on pins whose multiplexer value has changed."""
        return [note for pin, note in self._notes if before[pin] != self.mux[pin]]


@lru_cache(maxsize=256)  # firmware sets its pins in the same steps in each scene
def pin_settings_of(values: tuple[int, ...]) -> PinSettings:
    """Return the settings for these register values, which units and scenes share."""
    return PinSettings(values)


class GpioSettings(Chip):
    """Registers by their offsets: their stored values and the values in effect."""

    STATE = State("_stored _active _periods", cycles="_origins")
    MAP = at.GPIO
    steady = STEADY

    def __init__(self) -> None:
        super().__init__()
        self._settings: PinSettings = pin_settings_of((0,) * len(CONFIGURED))
        self._routes: Routes = self._settings.routes

    def reset_registers(self) -> None:
        """Set all registers to their reset values; `activate` puts them into effect."""
        self.writes += 1
        self._stored = dict(AT_RESET)  # the values that a read returns
        self._active = dict(AT_RESET)  # the values in effect, for registers that act with a delay

    def restart_sampling(self, now: int) -> None:
        """Sample in every cycle, as after XRS."""
        self._periods: list[int] = [1] * GROUPS  # sampling period of each group of eight pins
        self._origins: list[int] = [now] * GROUPS  # and a cycle in which the group was sampled

    def restored(self) -> None:
        """Derive the settings from the restored registers."""
        self._settings = pin_settings_of(tuple([self._active[offset] for offset in CONFIGURED]))
        self._routes = self._settings.routes

    def activate(self, now: int) -> None:
        """Apply the active values at `now`."""
        active = self._active
        before, self._settings = self._settings, pin_settings_of(tuple([active[offset] for offset in CONFIGURED]))
        if self._settings.mux != before.mux:
            self._routes = self._settings.routes
            self.notes += self._settings.new_notes(before.mux)
            self._note_crowded(before.routes.crowded)
        self._apply_periods(now)

    def _note_crowded(self, before: dict[str, tuple[int, ...]]) -> None:
        for signal, pins in self._routes.crowded.items():
            if before.get(signal) != pins:
                names = " and ".join(f"GPIO{pin}" for pin in pins)
                text = f"{names} are all assigned to {signal}, so it is a constant {idle_level(signal)}; assign one pin"
                self.notes.append(Note("duty", text, "SPRUFB0D section 6.5, Table 46"))

    def _apply_periods(self, now: int) -> None:
        port: int
        for port, offset in enumerate(CONTROLS):
            control: int = self._active[offset]
            periods = [2 * (control >> 8 * i & 0xFF) or 1 for i in range(4)]
            if periods != self._periods[4 * port : 4 * port + 4]:
                self._periods[4 * port : 4 * port + 4] = periods
                self._origins[4 * port : 4 * port + 4] = [now] * 4

    def _ports(self, offsets: tuple[int, ...]) -> BigInt:
        """Combine one register per port into a mask of all pins."""
        pins = 0
        i: int
        for i, offset in enumerate(offsets):
            pins |= self._stored[offset] << 32 * i
        return pins & ALL
