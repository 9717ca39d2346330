"""Models of the TMS320F28335's SCI, I2C and SPI that run its firmware and check the timing on its buses.

`__all__` is the public interface (docs/python_api.md). Firmware imports its names from `periph_sim.firmware`. Each name
is imported when it is first used: `import periph_sim` itself only decides whether the compiled core is used, and makes
modules importable by their former names.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING

from .form import choose

__version__ = "0.1.0"  # the wheel's metadata and `periph-sim --version` read the version from this line

if TYPE_CHECKING:
    from importlib.machinery import ModuleSpec

    from .api import make_case, run, scenarios
    from .core.kernel import SimulationStuck
    from .interfaces.reports.baselines.check import CaseCheck, check
    from .interfaces.reports.baselines.files import BadCheck
    from .interfaces.reports.sweep.sweep import Sweep, sweep
    from .processor.dsp import Dsp
    from .processor.user_code import FirmwareError
    from .records.cause_trace.why import why
    from .records.lint import lint
    from .records.recording import BadRecording
    from .records.run import NotInRun, Run
    from .scene.case.json_schema import case_schema
    from .scene.case.load import load
    from .scene.case.model import BadCase, Case
    from .scene.firmware_loader import Firmware
    from .scene.prepared import PreparedScene
    from .scene.result import Result
    from .scene.scene import Scene
    from .timing.verdict import Verdict
    from .traces.capture.capture import BadCapture, Capture
    from .traces.formats import read as read_capture
    from .traces.formats import write as write_capture

__all__ = [
    "BadCapture",
    "BadCase",
    "BadCheck",
    "BadRecording",
    "Capture",
    "Case",
    "CaseCheck",
    "Dsp",
    "Firmware",
    "FirmwareError",
    "NotInRun",
    "PreparedScene",
    "Result",
    "Run",
    "Scene",
    "SimulationStuck",
    "Sweep",
    "Verdict",
    "case_schema",
    "check",
    "lint",
    "load",
    "make_case",
    "read_capture",
    "run",
    "scenarios",
    "sweep",
    "why",
    "write_capture",
]

_HOMES = {
    "api": ("make_case", "run", "scenarios"),
    "core.kernel": ("SimulationStuck",),
    "processor.dsp": ("Dsp",),
    "processor.user_code": ("FirmwareError",),
    "records.cause_trace.why": ("why",),
    "records.lint": ("lint",),
    "records.recording": ("BadRecording",),
    "records.run": ("NotInRun", "Run"),
    "interfaces.reports.baselines.check": ("CaseCheck", "check"),
    "interfaces.reports.baselines.files": ("BadCheck",),
    "interfaces.reports.sweep.sweep": ("Sweep", "sweep"),
    "scene.case.json_schema": ("case_schema",),
    "scene.case.load": ("load",),
    "scene.case.model": ("BadCase", "Case"),
    "scene.firmware_loader": ("Firmware",),
    "scene.prepared": ("PreparedScene",),
    "scene.result": ("Result",),
    "scene.scene": ("Scene",),
    "timing.verdict": ("Verdict",),
    "traces.capture.capture": ("BadCapture", "Capture"),
}
_OTHER_NAMES = {"read_capture": ("traces.formats", "read"), "write_capture": ("traces.formats", "write")}
_FORMER_PACKAGES = ("dissertation", "sensors")
_PLACES = {name: (home, name) for home, names in _HOMES.items() for name in names} | _OTHER_NAMES


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        from .removed import NAMES

        if name in NAMES:  # `from periph_sim import NAME` would hide the message of an AttributeError
            raise ImportError(NAMES[name], name=__name__)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home, inside = _PLACES[name]
    found = getattr(import_module(f".{home}", __name__), inside)
    globals()[name] = found
    return found


class _MovedModules:
    """Import finder for modules under the names of earlier versions.

    names: the finder looks up only modules whose names begin with one of these texts.
    """

    def __init__(self, *names: str) -> None:
        self._names = names

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if not name.startswith(self._names):
            return None
        from .removed import moved_module

        return moved_module(name)


choose()
# After an update, folders of former packages may still exist. This finder comes first in `sys.meta_path`, so that
# Python does not import modules from these folders.
sys.meta_path.insert(0, _MovedModules(*(f"{__name__}.{package}" for package in _FORMER_PACKAGES)))
sys.meta_path.append(_MovedModules(f"{__name__}."))


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
