"""Features that a scene can lack, and a count of the objects of a scene.

    python -m tests.scene.absent SCENE  -->  JSON: modules imported, events, instances, before and after other scenes

A process of its own builds and runs one scene of BARE, then a scene of each row of ROWS, then the first scene again.
The test and the benchmark take the packages of each feature from here.
"""

from __future__ import annotations

import gc
import json
import os
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FrameType, FunctionType, ModuleType
from typing import Any

OURS = "periph_sim."
SECONDS = Fraction(1, 100)

SLAVE = {"firmware": "responder", "modules": ["I2C-A"]}
LOGGER = {"firmware": "uart_logger", "modules": ["SCI-A"]}
HEAD = {"period": "5 ms", "request": [{"name": "read", "address": 0x50, "count": 2, "expect": "01 02"}]}
REGISTERS = {"model": "registers", "address": 0x51, "register": [{"name": "DATA", "at": 0, "reset": 0x5A}]}
BUDGET = {"name": "bytes", "measure": "wrong bytes", "max": 0}
HOST = {"baud": 115200, "period": "20 ms"}
IMU = {"firmware": "imu_hil", "modules": ["I2C-A", "SCI-A", "GPIO"], "settings": {"arithmetic": "float64"}}

# Scenes that lack most features, as tables of a case: a slave with a controller, an SCI alone, a bus of agents.
BARE: dict[str, dict[str, Any]] = {
    "slave": {"unit": {"dsp": SLAVE}, "controller": HEAD, "budget": [BUDGET]},
    "sci": {"unit": {"dsp": LOGGER}},
    "bus": {"device": {"d": REGISTERS}, "controller": HEAD},
}


@dataclass(frozen=True)
class Row:
    """A feature that a scene can lack.

    packages: modules that nothing else needs, and packages ("f28335.i2c.") with all their modules but tables of names.
    named: tables of a case that has the feature.
    present: the scenes of BARE that have it.
    record: the file that the run is recorded to, if any.
    """

    packages: tuple[str, ...]
    named: Mapping[str, Any] = field(default_factory=dict)
    present: tuple[str, ...] = ()
    record: str = ""


def of_slave(**more: Any) -> dict[str, Any]:
    return {**BARE["slave"], **more}


def with_modules(*names: str) -> dict[str, Any]:
    return of_slave(unit={"dsp": {**SLAVE, "modules": ["I2C-A", *names]}})


def with_budget(measure: str, **limits: Any) -> dict[str, Any]:
    return of_slave(budget=[{"name": "one", "measure": measure, **limits}])


SPIKE = {"kind": "spike", "wire": "SCL", "at": "1 ms", "every": "1 ms", "width": "40 ns"}
DE = {"on": "dsp.SCI-A", "de": "dsp.GPIO34"}
CHIP = {"gyroscope": {"model": "itg3200", "values": {"fixed": [1, 2, 3]}}}

ROWS: dict[str, Row] = {
    "an F28335": Row(
        (
            *("processor.dsp", "processor.processor", "processor.bus", "processor.interrupts", "processor.python."),
            *(
                "f28335.pie.module",
                "f28335.cpu.interrupts",
                "f28335.system_control.module",
                "f28335.memory.ram",
                "scene.unit",
            ),
        ),
        present=("slave", "sci"),
    ),
    "I2C-A": Row(("f28335.i2c.",), present=("slave",)),
    "SCI": Row(("f28335.sci.", "scene.uart_lines"), present=("sci",)),
    "GPIO": Row(("f28335.gpio.", "processor.pin_router"), with_modules("GPIO")),
    "XINT": Row(("f28335.xint.",), with_modules("XINT")),
    "CPU timers": Row(("f28335.cpu_timer.",), with_modules("TIMER0")),
    "controller": Row(
        ("bus.i2c.controller", "bus.i2c.bus_clear", "devices.sensor_head", "scene.controller"),
        present=("slave", "bus"),
    ),
    "host": Row(("devices.host_pc", "bus.uart.sender", "scene.host"), {"unit": {"dsp": LOGGER}, "host": HOST}),
    "motion of a host": Row(
        ("imu.motion.", "imu.host_frame"),
        {"unit": {"dsp": LOGGER}, "host": {**HOST, "motion": {"kind": "static"}}},
    ),
    "sensor models": Row(
        ("imu.models.imu", "imu.numeric.", "imu.model_codes", "imu.firmware_model"),
        {"unit": {"dsp": IMU}, "host": HOST, "controller": {**HEAD, "period": "20 ms"}},
    ),
    "sensor chip": Row(
        ("devices.chips.", "devices.register_pointer", "scene.sensor_chips"), {"chip": CHIP, "controller": HEAD}
    ),
    "device": Row(
        ("devices.targets.", "scene.devices", "bus.i2c.target_side", "bus.i2c.disturbed_target"), present=("bus",)
    ),
    "device in Python": Row(
        ("scene.device_file", "devices.python_device"),
        {"device": {"d": {"model": "mine.py", "address": 0x51}}, "controller": HEAD},
    ),
    "fault on a wire": Row(("bus.faults.", "scene.faults"), of_slave(fault=[SPIKE])),
    "serial": Row(
        ("scene.serial.", "bus.uart.burst_sender"),
        {"unit": {"dsp": LOGGER}, "serial": {"send": [{"to": "dsp.SCI-A", "text": "ok", "at": "1 ms"}]}},
    ),
    "RS-485": Row(
        ("bus.uart.rs485", "scene.pairs"),
        {"unit": {"dsp": {**LOGGER, "modules": ["SCI-A", "GPIO"]}}, "transceiver": [DE]},
    ),
    "budgets": Row(("timing.budgets", "timing.measures."), present=("slave",)),
    "budgets on lost flags": Row(
        (
            "timing.measures.modifies",
            "records.cleared_flags",
        ),
        with_budget("lost flags", max=0),
    ),
    "budgets on races": Row(
        (
            "timing.measures.over_table",
            "records.read_modify_write",
            "records.subject",
            "records.run",
            "traces.formats.",
        ),
        with_budget("race I2C-A.I2CSTR.XRDY", min=1),
    ),
    "budgets on values": Row(
        ("timing.derived.error_records",),
        {
            "unit": {"dsp": {**IMU, "settings": {"arithmetic": "bytes"}}},
            "host": HOST,
            "controller": {**HEAD, "period": "20 ms"},
            "budget": [{"name": "one", "measure": "value error of gyroscope", "max": "2 LSB"}],
        },
    ),
    "recording": Row(("records.recording.", "traces.formats."), BARE["slave"], record="run.psr"),
}

