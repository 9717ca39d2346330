"""Settings of the GPIO control registers: routes, qualifiers and notes derived from MUX, QSEL and CTRL.

    stored value --2 cycles--> active value (in effect) --activate--> routes, qualifiers, periods

A route is the pin that feeds an input signal, or the pins that an output signal drives. A qualifier is a filter that
samples an input pin (`inputs.Qualifier`).

Source: SPRUFB0D sections 6.4 to 6.6, Tables 42 to 49.
"""

# core: compiled

from __future__ import annotations

from functools import lru_cache

from ...core.chip import Chip, Note
from ...core.state import State
from ...form.c_types import BigInt
from ..parts.f28335 import PART
from . import register_map as at
from .pin_mux_table import FUNCTIONS, IDLE_LOW, MODULES
from .register_map import BIT, PINS

# Names of the input and output signals of the modules that are modelled.
INPUTS = tuple(signal for module in PART.modules for signal in module.inputs or ())
OUTPUTS = tuple(signal for module in PART.modules for signal in module.outputs)


def function(pin: int, mux: int) -> str:
    """Return the function of the pin with GPxMUX = `mux`: "GPIO", a signal, or "" for a reserved value."""
    return FUNCTIONS[pin][mux - 1] if mux else "GPIO"


def idle_level(signal: str) -> int:
    """Return the level of an input when no pin, or more than one, is assigned to it (Table 46)."""
    return 0 if signal in IDLE_LOW else 1


def note_for(pin: int, mux: int) -> Note | None:
    """Return a note if a pin is set to a reserved value or assigned to a module that is not modelled."""
    name = function(pin, mux)
    if name == "GPIO" or name in INPUTS or name in OUTPUTS:
        return None
    if not name:
        return Note(
            "duty",
            f"GPIO{pin} is multiplexed to the reserved value {mux}; choose a value from the table",
            "SPRUFB0D section 6.5, note",
        )
    return Note(
        "unknown",
        f"GPIO{pin} is assigned to {name}, which is not modelled: the pin stays high-impedance",
        "SPRUFB0D Tables 47 to 49",
        joint=f"pins are assigned to {module_of(name)}, which is not modelled, and stay high-impedance",
        member=f"GPIO{pin} ({name})",
    )


def module_of(signal: str) -> str:
    """Return the manual's name of the module to which a signal belongs. signal: a signal of a module in MODULES."""
    return next(module for prefix, module in MODULES.items() if signal.startswith(prefix))


ALL = (1 << PINS) - 1
SYNCHRONISED_ONLY = 64  # number of the first pin of port C, whose pins have no QSEL
GROUPS = 8  # number of groups of eight pins that share a sampling period
DIRECTIONS = tuple(at.GPIO[f"GP{port}DIR"].offset for port in "ABC")
PULL_UPS = tuple(at.GPIO[f"GP{port}PUD"].offset for port in "ABC")
CONTROLS = tuple(at.GPIO[f"GP{port}CTRL"].offset for port in "AB")

