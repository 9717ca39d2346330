"""GPIO pins with synchroniser, qualifier, multiplexer and output latch.

    pad --> synchroniser --> qualifier --+--> peripheral input (source, seen_at, changed)
     ^                                   +--> XINT line (changed)
     |                                   +--> GPxDAT read
     +-- gpio_out_delay <-- latch, DIR, MUX

The owner connects wires and peripherals to this chip. It calls `wire` for the pads that are connected to wires, and
`edges` when their levels change. Every other pad takes the level that this chip drives on it, or else that of its
pull-up, or else 0.

The file inputs.py has the paths from the pads to the levels inside the chip. The owner drives the output of a
peripheral on its pads (`sink`), `gpio_out_delay` cycles after the output or its multiplexer setting has changed.

Source: SPRUFB0D section 6, PCLKCR3 in section 5.1; SPRZ272N section 3.2 (qualifier).

Chosen:
- MUX, QSEL and CTRL take effect 2 cycles after the write. The manual gives this delay only as an example. DIR, PUD, the
  interrupt selects and the output latches take effect at once. An output reaches its pad `gpio_out_delay` cycles later.
- Register bits without a pin, and words between registers, read 0.
- GPIOLPMSEL and GPIOXNMISEL are only stored.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core import chip
from ...core.chip import NEVER
from ...core.options import IntOption
from ...core.state import State
from ...form.c_types import BigInt
from ..system_options import SystemOptions
from . import register_map as at
from .inputs import GpioInputs, Qualifier
from .register_map import BIT, PINS
from .settings import ALL

CONFIGURATION_DELAY = 2  # cycles from a write to MUX, QSEL or CTRL to its effect
CONFIGURES = ("CTRL", "QSEL1", "QSEL2", "MUX1", "MUX2")

HALVES = {  # maps each word offset to (register, lowest bit of the word in this register: 0 or 16)
    register.offset + shift // 16: (register, shift) for register in at.GPIO for shift in range(0, register.width, 16)
}
PADS = tuple(f"GPIO{n}" for n in range(PINS))
HALF_AT = BIT[::16]  # for each 16-bit word of GPxDAT, the mask of its lowest pin


@final
class Gpio(GpioInputs):
    """GPIO module."""

    STATE = State(
        "driven driven_high out_version routes_version _wired _latch",
        cycles="_waiting _outs",
        results="out_version routes_version",
    )
    INPUTS = PADS
    OUTPUTS = PADS

    def __init__(self, options: SystemOptions) -> None:
        super().__init__()
        # `processor.pin_router` reads the next two masks in place of `Chip.out`, which is too short for 88 pins.
        self.driven_high: BigInt = 0  # mask: levels of the pins in `driven`; 0 elsewhere
        self.driven: BigInt = 0  # mask: pads that this chip drives as general-purpose outputs
        self.out_version = 0  # number of changes of `driven_high` and `driven`
        # Option: cycles from a change of a latch or of a peripheral's output to the change of the pad.
        self.gpio_out_delay: IntOption = options.gpio_out_delay
        self.routes_version = 0  # number of times that MUX, QSEL or CTRL settings took effect or were reset
        self._wired: BigInt = 0  # mask: pads whose level the owner reports
        # Register values that take effect later: (cycle, register offset, value).
        self._waiting: list[tuple[int, int, int]] = []
        self._outs: list[tuple[int, int, int]] = []  # outputs that take effect later: (cycle, driven, driven_high)
        self.reset(0)

    # Pads and peripherals ----------------------------------------------------

    def wire(self, pads: BigInt) -> None:
        """Add pads to those whose levels the owner reports by `edges`. pads: mask; bit i is GPIOi."""
        self._wired |= pads

    def edges(self, now: int, levels: BigInt, exact: bool = True) -> None:
        """Set the levels of all wired pads. The owner calls this in place of the method `pins`, which other chips have.

        exact: True if the levels changed at the SYSCLKOUT edge of cycle `now`; False if they changed between this edge
        and the previous one.
        """
        if self.next_wake < now:
            self._advance(now - 1)
        moved = (levels ^ self.pads) & self._wired
        if moved:
            self._flip(now, moved, exact)
            if moved & self._sampled:
                self._plan()

    def peripheral_level(self, now: int, signal: str) -> int:
        """Return the level of an input signal in cycle `now`."""
        self._advance(now)
        return self._settings.level(signal, self._shown(now))

    def gate(self, now: int, on: bool) -> None:
        """Switch the clock of the input paths on or off in cycle `now` (PCLKCR3.GPIOINENCLK)."""
        self._advance(now)
        self._input_clock = on
        self._update_paths(now)
        self._report_xints(now)
        self._plan()

    def xint_levels(self, now: int) -> int:
        """Return the levels of the XINT lines in cycle `now` as a mask; bit 0 is XINT1."""
        self._advance(now)
        shown = self._shown(now)
        return sum((shown >> self._xint_pin(i) & 1) << i for i in range(len(at.XINT_SELECTS)))

    def watch_xints(self, now: int, lines: int) -> None:
        """Report in `changed`, from this call on, the changes of the XINT lines in the mask `lines` only."""
        levels = self.xint_levels(now)
        self._xints = self._xints & self._watching | levels & ~self._watching
        self._watching = lines
        self._update_paths(now)
        self._plan()

    # Interface of chips --------------------------------------------------------

    def wake(self, now: int) -> int:
        self._advance(now)
        return chip.ANY_CHANGED

    def peek(self, now: int, offset: int) -> int:
        self._advance(now)
        if at.DATA <= offset < at.SELECT:
            port, word = (offset - at.DATA) // at.DATA_WORDS, (offset - at.DATA) % at.DATA_WORDS
            return self._words(now)[2 * port + (word & 1)] if word < at.SET else 0
        half = HALVES.get(offset)
        if half is None:
            return 0
        register, shift = half
        return self._stored[register.offset] >> shift & 0xFFFF  # these registers have no write-only fields to mask

    def write(self, now: int, offset: int, value: int) -> None:
        self.writes += 1
        self._advance(now)
        half = HALVES.get(offset)
        if half is None:
            return
        if at.DATA <= offset < at.SELECT:
            self._write_data(offset - at.DATA, value & 0xFFFF)
            self._drive(now)
        else:
            register, shift = half
            stored = self._stored[register.offset]
            merged = stored & ~(0xFFFF << shift) | (value & 0xFFFF) << shift
            stored, _ = register.write(stored, merged)
            self._stored[register.offset] = stored
            if register.name[3:] in CONFIGURES:
                self._waiting.append((now + CONFIGURATION_DELAY, register.offset, stored))
            else:
                self._update_paths(now)
                self._drive(now)
                self._follow_drive(now)
        self._report_xints(now)
        self._plan()

    def reset(self, now: int) -> None:
        """Reset by XRS: all registers take their reset values at once. Wired pads keep their levels."""
        settings, shown = self._settings, self._shown(now)
        self.reset_settings(now)
        self._waiting.clear()
        self._outs.clear()
        self._latch: BigInt = 0
        self.reset_inputs()
        if self.driven:
            self.driven = self.driven_high = 0
            self.out_version += 1
        self._configure(now)
        self._follow_drive(now)
        self._report_signals(now, settings, shown)
        self._plan()

    # Timed events ------------------------------------------------------------

    def _advance(self, now: int) -> None:
        while self.next_wake <= now:
            self._step(self.next_wake)

    def _step(self, now: int) -> None:
        """Process everything due in cycle `now`: samples, then outputs, then new settings."""
        qualifier: Qualifier
        for pin, qualifier in self._qualifiers.items():
            if qualifier.due <= now:
                qualifier.advance(now)
                self._qualified ^= BIT[pin]
                signal = self._settings.signal_at.get(pin)
                if signal is not None:
                    self.changed.append((signal, qualifier.qualified))
        while self._outs and self._outs[0][0] <= now:
            _, self.driven, self.driven_high = self._outs.pop(0)
            self.out_version += 1
            self._follow_drive(now)
        if self._waiting and self._waiting[0][0] <= now:
            settings, shown = self._settings, self._shown(now)
            while self._waiting and self._waiting[0][0] <= now:
                _, offset, value = self._waiting.pop(0)
                self._active[offset] = value
            self._configure(now)
            self._drive(now)
            self._report_signals(now, settings, shown)
        if self._settle_at <= now:
            self._settle_at = NEVER
        self._report_xints(now)
        self._plan()

    def _plan(self) -> None:
        when: int = self._settle_at
        if self._outs:
            when = min(when, self._outs[0][0])
        if self._waiting:
            when = min(when, self._waiting[0][0])
        qualifier: Qualifier
        for qualifier in self._qualifiers.values():
            when = min(when, qualifier.due)
        self.next_wake = when

    # From registers to settings ----------------------------------------------

    def _configure(self, now: int) -> None:
        """Derive routes and input paths from the values of MUX, QSEL and CTRL that are in effect."""
        self.activate(now)
        self._update_paths(now)
        self.routes_version += 1

    # From latches to pads ----------------------------------------------------

    def _write_data(self, offset: int, word: BigInt) -> None:
        """Write one word of DAT, SET, CLEAR or TOGGLE. offset: the word offset from GPADAT."""
        port, place = divmod(offset, at.DATA_WORDS)
        which = place & ~1
        half = HALF_AT[2 * port + (place & 1)]
        bits = half * word & ALL
        if which == at.DAT:
            self._latch = self._latch & ~(half * 0xFFFF) | bits
        elif which == at.SET:
            self._latch |= bits
        elif which == at.CLEAR:
            self._latch &= ~bits
        else:
            self._latch ^= bits

    def _drive(self, now: int) -> None:
        """Derive the outputs from latch, DIR and MUX. A change reaches the pads after the output delay."""
        driven = self._outputs
        out = self._latch & driven
        last = self._outs[-1] if self._outs else (now, self.driven, self.driven_high)
        if (driven, out) == (last[1], last[2]):
            return
        delay = self.gpio_out_delay.assume(self.touched)
        when = now + delay
        # An access of 32 bits writes two words in one cycle. The write of the second word replaces the change that the
        # write of the first word has scheduled.
        if self._outs and last[0] == when:
            self._outs.pop()
        self._outs.append((when, driven, out))
        if not delay:
            self._outs.clear()
            self.driven, self.driven_high = driven, out
            self.out_version += 1
            self._follow_drive(now)

    def _follow_drive(self, now: int) -> None:
        """Update the level of each pad that is not wired.

        It is the level that this chip drives. If the chip does not drive the pad, it is 1 with a pull-up, else 0.
        """
        level = self.driven_high & self.driven | self._pull_ups & ~self.driven
        moved = (level ^ self.pads) & ~self._wired
        if moved:
            self._flip(now, moved, True)
