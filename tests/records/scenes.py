"""Small scenes, recorded as `run --record x.psr` records them, and hand-made tables of records."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim.core.records import RECORDED, Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.processor.dsp import Dsp
from periph_sim.records.recording import recording
from periph_sim.records.run import Run
from periph_sim.scene import unit as unit_module
from periph_sim.scene.case.model import Case
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from periph_sim.traces.formats.record_table import Columns
from tests.scene.small import case

PER_SECOND = Fraction(3_000_000_000)
CYCLE = 20
ADDRESS = 0x50
MODULES = {"dsp": ("I2C-A", "SCI-A", "pin:MODEL")}
Main = Callable[[Dsp], None]


def ran(
    monkeypatch: pytest.MonkeyPatch, firmware: Main, duration: str = "10 ms", skip_polls: bool = True, **more: Any
) -> Run:
    """Run `firmware` on a unit "dsp" with an I2C-A, and return the recorded run."""
    program = Firmware("under test", lambda dsp, settings: firmware(dsp), None)
    monkeypatch.setattr(unit_module, "load_firmware", lambda name: program)
    unit = {"firmware": "under test", "modules": ["I2C-A"], "skip_polls": skip_polls}
    return recorded(case(duration, unit={"dsp": unit}, **more))


def recorded(of: Case, seconds: str | None = None) -> Run:
    columns = Columns()
    scene = Scene(of, lambda recorder, timebase: recorder.subscribe(RECORDED, columns.add))
    scene.run(None if seconds is None else Fraction(seconds))
    per_second = Fraction(scene.timebase.per_second)
    return Run(columns.table(per_second, scene.kernel.now, of.recorded_modules, scene.clocks()))


def asks(address: int = ADDRESS, **request: Any) -> dict[str, Any]:
    """Tables of a case with a controller that makes one request at 1 ms."""
    return {"controller": {"first": "1 ms", "rounds": 1, "request": [{"address": address, **request}]}}


def by_hand(*rows: tuple[Any, ...], end: int = 10_000, modules: tuple[str, ...] = ("I2C-A",)) -> Run:
    """A run with these records, numbered from 1.

    A row is cycle, kind, where, what, value, text, cause and, for an access, the name of the field.
    """
    columns = Columns()
    for number, (cycle, *of) in enumerate(rows, 1):
        columns.add(Record(number, cycle * CYCLE, *of))
    return Run(columns.table(PER_SECOND, end * CYCLE, {"dsp": modules}, {}))


def read(cycle: int, value: int = 0, field: str = "", place: str = "f:1", routine: int = 0) -> tuple[Any, ...]:
    return cycle, Kind.ACCESS, "dsp", "R I2C-A.I2CSTR", value, place, routine, field


def write(cycle: int, value: int = 0, field: str = "", place: str = "f:1", routine: int = 0) -> tuple[Any, ...]:
    return cycle, Kind.ACCESS, "dsp", "W I2C-A.I2CSTR", value, place, routine, field


def flag(cycle: int, name: str, value: int, cause: int = 0) -> tuple[Any, ...]:
    return cycle, Kind.FLAG, "dsp.I2C-A", f"I2CSTR.{name}", value, "", cause


def written(path: Path, *rows: tuple[Any, ...], end: int, modules: Any = MODULES, sysclk: int = 150_000_000) -> Path:
    """Write a recording. A row is tick, kind, where, what and the further fields of a record."""
    recorder = Recorder()
    with recording(path, modules) as (subscribe, ended_at):
        subscribe(recorder, Timebase(sysclk))
        for row in rows:
            recorder.emit(*row)
        ended_at(end, {})
    return path


def recorded_to(path: Path, of: Case) -> Path:
    """Run the case and record it as `run --record` does. Return the path."""
    with recording(path, of.recorded_modules) as (subscribe, ended_at):
        scene = Scene(of, subscribe)
        scene.run()
        ended_at(scene.kernel.now, scene.clocks())
    return path


def line_of(function: Callable[..., object], below: int = 1) -> str:
    """The place, as records name it, of the line that is `below` lines below the first line of a function."""
    return f"{function.__code__.co_name}:{function.__code__.co_firstlineno + below}"