STEADY = tuple(  # word offsets of all registers except GPxDAT, whose value changes with the pads
    register.offset + word
    for register in at.GPIO
    for word in range(register.width // 16)
    if not register.name.endswith("DAT")
)


def _pairs(name: str, pins: int) -> tuple[tuple[int, int], ...]:
    """Return where the two-bit field of each pin is: (register offset, lowest bit), for GPIO0 and up.

    name: "MUX" for the fields in GPxMUXn, "QSEL" for those in GPxQSELn. pins: number of pins.
    """
    places = ((port, half, i) for port in "ABC" for half in (1, 2) for i in range(16))
    first = list(places)[:pins]
    return tuple((at.GPIO[f"GP{port}{name}{half}"].offset, 2 * i) for port, half, i in first)


MUX = _pairs("MUX", PINS)
SELECT = _pairs("QSEL", SYNCHRONISED_ONLY)
CONFIGURED = tuple(dict.fromkeys(offset for offset, _ in MUX + SELECT))  # offsets of all MUX and QSEL registers
SAMPLES = {1: 3, 2: 6}  # for each value of QSEL that selects sampling, the required number of equal samples
ASYNCHRONOUS = 3  # value of QSEL that selects no synchronisation
AT_RESET = {register.offset: register.reset for register in at.GPIO}


class PinSettings:  # core: python
    """Settings of all pins. values: the values of the registers in CONFIGURED, in this order.

    mux: the multiplexer value of each pin, 0 to 3.
    sampled: (pin, required number of equal samples) for each pin with a qualifier.
    asynchronous: mask of the pins with QSEL = 3. Those that are not general-purpose have no synchronisation.
    notes: (pin, note) for each pin with a reserved multiplexer value or a function of a module that is not modelled.
    source: for each input signal, the pin that feeds it; None if none or more than one is assigned to it.
    sink: for each output signal, the pins that it drives.
    signal_at: for each pin that is the only one assigned to an input signal, this signal.
    crowded: for each input signal to which more than one pin is assigned, these pins.
    gpio: mask of the general-purpose pins.
    inputs: mask of the pins in `signal_at`.
    outputs: mask of the pins that a modelled module drives.
    """

    def __init__(self, values: tuple[int, ...]) -> None:
        value_at = dict(zip(CONFIGURED, values, strict=True))
        self.mux = tuple(value_at[offset] >> shift & 3 for offset, shift in MUX)
        select = [value_at[offset] >> shift & 3 for offset, shift in SELECT]
        self.sampled = tuple((pin, SAMPLES[each]) for pin, each in enumerate(select) if each in SAMPLES)
        self.asynchronous = sum(1 << pin for pin, each in enumerate(select) if each == ASYNCHRONOUS)
        self.notes = [(pin, note) for pin, each in enumerate(self.mux) if (note := note_for(pin, each)) is not None]
        given: dict[str, list[int]] = {}
        for pin, value in enumerate(self.mux):
            given.setdefault(function(pin, value), []).append(pin)
        fed = {signal: tuple(given.get(signal, ())) for signal in INPUTS}
        self.source = {signal: pins[0] if len(pins) == 1 else None for signal, pins in fed.items()}
        self.sink = {signal: tuple(given.get(signal, ())) for signal in OUTPUTS}
        self.signal_at = {pin: signal for signal, pin in self.source.items() if pin is not None}
        self.crowded = {signal: pins for signal, pins in fed.items() if len(pins) > 1}
        self.gpio = sum(BIT[pin] for pin in given.get("GPIO", ()))
        self.inputs = sum(BIT[pin] for pin in self.signal_at)
        self.outputs = sum(BIT[pin] for pins in self.sink.values() for pin in pins)

    def level(self, signal: str, shown: int) -> int:
        """Return the level of an input signal. shown: mask of the pins' levels after synchroniser and qualifier."""
        pin = self.source[signal]
        return idle_level(signal) if pin is None else shown >> pin & 1


@lru_cache(maxsize=256)  # a cache, because firmware often sets its pins to the same values in many scenes
def pin_settings_of(values: tuple[int, ...]) -> PinSettings:
    """Return the settings for these register values. Units and scenes with equal values share the result."""
    return PinSettings(values)


class GpioSettings(Chip):
    """Settings registers of the GPIO module: their stored values and the values in effect, by offset."""

    STATE = State("_stored _active _periods", cycles="_origins", grids={"_origins": "_periods"})
    MAP = at.GPIO
    steady = STEADY

    def __init__(self) -> None:
        super().__init__()
        self._settings: PinSettings = pin_settings_of((0,) * len(CONFIGURED))

    def reset_settings(self, now: int) -> None:
        """Set all registers to their reset values, and all sampling periods to one cycle. Call `activate` after it."""
        self.writes += 1
        self._stored = dict(AT_RESET)  # the values that a read returns, except for the data registers
        self._active = dict(AT_RESET)  # the values in effect; used only for MUX, QSEL and CTRL
        self._periods: list[int] = [1] * GROUPS  # sampling period of each group of eight pins
        # For each group, a cycle in which its pins are sampled. Its other samples are whole sampling periods before or
        # after this cycle.
        self._origins: list[int] = [now] * GROUPS

    def restored(self) -> None:
        """Derive the settings from the register values after a snapshot was restored."""
        self._settings = pin_settings_of(tuple([self._active[offset] for offset in CONFIGURED]))

    def activate(self, now: int) -> None:
        """Derive routes, qualifiers and periods from the active values, in effect from cycle `now` on."""
        before = self._settings
        self.restored()
        settings = self._settings
        if settings.mux != before.mux:
            self.notes += [note for pin, note in settings.notes if before.mux[pin] != settings.mux[pin]]
            for signal, pins in settings.crowded.items():
                if before.crowded.get(signal) != pins:
                    names = " and ".join([f"GPIO{pin}" for pin in pins])
                    self.note(
                        "duty",
                        f"{names} are all assigned to {signal}, so it is a constant {idle_level(signal)}; "
                        "assign one pin",
                        "SPRUFB0D section 6.5, Table 46",
                    )
        port: int
        for port, offset in enumerate(CONTROLS):
            control: int = self._active[offset]
            periods = [2 * (control >> 8 * i & 0xFF) or 1 for i in range(4)]
            if periods != self._periods[4 * port : 4 * port + 4]:
                self._periods[4 * port : 4 * port + 4] = periods
                self._origins[4 * port : 4 * port + 4] = [now] * 4

    def _ports(self, offsets: tuple[int, ...]) -> BigInt:
        """Return the stored values of three registers, one for each port, as one mask of all pins."""
        pins = 0
        i: int
        for i, offset in enumerate(offsets):
            pins |= self._stored[offset] << 32 * i
        return pins & ALL
