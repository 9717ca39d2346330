"""A user's own device: the class `Device` of a Python file becomes a target on the bus.

The file is imported like a firmware file: in a package of its own, with the files of the same folder that it imports.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from ..devices.python_device import HOOKS, NEEDED, DeviceBus, PythonTarget
from ..devices.targets import TargetContext
from ..processor.user_code import PASSES, FirmwareStalled, UserCode, defined_at, flaw_of
from .case.device_tables import DeviceTable
from .case.model import BadCase
from .context import SceneContext
from .firmware_loader import BadSetting, existing, filled, imported, module_of_file

CLASS = "Device"


def device_of_file(context: SceneContext, name: str, table: DeviceTable, place: TargetContext) -> PythonTarget:
    """Return the I2C target that the class `Device` of a Python file defines, at the address in `table`.

    place: the object through which the device accesses the scene.

    Raise BadCase if the table has no address, if the file cannot be loaded, or if its class or its settings are wrong.
    Raise FirmwareStalled if the code in the file takes more CPU time than `stall_limit` of the case.
    """

    def mistake(what: str, *key: str | int) -> Exception:
        return context.case.mistake(what, "device", name, *(key or ("model",)))

    path = context.case.folder / table.model
    if table.address is None:
        raise mistake("a device of a file has no address of its own; give it address = 0x42, for instance", "address")
    guard = UserCode(f"device {name}", float(context.case.stall_limit))

    def load() -> ModuleType:
        return guard.in_time(module_of_file, existing(path, "file", mistake))

    module = imported(path.name, load, path.parent, mistake, (*PASSES, FirmwareStalled, BadCase))
    made: Any = getattr(module, CLASS, None)
    if not isinstance(made, type):
        raise mistake(f"{path.name} has no class {CLASS}")
    _check_hooks(path, made, mistake)
    bus = DeviceBus(place, context.timebase.per_second, guard)
    settings = getattr(module, "Settings", None)
    arguments: tuple[object, ...] = (bus,)
    if settings is not None:
        try:
            arguments = (bus, guard(filled, settings, table.own, f"device {table.model}"))
        except BadSetting as error:
            raise mistake(str(error), *filter(None, [error.name])) from None
    elif table.own:
        key = next(iter(table.own))
        raise mistake(f"{path.name} takes no settings; give it a dataclass Settings, or leave {key} out", key)
    wrong = flaw_of(made, len(arguments))
    if wrong:
        expected = "__init__(self, bus, settings)" if settings is not None else "__init__(self, bus)"
        raise mistake(f"{defined_at(vars(made).get('__init__')) or path.name}: {CLASS} {wrong}; expected {expected}")
    return PythonTarget(guard, table.address, lambda: made(*arguments))


def _check_hooks(path: Path, made: type[object], mistake: Callable[..., Exception]) -> None:
    hooks = {hook: getattr(made, hook) for hook in HOOKS if hasattr(made, hook)}
    if not set(NEEDED) & set(hooks):
        raise mistake(f"{path.name}: class {CLASS} has neither {' nor '.join(NEEDED)}; give it one of them at least")
    for hook, function in hooks.items():
        wrong = flaw_of(function, HOOKS[hook] + 1)
        if wrong:
            takes = ", ".join(["self", *["read" if hook == "on_address" else "byte"] * HOOKS[hook]])
            raise mistake(f"{defined_at(function) or path.name}: {hook} {wrong}; expected {hook}({takes})")
