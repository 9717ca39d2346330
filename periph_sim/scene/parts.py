"""Parts of a scene, each imported when a case first names it, so that other parts cost no import.

from . import parts;  parts.build_head(...)  --> periph_sim.scene.controller is imported now
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names

if TYPE_CHECKING:
    from ..bus.i2c.byte_counter import I2cByteCounter
    from ..bus.i2c.event_recorder import BusRecorder
    from ..bus.i2c.stuck_watch import STUCK_AFTER, StuckWatch
    from ..f28335.i2c.options import I2cOptions
    from ..timing.measures.reply import Reply
    from .bit_skip import bit_skip_of
    from .case.measures import measures_of
    from .controller import build_head, head_plan, rounds_of, skips_bits
    from .deadlock import deadlock_reason
    from .derived_records import DerivedRecords
    from .devices import build_devices, put_on_bus
    from .faults import build_faults
    from .host import HostAgent, host_plan
    from .image_watching import variable_value
    from .limits import limits_of
    from .logged_outside import logged_outside
    from .outside_parties import as_driven, drives_bus
    from .outside_wires import check_outside, not_run
    from .release_delay import ReleaseDelay
    from .sensor_chips import build_chip
    from .serial.side import SerialSide
    from .state import restore_scene, state_of_scene
    from .unit import build_unit, unit_plan
    from .watch import watcher_of

_HOMES = {
    "bus.i2c.byte_counter": ("I2cByteCounter",),
    "bus.i2c.event_recorder": ("BusRecorder",),
    "bus.i2c.stuck_watch": ("STUCK_AFTER", "StuckWatch"),
    "f28335.i2c.options": ("I2cOptions",),
    "timing.measures.reply": ("Reply",),
    "scene.case.measures": ("measures_of",),
    "scene.bit_skip": ("bit_skip_of",),
    "scene.controller": ("build_head", "head_plan", "rounds_of", "skips_bits"),
    "scene.deadlock": ("deadlock_reason",),
    "scene.derived_records": ("DerivedRecords",),
    "scene.devices": ("build_devices", "put_on_bus"),
    "scene.faults": ("build_faults",),
    "scene.host": ("HostAgent", "host_plan"),
    "scene.image_watching": ("variable_value",),
    "scene.limits": ("limits_of",),
    "scene.logged_outside": ("logged_outside",),
    "scene.outside_parties": ("as_driven", "drives_bus"),
    "scene.outside_wires": ("check_outside", "not_run"),
    "scene.release_delay": ("ReleaseDelay",),
    "scene.sensor_chips": ("build_chip",),
    "scene.serial.side": ("SerialSide",),
    "scene.unit": ("build_unit", "unit_plan"),
    "scene.state": ("restore_scene", "state_of_scene"),
    "scene.watch": ("watcher_of",),
}
__all__ = [
    "STUCK_AFTER",
    "BusRecorder",
    "DerivedRecords",
    "HostAgent",
    "I2cByteCounter",
    "I2cOptions",
    "ReleaseDelay",
    "Reply",
    "SerialSide",
    "StuckWatch",
    "as_driven",
    "bit_skip_of",
    "build_chip",
    "build_devices",
    "build_faults",
    "build_head",
    "build_unit",
    "check_outside",
    "deadlock_reason",
    "drives_bus",
    "head_plan",
    "host_plan",
    "limits_of",
    "logged_outside",
    "measures_of",
    "not_run",
    "put_on_bus",
    "restore_scene",
    "rounds_of",
    "skips_bits",
    "state_of_scene",
    "unit_plan",
    "variable_value",
    "watcher_of",
]
__getattr__ = lazy_names("periph_sim", _HOMES)
