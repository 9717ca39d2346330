"""The firmware undisturbed: a case without its host goes in; what its code costs and what it waits for comes out.

    case, no host, no jitter --run, two rounds--> waits, I2CDXR writes, spans, transfers, edges, in ticks

No interrupt is taken in such a run, so the time between the end of one wait and the begin of the next is what the code
between them costs, access costs included. Nothing else is taken from it but the order of things on the bus.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from fractions import Fraction
from itertools import pairwise

from msgspec import Struct, field

from ...bus.i2c.transfer import Transfer
from ...core.records import Kind, Record
from ...devices.sensor_rounds import Round
from ...f28335.cpu import instruction_costs as cpu_costs
from ...f28335.cpu.compiled_code_costs import CodeCosts
from ...f28335.i2c.options import I2cOptions
from ...f28335.i2c.register_map import I2C_MAP
from ...f28335.system.options import SystemOptions
from ...processor.dsp import Dsp
from ...processor.polling import Spin
from ...processor.user_code import output_muted
from ...scene.case.model import Case
from ...scene.scene import Scene
from .branches import Decisions
from .code_trace import CodeTrace
from .program import Program
from .terms import BadBound, Term

KINDS = (Kind.ACCESS, Kind.FLAG, Kind.EDGE, Kind.BUS, Kind.SPAN, Kind.IRQ)
DXR, STR, OAR = "W I2C-A.I2CDXR", "W I2C-A.I2CSTR", "W I2C-A.I2COAR"
RECEIVING = ("W SCI-A.", "W PIE.")  # what the start-up of a receiver writes


class Wait(Struct):
    """A loop that waits for flags. first, end: its first read and the one that ended it. reads: in a pass.

    pass_cycles: of a pass, where the wait says it. into: ticks from the begin of a pass to the read that ended it.
    fields: that were read in the pass that ended it, polled: in any. flag: the field that changed last before that.
    edge: on the bus, which made it do so `delay` ticks later; None if nothing on the bus did.
    """

    place: str
    fields: tuple[str, ...]
    first: int
    end: int
    reads: int
    pass_cycles: int | None
    into: int
    flag: str = ""
    polled: tuple[str, ...] = ()
    edge: int | None = None
    delay: int = 0


class UndisturbedRun(Struct):
    """All times in ticks.

    cycle: length of one of SYSCLKOUT. low: the controller's SCL low time. module: cycles of the I2C module clock.
    writes: when I2CDXR was written. addressed: when I2COAR was. receives: from when on the SCI was set up and
    interrupts were taken. clears: when and where I2CSTR was written. bytes: when the ACK slot of each data byte
    ended. stretches: when SCL fell, and how much longer than `low` it stayed so. changes: when a field
    changed, but by the firmware's own accesses, and what it became. accesses: of the firmware, in the order of their
    records: when a read had its value or a write landed, which register, the field that was named, or "".
    """

    unit: str
    start: int
    cycle: Fraction
    low: int
    module: int
    options: SystemOptions
    code: CodeCosts
    trace: CodeTrace
    decisions: Decisions
    waits: list[Wait] = field(default_factory=list)
    writes: list[int] = field(default_factory=list)
    addressed: list[int] = field(default_factory=list)
    receives: int = 0
    clears: list[tuple[int, str]] = field(default_factory=list)
    spans: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    bytes: list[int] = field(default_factory=list)
    stretches: list[tuple[int, int]] = field(default_factory=list)
    transfers: list[Transfer] = field(default_factory=list)
    rounds: list[Round] = field(default_factory=list)
    masked: str = ""  # where the firmware runs with INTM = 1 after its first wait
    changes: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    accesses: list[tuple[int, str, str]] = field(default_factory=list)
    code_terms: dict[tuple[int, int, str, int], Term] = field(default_factory=dict)  # of chains, made once each
    seconds: Fraction = Fraction(0)  # of this run
    events: int = 0  # that it took
    wait_terms: dict[int, tuple[Term, Term]] = field(default_factory=dict)  # of waits, by their first read
    _unproven: dict[tuple[int, int], str] = field(default_factory=dict)  # what `unproven` found out already

    def unproven(self, begin: int, end: int) -> str:
        """Why what the code between two instants takes is no bound; empty if it is one.

        Before the first wait the code ran as it runs in every phase, since nothing from outside had come.
        """
        if end <= self.waits[0].first:
            return ""
        if (begin, end) not in self._unproven:
            self._unproven[begin, end] = self._doubts(begin, end)
        return self._unproven[begin, end]

    def _doubts(self, begin: int, end: int) -> str:
        decided = map(str, self.decisions.open(self.trace.ran(begin, end)))
        return "; ".join([*self.trace.uneven(begin, end), *decided])

    @property
    def rounding(self) -> int:
        """By how many ticks the instants of two cycles may be further apart at another place of the grid."""
        return int(self.cycle.denominator > 1)

    def lasting(self, begin: int, end: int) -> int:
        """Ticks that as many cycles take as passed between two instants of the CPU; rounded up."""
        return self.ticks(round((end - begin) / self.cycle))

    def ticks(self, cycles: int) -> int:
        """Rounded up."""
        return -(-cycles * self.cycle.numerator // self.cycle.denominator)

    def bus(self, tick: int) -> int:
        """The tick without the stretches before it: what the controller alone makes of the time."""
        return tick - sum(length for fell, length in self.stretches if fell + self.low < tick)

    def longest_delay(self, wait: Wait) -> int:
        """Ticks from the edge of a wait's flag to the flag, wherever in a cycle the edge comes."""
        return self.ticks((wait.delay + self.rounding) // self.cycle + 1) + self.rounding

    def pass_cycles(self, wait: Wait) -> int:
        """A pass of a wait: its own length, or `poll_pass` and what each read but the first adds to it.

        A flag that rises in the cycle of a read is read; so one waits a cycle less than that to be read, at most.
        """
        one, more = (
            cpu_costs.SIMPLE + self.options.pf2_read_ws.unrecorded(),
            (wait.reads - 1) * read_after_read(self.options),
        )
        if wait.pass_cycles is not None:
            return max(wait.pass_cycles, one + more)
        return max(self.code.poll_pass, one) + more


def read_after_read(options: SystemOptions) -> int:
    """Cycles from one read of a pass to the next: a branch not taken, the wait states, the read."""
    return cpu_costs.SB_NOT_TAKEN + options.pf2_read_ws.unrecorded() + cpu_costs.SIMPLE


def serving_unit(case: Case) -> str:
    """The one unit that answers on I2C. BadBound if there is none, or more than one."""
    if case.controller is None:
        what = "bounds count from a controller's requests, and there is no [controller]"
        raise BadBound(f"case {case.name}: {what}; what a run shows is all there is")
    units = [name for name, unit in case.unit.items() if "I2C-A" in unit.modules]
    if len(units) != 1:
        found = " and ".join(units) + " have it" if units else "none has it"
        raise BadBound(f"case {case.name}: bounds are known of one unit that answers by its I2C-A; here {found}")
    return units[0]


@output_muted()
def observe(case: Case) -> UndisturbedRun:
    """Run the case without host and jitter for two rounds. BadBound if its firmware does not serve in waits."""
    unit = serving_unit(case)
    controller = case.controller
    assert controller is not None
    calm_case = case.model_copy(
        update={
            "host": None,
            "budget": (),
            "breaks": (),
            "fidelity": "edge",  # bounds are of edges, whatever a case runs at
            "controller": controller.model_copy(update={"jitter": Fraction(0), "rounds": 2}),
        }
    )
    listener = _Listener(unit)
    scene = Scene(calm_case, lambda recorder, _: recorder.subscribe(KINDS, listener.hear), end="most")
    dsp = scene.units[unit]
    listener.dsp = dsp
    assert scene.head is not None
    transfers: list[Transfer] = []
    rounds: list[Round] = []
    scene.head.on_transfer.append(transfers.append)
    scene.head.on_round.append(rounds.append)
    schedule = scene.head.schedule
    seconds = (schedule.first + 2 * Fraction(schedule.period)) / scene.timebase.per_second
    scene.run(seconds)
    if len(rounds) < 2:
        what = "even without a host the second round is not over when the third one is due"
        raise BadBound(f"case {case.name}: {what}; lengthen controller.period or shorten what the firmware does")
    refused = next((transfer for transfer in transfers if not transfer.acked), None)
    if refused is not None:
        at = scene.timebase.show(refused.phases[0].start_at - scene.start)
        what = f"even without a host {refused.name} does not acknowledge its request at {at}"
        raise BadBound(f"case {case.name}: {what}; bounds need firmware that waits for each request when it comes")
    low = scene.head.controller.timing.low
    module = 1 + dsp.socket("I2C-A").chip.peek(dsp.processor.time.cycle, I2C_MAP["I2CPSC"].offset)
    cycle = scene.timebase.per_second / scene.units[unit].clock.hz
    decisions = Decisions(Program(scene.firmware[unit].main))
    trace = listener.trace
    plan = dsp.plan
    calm = UndisturbedRun(
        unit,
        scene.start,
        cycle,
        low,
        module,
        plan.system,
        plan.code,
        trace,
        decisions,
        transfers=transfers,
        rounds=rounds,
        seconds=seconds,
        events=scene.kernel.events,
    )
    return listener.fill(calm, plan.answers(I2cOptions).noise_filter_cycles.unrecorded())


class _Reading(Struct):
    spin: Spin
    place: str
    first: int
    end: int = 0
    reads: int = 1
    into: int = 0


class _Listener:
    """Hears the records of the calm run; `fill` makes sense of them."""

    def __init__(self, unit: str) -> None:
        self.dsp: Dsp | None = None
        self._unit = unit
        self._readings: list[_Reading] = []
        self._writes: list[int] = []
        self._addressed: list[int] = []
        self._receives = 0
        self._clears: list[tuple[int, str]] = []
        self._bytes: list[int] = []
        self._edges: list[int] = []
        self._scl: list[tuple[int, int]] = []
        self._changes: dict[str, list[int]] = defaultdict(list)
        self._foreign: dict[str, list[tuple[int, int]]] = defaultdict(list)
        self._spans: dict[str, list[tuple[int, int]]] = defaultdict(list)
        self._begun: dict[str, int] = {}
        self._own: set[int] = set()  # records of the firmware's accesses
        self._accesses: list[tuple[int, str, str]] = []
        self._enabled = False  # interrupts, for the first time
        self._masked = ""
        self.trace = CodeTrace()

    def hear(self, record: Record) -> None:
        kind = record.kind
        if kind is Kind.ACCESS:
            if record.where == self._unit:
                self._access(record)
        elif kind is Kind.FLAG:
            if record.where.startswith(f"{self._unit}."):
                name = f"{record.where.partition('.')[2]}.{record.what}"
                self._changes[name].append(record.tick)
                if record.cause not in self._own:
                    self._foreign[name].append((record.tick, record.value))
        elif kind is Kind.EDGE:
            if record.where in ("SCL", "SDA"):
                self._edges.append(record.tick)
            if record.where == "SCL":
                self._scl.append((record.tick, record.value))
        elif kind is Kind.BUS:
            if record.what == "byte":
                self._bytes.append(record.tick)
        elif kind is Kind.IRQ:
            if record.where == self._unit:
                what = f"{self._unit} takes {record.what} though no host sends"
                raise BadBound(
                    f"{what}; bounds are known of firmware that polls I2C, with interrupts by host frames only"
                )
        elif record.where == self._unit:
            self._span(record)

    def _starts_up(self, record: Record, masked: bool) -> None:
        """When the receiver is up: set-up may wait for something itself, and is over when the bus is at work."""
        self._enabled = self._enabled or not masked
        if not self._enabled or (record.what.startswith(RECEIVING) and not (self._readings and self._scl)):
            self._receives = record.tick

    def _access(self, record: Record) -> None:
        assert self.dsp is not None
        self._own.add(record.number)
        self._accesses.append((record.tick, record.what, record.field))
        masked = bool(self.dsp.core.intm)
        self._starts_up(record, masked)
        if record.what.startswith("W "):  # it may land when the next wait has begun
            if record.what == DXR:
                self._writes.append(record.tick)
            elif record.what == OAR:
                self._addressed.append(record.tick)
            elif record.what == STR:
                self._clears.append((record.tick, record.text))
            return
        if self._readings and masked and self._enabled:
            self._masked = self._masked or record.text
        spin = self.dsp.program.spin
        if spin is None:
            self.trace.note(record.tick, f"{record.text} {record.what}")
            return
        before = len(spin.polls)
        if not self._readings or self._readings[-1].spin is not spin:
            self._readings.append(_Reading(spin, record.text, record.tick))
            self.trace.note(record.tick, f"{record.text} waits")
            self.trace.note(record.tick, f"{record.text} goes on", waited=True)
        else:
            self.trace.amend(record.tick)
        reading = self._readings[-1]
        reading.end = record.tick
        reading.into = before
        reading.reads = max(reading.reads, before + 1)

    def _span(self, record: Record) -> None:
        self.trace.note(record.tick, f"{record.text} span {record.what}")
        if record.value:
            self._begun[record.what] = record.tick
        elif record.what in self._begun:
            self._spans[record.what].append((self._begun.pop(record.what), record.tick))

    def fill(self, calm: UndisturbedRun, filter_cycles: int) -> UndisturbedRun:
        most: dict[str, int] = defaultdict(int)
        for reading in self._readings:
            most[reading.place] = max(most[reading.place], reading.reads)
        polled: dict[str, dict[str, None]] = defaultdict(dict)
        for reading in self._readings:
            polled[reading.place] |= dict.fromkeys(str(poll) for poll in reading.spin.polls)
        step = read_after_read(calm.options)
        shortest = calm.ticks(filter_cycles * calm.module)
        for reading in self._readings:
            fields = tuple(dict.fromkeys(str(poll) for poll in reading.spin.polls))
            wait = Wait(
                reading.place,
                fields,
                reading.first,
                reading.end,
                most[reading.place],
                reading.spin.pass_cycles,
                calm.ticks(reading.into * step),
            )
            wait.polled = tuple(polled[reading.place])
            changed, wait.flag = max(
                ((_last(self._changes[name], wait.end), name) for name in fields), default=(-1, "")
            )
            edge = _last(self._edges, changed - shortest) if changed >= 0 else -1
            if edge >= 0:
                wait.edge, wait.delay = edge, changed - edge
            calm.waits.append(wait)
        if not self._writes:
            what = f"{self._unit} writes I2CDXR never, or within a wait only, so there is no answer to bound"
            raise BadBound(f"{what}; write it behind the wait for SDIR or XRDY")
        calm.masked = self._masked
        calm.writes, calm.addressed, calm.receives = self._writes, self._addressed, self._receives
        calm.clears, calm.changes = self._clears, dict(self._foreign)
        calm.accesses = self._accesses
        calm.spans, calm.bytes = dict(self._spans), self._bytes
        for (fell, level), (rose, _) in pairwise(self._scl):
            if not level and rose - fell > calm.low:
                calm.stretches.append((fell, rose - fell - calm.low))
        self._compare(calm)
        return calm

    def _compare(self, calm: UndisturbedRun) -> None:
        """Lay the second round's code beside that of the first, each from the end of its first wait on."""
        self.trace.forget()
        places = [place for place, mark in enumerate(self.trace.marks) if mark.waited]
        one, two = (next((p for p in places if self.trace.marks[p].tick >= r.start), 0) for r in calm.rounds[:2])
        self.trace.compare(one, two, calm.cycle)


def _last(ticks: list[int], until: int) -> int:
    """The last of these up to a tick; -1 if there is none."""
    place = bisect_right(ticks, until)
    return ticks[place - 1] if place else -1
