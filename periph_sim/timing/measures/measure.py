"""Base class of all measures, which follow the records of a run and keep the worst value and its tick.

Values are not stored, so memory does not grow with the run, unless `keep` is called. For percentiles, `Tally` counts
equal values in bounded memory. `registry` has a table of the measures with fixed names. The scene (`MeasuredScene`)
gives a measure information that records do not contain.
"""

# core: compiled

from __future__ import annotations

from array import array
from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, final

from msgspec import Struct

from ...core.records import UNWANTED, Kind, Listener, Recorder, Subjects
from ...core.state import State
from ...core.time import NO_TIME

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...core.wire import Wire
    from ...devices.watchers import WireWatcher
    from .expectations import Expected, Reply, Unsolicited, WatchedWire


MOST = 1 << 15  # maximum number of cells of a `Tally`


@final
class Cell:
    """Values that share a cell of the histogram.

    count: the number of values. value: the largest of them. at: the first tick at which the largest value occurred.
    """

    __slots__ = ("at", "count", "value")

    count: int
    value: int
    at: int


@final
class Tally:
    """Histogram of values for percentiles.

        value, tick --> cell of the value: count, first tick --> percentile

    Up to `most` different values have a cell each, and percentiles are exact. If there are more different values, all
    cells are made twice as wide until at most half of `most` cells are left. A cell represents its largest value, so a
    percentile is a measured value and never too small.
    """

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._cells: dict[int, Cell] = {}
        self._shift = 0  # `value >> _shift` is the number of the cell of a value

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
        """Return a percentile by nearest rank: the value and its first tick. per_mille: 950 for 95 % of the values."""
        rank, passed = -(-per_mille * sum(cell.count for cell in self._cells.values()) // 1000), 0
        for _, cell in sorted(self._cells.items()):
            passed += cell.count
            if passed >= rank:
                return cell.value, cell.at
        raise AssertionError("there is no value")

    def _widen(self) -> None:
        """Make all cells twice as wide until at most half of `most` cells are left, so that this is rarely needed."""
        while len(self._cells) > self._most // 2:
            self._shift += 1
            narrow, self._cells = self._cells, {}
            for number, cell in narrow.items():
                wide = self._cells.setdefault(number >> 1, cell)
                if wide is not cell:
                    wide.count += cell.count
                    if cell.value > wide.value:  # the values differ, because equal values are in one narrow cell
                        wide.value, wide.at = cell.value, cell.at


LOOKS_BACK = (
    *("this occurrence", "the occurrence before", "this transfer", "this round", "the round before"),
    "the whole run",
)
MILLIONTHS = 1_000_000  # shares of time and values in LSB are counted in millionths
READ = "read"  # the `occurrence` of measures that take one value for each addressed phase, at the tick of its START


class Measure(Listener):
    """Base of all measures.

    worst, least: the largest and the smallest value.
    worst_until: for a count of unsolicited characters, the end of the first series of them without a pause, which
        begins at `worst_at`; else NO_TIME.
    not_before: occurrences before this tick do not count.
    occasions: the number of times at which a value should have been measured; None if the measure does not count them.
    unit: "time" (ticks), "%" and "LSB" (millionths), or a word for the things that are counted.
    series: True if the measure takes a series of values, which has percentiles; False if it is one number for a run.
    occurrence: READ if the measure takes one value for each addressed phase; else "". A budget can join only measures
        with READ.
    asked: the name of the occasions, in the plural, such as "reads asked".
    looks_back: the range of past records on which the next value can depend; one of LOOKS_BACK. STATE lists the
        attributes that remember these records. Attributes for values that were taken are results, not state.
    is_jitter: True if the measure takes the differences between successive values (cycle-to-cycle jitter).
    """

    STATE = State("_before _uncompared")
    unit = "time"
    series = True
    needs = ""  # what the scene must contain: "I2C-A", "rounds", "host", "serial" or "SCI"; "" for nothing
    asked = ""
    kinds: frozenset[Kind] = frozenset()

    def __init__(self) -> None:
        self.looks_back = "this occurrence"
        self.occurrence = ""
        self.count = 0
        self.worst = 0
        self.least = 0
        self.worst_at = NO_TIME
        self.worst_until = NO_TIME
        self.least_at = NO_TIME
        self.cut_off = 0  # number of values of occurrences that the end of the run cut off
        self.not_before = NO_TIME
        self.occasions: int | None = 0 if self.asked else None
        self.is_jitter = False
        self._before: int | None = None  # for a jitter: the last value; None before the first value
        # `_uncompared` is 1 for a jitter before its first occasion, which does not count, because there is no earlier
        # value to compare with. Otherwise, `_uncompared` is 0.
        self._uncompared = 0
        self._kept: tuple[array[int], array[int]] | None = None
        self.tally: Tally | None = None  # set before the first value if percentiles are needed
        self.refuted = ""  # why the budget is broken regardless of its values, such as a wrong reply; or ""
        self.refuted_at = NO_TIME
        self.refuted_until = NO_TIME
        self.not_judged = ""  # the reason why it is not known whether all occurrences keep the limit; or ""

    @property
    def subjects(self) -> Subjects:
        """A dictionary from a kind of record to the wires or registers (the subjects) whose records the measure needs.

        A kind that is not in the dictionary is needed for all wires and registers.
        """
        return {}

    @property
    def silent(self) -> bool:
        """True if nothing was measured, so that nothing is proven."""
        return not self.count

    @property
    def measured(self) -> int:
        """The number of events at which a value was measured."""
        return self.count

    @property
    def counted(self) -> int:
        """The count that verdicts show: the number of values."""
        return self.count

    def missing(self) -> str:  # core: python
        """Return the reason why nothing was measured; "" if no reason is known."""
        if self._before is not None and not self.count:
            return "there was only one value, and a jitter needs two"
        return self.why_silent()

    def why_silent(self) -> str:  # core: python
        """Return the reason why no value was taken; "" if no reason is known. Subclasses override this method.

        `missing` returns this reason, except for a jitter with one value, which has a reason of its own.
        """
        return ""

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        """Return (value so far, tick at which the occurrence began) of each occurrence that is not over at `now`."""
        return []

    def unfinished_text(self) -> str:
        """Return a phrase that says which occurrences were not over at the end of the run."""
        return ""

    def close(self, now: int) -> str:
        """Take the values of unfinished occurrences that exceed all complete values. A jitter takes none.

        Such a value would have grown in a longer run. So it counts as the smallest value only if there is no complete
        value. Return a phrase about these occurrences; "" if no value was taken.
        """
        if self.is_jitter:
            return ""
        most = self.worst if self.count else None
        for value, at in sorted(self.unfinished(now)):
            if at >= self.not_before and (most is None or value > most):
                self.take_unfinished(value, at)
        return self.unfinished_text() if self.cut_off else ""

    def listen(self, scene: MeasuredScene) -> None:  # core: python
        """Get from the scene what this measure needs in addition to records.

        Raise BadEvent if the case does not describe the reply, silence or watched wire that the measure names.
        """

    def subscribe(self, recorder: Recorder) -> None:
        """Subscribe to the records that this measure needs, so that they are made."""
        recorder.subscribe(self.kinds, self, self.subjects)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """Return the tag under which `on_record` receives these records; UNWANTED if they are not needed."""
        return UNWANTED

    def finish(self, now: int) -> None:  # core: python
        """Handle the end of the run."""

    # Taking and storing values -----------------------------------------------------------

    def become_jitter(self) -> None:
        """Take the differences between successive values instead of the values. Call this before the first value."""
        self.is_jitter = True
        self.looks_back = "the occurrence before"
        self.occurrence = ""
        self._uncompared = 1

    def keep(self) -> None:
        """Begin to store all values. Distributions, and budgets with joined conditions, need all values."""
        self._kept = array("q"), array("q")

    @property
    def kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        """The stored values and their ticks, both int64[count], in order; None unless `keep` was called."""
        if self._kept is None:
            return None
        import numpy as np  # imported here, because most runs do not need it

        values, at = self._kept
        return np.array(values, np.int64), np.array(at, np.int64)

    def all_kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return `kept`, the values and their ticks. Call it only after `keep`."""
        assert self.kept is not None
        return self.kept

    def only(self, places: NDArray[np.int64]) -> None:
        """Drop all stored values except those at these indices."""
        values, at = (column[places].tolist() for column in self.all_kept())
        self.count = self.cut_off = 0
        self.occasions = None  # the occasions are counted by the measure to which this measure is joined
        self.keep()
        if self.tally is not None:
            self.tally = Tally()
        for value, when in zip(values, at, strict=True):
            self.take(value, when)

    def occasion(self, at: int, number: int = 1) -> None:
        """Count `number` occasions at which a value should be measured. at: the tick of the value."""
        if at >= self.not_before:
            assert self.occasions is not None
            self.occasions += number - self._uncompared
            self._uncompared = 0

    def refute(self, why: str, at: int, until: int = NO_TIME) -> None:
        """Mark the budget as broken, whatever values follow.

        The fault lasts from tick `at` to tick `until`; NO_TIME for a fault at one instant. Only the first fault is
        stored. Faults before `not_before` are ignored.
        """
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
        if self.tally is not None:
            self.tally.add(value, at)

    def take_unfinished(self, value: int, at: int) -> None:
        """Take the value of an occurrence that is not over. The value must not be less than any earlier value."""
        least, least_at, alone = self.least, self.least_at, not self.count
        self.take(value, at)
        self.cut_off += 1
        if not alone:
            self.least, self.least_at = least, least_at


class MeasuredScene(Struct, frozen=True):
    """Values and functions of a scene. With them, measures get information that records do not contain.

    began: the tick at which the run begins.
    wire: returns the wire with a given name.
    value_of: returns the present value of a field, given its place and name, such as "dsp.I2C-A" and "I2CSTR.XRDY".
    clock_history: returns pairs (tick, SYSCLKOUT in Hz from then on) of a unit, up to now; of the first unit for "".
    i2c_release_delay: returns, for a unit, a function from the tick of a write of I2CDXR to the delay of the release of
        SCL after it, in ticks. The module has held SCL low until this write. The delay is that of the module's present
        settings.
    rounds_at_start: returns a function for measures to call at a START. It returns True if this START may begin a
        round.
    watcher: builds the wire watcher that the table [watch.NAME] describes, where NAME is the name of the measure. The
        watcher passes its results to the measure.
    on_reply: begins to report to a measure its requests, and what is sent to and by the SCI that should reply. It
        returns the expected reply, and a function that returns why the reply was never requested.
    on_unsolicited: begins to report to a measure the characters that belong to no expected reply. If the measure names
        a send, an entry of [[serial.send]], it reports also when this send begins and ends. It returns a function that
        returns characters as text, and a function that returns why this send never began.
    """

    began: int
    ticks_per_second: int
    wire: Callable[[str], Wire]
    value_of: Callable[[str, str], int]
    clock_history: Callable[[str], list[tuple[int, Fraction]]]
    i2c_release_delay: Callable[[str], Callable[[int], int]]
    rounds_at_start: Callable[[], Callable[[], bool]]
    watcher: Callable[[WatchedWire], WireWatcher]
    on_reply: Callable[[Reply], tuple[Expected, Callable[[], str]]]
    on_unsolicited: Callable[[Unsolicited], tuple[Callable[[tuple[int, ...]], str], Callable[[], str]]]
