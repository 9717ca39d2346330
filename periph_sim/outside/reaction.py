"""How soon a case may answer: what its kernel will do and edges put but not done yet go in, a tick comes out.

    events of the kernel            --+--> the first tick at which a pin of ours may move
    edges: at once, or behind a filter'

An I2C module that is no master knows of an edge only behind its noise filter, and an SCI behind its synchroniser. In
the middle of a byte nobody can tell even then that an edge came: the module says of how many that is so, and as long as
they come far enough apart, and SDA moves as SCL is low, there is no answer to them. Whoever else listens is taken to
answer at once. What a program does moves a pin once a write of it has reached a register.
"""

# core: compiled

from __future__ import annotations

from bisect import insort
from collections.abc import Sequence
from fractions import Fraction
from operator import itemgetter
from typing import TYPE_CHECKING, final

from ..core.chip import NEVER
from ..core.kernel import Agent, Event
from ..core.socket import WAKE, Socket
from ..core.time import Clock
from ..core.wire import Pin, Sampler
from ..f28335.i2c.module import I2c
from ..f28335.i2c.register_map import SCL
from ..f28335.sci.module import Sci
from ..form.c_types import Text
from ..processor.pin_router import BETWEEN, Router
from ..processor.processor import Processor
from ..scene.scene import Scene

if TYPE_CHECKING:
    from ..core.kernel import Kernel
    from ..core.wire import Wire

LONG_AGO = -NEVER
REMEMBERED = 64  # edges, where nobody asks
_tick = itemgetter(0)


