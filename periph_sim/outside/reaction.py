"""Calculation of the earliest tick at which a case may answer a move of the outside.

    events of the kernel                                          --+--> first tick at which pins of the case may move
    edges from `put`, not applied yet: at once, or after a filter --'

A case answers when one of its pins pulls a line low or releases it. These rules give the earliest tick:

- An I2C module that is not a master receives an edge after its noise filter, and an SCI receives it after its
  synchroniser.
- An I2C module does not answer in the middle of a byte. It states the number of further SCL edges to which it will not
  answer. The number is valid if all pulses pass the filter and SDA changes only while SCL is low.
- All other listeners are assumed to answer at once.
- Firmware moves a pin only when one of its writes arrives at a register, or when a read ends a stretch of SCL.

An external simulator that uses a session can run on its own up to this tick, as long as it moves no line.
"""

# core: compiled

from __future__ import annotations

from bisect import insort
from collections.abc import Sequence
from fractions import Fraction
from operator import itemgetter
from typing import TYPE_CHECKING, final

from ..core.chip import NEVER
from ..core.sampler import Sampler
from ..core.socket import WAKE, Socket
from ..core.time import Clock
from ..core.wire import Pin
from ..f28335.i2c.module import I2c
from ..f28335.i2c.register_map import SCL
from ..f28335.sci.module import Sci
from ..form.c_types import Text
from ..processor.pin_router import BETWEEN, Router
from ..processor.processor import Processor
from ..scene.scene import Scene

if TYPE_CHECKING:
    from ..core.agent import Event
    from ..core.kernel import Kernel
    from ..core.wire import Wire

LONG_AGO = -NEVER
REMEMBERED = 64  # number of past moves that are kept while `due` is not called
_tick = itemgetter(0)


