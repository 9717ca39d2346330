"""Imports on demand: a module is imported when one of its names is first needed.

The modules in `HOMES` are like entry points of this package: the rest of the program finds them only by name and does
not import them directly. With `lazy_names`, importing one name of a package does not load the package's other modules.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType

HOMES = {
    "firmware model": "periph_sim.imu.firmware_model",  # implements `scene.unit.FirmwareModel`
    "host frames": "periph_sim.imu.host_frames",  # implements `devices.host_frames.HostFrames`
    "plugins": "periph_sim.scene.plugins",  # defines the function `known_formats`, which finds plugins' capture formats
    "sensors": "periph_sim.imu.sensors",  # defines `SENSORS`: the sensors, by their names in the key `order`
}


def registered(what: str) -> ModuleType:
    """Import and return the module of an entry in `HOMES`."""
    return import_module(HOMES[what])


def lazy_names(package: str, homes: Mapping[str, tuple[str, ...]]) -> Callable[[str], object]:
    """Return the function `__getattr__` of a package, which imports a module when one of its names is first used.

    homes: for each module, the names that it defines.
    """
    places = {name: module for module, names in homes.items() for name in names}

    imported: dict[str, ModuleType] = {}  # maps a name that the package offers to the imported module that defines it

    def found(name: str) -> object:
        module = imported.get(name)
        if module is None:
            if name not in places:
                raise AttributeError(f"module {package!r} has no attribute {name!r}")
            module = imported[name] = import_module(f"{package}.{places[name]}")
        return getattr(module, name)

    return found
