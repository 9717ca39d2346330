"""SCI frames above edges: UART lines, units and senders go in; frames pass in two events where nobody can tell."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from ..bus.uart.whole_frames import FrameParty, WholeFrames
from ..core.kernel import Agent
from ..f28335.sci.module import Sci
from ..processor.dsp import Dsp
from ..processor.sci_frames import PadsHear, SciHears, SciSends
from .case.wiring import SciLines
from .context import SceneContext


class FramesSide:
    """lines: by wire that is not at edges, what its frames pass through. outside: who sends frames and is no unit, as
    wires name them.
    """

    def __init__(
        self, context: SceneContext, units: Mapping[str, Dsp], scis: Collection[SciLines], outside: Iterable[str]
    ) -> None:
        kernel, known = context.kernel, {*units, *outside}
        modules = {sci: units[sci.unit].socket(sci.module) for sci in scis}
        hear: dict[Agent, FrameParty] = {}
        for sci, socket in modules.items():
            assert isinstance(socket.chip, Sci)
            hear[socket] = SciHears(socket, socket.chip, units[sci.unit].clock)
        routers = [dsp.router for dsp in units.values() if dsp.router is not None]
        self.lines: dict[str, WholeFrames] = {}
        for wire in {
            name: context.wire(name) for sci in scis for name in (sci.rx, sci.tx) if name in context.levels.lines
        }.values():
            pads: dict[Agent, FrameParty] = {router: PadsHear(router, wire) for router in routers}
            self.lines[wire.name] = WholeFrames(kernel, wire, known, hear | pads)
        for sci, socket in modules.items():
            assert isinstance(socket.chip, Sci)
            SciSends(kernel, socket, socket.chip, units[sci.unit].clock, self.lines)

    @property
    def frames(self) -> int:
        """How many were sent."""
        return sum(line.frames for line in self.lines.values())

    @property
    def passed(self) -> int:
        """How many of them passed in two events."""
        return sum(line.passed for line in self.lines.values())
