"""Evidence for each divergence: the history of the chip's flags, and the statement of the firmware that caused it.

The run is repeated with recording, and ends soon after the last divergence. The statement is the one that wrote the
value on the wires, or else the one that was executed at the divergence.

    Recorder --FLAG, ACCESS--> a ring buffer per field or access --at each divergence--> changes, oldest first

The first run records nothing, because the divergences are not known until this run ends. The second run repeats the
first exactly. The ring buffers are bounded, so memory does not grow with the length of the run.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

from ..core.records import Kind, Record, Recorder
from ..core.time import Timebase
from ..processor.dsp import Dsp
from ..processor.source_location import InstructionLocation, SourceLocation
from ..records.recording import Subscribe
from ..scene.scene import Scene
from .report import TIMING, Divergence, HistoryEntry

KEEP = 24  # number of entries kept in the ring buffer of each field, and of each kind of access to each register

REGISTERS = {"I2C-A": ("I2CSTR.", "I2CMDR."), "SCI-A": ("SCIRXST.", "SCIFFRX.", "SCICTL1.")}


class FlagHistory:
    """Recorder of changes and accesses around the divergences of a run.

    moments: for each divergence, its tick and the last tick of its history.
    unit, module: the unit and its module whose registers are recorded.
    keep: the number of entries in each ring buffer.
    instants: ticks at which `watch` stores the statement that the firmware executes.

    places: the firmware's statement at each of `instants` that the run reached; None if the program was not running.
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
        self.places: dict[int, SourceLocation | None] = {}

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.FLAG, Kind.ACCESS], self._record)

    def watch(self, scene: Scene) -> None:
        """Store the statement that the unit's firmware executes at each of `instants`, during the run of this scene."""
        dsp = scene.units[self._unit]
        for tick in self._instants:
            scene.kernel.call_at(max(tick, scene.kernel.now), partial(self._note_place, tick, dsp))

    def _note_place(self, tick: int, dsp: Dsp) -> None:
        self.places[tick] = dsp.processor.causing_statement()

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
        self._frozen[moment] = sorted(
            (record for ring in self._rings.values() for record in ring), key=attrgetter("number")
        )

    def records_near(self, moment: tuple[int, int]) -> list[Record]:
        """Return the records that the ring buffers contained at the end of the history of `moment`, in order of time.

        Call this after the run, with one of `moments`.
        """
        while self._moments:
            self._freeze(self._moments.popleft())
        return self._frozen[moment]


Repeat = Callable[[Subscribe, int, Callable[[Scene], None]], Scene]  # the type of `Replay.repeat`


class Role(NamedTuple):
    """The role of a unit in a replay: slave, master or receiver.

    module: the module that is connected to the replayed lines.
    writes: for the first words of an event, such as "data read", the register to which the firmware writes the value
        that this event shows. It has only events whose value the firmware sends.
    """

    module: str
    writes: Mapping[str, str]


AS_SLAVE = Role("I2C-A", {"data read": "I2CDXR"})
AS_MASTER = Role("I2C-A", {"data write": "I2CDXR", "address": "I2CSAR"})
AS_RECEIVER = Role("SCI-A", {})


def with_history(
    divergences: tuple[Divergence, ...], scene: Scene, origin: int, after: int, unit: str, role: Role, repeat: Repeat
) -> list[Divergence]:
    """Return the divergences with their histories and causes.

    scene: the scene of the run that had the divergences.
    origin: the tick at which the capture begins.
    after: the number of ticks after a divergence for which its history is shown.
    unit, role: the unit with the firmware, and its role.
    repeat: a function that repeats the run.

    The tick of a divergence is the tick of the replayed event. If the replay has no such event, it is the tick of the
    captured event; if the capture has none either, it is the end of the run.

    A cause that a divergence already has is kept. Otherwise, the cause is the last statement that wrote the value found
    in the replay. If no such write is recorded, the cause is the statement that the firmware executes at the tick of
    the divergence. For a divergence of kind TIMING, it is the statement at the tick of the captured event.
    """
    if not divergences:
        return []
    timebase = scene.timebase
    moments, instants = [], []
    for divergence in divergences:
        captured, replayed = (
            None if seconds is None else origin + timebase.ticks(Fraction(seconds), "nearest")
            for seconds in (divergence.capture_s, divergence.replay_s)
        )
        known = captured if replayed is None else replayed
        tick = scene.kernel.now if known is None else known
        moments.append((tick, tick + after))
        instants.append(captured if divergence.kind == TIMING and captured is not None else tick)
    history = FlagHistory(moments, unit, role.module, instants=instants)
    repeat(history.subscribe, max(until for _, until in moments), history.watch)
    found = []
    for divergence, moment, instant in zip(divergences, moments, instants, strict=True):
        records = history.records_near(moment)
        changes = tuple(
            HistoryEntry(float(timebase.seconds(record.tick - origin)), _what(record.where, record.what), record.value)
            for record in records
        )
        before = [record for record in records if record.tick <= moment[0]]
        cause = divergence.cause or _write_of(divergence.found, role, before)
        if not cause and (executed := history.places.get(instant)) is not None:
            cause = f"the firmware was at {_shown(executed)}"
        found.append(replace(divergence, history=changes, cause=cause))
    return found


def _write_of(event: str, role: Role, records: Sequence[Record]) -> str:
    """Return a phrase with the last statement that wrote the value of an event; "" if no such write is in `records`."""
    for words, register in role.writes.items():
        if event.startswith(words):
            value = int(event.removeprefix(words).split()[0], 16)
            writes = [r for r in records if r.what == f"W {role.module}.{register}" and r.value & 0xFF == value]
            if writes and isinstance(writes[-1].text, SourceLocation):
                return f"{register} = 0x{value:02X} was written at {_shown(writes[-1].text)}"
    return ""


def _shown(place: SourceLocation) -> str:
    """Format a source location as file, line and function; for an image without debug data, as function and address."""
    if isinstance(place, InstructionLocation):
        return str(place)
    return f"{Path(place.path).name}:{place.line}, in {place.rpartition(':')[0]}"


def _what(where: str, what: str) -> str:
    return what if what[:2] in ("R ", "W ") else f"{where.rpartition('.')[2]}.{what}"
