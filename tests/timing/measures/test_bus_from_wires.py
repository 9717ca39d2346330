"""Analysis of bus lines that are drawn bit by bit: the acknowledging party, times held, and margins of I2CDXR."""

from __future__ import annotations

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import NO_TIME
from periph_sim.core.wire import Pin, Wire
from periph_sim.timing.derived.held_records import HeldRecords
from periph_sim.timing.measures.bus_from_wires import BusFromWires
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.margin import Margin
from periph_sim.timing.measures.measure import Measure
from tests.timing.events_by_hand import ONE, pairs, scene_of

HEAD, DSP = "controller", "dsp.GPIO33"
LOW, HIGH = 10, 10  # ticks of SCL
RELEASE = 3  # ticks from a write of I2CDXR to the release of SCL


class Drawn:
    """Records of a bus whose every bit takes 20 ticks: SCL low for 10, high for 10."""

    def __init__(self, began: int = 100) -> None:
        self.records: list[Record] = []
        self.now = began
        self._levels = {"SCL": 1, "SDA": 1}
        self._who = {"SCL": "", "SDA": ""}

    def add(self, kind: Kind, where: str, what: str, value: int, text: str = "") -> None:
        self.records.append(Record(len(self.records) + 1, self.now, kind, where, what, value, text, 0))

    def line(self, wire: str, level: int, who: str = "") -> None:
        if self._levels[wire] != level:
            self._levels[wire] = level
            self.add(Kind.EDGE, wire, "level", level, who if not level else "")
        elif not level and who != self._who[wire]:
            self.add(Kind.HOLD, wire, "held", 0, who)
        self._who[wire] = who

    def hold(self, who: str) -> None:
        self.line("SCL", 0, who)

    def start(self) -> None:
        """SDA falls, and SCL ten ticks later. For a repeated START, both rise first."""
        self.line("SDA", 1)
        self.now += LOW
        self.line("SCL", 1)
        self.now += HIGH
        self.line("SDA", 0, HEAD)
        self.now += HIGH
        self.line("SCL", 0, HEAD)

    def bit(self, value: int, who: str = HEAD, held: int = 0) -> None:
        """Add a bit. held: number of additional ticks for which only the unit holds SCL low."""
        self.line("SDA", value, who)
        self.now += LOW
        if held:
            self.hold(DSP)
            self.now += held
        self.line("SCL", 1)
        self.now += HIGH
        self.line("SCL", 0, HEAD)

    def byte(self, value: int, acked_by: str = DSP, who: str = HEAD, held: int = 0) -> None:
        for place in range(7, -1, -1):
            self.bit(value >> place & 1, who, held if place == 7 else 0)
        self.bit(0 if acked_by else 1, acked_by)

    def stop(self) -> None:
        self.line("SDA", 0, HEAD)
        self.now += LOW
        self.line("SCL", 1)
        self.now += HIGH
        self.line("SDA", 1)
        self.now += 50


class CallRecorder(BusFromWires):
    """Records the calls that BusFromWires makes."""

    def __init__(self) -> None:
        super().__init__("dsp")
        self.calls: list[tuple[object, ...]] = []

    def started(self, now: int) -> None:
        self.calls.append(("started", now))

    def stopped(self, now: int) -> None:
        self.calls.append(("stopped", now, self.stream.index))

    def held(self, let_go: int, rose: int) -> None:
        if let_go != rose:
            self.calls.append(("held", let_go, rose))

    def first_bit(self, let_go: int, rose: int) -> None:
        stream = self.stream
        self.calls.append(("first bit", stream.address, stream.read, self.ours, stream.index, let_go, rose))


class ReplayedWires:
    """Two wires that are driven according to records of edges and holds."""

    def __init__(self) -> None:
        self._kernel = Kernel()
        self._wires = {name: Wire(self._kernel, name, Recorder()) for name in ("SCL", "SDA")}
        self._pins: dict[tuple[str, str], Pin] = {}

    def wire(self, name: str) -> Wire:
        return self._wires[name]

    def play(self, record: Record) -> None:
        pulling = record.text.split(", ") if record.text else []
        for who in pulling:
            if (record.where, who) not in self._pins:
                self._pins[record.where, who] = self._wires[record.where].attach(who)
        self._kernel.now = record.tick
        for (where, who), pin in self._pins.items():
            if where == record.where:
                pin.drive(int(who not in pulling))
        self._kernel.settle()


