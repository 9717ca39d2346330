"""What a budget can limit: happenings of a run go in as they happen, the worst value and when it was come out.

A measure keeps no history, so memory does not grow with the run, unless `keep` is asked for: by a percentile, or by
whoever wants all values. Each class says what it measures and from which event to which. `MEASURES` is the list users
choose from; measures of events that users name are in `event_measures`.
"""

from __future__ import annotations

from array import array
from collections import OrderedDict
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..core.records import Kind, Record, Subjects
from ..core.time import NO_TIME
from ..devices.host_pc import FRAME_BYTES
from ..devices.sensor_head import CHIPS, Round
from ..devices.truth import Axes, shown
from ..lines.i2c_controller import Transfer


class Happenings(Protocol):
    """What a scene lets a measure listen to and ask."""

    def listen_transfers(self, told: Callable[[Transfer], None]) -> None: ...

    def listen_rounds(self, told: Callable[[Round], None]) -> None: ...

    def listen_frames(self, told: Callable[[int, tuple[int, ...], int], None]) -> None: ...

    def listen_stuck(self, told: Callable[[int], None]) -> None: ...

    def listen_sci(self, told: Callable[[int, int, bool], None]) -> None:
        """`told(tick, words in the receive FIFO, something was overrun)` on every change."""

    def checks_host(self) -> bool:
        """Whether known chips are to show values of host frames."""

    def listen_missed(self, told: Callable[[int], None]) -> None:
        """`told(tick)` when a round was due and could not begin."""

    def transfers_in_round(self) -> int: ...

    def startup_transfers(self) -> int:
        """How many transfers there are before the first round."""

    def round_period(self) -> int:
        """From one round's due time to the next one's, in ticks."""

    def began(self) -> int:
        """The tick at which the run begins."""

    def level_of(self, wire: str) -> int:
        """The level of a wire now."""

    def value_of(self, place: str, name: str) -> int:
        """What a field holds now: of "dsp.I2C-A" that of "I2CSTR.XRDY"."""

    def ticks_per_second(self) -> int: ...

    def sysclk(self, unit: str) -> Fraction:
        """SYSCLKOUT of a unit in Hz, as it is now; of the first one where none is named."""

    def cpu_cycles(self, unit: str) -> tuple[int, int]:
        """(cycles in computations and service routines, all cycles) of a unit, so far."""

    def host_values(self, number: int) -> tuple[int, ...]: ...

    def frame_due(self, number: int) -> int:
        """The tick at which a host frame is due."""

    def truth_at(self, tick: int) -> Mapping[str, Axes]:
        """What each chip should show at this tick."""


MILLIONTHS = 1_000_000  # parts of the time and LSB are counted in these
MODEL = "model"  # the span in which firmware computes sensor models
READ = "read"  # an occurrence: one addressed phase, which begins with its START


