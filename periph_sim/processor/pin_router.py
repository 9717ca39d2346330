"""Connections between wires, the GPIO multiplexer and the peripherals of one F28335.

    wires --> pads --> (synchroniser, qualifier, MUX) --> inputs of a peripheral, one sample a cycle
    peripheral output, GPIO latch --> MUX --> pad --> wire

A pad is a pin of the chip with its GPIO number. A pad without synchroniser and qualifier is asynchronous. If it feeds a
peripheral, its wire is an input of the peripheral (`Socket.inputs`), and the pad causes no events here: the GPIO module
receives the level only before an access, unless a subscriber needs the edges of the pad.
"""

# core: compiled

from __future__ import annotations

from ..core.agent import Agent
from ..core.chip import NEVER
from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.sampler import Sampler
from ..core.socket import Socket
from ..core.state import State
from ..core.time import NO_TIME, Clock
from ..core.wire import Pin, Wire
from ..f28335.gpio.module import Gpio
from ..f28335.gpio.register_map import BIT
from ..f28335.gpio.settings import OUTPUTS
from ..f28335.xint.module import Xint
from ..form.c_types import BigInt

Port = tuple[Socket, int]  # a peripheral, and the index of one of its inputs or outputs

# The lowest bit of an event's tag selects the call of `_between` or `_reconnect`. The other bits are the number of the
# record that is the cause of the event; 0 if there is none.
BETWEEN, RECONNECT = range(2)


