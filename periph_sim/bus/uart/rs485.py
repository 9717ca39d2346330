"""An RS-485 wire pair and the transceivers on it, whose drivers share the pair and are switched on and off.

    TX --> driver --on by DE--> pair --> receiver --> RX     (off while its own driver is on, unless `hears_itself`)

A pair without an active driver is idle: bias resistors hold it at 1. If several drivers are on at once, a 0 of any of
them wins. More than one active driver is a collision, whatever levels they drive.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.sampler import watch
from ...core.state import State
from ...core.time import NO_TIME
from ...core.wire import Wire
from .reader import Line, LineFrame, UartReader

COLLISION, CUT = "collision", "cut"  # records of a wire pair, besides those of the frames on it


class Rs485Pair:
    """A wire pair and the drivers that are on.

    on: the active drivers; the first one has been on longest.
    on_collision: called with (tick, names of the drivers that are on) when a driver is switched on while another is on.
    """

    STATE = State("on")

    def __init__(self, kernel: Kernel, recorder: Recorder, wire: Wire) -> None:
        self.kernel = kernel
        self.wire = wire
        self.on_collision: list[Callable[[int, tuple[str, ...]], None]] = []
        self._recorder = recorder
        self.on: list[Driver] = []

    def record(self, what: str, text: str) -> None:
        if self._recorder.wants(Kind.FRAME, self.wire.name):
            self._recorder.emit(self.kernel.now, Kind.FRAME, self.wire.name, what, 0, text)

    def switched(self, driver: Driver) -> None:
        """Handle a driver that was switched on or off."""
        if not driver.on:
            self.on.remove(driver)
            return
        self.on.append(driver)
        if len(self.on) > 1:
            who = tuple(one.who for one in self.on)
            self.record(COLLISION, " and ".join(who))
            for callback in self.on_collision:
                callback(self.kernel.now, who)


class Driver:
    """One party's driver on a wire pair, initially switched off."""

    STATE = State("on _level", ticks="_last_off _last_on")

    def __init__(self, pair: Rs485Pair, who: str) -> None:
        self.who = who
        self.on = False
        self._pair = pair
        self._pin = pair.wire.attach(who)
        self._level = 1
        self._last_on = self._last_off = NO_TIME

    def drive(self, level: int) -> None:
        self._level = level
        if self.on:
            self._pin.drive(level)

    def enable(self, on: bool) -> None:
        if on == self.on:
            return
        self.on = on
        if on:
            self._last_on = self._pair.kernel.now
        else:
            self._last_off = self._pair.kernel.now
        self._pin.drive(self._level if on else 1)
        self._pair.switched(self)

    def was_on(self, tick: int) -> bool:
        """Return True if `tick` is in the last period in which the driver was on. Earlier periods are not stored."""
        return self._last_on != NO_TIME and self._last_on <= tick and (self.on or tick < self._last_off)


class Transceiver:
    """One transceiver on a wire pair, with its lines TX, RX and DE.

    line: a function that returns the length of a bit in ticks, and the format of the frames on `tx`.
    hears_itself: True if the receiver stays on while the driver is on.
    at_first: 1 if the driver is on until the first change of DE, otherwise 0.
    on_cut: called with (tick, ticks) when the driver is switched off `ticks` before the end of a frame, and with
        (tick, 0) when a frame begins while the driver is off.
    """

    STATE = State("driver", ticks="_ends_at")

    def __init__(
        self, pair: Rs485Pair, who: str, tx: Wire, rx: Wire, de: Wire, line: Line, hears_itself: bool, at_first: int
    ) -> None:
        self.pair = pair
        self.driver = Driver(pair, who)
        self.on_cut: list[Callable[[int, int], None]] = []
        self.line = line
        self._hears_itself = hears_itself
        self._out = rx.attach(who)
        self._ends_at = NO_TIME  # the tick at which the present frame on TX ends; NO_TIME between frames
        self.driver.drive(tx.level)
        if at_first:
            self.driver.enable(True)
        reader = UartReader(tx, line)
        reader.on_begin.append(self._begins)
        reader.on_end.append(self._over)
        watch([tx], lambda tick, level: self.driver.drive(level))
        watch([de], self._turned)
        watch([pair.wire], lambda tick, level: self._hear())

    def _turned(self, tick: int, level: int) -> None:
        self.driver.enable(bool(level))
        self._hear()
        if not level and self._ends_at > tick:
            self._cut(self._ends_at - tick)

    def _begins(self, tick: int) -> None:
        bit, form = self.line()
        self._ends_at = tick + int(Fraction(form.length) * bit)
        if not self.driver.on:
            self._cut(0)

    def _over(self, frame: LineFrame) -> None:
        self._ends_at = NO_TIME

    def _cut(self, ticks: int) -> None:
        self.pair.record(CUT, self.driver.who)
        for callback in self.on_cut:
            callback(self.pair.kernel.now, ticks)

    def _hear(self) -> None:
        off = self.driver.on and not self._hears_itself
        self._out.drive(1 if off else self.pair.wire.level)
