"""Records of firmware: values of accesses, and file and line of waits, spans and service routines."""

from __future__ import annotations

import linecache
from fractions import Fraction
from pathlib import Path

from periph_sim.core.records import OF_MODIFIES, RECORDED, Kind, Record, RecordSink
from periph_sim.processor.source_location import SourceLocation
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.processor.bench import Bench, recorder_of, unit


def test_a_recorded_read_has_the_value_that_the_firmware_got():
    recorder, accesses = recorder_of(Kind.ACCESS)
    bench = Bench([(1, 4, -1), (2, 5, -1)], recorder=recorder)
    got: list[int] = []

    def main() -> None:
        bench.cpu.compute(20)
        got.append(bench.flags.STATUS.all)
        got.append(bench.flags.COUNT.all)  # a read clears it
        got.append(bench.flags.COUNT.all)

    bench.run(main, 200)
    assert got == [5, 2, 0]
    assert [(a.what, a.value) for a in accesses] == [("R FLAGS.STATUS", 5), ("R FLAGS.COUNT", 2), ("R FLAGS.COUNT", 0)]


def test_the_field_of_an_access_is_recorded():
    recorder, accesses = recorder_of(Kind.ACCESS)
    bench = Bench([], recorder=recorder)

    def main() -> None:
        assert bench.flags.STATUS.C == 0
        assert bench.flags.STATUS.all == 0
        bench.flags.STATUS.C = 1
        bench.flags.STATUS.all = 1

    bench.run(main, 200)
    assert [(a.what[0], a.field) for a in accesses] == [("R", "C"), ("R", ""), ("R", "C"), ("W", "C"), ("W", "")]


def test_each_half_of_a_pair_is_recorded_at_its_position():
    recorder, accesses = recorder_of(Kind.ACCESS)
    dsp, kernel = unit("TIMER0", recorder=recorder)
    period = dsp.module("TIMER0").PRD
    got: list[int] = []

    def main() -> None:
        period.all = 0x1111_2222
        got.extend((period.half.MSW, period.half.LSW, period.all))
        period.half.MSW = 0x3333
        period.half.LSW = 0x4444

    dsp.start(main)
    kernel.run_until(20 * 1000)
    assert got == [0x1111, 0x2222, 0x1111_2222]
    assert [(a.what[0], a.value) for a in accesses if a.what.endswith("TIMER0.PRD")] == [
        ("W", 0x1111_2222),
        ("R", 0x1111_0000),
        ("R", 0x2222),
        ("R", 0x1111_2222),
        ("W", 0x3333_0000),
        ("W", 0x4444),
    ]


def test_idle_is_recorded_from_the_instruction_to_the_interrupt() -> None:
    recorder, found = recorder_of(Kind.WAIT)
    bench = Bench([(200, 0, 0)], recorder=recorder)
    bench.enable()
    bench.cpu.program.handle("SEQ1INT", lambda: bench.note("served"))

    def firmware() -> None:
        bench.cpu.compute(50)
        bench.cpu.idle()
        bench.note("awake")

    log = dict(bench.run(firmware, 600))
    assert [(record.what, record.value) for record in found] == [("IDLE", 1), ("IDLE", 0)]
    begin, end = (bench.clock.cycle_at(record.tick) for record in found)
    assert 50 <= begin < 60 and 200 <= end <= log["served"] <= log["awake"]


CASE = load(Path(__file__).parents[2] / "timing" / "imu_hil_published.toml")


def records(*kinds: Kind, seconds: Fraction = Fraction(8, 1000)) -> list[Record]:
    found: list[Record] = []
    Scene(CASE, lambda recorder, _: recorder.subscribe(kinds, found.append)).run(seconds)
    return found


class OfModifies(RecordSink):
    """A sink that keeps the places of accesses to I2CSTR, and requests those of read-modify-writes only."""

    def __init__(self) -> None:
        self.kept: list[tuple[str, str, str]] = []  # R or W, the field, the place

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return ("R I2C-A.I2CSTR", "W I2C-A.I2CSTR").index(what) if what.endswith("I2CSTR") else -1

    def places(self, tag: int) -> int:
        return OF_MODIFIES

    def keep(self, tag: int, number: int, tick: int, value: int, text: str, cause: int, field: str) -> None:
        self.kept.append(("RW"[tag], field, text))


