"""The I2C module of an F28335 in bit skipping, as slave and as master of the bus.

Bit skipping simulates several bits of a byte in one step, if no party can observe the edges between them. A party is a
participant of the bus: a module, a device or a controller.

    out SCL  __|~~|__|~~|_ ... _|~~|_          output of the module, in cycles of SYSCLKOUT
    wire     ___|~~|__|~~|_ ... _|~~|_         later by the delay from output to pin
               ^ here a master tries to skip bits

`bus.i2c.bit_skip` decides when bits are skipped; `f28335.i2c.master` has the states of the master.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..bus.i2c.bit_skip import SKIPPED_BITS, BitParty, BitSkip, CycleTimes
from ..core.chip import PINS_CHANGED
from ..core.socket import PinReleaseGate, Socket
from ..core.time import Clock
from ..core.wire import Pin
from ..f28335.i2c.module import I2c
from ..f28335.i2c.register_map import SCL

MARGIN = 2  # cycles added to each required time, since an edge between two cycles is sampled at the later cycle


@final
class I2cModuleParty(BitParty):
    """The I2C module of a unit as a party whose bits can be skipped."""

    def __init__(self, socket: Socket, chip: I2c, clock: Clock) -> None:
        """socket: the socket of the module. clock: SYSCLKOUT of the unit."""
        self._socket = socket
        self._chip = chip
        self._clock = clock
        self._asking = False  # True while the module, as the master, tries to skip bits
        self._release_cause = 0  # the record that caused the release of SCL for the first skipped bit

    def act(self, tag: int) -> None:
        """End the skip: repeat the release of SCL for the first bit. The byte is then transferred edge by edge."""
        self._socket.reclock()
        self._socket.repeat_release(self._release_cause)

    # Methods of a party -----------------------------------------------------------

    def pulls(self, line: int) -> int:
        mask: int = 0
        pin: Pin
        for pin in self._socket.pins.get(0 if line == SCL else 1, []):
            mask |= pin.mask
        return mask

    def byte(self) -> int:
        return self._chip.byte_on_sda()

    def keeps_bus(self, shown: int) -> bool:
        return self._chip.master.keeps_bus(shown)

    def sda_follows_at(self, fall: int) -> int:
        chip, cycle = self._chip, self._clock.cycle_at(fall)
        if chip.master.active:
            return self._clock.tick(cycle + chip.state.tm)
        return self._clock.tick(cycle + chip.filter_width + self._socket.out_delay)

    def separates(self, fall: int, moved: int) -> bool:
        """Return True if two edges are at least one period of the module clock apart (option `unequal_arrival`).

        The module then samples them as separate events.

        fall: tick of the falling edge of SCL. moved: tick of the next change of SDA.
        """
        return self._clock.cycle_at(moved) - self._clock.cycle_at(fall) >= self._chip.state.tm

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        chip = self._chip
        if not chip.waits_for_byte(self._asking) or not self._socket.shows_output():
            return False
        width, module_clock = chip.filter_width, chip.state.tm
        if not width:
            return False
        # Each level must last longer than the width of the noise filter.
        # SDA must not change together with SCL, whether another party or this module drives SDA.
        apart = max(width, module_clock) + MARGIN
        low, high, hold = self._cycles(low), self._cycles(high), self._cycles(hold)
        own = width + self._socket.out_delay + MARGIN
        return (each or hold >= module_clock + MARGIN) and min(high, low - hold, low - own) >= apart

    def _cycles(self, ticks: int) -> int:
        """Return the largest number of cycles that is less than a time in ticks."""
        return self._clock.cycle_at(self._clock.tick(0) + ticks) - 1

    def set_bit_position(self, shown: int, bit: int, fell: int) -> None:
        self._chip.set_bit_position(shown, bit)
        self._socket.accept_output()

    # Methods of a master ------------------------------------------------------------

    def skips(self, bit_skip: BitSkip, times: CycleTimes) -> bool:
        """Try to skip bits of the byte that begins now. Return False if `BitSkip.skips_for` does."""
        master, delay = self._chip.master, self._socket.out_delay
        master.begin_skip(delay)
        release = master.skip_release
        times.since, times.low, times.high = release + delay, master.skip_low, master.skip_high
        ends = self._clock.tick(release + SKIPPED_BITS * (master.skip_low + master.skip_high))
        self._release_cause = self._socket.present_cause()
        self._asking = True
        skips = bit_skip.skips_for(self, times, self._clock.tick(master.skip_fell + delay), ends)
        self._asking = False
        if skips:
            self._socket.publish(release, PINS_CHANGED)  # schedules the wake-up for the eighth bit
        return skips


@final
class I2cMasterGate(PinReleaseGate):
    """Gate that holds the SCL pin low while bits that the module clocks are skipped."""

    def __init__(self, party: I2cModuleParty, chip: I2c, clock: Clock, bit_skip: BitSkip) -> None:
        self._party = party
        self._chip = chip
        self._bit_skip = bit_skip
        self._times = CycleTimes(clock)

    def holds_back(self) -> bool:
        bit = self._chip.master.released_bit()
        if bit == SKIPPED_BITS:
            self._bit_skip.over()
        return not bit and self._chip.only_clocks_byte() and self._party.skips(self._bit_skip, self._times)


def party_of(socket: Socket, clock: Clock, bit_skip: BitSkip, clocks: bool) -> I2cModuleParty:  # core: python
    """Return an I2C module as a party. clocks: True if the module, as a master, can skip bits that it clocks."""
    chip = socket.chip
    assert isinstance(chip, I2c)
    party = I2cModuleParty(socket, chip, clock)
    if clocks:
        socket.release = I2cMasterGate(party, chip, clock, bit_skip)
    return party
