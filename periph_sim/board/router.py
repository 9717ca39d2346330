"""Joins wires, the GPIO multiplexer and the peripherals of one F28335.

    wire edge --> pad --> (synchroniser, qualifier, MUX) --> peripheral input
    peripheral output, GPIO latch --> MUX --> pad --> wire

An asynchronous pin costs nothing here but the call: its edges go straight to the
peripheral, and the pads are told to the GPIO machine only when somebody reads them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ..core.kernel import Kernel
from ..core.socket import Socket
from ..core.time import Clock
from ..core.wire import Pin, Wire
from ..f28335.gpio import Gpio
from ..f28335.pin_table import INPUTS, OUTPUTS
from ..f28335.xint import Xint

Port = tuple[Socket, int]  # a peripheral and the index of one of its pins


class Pad:
    """One pad's way in. socket: the peripheral it feeds without any delay, or None."""

    __slots__ = ("_clock", "_n", "_router", "_watched", "index", "pin", "socket")

    def __init__(self, router: Router, n: int, clock: Clock) -> None:
        self._router = router
        self._n = n
        self._clock = clock
        self._watched = router.gpio_socket.watchers
        self.socket: Socket | None = None
        self.index = 0
        self.pin: Callable[[int, int, int], int] = router.gpio_socket.chip.pin

    def feed(self, socket: Socket, index: int) -> None:
        """From now on edges go straight to this input of this peripheral."""
        self.socket, self.index, self.pin = socket, index, socket.chip.pin

    def edge(self, tick: int, level: int) -> None:
        """The wire at this pad changed."""
        if self.socket is None or self._watched:
            self._router.edge(self._n, tick, level)
            return
        cycle = self._clock.cycle_at(tick)
        looks = self.pin(cycle, self.index, level)
        if looks:
            self.socket.publish(cycle, looks)

    def traced_edge(self, tick: int, level: int) -> None:
        """The same where causes are recorded: the peripheral keeps the edge as cause of what comes of it."""
        if self.socket is not None and not self._watched:
            self.socket.given(self._clock.cycle_at(tick) + self.socket.chip.filter_width)
        self.edge(tick, level)


