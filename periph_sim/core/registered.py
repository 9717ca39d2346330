"""Modules outside the core that define what the core uses by name, as entry points of this package would.

The core imports none of them: each is imported when a case first needs what it defines.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

HOMES = {
    "firmware model": "periph_sim.imu.firmware_model",  # see `scene.unit.FirmwareModel`
    "host frames": "periph_sim.imu.host_frames",  # see `devices.host_frames`
    "plugins": "periph_sim.scene.plugins",  # known_formats: the capture formats of plugins
    "sensors": "periph_sim.imu.sensors",  # SENSORS: the sensors that `order` may name, by name
}


def registered(what: str) -> ModuleType:
    """Import and return the module that is registered for one of `HOMES`."""
    return import_module(HOMES[what])