def calls_for(drawn: Drawn) -> list[tuple[object, ...]]:
    monitor, wires = CallRecorder(), ReplayedWires()
    monitor.attach(wires.wire("SCL"), wires.wire("SDA"))
    for record in drawn.records:
        wires.play(record)
    monitor.settle()
    return monitor.calls


def test_addresses_bytes_and_conditions():
    """A write and, after a repeated START, a read whose last byte is not acknowledged."""
    bus = Drawn()
    bus.start()  # at 120; the first rise of the address is at 140, the next ones every 20 ticks
    bus.byte(0x50 << 1)
    bus.byte(0x07)
    again = bus.now
    bus.start()
    bus.byte(0x50 << 1 | 1)
    first = bus.now
    bus.byte(0xA5, HEAD, DSP)
    bus.byte(0x5A, "", DSP)
    last = bus.now
    bus.stop()
    assert calls_for(bus) == [
        ("started", 120),
        ("first bit", 0x50, False, True, 0, 320, 320),
        ("first bit", 0x50, False, True, 1, again + 10, again + 10),  # the rise before the repeated START
        ("first bit", 0x50, True, True, 0, first + 10, first + 10),
        ("first bit", 0x50, True, True, 1, first + 190, first + 190),
        ("stopped", last + 20, 2),
    ]


@pytest.mark.parametrize(
    ("address", "acked_by", "read", "ours", "acked"),
    [
        (0x50, DSP, True, True, True),
        (0x50, "chip", True, False, True),
        (0x50, "", True, False, False),
        (0x7F, DSP, False, True, True),
        (0x00, f"chip, {DSP}", True, True, True),
        (0x01, "dsp2.GPIO33", True, False, True),
    ],
)
def test_the_unit_is_addressed_if_it_acknowledges_alone_or_with_others(
    address: int, acked_by: str, read: bool, ours: bool, acked: bool
):
    bus = Drawn()
    bus.start()
    bus.byte(address << 1 | read, acked_by)
    bus.byte(0x55)
    calls = [one for one in calls_for(bus) if one[0] == "first bit"]
    assert calls == ([("first bit", address, read, ours, 0, 320, 320)] if acked else [])


def test_the_unit_holds_scl_alone_from_the_release_by_the_others():
    bus = Drawn()
    bus.start()
    bus.byte(0x50 << 1 | 1)
    begin = bus.now
    bus.byte(0xFF, HEAD, DSP, held=33)
    assert calls_for(bus)[1:] == [
        ("held", begin + 10, begin + 43),
        ("first bit", 0x50, True, True, 0, begin + 10, begin + 43),
    ]


def test_another_party_that_holds_scl_again_ends_the_time_held_alone():
    bus = Drawn()
    bus.start()
    bus.now += 5
    bus.hold(DSP)
    bus.now += 5
    bus.hold(f"{DSP}, chip")
    bus.now += 7
    bus.hold(DSP)
    bus.now += 4
    bus.line("SCL", 1)
    assert calls_for(bus) == [("started", 120), ("held", 147, 151)]


def test_edges_of_one_tick_are_one_sample():
    """SDA and SCL change at the same tick. The result does not depend on the order of the records."""
    for first, second in (("SDA", "SCL"), ("SCL", "SDA")):
        for level in (0, 1):
            bus = Drawn()
            bus.line("SDA", 1 - level, HEAD)
            bus.now += 10
            if level:
                bus.line("SCL", 0, HEAD)
                bus.now += 10
            for wire in (first, second):
                bus.line(wire, level, HEAD)
            calls = [one[0] for one in calls_for(bus)]
            assert calls == (["started"] if level else []), (first, level)


