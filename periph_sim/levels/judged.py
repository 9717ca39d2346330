"""A case at its own level: a case goes in; what runs and judges it comes out, by edges and bytes or by arithmetic."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Protocol

from ..core.records import Recorder
from ..core.time import Timebase
from ..scene.case.model import Case
from ..scene.firmware_loader import Firmware
from ..scene.result import Result
from ..scene.scene import Scene
from ..timing.budgets import BudgetJudge
from ..timing.verdict import Verdict

SCHEDULE = "schedule"
Subscribe = Callable[[Recorder, Timebase], None]


class Judged(Protocol):
    """The part of a `Scene` that yields verdicts. case: as it is on edges, where its level has no records."""

    @property
    def case(self) -> Case: ...

    @property
    def limits(self) -> Sequence[BudgetJudge]: ...

    @property
    def start(self) -> int: ...

    @property
    def timebase(self) -> Timebase: ...

    def run(self, duration: Fraction | None = None, progress: Callable[[float], None] | None = None, /) -> Result: ...

    def typical(self) -> list[Verdict]: ...


def refuse_record(case: Case, record: object) -> None:
    """BadCase where a level without records is to be recorded. record: the file; None where there is none."""
    if record is not None and case.fidelity == SCHEDULE:
        what = f'"schedule" has no records, so there is nothing to write to {record}'
        raise case.mistake(f'{what}; use "edge", or "adaptive" with the same records', "fidelity")


def judged(
    case: Case,
    subscribe: Subscribe | None = None,
    programs: Mapping[str, Firmware] | None = None,
    *,
    keep_values: bool = False,
) -> Judged:
    """subscribe, programs, keep_values: as `Scene` takes them. BadCase where the level cannot run the case."""
    if case.fidelity != SCHEDULE:
        return Scene(case, subscribe, programs, keep_values=keep_values)
    if programs:
        what = '"schedule" knows the firmware imu_hil, and none that is given as a function'
        raise case.mistake(f'{what}; use "edge", or "adaptive" with the same records', "fidelity")
    from .schedule.scheduled_scene import ScheduledScene

    return ScheduledScene(case, keep_values=keep_values)