class Measure:
    """unit: "time" (ticks), "%" and "LSB" (millionths) or a word for what is counted. worst: the largest value seen.

    least: the smallest. series: it takes one value after the other, of which there are percentiles. occurrence: what
    it takes a value of; measures of the same occurrences can be joined. not_before: the tick from which on it takes.
    """

    unit = "time"
    series = True
    needs = ""  # what a scene must have for this to mean anything: "controller", "host" or "SCI-A"
    occurrence = ""
    kinds: frozenset[Kind] = frozenset()

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
        self.total = 0
        self.not_before = NO_TIME
        self._kept: tuple[array[int], array[int]] | None = None

    @property
    def silent(self) -> bool:
        """Nothing was measured, so nothing is proven."""
        return not self.count

    def missing(self) -> str:
        """Why nothing was measured, where more can be said than that."""
        return ""

    def waits(self) -> tuple[int, str]:
        """Since when an event waits for the one that would end it, and that as a phrase; NO_TIME if none does."""
        return NO_TIME, ""

    def keep(self) -> None:
        """Keep every value, for percentiles and distributions."""
        self._kept = array("q"), array("q")

    @property
    def kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        """(values, when each was), both int64[count], as they came; None where `keep` was not asked for."""
        if self._kept is None:
            return None
        values, at = self._kept
        return np.array(values, np.int64), np.array(at, np.int64)

    def all_kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """As `kept`, where they are known to be."""
        assert self.kept is not None
        return self.kept

    def only(self, places: NDArray[np.int64]) -> None:
        """Forget all kept values but those at these places."""
        values, at = (column[places].tolist() for column in self.all_kept())
        self.count = self.total = 0
        self.keep()
        for value, when in zip(values, at, strict=True):
            self.take(value, when)

    def percentile(self, per_mille: int) -> tuple[int, int]:
        """(value, when first): the least value that so many of a thousand do not exceed (nearest rank)."""
        values, at = self.all_kept()
        rank = -(-per_mille * len(values) // 1000) - 1
        value = np.partition(values, rank)[rank]
        return int(value), int(at[np.argmax(values == value)])

    def listen(self, scene: Happenings) -> None:
        """Ask the scene for what this measure needs."""

    def record(self, record: Record) -> None:
        """One record of `kinds`."""

    def finish(self, now: int) -> None:
        """The run is over."""

    def take(self, value: int, at: int) -> None:
        if at < self.not_before:
            return
        if not self.count or value > self.worst:
            self.worst, self.worst_at = value, at
        if not self.count or value < self.least:
            self.least, self.least_at = value, at
        self.count += 1
        self.total += value
        if self._kept is not None:
            self._kept[0].append(value)
            self._kept[1].append(at)


class Counter(Measure):
    """Counts something: worst is how many there were, worst_at when the first one was. Zero is a value."""

    unit = "count"
    series = False

    @property
    def silent(self) -> bool:
        return False

    def one_more(self, at: int, by: int = 1) -> None:
        if not self.count:
            self.worst_at = self.least_at = at
        self.count += by
        self.worst = self.least = self.count


class SpanTime(Measure):
    """From the begin of a named stretch of firmware to its end, service routines in between included."""

    kinds = frozenset({Kind.SPAN})

    def __init__(self, name: str) -> None:
        super().__init__()
        self._name = name
        self._began: dict[str, int] = {}

    def record(self, record: Record) -> None:
        if record.what != self._name:
            return
        if record.value:
            self._began[record.where] = record.tick
        elif record.where in self._began:
            began = self._began.pop(record.where)
            self.take(record.tick - began, began)


class Response(Measure):
    """From the SCL fall that ends the ACK slot of a read address to the SCL rise of the first data bit."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        scene.listen_transfers(self._transfer)

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            if phase.read and phase.answer_at != NO_TIME:
                self.take(phase.answer_at - phase.answer_from, phase.answer_from)


class Stretch(Measure):
    """Longest time the other side held SCL low beyond the controller's own low time, per acknowledged phase."""

    needs = "controller"
    occurrence = READ

    def listen(self, scene: Happenings) -> None:
        scene.listen_transfers(self._transfer)

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            if phase.acked:
                self.take(phase.stretch, phase.start_at)


class RoundTime(Measure):
    """From the moment at which a round was due to its last STOP."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        scene.listen_rounds(self._round)

    def _round(self, over: Round) -> None:
        self.take(over.end - over.due, over.due)


class MissedRounds(Counter):
    """Rounds that could not begin when they were due, since the one before still ran."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        scene.listen_missed(self.one_more)


class NackedRounds(Counter):
    """Rounds with at least one request whose address nobody acknowledged."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        scene.listen_rounds(self._round)

    def _round(self, over: Round) -> None:
        if over.nacked:
            self.one_more(over.due)


class Nacked(Counter):
    """Requests whose address nobody acknowledged."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        scene.listen_transfers(self._transfer)

    def _transfer(self, transfer: Transfer) -> None:
        if not transfer.acked and transfer.phases[0].start_at != NO_TIME:
            self.one_more(transfer.phases[0].start_at)


class WrongBytes(Measure):
    """Bytes read that are not what they should be: `expect` of the request, or the values of a recent host frame.

    worst is how many were wrong, count how many were compared: a run that compared nothing proves nothing.
    """

    needs = "controller"
    RECENT = 8  # frames that a sample may come from
    unit = "bytes"
    series = False

    def listen(self, scene: Happenings) -> None:
        self._chips = {chip.address: name for name, chip in CHIPS.items()} if scene.checks_host() else {}
        self._recent: OrderedDict[int, tuple[int, ...]] = OrderedDict({-1: (0,) * 6})
        self.where: dict[str, int] = {}  # "gyroscope byte 0" -> how often it was wrong
        self.first = ""  # the first wrong read, as a sentence
        scene.listen_transfers(self._transfer)
        scene.listen_frames(self._frame)

    def _frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        self._recent[number] = values
        while len(self._recent) > self.RECENT:
            self._recent.popitem(last=False)

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            if phase.read and phase.got:
                wanted = self._wanted(phase.address, bytes(phase.got), phase.expect)
                wrong = [i for i, (a, b) in enumerate(zip(phase.got, wanted, strict=False)) if a != b]
                self.count += min(len(phase.got), len(wanted))
                if wrong:
                    if not self.worst:
                        self.worst_at = self.least_at = phase.start_at
                        self.first = f"{transfer.name} read {phase.got.hex(' ')} where {wanted.hex(' ')} was expected"
                    self.worst = self.least = self.worst + len(wrong)
                for i in wrong:
                    place = f"{transfer.name} byte {i}"
                    self.where[place] = self.where.get(place, 0) + 1

    def _wanted(self, address: int, got: bytes, expect: bytes | None) -> bytes:
        """What `got` should have been: of all candidates the one that agrees in the most bytes."""
        if expect is not None:
            return expect
        if address not in self._chips:
            return b""
        name = self._chips[address]
        chip = CHIPS[name]
        candidates = []
        for values in reversed(self._recent.values()):  # the last frame's is the usual one
            three = shown(values)[name]
            in_order = [three[axis] for axis in chip.order]
            wanted = b"".join([v.to_bytes(2, "big" if chip.big else "little", signed=True) for v in in_order])
            if wanted == got:
                return wanted
            candidates.append(wanted)
        return max(candidates, key=lambda c: sum(a == b for a, b in zip(c, got, strict=False)))


class Age(Measure):
    """From the end of a host frame to the START of the first read that carries its values."""

    needs = "host"
    occurrence = READ
    RECENT = 64

    def listen(self, scene: Happenings) -> None:
        self._chip = CHIPS["gyroscope"]
        self._waiting: OrderedDict[tuple[int, ...], int] = OrderedDict()
        scene.listen_frames(self._frame)
        scene.listen_transfers(self._transfer)

    def _frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        self._waiting[values[0:3]] = tick
        if len(self._waiting) > self.RECENT:
            self._waiting.popitem(last=False)

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            if phase.read and phase.address == self._chip.address and len(phase.got) == 6:
                sent = self._waiting.pop(self._chip.values(bytes(phase.got)), None)
                if sent is not None:
                    self.take(phase.start_at - sent, phase.start_at)


class ModelAge(Measure):
    """From the end of the last host frame that was whole when the models began to the first read of what they made.

    As `age`, for firmware whose chips do not show the values of frames. Each known chip's first read counts, from its
    START; and a frame that is worked on once more, since no other has come, counts once more.
    """

    needs = "host"
    occurrence = READ
    kinds = frozenset({Kind.SPAN})

    def listen(self, scene: Happenings) -> None:
        self._addresses = {chip.address for chip in CHIPS.values()}
        self._sent = NO_TIME  # the end of the last whole frame,
        self._taken = NO_TIME  # of the one that the models under way work on,
        self._made = NO_TIME  # and of the one that the last models worked on
        self._unread: set[int] = set()  # chips whose values, from there, no read has carried yet
        scene.listen_frames(self._frame)
        scene.listen_transfers(self._transfer)

    def missing(self) -> str:
        return f"no chip was read after a span {MODEL!r} that began after a host frame had come"

    def _frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        self._sent = tick

    def record(self, record: Record) -> None:
        if record.what != MODEL:
            return
        if record.value:
            self._taken = self._sent
        elif self._taken != NO_TIME:
            self._made, self._unread = self._taken, set(self._addresses)

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            if phase.read and phase.got and phase.address in self._unread:
                self._unread.remove(phase.address)
                self.take(phase.start_at - self._made, phase.start_at)


class FifoHighWater(Measure):
    """Most words that ever waited in the SCI receive FIFO."""

    needs = "SCI-A"
    unit = "words"

    def listen(self, scene: Happenings) -> None:
        scene.listen_sci(self._sci)

    def _sci(self, tick: int, words: int, overrun: bool) -> None:
        self.take(words, tick)


class Overruns(Counter):
    """Characters lost in the SCI: FIFO overflow (RXFFOVF) or SCIRXBUF overrun (OE), counted as they happen."""

    needs = "SCI-A"

    def listen(self, scene: Happenings) -> None:
        scene.listen_sci(self._sci)

    def _sci(self, tick: int, words: int, overrun: bool) -> None:
        if overrun:
            self.one_more(tick)


class Stuck(Counter):
    """Times a line was held low longer than the controller's `stuck_after`."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        scene.listen_stuck(self.one_more)


SPAN = "span:"

MEASURES: dict[str, type[Measure]] = {
    "response": Response,
    "stretch": Stretch,
    "round": RoundTime,
    "missed rounds": MissedRounds,
    "nacked rounds": NackedRounds,
    "nacked": Nacked,
    "wrong bytes": WrongBytes,
    "age": Age,
    "model age": ModelAge,
    "fifo high-water": FifoHighWater,
    "overruns": Overruns,
    "stuck": Stuck,
}

assert FRAME_BYTES == 12  # the word positions above are those of this frame


def make(name: str) -> Measure:
    """The measure that a budget names: one of MEASURES, or "span:NAME". KeyError otherwise."""
    if name.startswith(SPAN):
        return SpanTime(name.removeprefix(SPAN))
    return MEASURES[name]()