def test_a_start_during_a_byte_begins_a_new_transfer_and_a_stop_ends_it():
    bus = Drawn()
    bus.start()
    for bit in (1, 0, 1):
        bus.bit(bit)
    bus.start()
    bus.byte(0x21 << 1)
    bus.byte(0x00)
    bus.stop()
    bus.line("SCL", 0, HEAD)
    bus.now += 9
    bus.line("SCL", 1)
    calls = calls_for(bus)
    assert [one[0] for one in calls] == ["started", "first bit", "first bit", "stopped"]
    assert calls[1][1:4] == (0x21, False, True)


def test_a_low_scl_is_held_by_the_unit_alone_if_no_other_party_pulls():
    monitor, wires = CallRecorder(), ReplayedWires()
    monitor.attach(wires.wire("SCL"), wires.wire("SDA"))
    assert not monitor.held_by_us_alone()
    for number, (level, who, alone) in enumerate(
        [(0, DSP, True), (0, f"{DSP}, {HEAD}", False), (0, f"{DSP}, dsp.GPIO32", True), (1, "", False), (0, DSP, True)]
    ):
        wires.play(Record(number, number, Kind.EDGE, "SCL", "level", level, who, 0))
        assert monitor.held_by_us_alone() == alone, who


# Margins ------------------------------------------------------------------------------------------------------------


def writes(bus: Drawn, at: int | None = None) -> None:
    now, bus.now = bus.now, bus.now if at is None else at
    bus.add(Kind.ACCESS, "dsp", "W I2C-A.I2CDXR", 7)
    bus.now = now


def xrdy(bus: Drawn, value: int) -> None:
    bus.add(Kind.FLAG, "dsp.I2C-A", "I2CSTR.XRDY", value)


def margins(bus: Drawn, end: int | None = None) -> tuple[Margin, list[tuple[int, int]]]:
    measure, wires, recorder = Margin("dsp"), ReplayedWires(), Recorder()
    measure.keep()
    measure.listen(scene_of(wire=wires.wire, value=1, i2c_release_delay=lambda unit: lambda written: RELEASE))
    measure.subscribe(recorder)
    for one in bus.records:
        if one.kind in (Kind.EDGE, Kind.HOLD):
            wires.play(one)
        else:
            recorder.emit(one.tick, one.kind, one.where, one.what, one.value)
    measure.finish(bus.now if end is None else end)
    return measure, pairs(measure)


def addressed(read: bool = True, acked_by: str = DSP) -> Drawn:
    bus = Drawn()
    bus.start()
    bus.byte(0x50 << 1 | read, acked_by)
    return bus


def test_the_margin_is_from_the_write_to_the_release_by_the_controller_minus_the_time_of_the_module():
    bus = addressed()
    bus.now += 4
    writes(bus)
    wrote, rises = bus.now, bus.now + 10
    bus.byte(0xA5, HEAD, DSP)
    measure, found = margins(bus)
    assert found == [(rises - RELEASE - wrote, wrote)]
    assert (measure.occasions, measure.count) == (1, 1)


def test_after_a_late_write_the_margin_is_negative_and_scl_was_held():
    bus = addressed()
    bus.line("SDA", 1)
    bus.now += LOW
    bus.hold(DSP)
    let_go = bus.now
    bus.now += 30
    writes(bus)
    bus.now += RELEASE
    bus.line("SCL", 1)
    _, found = margins(bus)
    assert found == [(let_go - RELEASE - (let_go + 30), let_go + 30)]


def test_a_byte_written_in_advance_has_the_margin_of_the_next_byte():
    """The first of two writes in advance is shifted out. The second waits in I2CDXR until XRDY is set."""
    bus = addressed()
    bus.now += 2
    writes(bus)
    first = bus.now
    xrdy(bus, 0)
    bus.now += 1
    xrdy(bus, 1)  # the byte was moved to the shift register
    bus.now += 1
    writes(bus)
    second = bus.now
    xrdy(bus, 0)
    bus.now += 6
    bus.line("SCL", 1)
    needed = bus.now
    bus.now += HIGH
    bus.line("SCL", 0, HEAD)
    for _ in range(7):
        bus.bit(1, DSP)
    xrdy(bus, 1)
    bus.bit(0, HEAD)
    bus.line("SDA", 1)
    bus.now += LOW
    bus.line("SCL", 1)
    again = needed + 9 * (LOW + HIGH)
    assert bus.now == again
    _, found = margins(bus)
    assert found == [(needed - RELEASE - first, first), (again - RELEASE - second, second)]


