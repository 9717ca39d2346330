"""Small scenes whose runs are recorded as `run --record x.psr` would, and tables of records given by hand."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from periph_sim.core.records import RECORDED, Record
from periph_sim.processor.dsp import Dsp
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
Main = Callable[[Dsp], None]


def ran(
    monkeypatch: pytest.MonkeyPatch, firmware: Main, duration: str = "10 ms", skip_polls: bool = True, **more: Any
) -> Run:
    """What a unit "dsp" with an I2C-A did under `firmware`."""
    program = Firmware("under test", lambda dsp, settings: firmware(dsp), None)
    monkeypatch.setattr(unit_module, "load_firmware", lambda name: program)
    unit = {"firmware": "under test", "modules": ["I2C-A"], "skip_polls": skip_polls}
    return recorded(case(duration, unit={"dsp": unit}, **more))


def recorded(of: Case, seconds: str | None = None) -> Run:
    columns = Columns()
    scene = Scene(of, lambda recorder, timebase: recorder.subscribe(RECORDED, columns.add))
    scene.run(None if seconds is None else Fraction(seconds))
    return Run(columns.table(Fraction(scene.timebase.per_second), scene.kernel.now, of.recorded_modules))


def asks(address: int = ADDRESS, **request: Any) -> dict[str, Any]:
    """A controller that makes one request at 1 ms."""
    return {"controller": {"first": "1 ms", "rounds": 1, "request": [{"address": address, **request}]}}


def by_hand(*rows: tuple[Any, ...], end: int = 10_000, modules: tuple[str, ...] = ("I2C-A",)) -> Run:
    """A run of given records: cycle, kind, where, what, value, text, cause, and of an access the field that was named;
    numbered from 1."""
    columns = Columns()
    for number, (cycle, *of) in enumerate(rows, 1):
        columns.add(Record(number, cycle * CYCLE, *of))
    return Run(columns.table(PER_SECOND, end * CYCLE, {"dsp": modules}))


def line_of(function: Callable[..., object], below: int = 1) -> str:
    """The place of the line so many below the head of a function, as records name it."""
    return f"{function.__code__.co_name}:{function.__code__.co_firstlineno + below}"
