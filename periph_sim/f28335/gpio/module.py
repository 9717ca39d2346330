"""GPIO pins with synchroniser, qualifier, multiplexer and output latch.

    pad --> synchroniser --> qualifier --+--> peripheral input (source, seen_at, changed)
     ^                                   +--> XINT line (changed)
     |                                   +--> GPxDAT read
     +-- out_delay <-- latch, DIR, MUX

The owner connects wires and peripherals to this chip. `edges` sets the levels of the pads that were
passed to `wire`; every other pad takes the level that this chip drives on it, or its pull-up.

An edge between two SYSCLKOUT edges is reported with the later of them as `now` and
exact=False; one that falls on a SYSCLKOUT edge with exact=True. A synchronised pin shows
it at the first SYSCLKOUT edge strictly after it, an asynchronous one at the first edge at
or after it: `seen_at` returns that cycle. So a pin that is synchronised or asynchronous
needs no wake-up to feed a peripheral; a sampled pin reports in `changed`, as does every
input signal whose level changes with a route or mode. A peripheral's output reaches the
pads in `sink` `gpio_out_delay` cycles after the output, or its route, has changed.

Source: SPRUFB0D section 6, PCLKCR3 in section 5.1; SPRZ272N section 3.2 (qualifier).

Chosen:
- MUX, QSEL and CTRL take effect 2 cycles after the write (the manual says "such as");
  DIR, PUD, the interrupt selects and the latches take effect at once. All outputs then
  reach the pad after `gpio_out_delay`.
- The qualifiers' prescalers count from reset, one per eight pins; a change of CTRL restarts
  those of the port.
- A pin's sampler starts when its QSEL selects one, from the level shown until then.
- With QSEL = 3 on a peripheral's pin, GPxDAT and XINT also see the pad's level.
- GPIOINENCLK = 0: an output pin of port A or B (not GPIO32, 33) reads 0, as do XINT lines
  on it; when switched on again, it shows the pad at once, and a sampler starts from 0.
- Bits of GPIO without a pin, and words between registers, read 0.
- GPIOLPMSEL and GPIOXNMISEL are only stored.
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING, final

from ...core import chip
from ...core.chip import NEVER
from ...core.registers import Register
from ...core.state import State
from ...form.c_types import BigInt
from ..system_options import SystemOptions
from . import register_map as at
from .qualifier import Qualifier
from .register_map import BIT, PINS
from .routes import INPUTS, Routes
from .settings import ALL, DIRECTIONS, PULL_UPS, GpioSettings

if TYPE_CHECKING:
    from ...core.options import IntOption

CONFIGURATION_DELAY = 2  # cycles from a write to MUX or QSEL to its effect
NOT_GATED = 0b11 << 32 | ALL >> 64 << 64  # GPIOINENCLK does not act on the I2C pins and port C
CONFIGURES = ("CTRL", "QSEL1", "QSEL2", "MUX1", "MUX2")

Half = tuple[Register, int]  # a register and the shift of its half


def _halves() -> dict[int, Half]:
    halves: dict[int, Half] = {}
    for register in at.GPIO:
        for shift in range(0, register.width, 16):
            halves[register.offset + shift // 16] = (register, shift)
    return halves


HALVES = _halves()
STORED = {offset: (register.offset, shift) for offset, (register, shift) in HALVES.items()}
WORDS = range(0, 32 * (at.SELECT - at.DATA) // at.DATA_WORDS, 16)  # their lowest pins
PADS = tuple(f"GPIO{n}" for n in range(PINS))
HALF_AT = BIT[::16]  # the lowest pin of each half of a port


@final
class Gpio(GpioSettings):
    """GPIO module.

    pads: mask of the levels at the pads.
    watched: mask of the pins that feed an XINT line that the owner watches.
    """

    STATE = State(
        "pads watched driven driven_high out_version routes_version changed _wired _before _qualifiers "
        "_qualified _watching _xints _latch _asynchronous _sampled _dead _pull_ups _outputs _input_clock "
        "_last_words _last_level _last_pads _last_qualified _settles",
        cycles="_edge_at _waiting _outs _settle_at",
    )
    INPUTS = PADS
    OUTPUTS = PADS
    pads: BigInt
    watched: BigInt
    driven: BigInt
    driven_high: BigInt
    gpio_out_delay: IntOption
    _wired: BigInt
    _before: BigInt
    _qualified: BigInt
    _latch: BigInt
    _asynchronous: BigInt
    _sampled: BigInt
    _dead: BigInt
    _pull_ups: BigInt
    _outputs: BigInt
    _settles: BigInt
    _last_pads: BigInt
    _last_qualified: BigInt
    LINES: tuple[str, ...] = ()

    def __init__(self, options: SystemOptions) -> None:
        super().__init__()
        self.filter_width = 0
        self.next_wake = NEVER
        self.out = 0  # a mask of a chip cannot hold 88 pins: the router reads these
        self.driven_high = 0  # mask: levels of the pins in `driven`; 0 elsewhere
        self.driven = 0  # mask: pads that this chip drives as general-purpose outputs
        self.out_version = 0  # counts changes of `driven_high` and `driven`
        self.gpio_out_delay = options.gpio_out_delay  # cycles from a latch or a peripheral's output to the pad
        self.routes_version = 0  # number of times that MUX, QSEL or CTRL settings took effect
        self.changed: list[tuple[str, int]] = []  # (signal or "XINTn", level) since the owner last cleared the list
        self.requests = 0
        self.held = 0
        self.touched: set[str] = set()

        self._wired = 0  # mask: pads whose level the owner reports
        self.pads = ALL & ~at.GPIO["GPAPUD"].reset  # mask: levels of the pads, initially the pull-ups
        self._edge_at = -1  # the cycle of the last exact edges
        self._before = 0  # the pads before those edges
        self._qualifiers: dict[int, Qualifier] = {}
        self._qualified = 0  # mask: output of the qualifiers
        self._waiting: list[tuple[int, int, int]] = []  # (when, register offset, value)
        self._outs: list[tuple[int, int, int]] = []  # (when, driven, out)
        self._watching: int  # mask: XINT lines that the owner watches
        self._xints: int  # mask: their levels as last reported
        self._asynchronous = 0
        self._sampled = 0
        self._dead = 0  # mask: pins whose input path is switched off
        self._last_words: list[int] = []  # the last value of the data registers
        self._last_level: int | None = None  # the levels that it was computed from; None after a change of paths
        self._last_pads = self._last_qualified = 0
        self.reset(0)

    # Pads and peripherals ----------------------------------------------------

    def wire(self, pads: BigInt) -> None:
        """Let the owner report the levels of the pads in this mask. ValueError if there is no such pad."""
        if pads & ~ALL:
            raise ValueError(f"there is no GPIO{pads.bit_length() - 1}; the pins are GPIO0 to GPIO{PINS - 1}")
        self._wired |= pads

    def edges(self, now: int, levels: BigInt, exact: bool = True) -> None:
        """Set the levels of all wired pads, in place of `pins`. exact: they changed on the SYSCLKOUT edge."""
        if self.next_wake < now:
            self._advance(now - 1)
        moved = (levels ^ self.pads) & self._wired
        if moved:
            self._flip(now, moved, exact)

    def moved_before(self, pads: BigInt) -> None:
        """Change the levels of pads whose edges were not reported, as of a cycle before the present one."""
        self.pads ^= pads
        self._before ^= pads

    def seen_at(self, now: int, index: int, exact: bool) -> int:
        """Return the cycle at which a pad edge is seen inside the chip; NEVER if it is reported in `changed`."""
        bit = BIT[index]
        if self._sampled & bit:
            return NEVER
        return now if self._asynchronous & bit or not exact else now + 1

    def source(self, signal: str) -> int | None:
        """Return the pin that feeds an input signal; None if none or more than one is assigned to it."""
        return self._routes.source[signal]

    def sink(self, signal: str) -> tuple[int, ...]:
        """Return the pins that an output signal drives."""
        return self._routes.sink[signal]

    def peripheral_level(self, now: int, signal: str) -> int:
        """Return the level of an input signal in cycle `now`."""
        self._advance(now)
        return self._routes.level(signal, self._shown(now))

    def pulled_up(self) -> BigInt:
        """Return the mask of the pins whose pull-up is on."""
        return self._pull_ups

    def gate(self, now: int, on: bool) -> None:
        """Switch the input clock: PCLKCR3.GPIOINENCLK takes effect in cycle `now`."""
        self._advance(now)
        self._input_clock = on
        self._update_paths(now)
        self._report_xints(now)
        self._plan()

    def xint_levels(self, now: int) -> int:
        """Return the mask of the levels on XINT1 (bit 0) to XINT7."""
        self._advance(now)
        shown = self._shown(now)
        return sum((shown >> self._xint_pin(i) & 1) << i for i in range(len(at.XINT_SELECTS)))

    def watch_xints(self, now: int, lines: int) -> None:
        """Report changes of the XINT lines in this mask in `changed`; the others are not evaluated."""
        levels = self.xint_levels(now)
        self._xints = self._xints & self._watching | levels & ~self._watching
        self._watching = lines
        self._update_paths(now)
        self._plan()

    # The chip's protocol -----------------------------------------------------

    def wake(self, now: int) -> int:
        self._advance(now)
        return chip.ANY_CHANGED

    def read(self, now: int, offset: int) -> int:
        return self.peek(now, offset)

    def peek(self, now: int, offset: int) -> int:
        self._advance(now)
        if at.DATA <= offset < at.SELECT:
            port, word = (offset - at.DATA) // at.DATA_WORDS, (offset - at.DATA) % at.DATA_WORDS
            return self._words(now)[2 * port + (word & 1)] if word < at.SET else 0
        stored = STORED.get(offset)
        if stored is None:
            return 0
        place, shift = stored
        return self._stored[place] >> shift & 0xFFFF  # the CPU reads all stored bits

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
        """Reset by XRS: registers take their reset values at once; wired pads keep their levels."""
        routes, shown = self._routes, self._shown(now)
        self.reset_registers()
        self._waiting.clear()
        self._outs.clear()
        self._latch = 0
        self._watching = self._xints = 0
        self._input_clock = True  # PCLKCR3.GPIOINENCLK
        self._qualifiers.clear()
        self.restart_sampling(now)
        self._settle_at = NEVER  # when a synchronised level that can be read changes
        if self.driven:
            self.driven = self.driven_high = 0
            self.out_version += 1
        self._configure(now)
        self._follow_drive(now)
        self._report_signals(now, routes, shown)
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
                signal = self._routes.signal_at.get(pin)
                if signal is not None:
                    self.changed.append((signal, qualifier.qualified))
        while self._outs and self._outs[0][0] <= now:
            _, self.driven, self.driven_high = self._outs.pop(0)
            self.out_version += 1
            self._follow_drive(now)
        if self._waiting and self._waiting[0][0] <= now:
            self._apply_settings(now)
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

    # From pads to levels -----------------------------------------------------

    def _flip(self, now: int, bits: BigInt, exact: bool) -> None:
        """Toggle the pads in `bits`."""
        settling = self._settle_at <= now  # an edge of the previous cycle, on any pin, shows now
        if not exact and self._edge_at == now:
            raise ValueError(f"an edge before cycle {now} was reported after one exactly on it; report edges in order")
        if exact and self._edge_at != now:
            self._edge_at = now
            self._before = self.pads
        self.pads ^= bits
        if bits & self._sampled:
            self._sample(now + 1 if exact else now, bits)
        if exact and bits & self._settles:
            self._settle_at = now + 1
            self.next_wake = min(self.next_wake, now + 1)
        if settling or bits & self.watched:
            self._report_xints(now)

    def _sample(self, now: int, bits: BigInt) -> None:
        for pin, qualifier in self._qualifiers.items():
            if bits >> pin & 1 and not self._dead >> pin & 1:
                qualifier.edge(now, self.pads >> pin & 1)
        self._plan()

    def _synchronised(self, now: int) -> BigInt:
        return self._before if self._edge_at == now else self.pads

    def _shown(self, now: int) -> BigInt:
        """Return the mask of the levels after synchroniser and qualifier in cycle `now`."""
        level = self._synchronised(now) & ~self._asynchronous | self.pads & self._asynchronous
        return (level & ~self._sampled | self._qualified & self._sampled) & ~self._dead

    def _words(self, now: int) -> list[int]:
        """Return these levels as the words of GPxDAT, 16 per word; recomputed only after a change."""
        level, pads, qualified = self._synchronised(now), self.pads, self._qualified
        if level is not self._last_level or pads is not self._last_pads or qualified is not self._last_qualified:
            self._last_level, self._last_pads, self._last_qualified = level, pads, qualified
            shown = self._shown(now)
            self._last_words = [shown >> shift & 0xFFFF for shift in WORDS]
        return self._last_words

    def _report_signals(self, now: int, routes: Routes, shown: BigInt) -> None:
        """Report in `changed` the inputs that differ from those of these routes with these levels at their pins."""
        shown_now = self._shown(now)
        if routes is self._routes and shown == shown_now:
            return
        for signal in INPUTS:
            level = self._routes.level(signal, shown_now)
            if level != routes.level(signal, shown):
                self.changed.append((signal, level))

    def _xint_pin(self, line: int) -> int:
        return self._stored[at.XINT_SELECTS[line]] + at.XINT_FIRST_PIN[line]

    def _report_xints(self, now: int) -> None:
        if not self._watching:
            return
        shown = self._shown(now)
        for i in range(len(at.XINT_SELECTS)):
            if self._watching >> i & 1:
                level = shown >> self._xint_pin(i) & 1
                if level != self._xints >> i & 1:
                    self._xints ^= 1 << i
                    self.changed.append((f"XINT{i + 1}", level))

    # From registers to settings ----------------------------------------------

    def _apply_settings(self, now: int) -> None:
        """Apply the writes to MUX, QSEL and CTRL that take effect now."""
        routes, shown = self._routes, self._shown(now)
        while self._waiting and self._waiting[0][0] <= now:
            _, offset, value = self._waiting.pop(0)
            self._active[offset] = value
        self._configure(now)
        self._drive(now)
        self._report_signals(now, routes, shown)

    def _configure(self, now: int) -> None:
        """Derive routes and paths from the active MUX, QSEL and CTRL."""
        self.activate(now)
        self._update_paths(now)
        self.routes_version += 1

    def _update_paths(self, now: int) -> None:
        """Compute the masks of directions and input paths; create and delete samplers."""
        shown = self._shown(now)
        self._pull_ups = ALL & ~self._ports(PULL_UPS)
        self._outputs = self._ports(DIRECTIONS) & self._routes.gpio  # general-purpose ones
        self._dead = 0 if self._input_clock else (self._outputs | self._routes.outputs) & ~NOT_GATED
        self._asynchronous = self._settings.asynchronous & ~self._routes.gpio
        self._last_level = None
        self._sampled = 0
        pin: int
        samples: int
        for pin, samples in self._settings.sampled:
            self._sampled |= BIT[pin]
            self._update_sampler(now, pin, samples, shown >> pin & 1)
        self._qualifiers = {pin: q for pin, q in self._qualifiers.items() if self._sampled >> pin & 1}
        self._qualified = 0
        qualifier: Qualifier
        for pin, qualifier in self._qualifiers.items():
            if qualifier.qualified:
                self._qualified |= BIT[pin]
        self.watched = 0  # mask: pins that feed a watched XINT line
        line: int
        for line in range(len(at.XINT_SELECTS)):
            if self._watching >> line & 1:
                self.watched |= BIT[self._xint_pin(line)]
        forwarded = self._routes.inputs & ~self.watched  # the owner itself passes their edges to the peripheral
        # An exact edge on these pins needs a wake-up.
        self._settles = ALL & ~self._asynchronous & ~self._sampled & ~self._dead & ~forwarded
        if self._edge_at == now and (self.pads ^ self._before) & self._settles:
            self._settle_at = now + 1

    def _update_sampler(self, now: int, pin: int, samples: int, shown: int) -> None:
        """Apply the active settings to the sampler of a pin; the sampler of a dead pin restarts from 0."""
        dead = self._dead >> pin & 1
        period, origin = self._periods[pin // 8], self._origins[pin // 8]
        qualifier: Qualifier | None = self._qualifiers.get(pin)
        if qualifier is None or dead:
            qualifier = Qualifier(now, 0 if dead else shown, period, samples, origin)
            self._qualifiers[pin] = qualifier
        qualifier.configure(now, period, samples, origin)
        level = self.pads >> pin & 1
        if not dead and qualifier.level != level:
            just_changed = self._edge_at == now and self._before >> pin & 1 != level
            qualifier.edge(now + 1 if just_changed else now, level)

    # From latches to pads ----------------------------------------------------

    def _write_data(self, offset: int, word: BigInt) -> None:
        """Write one half of DAT, SET, CLEAR or TOGGLE. offset: within the data registers."""
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
        """Schedule the pad levels after the output delay. Call after a change of latch, DIR or MUX."""
        driven = self._outputs
        out = self._latch & driven
        last = self._outs[-1] if self._outs else (now, self.driven, self.driven_high)
        if (driven, out) == (last[1], last[2]):
            return
        delay = self.gpio_out_delay.assume(self.touched)
        when = now + delay
        if self._outs and last[0] == when:  # the other half of the same access
            self._outs.pop()
        self._outs.append((when, driven, out))
        if not delay:
            self._outs.clear()
            self.driven, self.driven_high = driven, out
            self.out_version += 1
            self._follow_drive(now)

    def _follow_drive(self, now: int) -> None:
        """Set pads that are not wired to the level that this chip drives on them, or to their pull-up."""

        level = self.driven_high & self.driven | self._pull_ups & ~self.driven
        moved = (level ^ self.pads) & ~self._wired
        if moved:
            self._flip(now, moved, True)
