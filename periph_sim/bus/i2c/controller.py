"""An I2C controller: drives SCL and SDA for transfers, and stores the results in the `Transfer` objects.

    Transfer --> bits --> SCL, SDA
                  ^--- the actual lines: stretching, ACKs, data, arbitration

The controller makes one transfer, from START to STOP, at a time. Each bit begins with the fall of SCL. If SDA must
change, it changes `hold` after the fall. SCL is released `low` after the fall, and falls again `high` after its actual
rise. SDA is sampled at the end of the high phase. Each bit takes two or three events of the kernel.

Source: UM10204 sections 3.1.1 to 3.1.10 (bus protocol), Table 10 (times).
"""

# core: compiled without checks for None

from __future__ import annotations

from collections.abc import Callable

from ...core.agent import Event
from ...core.kernel import Kernel
from ...core.records import Kind, Recorder, Topic
from ...core.sampler import Sampler, watch
from ...core.state import State
from ...core.time import NO_TIME
from ...core.wire import Wire
from .bit_skip import BitParty
from .bus_clear import BusClear
from .filtered_bus import FilteredBus
from .line_events import SCL
from .transfer import BusTiming, Phase, Transfer

# Tags of the controller's events. Each names the next step of a transfer; STUCK checks for a stuck line.
BEGIN, FIRST_LOW, SDA_FOLLOWS, RELEASE, BIT_END, STOP_RISES, STUCK = range(7)
OF_AGENT = ("arbitration lost", "clear", "stuck")  # events that only the controller itself can report
ADDRESS = -1  # value of `_index` during an address byte
NO_BYTE = 1 << 30  # value of `_index` after the last byte of a phase, when a STOP or repeated START is next


