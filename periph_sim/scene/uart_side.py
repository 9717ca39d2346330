"""The serial lines of a scene: its wires and units go in; who talks on them from outside, and what is heard, come out.

[host], [serial] --> RX, or a pair --transceiver--> RX --> SCI --> SciMonitor: words, overruns
TX of an SCI, pairs --> UartLines: frames, characters
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

from .case.wiring import sci_lines
from .context import SceneContext

if TYPE_CHECKING:
    from ..bus.uart.reader import Line
    from ..core.wire import Wire
    from ..processor.dsp import Dsp
    from ..timing.measures.measure import SceneEvents
    from ..timing.measures.reply import Expected, Reply
    from .pairs import Pairs
    from .sci_monitor import SciMonitor
    from .serial.side import SerialSide
    from .uart_lines import UartLines


class UartSide:
    """host: how the host sends on RX, where there is one. serial: who else talks, not yet on the wires."""

    def __init__(
        self,
        context: SceneContext,
        wires: Mapping[str, Wire],
        units: Mapping[str, Dsp],
        host: Line | None,
        serial: SerialSide | None,
        events: SceneEvents,
    ) -> None:
        self._units = units
        self._serial = serial
        self._scis = sci_lines(context.case, context.wiring)
        self._monitors: list[SciMonitor] = []
        self._pairs: Pairs | None = None
        self._lines: UartLines | None = None
        senders = {} if host is None else {"RX": host}
        if serial is not None or context.case.transceiver:
            self._pairs = self._pairs_of(context)
        if serial is not None and self._pairs is not None:
            serial.attach(context, self._pairs)
            serial.listen(events)
            senders |= serial.lines()
        if self._pairs is not None:
            senders |= self._pairs.lines()
        if self._scis or senders:
            from .uart_lines import UartLines

            self._lines = UartLines(context, wires, units, senders)

    def _pairs_of(self, context: SceneContext) -> Pairs:
        from .pairs import Pairs
        from .uart_lines import sci_line

        return Pairs(context, lambda unit, module: partial(sci_line, context, self._units[unit], module))

    @property
    def has_sci(self) -> bool:
        return bool(self._scis)

    @property
    def characters(self) -> int:
        """How many were sent by the tables of [serial]."""
        return 0 if self._serial is None else self._serial.characters

    def notes(self) -> list[str]:
        """What went wrong on pairs, and what was to be sent and never was."""
        told = [] if self._pairs is None else self._pairs.notes()
        return told + ([] if self._serial is None else self._serial.notes())

    def finish(self, now: int) -> None:
        """The run is over."""
        if self._lines is not None:
            self._lines.finish(now)

    def on_reply(self, reply: Reply) -> tuple[Expected, Callable[[], str]]:
        assert self._serial is not None
        return self._serial.on_reply(reply)

    def on_character(self, told: Callable[[int], None]) -> None:
        if self._lines is not None:
            self._lines.on_character(told)

    def on_sci(self, told: Callable[[int, int, bool], None]) -> None:
        for monitor in self._receivers():
            monitor.told.append(told)

    def on_received_character(self, told: Callable[[int], None]) -> None:
        for monitor in self._receivers():
            monitor.received.append(told)

    def _receivers(self) -> list[SciMonitor]:
        if not self._monitors and self._scis:
            from .sci_monitor import SciMonitor

            self._monitors = [SciMonitor(self._units[sci.unit], sci.module) for sci in self._scis]
        return self._monitors
