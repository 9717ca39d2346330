"""The terms that the level adds up, measured from short edge runs of the very case, as `explain.bound` measures them.

observe (no host, two rounds)      --> waits, code between them, what the bus does when
observe_handlers (host, no request) --> the service routine's cycles
sample_grid (host, no request)      --> SCICLK's place in the CPU's cycles, from a stop bit to the FIFO's request

read:  START .. AAS | code | RRDY | code, I2CSTR written | SDIR | code, I2CDXR | XRDY | I2CDXR | .. | SCD | code ..
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

from ...bus.i2c.transfer import BusTiming, Transfer
from ...core.options import options_from
from ...explain.bound.service_routine import ServiceRoutines
from ...explain.bound.undisturbed_run import UndisturbedRun, Wait, read_after_read
from ...f28335.i2c.options import I2cOptions
from ...scene.case.model import Case
from .code import Code, CodeTable, CodeTiming, accesses_in
from .errors import refuse

STR, MDR, DXR, OAR = "I2C-A.I2CSTR", "I2C-A.I2CMDR", "I2C-A.I2CDXR", "I2C-A.I2COAR"
AAS, RRDY, SDIR, XRDY, SCD = (f"{STR}.{flag}" for flag in ("AAS", "RRDY", "SDIR", "XRDY", "SCD"))


@dataclass(frozen=True)
class ReadBus:
    """When the bus does what in a read, in ticks from its START, as long as SCL is not held.

    aas, rrdy, sdir: the edges that set these flags. again: the repeated START. needs: SCL falls at the end of the
    ACK slot before each data byte. stop: of the transfer. eighth: SCL falls behind the address and its R/W bit.
    refused: the STOP, if nobody acknowledges the address.
    """

    aas: int
    rrdy: int
    sdir: int
    again: int
    needs: tuple[int, ...]
    stop: int
    eighth: int
    refused: int


@dataclass(frozen=True)
class ReadCode:
    """Code of a read, each from the read that ended a wait to the first read of the next. clear: I2CSTR is written.

    first, more: I2CDXR is written. after: up to the next wait for AAS, or, behind the last read, to the models.
    """

    pointer: CodeTable
    clear: CodeTable
    first: CodeTable
    more: tuple[CodeTable, ...]
    after: CodeTable


@dataclass(frozen=True)
class Terms:
    """bus: of each read. seen: cycles from a bus edge to its flag. gap: from a STOP to the next START, in a round.

    free: the same at least. poll, poll_two: cycles of a pass that reads one flag, and two. second: from the first to
    the second. reads: the code of each read. start: from the end of the models to the first wait for AAS.
    first_model: the cycle at which the models begin for the first time. waits: read wait states. release: cycles from
    a late write of I2CDXR to the release of SCL, out: to the pin; margin: the same as `margin of I2CDXR` counts it.
    """

    names: tuple[str, ...]
    bus: tuple[ReadBus, ...]
    seen: int
    low: int
    high: int
    gap: int
    free: int
    poll: int
    poll_two: int
    second: int
    waits: int
    service: int
    reads: tuple[ReadCode, ...]
    start: CodeTable
    first_model: int
    release: int
    margin: int
    cycle: Fraction


def measured(
    case: Case,
    calm: UndisturbedRun,
    handlers: ServiceRoutines,
    timing: BusTiming,
    gap: int,
    modules: Mapping[str, bool],
) -> Terms:
    """timing, gap: of the controller agent. BadSchedule where the run has another structure."""
    return _Measured(case, calm, handlers, timing, gap, modules).terms()


class _Measured:
    def __init__(
        self,
        case: Case,
        calm: UndisturbedRun,
        handlers: ServiceRoutines,
        timing: BusTiming,
        gap: int,
        modules: Mapping[str, bool],
    ) -> None:
        self._case, self._calm, self._bus = case, calm, timing
        self._gap, self._modules = gap, modules
        service = sum(round(term.ticks / calm.cycle) for term in handlers.terms)
        self._timing = CodeTiming(calm.code, calm.options, service)
        self._records = [(self._cycle(tick), what, field) for tick, what, field in calm.accesses]
        self._per_round = len(calm.transfers) // 2
        self._waits = [wait for wait in calm.waits if wait.end >= calm.rounds[0].start]

    def _refuse(self, what: str) -> Exception:
        return refuse(self._case.name, what)

    def _cycle(self, tick: int) -> int:
        """From the begin of the run on: the first that begins at or after a tick."""
        return -(-(tick - self._calm.start) * self._calm.cycle.denominator // self._calm.cycle.numerator)

    def terms(self) -> Terms:
        calm, options = self._calm, self._calm.options
        i2c = self._i2c
        reads = calm.transfers[: self._per_round]
        spans = calm.spans.get("model", [])
        if set(calm.spans) != {"model"} or len(spans) != 3 or any(transfer.stop_at < 0 for transfer in reads):
            raise self._refuse("the firmware's models do not run once before the first round and once behind each")
        per_read = [self._of_read(number) for number in range(2 * self._per_round)]
        buses, codes = [bus for bus, _ in per_read], [code for _, code in per_read]
        half = self._per_round
        shapes = [_shape(code) for code in codes]
        if buses[:half] != buses[half:] or shapes[:half] != shapes[half:]:
            raise self._refuse("two rounds without a host are not alike")
        setup = max(1, i2c.sda_setup_before_scl_release.unrecorded() * calm.module)
        first = next(wait for wait in calm.waits if wait.first > spans[0][1])
        behind = self._code(self._cycle(spans[0][1]), self._cycle(first.first), "the models", behind_wait=False)
        waits, pin = options.pf2_read_ws.unrecorded(), options.gpio_out_delay.unrecorded()
        one = 1 + waits
        return Terms(
            names=tuple(transfer.name for transfer in reads),
            bus=tuple(buses[:half]),
            seen=self._seen,
            low=self._bus.low,
            high=self._bus.high,
            gap=max(self._gap, self._bus.free),
            free=self._bus.free,
            poll=max(calm.code.poll_pass, one),
            poll_two=max(calm.code.poll_pass, one) + read_after_read(options),
            second=read_after_read(options),
            waits=waits,
            service=self._timing.service,
            reads=tuple(codes[:half]),
            start=self._ready(behind),
            first_model=self._cycle(spans[0][0]),
            release=setup + (pin if self._modules.get("GPIO") else 0),
            margin=setup + pin,
            cycle=calm.cycle,
        )

    @cached_property
    def _i2c(self) -> I2cOptions:
        return options_from(I2cOptions, self._case.unit[self._calm.unit].options.get("i2c", {}))

    @property
    def _seen(self) -> int:
        """Cycles from an edge to what it sets."""
        return self._i2c.noise_filter_cycles.unrecorded() * self._calm.module

    # One read --------------------------------------------------------------------

    def _of_read(self, number: int) -> tuple[ReadBus, ReadCode]:
        calm = self._calm
        transfer = calm.transfers[number]
        start = transfer.phases[0].start_at
        waits = [wait for wait in self._waits if start < wait.end and (wait.edge or 0) <= transfer.stop_at]
        waits = [wait for wait in waits if wait.end > start][: transfer.phases[-1].count + 4]
        flags = [wait.flag for wait in waits]
        count = transfer.phases[-1].count
        if (
            len(transfer.phases) != 2
            or flags != [AAS, RRDY, SDIR, *[XRDY] * count, SCD]
            or any(wait.pass_cycles is not None for wait in waits)
        ):
            raise self._refuse(f"the read of {transfer.name} does not wait for AAS, RRDY, SDIR, XRDY per byte and SCD")
        bus = self._bus_of(transfer, waits)
        ends = [(self._cycle(wait.end), self._cycle(after.first), wait.flag) for wait, after in pairwise(waits)]
        codes = [self._code(*each) for each in ends]
        last = waits[-1]
        following = next((wait for wait in self._waits if wait.first > last.end), None)
        begin = next((begin for begin, _ in calm.spans["model"] if begin > last.end), None)
        if following is None and begin is None:
            raise self._refuse("the run without a host ends in a read")
        if begin is not None and (following is None or begin < following.first):
            after = CodeTable(self._code(self._cycle(last.end), self._cycle(begin), "SCD", into_wait=False))
        else:
            assert following is not None
            after = self._ready(self._code(self._cycle(last.end), self._cycle(following.first), "SCD"))
        clear = codes[1]
        marks = self._places(clear, "M", STR)
        if len(marks) != 1:
            raise self._refuse("SCD is not cleared by one write of the field between RRDY and SDIR")
        return bus, ReadCode(
            CodeTable(codes[0]),
            CodeTable(clear, [("read", marks[0]), ("lands", marks[0])]),
            self._writes(codes[2]),
            tuple(self._writes(code) for code in codes[3:]),
            after,
        )

    def _bus_of(self, transfer: Transfer, waits: list[Wait]) -> ReadBus:
        timing, calm = self._bus, self._calm
        start = transfer.phases[0].start_at
        bit, count = timing.low + timing.high, transfer.phases[1].count
        again = timing.start_hold + 18 * bit + timing.low + timing.start_setup
        fall = again + timing.start_hold + 9 * bit
        needs = tuple(fall + 9 * bit * byte for byte in range(count))
        stop = needs[-1] + 9 * bit + timing.low + timing.stop_setup
        points = {"fall8": 8 * bit, "rise8": 7 * bit + timing.low, "rise9": 8 * bit + timing.low, "fall9": 9 * bit}
        address = points[self._i2c.aas_sdir_point.unrecorded()]
        pointer = points[self._i2c.rrdy_point.unrecorded()]
        edges = (
            timing.start_hold + address,
            timing.start_hold + 9 * bit + pointer,
            again + timing.start_hold + address,
        )
        held = calm.bus(start) - start
        stopped = calm.bus(transfer.stop_at) - held - start
        measured = (transfer.phases[1].start_at - start, transfer.phases[1].answer_from - start, stopped)
        if measured != (again, needs[0], stop):
            raise self._refuse(f"the read of {transfer.name} takes another time on the bus than its bits, undisturbed")
        for wait, edge in zip((*waits[:3], waits[-1]), (*edges, transfer.stop_at - start), strict=True):
            if self._cycle((wait.edge or 0) + wait.delay) != self._cycle(start + edge) + self._seen:
                flag = wait.flag.rpartition(".")[2]
                raise self._refuse(f"{flag} of {transfer.name} does not rise a fixed time behind its edge")
        refused = timing.start_hold + 9 * bit + timing.low + timing.stop_setup
        return ReadBus(edges[0], edges[1], edges[2], again, needs, stop, timing.start_hold + 8 * bit, refused)

    # Code ---------------------------------------------------------------------------

    def _code(self, begin: int, end: int, what: str, behind_wait: bool = True, into_wait: bool = True) -> Code:
        lands = self._timing.options.write_lands.unrecorded()
        accesses = accesses_in(self._records, begin, end, lands)
        if any(access.register.partition(".")[0] not in ("I2C-A", "GPIO") for access in accesses):
            raise self._refuse(f"the code behind {what} accesses more than I2C and GPIO")
        code = Code(accesses, self._timing, behind_wait, into_wait)
        wrong = code.differs(begin, end)
        if wrong:
            raise self._refuse(f"the code behind {what} {wrong}")
        return code

    def _places(self, code: Code, ways: str, register: str) -> list[int]:
        return [n for n, access in enumerate(code.accesses) if access.way in ways and access.register == register]

    def _writes(self, code: Code) -> CodeTable:
        found = self._places(code, "W", DXR)
        if len(found) != 1:
            raise self._refuse("I2CDXR is not written once between two waits of a read")
        return CodeTable(code, [("lands", found[0])])

    def _ready(self, code: Code) -> CodeTable:
        """Its marks: the module goes off, and IRS is set with the own address valid."""
        modes, address = self._places(code, "M", MDR), self._places(code, "W", OAR)
        if len(address) != 1 or not modes or modes[-1] < address[0] or code.accesses[modes[-1]].field != "IRS":
            raise self._refuse("the own address is not written once in IRS = 0 before each request")
        off = [place for place in modes if place < address[0] and code.accesses[place].field == "IRS"][-1:]
        if not off:
            raise self._refuse("IRS is not cleared before the own address is written")
        return CodeTable(code, [("lands", off[0]), ("lands", modes[-1])])


def _shape(code: ReadCode) -> list[int]:
    return [table.length for table in (code.pointer, code.clear, code.first, *code.more, code.after)]