def source(record: Record) -> str:
    where = record.text
    assert isinstance(where, SourceLocation) and where == f"{str(where).partition(':')[0]}:{where.line}"
    return linecache.getline(where.path, where.line).strip()


def test_records_of_waits_alternate_and_name_the_polled_fields():
    waits = records(Kind.WAIT)
    assert [w.value for w in waits] == [1, 0] * (len(waits) // 2) + [1] * (len(waits) % 2)
    first, second = waits[0], waits[2]
    assert (first.what, source(first)) == ("I2C-A.I2CSTR.AAS", "dsp.spin(lambda: i2c.I2CSTR.AAS == 1)")
    assert (second.what, source(second)) == ("I2C-A.I2CSTR.RRDY", "dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)")
    assert any(w.what == "I2C-A.I2CSTR.XRDY and I2C-A.I2CSTR.SCD" for w in waits)


def test_a_condition_that_is_true_at_once_is_not_recorded_as_a_wait():
    """The firmware of the emulator without its wait for SDIR finds XRDY set at once."""
    waits = records(Kind.WAIT, seconds=Fraction(4, 1000))
    assert [w.what for w in waits] == ["I2C-A.I2CSTR.AAS"]


def test_records_of_spans_and_routines_have_their_source_lines():
    found = [r for r in records(Kind.SPAN, Kind.IRQ, Kind.ACCESS) if r.value and r.kind is not Kind.ACCESS]
    sources = {r.what: source(r) for r in found}
    assert sources == {
        "model": 'dsp.compute(self.cost, "model")',
        "SCIRXINTA": "def sci_received(self) -> None:",
    }


def test_a_span_of_a_with_statement_has_the_line_of_the_statement(tmp_path: Path):
    firmware = tmp_path / "steps.py"
    firmware.write_text(
        'def main(dsp, settings):\n    with dsp.span("step"):\n        dsp.compute(9)\n', encoding="utf-8"
    )
    case = tmp_path / "steps.toml"
    case.write_text(
        f'name = "steps"\nduration = "1 us"\n[unit.dsp]\nfirmware = "{firmware}"\nmodules = []\n', encoding="utf-8"
    )
    found: list[Record] = []
    Scene(load(case), lambda recorder, _: recorder.subscribe([Kind.SPAN], found.append)).run()
    assert [record.value for record in found] == [1, 0]
    assert (found[0].text, source(found[0])) == ("main:2", 'with dsp.span("step"):')


def test_a_routine_is_not_the_cause_of_other_events_while_it_computes():
    case = load(
        Path(__file__).parents[2] / "timing" / "imu_hil_published.toml",
        ["unit.dsp.settings.frame_cost=200 us", "host.first=4.24 ms"],
    )
    found: list[Record] = []
    Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, found.append)).run(Fraction(8, 1000))
    entered = next(r for r in found if r.kind is Kind.IRQ and r.value)
    left = next(r for r in found if r.kind is Kind.IRQ and not r.value)
    inside = [r for r in found if entered.tick < r.tick < left.tick]
    of_it = {r.kind for r in inside if r.cause == entered.number}
    assert of_it == {Kind.ACCESS, Kind.SPAN}
    assert sum(r.kind is Kind.EDGE for r in inside) > 20


def test_a_sink_of_read_modify_writes_gets_no_places_of_other_reads():
    keeper = OfModifies()
    Scene(CASE, lambda recorder, _: recorder.subscribe([Kind.ACCESS], keeper)).run(Fraction(8, 1000))
    modified = [(way, field) for way, field, place in keeper.kept if place]
    assert {field for _, field in modified} == {"SCD"} and len({place for _, _, place in keeper.kept if place}) == 1
    assert modified.count(("R", "SCD")) == modified.count(("W", "SCD")) > 0
    polls = [place for way, field, place in keeper.kept if field in ("AAS", "RRDY", "XRDY")]
    assert len(polls) > 20 and not any(polls)
