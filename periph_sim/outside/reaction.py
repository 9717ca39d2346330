"""How soon a case may answer what the outside does to its lines: a tick goes in, the first one of an answer comes out.

An I2C module that is no master knows of an edge only behind its noise filter, and an SCI behind its synchroniser: until
then no pin of theirs moves by it. Whoever else listens is taken to answer at once.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..core.socket import Socket
from ..core.wire import Sampler
from ..f28335.i2c.module import I2c
from ..f28335.sci.module import Sci
from ..scene.scene import Scene


class Reaction:
    def __init__(self, scene: Scene, lines: Sequence[str]) -> None:
        case = scene.case
        self._others = bool(case.chip or case.device or case.controller or case.fault or case.transceiver)
        self._wires = [scene.wires[name] for name in lines]
        self._versions = [-1] * len(self._wires)
        self._clocks = {id(socket): dsp.clock for dsp in scene.units.values() for socket in dsp.sockets.values()}
        self._known = [socket for dsp in scene.units.values() for socket in dsp.sockets.values()]
        self._behind_filter: list[Socket] = []
        self._at_once = True

    def after(self, tick: int) -> int:
        """Lines move at `tick`: before the tick that is given no pin of ours moves by it."""
        if self._others:
            return tick
        versions = [wire.version for wire in self._wires]
        if versions != self._versions:
            self._versions = versions
            self._look()
        if self._at_once:
            return tick
        first = -1
        for socket in self._behind_filter:
            chip = socket.chip
            if isinstance(chip, I2c) and chip.master.active:
                return tick
            clock = self._clocks[id(socket)]
            at = clock.tick(clock.cycle_at(tick) + chip.filter_width)
            first = at if first < 0 else min(first, at)
        return max(tick, first)

    def _look(self) -> None:
        """Who listens now: pins are routed anew as firmware sets them up."""
        agents = [ear.agent for wire in self._wires for ear in wire.ears() if isinstance(ear, Sampler)]
        sockets = [socket for socket in self._known if any(agent is socket for agent in agents)]
        self._behind_filter = [socket for socket in sockets if isinstance(socket.chip, (I2c, Sci))]
        self._at_once = len(self._behind_filter) < len(sockets) or not sockets
