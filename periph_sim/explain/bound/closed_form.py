"""The worst case of request and response in closed form: what code and waits cost goes in, sums of terms come out.

    response = max(SCL low time, filter + poll pass + code up to I2CDXR + interrupts + copy + setup + output
                                 - time on the bus from the flag's edge to the end of the address's ACK slot)

Holds as long as the firmware keeps the deadlines of `deadlines`.
Source of the form: SPRUG03B sections 2 and 3 (XRDY, stretching), the busy window of response-time analysis.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import ceil, floor

from msgspec import Struct
from msgspec.structs import replace

from ...bus.i2c.transfer import Phase, Transfer
from ...core.time import Timebase
from ...devices.sensor_rounds import CHIPS, Round
from ...f28335.cpu import instruction_costs as cpu_costs
from ...f28335.i2c.options import I2cOptions
from ...f28335.system.memory_map import WRITE_TO_READ
from ...f28335.system.options import SystemOptions
from ...scene.case.model import Case
from .fifo_bound import fifo_bounds
from .latest_chain import LatestChain, chains, waits_between
from .service_routine import ServiceRoutines, in_ticks
from .terms import BadBound, Bound, Term, reasons, total
from .undisturbed_run import UndisturbedRun, Wait

MEASURED = "measured in a run without host"


class Write(Struct, frozen=True):
    """A write of I2CDXR at its latest, interrupts included. before: what of the chain lies before the SCL fall behind
    which its first bit stands, as a term to be taken off. late: ticks from that fall to the release of SCL.

    alone: the same without interrupts. made: how many writes of I2CDXR the chain makes, this one included.
    """

    chain: LatestChain
    interrupts: Term
    before: Term
    late: int
    alone: int
    made: int


class ClosedForm:
    """The bounds of one case. scene_ticks: of the case's own durations."""

    def __init__(
        self, case: Case, calm: UndisturbedRun, handlers: ServiceRoutines, timebase: Timebase, options: I2cOptions
    ) -> None:
        assert case.controller is not None
        self.case, self.calm, self.handlers = case, calm, handlers
        self.timebase = timebase
        controller = case.controller
        self.period, self.jitter, self.first = (
            in_ticks(length, controller.ppm, timebase)
            for length in (controller.period, controller.jitter, controller.first)
        )
        self._options = options
        self._interrupts: dict[int, Term] = {}  # what `preempted` made already, by how many
        if any(fell not in self._reading for fell, _ in calm.stretches):
            what = "the unit holds SCL elsewhere than before the data of a read, and no term counts that"
            raise BadBound(f"case {case.name}: {what}; see `stretch` of a run with --explain for where and why")
        if any(len(phase.acks) > 1 for transfer in calm.transfers for phase in transfer.phases if not phase.read):
            what = "a request writes more than one byte; SCL may be held behind each, and no term counts that"
            raise BadBound(f"case {case.name}: {what}; judge such requests by what a run shows")

    # Parts ---------------------------------------------------------------------

    @cached_property
    def release(self) -> tuple[Term, ...]:
        """From the write of I2CDXR to the rise of SCL, where the module waits for data."""
        calm, options = self.calm, self._options
        bcm = options.bcm_reset.unrecorded()
        copy = 0 if bcm else calm.module
        setup = max(1, options.sda_setup_before_scl_release.unrecorded() * calm.module)
        out = calm.options.gpio_out_delay.unrecorded()
        return (
            Term("copy I2CDXR to I2CXSR", calm.ticks(copy), f"at the write with BCM = {bcm} (bcm_reset)"),
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
        """The writes of each read, one a byte, each by its latest chain; `alone` is of that which is so undisturbed."""
        return [
            [
                replace(max(chains, key=lambda write: write.late), alone=max(write.alone for write in chains))
                for chains in of_read
            ]
            for of_read in self._candidates
        ]

    @cached_property
    def _candidates(self) -> list[list[list[Write]]]:
        """Of each read, each write by every chain that leads to it."""
        return [self._writes_of(transfer, phase) for transfer, phase in self._reads]

    def _writes_of(self, transfer: Transfer, phase: Phase) -> list[list[Write]]:
        calm = self.calm
        begin = transfer.phases[0].start_at
        made = [tick for tick in calm.writes if phase.start_at < tick <= transfer.stop_at]
        found: list[list[Write]] = []
        for number, (need, point) in enumerate(zip(self._needs(transfer, phase), made, strict=False)):
            waits = waits_between(calm, begin, point)
            which = "the address's ACK slot" if not number else f"byte {number - 1}'s ACK slot"
            candidates: list[Write] = []
            for chain in chains(calm, waits, point, "I2CDXR"):
                before = Term(f"edge to the end of {which}", calm.bus(chain.edge) - calm.bus(need), "controller.rate")
                length = chain.length + total(self.release)
                interrupts = self.preempted(length)
                alone = length + before.ticks
                writes = sum(chain.edge < tick <= point for tick in calm.writes)
                candidates.append(Write(chain, interrupts, before, alone + interrupts.ticks, alone, writes))
            if not candidates:
                what = f"I2CDXR of {transfer.name} byte {number} is written behind no wait that a flag of the bus ends"
                raise BadBound(f"{what}, so nothing says how late it may be; wait for SDIR or XRDY before it")
            found.append(candidates)
        if not found:
            what = f"I2CDXR is not written between the read address of {transfer.name} and its STOP"
            raise BadBound(f"{what}, so there is no answer to bound; write it behind the flag that asks for it")
        return found

    def preempted(self, length: int) -> Term:
        """What interrupts add to something of so many ticks."""
        count = self.handlers.within(length)
        if count not in self._interrupts:
            cost = f"{self.handlers.cost / float(self.calm.cycle):.0f} cycles each"
            source = f"{cost}, see service routine"
            unproven = reasons(self.handlers.terms) if count else ""
            taken = count * self.handlers.cost
            self._interrupts[count] = Term(f"interrupts by host frames: {count}", taken, source, unproven)
        return self._interrupts[count]

    # Bounds --------------------------------------------------------------------

    def bounds(self, spare: Iterable[Bound]) -> list[Bound]:
        """All of them. spare: the deadlines that they rest on, none of which may be missed."""
        found = [self.response, self.stretch, self.margin, self.round, self.slack, *self.spans]
        found += [*self.ages, *self.latencies, *self.fifo, *self.none_missed, *self.reactions, *self.own_addresses]
        unproven = reasons(term for deadline in spare for term in deadline.terms)
        rests = (Term("deadlines are kept", 0, "listed below", unproven),) if unproven else ()
        return [replace(bound, terms=(*bound.terms, *rests)) for bound in found]

    @cached_property
    def response(self) -> Bound:
        terms = self._until_release(max((writes[0] for writes in self.writes), key=lambda write: write.late))
        low = Term("SCL low time of the controller", self.calm.low, "controller.rate, controller.low")
        return Bound("response", "response", terms, low)

    @cached_property
    def stretch(self) -> Bound:
        """Of the I2CDXR write that comes latest; nothing else holds SCL, or there would be no closed form."""
        latest = max((write for writes in self.writes for write in writes), key=lambda write: write.late)
        low = Term("SCL low time of the controller", -self.calm.low, "controller.rate, controller.low")
        none = Term("no stretch", 0, "SCL is released before the controller releases it")
        return Bound("stretch", "stretch", (*self._until_release(latest), low), none)

    @cached_property
    def margin(self) -> Bound:
        """Of the write that comes latest: what is left before the controller releases SCL."""
        latest = max((write for writes in self.writes for write in writes), key=lambda write: write.late)
        low = Term("SCL low time of the controller", self.calm.low, "controller.rate, controller.low")
        taken = (term.taken_off() for term in self._until_release(latest))
        return Bound("margin", "margin of I2CDXR", (low, *taken), least=True)

    @cached_property
    def held_from(self) -> int:
        """Cycles more before each write of I2CDXR, from which on SCL may be held for it; 0: it may be already."""
        return min(self._held_from(write) for read in self._candidates for chains in read for write in chains)

    def _held_from(self, write: Write) -> int:
        """Longer code may meet more interrupts, which leave less for it: down from what is left without any."""
        calm, length, left = self.calm, write.alone - write.before.ticks, self.calm.low - write.alone
        cycles = floor(left / (write.made * calm.cycle))
        while cycles >= 0:
            added = calm.ticks(write.made * cycles)
            room = left - self.preempted(length + added).ticks
            if added <= room:
                return cycles + 1
            cycles = min(cycles - 1, floor(room / (write.made * calm.cycle)))
        return 0

    def _until_release(self, write: Write) -> tuple[Term, ...]:
        """From the SCL fall behind which the first bit stands to the release of SCL."""
        return (*write.chain.terms, write.interrupts, *self.release, write.before)

    @cached_property
    def reactions(self) -> list[Bound]:
        """From SDIR or XRDY to the write of I2CDXR, of either and of each; none where a write waits for neither."""
        found: dict[str, list[tuple[Term, ...]]] = {}
        for transfer in self.calm.transfers:
            begin = transfer.phases[0].start_at
            for point in (tick for tick in self.calm.writes if begin < tick <= transfer.stop_at):
                waits = waits_between(self.calm, begin, point)
                flag = waits[-1].flag.rpartition(".")[2] if waits else ""
                if flag not in ("SDIR", "XRDY") or waits[-1].edge is None:
                    return []
                found.setdefault(flag, []).extend(self._reactions(waits, point))
        of_flag = {flag: max(sums, key=total) for flag, sums in found.items()}
        if not of_flag:
            return []
        bounds = [Bound("reaction", "reaction", max(of_flag.values(), key=total))]
        for flag, terms in of_flag.items():
            measure = f"from flag I2C-A.I2CSTR.{flag} rise to access W I2C-A.I2CDXR"
            for text in (measure, f"{measure}, same transfer") if flag == "SDIR" else (f"{measure}, same transfer",):
                bounds.append(Bound(f"reaction to {flag}", text, terms, special=True))
        return bounds

    def _reactions(self, waits: list[Wait], point: int) -> Iterator[tuple[Term, ...]]:
        """By each chain that leads to the write: what passes from the flag of the last wait on."""
        calm, last = self.calm, waits[-1]
        assert last.edge is not None
        flag = last.flag.rpartition(".")[2]
        for chain in chains(calm, waits, point, "I2CDXR"):
            interrupts = self.preempted(chain.length)
            if chain.edge == last.edge:
                yield (*chain.terms[1:], interrupts)
            else:
                since = calm.bus(last.edge) - calm.bus(chain.edge) + last.delay - calm.ticks(1) - calm.rounding
                yield (*chain.terms, interrupts, Term(f"edge to {flag}", -since, "controller.rate"))

    @cached_property
    def latencies(self) -> list[Bound]:
        """From the request to the first instruction, by vector; nothing but an instruction under way may delay it."""
        calm, handlers, options = self.calm, self.handlers, self.calm.options
        if not handlers.per_frame or self.case.host is None:
            return []
        protected = options.pf2_read_ws.unrecorded() + options.write_lands.unrecorded() + WRITE_TO_READ + 3
        longest = max(protected, cpu_costs.IRET, *map(calm.pass_cycles, calm.waits)) + options.idle_wake.unrecorded()
        busy = handlers.cost if handlers.apart <= handlers.cost else 0
        masked = f"{calm.masked} runs with interrupts masked" if calm.masked else self._too_early
        terms = (
            Term("request to first instruction", calm.ticks(entry_latency(options)), "int_latency", masked),
            Term("instruction under way", calm.ticks(longest), "a pass of a wait, or a read behind a write, at most"),
            Term(
                "service routine before", busy, "none where they are asked for further apart", reasons(handlers.terms)
            ),
        )
        found = [Bound(f"latency {name}", f"interrupt latency {name}", terms) for name in handlers.vectors]
        routine = (handlers.terms[-1],)
        in_it = "each time in interrupt"
        return found + [Bound(f"in {name}", f"{in_it} {name}", routine, special=True) for name in handlers.vectors]

    @cached_property
    def fifo(self) -> list[Bound]:
        """High-water and overruns of the receive FIFO; none where no FIFO interrupt serves it."""
        receiver = self.handlers.receiver
        if receiver is None or not self.latencies:
            return []
        return fifo_bounds(receiver, self.latencies[0].terms, self.handlers.terms[-1].ticks)

    @cached_property
    def _too_early(self) -> str:
        """What is wrong where the first frame may come before the firmware can take it; empty if it cannot."""
        calm, host = self.calm, self.case.host
        assert host is not None
        first = floor(in_ticks(host.first, host.ppm, self.timebase))
        ready = calm.receives - calm.start
        if first > ready + self.handlers.bit:
            return ""
        what = f"part of the first host frame, at {self.timebase.show(first)}, may come before the firmware receives"
        return f"{what} at {self.timebase.show(ready)}, and every later one be read out of step; raise host.first"

    @cached_property
    def own_addresses(self) -> list[Bound]:
        """From a STOP to the write of I2COAR; none where not every STOP has one before the next request.

        The slowest is mostly behind the last STOP of a round. The others come first in every round, so that of all
        values their part at least is below their own bound.
        """
        assert self.case.controller is not None
        calm, each = self.calm, []
        for before, after in pairwise(calm.transfers):
            made = [at for at in calm.addressed if before.stop_at < at < after.phases[0].start_at]
            if len(made) != 1:
                return []
            waits = waits_between(calm, before.phases[0].start_at, made[0])
            sums = []
            for chain in chains(calm, waits, made[0], "I2COAR"):
                since = Term("edge to STOP", calm.bus(chain.edge) - calm.bus(before.stop_at), "controller.rate")
                sums.append((*chain.terms, self.preempted(chain.length), since))
            if not sums:
                return []
            each.append(max(sums, key=total))
        measure, per_round = "from bus STOP to access W I2C-A.I2COAR", len(calm.transfers) // len(calm.rounds)
        found = [Bound("own address", measure, max(each, key=total), special=True)]
        if per_round > 1 and self.case.controller.initialise is None:
            others = [terms for place, terms in enumerate(each) if place % per_round != per_round - 1]
            part = Fraction(per_round - 1, per_round)
            found.append(Bound("own address within a round", measure, max(others, key=total), special=True, part=part))
        return found

    @cached_property
    def none_missed(self) -> list[Bound]:
        """Counts that stay 0 while the deadlines are kept: each request finds the firmware in its wait."""
        assert self.case.controller is not None
        if self.case.controller.initialise is not None:
            return []
        none = Term("requests that come too early", 0, "the deadlines below")
        found = [Bound(name, name, (none,), counted=True, special=True) for name in ("nacked rounds", "nacked")]
        if self.slack.ticks > 0:
            late = Term("rounds that last too long", 0, "slack", self.slack.unproven)
            found.append(Bound("missed rounds", "missed rounds", (late,), counted=True, special=True))
        return found

    @cached_property
    def round(self) -> Bound:
        """From its begin, whenever that was, to its last STOP."""
        per_round = len(self.writes) // len(self.calm.rounds)
        rounds = [self.writes[i : i + per_round] for i in range(0, len(self.writes), per_round)]
        late = max(sum(max(0, w.alone - self.calm.low) for writes in reads for w in writes) for reads in rounds)
        bus = max(self._bus_time(over) for over in self.calm.rounds)
        source = "each I2CDXR write at its latest, as for response"
        why = reasons(term for writes in self.writes for w in writes for term in w.chain.terms)
        terms = (
            Term("requests on the bus", bus, "controller.rate, gap, order; START to STOP without stretching"),
            Term("stretching by code and polls", late, source, why),
        )
        return Bound("round", "round", (*terms, self.preempted(total(terms))))

    def _bus_time(self, over: Round) -> int:
        return self.calm.bus(over.end) - self.calm.bus(over.start)

    @cached_property
    def slack(self) -> Bound:
        taken = tuple(term.taken_off() for term in self.round.terms)
        period = Term("period", floor(self.period), "controller.period, ppm")
        late = Term("late round", -ceil(self.jitter), "controller.jitter")
        return Bound("slack", "slack", (period, late, *taken), least=True)

    @cached_property
    def spans(self) -> list[Bound]:
        found = []
        for name, times in self.calm.spans.items():
            cost = max(self.calm.lasting(begin, end) for begin, end in times)
            unproven = next(filter(None, (self.calm.unproven(begin, end) for begin, end in times)), "")
            terms = (Term(f"span {name}", cost, f"its cost, {MEASURED}", unproven), self.preempted(cost))
            found.append(Bound(f"span {name}", f"span:{name}", terms))
        return found

    @cached_property
    def ages(self) -> list[Bound]:
        """Of every read, and of each chip's; none where the models do not run once after each round, on what came."""
        calm, host = self.calm, self.case.host
        works = [begin for times in calm.spans.values() for begin, _ in times]
        one, two = calm.rounds[:2]
        if host is None or not self.handlers.per_frame or not any(one.end <= begin < two.start for begin in works):
            return []
        if host.lose or host.silent or host.frames is not None:
            return []
        early = Term("first frame behind the start-up", 0, "host.first", self._too_early or self._dropped)
        into: dict[str, int] = {}
        for name, chip in CHIPS.items():
            reads = [phase.start_at for _, phase in self._reads if phase.address == chip.address]
            found = [calm.bus(at) - calm.bus(r.start) for at in reads for r in calm.rounds if r.start <= at <= r.end]
            into |= {f" of {name}": max(found)} if found else {}
        if not into:
            return []
        into[""] = max(into.values())
        return [
            Bound(
                f"{of}{chip}", f"{of}{chip}", (*self._age(ticks, min(works)), early), special=bool(chip) or of != "age"
            )
            for of in ("age", "model age")
            for chip, ticks in into.items()
        ]

    @property
    def _dropped(self) -> str:
        """What is wrong where a host may leave a frame out, or one is not served as a whole; empty if neither."""
        from ...devices.host_pc import FRAME_BYTES  # of a host that is there

        host, receiver = self.case.host, self.handlers.receiver
        assert host is not None
        lasts = (FRAME_BYTES * (10 + host.gap)) * self.handlers.bit
        between = self.handlers.period - (self.handlers.jitter if host.paced_by == "schedule" else 0)
        if between <= lasts:
            return "a frame of the host may be due while the one before is still sent, and is left out"
        if receiver is not None and FRAME_BYTES % receiver.level:
            return f"the FIFO asks for service at {receiver.level} words, which do not make up a frame of {FRAME_BYTES}"
        if receiver is not None and len(receiver.reads) != receiver.level:
            read = f"{len(receiver.reads)} words are read each time"
            return f"the FIFO asks for service at {receiver.level} words, but {read}, whether they are there or not"
        return ""

    def _age(self, into: int, first_model: int) -> tuple[Term, ...]:
        """into: of the read in its round."""
        calm, handlers = self.calm, self.handlers
        bus = min(self._bus_time(over) for over in calm.rounds)
        late = total(self.round.terms[1:]) + ceil(self.jitter)
        routines = handlers.per_frame * handlers.cost
        beside = calm.options.idle_wake.unrecorded() + max(map(calm.pass_cycles, calm.waits))
        latency = calm.ticks(entry_latency(calm.options) + beside)
        shared = (
            Term("read in its round", into, "controller.rate, order"),
            Term("late and stretched round", late, "controller.jitter, and as for round", self.round.unproven),
            Term("SCI flag behind the stop bit", handlers.bit, "a bit of host.baud at most"),
            Term("interrupt latency", latency, "int_latency, and a poll's branch that it waits for"),
            Term("service routines of a frame", routines, "measured without requests", reasons(handlers.terms)),
        )
        steady = (
            Term("frame that none has followed yet", handlers.period + 1 + handlers.jitter, "host.period, ppm, jitter"),
            Term("round before, whose end the models wait for", ceil(self.period), "controller.period, ppm"),
            Term("round before which no model begins", -bus, "controller.rate, order"),
        )
        early = (
            Term("first round and a period", ceil(self.first + self.period), "controller.first, controller.period"),
            Term("first model's begin", calm.start - first_model, MEASURED),
        )
        return (*max(steady, early, key=total), *shared)


def entry_latency(options: SystemOptions) -> int:
    """Cycles from a request to the first instruction of its service routine, if nothing is under way."""
    return options.int_latency.unrecorded() + options.vector_fetch_waits.unrecorded()