class I2cController(BitParty):
    """An agent that makes transfers on SCL and SDA.

    who: the controller's name on the wires and in records.
    beside_others: True if a `BusRecorder` records the events on the wires, so the controller records only OF_AGENT.
    stuck_after: a time in ticks, or 0 for never. If SCL does not change for this time while the controller waits for
        the bus or for the rise of SCL, `on_stuck` is called with the stuck line.
    clear_after: a time in ticks, or 0 for never. If SCL stays high for this time while a START is blocked, because SDA
        is low or a STOP is missing, the controller clears the bus. It is 0 on buses with other controllers.
    gives_up: True if a NACK of a written byte ends the transfer with a STOP; False if the transfer then continues with
        its next phase. A NACK of the address always ends the transfer.
    """

    STATE = State(
        "busy _sda_level _rising _high _high_end _transfer _done _phase _phase_index _stretch _wanted "
        "_acks _got _byte _bit _in _index _receiving _bus _next _guard _clear _sampler",
        ticks="_let_go_at _refused_since",
        expires="_let_go_at",
    )

    __slots__ = (
        "_acks",
        "_bit",
        "_bus",
        "_byte",
        "_clear",
        "_clear_after",
        "_done",
        "_gives_up",
        "_got",
        "_guard",
        "_high",
        "_high_end",
        "_hold",
        "_in",
        "_index",
        "_kernel",
        "_let_go_at",
        "_low_time",
        "_next",
        "_on_stuck",
        "_phase",
        "_phase_index",
        "_receiving",
        "_recorder",
        "_refused_since",
        "_rising",
        "_sampler",
        "_scl_mask",
        "_scl_wire",
        "_sda_level",
        "_sda_mask",
        "_sda_wire",
        "_stretch",
        "_stuck_after",
        "_topics",
        "_transfer",
        "_wanted",
        "beside_others",
        "busy",
        "timing",
        "who",
    )

    _recorder: Recorder | None
    _sampler: Sampler
    _bus: FilteredBus
    _clear: BusClear
    _low_time: int
    _hold: int
    _high: int

    def __init__(
        self,
        kernel: Kernel,
        recorder: Recorder,
        scl: Wire,
        sda: Wire,
        timing: BusTiming,
        who: str = "controller",
        stuck_after: int = 0,
        on_stuck: Callable[[Wire], None] | None = None,
        clear_after: int = 0,
        gives_up: bool = False,
    ) -> None:
        self.who = who
        self.timing = timing
        self._low_time, self._hold = timing.low, timing.hold
        self.busy = False
        self._kernel = kernel
        self._recorder = recorder if recorder.wants(Kind.BUS) else None
        self.beside_others = False
        self._topics: dict[str, Topic] = {}  # maps the name of an event to the topic of its records
        self._scl_wire = scl
        self._sda_wire = sda
        self._scl_mask = scl.attach(who).mask
        self._sda_mask = sda.attach(who).mask
        self._stuck_after = stuck_after
        self._on_stuck = on_stuck
        self._next: Event = kernel.event(self)  # the event of the next step of a transfer
        self._guard: Event | None = None  # the scheduled check for a stuck line; None if no check is scheduled
        self._sda_level = 1
        self._rising = False  # True if SCL is released and has not risen yet
        self._high = timing.high  # duration of the next high phase of SCL, in ticks
        self._high_end = BIT_END  # the tag of the event at the end of the next high phase of SCL
        self._let_go_at = 0
        self._transfer = Transfer("", [])
        self._done: Callable[[Transfer], None] = lambda transfer: None
        self._phase = Phase(0, False)
        self._phase_index = 0
        self._stretch = 0  # the longest clock stretch in the present phase, in ticks
        self._wanted = 0  # number of data bytes to transfer in the phase
        self._acks: list[bool] = []  # for each data byte of the phase so far, True if it was acknowledged
        self._got = bytearray()  # the data bytes read so far in the phase
        self._byte = 0  # the byte that is sent, or 0xFF while receiving
        self._bit = 0  # number of the bit in the byte: 0 to 7, or 8 for the ACK
        self._in = 0  # the value of the bits of this byte that were sampled so far
        self._index = NO_BYTE  # number of the present data byte, from 0; or ADDRESS or NO_BYTE
        self._receiving = False
        self._gives_up = gives_up
        self._clear_after = clear_after
        self._refused_since = NO_TIME  # the tick since which a START has had to wait for the bus; NO_TIME if none waits
        masks, times = (self._scl_mask, self._sda_mask), (timing.low, timing.high, timing.hold)
        self._clear = BusClear(kernel, scl, sda, masks, times, self._cleared)
        self._bus = FilteredBus(kernel.now, timing.filter, timing.free)
        self._sampler = watch([scl, sda], self)

    @property
    def held_since(self) -> int:
        """The tick at which the controller released SCL, while SCL is still low; else NO_TIME."""
        return self._let_go_at if self._rising else NO_TIME

    def act(self, tag: int) -> None:
        if tag == RELEASE:
            self._release()
        elif tag == BIT_END:
            self._bit_end()
        elif tag == SDA_FOLLOWS:
            self._sda_wire.pull(self._sda_mask, self._sda_level)
            self._then(self._kernel.now + self._low_time - self._hold, RELEASE)
        elif tag == BEGIN:
            self._start()
        elif tag == FIRST_LOW:
            self._high, self._high_end = self.timing.high, BIT_END
            self._low(self._byte >> 7 & 1)
        elif tag == STOP_RISES:
            self._stop()
        else:
            self._stuck()

    # Transfers ----------------------------------------------------------------

    def begin(self, transfer: Transfer, done: Callable[[Transfer], None]) -> None:
        """Start a transfer as soon as the bus has been free long enough.

        done: called with the transfer at its STOP, or earlier if the transfer is lost.

        Raise ValueError if the controller is making a transfer already.
        """
        if self.busy:
            raise ValueError(f"{self.who}: asked for transfer {transfer.name!r} while {self._transfer.name!r} runs")
        self.busy = True
        self._transfer = transfer
        self._done = done
        self._phase_index = 0
        self._index = NO_BYTE  # it is still ADDRESS if the previous transfer lost arbitration in an address byte
        self._bus.settle(self._kernel.now)
        self._then(max(self._kernel.now, self._bus.last_stop + self.timing.free), BEGIN)

    def bytes_under_way(self) -> int:
        """Return the number of whole bytes so far in the present transfer, addresses included; 0 between transfers."""
        return self._transfer.wire_bytes - (self._index == ADDRESS) if self.busy else 0

    def _start(self) -> None:
        now = self._kernel.now
        if not self._may_start(now):
            self._watch_stuck()
            if self._refused_since == NO_TIME:
                self._refused_since = now
            if self._may_clear(now):
                self._clear.begin()
                return
            free_at = self._bus.last_stop + self.timing.free
            self._then(free_at if free_at > now else now + self.timing.free, BEGIN)
            return
        self._disarm_guard()
        self._refused_since = NO_TIME
        phase = self._phase = self._transfer.phases[self._phase_index]
        phase.start_at = now
        self._stretch, self._acks, self._got = phase.stretch, phase.acks, phase.got
        self._wanted = phase.count if phase.read else len(phase.data)
        self._set_sda(0)
        self._mark("START" if self._phase_index == 0 else "repeated START", 0)
        byte = phase.address << 1 | phase.read if phase.address_byte is None else phase.address_byte
        self._load(byte, ADDRESS, False)
        self._then(now + self.timing.start_hold, FIRST_LOW)

    def _may_start(self, now: int) -> bool:
        """Return True if both lines are high and the bus is in use by this controller or was free long enough."""
        if not self._scl_wire.level or not self._bus.sda(self._kernel.now):
            return False
        return self._phase_index > 0 or not (self._bus.busy or now < self._bus.last_stop + self.timing.free)

    def _may_clear(self, now: int) -> bool:
        if not self._clear_after or not self._scl_wire.level:
            return False
        return now - max(self._refused_since, self._bus.scl_moved) >= self._clear_after

    def _cleared(self, clocks: int, free: bool) -> None:
        """Continue after a bus clear. free: True if SDA is high, so that the STOP of the bus clear was made.

        This STOP ends a transfer that was about to make a repeated START: the transfer is lost. In all other cases the
        START is tried again. clocks: the number of clocks of the bus clear.
        """
        self._mark("clear", clocks)
        self._refused_since = NO_TIME
        if free and self._phase_index:
            self._disarm_guard()
            self._transfer.lost = True
            self._finish()
        else:
            self._then(max(self._kernel.now, self._bus.last_stop + self.timing.free), BEGIN)

    def sampled(self, now: int, levels: int) -> None:
        self._bus.sampled(now, levels)
        if self._rising:
            if levels & SCL:
                self._rising = False
                self._disarm_guard()
                stretch = now - self._let_go_at
                if stretch > self._stretch:
                    self._stretch = self._phase.stretch = stretch
                if self._index == 0 and self._bit == 0:
                    self._phase.answer_at = now
                self._then(now + self._high, self._high_end)
            else:
                self._watch_stuck()

    def _then(self, time: int, tag: int) -> None:
        self._kernel.reschedule(self._next, time, tag)

    # Bits ---------------------------------------------------------------------

    def _load(self, byte: int, index: int, receiving: bool) -> None:
        self._byte, self._index, self._receiving = byte, index, receiving
        self._bit = self._in = 0

    def _low(self, sda: int) -> None:
        """Pull SCL low. SDA will change to `sda` after the hold time, and SCL will be released after the low time."""
        self._scl_wire.pull(self._scl_mask, 0)
        if sda == self._sda_level:
            self._then(self._kernel.now + self._low_time, RELEASE)
        else:
            self._sda_level = sda
            self._then(self._kernel.now + self._hold, SDA_FOLLOWS)

    def _set_sda(self, level: int) -> None:
        self._sda_level = level
        self._sda_wire.pull(self._sda_mask, level)

    def _release(self) -> None:
        """Release SCL. SCL rises now, or later if another party holds it low; `sampled` handles the rise."""
        self._scl_wire.pull(self._scl_mask, 1)
        self._let_go_at = self._kernel.now
        self._rising = True
        self._sampler.request_sample()

    def _bit_end(self) -> None:
        """End the high phase: sample SDA and begin the next bit."""
        level = self._bus.sda(self._kernel.now)
        bit = self._bit
        if bit == 8:
            self._byte_end(level == 0)
            return
        if level == 0 and self._sda_level and not self._receiving:
            self._transfer.lost = True
            self._mark("arbitration lost", 0)
            self._set_sda(1)
            self._finish()
            return
        self._in = self._in << 1 | level
        self._bit = bit = bit + 1
        if bit < 8:
            self._low(self._byte >> (7 - bit) & 1)
        else:  # all bytes that are read are acknowledged, except the last one
            self._low(int(not self._receiving or self._index + 1 >= self._wanted))

    # Bytes --------------------------------------------------------------------

    def _byte_end(self, ack: bool) -> None:
        phase = self._phase
        # True for a NACK by the target. A NACK by this controller is not a refusal: it ends a read.
        refused = not ack and (self._index < 0 or not self._receiving)
        if self._index < 0:
            phase.acked = ack
            self._mark("address", self._in << 1 | (not ack))
        else:
            self._acks.append(ack)
            self._mark("byte", self._in << 1 | (not ack))
            if self._receiving:
                self._got.append(self._in)
        following = self._index + 1
        if self._index < 0 and ack:
            phase.answer_from = self._kernel.now
        if following < self._wanted and (ack or (self._receiving and self._index >= 0)):
            if self._receiving or phase.read:
                self._load(0xFF, following, True)
            else:
                self._load(phase.data[following], following, False)
            self._low(self._byte >> 7 & 1)
            return
        if refused:
            self._mark("NACK", int(self._index >= 0))
        gives_up = refused and (self._index < 0 or self._gives_up)
        self._load(0xFF, NO_BYTE, False)
        if self._phase_index + 1 < len(self._transfer.phases) and not gives_up:
            self._phase_index += 1
            self._high, self._high_end = self.timing.start_setup, BEGIN
            self._low(1)
        else:
            self._high, self._high_end = self.timing.stop_setup, STOP_RISES
            self._low(0)

    def _stop(self) -> None:
        self._set_sda(1)
        self._mark("STOP", 0)
        self._finish()

    def _finish(self) -> None:
        self.busy = False
        self._transfer.stop_at = self._kernel.now
        self._done(self._transfer)

    # Stuck lines ------------------------------------------------------------------

    def _watch_stuck(self) -> None:
        if self._stuck_after and not self._guard:
            self._guard = self._kernel.schedule(self._kernel.now + self._stuck_after, self, STUCK)

    def _disarm_guard(self) -> None:
        if self._guard:
            self._kernel.cancel(self._guard)
            self._guard = None

    def _stuck(self) -> None:
        self._guard = None
        due = self._bus.scl_moved + self._stuck_after
        if due > self._kernel.now:  # SCL has changed since the check was scheduled
            self._guard = self._kernel.schedule(due, self, STUCK)
            return
        wire = self._sda_wire if self._scl_wire.level else self._scl_wire
        self._mark("stuck", wire.level)
        if self._on_stuck is not None:
            self._on_stuck(wire)

    def _mark(self, what: str, value: int) -> None:
        if self._recorder is None or (self.beside_others and what not in OF_AGENT):
            return
        topic: Topic | None = self._topics.get(what)
        if topic is None:
            topic = self._topics[what] = self._recorder.topic(Kind.BUS, self.who, what)
        topic.emit(self._kernel.now, value, self._transfer.name)
