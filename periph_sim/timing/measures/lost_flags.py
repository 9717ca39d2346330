"""Measures of flags that read-modify-writes cleared unintentionally.

    records --Modifies--> flags that were lost, and when

The result equals that of `periph-sim races` on a recorded run (`records/lost_flags.py`), without a recording.
"""

from __future__ import annotations

from ...core.records import Kind, Recorder, Subjects
from .cleared_flags import CLEARABLE, CLEARABLE_FLAGS, Cleared
from .measure import Measure
from .measured_scene import MeasuredScene
from .modifies import Modifies
from .watched import Watched


class LostFlags(Measure):
    """Flags that a read-modify-write cleared unintentionally and that firmware had not read since they rose.

    worst is the number of lost flags, count that of the writes. A plain write clears what it is meant to clear. Without
    any write nothing is proven.
    """

    unit = "flags"
    series = False
    kinds = frozenset({Kind.ACCESS, Kind.FLAG})

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self.watched = watched
        self.modifies = Modifies(watched.concerns, watched.is_about, not watched.register)

    @property
    def subjects(self) -> Subjects:
        watched = self.watched
        if watched.register:
            return {Kind.FLAG: {f"{watched.unit}.{watched.module}.{watched.register}"}}
        return {Kind.FLAG: [f"{unit}.{register}" for unit in watched.units for register in CLEARABLE]}

    def listen(self, scene: MeasuredScene) -> None:
        self.modifies.clock_is(scene.ticks_per_second(), scene.clock_history(self.watched.unit))

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe((Kind.ACCESS,), self.modifies)
        recorder.subscribe((Kind.FLAG,), self.modifies, self.subjects, CLEARABLE_FLAGS)

    def finish(self, now: int) -> None:
        self.modifies.finish()
        gone = self.gone()
        self.count = self.modifies.writes
        self.worst = self.least = gone.count
        self.worst_at = self.least_at = gone.first

    def gone(self) -> Cleared:
        return self.modifies.lost()

    def missing(self) -> str:
        what = self.watched.text or "a register with flags that writing 1 clears"
        return f"the firmware never wrote {what}"


class ClearedAlong(LostFlags):
    """Number of times that a read-modify-write meant for another flag cleared this one, whether it was read or not.

    For a flag that firmware waits for later, and that no other write may clear.
    """

    def gone(self) -> Cleared:
        return self.modifies.cleared(self.watched.field)
