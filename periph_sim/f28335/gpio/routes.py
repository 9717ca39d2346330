"""Routes derived from multiplexer values: the pin that feeds each input signal, the pins that each output drives.

    mux value of every pin  -->  Routes: source, sink, and the pins as bit masks

Source: SPRUFB0D section 6.5, Tables 46 to 49.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from ...core.chip import Note
from ..parts.f28335 import PART
from .pin_mux_table import FUNCTIONS, IDLE_LOW, MODULES

# Signals of the modules that are modelled.
INPUTS = tuple(signal for module in PART.modules for signal in module.inputs or ())
OUTPUTS = tuple(signal for module in PART.modules for signal in module.outputs)


def function(pin: int, mux: int) -> str:
    """Return the function of the pin with GPxMUX = `mux`: "GPIO", a signal, or "" for a reserved value."""
    return FUNCTIONS[pin][mux - 1] if mux else "GPIO"


def idle_level(signal: str) -> int:
    """Return the level of an input when no pin, or more than one, is assigned to it (Table 46)."""
    return 0 if signal in IDLE_LOW else 1


class Routes:
    """Routes of all pins. mux: one value 0 to 3 for each of the 88 pins."""

    def __init__(self, mux: Sequence[int]) -> None:
        self.source: dict[str, int | None] = {}
        self.sink: dict[str, tuple[int, ...]] = {}
        self.signal_at: dict[int, str] = {}  # pin -> the input signal that it alone feeds
        self.crowded: dict[str, tuple[int, ...]] = {}  # input signals with more than one pin
        given: dict[str, list[int]] = {}
        self.gpio = 0  # mask: pins that are general-purpose
        for pin, value in enumerate(mux):
            name = function(pin, value)
            if name == "GPIO":
                self.gpio |= 1 << pin
            else:
                given.setdefault(name, []).append(pin)
        for signal in INPUTS:
            pins = given.get(signal, [])
            self.source[signal] = pins[0] if len(pins) == 1 else None
            if len(pins) == 1:
                self.signal_at[pins[0]] = signal
            elif pins:
                self.crowded[signal] = tuple(pins)
        for signal in OUTPUTS:
            self.sink[signal] = tuple(given.get(signal, ()))
        self.inputs = sum(1 << pin for pin in self.signal_at)  # mask: pins that feed a modelled input
        self.outputs = sum(1 << pin for pins in self.sink.values() for pin in pins)  # mask: pins a module drives

    def level(self, signal: str, shown: int) -> int:
        """Return the level of an input signal for these levels of the pins, after their qualifiers."""
        pin = self.source[signal]
        return idle_level(signal) if pin is None else shown >> pin & 1


@lru_cache(maxsize=256)
def routes_of(mux: tuple[int, ...]) -> Routes:
    """Return the routes for these multiplexer values, which units and scenes share."""
    return Routes(mux)


def note_for(pin: int, mux: int) -> Note | None:
    """Return a note if a pin is set to a reserved value or assigned to a module that is not modelled."""
    name = function(pin, mux)
    if name == "GPIO" or name in INPUTS or name in OUTPUTS:
        return None
    if not name:
        text = f"GPIO{pin} is multiplexed to the reserved value {mux}; choose a value from the table"
        return Note("duty", text, "SPRUFB0D section 6.5, note")
    text = f"GPIO{pin} is assigned to {name}, which is not modelled: the pin stays high-impedance"
    joint = f"pins are assigned to {module_of(name)}, which is not modelled, and stay high-impedance"
    return Note("unknown", text, "SPRUFB0D Tables 47 to 49", joint, f"GPIO{pin} ({name})")


def module_of(signal: str) -> str:
    """Return the module of a signal of the pin table, with its name in the manual."""
    return next(module for prefix, module in MODULES.items() if signal.startswith(prefix))
