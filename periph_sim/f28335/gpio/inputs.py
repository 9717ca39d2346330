"""Input paths from the GPIO pads to the levels inside the chip: synchroniser, qualifiers, XINT lines.

    pad --> synchroniser --> qualifier --+--> peripheral input (source, seen_at, changed)
                                         +--> XINT line (changed)
                                         +--> GPxDAT read

When the owner reports an edge at a pad, it passes `exact` and a cycle, `now`. If the edge at the pad coincides with a
SYSCLKOUT edge, exact is True, and `now` is the cycle of this SYSCLKOUT edge. If the edge at the pad is between two
SYSCLKOUT edges, exact is False, and `now` is the cycle of the later one.

A pin is synchronised if QSEL = 0, if QSEL = 3 and the pin is general-purpose, or if the pin is in port C. The level
inside the chip then follows at the first SYSCLKOUT edge after the edge at the pad. A pin of a peripheral with QSEL = 3
is asynchronous. The level then follows at the first SYSCLKOUT edge that coincides with the edge at the pad or comes
after it. `seen_at` returns this cycle, so that the owner can pass the edge to the peripheral without a wake-up of this
chip.

With QSEL = 1 or 2 the pin has a qualifier and is called sampled. `changed` reports the changes of an input signal that
a qualifier, new settings or a reset causes, and all changes of the XINT lines that the owner watches.

Source: SPRUFB0D section 6, PCLKCR3 in section 5.1.

Chosen:
- Each group of eight pins has a prescaler, which sets the times of its qualifiers' samples and counts from reset on. A
  change of GPxCTRL restarts the prescalers of its port.
- When QSEL selects sampling for a pin, the qualifier starts with the level that the pin has shown until then.
- If a peripheral's pin has QSEL = 3, GPxDAT and XINT also show the level of the pad without synchronisation.
- With GPIOINENCLK = 0, an output pin of port A or B (except GPIO32 and 33) reads 0, and so does an XINT line that
  selects it. When GPIOINENCLK is set again, the pin shows the level of its pad at once. If the pin has a qualifier, the
  qualifier starts from 0.
- GPIOINENCLK has no effect on a pin that feeds an input of a peripheral, even if the peripheral can also drive it, as
  the SPI does with its pins.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.state import State
from ...form.c_types import BigInt
from . import register_map as at
from .register_map import BIT
from .settings import ALL, DIRECTIONS, INPUTS, PULL_UPS, GpioSettings, PinSettings

DEPTH = 6  # the maximum number of samples that QSEL can require


@final
class Qualifier:
    """The qualifier of one pin. It changes its output when a number of samples in a row have the new level.

        level --> sample every `period` cycles --> `samples` equal ones in a row --> qualified

        period 2, 3 samples   sample     | | | | | |
                              level    ___/~~~~~~~~~
                              qualified________/~~~~

    Evaluation is lazy: samples are not taken one by one. Each call counts the samples since the previous call.

    The qualifier only counts equal samples. So it has the erratum of the silicon: with period n and m samples, a pulse
    of only n·(m - 1) + 1 cycles passes if m samples happen to be in it, although n·m cycles were intended.

    Source: SPRUFB0D section 6.4.3, Tables 42 to 45, Figure 46; SPRZ272N section 3.2.

    Chosen:
    - The output changes in the cycle of the last of the equal samples.
    - A change of the sampling period restarts the prescaler; a change between three and six samples keeps the samples
      already taken.

    level: the synchronised level. Samples before the creation of the qualifier count as equal to the initial level.
    period: cycles from one sample to the next.
    samples: number of equal samples in a row that changes the output.
    origin: a cycle in which a sample was taken.
    """

    STATE = State("level qualified _period _samples _sampled _run", cycles="due _origin _done", made=True)

    def __init__(self, now: int, level: int, period: int, samples: int, origin: int) -> None:
        self.level = level
        self.qualified = level  # the output
        # Cycle at which the output will change if the level stays. NEVER if the level is equal to the output.
        self.due = NEVER
        self._period = period
        self._samples = samples
        self._origin = origin
        self._sampled = level  # the last sample
        self._run = DEPTH  # number of equal samples in a row up to the last sample
        self._done = now  # samples have been taken up to and including this cycle

    def edge(self, now: int, level: int) -> None:
        """Set the synchronised level from cycle `now` on. A sample in that cycle takes this level."""
        self.advance(now - 1)
        self.level = level
        self._plan()

    def advance(self, now: int) -> None:
        """Take all samples up to and including cycle `now`."""
        if now <= self._done:
            return
        origin, period = self._origin, self._period
        taken = (now - origin) // period - (self._done - origin) // period
        self._done = now
        if not taken:
            return
        if self._sampled != self.level:
            self._sampled = self.level
            self._run = 0
        self._run = min(self._run + taken, DEPTH)
        if self._run >= self._samples:
            self.qualified = self._sampled
            self.due = NEVER

    def configure(self, now: int, period: int, samples: int, origin: int) -> None:
        """Set `period`, `samples` and `origin`, as in the docstring of the class, for samples after cycle `now`."""
        self.advance(now)
        self._period, self._samples, self._origin = period, samples, origin
        self._plan()

    def _plan(self) -> None:
        if self.level == self.qualified:
            self.due = NEVER
            return
        have = self._run if self._sampled == self.level else 0
        lacking = max(self._samples - have, 1)
        self.due = self._origin + ((self._done - self._origin) // self._period + lacking) * self._period


# Mask: the pins on which GPIOINENCLK has no effect: GPIO32, GPIO33 and port C.
NOT_GATED = 0b11 << 32 | ALL >> 64 << 64
WORDS = range(0, 32 * (at.SELECT - at.DATA) // at.DATA_WORDS, 16)  # lowest pin of each word; the last 2 have no pins


class GpioInputs(GpioSettings):
    """Pads and their input paths.

    pads: mask of the levels at the pads.
    watched: mask of the pins that feed an XINT line that the owner watches (`Gpio.watch_xints`).
    changed: list of (name, new level), one entry for each change since the owner last cleared the list. The name is
        that of an input signal, such as "SDAA", or of an XINT line, such as "XINT1".
    """

    STATE = State(
        "pads watched changed _before _qualifiers _qualified _watching _xints _asynchronous _sampled _dead _pull_ups "
        "_outputs _input_clock _last_words _last_level _last_pads _last_qualified _settles",
        cycles="_edge_at _settle_at",
        expires="_edge_at",
    )
    _last_pads: BigInt
    _last_qualified: BigInt

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """For comparisons of states, leave out `_before` if the last edges were in an earlier cycle.

        It has an effect only in the cycle of these edges. See `proof.normal_state`.
        """
        return {"_before": self._before if self._edge_at == cycle else None}

    def __init__(self) -> None:
        super().__init__()
        self.changed: list[tuple[str, int]] = []
        self.pads: BigInt = ALL & ~at.GPIO["GPAPUD"].reset  # initially the levels of the pull-ups
        self._edge_at = -1  # cycle of the last edges that were exactly on a SYSCLKOUT edge
        self._before: BigInt = 0  # mask: levels of the pads before the edges at `_edge_at`
        self._qualifiers: dict[int, Qualifier] = {}
        self._qualified: BigInt = 0  # mask: outputs of the qualifiers
        self._asynchronous: BigInt = 0
        self._sampled: BigInt = 0
        self._dead: BigInt = 0  # mask: pins whose input path GPIOINENCLK = 0 switches off, so that they read 0
        self._last_words: list[int] = []  # the most recently computed words of GPxDAT
        # Mask of synchronised levels from which `_last_words` was computed. None if it must be computed again.
        self._last_level: int | None = None
        self._last_pads = self._last_qualified = 0

    def reset_inputs(self) -> None:
        """Reset by XRS: all input paths are on, no pin has a qualifier, and no XINT line is watched."""
        self._watching = 0  # mask: XINT lines that the owner watches
        self._xints = 0  # mask: levels of the XINT lines as last reported
        self._input_clock = True  # value of PCLKCR3.GPIOINENCLK
        self._qualifiers.clear()
        self._settle_at = NEVER  # cycle at which the synchronised level of a pin in `_settles` changes; NEVER if none

    # Queries of the owner -----------------------------------------------------

    def moved_before(self, pads: BigInt) -> None:
        """Toggle the levels of these pads as if they had changed in an earlier cycle. No edge is evaluated.

        The owner can then peek at the registers as they would be with these levels. A second call undoes the first one.
        """
        self.pads ^= pads
        self._before ^= pads

    def seen_at(self, now: int, index: int, exact: bool) -> int:
        """Return the cycle at which an edge of a pad is seen inside the chip; NEVER if `changed` reports it instead.

        now, exact: the time of the edge, as the head of this file describes. index: the GPIO number of the pad.
        """
        bit = BIT[index]
        if self._sampled & bit:
            return NEVER
        return now if self._asynchronous & bit or not exact else now + 1

    def source(self, signal: str) -> int | None:
        """Return the pin that feeds an input signal; None if none or more than one is assigned to it."""
        return self._settings.source[signal]

    def sink(self, signal: str) -> tuple[int, ...]:
        """Return the pins that an output signal drives."""
        return self._settings.sink[signal]

    # From pads to levels ------------------------------------------------------

    def _flip(self, now: int, bits: BigInt, exact: bool) -> None:
        """Toggle the levels of the pads in the mask `bits`. now, exact: the time of these edges."""
        settling = self._settle_at <= now  # True if an edge in the previous cycle becomes visible now
        if not exact and self._edge_at == now:
            raise ValueError(f"an edge before cycle {now} was reported after one exactly on it; report edges in order")
        if exact and self._edge_at != now:
            self._edge_at = now
            self._before = self.pads
        self.pads ^= bits
        if bits & self._sampled:
            for pin, qualifier in self._qualifiers.items():
                if bits >> pin & 1 and not self._dead >> pin & 1:
                    qualifier.edge(now + 1 if exact else now, self.pads >> pin & 1)
        if exact and bits & self._settles:
            self._settle_at = now + 1
            self.next_wake = min(self.next_wake, now + 1)
        if settling or bits & self.watched:
            self._report_xints(now)

    def _synchronised(self, now: int) -> BigInt:
        return self._before if self._edge_at == now else self.pads

    def _shown(self, now: int) -> BigInt:
        """Return the mask of the levels after synchroniser and qualifier in cycle `now`."""
        level = self._synchronised(now) & ~self._asynchronous | self.pads & self._asynchronous
        return (level & ~self._sampled | self._qualified & self._sampled) & ~self._dead

    def _words(self, now: int) -> list[int]:
        """Return the levels of all pins in cycle `now` as the words of GPADAT, GPBDAT and GPCDAT, and two zeros."""
        level, pads, qualified = self._synchronised(now), self.pads, self._qualified
        if level is not self._last_level or pads is not self._last_pads or qualified is not self._last_qualified:
            self._last_level, self._last_pads, self._last_qualified = level, pads, qualified
            shown = self._shown(now)
            self._last_words = [shown >> shift & 0xFFFF for shift in WORDS]
        return self._last_words

    def _report_signals(self, now: int, settings: PinSettings, shown: BigInt) -> None:
        """Report in `changed` each input signal whose level has changed because routes or levels of pins changed.

        settings, shown: the settings before the change, and the mask that `_shown` returned before it.
        """
        shown_now = self._shown(now)
        if settings is self._settings and shown == shown_now:
            return
        for signal in INPUTS:
            level = self._settings.level(signal, shown_now)
            if level != settings.level(signal, shown):
                self.changed.append((signal, level))

    # XINT lines ---------------------------------------------------------------

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

    # Paths --------------------------------------------------------------------

    def _update_paths(self, now: int) -> None:
        """Compute the masks of pins by direction and input path. Create and delete qualifiers."""
        shown = self._shown(now)
        self._pull_ups: BigInt = ALL & ~self._ports(PULL_UPS)  # mask: pins whose pull-up is on
        self._outputs: BigInt = self._ports(DIRECTIONS) & self._settings.gpio  # mask: general-purpose outputs
        outputs = self._outputs | self._settings.outputs & ~self._settings.inputs
        self._dead = 0 if self._input_clock else outputs & ~NOT_GATED
        self._asynchronous = self._settings.asynchronous & ~self._settings.gpio
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
        self.watched: BigInt = 0  # mask: pins that feed a watched XINT line
        line: int
        for line in range(len(at.XINT_SELECTS)):
            if self._watching >> line & 1:
                self.watched |= BIT[self._xint_pin(line)]
        # Mask: pins that feed a peripheral and no watched XINT line. The owner passes their edges to the peripheral.
        forwarded = self._settings.inputs & ~self.watched
        # Mask: pins for which an edge with exact=True needs a wake-up in the next cycle.
        self._settles: BigInt = ALL & ~self._asynchronous & ~self._sampled & ~self._dead & ~forwarded
        if self._edge_at == now and (self.pads ^ self._before) & self._settles:
            self._settle_at = now + 1

    def _update_sampler(self, now: int, pin: int, samples: int, shown: int) -> None:
        """Set period and number of samples of a pin's qualifier. If there is none, create it with the level `shown`.

        If the input path of the pin is switched off, create it anew with the level 0.
        """
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
