"""The I2C controller of a case: the sensor head on SCL and SDA that [controller] describes, and its requests.

    Case --head_plan--> HeadPlan, shared by all scenes of the case --build_head--> SensorHead of one scene

The head counts its times by its own clock, which has an error of `ppm` parts per million. The low and high times of SCL
are rounded to the nearest tick. The period of the rounds is not rounded, so rounds do not drift from this clock.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from ..bus.i2c.controller import I2cController
from ..bus.i2c.transfer import BusTiming, Transfer
from ..core.phrases import counted
from ..devices.sensor_head import SensorHead
from ..devices.sensor_rounds import ChipData, Request, Schedule
from ..timing.rounds import MasterSchedule
from .case.model import Case
from .case.optimizations import BITS
from .case.party_tables import Controller, RequestTable, RoundsTable
from .context import CaseTicks, SceneContext
from .plugins import sensors_of

if TYPE_CHECKING:
    from ..bus.i2c.bit_skip import BitParty, BitSkip
    from ..core.agent import Agent
    from ..core.wire import Wire
    from ..processor.dsp import Dsp


class HeadPlan(Struct, frozen=True):
    """Requests of a [controller] and their schedule.

    requests: the requests of each round.
    startup: the requests before the first round, which set up the chips.
    timing: the low, high, set-up, hold and bus-free times of SCL and SDA, and the filter time of SDA, in ticks.
    schedule: the times at which the sensor head, the agent that [controller] describes, begins rounds.
    asked: the transfers on the bus that result from `requests` and `startup`, and their schedule.
    stuck_after, clear_after: durations in ticks; `I2cController` describes them.
    """

    requests: tuple[Request, ...]
    startup: tuple[Request, ...]
    timing: BusTiming
    schedule: Schedule
    asked: MasterSchedule
    stuck_after: int
    clear_after: int


def skips_bits(context: SceneContext) -> bool:
    """Return True if the first seven bits of each I2C byte may be simulated in one step.

    This is an optimization. The case must not disable it, and the edges of SCL and SDA must not be recorded.
    """
    return context.optimizes(BITS) and not (context.wire("SCL").recorded or context.wire("SDA").recorded)


def head_plan(scale: CaseTicks) -> HeadPlan:
    """Return the plan of a case's [controller]. Raise BadCase for invalid requests or times."""
    table = scale.case.controller
    assert table is not None
    requests = _requests(scale.case, table, "controller")
    startup: list[Request] = []
    if table.initialise is not None:
        addresses = {request.address for request in requests}
        known = _sensors(scale.case, table).values()
        startup = [request for sensor in known if sensor.address in addresses for request in sensor.startup]
        if not startup:
            what = "no known chip is asked, so there is none to set up"
            raise scale.case.mistake(what, "controller", "initialise")
    by_stop = table.pointer_by == "STOP"

    def ticks(length: Fraction) -> int:
        return scale.ticks(length, table.ppm)

    timing, gap, clear_after = counted_lengths(scale, table)
    stuck_after = scale.ticks(table.stuck_after)
    schedule = Schedule(
        first=ticks(table.first),
        period=scale.exact_ticks(table.period, table.ppm),
        gap=gap,
        jitter=ticks(table.jitter),
        rounds=table.rounds,
        ahead=ticks(table.initialise or Fraction(0)),
        starts=scale.starts("rounds"),
    )
    set_up_at = scale.start + schedule.first - schedule.ahead
    if startup and schedule.starts and schedule.starts[0] < set_up_at:
        way = "start it later, or make controller.first earlier or controller.initialise longer"
        raise scale.case.mistake(f"the round starts before the chips are set up; {way}", "inputs", "rounds", 0)
    asked = MasterSchedule(
        requests=_transfers(requests, by_stop),
        period=schedule.period,
        startup=_transfers(startup, by_stop),
        first=scale.start + schedule.first,
        late=schedule.jitter if schedule.starts is None else 0,
        rounds=schedule.rounds,
        starts=schedule.starts,
    )
    return HeadPlan(tuple(requests), tuple(startup), timing, schedule, asked, stuck_after, clear_after)


def counted_lengths(scale: CaseTicks, table: Controller) -> tuple[BusTiming, int, int]:
    """Return the lengths that a controller counts with its clock, in ticks: the timing, the gap and `clear_after`."""

    def ticks(length: Fraction) -> int:
        return scale.ticks(length, table.ppm)

    half = Fraction(1, 2) / table.rate
    low = ticks(half if table.low is None else table.low)
    high = ticks(half if table.high is None else table.high)
    timing = BusTiming(low, high, ticks(table.hold), high, low, high, low, ticks(table.filter))
    return timing, ticks(table.gap), ticks(table.clear_after or Fraction(0))


