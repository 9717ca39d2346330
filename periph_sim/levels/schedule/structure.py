"""Which cases the level knows: a case goes in, its terms come out, or a sentence that says why it is another.

Known is the reference firmware imu_hil as it is published: models once behind each round, reads that wait for AAS,
RRDY, SDIR, XRDY or SCD, one service routine a host frame; a controller agent that asks each chip once a round.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from ...bus.i2c.transfer import BusTiming
from ...core.settings import Spread
from ...devices.host_pc import FRAME_BYTES
from ...explain.bound.closed_form import ClosedForm
from ...explain.bound.fifo_bound import VECTOR
from ...explain.bound.form_of_case import closed_form
from ...explain.bound.terms import BadBound, reasons
from ...f28335.i2c.options import I2cOptions
from ...f28335.sci.options import SciOptions
from ...f28335.system.options import SystemOptions
from ...scene.case.model import Case, Controller, HostTable, Unit
from ...scene.firmware_loader import BadFirmware, BadSetting, load_firmware, settings_for
from ...timing.rounds import Asked
from .errors import BadSchedule, refuse
from .receiver import Receiver, receiver
from .terms import Terms, measured

FIRMWARE = "imu_hil.py"
KNOWN_OPTIONS = {  # of which a term counts every answer
    I2cOptions: {"aas_sdir_point", "rrdy_point", "noise_filter_cycles", "sda_setup_before_scl_release"},
    SystemOptions: {"int_latency", "pf2_read_ws", "gpio_out_delay"},
    SciOptions: {"rx_int_extra", "rxrdy_point", "rx_sync_stages"},
}


@dataclass(frozen=True)
class Structure:
    """A case that the level knows. cost: of a run of the models. asked: what the controller asks in a round.

    edge_seconds, edge_events: of the edge runs that its terms were measured in.
    """

    case: Case
    unit: str
    controller: Controller
    host: HostTable
    terms: Terms
    receiver: Receiver
    cost: Spread
    sysclk: Fraction
    per_second: int
    closed: ClosedForm
    asked: Asked
    edge_seconds: Fraction
    edge_events: int


def structure_of(case: Case) -> Structure:
    """BadSchedule for a case of another structure."""
    case = case.model_copy(update={"fidelity": "edge"})  # of which its terms are
    for what in _others(case):
        raise refuse(case.name, what)
    assert case.controller is not None and case.host is not None
    ((only, table),) = case.unit.items()
    cost = _cost(case, only, table)
    try:
        closed = closed_form(_with_short_models(case))
    except BadBound as error:
        raise BadSchedule(f'{error}; so the level "schedule" has no terms for it, use fidelity = "edge"') from None
    calm, handlers = closed.calm, closed.handlers
    unit = case.unit[calm.unit]
    for what in _of_firmware(closed):
        raise refuse(case.name, what)
    found, scene = receiver(case, calm.unit)
    assert scene.head is not None and scene.bus.asked is not None
    timing: BusTiming = scene.head.controller.timing
    modules = dict.fromkeys(unit.modules, True)
    terms = measured(case, calm, handlers, timing, scene.head.schedule.gap, modules)
    nominal = Fraction(scene.units[calm.unit].control.sysclk_hz)
    seconds = calm.seconds + handlers.seconds + scene.case.duration
    events = calm.events + handlers.events + scene.kernel.events
    return Structure(
        case,
        calm.unit,
        case.controller,
        case.host,
        terms,
        found,
        cost,
        nominal,
        scene.timebase.per_second,
        closed,
        scene.bus.asked,
        seconds,
        events,
    )


def _with_short_models(case: Case) -> Case:
    """The case in which terms are measured: what the models cost is a term of its own, however long."""
    units = {}
    for name, unit in case.unit.items():
        settings = {key: value for key, value in unit.settings.items() if key != "beyond_estimate"}
        units[name] = unit.model_copy(update={"settings": settings | {"model_cost": "1 us"}})
    return case.model_copy(update={"unit": units})


def _others(case: Case) -> Iterator[str]:
    """What of the tables is another structure."""
    host, controller = case.host, case.controller
    if host is None or controller is None:
        yield "it has no [host] or no [controller]"
        return
    for name in ("chip", "device", "transceiver", "cable", "fault", "serial", "rounds"):
        if getattr(case, name, None):
            yield f"it has [{name}]"
    if case.start:
        yield "it does not begin at 0 (start)"
    for key in ("lose", "silent", "twice"):
        if getattr(host, key):
            yield f"host.{key} is given"
    if host.frames is not None:
        yield "host.frames is given"
    if controller.pointer_by != "repeated START" or controller.initialise is not None:
        yield "requests come by STOP, or chips are set up before the first round"
    if controller.rounds is not None:
        yield "controller.rounds is given"
    if controller.clear_after is not None:
        yield "controller.clear_after clears a bus that hangs"
    if len(case.unit) != 1:
        yield "it has more than one unit"
    for name, unit in case.unit.items():
        if not unit.firmware:
            yield f"unit.{name} runs {_program(unit)}, and terms are measured in Python firmware"
        for kind, known in KNOWN_OPTIONS.items():
            group = {"I2cOptions": "i2c", "SystemOptions": "system", "SciOptions": "sci"}[kind.__name__]
            plain = kind().unrecorded()
            for option, value in unit.options.get(group, {}).items():
                if option not in known and value != plain[option]:
                    yield f"unit.{name}.options.{group}.{option} is {value!r}"
        if unit.from_boot or not unit.skip_polls:
            yield f"unit.{name} has from_boot or skip_polls"


def _program(unit: Unit) -> str:
    """What a unit runs that is no Python."""
    if unit.image:
        return f"the image {Path(unit.image).name}"
    others = " and others" if len(unit.sources) > 1 else ""
    return f"C sources, {Path(unit.sources[0]).name}{others}"


def _of_firmware(closed: ClosedForm) -> Iterator[str]:
    """What of the firmware is another structure."""
    calm, handlers = closed.calm, closed.handlers
    if not handlers.per_frame or handlers.vectors != (VECTOR,):
        yield "its service routine is not that of the SCI's receive FIFO"
        return
    if handlers.per_frame != 1 or handlers.receiver is None or handlers.receiver.level != FRAME_BYTES:
        yield "a host frame sets off more than one service routine"
    unproven = reasons(handlers.terms)
    if unproven:
        yield unproven
    if calm.masked:
        yield f"{calm.masked} runs with interrupts masked"
    addresses = [phase.address for transfer in calm.transfers[: len(calm.transfers) // 2] for phase in transfer.phases]
    if len(set(addresses)) * 2 != len(addresses):
        yield "a chip is asked more than once a round"


def _cost(case: Case, name: str, unit: Unit) -> Spread:
    """What a run of the models costs, from the firmware's settings."""
    try:
        firmware = load_firmware(unit.firmware)
        settings: Any = settings_for(firmware, unit.settings)
    except (BadFirmware, BadSetting) as error:
        raise BadSchedule(f"case {case.name}, unit {name}: {error}") from None
    code = getattr(firmware.main, "__code__", None)
    if code is None or Path(code.co_filename).name != FIRMWARE:
        raise refuse(case.name, f"its firmware is {unit.firmware!r}, not imu_hil")
    if settings.models_run != "round":
        raise refuse(case.name, f"models_run is {settings.models_run!r}")
    if settings.table:
        raise refuse(case.name, "a chip shows a fixed table, which has no age")
    cost = settings.run_cost
    assert isinstance(cost, Spread)
    return cost
