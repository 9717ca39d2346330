"""Check whether a closed table, whose frames all have the same data, also holds for frames with other data.

    runs of the table --marks of data--> no instruction uses data to decide what happens
    some of them, with static and with changing data --> equal records, apart from the bytes

The marks (`image.data_marks`) prove it for the firmware. Words that show levels of lines, as GPADAT does, are marked,
too. An SCI notices other data only in the bits that it receives: it counts its samples from the edge of the start bit,
which each character has. Settings with which this is not so are found by `data_use`, and the second line is a test.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from zlib import crc32

from ..core.records import Kind, Listener, Recorder
from ..core.time import Timebase
from ..f28335.gpio.pin_mux_table import FUNCTIONS
from ..f28335.memory.ram import MEMORY
from ..f28335.sci.register_map import ADDRIDLE_MODE, CDC, PARITYENA, RXENA, SCI_MAP, SCICHAR, SWRESET
from ..processor.image.data_marks import LINES, LOOPED, OF_DATA
from ..scene.derived_records import OF_UNITS
from ..scene.scene import Scene
from ..timing.language.matcher import Matcher
from .closed_table import StartTable
from .normal_state import periods_of
from .pair_groups import EXTERNAL, has_external_interrupt
from .record_digests import SCI
from .stretch import CoveredCase

KINDS = (Kind.ACCESS, Kind.IRQ, Kind.BUS, Kind.FRAME)
MOST_RUNS = 8  # maximum number of runs of a table that are repeated with other data
SAMPLES = 8  # samples of an SCI in a bit
WITH_DATA = (SCI, "SPISIMO", "SPISOMI", "SDA")  # beginnings of the names of pin functions that show data
ACTS_ON_DATA = "an SCI detects its rate from data, or its frames are not 8 data bits without parity and address bit"
FURTHEST = Fraction(1, 50)  # maximum difference of the rates of host and SCI with which all data are received alike


class TimesDigest(Listener):
    """A digest of the records of KINDS: of their times, and of their values unless these can be data."""

    def __init__(self) -> None:
        self.digest = 0
        self._without_value: set[int] = set()

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        tag = crc32(f"{kind.value} {where} {what}".encode())
        if kind in (Kind.BUS, Kind.FRAME) or what.rpartition(".")[2] in (*OF_DATA, LOOPED):
            self._without_value.add(tag)
        return tag

    def on_record(self, tag: int, tick: int, value: int) -> None:
        self.digest = hash((self.digest, tag, tick, 0 if tag in self._without_value else 2 * value + 1))


def data_use(covered: CoveredCase, table: StartTable) -> str:
    """Return a phrase that says why a closed table holds for the data of the case only; "" if it holds for any data.

    covered: the case, which must have a host.
    """
    if table.data_use:
        return table.data_use
    host = covered.case.host
    assert host is not None
    changing = covered.with_ramp()
    step = -(-len(table.starts) // MOST_RUNS)
    for number in range(0, len(table.starts), step):
        digests = [_digest(one, table, number) for one in (covered, changing)]
        if digests[0] != digests[1]:
            return "frames with other data have other effects"
    scene = covered.free_scene(TimesDigest(), keep_values=False)
    scene.advance(scene.start + table.first_rest)
    if any(map(has_external_interrupt, scene.units.values())):
        return EXTERNAL
    if acts_on_data(scene):
        return ACTS_ON_DATA
    bit = 1 / (host.baud * (1 + Fraction(host.error) / 100))
    hz = Fraction(next(iter(scene.units.values())).clock.hz)
    for name, cycles in periods_of(scene).items():
        if f".{SCI}" in name and abs(SAMPLES * cycles / hz / bit - 1) > FURTHEST:
            return "the rates of the host and of the SCI differ by more than 2 %"
    return ""


def acts_on_data(scene: Scene) -> bool:
    """Return True if a receiving SCI is set up such that the data of a frame can decide what it does."""
    for dsp in scene.units.values():
        cycle = dsp.clock.cycle_at(scene.kernel.now)
        for name, socket in dsp.sockets.items():
            if name.startswith(SCI):
                ccr, ctl1, ffct = (socket.see(cycle, SCI_MAP[each].offset) for each in ("SCICCR", "SCICTL1", "SCIFFCT"))
                receives = ctl1 & SWRESET and ctl1 & RXENA
                if receives and (ccr & (ADDRIDLE_MODE | PARITYENA | SCICHAR) != SCICHAR or ffct & CDC):
                    return True
    return False


def _digest(covered: CoveredCase, table: StartTable, run: int) -> int:
    """Repeat a run of a table, and return its digest. covered: the case, which can have other data."""
    digest = TimesDigest()

    def subscribe(recorder: Recorder, _: Timebase) -> None:
        recorder.subscribe(KINDS, digest)

    rounds = table.rounds[run] if table.rounds else None
    inputs = covered.phases.inputs_at(table.starts[run], rounds)
    end = max(table.starts[run] + (rounds or [])) + table.apart
    scene = covered.scene_of(inputs, Fraction(end, covered.phases.ticks_per_second), covered.case.seed, subscribe)
    scene.run()
    return digest.digest


def follow_data(covered: CoveredCase, names: Sequence[str]) -> list[str]:
    """Return those of the named budgets whose values can differ with other data, such as edges of a TX line."""
    pins = [pin for unit in covered.case.unit.values() for pin in unit.pins.items()]
    shown = {name for name, number in pins if any(function.startswith(WITH_DATA) for function in FUNCTIONS[number])}
    others = {name for name, _ in pins} - shown
    events = covered.events()
    return [name for name in names if (used := events[name]) is None or any(_is_of_data(one, others) for one in used)]


def _is_of_data(event: Matcher, pins: set[str]) -> bool:
    """Return True if other data can move or add an event. pins: the wires of pins that show no data."""
    if event.kind is Kind.EDGE:
        return not (event.where and event.where <= pins | {"SCL"})
    if event.kind is Kind.FLAG:
        in_memory = not event.where or any(where.endswith(f".{MEMORY}") for where in event.where)
        return in_memory or event.what.partition(".")[0] in (*OF_DATA, *LINES, LOOPED)
    if event.kind in (Kind.BUS, Kind.FRAME, Kind.ACCESS):
        return event.mask != 0 or event.what == "stuck"
    if event.kind is Kind.TRANSFER:
        return event.what in OF_UNITS
    return event.kind not in (Kind.IRQ, Kind.SPAN, Kind.ROUND, Kind.RECEIVER)
