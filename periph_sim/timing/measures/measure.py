"""Base class of all measures, which follow the records of a run and keep the worst value and its tick.

What it keeps of its values is in `taken_values`. Measures with a fixed name are rows in `registry`.
"""

# core: compiled

from __future__ import annotations

from ...core.records import UNWANTED, Kind, Recorder, Subjects
from ...core.state import State
from ...core.time import NO_TIME
from .measured_scene import MeasuredScene
from .taken_values import TakenValues

LOOKS_BACK = (
    *("this occurrence", "the occurrence before", "this transfer", "this round", "the round before"),
    "the whole run",
)
MILLIONTHS = 1_000_000  # parts of the time and LSB are counted in these
READ = "read"  # an occurrence: one addressed phase, read or written, identified by its START


class Measure(TakenValues):
    """Base of all measures.

    unit: "time" (ticks), "%" and "LSB" (millionths) or a word for what is counted. series: True if it takes one value
    after the other, which have percentiles. occurrence: what a value belongs to; measures of the same occurrences can
    be joined. asked: the name of occasions, as a plural.

    looks_back: how far back the records are that its next value depends on, a word of LOOKS_BACK. STATE lists what it
    remembers of them; the values that it has taken are results.
    """

    STATE = State()
    looks_back: str = "this occurrence"
    unit = "time"
    series = True
    needs = ""  # what a scene must have for this to mean anything: "controller", "rounds", "host", "serial", "SCI"
    occurrence = ""
    asked = ""
    kinds: frozenset[Kind] = frozenset()
    refuted = ""  # why no value can keep the limit, such as a reply that is not the expected one
    refuted_at = NO_TIME
    refuted_until = NO_TIME

    @property
    def subjects(self) -> Subjects:
        """The subjects whose records it needs, by kind, without the kinds of which it needs all."""
        return {}

    def __init__(self) -> None:
        super().__init__()
        self.not_judged = ""  # the reason why it is not known whether all occurrences keep the limit
        self.occasions = 0 if self.asked else None

    @property
    def silent(self) -> bool:
        """True if nothing was measured, so that nothing is proven."""
        return not self.count

    @property
    def measured(self) -> int:
        """The number of occasions that were measured."""
        return self.count

    @property
    def counted(self) -> int:
        """The count that verdicts show: the number of values."""
        return self.count

    def missing(self) -> str:  # core: python
        """Return why nothing was measured; empty if nothing more can be said."""
        return ""

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        """Return (value so far, as given to `take`, begin) of each occurrence that is not over."""
        return []

    def unfinished_text(self) -> str:
        """Return what is not over, as a phrase."""
        return ""

    def close(self, now: int) -> str:
        """Take the values of unfinished occurrences that exceed all others; return these occurrences as a phrase.

        Such a value may still grow, so it never counts as the least one.
        """
        most = self.worst if self.count else None
        for value, at in sorted(self.unfinished(now)):
            if at >= self.not_before and (most is None or value > most):
                self.take_unfinished(value, at)
        return self.unfinished_text() if self.cut_off else ""

    def listen(self, scene: MeasuredScene) -> None:  # core: python
        """Ask the scene for what this measure needs in addition to records."""

    def subscribe(self, recorder: Recorder) -> None:
        """Subscribe to the records that this measure looks at, which has them made."""
        recorder.subscribe(self.kinds, self, self.subjects)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """Return the tag for `on_record` of records of this kind, place and thing; UNWANTED for none of them."""
        return UNWANTED

    def finish(self, now: int) -> None:  # core: python
        """Handle the end of the run."""
