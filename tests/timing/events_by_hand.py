"""Hand-made records, scopes of scenes with one or two units, and measures that receive the records."""

from __future__ import annotations

from fractions import Fraction
from itertools import count
from types import SimpleNamespace

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.timing.language.scope import Scope
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.measure import Measure, MeasuredScene
from periph_sim.traces.formats.record_table import Columns, RecordTable

MODULES = ("I2C-A", "SCI-A", "GPIO")
ONE = Scope({"dsp": MODULES}, ("SDA", "SCL", "RX", "TX", "MODEL"), controller=True, host=True, rounds=True)
TWO = Scope({"head": ("I2C-A", "TIMER0"), "imu": ("I2C-A", "SCI-A")}, ("SDA", "SCL", "RX", "TX"))
BARE = Scope({"dsp": ("I2C-A",)}, ("SDA", "SCL"))
NO_BUS = Scope({"dsp": ("SCI-A",)}, ("RX", "TX"))

KINDS = {"edge": Kind.EDGE, "flag": Kind.FLAG, "access": Kind.ACCESS, "irq": Kind.IRQ, "span": Kind.SPAN}
KINDS |= {"wait": Kind.WAIT, "bus": Kind.BUS, "frame": Kind.FRAME, "note": Kind.NOTE, "transfer": Kind.TRANSFER}


def records(drawn: str) -> list[Record]:
    """Parse records, one per line: tick, kind, where, what (with _ for a space), value."""
    made = []
    for number, line in enumerate((line for line in drawn.splitlines() if line.strip()), 1):
        tick, kind, where, what, value = line.split()
        made.append(Record(number, int(tick), KINDS[kind], where, what.replace("_", " "), int(value, 0), "", 0))
    return made


def make(name: str) -> Measure:
    """Return a measure by its fixed name, which needs no scene."""
    return measure_named(name, Scope())


def table(of: list[Record]) -> RecordTable:
    columns = Columns()
    for record in of:
        columns.add(record)
    return columns.table(Fraction(10**9), 1000, {"dsp": (*MODULES, "pin:MODEL")}, {})


def feed(measure: Measure, of: list[Record]) -> Measure:
    """Pass the records to the measure as a scene would."""
    recorder = Recorder()
    measure.subscribe(recorder)
    for record in of:
        recorder.emit(record.tick, record.kind, record.where, record.what, record.value, record.text, record.field)
    return measure


def scene_of(transfers: int = 1, level: int = 1, value: int = 0, **there: object) -> MeasuredScene:
    """A scene for measures: rounds of `transfers` transfers; wires have this level, and fields this value."""
    starts = count()
    offered: dict[str, object] = dict.fromkeys(MeasuredScene.__struct_fields__) | {
        "began": 0,
        "ticks_per_second": 10**9,
        "wire": lambda name: SimpleNamespace(level=level),
        "value_of": lambda place, name: value,
        "rounds_at_start": lambda: lambda: next(starts) % transfers == 0,
    }
    return MeasuredScene(**(offered | there))  # type: ignore[arg-type]


def played(
    text: str,
    of: str | list[Record] = "",
    now: int | None = None,
    *,
    scope: Scope = ONE,
    keep: bool = False,
    **there: object,
) -> Measure:
    """The measure of a text after these records, in the scene `scene_of(**there)`. now: the end of the run, if any."""
    measure = measure_named(text, scope)
    measure.listen(scene_of(**there))  # type: ignore[arg-type]
    if keep:
        measure.keep()
    feed(measure, records(of) if isinstance(of, str) else of)
    if now is not None:
        measure.finish(now)
    return measure


def pairs(measure: Measure) -> list[tuple[int, int]]:
    """The kept (value, tick), in order of their ticks."""
    values, at = measure.all_kept()
    return sorted(zip(values.tolist(), at.tolist(), strict=True), key=lambda pair: pair[1])


def summary(measure: Measure) -> tuple[int, int, int, int]:
    """Return worst, tick of the worst, least, count."""
    return measure.worst, measure.worst_at, measure.least, measure.count
