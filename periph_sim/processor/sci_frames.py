"""An F28335's SCI as its frames pass in two events: its socket goes in; how it hears them, and what it sends, come out.

    TXD  ~~|___|~~|___|~~~~~~|__|~~~~   the module's own edges: the first and the last; those between are taken from it
    wire  ~~|____________________|~~~~  later by the delay from output to pin
            ^ asked here         ^ over

See `bus.uart.whole_frames`.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Mapping
from typing import final

from ..bus.uart.whole_frames import FrameParty, FrameSender, WholeFrames
from ..core.kernel import CHIP, TIMER, Kernel
from ..core.socket import Release, Socket
from ..core.time import Clock
from ..core.wire import Pin, Wire
from ..f28335.sci.module import Sci
from ..form.c_types import BigInt
from .pin_router import Router

TXD_INDEX = 0  # among the module's outputs


@final
class SciHears(FrameParty):
    """socket: of the module. clock: SYSCLKOUT."""

    __slots__ = ("_chip", "_clock", "_socket")

    def __init__(self, socket: Socket, chip: Sci, clock: Clock) -> None:
        self._socket = socket
        self._chip = chip
        self._clock = clock

    def hears_whole(self, first: int, second: int, last: int) -> bool:
        clock = self._clock
        return self._chip.hears_whole(clock.cycle_at(first), clock.cycle_at(second), clock.cycle_at(last))

    def hears(self, tick: int, level: int) -> None:
        self._socket.sampled(tick, level)

    def untold(self, frames: WholeFrames | None) -> None:
        self._socket.untold = frames


@final
class PadsHear(FrameParty):
    """The GPIO machine of a unit, to whose pads a wire comes: it is told as a frame ends, or somebody is to look."""

    __slots__ = ("_level", "_pads", "_router", "_tick")

    _pads: BigInt

    def __init__(self, router: Router, wire: Wire) -> None:
        self._router = router
        self._pads = router.pads_of(wire)
        self._tick = self._level = 0

    def hears_whole(self, first: int, second: int, last: int) -> bool:
        return self._router.only_shows(self._pads)

    def hears(self, tick: int, level: int) -> None:
        self._tick, self._level = tick, level

    def untold(self, frames: WholeFrames | None) -> None:
        if frames is not None:
            self._level = 0
        elif self._level:
            self._router.moved(self._tick, self._pads, 1)


class SciSends(FrameSender):
    """lines: by wire, what frames pass through."""

    __slots__ = ("_chip", "_clock", "_cycles", "_frames", "_kernel", "_lines", "_socket")

    def __init__(
        self, kernel: Kernel, socket: Socket, chip: Sci, clock: Clock, lines: Mapping[str, WholeFrames]
    ) -> None:
        self._kernel = kernel
        self._socket = socket
        self._chip = chip
        self._clock = clock
        self._lines = lines
        self._frames: WholeFrames | None = None  # through which the frame under way passes
        self._cycles: list[int] = []  # in which the module would make the edges between
        socket.release = SciPin(self)

    def begins(self) -> None:
        """TXD's pin is about to fall."""
        chip, clock, pins = self._chip, self._clock, self._socket.pins[TXD_INDEX]
        coming = chip.coming_edges()
        if not coming or len(pins) != 1:
            return
        pin: Pin = pins[0]
        frames: WholeFrames | None = self._lines.get(pin.wire.name)
        if frames is None:
            return
        now = clock.cycle_at(self._kernel.now)
        last: int
        cycles, last = coming[:-1], coming[-1]
        delay = self._socket.out_delay
        if (cycles or coming)[0] <= now:
            return
        between = [clock.tick(cycle + delay) for cycle in cycles]
        if frames.passes(self, pin.mask, between, clock.tick(last + delay), TIMER if delay else CHIP):
            self._frames, self._cycles = frames, cycles
            chip.take_edges(now)
            self._socket.reclock()

    def ends(self) -> None:
        """TXD's pin is about to rise."""
        frames = self._frames
        if frames is not None:
            self._frames = None
            frames.over()

    def take_back(self, edges: list[int]) -> None:
        """Those that the module would have made by now are on their way to the pin, if they are not there."""
        self._frames = None
        kernel, clock, socket = self._kernel, self._clock, self._socket
        on_wire = len(self._cycles) - len(edges)
        now = clock.cycle_at(kernel.now)
        if clock.tick(now) > kernel.now or kernel._phase <= CHIP:
            now -= 1
        made: int = on_wire
        while made < len(self._cycles) and self._cycles[made] <= now:
            made += 1
            socket.move(self._cycles[made - 1], TXD_INDEX, made & 1)
        self._chip.give_back_edges(now, len(self._cycles) - made)
        socket._out = self._chip.out
        socket.reclock()


@final
class SciPin(Release):
    """TXD's pin."""

    __slots__ = ("_sends",)

    def __init__(self, sends: SciSends) -> None:
        self._sends = sends

    def pulls(self) -> None:
        self._sends.begins()

    def holds_back(self) -> bool:
        self._sends.ends()
        return False