@final
class Reaction(Agent):
    """Ticks are the kernel's. lines: that lead outside."""

    _kernel: Kernel
    _mark: Event
    _levels: dict[str, int]
    _seen: dict[str, int]

    def __init__(self, scene: Scene, lines: Sequence[str]) -> None:
        case = scene.case
        self._others = bool(case.chip or case.device or case.controller or case.fault or case.transceiver)
        self._kernel = scene.kernel
        self._mark = scene.kernel.ask(scene.kernel.now, self)
        scene.kernel.cancel(self._mark)
        self._wires = [scene.wires[name] for name in lines]
        self._version = -1  # the sum of theirs, which only grow
        self._clocks = {socket: dsp.clock for dsp in scene.units.values() for socket in dsp.sockets.values()}
        self._cpu_clocks = {dsp.processor: dsp.clock for dsp in scene.units.values()}
        self._chips = {
            dsp.processor: [socket.chip for socket in dsp.sockets.values() if isinstance(socket.chip, I2c)]
            for dsp in scene.units.values()
        }
        self._direct: list[Socket] = []  # modules that listen, but for those behind synchronised pads:
        self._routers: list[Router] = []
        self._listening: list[Socket] = []  # all who listen, if each of them does so behind a filter
        self._modules: list[tuple[Socket, I2c]] = []  # those that are I2C modules
        self._pins: list[list[Pin]] = []  # of SCL and SDA of each
        self._scl = self._sda = ""  # their lines; "" if there are none, or several
        self._at_once = True
        self._now = scene.kernel.now  # the tick that comes next
        self._levels = dict.fromkeys(lines, 1)  # as they were put, up to then
        self._put: list[tuple[int, str, int]] = []  # from then on, in order of time
        self._fresh = False  # what follows is of now:
        self._due = NEVER
        self._silent = -1  # further edges of SCL of which nobody can tell; -1: of any edge somebody can
        self._widest = 0  # ticks: of the longest pulse that may go unseen, so that its edges are not counted on
        self._widest_of: list[tuple[int, Clock]] = []  # with these filters, and clocks
        self._hz: list[Fraction] = []  # as they run
        self._seen = self._levels.copy()  # levels behind all that was put
        self._scl_moved = LONG_AGO  # behind all that was put,
        self._scl_done = LONG_AGO  # and up to now

    def put(self, tick: int, line: Text, level: int) -> None:
        """The outside moves a line at `tick`."""
        if self._put and tick < self._put[-1][0]:
            insort(self._put, (tick, line, level), key=_tick)
            self._fresh = False
            return
        self._put.append((tick, line, level))
        if self._fresh:
            self._weigh(tick, line, level)

    def advanced(self, now: int) -> None:
        """All before tick `now` is done."""
        self._now = now
        self._fresh = False
        if len(self._put) > 2 * REMEMBERED:  # nobody asks what comes next, so nobody looks
            self._pass(len(self._put) - REMEMBERED)

    def due(self) -> int:
        """Before this tick no pin of ours moves if nothing more is put; or NEVER."""
        if not self._fresh:
            self._look()
        return self._due

    def _look(self) -> None:
        self._fresh = True
        self._listeners()
        self._lines()
        self._due = self._first_event()
        self._silent = -1
        if self._scl and not self._routes():
            self._silent = min([chip.silent_edges() for _, chip in self._modules])
            of = [(chip.filter_width, self._clocks[socket]) for socket, chip in self._modules]
            hz = [clock.hz for _, clock in of]
            if of != self._widest_of or hz != self._hz:
                self._widest_of, self._hz = of, hz
                self._widest = max([clock.tick(max(width, 1)) - clock.tick(0) for width, clock in of])
        if self._put:
            self._weigh_all()

    def _pass(self, most: int) -> None:
        """Of what was put, what is done is the lines' levels; `most` of it."""
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
        """Apart from what is done by now."""
        self._pass(len(self._put))
        self._seen = self._levels.copy()
        self._scl_moved = self._scl_done
        tick: int
        level: int
        for tick, line, level in self._put:
            self._weigh(tick, line, level)

    def _listeners(self) -> None:
        """Who listens now: pins are routed anew as firmware sets them up."""
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
        """Which lines the modules' pins are on now."""
        pins = [pins for socket, _ in self._modules for pins in socket.pins]  # each has two
        if pins != self._pins:
            self._pins = pins
            scl, sda = ({pin.wire.name for some in pins[line::2] for pin in some} for line in (0, 1))
            self._scl, self._sda = (scl.pop(), sda.pop()) if len(scl) == len(sda) == 1 else ("", "")

    def _first_event(self) -> int:
        """The kernel's first that may move a pin; a module's wake-up of which nobody can tell is none."""
        due = NEVER
        event = self._events()
        while event is not None and event.time < due:
            due = min(due, max(event.time, self._effect(event)))
            event = event.following
        return due

    def _events(self) -> Event | None:
        """The kernel's first event; the others follow it."""
        kernel = self._kernel
        kernel.renew(self._mark, kernel.now, 0)  # what is due now is done: it is the first of all
        event = self._mark.following
        kernel.cancel(self._mark)
        return event

    def _routes(self) -> bool:
        """An edge is on its way from a pad to a module."""
        if not self._routers:
            return False
        event = self._events()
        while event is not None and not isinstance(event.agent, Router):
            event = event.following
        return event is not None

    def _effect(self, event: Event) -> int:
        """Before this tick no pin moves by an event."""
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
                if chip.target.pulls & SCL or chip.master.active:  # which a read may end, and that acts at once
                    return event.time
            clock: Clock = self._cpu_clocks[processor]
            return _tick_of(clock, processor.next_output(clock.cycle_at(event.time)))
        elif isinstance(agent, Router) and event.tag == BETWEEN and not self._at_once:
            return self._answer(event.time)
        return event.time

    def _weigh(self, tick: int, line: Text, level: int) -> None:
        """What was put may be answered, or not."""
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
                    tick = max(before, self._now)  # a pulse that the filter may swallow: SDA moved as SCL was high
                elif self._silent:
                    self._silent -= 1
                    return
                self._silent = -1
            elif line == self._sda and not self._seen[self._scl] and tick != self._scl_moved:
                return
        self._due = min(self._due, self._answer(tick))

    def _answer(self, tick: int) -> int:
        """The first tick at which a line that moves at `tick` is answered."""
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
