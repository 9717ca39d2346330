"""What a budget can limit: happenings of a run go in as they happen, the worst value and when it was come out.

A measure keeps no history, so memory does not grow with the run, unless `keep` is asked for by whoever wants all
values; a percentile counts equal ones (`tally`). Each class says what it measures and from which event to which. The
list users choose from is in `registry`; measures of events that users name are in `event`.
"""

# core: compiled

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Protocol

from ...core.records import UNHEARD, Kind, Listener, Recorder, Subjects
from ...core.time import NO_TIME
from .tally import Tally

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...bus.i2c.transfer import Phase, Transfer
    from ...bus.receiver_listener import ReceiverListener
    from ...core.wire import Wire
    from ...devices.sensor_rounds import Round
    from ...devices.truth import Axes
    from ...devices.watchers import WireWatcher
    from .origins import Origin
    from .reply import Expected, Reply
    from .watched_wire import WatchedWire


class Delay(Protocol):
    def ticks(self, written: int) -> int:
        """Return the delay of a write at this tick, with the present settings."""


class ReadOrigins(Protocol):
    def of(self, phase: Phase) -> Origin | None:
        """Return the origin of what a phase of the transfer that is just over has read."""


class SceneEvents(Protocol):
    """What a scene lets a measure listen to and ask."""

    def on_transfer(self, told: Callable[[Transfer], None]) -> None: ...

    def on_round(self, told: Callable[[Round], None]) -> None: ...

    def on_frame(self, told: Callable[[int, tuple[int, ...], int], None]) -> None: ...

    def on_stuck(self, told: Callable[[int], None]) -> None: ...

    def on_sci(self, listener: ReceiverListener) -> None:
        """`listener` is told what becomes of each SCI's receiver."""

    def on_character(self, told: Callable[[int], None]) -> None:
        """`told(tick)` of each character to an SCI, and when its start bit began; at the latest as the run ends.

        Of one that goes to several it is told for each.
        """

    def origins(self) -> ReadOrigins:
        """Which host frame the bytes of a read come from."""

    def checks_host(self) -> bool:
        """Whether known chips are to show values of host frames."""

    def on_reply(self, reply: Reply) -> tuple[Expected, Callable[[], str]]:
        """Tell a measure of a reply what it listens to. What is expected; why it was never asked for, as a phrase."""

    def watcher(self, measure: WatchedWire) -> WireWatcher:
        """Who watches the wire that the measure is named for, and tells it what he finds."""

    def on_round_due(self, told: Callable[[int], None]) -> None:
        """`told(tick)` of each round that was due, and when, whether it began or not; at the latest as the run ends."""

    def on_missed_round(self, told: Callable[[int], None]) -> None:
        """The same of those that did not begin while they were due."""

    def rounds_at_start(self) -> Callable[[], bool]:
        """To be asked at a START that is no repeated one: whether it begins a round."""

    def round_period(self) -> int:
        """From one round's due time to the next one's, in ticks."""

    def began(self) -> int:
        """The tick at which the run begins."""

    def wire(self, name: str) -> Wire: ...

    def level_of(self, wire: str) -> int:
        """The level of a wire now."""

    def value_of(self, place: str, name: str) -> int:
        """What a field holds now: of "dsp.I2C-A" that of "I2CSTR.XRDY"."""

    def ticks_per_second(self) -> int: ...

    def clock_history(self, unit: str) -> list[tuple[int, Fraction]]:
        """SYSCLKOUT of a unit in Hz from each tick on, up to now; of the first one where none is named."""

    def i2c_release_delay(self, unit: str) -> Delay:
        """From a write of I2CDXR that SCL is held for to its release."""

    def open_transfer(self) -> Transfer | None:
        """A firmware's transfer without a STOP yet, if it has an address; a controller agent's is None: it goes on."""

    def held_since(self) -> int:
        """Since when others hold SCL low that the master has let go of; NO_TIME if they do not."""

    def host_values(self, number: int) -> tuple[int, ...]: ...

    def frame_due(self, number: int) -> int:
        """The tick at which a host frame is due."""

    def truth_at(self, tick: int) -> Mapping[str, Axes]:
        """What each chip should show at this tick."""


MILLIONTHS = 1_000_000  # parts of the time and LSB are counted in these
MODEL = "model"  # the span in which firmware computes sensor models
READ = "read"  # an occurrence: one addressed phase, which begins with its START


