"""Base class of all measures, which follow the records of a run and keep the worst value and its tick.

No history of values is kept, so memory does not grow with the run, unless `keep` asks for all values. For percentiles
`Tally` counts equal values in bounded memory. Measures with a fixed name are rows in `registry`. A measure may ask the
scene for what records do not show: `MeasuredScene`.
"""

# core: compiled

from __future__ import annotations

from array import array
from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Protocol, final

from ...core.records import UNWANTED, Kind, Listener, Recorder, Subjects
from ...core.state import State
from ...core.time import NO_TIME

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...core.wire import Wire
    from ...devices.watchers import WireWatcher
    from .expectations import Expected, Reply, WatchedWire


MOST = 1 << 15  # maximum number of cells


@final
class Cell:
    """Values that share a cell of the histogram.

    count: their number. value: the largest. at: the first tick at which the largest occurred.
    """

    __slots__ = ("at", "count", "value")

    count: int
    value: int
    at: int


@final
class Tally:
    """Histogram of values for percentiles.

        value, tick --> cell of the value: count, first tick --> percentile

    Up to `most` different values have a cell each, and percentiles are exact. With more values the cells become twice
    as wide until half of `most` are left. A cell represents the largest value in it, so a percentile is a measured
    value and never too small.
    """

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._cells: dict[int, Cell] = {}
        self._shift = 0  # a value shifted right by this is the number of its cell

    def __len__(self) -> int:
        return len(self._cells)

    def add(self, value: int, at: int) -> None:
        number = value >> self._shift
        cell: Cell | None = self._cells.get(number)
        if cell is None:
            cell = self._cells[number] = Cell()
            cell.count, cell.value, cell.at = 1, value, at
            if len(self._cells) > self._most:
                self._widen()
        else:
            cell.count += 1
            if value > cell.value:
                cell.value, cell.at = value, at

    def percentile(self, per_mille: int) -> tuple[int, int]:
        """Return (value, first tick) of the least value that `per_mille` of the values do not exceed (nearest rank)."""
        rank, passed = -(-per_mille * sum(cell.count for cell in self._cells.values()) // 1000), 0
        for _, cell in sorted(self._cells.items()):
            passed += cell.count
            if passed >= rank:
                return cell.value, cell.at
        raise AssertionError("there is no value")

    def _widen(self) -> None:
        """Make cells twice as wide until half are left, so that values far apart do not widen them each time."""
        while len(self._cells) > self._most // 2:
            self._shift += 1
            narrow, self._cells = self._cells, {}
            for number, cell in narrow.items():
                wide = self._cells.setdefault(number >> 1, cell)
                if wide is not cell:
                    wide.count += cell.count
                    if (cell.value, -cell.at) > (wide.value, -wide.at):
                        wide.value, wide.at = cell.value, cell.at


LOOKS_BACK = (
    *("this occurrence", "the occurrence before", "this transfer", "this round", "the round before"),
    "the whole run",
)
MILLIONTHS = 1_000_000  # parts of the time and LSB are counted in these
READ = "read"  # an occurrence: one addressed phase, read or written, identified by its START


class Measure(Listener):
    """Base of all measures.

    worst, least: the largest and the smallest value. not_before: the first tick that counts. occasions: number of times
    that there was something to measure, counted on the bus and not by the firmware; None if it has no such count.

    unit: "time" (ticks), "%" and "LSB" (millionths) or a word for what is counted. series: True if it takes one value
    after the other, which have percentiles. occurrence: what a value belongs to; measures of the same occurrences can
    be joined. asked: the name of occasions, as a plural.

    looks_back: how far back the records are that its next value depends on, a word of LOOKS_BACK. STATE lists what it
    remembers of them; the values that it has taken are results.

    is_jitter: it takes the difference between each value and the one before (cycle-to-cycle jitter), not the value.
    """

    STATE = State("_before _uncompared")
    unit = "time"
    series = True
    needs = ""  # what a scene must have for this to mean anything: "controller", "rounds", "host", "serial", "SCI"
    asked = ""
    kinds: frozenset[Kind] = frozenset()

    def __init__(self) -> None:
        self.looks_back = "this occurrence"
        self.occurrence = ""
        self.count = 0
        self.worst = 0
        self.least = 0
        self.worst_at = NO_TIME
        self.least_at = NO_TIME
        self.cut_off = 0  # number of these that the end of the run cut off
        self.not_before = NO_TIME
        self.occasions: int | None = 0 if self.asked else None
        self.is_jitter = False
        self._before: int | None = None  # the last value, of a jitter
        self._uncompared = 0  # occasions to come that have none before them to be compared with
        self._kept: tuple[array[int], array[int]] | None = None
        self._tally: Tally | None = None
        self.refuted = ""  # why no value can keep the limit, such as a reply that is not the expected one
        self.refuted_at = NO_TIME
        self.refuted_until = NO_TIME
        self.not_judged = ""  # the reason why it is not known whether all occurrences keep the limit

    @property
    def subjects(self) -> Subjects:
        """The subjects whose records it needs, by kind, without the kinds of which it needs all."""
        return {}

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
        if self._before is not None and not self.count:
            return "there was one value, which has none before it"
        return self.why_silent()

    def why_silent(self) -> str:  # core: python
        """Return the same if no value was taken that a jitter leaves out."""
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
        if self.is_jitter:
            return ""
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

    # Values -----------------------------------------------------------------------------

    def become_jitter(self) -> None:
        """Take differences between successive values in place of values. Call it before the first value."""
        self.is_jitter = True
        self.looks_back = "the occurrence before"
        self.occurrence = ""
        self._uncompared = 1

    def keep(self) -> None:
        """Keep every value, for distributions and joined conditions."""
        self._kept = array("q"), array("q")

    def tally(self) -> None:
        """Count values that are equal, for percentiles."""
        self._tally = Tally()

    @property
    def tallied(self) -> bool:
        return self._tally is not None

    @property
    def kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        """(values, when each was), both int64[count], in order; None unless `keep` was called."""
        if self._kept is None:
            return None
        import numpy as np  # with the first percentile: most runs need none

        values, at = self._kept
        return np.array(values, np.int64), np.array(at, np.int64)

    def all_kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return `kept`, the values and their ticks. Call it only after `keep`."""
        assert self.kept is not None
        return self.kept

    def only(self, places: NDArray[np.int64]) -> None:
        """Keep only the values at these places."""
        values, at = (column[places].tolist() for column in self.all_kept())
        self.count = self.cut_off = 0
        self.occasions = None  # the measure that it is joined to has them
        self.keep()
        if self._tally is not None:
            self.tally()
        for value, when in zip(values, at, strict=True):
            self.take(value, when)

    def percentile(self, per_mille: int) -> tuple[int, int]:
        """Return (value, first tick) of the least value that `per_mille` of the values do not exceed (nearest rank)."""
        assert self._tally is not None
        return self._tally.percentile(per_mille)

    def occasion(self, at: int, number: int = 1) -> None:
        """Count occasions. at: as given to `take`."""
        if at >= self.not_before:
            assert self.occasions is not None
            self.occasions += number - self._uncompared
            self._uncompared = 0

    def refute(self, why: str, at: int, until: int = NO_TIME) -> None:
        """Break the budget, whatever values follow, unless it is broken already. until: the end of what is wrong."""
        if not self.refuted and at >= self.not_before:
            self.refuted, self.refuted_at, self.refuted_until = why, at, at if until == NO_TIME else until

    def take(self, value: int, at: int) -> None:
        if self.is_jitter:
            before, self._before = self._before, value
            if before is None:
                return
            value = abs(value - before)
        if at < self.not_before:
            return
        if not self.count or value > self.worst:
            self.worst, self.worst_at = value, at
        if not self.count or value < self.least:
            self.least, self.least_at = value, at
        self.count += 1
        if self._kept is not None:
            self._kept[0].append(value)
            self._kept[1].append(at)
        if self._tally is not None:
            self._tally.add(value, at)

    def take_unfinished(self, value: int, at: int) -> None:
        """Take the value of an unfinished occurrence, which exceeds all before."""
        least, least_at, alone = self.least, self.least_at, not self.count
        self.take(value, at)
        self.cut_off += 1
        if not alone:
            self.least, self.least_at = least, least_at


class Delay(Protocol):
    def ticks(self, written: int) -> int:
        """Return the delay of a write at this tick, with the present settings."""


class MeasuredScene(Protocol):
    """The questions that a scene answers."""

    def on_reply(self, reply: Reply) -> tuple[Expected, Callable[[], str]]:
        """Subscribe `reply`. Return the expected reply, and a function that returns why it was never requested."""

    def watcher(self, measure: WatchedWire) -> WireWatcher:
        """Return the watcher of the wire that the measure is named for, which gives its findings to the measure."""

    def rounds_at_start(self) -> Callable[[], bool]:
        """Return a function that says, at a START that is no repeated one, whether it begins a round."""

    def began(self) -> int:
        """Return the tick at which the run begins."""

    def wire(self, name: str) -> Wire: ...

    def level_of(self, wire: str) -> int:
        """Return the level of a wire now."""

    def value_of(self, place: str, name: str) -> int:
        """Return what a field holds now: of "dsp.I2C-A" that of "I2CSTR.XRDY"."""

    def ticks_per_second(self) -> int: ...

    def clock_history(self, unit: str) -> list[tuple[int, Fraction]]:
        """Return a unit's SYSCLKOUT in Hz from each tick on, up to now; of the first unit where none is named."""

    def i2c_release_delay(self, unit: str) -> Delay:
        """Return the delay from a write of I2CDXR that SCL is held for to its release."""
