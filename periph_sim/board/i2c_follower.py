"""An F28335's I2C module as a follower of SCL pulses: ticks and wires on one side, its cycles and pins on the other.

    Pulses --> cycles --> I2c.follow --> SDA's pin as it stands after the last pulse

It follows only where its pins lead straight to SCL and SDA of the bus and nobody looks at it edge by edge.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..core.wire import Wire
from ..f28335.i2c import SCL_PIN, SDA_PIN, I2c
from ..lines.i2c_pulses import Pulses
from .dsp import Dsp


class I2cFollower:
    def __init__(self, dsp: Dsp, scl: Wire, sda: Wire) -> None:
        self._socket = dsp.socket("I2C-A")
        chip = self._socket.chip
        assert isinstance(chip, I2c)
        self._chip = chip
        self._clock = dsp.clock
        self._router = dsp.router
        self._scl = scl
        self._sda = sda
        self._seen_wired = -1
        self._leads = False
        self._judged: tuple[int, ...] = ()
        self._fits = False

    def can_follow(self, pulses: Pulses) -> int:
        if not self._straight():
            return 0
        left = self._chip.pulses_left(self._clock.cycle_at(pulses.first))
        return left if left and self._slow_enough(pulses.high, pulses.low, pulses.hold, self._chip.filter_width) else 0

    def _slow_enough(self, *times: int) -> bool:
        """The filter lets every edge through, and an answer on SDA is out and seen before SCL rises again."""
        if times != self._judged:
            high, low, hold, width = self._judged = times
            through = self._ticks(width + 1)
            answered = through + self._ticks(self._socket.out_delay + 1)
            self._fits = high > through and low - through > max(hold, answered)
        return self._fits

    def sends(self, pulses: Pulses) -> Sequence[int]:
        return self._chip.sends(pulses.number)

    def follow(self, pulses: Pulses, sda: Sequence[int]) -> None:
        clock, socket = self._clock, self._socket
        last_fall = clock.cycle_at(pulses.fall(pulses.number - 1))
        self._chip.follow(last_fall, sda)
        socket.adopt_outputs()
        level = self._chip.out >> SDA_PIN & 1
        for pin in socket.pins[SDA_PIN]:
            pin.wire.skip_to(pin.mask, level)

    def _straight(self) -> bool:
        """Both lines lead to the module, and only to it, without anything in between."""
        if self._router is not None and self._router.reads_pads:
            return False
        if self._socket.wired != self._seen_wired:
            self._seen_wired = self._socket.wired
            self._leads = self._leads_straight(SCL_PIN, self._scl) and self._leads_straight(SDA_PIN, self._sda)
        return self._leads

    def _leads_straight(self, index: int, wire: Wire) -> bool:
        out = [pin.wire for pin in self._socket.pins[index]] == [wire]
        return out and (self._router is None or self._router.leads_straight(wire, self._socket, index))

    def _ticks(self, cycles: int) -> int:
        return self._clock.tick(cycles) - self._clock.tick(0)
