"""The devices of a case on a scene's bus: targets connected to SCL and SDA, one for each `[device.NAME]` table.

DeviceTable --> family of `devices.targets` or of a plugin, or a Python file --> Target
SCL, SDA <--> TargetSide <--> DisturbedTarget (only if the table has stretches, or faults other than "off") <--> Target
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from random import Random
from typing import Literal

from ..bus.faults import HeldLine
from ..bus.i2c.disturbed_target import DisturbedTarget, Rule, When, cut_power, flip, replaced, stretch
from ..bus.i2c.target_side import TargetSide
from ..core.chip import Note
from ..core.records import Kind
from ..core.state import State
from ..core.wire import Wire
from ..devices.targets import BadDevice, Target, TargetContext, families
from . import plugins
from .case.device_tables import BusParty, DeviceTable, FaultTrigger
from .case.error_text import own_settings
from .case.model import Case
from .context import SceneContext

ACCESS = {"read": 1, "write": 0, "any": None}
OTHERS = ("controller", "host", "serial", "outside")  # names of other parties, which no chip or device may have


class NoteLog:
    """The notes of a chip or device. notes: a dictionary from a note to [its first tick, its count]."""

    STATE = State("notes")

    def __init__(self, context: SceneContext, name: str) -> None:
        self.notes: dict[Note, list[int]] = {}
        self.on_note: Callable[[Note], None] | None = None
        self._context = context
        self._name = name

    def take(self, note: Note) -> None:
        kernel, recorder = self._context.kernel, self._context.recorder
        first_and_count = self.notes.setdefault(note, [kernel.now, 0])
        first_and_count[1] += 1
        if recorder.wants(Kind.NOTE):
            text = f"{note.text} [{note.source}]"
            recorder.emit(kernel.now, Kind.NOTE, self._name, note.code, first_and_count[1], text)
        if self.on_note is not None:
            self.on_note(note)


class DeviceOnBus:
    """A device on the bus.

    target: the I2C target that the device's model built, without the stretches and faults in the device's table.
    """

    STATE = State("target log")

    def __init__(self, context: SceneContext, name: str, known: Mapping[str, Wire]) -> None:
        """Build the target that the table [device.NAME] describes, and connect it to the bus.

        known: a dictionary from names to wires of the scene.
        """
        table = context.case.device[name]
        self.log = NoteLog(context, name)
        self.side: TargetSide | None = None
        place = TargetContext(
            kernel=context.kernel,
            who=name,
            address=table.address,
            ticks=context.ticks,
            start=context.start,
            folder=context.case.folder,
            random=Random(f"{context.case.seed} {name}"),
            wire=lambda wire: _wire(known, wire),
            hold_clock=self._hold_clock,
            note=self.log.take,
        )
        self.target = _target(context, name, table, place)
        self.side = put_on_bus(context, name, table, self.target)

    def _hold_clock(self, ticks: int) -> None:
        if self.side is not None:
            self.side.hold_clock(ticks)


def put_on_bus(context: SceneContext, name: str, table: BusParty, target: Target) -> TargetSide:
    """Connect a target to SCL and SDA, with the stretches and faults in `table`.

    Return the object through which the target drives the wires.
    """
    scl, sda = context.wire("SCL"), context.wire("SDA")
    sides: list[TargetSide] = []

    def hold_clock(ticks: int) -> None:
        sides[0].hold_clock(ticks)

    def when(number: int, of: FaultTrigger) -> When:
        until = None if of.until is None else context.start + context.ticks(of.until)
        return When(
            Random(f"{context.case.seed} {name} {number}"),
            of.bytes,
            of.phases,
            ACCESS[of.access],
            of.share,
            context.start + context.ticks(of.after),
            until,
        )

    rules: list[Rule] = []
    if table.stretch is not None:
        length = table.stretch.length
        least, most = context.ticks(length.least), context.ticks(length.most)
        strikes = when(0, table.stretch)
        rules.append(Rule(strikes, strike=partial(stretch, strikes.random, least, most, hold_clock)))
    for number, fault in enumerate(table.fault, 1):
        strikes = when(number, fault)
        if fault.kind == "nack":
            rules.append(Rule(strikes, refuses=True))
        elif fault.kind == "wrong":
            assert fault.value is not None
            rules.append(Rule(strikes, replace=partial(replaced, fault.value)))
        elif fault.kind == "flip":
            rules.append(Rule(strikes, replace=partial(flip, strikes.random, fault.bit)))
        elif fault.kind == "hold":
            length_ticks = 0 if fault.length is None else context.ticks(fault.length)
            held = HeldLine(context.kernel, sda, scl, name, length_ticks, fault.clocks or 0)
            rules.append(Rule(strikes, strike=held.pull, held=held))
    disturbed = DisturbedTarget(context.kernel, target, rules) if rules else target
    side = TargetSide(
        context.kernel, scl, sda, disturbed.answer, context.ticks(table.output_delay), name, disturbed.on_end
    )
    sides.append(side)
    for fault in table.fault:
        if fault.kind == "off":
            until = None if fault.until is None else context.start + context.ticks(fault.until)
            cut_power(context.kernel, side, target, context.start + context.ticks(fault.after), until)
    return side


def check_name(case: Case, kind: Literal["chip", "device"], name: str) -> None:
    """Raise BadCase for a chip or device with the name of another party."""
    if name in case.unit or name in OTHERS or (kind == "device" and name in case.chip):
        what = f"{name!r} is another party on the wires already; give the {kind} another name"
        raise case.mistake(what, kind, name)


def take_addresses(
    case: Case, kind: Literal["chip", "device"], name: str, addresses: Iterable[int], taken: dict[int, str]
) -> None:
    """Add the addresses of a chip or device to `taken`. Raise BadCase if one of them is there already.

    taken: a dictionary from an address to the name of the party that has it.
    """
    for address in addresses:
        if address in taken:
            raise case.mistake(f"{taken[address]} has the address {address:#04x} too", kind, name, "address")
        taken[address] = name


def build_devices(context: SceneContext, known: Mapping[str, Wire], taken: dict[int, str]) -> dict[str, DeviceOnBus]:
    """Return the devices by name.

    known: a dictionary from names to wires of the scene.
    taken: see `take_addresses`.

    Raise BadCase for an invalid device, or for one whose name or address another party has. Raise FirmwareStalled as
    `device_of_file` does.
    """
    devices: dict[str, DeviceOnBus] = {}
    for name in context.case.device:
        check_name(context.case, "device", name)
        devices[name] = DeviceOnBus(context, name, known)
        take_addresses(context.case, "device", name, devices[name].target.addresses, taken)
    return devices


def _target(context: SceneContext, name: str, table: DeviceTable, place: TargetContext) -> Target:
    case, model = context.case, table.model
    if model.endswith(".py"):
        from .device_file import device_of_file

        return device_of_file(context, name, table, place)
    models = plugins.known(case.folder, "MODELS", families(), [model])
    if model not in models:
        from ..devices.chips import chip_models

        if model in plugins.known(case.folder, "CHIP", chip_models(), [model]):
            raise case.mistake(f"{model} is a sensor chip; give it a [chip.{name}] table", "device", name, "model")
        names = [*models, "a path that ends in .py"]
        raise case.unknown("device", model, names, "device", name, "model")
    family = models[model]
    settings = own_settings(case, family.Settings, table, f"a {model}", "device", name)
    try:
        return family.build(model, settings, place)
    except BadDevice as error:
        raise case.mistake(str(error), "device", name, *error.place) from None


def _wire(known: Mapping[str, Wire], name: str) -> Wire:
    if name not in known:
        raise ValueError(f"there is no wire {name!r}; name it in a unit's pins, as in pins = {{ {name} = 12 }}")
    return known[name]