@final
class Reaction:
    """Calculator of the earliest tick at which a pin of the case may move. Times are in ticks of the kernel.

    lines: the names of the lines that lead outside.
    """

    _kernel: Kernel
    _levels: dict[str, int]
    _seen: dict[str, int]

    def __init__(self, scene: Scene, lines: Sequence[str]) -> None:
        case = scene.case
        self._others = bool(case.chip or case.device or case.controller or case.fault or case.transceiver)
        self._kernel = scene.kernel
        self._wires = [scene.wires[name] for name in lines]
        # The sum of the wires' versions at the last update of the listeners. It grows when a wire's listeners change.
        self._version = -1
        self._clocks = {socket: dsp.clock for dsp in scene.units.values() for socket in dsp.sockets.values()}
        self._cpu_clocks = {dsp.processor: dsp.clock for dsp in scene.units.values()}
        self._chips = {
            dsp.processor: [socket.chip for socket in dsp.sockets.values() if isinstance(socket.chip, I2c)]
            for dsp in scene.units.values()
        }
        self._direct: list[Socket] = []  # modules that listen to the lines without a synchronised pad
        self._routers: list[Router] = []  # pin routers whose synchronised pads listen to the lines
        self._listening: list[Socket] = []  # listening modules whose inputs have a filter: I2C and SCI
        self._modules: list[tuple[Socket, I2c]] = []  # the I2C modules in `_listening`
        # Two lists for each module in `_modules`: the list of its SCL pins, followed by the list of its SDA pins.
        self._pins: list[list[Pin]] = []
        self._scl = self._sda = ""  # the lines at `_pins`; "" if there are none or the modules have different lines
        self._at_once = True  # True if a listener may answer at once, without the delay of an input filter
        self._now = scene.kernel.now  # the first tick that has not run yet
        self._levels = dict.fromkeys(lines, 1)  # levels of the lines before the moves in `_put`
        self._put: list[tuple[int, str, int]] = []  # moves (tick, line, level) in order of time
        self._fresh = False  # True if the attributes that `_look` computes are up to date
        self._due = NEVER
        # Number of further edges of SCL that cause no answer, under the conditions in the head of this file; -1 if any
        # edge of a line may cause one.
        self._silent = -1
        self._widest = 0  # length in ticks of the longest pulse that a filter may remove
        self._widest_of: list[tuple[int, Clock]] = []  # the filter widths and clocks from which `_widest` was computed
        self._hz: list[Fraction] = []  # frequencies of the clocks in `_widest_of` when `_widest` was computed
        self._seen = self._levels.copy()  # levels of the lines after all moves in `_put`, if `_fresh` is True
        self._scl_moved = LONG_AGO  # tick of the last edge of SCL among all moves; valid if `_silent` is not -1
        self._scl_done = LONG_AGO  # tick of the last edge of SCL among the moves that were applied to `_levels`

    def put(self, tick: int, line: Text, level: int) -> None:
        """Record that the outside moves a line at `tick`."""
        if self._put and tick < self._put[-1][0]:
            insort(self._put, (tick, line, level), key=_tick)
            self._fresh = False
            return
        self._put.append((tick, line, level))
        if self._fresh:
            self._weigh(tick, line, level)

    def advanced(self, now: int) -> None:
        """Record that the scene has run up to tick `now`, exclusive."""
        self._now = now
        self._fresh = False
        if len(self._put) > 2 * REMEMBERED:  # past moves remain because `due` is not called
            self._pass(len(self._put) - REMEMBERED)

    def due(self) -> int:
        """Return a tick before which no pin of the case moves if `put` is not called again; NEVER if no pin moves."""
        if not self._fresh:
            self._look()
        return self._due

    def _look(self) -> None:
        self._fresh = True
        self._listeners()
        self._lines()
        self._due = self._first_event()
        self._silent = -1
        if self._scl:
            self._silent = min([chip.silent_edges() for _, chip in self._modules])
            of = [(chip.filter_width, self._clocks[socket]) for socket, chip in self._modules]
            hz = [clock.hz for _, clock in of]
            if of != self._widest_of or hz != self._hz:
                self._widest_of, self._hz = of, hz
                self._widest = max([clock.tick(max(width, 1)) - clock.tick(0) for width, clock in of])
        if self._put:
            self._weigh_all()

    def _pass(self, most: int) -> None:
        """Remove up to `most` past moves and apply them to `_levels`."""
        done: int = 0
        tick: int
        level: int
        for tick, line, level in self._put:
            if tick >= self._now or done == most:
                break
            done += 1
            if line == self._scl and level != self._levels[line]:
                self._scl_done = tick
            self._levels[line] = level
        del self._put[:done]

    def _weigh_all(self) -> None:
        """Lower `_due` if the case can answer a present or future move in `_put` earlier.

        An answer is a pull or release of a line by a pin of the case. No answer comes before tick `_due`.
        """
        self._pass(len(self._put))
        self._seen = self._levels.copy()
        self._scl_moved = self._scl_done
        tick: int
        level: int
        for tick, line, level in self._put:
            self._weigh(tick, line, level)

    def _listeners(self) -> None:
        """Update the lists of the modules that listen to the lines, because firmware may have rerouted pins."""
        version: int = 0
        wire: Wire
        for wire in self._wires:
            version += wire.version
        if version != self._version:
            self._version = version
            agents = [ear.agent for wire in self._wires for ear in wire.listeners() if isinstance(ear, Sampler)]
            self._direct = [socket for socket in self._clocks if any(agent is socket for agent in agents)]
            self._routers = [agent for agent in dict.fromkeys(agents) if isinstance(agent, Router)]
        elif not self._routers:
            return
        fed = [router.fed() for router in self._routers]
        sockets = [*self._direct, *(socket for some in fed for socket in some or ())]
        self._listening = [socket for socket in dict.fromkeys(sockets) if isinstance(socket.chip, (I2c, Sci))]
        self._at_once = self._others or None in fed or len(self._listening) < len(set(sockets)) or not sockets
        self._modules = [(socket, socket.chip) for socket in self._listening if isinstance(socket.chip, I2c)]

    def _lines(self) -> None:
        """Update `_pins`, and the names of the lines to which the I2C modules are connected."""
        pins = [pins for socket, _ in self._modules for pins in (socket.pins.get(0, []), socket.pins.get(1, []))]
        if pins != self._pins:
            self._pins = pins
            scl, sda = ({pin.wire.name for some in pins[line::2] for pin in some} for line in (0, 1))
            self._scl, self._sda = (scl.pop(), sda.pop()) if len(scl) == len(sda) == 1 else ("", "")

    def _first_event(self) -> int:
        """Return the first tick at which one of the scheduled events may move a pin; NEVER if no event does so."""
        due = NEVER
        event = self._kernel.next_event()
        while event is not None and event.time < due:
            due = min(due, max(event.time, self._effect(event)))
            event = event.following
        return due

    def _effect(self, event: Event) -> int:
        """Return a tick before which this event does not move a pin."""
        agent = event.agent
        if isinstance(agent, Socket):
            socket: Socket = agent
            if event.tag == WAKE and isinstance(socket.chip, I2c):
                return _tick_of(self._clocks[socket], socket.chip.next_output() + socket.out_delay)
        elif isinstance(agent, Processor):
            processor: Processor
            processor, chips = agent, self._chips[agent]
            chip: I2c
            for chip in chips:
                if chip.target.pulls & SCL or chip.master.active:  # a register read may end a stretch at once
                    return event.time
            clock: Clock = self._cpu_clocks[processor]
            return _tick_of(clock, processor.next_output(clock.cycle_at(event.time)))
        elif isinstance(agent, Router) and event.tag & 1 == BETWEEN and not self._at_once:
            return self._answer(event.time)
        return event.time

    def _weigh(self, tick: int, line: Text, level: int) -> None:
        """If a listener can answer a move, lower `_due` to the tick of the earliest answer."""
        if level == self._seen[line]:
            return
        self._seen[line] = level
        if self._at_once:
            self._due = min(self._due, tick)
            return
        if self._silent >= 0:
            if line == self._scl:
                before, self._scl_moved = self._scl_moved, tick
                if tick - before <= self._widest:
                    # This edge of SCL ends a pulse that is so short that a filter may remove it. If a filter removes a
                    # low pulse, the module takes edges of SDA during the pulse as START or STOP. It can then answer
                    # from `before` on, which is the start of the pulse.
                    tick = max(before, self._now)
                elif self._silent:
                    self._silent -= 1
                    return
                self._silent = -1
            elif line == self._sda and not self._seen[self._scl] and tick != self._scl_moved:
                return
        self._due = min(self._due, self._answer(tick))

    def _answer(self, tick: int) -> int:
        """Return the earliest tick at which a module can answer a move of a line at `tick`."""
        first: int = NEVER
        chip: I2c
        for _, chip in self._modules:
            if chip.master.active:
                return tick
        socket: Socket
        for socket in self._listening:
            clock: Clock = self._clocks[socket]
            first = min(first, clock.tick(clock.cycle_at(tick) + socket.chip.filter_width + socket.out_delay))
        return max(tick, first)


def _tick_of(clock: Clock, cycle: int) -> int:
    return clock.tick(cycle) if cycle < NEVER else NEVER
