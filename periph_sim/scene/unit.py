"""A unit of a case: the F28335 that a [unit.NAME] table describes, with its started firmware.

Case --unit_plan--> DspPlan, shared by all scenes of the case --build_unit--> Dsp with its firmware, for one scene
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from msgspec.structs import asdict, replace

from ..core.options import Answers
from ..core.phrases import did_you_mean
from ..core.registered import registered
from ..core.table import separate
from ..core.wire import MAX_PARTIES
from ..f28335.cpu.code_costs import CodeCosts
from ..f28335.descriptor import named_class
from ..f28335.parts import part_named, part_names
from ..f28335.system_options import SystemOptions
from ..processor.dsp import Dsp, DspPlan
from ..processor.user_code import Misuse, UserCode
from .case.error_text import checked_options
from .case.model import Case
from .case.optimizations import DECODING, POLLS
from .case.unit_table import Unit
from .case.wiring import pulled_down
from .context import CaseTicks, SceneContext
from .firmware_loader import BadFirmware, BadSetting, Firmware, load_firmware, run_main, settings_for

if TYPE_CHECKING:
    from ..devices.chip_model import ChipModel
    from ..devices.truth import Truth


class FirmwareModel(Protocol):
    """Interface of the model with which firmware computes the data of the sensor chips that it emulates."""

    def check(self, case: Case, unit: str) -> None:
        """Raise BadCase if the case does not meet the requirements of the model."""

    def codes(self) -> ChipModel | None:
        """Return a model that computes the bytes that the unit should send to the controller.

        Return None if the firmware's settings do not determine these bytes.
        """

    def truth(self, motion: Any, first: Fraction) -> Truth:
        """Return the values that ideal chips would measure during the motion that the host's frames describe.

        first: the time in the motion that frame 0 describes, in seconds.
        """

    def attitude(self, readings: Mapping[str, Sequence[float]]) -> list[float] | None:
        """Return roll, pitch and yaw in degrees; None if the readings do not suffice to compute them.

        readings: a dictionary from a chip to its last values.
        """


def unit_plan(ticks: CaseTicks, name: str) -> DspPlan:
    """Return the plan of a unit of a case, without its wires.

    Raise BadCase for an unknown part, module or option, or for an option with a wrong answer.
    """
    case = ticks.case
    unit = case.unit[name]
    part = part_named(unit.part)
    if part is None:
        raise case.unknown("part", unit.part, part_names(), "unit", name, "part")
    for module in unit.modules:
        if module not in part.selectable:
            raise case.unknown("module", module, part.selectable, "unit", name, "modules")
    known = part.options_groups
    for group in unit.options:
        if group not in known:
            hint = did_you_mean(group, known)
            raise case.mistake(f"there are no options of {group!r}; {hint}", "unit", name, "options", group)
    needed = {part.by_name[module].options for module in unit.modules}.union(unit.options) - {"system"}
    options: dict[str, Answers] = {
        group: checked_options(
            case, named_class(known[group]), unit.options.get(group, {}), "unit", name, "options", group
        )
        for group in known
        if group in needed
    }
    return DspPlan(
        name,
        unit.modules,
        {},
        oscclk_hz=int(unit.oscclk),
        pll=unit.pll,
        ppm=unit.ppm,
        from_boot=unit.from_boot or bool(unit.image or unit.sources),
        skip_polls=unit.skip_polls and ticks.optimizes(POLLS),
        keeps_decoded=ticks.optimizes(DECODING),
        strict=case.strict,
        seed=case.seed,
        costs=() if case.inputs is None else case.inputs.costs.get(name, ()),
        stall_limit=float(case.stall_limit),
        pulled_down=pulled_down(case, name),
        part=part,
        code=CodeCosts(**asdict(unit.code)),
        system=checked_options(case, SystemOptions, unit.options.get("system", {}), "unit", name, "options", "system"),
        options=options,
    )


def build_unit(
    context: SceneContext, name: str, plan: DspPlan, program: Firmware | None
) -> tuple[Dsp, Firmware, FirmwareModel | None]:
    """Return a unit, its started program, and the firmware's model of sensor chips (None if the firmware has none).

    program: the firmware to use in place of the case's Python firmware; None for the case's firmware. It is ignored for
        a unit with an image or C sources.

    Raise BadCase if the program cannot be loaded, or if the unit's table has another mistake, such as wrong settings.
    """
    case, unit = context.case, context.case.unit[name]
    wires = {pin: context.wire(wire) for pin, wire in context.wiring.pins[name].items()}
    if len(wires) > MAX_PARTIES:
        what = f"the pins of the unit would have {len(wires)} wires; at most {MAX_PARTIES} are possible, so name fewer"
        raise case.mistake(what, "unit", name, "pins")
    dsp = Dsp(context.kernel, context.timebase, context.recorder, replace(plan, wires=wires))
    if unit.image:
        return dsp, _started_image(context, name, unit, dsp), None
    if unit.sources:
        return dsp, _started_sources(case, name, unit, dsp), None
    guard = UserCode(f"firmware {unit.firmware}", float(case.stall_limit))
    try:
        firmware = program or guard(load_firmware, unit.firmware)
    except BadFirmware as error:
        raise case.mistake(str(error), "unit", name, "firmware") from None
    try:
        settings = guard(settings_for, firmware, separate(unit.settings))
    except BadSetting as error:
        inside = (error.name,) if error.name else ()  # no name if several settings do not fit together
        raise case.mistake(str(error), "unit", name, "settings", *inside) from None
    model: FirmwareModel | None = None
    if guard(getattr, settings, "sensors", None) is not None:
        model = guard(registered("firmware model").firmware_model, settings)
    if model is not None:
        model.check(case, name)
    dsp.start(partial(run_main, firmware, dsp, settings))
    return dsp, firmware, model


def _started_image(context: SceneContext, name: str, unit: Unit, dsp: Dsp) -> Firmware:
    """Make the unit run its image. Return a Firmware object with the name of the image, for lists of firmware."""
    from ..processor.image.boot import BadStub, Stub, stubbed
    from ..processor.image_files.model import BadImage
    from ..processor.image_files.program_file import program_in
    from .image_watching import watch_image

    stubs = []
    for place, table in enumerate(unit.stub):
        try:
            address = stubbed(table.register_, dsp.memory)
        except BadStub as error:
            raise context.case.mistake(str(error), "unit", name, "stub", place, "register") from None
        tick = context.kernel.now + context.timebase.ticks(table.after, "nearest")
        stubs.append(Stub(tick, address, table.value))
    try:
        program = dsp.start_image(program_in(Path(unit.image)), unit.boot, stubs)
    except BadImage as error:
        raise context.case.mistake(str(error), "unit", name, "image") from None
    watch_image(context.case, name, unit, dsp, program, context.recorder)
    return Firmware(unit.image, _no_python, None)


def _started_sources(case: Case, name: str, unit: Unit, dsp: Dsp) -> Firmware:
    """Make the unit run its C sources, beginning with main.

    Return a Firmware object with the names of the sources, for lists of firmware.
    """
    from ..processor.host_code.firmware import HostFirmware
    from ..processor.host_code.library import BadSources, Sources

    given = unit.compile
    files, folders = (tuple(map(Path, paths)) for paths in (unit.sources, given.include))
    defines = tuple((macro, str(value)) for macro, value in given.defines.items())
    try:
        firmware = HostFirmware(dsp, Sources(files, folders, defines, given.undefined))
    except BadSources as error:
        raise case.mistake(str(error), "unit", name, "sources") from None
    dsp.sources = firmware
    dsp.start(firmware.main)
    return Firmware(", ".join(unit.sources), _no_python, None)


def _no_python(dsp: Dsp, settings: object) -> None:
    """Raise Misuse: an image or C sources have no main that Python could call."""
    raise Misuse(f"{dsp.name} runs an image or C sources, which have no main that Python could call")
