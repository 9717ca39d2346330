"""Lost flags as measures: accesses and flag changes go in; what read-modify-writes cleared unmeant comes out.

    records --Modifies--> flags that were lost, and when

What counts is what `periph-sim races` shows of a recorded run (`records/lost_flags.py`), which is not needed here.
"""

from __future__ import annotations

from ...core.records import Kind, Recorder, Subjects
from .measure import Measure, MeasuredScene
from .modifies import CLEARABLE, CLEARABLE_FLAGS, Cleared, Modifies
from .watched import Watched


class LostFlags(Measure):
    """Flags that a read-modify-write cleared unmeant, and that firmware had not looked at since they rose.

    worst is how many were lost, count how many writes there were, of which a plain one clears what it means to: with
    none, nothing is proven.
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
    """How often a read-modify-write cleared this flag though another one was meant, whether it had been read or not.

    This is for a flag that is waited for afterwards, and that no other write may take.
    """

    def gone(self) -> Cleared:
        return self.modifies.cleared(self.watched.field)