def build_head(
    context: SceneContext, table: Controller, plan: HeadPlan, on_stuck: Callable[[Wire], None]
) -> SensorHead:
    """Return the sensor head that `plan` describes, with its I2C controller connected to the wires of a scene."""
    kind = I2cController
    if skips_bits(context):
        from ..bus.i2c.skipping_controller import SkippingController

        kind = SkippingController
    controller = kind(
        context.kernel,
        context.recorder,
        context.wire("SCL"),
        context.wire("SDA"),
        plan.timing,
        who="controller",
        stuck_after=plan.stuck_after,
        on_stuck=on_stuck,
        clear_after=plan.clear_after,
        gives_up=table.on_nack == "give up",
    )
    return SensorHead(
        context.kernel,
        controller,
        list(plan.requests),
        plan.schedule,
        startup=list(plan.startup),
        by_stop=table.pointer_by == "STOP",
        seed=context.case.seed,
    )


def rounds_of(context: SceneContext, table: RoundsTable) -> MasterSchedule:
    """Return the requests in [rounds], which a unit or an outside party makes, and their schedule.

    Raise BadCase for an invalid request, if [rounds] has no request, or if its period has too many ticks.
    """
    requests = _requests(context.case, table, "rounds")
    transfers = _transfers(requests, table.pointer_by == "STOP")
    period = context.exact_ticks(table.period, Fraction(0))
    return MasterSchedule(transfers, period, rounds=table.rounds, ack_polling=table.ack_polling)


def _requests(case: Case, table: Controller | RoundsTable, name: str) -> list[Request]:
    known = _sensors(case, table)
    requests = [_chip(case, known, chip, name, "order") for chip in table.order]
    requests += [_request(case, known, request, name, "request", i) for i, request in enumerate(table.request)]
    if not requests:
        raise case.mistake(f"it has no requests; give it order or [[{name}.request]]", name)
    return requests


def _transfers(requests: list[Request], by_stop: bool) -> tuple[Transfer, ...]:
    return tuple(transfer for request in requests for transfer in request.transfers(by_stop))


def _sensors(case: Case, table: Controller | RoundsTable) -> Mapping[str, ChipData]:
    """Return the sensors that requests can name, by name.

    Plugins that are installed as packages are searched only if the table names a sensor that is otherwise unknown.
    """
    names = [*table.order, *(request.chip for request in table.request if request.chip is not None)]
    return sensors_of(case, names)


def _chip(case: Case, known: Mapping[str, ChipData], name: str, *place: str | int) -> Request:
    if name not in known:
        raise case.unknown("chip", name, known, *place)
    sensor = known[name]
    return Request(name, sensor.address, sensor.pointer, sensor.count)


def _request(case: Case, known: Mapping[str, ChipData], table: RequestTable, *place: str | int) -> Request:
    if table.chip is not None:
        request = _chip(case, known, table.chip, *place, "chip")
        if table.expect is not None and len(table.expect) != request.count:
            what = f"expect has {counted(len(table.expect), 'byte')}, but count is {request.count}"
            raise case.mistake(what, *place)
        return replace(request, name=table.name or request.name, expect=table.expect)
    assert table.address is not None
    name = table.name or f"{table.address:#04x}"
    return Request(name, table.address, table.pointer, table.count, table.write, table.expect)


MODULE = "I2C-A"


def bit_skip_of(context: SceneContext, controller: I2cController | None, units: Mapping[str, Dsp]) -> BitSkip:
    """Return the object that simulates the first seven bits of a byte on SCL and SDA in one step.

    controller: the agent that drives SCL as the master; None if the case has no [controller].
    """
    from ..bus.i2c.bit_skip import BitSkip
    from ..bus.i2c.skipping_controller import SkippingController

    modules: dict[Agent, BitParty] = {}
    bit_skip = BitSkip(context.kernel, context.wire("SCL"), context.wire("SDA"), controller, modules)
    for dsp in units.values():
        if MODULE in dsp.sockets:
            from ..processor.i2c_bit_skip import party_of  # imported here, because only some scenes have an I2C module

            socket = dsp.sockets[MODULE]
            modules[socket] = party_of(socket, dsp.clock, bit_skip, clocks=controller is None)
    if controller is not None:
        assert isinstance(controller, SkippingController)
        controller.bit_skip = bit_skip
    return bit_skip
