"""Records made by hand, and a scene of one or two units for them to be from."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.timing.language.scope import Scope
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.measure import Measure
from periph_sim.traces.formats.record_table import Columns, RecordTable

MODULES = ("I2C-A", "SCI-A", "GPIO")
ONE = Scope({"dsp": MODULES}, ("SDA", "SCL", "RX", "TX", "MODEL"), controller=True, host=True, rounds=True)
TWO = Scope({"head": ("I2C-A", "TIMER0"), "imu": ("I2C-A", "SCI-A")}, ("SDA", "SCL", "RX", "TX"))
BARE = Scope({"dsp": ("I2C-A",)}, ("SDA", "SCL"))
NO_BUS = Scope({"dsp": ("SCI-A",)}, ("RX", "TX"))

KINDS = {"edge": Kind.EDGE, "flag": Kind.FLAG, "access": Kind.ACCESS, "irq": Kind.IRQ, "span": Kind.SPAN}
KINDS |= {"wait": Kind.WAIT, "bus": Kind.BUS, "frame": Kind.FRAME, "note": Kind.NOTE, "transfer": Kind.TRANSFER}


def records(drawn: str) -> list[Record]:
    """One a line: tick, kind, where, what (a _ is a blank), value."""
    made = []
    for number, line in enumerate((line for line in drawn.splitlines() if line.strip()), 1):
        tick, kind, where, what, value = line.split()
        made.append(Record(number, int(tick), KINDS[kind], where, what.replace("_", " "), int(value, 0), "", 0))
    return made


def make(name: str) -> Measure:
    """The measure of a fixed name, which needs nothing of a scene."""
    return measure_named(name, Scope())


def table(of: list[Record]) -> RecordTable:
    columns = Columns()
    for record in of:
        columns.add(record)
    return columns.table(Fraction(10**9), 1000, {"dsp": (*MODULES, "pin:MODEL")})


def tell(measure: Measure, of: list[Record]) -> Measure:
    """The records that a scene would hand to the measure."""
    recorder = Recorder()
    measure.subscribe(recorder)
    for record in of:
        recorder.emit(record.tick, record.kind, record.where, record.what, record.value, record.text, record.field)
    return measure


def came(measure: Measure) -> tuple[int, int, int, int]:
    """worst, when, least, count"""
    return measure.worst, measure.worst_at, measure.least, measure.count