class Router:
    """pads: GPIO number -> wire. inputs, outputs: signal of the pin table -> the peripheral's pin."""

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        gpio: Gpio,
        gpio_socket: Socket,
        who: str,
        pads: dict[int, Wire],
        inputs: dict[str, Port],
        outputs: dict[str, Port],
        xint: Socket | None,
    ) -> None:
        self._kernel = kernel
        self._clock = clock
        self._gpio = gpio
        self.gpio_socket = gpio_socket
        self._pads = pads
        self._inputs = inputs
        self._outputs = outputs
        self._pins: dict[int, Pin] = {n: wire.attach(f"{who}.GPIO{n}") for n, wire in pads.items()}
        self._feeds: dict[int, Port] = {}  # pin -> the peripheral it feeds
        self._xint = xint
        self._routes = -1
        self._outs = -1
        self._direct = {n: Pad(self, n, clock) for n in pads}
        for n, wire in pads.items():
            wire.watch(self._direct[n].traced_edge if gpio_socket.traces else self._direct[n].edge)
        for socket, _ in outputs.values():
            socket.out_delay = gpio.out_delay
        self._xint_chip: Xint | None = None
        self._lines = 0  # XINT lines that the GPIO machine reports
        if xint is not None:
            assert isinstance(xint.chip, Xint)
            self._xint_chip = xint.chip
            xint.before = self._listen
            xint.after = self._watch_lines
        gpio_socket.after = self.look
        gpio_socket.before = self.tell_pads
        self.look(clock.cycle_at(kernel.now))

    def leads_straight(self, wire: Wire, socket: Socket, index: int) -> bool:
        """Whether this wire's edges go to this input of a peripheral, at once, and nowhere else."""
        pads = [self._direct[n] for n, at in self._pads.items() if at is wire]
        return len(pads) == 1 and pads[0].socket is socket and pads[0].index == index

    @property
    def reads_pads(self) -> bool:
        """Somebody watches the pads' levels edge by edge."""
        return bool(self.gpio_socket.watchers)

    def edge(self, n: int, tick: int, level: int) -> None:
        """A wire changed at a pad that is synchronised, or whose level somebody reads."""
        clock = self._clock
        cycle = clock.cycle_at(tick)
        feed = self._feeds.get(n)
        exact = clock.tick(cycle) == tick
        seen = self._gpio.seen_at(cycle, n, exact)
        if feed is not None and seen == cycle:
            feed[0].pin(cycle, feed[1], level)
        self._gpio.pin(cycle, n, level, exact)
        self.gpio_socket.publish(cycle)
        if feed is not None and seen == cycle + 1:
            feed[0].later(clock.tick(seen), partial(feed[0].pin, seen, feed[1], level))

    def tell_pads(self, cycle: int) -> None:
        """The levels of the pads that were not told edge by edge."""
        for n, wire in self._pads.items():
            self._gpio.pin(cycle, n, wire.level)

    def look(self, cycle: int) -> None:
        """After each input of the GPIO machine: new routes, new levels on its outputs, qualified edges."""
        gpio = self._gpio
        if gpio.routes_version != self._routes:
            self._routes = gpio.routes_version
            self._reroute(cycle)
        if gpio.out_version != self._outs:
            self._outs = gpio.out_version
            self._drive()
        if gpio.changed:
            changed, gpio.changed = gpio.changed, []
            for signal, level in changed:
                if signal in self._inputs:
                    socket, index = self._inputs[signal]
                    socket.pin(cycle, index, level)
                elif self._xint is not None and signal.startswith("XINT"):
                    self._xint.pin(cycle, int(signal[4:]) - 1, level)

    def _listen(self, cycle: int) -> None:
        """Before an access to XINT: its lines as they are. Afterwards: hear of the edges of enabled ones only."""
        xint = self._xint_chip
        assert xint is not None
        self.tell_pads(cycle)
        xint.settle(cycle, self._gpio.xint_levels(cycle))

    def _watch_lines(self, cycle: int) -> None:
        assert self._xint_chip is not None
        if self._xint_chip.enabled != self._lines:
            self._lines = self._xint_chip.enabled
            self._gpio.watch_xints(cycle, self._lines)

    def _reroute(self, cycle: int) -> None:
        gpio = self._gpio
        self.tell_pads(cycle)
        self._feeds = {}
        for pad in self._direct.values():
            pad.socket = None
        for signal in INPUTS:
            if signal in self._inputs:
                socket, index = self._inputs[signal]
                pin = gpio.source(signal)
                if pin is not None:
                    self._feeds[pin] = (socket, index)
                    if pin in self._direct and gpio.seen_at(cycle, pin, exact=True) == cycle:
                        self._direct[pin].feed(socket, index)
                socket.pin(cycle, index, gpio.peripheral_level(cycle, signal))
        after = self._clock.tick(cycle + gpio.out_delay)
        self._kernel.at(max(after, self._kernel.now), self._reconnect)

    def _reconnect(self) -> None:
        """Outputs to the pins that are theirs now."""
        for signal in OUTPUTS:
            if signal in self._outputs:
                socket, index = self._outputs[signal]
                pins = [self._pins[n] for n in self._gpio.sink(signal) if n in self._pins]
                socket.connect(index, pins)
        self._drive()

    def _drive(self) -> None:
        """Pads that GPIO drives; all others but those of peripherals are let go."""
        gpio = self._gpio
        theirs = {n for signal in self._outputs for n in gpio.sink(signal)}
        for n, pin in self._pins.items():
            if n not in theirs:
                pin.drive(gpio.out >> n & 1 if gpio.driven >> n & 1 else 1)