class Measure(Listener):
    """unit: "time" (ticks), "%" and "LSB" (millionths) or a word for what is counted. worst: the largest value seen.

    least: the smallest. series: it takes one value after the other, of which there are percentiles. occurrence: what
    it takes a value of; measures of the same occurrences can be joined. not_before: the tick from which on it takes.

    occasions: how often there was something to measure, counted on the bus and not by the firmware: None where the
    measure has no such count. asked: what these are, as a plural.
    """

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
        """The subjects that it needs records of, for kinds of which it does not need all."""
        return {}

    def __init__(self) -> None:
        self.count = 0
        self.worst = 0
        self.least = 0
        self.worst_at = NO_TIME
        self.least_at = NO_TIME
        self.cut_off = 0  # of these, how many the end of the run cut off
        self.not_before = NO_TIME
        self.not_judged = ""  # why it is not known whether all occurrences keep the limit
        self.occasions: int | None = 0 if self.asked else None
        self.tap: Callable[[int, int], None] | None = None  # told of each value that is taken
        self._kept: tuple[array[int], array[int]] | None = None
        self._tally: Tally | None = None

    @property
    def silent(self) -> bool:
        """Nothing was measured, so nothing is proven."""
        return not self.count

    @property
    def measured(self) -> int:
        """How many of the occasions were measured."""
        return self.count

    @property
    def counted(self) -> int:
        """What verdicts show as the count: how many values there are."""
        return self.count

    def missing(self) -> str:  # core: python
        """Why nothing was measured, where more can be said than that."""
        return ""

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        """(what it has come to, as given to `take`, when it began) of each occurrence that is not over."""
        return []

    def unfinished_text(self) -> str:
        """What is not over, as a phrase."""
        return ""

    def close(self, now: int) -> str:
        """Count what is not over after the run, where it has come to more than everything that is; that as a phrase.

        It may come to more yet, so it says nothing of the least.
        """
        most = self.worst if self.count else None
        for value, at in sorted(self.unfinished(now)):
            if at >= self.not_before and (most is None or value > most):
                self.take_unfinished(value, at)
        return self.unfinished_text() if self.cut_off else ""

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
        """(values, when each was), both int64[count], as they came; None where `keep` was not asked for."""
        if self._kept is None:
            return None
        import numpy as np  # with the first percentile: most runs need none

        values, at = self._kept
        return np.array(values, np.int64), np.array(at, np.int64)

    def all_kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """As `kept`, where they are known to be."""
        assert self.kept is not None
        return self.kept

    def only(self, places: NDArray[np.int64]) -> None:
        """Forget all kept values but those at these places."""
        values, at = (column[places].tolist() for column in self.all_kept())
        self.count = self.cut_off = 0
        self.occasions = None  # the measure that it is joined to has them
        self.keep()
        if self._tally is not None:
            self.tally()
        for value, when in zip(values, at, strict=True):
            self.take(value, when)

    def percentile(self, per_mille: int) -> tuple[int, int]:
        """(value, when first): the least value that so many of a thousand do not exceed (nearest rank)."""
        assert self._tally is not None
        return self._tally.percentile(per_mille)

    def listen(self, scene: SceneEvents) -> None:  # core: python
        """Ask the scene for what this measure needs."""

    def subscribe(self, recorder: Recorder) -> None:
        """Have the records made that it looks at, and be told of them."""
        recorder.subscribe(self.kinds, self, self.subjects)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """What `hear` is told with records of this kind, place and thing; UNHEARD where it has no use for them."""
        return UNHEARD

    def finish(self, now: int) -> None:  # core: python
        """The run is over."""

    def occasion(self, at: int, number: int = 1) -> None:
        """There was so often something to measure. at: as given to `take`."""
        if at >= self.not_before:
            assert self.occasions is not None
            self.occasions += number

    def take(self, value: int, at: int) -> None:
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
        if self.tap is not None:
            self.tap(value, at)

    def take_unfinished(self, value: int, at: int) -> None:
        """`value` so far, more than any before."""
        least, least_at, alone = self.least, self.least_at, not self.count
        self.take(value, at)
        self.cut_off += 1
        if not alone:
            self.least, self.least_at = least, least_at


class Counter(Measure):  # core: python
    """Counts something: worst is how many there were, worst_at when the first one was. Zero is a value.

    Verdicts show at how many of its occasions it was measured, where it has any.
    """

    unit = "count"
    series = False

    @property
    def silent(self) -> bool:
        return False

    @property
    def counted(self) -> int:
        return self.count if self.occasions is None else self.measured

    def one_more(self, at: int, by: int = 1) -> None:
        if not self.count:
            self.worst_at = self.least_at = at
        self.count += by
        self.worst = self.least = self.count