@pytest.mark.parametrize(("read", "acked_by"), [(False, DSP), (True, "chip"), (True, "")])
def test_bytes_that_others_send_or_the_unit_receives_have_no_margin(read: bool, acked_by: str):
    bus = addressed(read, acked_by)
    writes(bus)
    bus.byte(0xA5, HEAD, DSP)
    measure, found = margins(bus)
    assert found == [] and measure.occasions == 0
    assert measure.missing() == "dsp sent no byte as a slave whose write of I2CDXR is known"


def test_writes_of_other_units_and_reads_are_ignored():
    bus = addressed()
    bus.add(Kind.ACCESS, "imu", "W I2C-A.I2CDXR", 7)
    bus.add(Kind.ACCESS, "dsp", "R I2C-A.I2CDXR", 7)
    bus.byte(0xA5, HEAD, DSP)
    measure, found = margins(bus)
    assert found == [] and measure.occasions == 1


@pytest.mark.parametrize(
    ("where", "flag", "taken"),
    [
        ("dsp.I2C-A", "I2CSTR.XRDY", 1),
        ("dsp.I2C-A", "I2CSTR.RRDY", 0),
        ("dsp.I2C-A", "I2CSTR.XSMT", 0),
        ("dsp.I2C-A", "I2CFFTX.XRDY", 0),
        ("imu.I2C-A", "I2CSTR.XRDY", 0),
    ],
)
def test_only_its_own_xrdy_shows_that_a_byte_moved_to_the_shift_register(where: str, flag: str, taken: int):
    """A byte that is written while another one is sent waits in I2CDXR until XRDY, and no other flag, is set."""
    bus = addressed()
    xrdy(bus, 0)
    writes(bus)
    bus.add(Kind.FLAG, where, flag, 1)
    bus.byte(0xA5, HEAD, DSP)
    measure, found = margins(bus)
    assert (len(found), measure.occasions) == (taken, 1)


def test_scl_held_until_the_end_of_the_run_is_counted():
    bus = addressed()
    bus.line("SDA", 1)
    bus.now += LOW
    bus.hold(DSP)
    measure, found = margins(bus, bus.now + 500)
    assert found == [(-500, bus.now)] and measure.occasions == 1


def held(bus: Drawn, end: int) -> Measure:
    measure, scene, recorder = measure_named("SCL held per transfer", ONE), ReplayedWires(), Recorder()
    measure.keep()
    measure.subscribe(recorder)
    found = HeldRecords(recorder, "dsp")
    found.attach(scene.wire("SCL"), scene.wire("SDA"))
    for record in bus.records:
        scene.play(record)
    found.finish(end)
    measure.finish(end)
    return measure


def test_times_held_are_summed_per_transfer():
    bus = Drawn()
    bus.start()
    bus.byte(0x50 << 1, held=5)
    bus.byte(0x07, held=8)
    bus.start()
    bus.byte(0x50 << 1 | 1, held=2)
    bus.stop()
    second = bus.now + 20
    bus.start()
    bus.byte(0x50 << 1)
    bus.stop()
    measure = held(bus, bus.now)
    assert [column.tolist() for column in measure.all_kept()] == [[15, 0], [120, second]]
    assert measure.unfinished(bus.now) == [] and measure.close(bus.now) == ""


def test_an_unfinished_transfer_counts_with_the_time_held_so_far():
    bus = Drawn()
    bus.start()
    bus.byte(0x50 << 1, held=5)
    bus.now += LOW
    bus.hold(DSP)
    end = bus.now + 40
    measure = held(bus, end)
    assert measure.unfinished(end) == [(45, 120)]
    assert measure.close(end) == "a transfer was not over when the run ended" and measure.worst == 45
    assert held(Drawn(), 500).unfinished(500) == []
    assert held(Drawn(), 500).worst_at == NO_TIME
