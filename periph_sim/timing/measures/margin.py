"""Measure of the margin of writes to I2CDXR.

    SCL    ─┐___________┌─┐_        the controller releases SCL at g; the first bit of the byte must be ready then
    ACK end             g
    write      w--------|           margin: g - w - d; d: delay from a write to the module's release of SCL
    late                |----w      negative: SCL is held low for this time

The write of a byte is the last write before I2CDXR is copied to I2CXSR. XRDY = 1 shows that I2CDXR is empty.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable

from ...core.records import UNWANTED, Kind, Recorder, Subjects
from ...core.state import State
from ...core.time import NO_TIME
from .bus_from_wires import BusFromWires
from .measure import Measure, MeasuredScene

WRITE, XRDY = 0, 1  # tags of records: writes of I2CDXR, changes of XRDY
THINGS = {(Kind.ACCESS, "W I2C-A.I2CDXR"), (Kind.FLAG, "I2CSTR.XRDY")}


class _Reads(BusFromWires):
    """Finds the bytes that the unit sends as a slave, and the tick at which the controller needs each of them."""

    def __init__(self, unit: str, measure: Margin) -> None:
        super().__init__(unit)
        self._measure = measure

    def first_bit(self, let_go: int, rose: int) -> None:
        if self.stream.read and self.ours:
            self._measure.needed(let_go, rose)


class Margin(Measure):
    """Time from the write of I2CDXR to the latest tick at which this write would be early enough.

    A write is early enough if the module releases SCL no later than the controller does. The margin is negative if the
    write came later, so that the module held SCL low. It is measured for each byte that a unit sends as a slave.
    """

    STATE = State("bus _empty", ticks="_waiting _shifting")
    asked = "bytes sent"
    kinds = frozenset({Kind.ACCESS, Kind.FLAG})

    _delay: Callable[[int], int]

    def __init__(self, unit: str) -> None:
        super().__init__()
        self._unit = unit
        self.bus = _Reads(unit, self)
        self._waiting = NO_TIME  # the tick at which the byte in I2CDXR was written
        self._shifting = NO_TIME  # the tick at which the byte in I2CXSR was written
        self._empty = True  # True if XRDY shows that I2CDXR is empty

    @property
    def subjects(self) -> Subjects:
        return {Kind.ACCESS: {f"{self._unit}.I2C-A.I2CDXR"}, Kind.FLAG: {f"{self._unit}.I2C-A.I2CSTR"}}

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(self.kinds, self, self.subjects, THINGS)

    def listen(self, scene: MeasuredScene) -> None:
        self._delay = scene.i2c_release_delay(self._unit)
        self._empty = bool(scene.value_of(f"{self._unit}.I2C-A", "I2CSTR.XRDY"))
        self.bus.attach(scene.wire("SCL"), scene.wire("SDA"))

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if (kind, where, what) == (Kind.ACCESS, self._unit, "W I2C-A.I2CDXR"):
            return WRITE
        return XRDY if (kind, where, what) == (Kind.FLAG, f"{self._unit}.I2C-A", "I2CSTR.XRDY") else UNWANTED

    @property
    def holds_byte(self) -> bool:
        """True if a byte was written that the controller has not needed yet."""
        return self._waiting != NO_TIME or self._shifting != NO_TIME

    def on_record(self, tag: int, tick: int, value: int) -> None:
        self.bus.settle_before(tick)
        if tag == WRITE:
            self._copied()
            self._waiting = tick
        else:
            self._empty = bool(value)
            self._copied()

    def _copied(self) -> None:
        """Note that the byte in I2CDXR was copied to I2CXSR, if XRDY shows that I2CDXR is empty."""
        if self._empty and self._waiting != NO_TIME:
            self._shifting, self._waiting = self._waiting, NO_TIME

    def needed(self, let_go: int, rose: int) -> None:
        """Take the margin of a byte, after SCL has risen for its first bit.

        let_go: the tick at which the controller released SCL, or a later tick at which the last other party except the
            unit released it.
        rose: the tick at which SCL rose.
        """
        self.occasion(rose)
        self._copied()
        written, self._shifting = self._shifting, NO_TIME
        if written != NO_TIME:
            delay: int = self._delay(written)
            self.take(let_go - delay - written, written)

    def finish(self, now: int) -> None:
        bus = self.bus
        bus.settle()
        if bus.stream.read and bus.ours and bus.phase_at != NO_TIME and bus.held_by_us_alone():
            self.occasion(now)
            self.take(bus.others_held_until - now, bus.others_held_until)

    def why_silent(self) -> str:
        return f"{self._unit} sent no byte as a slave whose write of I2CDXR is known"
