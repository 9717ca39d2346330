"""The worst case of request and response in closed form: what code and waits cost goes in, sums of terms come out.

    response = max(SCL low time, filter + poll pass + code up to I2CDXR + interrupts + copy + setup + output
                                 - time on the bus from the flag's edge to the end of the address's ACK slot)

Holds as long as the firmware keeps the deadlines of `deadlines`.
Source of the form: SPRUG03B sections 2 and 3 (XRDY, stretching), the busy window of response-time analysis.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from ..case.model import Case
from ..core.time import Timebase
from ..devices.sensor_head import CHIPS, Round
from ..f28335.i2c_options import I2cOptions
from ..lines.i2c_controller import Phase, Transfer
from .calm import Calm
from .handler import Handlers
from .late import Late, chains, waits_between
from .terms import BadBound, Bound, Term, total

MEASURED = "measured in a run without host"


@dataclass(frozen=True)
class Write:
    """A write of I2CDXR at its latest. late: ticks, without interrupts, from the SCL fall behind which its first bit
    stands to the release of SCL. before: what of the chain lies before that fall, as a term to be taken off."""

    chain: Late
    before: Term
    late: int


class Closed:
    """The bounds of one case. scene_ticks: of the case's own durations."""

    def __init__(self, case: Case, calm: Calm, handlers: Handlers, timebase: Timebase, options: I2cOptions) -> None:
        assert case.controller is not None
        self.case, self.calm, self.handlers = case, calm, handlers
        self.timebase = timebase
        controller = case.controller
        self.period, self.jitter, self.first = (
            timebase.ticks(length, "nearest") for length in (controller.period, controller.jitter, controller.first)
        )
        self._options = options
        if any(fell not in self._reading for fell, _ in calm.stretches):
            raise BadBound(f"case {case.name}: SCL is stretched before a read's data, which no term of the sum is for")

    # Parts ---------------------------------------------------------------------

    @cached_property
    def release(self) -> tuple[Term, ...]:
        """From the write of I2CDXR to the rise of SCL, where the module waits for data."""
        calm, options = self.calm, self._options
        copy = 0 if options.bcm_reset else calm.module
        setup = max(1, options.sda_setup_before_scl_release * calm.module)
        out = calm.options.gpio_out_delay
        return (
            Term("copy I2CDXR to I2CXSR", calm.ticks(copy), f"at the write with BCM = {options.bcm_reset} (bcm_reset)"),
            Term("SDA set up before SCL", calm.ticks(setup), "sda_setup_before_scl_release x (IPSC + 1)"),
            Term("pin output", calm.ticks(out), "gpio_out_delay"),
        )

    @property
    def _reads(self) -> Iterator[tuple[Transfer, Phase]]:
        for transfer in self.calm.transfers:
            for phase in transfer.phases:
                if phase.read:
                    yield transfer, phase

    @cached_property
    def _reading(self) -> set[int]:
        """The SCL falls at which a data byte of a read begins: there a slave without data stretches."""
        return {need for transfer, phase in self._reads for need in self._needs(transfer, phase)}

    def _needs(self, transfer: Transfer, phase: Phase) -> list[int]:
        ends = [tick for tick in self.calm.bytes if phase.answer_from < tick <= transfer.stop_at]
        return [phase.answer_from, *ends][: phase.count]

    @cached_property
    def writes(self) -> list[list[Write]]:
        """The writes of each read, one a byte, each by its latest chain."""
        return [self._writes_of(transfer, phase) for transfer, phase in self._reads]

    def _writes_of(self, transfer: Transfer, phase: Phase) -> list[Write]:
        calm = self.calm
        begin = transfer.phases[0].start_at
        made = [tick for tick in calm.writes if phase.start_at < tick <= transfer.stop_at]
        found = []
        for number, (need, point) in enumerate(zip(self._needs(transfer, phase), made, strict=False)):
            waits = waits_between(calm, begin, point)
            which = "the address's ACK slot" if not number else f"byte {number - 1}'s ACK slot"
            latest: Write | None = None
            for chain in chains(calm, waits, point, "I2CDXR"):
                before = Term(f"edge to the end of {which}", calm.bus(chain.edge) - calm.bus(need), "controller.rate")
                write = Write(chain, before, total((*chain.terms, *self.release)) + before.ticks)
                if latest is None or write.late > latest.late:
                    latest = write
            if latest is None:
                raise BadBound(f"the write of I2CDXR for {transfer.name} byte {number} follows no wait for a flag")
            found.append(latest)
        if not found:
            raise BadBound(f"I2CDXR is not written between the read address of {transfer.name} and its STOP")
        return found

    def preempted(self, length: int) -> Term:
        """What interrupts add to something of so many ticks."""
        count = self.handlers.within(length)
        cost = f"{self.handlers.cost / float(self.calm.cycle):.0f} cycles each"
        return Term(f"interrupts by host frames: {count}", count * self.handlers.cost, f"{cost}, see service routine")

    # Bounds --------------------------------------------------------------------

    @cached_property
    def response(self) -> Bound:
        write = max((writes[0] for writes in self.writes), key=lambda write: write.late)
        sum_of = (*write.chain.terms, *self.release)
        terms = (*write.chain.terms, self.preempted(total(sum_of)), *self.release, write.before)
        low = Term("SCL low time of the controller", self.calm.low, "controller.rate, controller.low")
        return Bound("response", "response", terms, low)

    @cached_property
    def round(self) -> Bound:
        per_round = len(self.writes) // len(self.calm.rounds)
        rounds = [self.writes[i : i + per_round] for i in range(0, len(self.writes), per_round)]
        late = max(sum(max(0, w.late - self.calm.low) for writes in reads for w in writes) for reads in rounds)
        bus = max(self._bus_time(over) for over in self.calm.rounds)
        terms = (
            Term("requests on the bus", bus, "controller.rate, gap, order; START to STOP without stretching"),
            Term("late round", self.jitter, "controller.jitter"),
            Term("stretching by code and polls", late, "each I2CDXR write at its latest, as for response"),
        )
        return Bound("round", "round", (*terms, self.preempted(total(terms))))

    def _bus_time(self, over: Round) -> int:
        return self.calm.bus(over.end) - self.calm.bus(over.due)

    @cached_property
    def slack(self) -> Bound:
        taken = tuple(Term(term.what, -term.ticks, term.source) for term in self.round.terms)
        return Bound("slack", "slack", (Term("period", self.period, "controller.period"), *taken), least=True)

    @cached_property
    def spans(self) -> list[Bound]:
        found = []
        for name, times in self.calm.spans.items():
            cost = max(end - begin for begin, end in times)
            terms = (Term(f"span {name}", cost, f"its cost, {MEASURED}"), self.preempted(cost))
            found.append(Bound(f"span {name}", f"span:{name}", terms))
        return found

    @cached_property
    def age(self) -> Bound | None:
        """None where no host sends, or no work on its frames is seen between the rounds."""
        calm, handlers = self.calm, self.handlers
        if self.case.host is None or not handlers.per_frame:
            return None
        address = CHIPS["gyroscope"].address
        reads = [phase for _, phase in self._reads if phase.address == address]
        one, two = calm.rounds[:2]
        works = [begin for times in calm.spans.values() for begin, _ in times]
        if not reads or not any(one.end <= begin < two.start for begin in works):
            return None
        into = max(calm.bus(p.start_at) - calm.bus(r.due) for p, r in zip(reads, calm.rounds, strict=True))
        bus = min(self._bus_time(over) for over in calm.rounds)
        late = total(self.round.terms[1:])
        routines = handlers.per_frame * handlers.cost
        pass_ticks = max(calm.pass_ticks(wait) for wait in calm.waits)
        latency = calm.ticks(calm.options.int_latency) + pass_ticks
        shared = (
            Term("gyroscope's read in its round", into, "controller.rate, order"),
            Term("late and stretched round", late, "as for round"),
            Term("SCI flag behind the stop bit", handlers.bit, "a bit of host.baud at most"),
            Term("interrupt latency", latency, "int_latency, and a poll's branch that it waits for"),
            Term("service routines of a frame", routines, "measured with no controller"),
        )
        steady = (
            Term("two rounds: missed by one model, shown after the next", 2 * self.period, "controller.period"),
            Term("round before which no model begins", -bus, "controller.rate, order"),
        )
        begin = calm.start - min(works)
        early = (
            Term("first round and a period", self.first + self.period, "controller.first, controller.period"),
            Term("first model's begin", begin, MEASURED),
        )
        return Bound("age", "age", (*max(steady, early, key=total), *shared))
