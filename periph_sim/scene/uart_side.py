"""The serial lines of a scene: its wires and units go in; who talks on them from outside, and what is heard, come out.

[host], [serial] --> RX, or a pair --transceiver--> RX --> SCI --> SciMonitor: words, overruns
TX of an SCI, pairs --> UartLines: frames, characters
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from ..bus.uart.reader import Line
from ..core.wire import Wire
from ..processor.dsp import Dsp
from ..timing.measures.measure import SceneEvents
from ..timing.measures.reply import Expected, Reply
from .case.wiring import sci_lines
from .context import SceneContext
from .pairs import Pairs
from .sci_monitor import SciMonitor
from .serial.side import SerialSide
from .uart_lines import UartLines, sci_line


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
        self._pairs = Pairs(context, lambda unit, module: partial(sci_line, context, units[unit], module))
        senders = {} if host is None else {"RX": host}
        if serial is not None:
            serial.attach(context, self._pairs)
            serial.listen(events)
            senders |= serial.lines()
        self._lines = UartLines(context, wires, units, {**senders, **self._pairs.lines()})

    @property
    def has_sci(self) -> bool:
        return bool(self._scis)

    @property
    def characters(self) -> int:
        """How many were sent by the tables of [serial]."""
        return 0 if self._serial is None else self._serial.characters

    def notes(self) -> list[str]:
        """What went wrong on pairs, and what was to be sent and never was."""
        return self._pairs.notes() + ([] if self._serial is None else self._serial.notes())

    def finish(self, now: int) -> None:
        """The run is over."""
        self._lines.finish(now)

    def on_reply(self, reply: Reply) -> tuple[Expected, Callable[[], str]]:
        assert self._serial is not None
        return self._serial.on_reply(reply)

    def on_character(self, told: Callable[[int], None]) -> None:
        self._lines.on_character(told)

    def on_sci(self, told: Callable[[int, int, bool], None]) -> None:
        for monitor in self._receivers():
            monitor.told.append(told)

    def on_received_character(self, told: Callable[[int], None]) -> None:
        for monitor in self._receivers():
            monitor.received.append(told)

    def _receivers(self) -> list[SciMonitor]:
        if not self._monitors:
            self._monitors = [SciMonitor(self._units[sci.unit], sci.module) for sci in self._scis]
        return self._monitors
