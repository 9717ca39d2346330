"""A run at the cheapest level within a bound.

    first part of the scene --every fidelity--> errors --> cheapest within the bound --> the whole run
                                                             what the first part did not show --> again, on edges

The bound is measured and not proven: it holds for what the first part showed. So a level that is not equal to edges by
construction is watched: a flag that is set, an interrupt, a NACK, lost arbitration, a note or a stretched byte that was
not met there ends the run, and all of it is made again on edges.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from time import process_time

from ...bus.i2c.transfer import Transfer
from ...core.records import UNHEARD, Kind, Listener, Recorder
from ...core.time import Timebase
from ...processor.user_code import output_muted
from ...scene.case.model import BadCase, Case
from ...scene.result import Result
from ...scene.scene import Scene
from ...timing.format_value import duration_text
from .choose import Best, best_within
from .compared import LONGER, Make, compare_levels
from .levels import REFERENCE, Level, fidelities_of
from .moments import KINDS, Met, sort_of

PART = Fraction(60, 1000)  # seconds of the scene that are measured
ADAPTIVE = "give --fidelity adaptive, which needs no measurement"
STRETCHED = "a stretched byte"
SORTS = {Kind.FLAG: 2, Kind.IRQ: 2, Kind.BUS: 2, Kind.NOTE: 1}


@dataclass(frozen=True)
class Choice:
    """best: the level and why. level: of the run in the end. unmet: the reason for which it fell back to edges.

    measured_s, used_s: of the scene. cpu_s: that measuring took; total_cpu_s: with all runs of the whole scene.
    """

    best: Best
    level: str
    unmet: str
    measured_s: float
    used_s: float
    cpu_s: float
    total_cpu_s: float

    def heading(self) -> str:
        """For the line of the verdict."""
        return f"; {self.level}, measured on {duration_text(self.measured_s)}, used for {duration_text(self.used_s)}"

    def sentence(self) -> str:
        fallen = f"; fell back to edges at {self.unmet}" if self.unmet else ""
        return f"{self.best.why}; measuring took {self.cpu_s:.2g} of {self.total_cpu_s:.2g} s of CPU time{fallen}"

    def as_json(self) -> dict[str, object]:
        return self.best.as_json() | {
            "used": self.level,
            "unmet": self.unmet,
            "measured_s": self.measured_s,
            "used_s": self.used_s,
            "cpu_s": self.cpu_s,
            "total_cpu_s": self.total_cpu_s,
        }


class _Unmet(Exception):
    """Something happened that the measured part did not show."""


class UnmetWatch(Listener):
    """Listens to the sorts of records that were not met before, so that others cost nothing.

    first: the first unmet record and its tick; None if there was none. stretched: True if a byte was stretched before.
    """

    def __init__(self, met: Met, stretched: bool) -> None:
        self.first: tuple[str, int] | None = None
        self._met, self._stretched = met, stretched
        self._topics: list[tuple[Kind, str, str]] = []

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if kind not in KINDS or len(self._met.get((kind, where, what), ())) == SORTS[kind]:
            return UNHEARD
        self._topics.append((kind, where, what))
        return len(self._topics) - 1

    def hear(self, tag: int, tick: int, value: int) -> None:
        topic = kind, where, what = self._topics[tag]
        if self.first is None and sort_of(kind, what, value) not in self._met.get(topic, ()):
            self.first = f"{where} {what} = {value}" if kind is Kind.FLAG else f"{where} {what}", tick

    def transfer(self, over: Transfer) -> None:
        if self.first is None and not self._stretched and any(phase.stretch for phase in over.phases):
            self.first = STRETCHED, over.stop_at


def run_within(
    make: Make,
    bound_s: float,
    length: Fraction | None,
    keep_values: bool = False,
    told: Callable[[float], None] | None = None,
    levels: tuple[Level, ...] | None = None,
) -> tuple[Scene, Result, Choice]:
    """Measure, choose and run. levels: to choose from, the reference first; None: all fidelities of the case.

    BadCase where no level is known to be within the bound.
    """
    began = process_time()
    levels = levels or fidelities_of(make(()))
    case = make(levels[0].changes)
    whole = case.duration if length is None else length
    part = min(PART, whole)
    with output_muted():
        found = compare_levels(make, levels, part, ADAPTIVE if whole > part else LONGER)
    best = best_within(found, bound_s, float(whole))
    if best.level is None:
        raise BadCase(f"case {case.name}: no level within {bound_s * 1e6:g} us: {best.why}")
    cpu = process_time() - began
    chosen = make(best.level.changes)
    unmet = ""
    if best.level.same_records or whole == part:
        scene = Scene(chosen, keep_values=keep_values)
        result = scene.run(whole, told)
    else:
        stretch = found.observed.values.get("stretch")
        watch = UnmetWatch(found.observed.met, stretch is not None and bool(stretch[1].any()))
        scene, came = _watched(chosen, watch, whole, keep_values, told)
        if came is None:
            assert watch.first is not None
            what, tick = watch.first
            unmet = f"{what}, at {scene.timebase.show(tick - scene.start)}, which the measured part has not"
            scene = Scene(case, keep_values=keep_values)
            came = scene.run(whole, told)
        result = came
    level = REFERENCE if unmet else best.level.name
    return scene, result, Choice(best, level, unmet, float(part), float(whole), cpu, process_time() - began)


def _watched(
    case: Case, watch: UnmetWatch, length: Fraction, keep_values: bool, told: Callable[[float], None] | None
) -> tuple[Scene, Result | None]:
    """The run; None for its result if something was not met before."""

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe(KINDS, watch)

    def progress(done: float) -> None:
        if watch.first is not None:
            raise _Unmet
        if told is not None:
            told(done)

    scene = Scene(case, subscribe, keep_values=keep_values)
    scene.on_transfer(watch.transfer)
    try:
        result = scene.run(length, progress)
    except _Unmet:
        return scene, None
    return scene, result
