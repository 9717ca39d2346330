"""History of the chip's flags: the changes and accesses around given instants.

    Recorder --FLAG, ACCESS--> one ring a register or access --at each instant--> changes, oldest first

A replay that differs from its capture is repeated with this listener: a run is the same each time, and the first run,
before the difference is known, records nothing. The rings are bounded, so memory does not grow with the run.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Sequence
from functools import partial

from ..core.records import Kind, Record, Recorder
from ..core.time import Timebase
from ..processor.dsp import Dsp
from ..processor.source_location import SourceLocation
from ..scene.scene import Scene

KEEP = 24  # number of changes kept for each field, and of accesses of each kind for each register

REGISTERS = {"I2C-A": ("I2CSTR.", "I2CMDR."), "SCI-A": ("SCIRXST.", "SCIFFRX.", "SCICTL1.")}


class FlagHistory:
    """Changes and accesses around some moments of a run.

    moments: pairs (tick, last tick to show).
    module: the module whose registers are shown.
    keep: the number of entries that each ring keeps.
    instants: the ticks at which the executed statement is noted.
    """

    def __init__(
        self,
        moments: Sequence[tuple[int, int]],
        unit: str,
        module: str,
        keep: int = KEEP,
        instants: Sequence[int] = (),
    ) -> None:
        self._moments = deque(sorted(moments, key=lambda moment: moment[1]))
        self._instants = instants
        self._unit = unit
        self._where = f"{unit}.{module}"
        self._registers = REGISTERS[module]
        self._accesses = (f"R {module}.", f"W {module}.")
        self._rings: dict[str, deque[Record]] = defaultdict(lambda: deque(maxlen=keep))
        self._frozen: dict[tuple[int, int], list[Record]] = {}
        self._places: dict[int, SourceLocation | None] = {}

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.FLAG, Kind.ACCESS], self._record)

    def watch(self, scene: Scene) -> None:
        """Note the statement that the unit's firmware executes at each instant of this scene's run."""
        dsp = scene.units[self._unit]
        for tick in self._instants:
            scene.kernel.call_at(max(tick, scene.kernel.now), partial(self._note_place, tick, dsp))

    def _note_place(self, tick: int, dsp: Dsp) -> None:
        self._places[tick] = dsp.processor.causing_statement()

    def place(self, instant: int) -> SourceLocation | None:
        """Return the statement executed at an instant; None before the program begins or after its end."""
        return self._places.get(instant)

    def _record(self, record: Record) -> None:
        while self._moments and record.tick > self._moments[0][1]:
            self._freeze(self._moments.popleft())
        if not self._moments:
            return
        if record.kind is Kind.FLAG:
            wanted = record.where == self._where and record.what.startswith(self._registers)
        else:
            wanted = record.where == self._unit and record.what.startswith(self._accesses)
        if wanted:
            self._rings[record.what].append(record)

    def _freeze(self, moment: tuple[int, int]) -> None:
        self._frozen[moment] = sorted((record for ring in self._rings.values() for record in ring), key=_number)

    def records_near(self, moment: tuple[int, int]) -> list[Record]:
        """Return the records near one of the moments, in order. Call after the run."""
        while self._moments:
            self._freeze(self._moments.popleft())
        return self._frozen[moment]


def _number(record: Record) -> int:
    return record.number