class Router(Agent):
    """Connects the inputs and outputs of peripherals with the wires as the GPIO registers select.

    pads: the sampler of the pads whose edges the GPIO module receives.
    """

    STATE = State(
        "_pins _free_pins _direct _feeds pads _monitored _unread _routes _outs _lines",
        ticks="_between_at",
    )

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return the values that are compared in place of attributes; see `proof.normal_state`.

        These are the levels of the pads as the GPIO module would have them after an access, and the numbers of changes
        of routes and of outputs that are not applied yet.
        """
        gpio = self._gpio
        pads = gpio.pads ^ (self._levels_on_wires() ^ gpio.pads) & self._unread
        return {
            "_routes": gpio.routes_version - self._routes,
            "_outs": gpio.out_version - self._outs,
            "_gpio.pads": pads,
        }

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        recorder: Recorder,
        gpio: Gpio,
        gpio_socket: Socket,
        who: str,
        wires: dict[int, Wire],
        pulled_down: frozenset[int],
        inputs: dict[str, Port],
        outputs: dict[str, Port],
        xint: Socket | None,
    ) -> None:
        """who: the name of the unit. wires: the wires at the pads, by GPIO number.

        pulled_down: the GPIO numbers of pads that an external resistor holds low while nothing drives them.
        inputs, outputs: for each signal of the pin table, the input or output of its peripheral.
        xint: the module with the external interrupts; None if the unit does not have it.
        """
        self._kernel = kernel
        self._clock = clock
        self._recorder = recorder
        self._gpio = gpio
        self._gpio_socket = gpio_socket
        self._wires: dict[int, Wire] = wires
        self._undriven = {n: int(n not in pulled_down) for n in wires}  # level of each undriven pad
        self._inputs = inputs
        self._outputs = outputs
        self._pins: dict[int, Pin] = {n: wire.attach(f"{who}.GPIO{n}") for n, wire in wires.items()}
        self._free_pins: dict[int, Pin] = {}  # the pins of pads that no peripheral drives
        self._direct: set[str] = set()  # the input signals of peripherals that come from asynchronous pads
        self._feeds: dict[int, Port] = {}  # maps a pad with synchroniser, but no qualifier, to the input that it feeds
        self.pads = Sampler(kernel, recorder, self)
        self._line = {n: line for line, n in enumerate(wires)}  # maps a pad to its line in `pads`
        self._monitored: set[int] = set()  # the pads whose edges the GPIO module receives
        self._unread: BigInt = -1  # mask of the pads that are not in `_monitored`
        self._between_at = NO_TIME  # the tick of the next call of `_between`; NO_TIME if none is scheduled
        self._xint = xint
        self._routes = -1
        self._outs = -1
        for socket, _ in outputs.values():
            socket.out_delay = gpio.gpio_out_delay.unrecorded()
        self._xint_chip: Xint | None = None
        self._lines = 0  # mask of the XINT lines whose changes the GPIO module reports
        if xint is not None:
            assert isinstance(xint.chip, Xint)
            self._xint_chip = xint.chip
            xint.before = self._before_xint
            xint.after = self._watch_lines
        gpio.wire(sum(BIT[n] for n in wires))
        gpio_socket.after = self.look
        gpio_socket.before = self._pass_all_pads
        gpio_socket.on_peek = self._peek
        gpio_socket.on_watch = self._select_pads
        self.look(clock.cycle_at(kernel.now))

    def act(self, tag: int) -> None:
        if tag & 1 == RECONNECT:
            self._reconnect()
            return
        outer = self._recorder.cause
        self._recorder.cause = tag >> 1 or outer
        self._between()
        self._recorder.cause = outer

    # Pads ----------------------------------------------------------------------

    def _select_pads(self) -> None:
        """Select the pads to monitor: all, except asynchronous pads that feed a peripheral and have no subscriber."""
        direct = {self._gpio.source(signal) for signal in sorted(self._direct)}
        everything = bool(self._gpio_socket.watchers)
        monitored = {n for n in self._wires if everything or n not in direct or self._gpio.watched >> n & 1}
        for n in sorted(self._monitored - monitored):
            self.pads.put(self._line[n], self._wires[n].level)
        for n in sorted(monitored - self._monitored):
            self.pads.listen(self._line[n], self._wires[n])
        self._monitored = monitored
        self._unread = ~sum(BIT[n] for n in monitored)

    def sampled(self, tick: int, levels: int) -> None:
        """Pass changed pads to the GPIO module. A change between two SYSCLKOUT edges is passed at the later edge."""
        cycle = self._clock.cycle_at(tick)
        begin = self._clock.tick(cycle)
        if begin == tick:
            moved = self._pass_pads(cycle, self._levels_of(levels))
            fed = False
            for n in self._feeds:
                if moved >> n & 1:
                    fed = True
            if not fed:
                return
            begin = self._clock.tick(cycle + 1)  # the tick at which the output of a synchroniser changes
        self._plan_between(begin)

    def fed(self) -> list[Socket] | None:
        """Return the peripherals that receive edges through a synchroniser.

        Return None if an edge may have other effects: it is observed, or a qualifier delays it.
        """
        if self._gpio_socket.watchers or self._gpio.watched:
            return None
        if any(self._gpio.seen_at(0, n, exact=True) == NEVER for n in sorted(self._monitored)):
            return None
        return [socket for socket, _ in self._feeds.values()]

    def _plan_between(self, begin: int) -> None:
        if begin != self._between_at:
            self._between_at = begin
            self._kernel.schedule(begin, self, self._recorder.cause << 1 | BETWEEN)

    def _between(self) -> None:
        """Pass the levels just before this SYSCLKOUT edge to the peripherals, because the synchronisers sample them."""
        self._between_at = NO_TIME
        cycle, levels = self._clock.cycle_at(self._kernel.now), self._levels_of(self.pads.levels)
        self._pass_pads(cycle, levels, exact=False)
        socket: Socket
        index: int
        for n, (socket, index) in self._feeds.items():
            socket.inputs.put(index, levels >> n & 1)

    def _levels_of(self, lines: int) -> BigInt:
        """Return the levels of pads as a mask by GPIO number. lines: the same levels as a mask by line of `pads`."""
        levels = 0
        for n, line in self._line.items():
            if lines >> line & 1:
                levels |= BIT[n]
        return levels

    def _pass_pads(self, cycle: int, levels: BigInt, exact: bool = True) -> BigInt:
        """Pass the levels of the monitored pads to the GPIO module, and return the mask of those that have changed.

        exact: True if they changed at the SYSCLKOUT edge of this cycle, False if they changed before this edge.
        """
        gpio = self._gpio
        levels = levels & ~self._unread | gpio.pads & self._unread
        moved = levels ^ gpio.pads
        if moved:
            gpio.edges(cycle, levels, exact)
            self._gpio_socket.publish(cycle)
        return moved

    def _pass_all_pads(self, cycle: int) -> None:
        """Before an access, pass the levels of all pads to the GPIO module, also of pads that are not monitored."""
        self._kernel.materialize()
        self._gpio.edges(cycle, self._levels_on_wires())

    def _peek(self, cycle: int, offset: int) -> int:
        """Return a word of a GPIO register for the present levels of all pads. The GPIO module does not change."""
        gpio, unread = self._gpio, (self._levels_on_wires() ^ self._gpio.pads) & self._unread
        gpio.moved_before(unread)
        value = gpio.peek(cycle, offset)
        gpio.moved_before(unread)
        return value

    def _levels_on_wires(self) -> BigInt:
        levels = 0
        wire: Wire
        for n, wire in self._wires.items():
            if wire.level:
                levels |= BIT[n]
        return levels

    # Routes --------------------------------------------------------------------

    def look(self, cycle: int) -> None:
        """Apply changes that the GPIO module has made to routes, output levels and qualified inputs."""
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
                if signal in self._inputs and signal not in self._direct:
                    socket, index = self._inputs[signal]
                    socket.inputs.put(index, level)
                elif self._xint is not None and signal.startswith("XINT"):
                    self._xint.inputs.put(int(signal[4:]) - 1, level)

    def _before_xint(self, cycle: int) -> None:
        """Set the levels of all XINT lines before an access, since only enabled lines are monitored at other times."""
        assert self._xint is not None and self._xint_chip is not None
        self._pass_all_pads(cycle)
        levels = self._gpio.xint_levels(cycle)
        self._xint_chip.settle(cycle, levels)
        self._xint.inputs.levels = levels

    def _watch_lines(self, cycle: int) -> None:
        assert self._xint_chip is not None
        if self._xint_chip.enabled != self._lines:
            self._lines = self._xint_chip.enabled
            self._gpio.watch_xints(cycle, self._lines)
            self._select_pads()

    def _reroute(self, cycle: int) -> None:
        gpio = self._gpio
        self._pass_all_pads(cycle)
        self._direct.clear()
        self._feeds.clear()
        socket: Socket
        index: int
        for signal, (socket, index) in self._inputs.items():
            pad = gpio.source(signal)
            if pad in self._wires and gpio.seen_at(cycle, pad, exact=True) == cycle:
                self._direct.add(signal)
                socket.inputs.listen(index, self._wires[pad])
                continue
            if pad in self._wires and gpio.seen_at(cycle, pad, exact=True) == cycle + 1:
                self._feeds[pad] = (socket, index)
            socket.inputs.put(index, gpio.peripheral_level(cycle, signal))
        theirs = {n for signal in self._outputs for n in gpio.sink(signal)}
        self._free_pins = {n: pin for n, pin in self._pins.items() if n not in theirs}
        self._select_pads()
        if self._feeds:
            self._plan_between(self._clock.tick(cycle + 1))
        delay = gpio.gpio_out_delay.assume(gpio.touched) if theirs else gpio.gpio_out_delay.unrecorded()
        after = self._clock.tick(cycle + delay)
        self._kernel.schedule(max(after, self._kernel.now), self, RECONNECT)

    def _reconnect(self) -> None:
        """Connect the outputs of peripherals to the pins that the MUX selects."""
        self._kernel.materialize()
        for signal in OUTPUTS:
            if signal in self._outputs:
                socket: Socket
                index: int
                socket, index = self._outputs[signal]
                pins = [self._pins[n] for n in self._gpio.sink(signal) if n in self._pins]
                socket.connect(index, pins)
        self._drive()

    def _drive(self) -> None:
        """Drive the pads that GPIO drives. Give all others that no peripheral drives their undriven level."""
        driven, high = self._gpio.driven, self._gpio.driven_high
        pin: Pin
        for n, pin in self._free_pins.items():
            pin.drive(high >> n & 1 if driven >> n & 1 else self._undriven[n])