# Entry points of periph_sim and packages beside scenes, of periph_sim and of others. No scene needs one of them.
ENTRY_POINTS = (
    *(
        "__main__",
        "api",
        "cli",
        "outside.",
        "interfaces.commands.",
        "interfaces.pytest_plugin.",
        "interfaces.reports.",
        "replay.",
    ),
    *("imu.commands.", "imu.moving.", "traces.formats.", "traces.compliance.", "traces.diff.", "traces.drawing."),
)
OTHERS = (
    *("numpy", "click", "rich", "jinja2", "drawsvg", "pywellen", "pylibfst", "vcd", "zlib_ng", "matplotlib", "scipy"),
    *("ahrs", "distributed", "pytest", "hypothesis", "multiprocessing", "concurrent", "sqlite3", "asyncio"),
    *("pydantic", "pydantic_core", "annotated_types"),
)
# Ends of names of modules with data, in which words of a case are looked up.
DATA = ("descriptor", "register_map", "_map", "pin_mux_table")

DEVICE = """
class Device:
    def __init__(self, bus):
        self.bus = bus

    def on_read(self):
        return 0
"""


def is_in_packages(module: str, packages: tuple[str, ...]) -> bool:
    """Return True for a module, without "periph_sim.", of these packages that is not a table of names."""
    return not module.endswith(DATA) and any(
        module.startswith(package) if package.endswith(".") else module == package for package in packages
    )


def run(tables: Mapping[str, Any], record: str = "") -> Any:
    """Run a scene of these tables and return it."""
    from periph_sim.scene.case.model import Case
    from periph_sim.scene.scene import Scene

    case = Case.model_validate({"name": "absent", "duration": "1 s", "unit": {}, **tables})
    if not record:
        scene = Scene(case)
        scene.run(SECONDS)
        return scene
    from periph_sim.records.recording import recording

    with recording(Path(record), case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe)
        scene.run(SECONDS)
        ended_at(scene.kernel.now, {})
    return scene


NOT_FOLLOWED = (ModuleType, type, CodeType, FrameType, BuiltinFunctionType)


def census(scene: object) -> Counter[str]:
    """Return the number of instances of each class of periph_sim that a scene refers to: {"core.wire.Wire": 2, ...}."""
    found: Counter[str] = Counter()
    seen = {id(scene)}
    left = [scene]
    while left:
        one = left.pop()
        kind = type(one)
        while not kind.__name__.isidentifier():  # a class made for a register: "I2C-A.I2CSTR"
            kind = kind.__base__
        if kind.__module__.startswith(OURS):
            found[f"{kind.__module__.removeprefix(OURS)}.{kind.__qualname__}"] += 1
        if isinstance(one, FunctionType):
            more: list[object] = [*(one.__closure__ or ()), *(one.__defaults__ or ())]
        elif type(one).__name__ == "cython_function_or_method":
            more = []
        else:
            more = gc.get_referents(one)
        for other in more:
            if id(other) not in seen and not isinstance(other, NOT_FOLLOWED):
                seen.add(id(other))
                left.append(other)
    return found


def loaded() -> list[str]:
    """Return the loaded modules of periph_sim, without "periph_sim.", and the other loaded packages."""
    return sorted(
        {name.removeprefix(OURS) if name.startswith(OURS) else name.partition(".")[0] for name in sys.modules}
    )


COUNTED = "bus"  # the bare scene whose process also counts the objects of the other scenes


def report(name: str) -> dict[str, Any]:
    """Return the report that `python -m tests.scene.absent` prints."""
    before = set(loaded())
    scene = run(BARE[name])
    result: dict[str, Any] = {"modules": sorted(set(loaded()) - before), "events": scene.kernel.events}
    result["objects"] = census(scene)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("mine.py").write_text(DEVICE, "utf-8")
        result["named"] = {}
        for what, row in ROWS.items():
            having = row.named or BARE[row.present[0]]
            other = run(having, row.record)
            result["named"][what] = census(other) if name == COUNTED else {}
        os.chdir("/")
    result["all modules"] = loaded()
    again = run(BARE[name])
    return {**result, "events again": again.kernel.events, "objects again": census(again)}


if __name__ == "__main__":
    print(json.dumps(report(sys.argv[1])))
