"""Names of earlier versions: removed names with messages that say what to use, and moved names with the new names."""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from importlib.abc import Loader

COMMANDS = {
    "bound": (
        "`periph-sim bound` was removed: its formula missed dependences that are not visible in the firmware's source; "
        "`periph-sim prove` runs the phases instead, and finds the windows in which budgets break"
    ),
}
LEVELS = {
    "schedule": (
        "level 'schedule' was removed: its arithmetic knew one firmware only; `periph-sim prove` runs the phases of "
        "any case, and `periph-sim sweep` many scenarios one by one"
    ),
}
NAMES = {
    name: (
        f"periph_sim.{name} was removed: its arithmetic knew one firmware only; `periph-sim prove` runs the phases of "
        "any case, periph_sim.sweep many scenarios one by one, and periph_sim.scenarios those of an image with a table"
    )
    for name in ("schedule", "BadSchedule", "ScheduleResult")
}

MOVED = {  # maps former names of modules and packages to present names; the next release removes the former names
    "periph_sim.core.settings": "periph_sim.core.table",
    "periph_sim.devices.attitude": "periph_sim.imu.attitude",
    "periph_sim.devices.samples": "periph_sim.imu.samples",
    "periph_sim.dissertation": "periph_sim.imu",
    "periph_sim.scene.case.sensor_sets": "periph_sim.imu.parameter_sets",
    "periph_sim.scene.case.sensor_sets_text": "periph_sim.imu.parameter_sets",
    "periph_sim.sensors.shared_models": "periph_sim.imu.model_codes",
    "periph_sim.sensors": "periph_sim.imu",
}


def moved_module(name: str) -> ModuleSpec | None:
    """Return the spec of a module that is imported by its former name; None if `name` is not a former name."""
    former = next((old for old in MOVED if name == old or name.startswith(f"{old}.")), None)
    return None if former is None else ModuleSpec(name, cast("Loader", _MovedModule(former)))


class _MovedModule:
    """Loader of a module that is imported by its former name.

    former: the key of MOVED that is the former name of the module, or of a package that contains the module.

    The class is not derived from `importlib.abc.Loader`, because the import of that class takes 10 ms.
    """

    def __init__(self, former: str) -> None:
        self._former = former

    def create_module(self, spec: ModuleSpec) -> None:
        """Let the import system create an empty module."""

    def exec_module(self, module: ModuleType) -> None:
        """Import the module by its present name, with a warning that has both names."""
        name, former = module.__name__, self._former
        what = f"{former} is now {MOVED[former]}, and its former name will be removed in the next release"
        warnings.warn(what, FutureWarning, stacklevel=2)
        found = import_module(MOVED[former] + name.removeprefix(former))
        if not hasattr(found, "__path__"):
            sys.modules[name] = found
            return
        vars(module).update((key, value) for key, value in vars(found).items() if not key.startswith("__"))
        module.__path__ = []  # no folders, so that only the finder of this package finds the submodules
