"""Small scenes for tests: firmware given as a function, a case given as a few tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest

from periph_sim import Case, Dsp, Firmware, Scene
from periph_sim.firmware import start_i2c


def case(duration: str = "10 ms", **more: Any) -> Case:
    """Return a case of these tables; `unit` may be left out for a scene without a DSP."""
    return Case.model_validate({"name": "small", "duration": duration, "unit": {}, **more})


def unit(*modules: str, **more: Any) -> dict[str, Any]:
    """Return the table of a unit that runs one of the programs `given`."""
    return {"firmware": "given", "modules": list(modules), **more}


def started_i2c(dsp: Dsp, own_address: int = 0) -> Any:
    """Return the I2C module of a unit, started and out of reset."""
    start_i2c(dsp, own_address)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    return i2c


def command(i2c: Any, address: int, count: int, mode: int = 0x6E20, first: int | None = None) -> None:
    """Start a transfer as the bus master. mode: I2CMDR, here a write with STOP. first: the first byte."""
    i2c.I2CSAR.all = address
    i2c.I2CCNT.all = count
    if first is not None:
        i2c.I2CDXR.all = first
    i2c.I2CMDR.all = mode


def given(**programs: Callable[[Dsp], None]) -> dict[str, Firmware]:
    """Return the programs of units, each given as a function of its DSP."""
    return {unit: Firmware("given", lambda dsp, settings, run=run: run(dsp), None) for unit, run in programs.items()}


def scene_with(firmware: Callable[[Dsp], None], modules: list[str], dsp: Mapping[str, Any] = {}, **more: Any) -> Scene:
    """Return a scene whose unit "dsp" runs `firmware`. dsp: more keys of the unit. more: more tables of the case."""
    return Scene(case(unit={"dsp": unit(*modules, **dsp)}, **more), programs=given(dsp=firmware))


def sentence_of(error: type[Exception], refused: Callable[[], object]) -> str:
    """Return the message, of one line, of an error of this kind, which the call must raise."""
    with pytest.raises(error) as caught:
        refused()
    assert "\n" not in str(caught.value)
    return str(caught.value)
