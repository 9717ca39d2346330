"""A scene builds only what its case names, and costs only what it builds."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

from periph_sim import Case, Dsp, Scene
from periph_sim.core.chip import NEVER
from periph_sim.f28335.gpio.module import Gpio
from periph_sim.f28335.i2c.module import I2c
from periph_sim.f28335.sci.module import Sci
from periph_sim.firmware.sci import start_sci
from periph_sim.scene.case.origin import Source
from tests.scene.small import case, scene_with

ALWAYS = {"SYS", "PIE"}


def idle(dsp: Dsp) -> None:
    """Firmware that has nothing to do."""


@pytest.mark.parametrize(
    ("modules", "wires"),
    [
        ([], set()),
        (["I2C-A"], {"SDA", "SCL"}),
        (["SCI-A"], {"RX", "TX"}),
        (["GPIO"], set()),
        (["I2C-A", "SCI-A", "GPIO"], {"SDA", "SCL", "RX", "TX"}),
        (["TIMER0"], set()),
    ],
)
def test_sockets_and_wires_are_those_of_the_modules_named(modules: list[str], wires: set[str]):
    scene = scene_with(idle, modules)
    assert set(scene.units["dsp"].sockets) == ALWAYS | set(modules)
    assert set(scene.wires) == wires
    assert scene.head is None and scene.host is None


def modules() -> list[object]:
    """Return the existing modules of chips, found by their type since compiled classes cannot be patched."""
    return [one for one in gc.get_objects() if type(one) in (Sci, I2c, Gpio)]


@pytest.mark.parametrize(
    ("named", "made"), [([], []), (["I2C-A"], ["I2c"]), (["SCI-A", "SCI-C", "GPIO"], ["Gpio", "Sci", "Sci"])]
)
def test_only_named_modules_are_created(named: list[str], made: list[str]):
    gc.collect()
    before = modules()
    scene = scene_with(idle, named)
    assert sorted(type(one).__name__ for one in modules() if all(one is not old for old in before)) == made
    assert set(scene.units["dsp"].sockets) == ALWAYS | set(named)


def test_a_scene_without_agents_costs_one_event_for_each_unit():
    result = scene_with(idle, ["I2C-A", "SCI-A", "GPIO"]).run()
    firmware_starts, routes_settle = 1, 1
    assert result.events == firmware_starts + routes_settle


def test_an_agent_on_wires_alone_costs_its_own_events():
    alone = Scene(case(controller={"order": ["gyroscope"], "rounds": 1}))
    result = alone.run()
    assert set(alone.wires) == {"SDA", "SCL"} and alone.units == {}
    assert result.wire_bytes == 1 and result.counts["nacked"] == 1
    silent = Scene(case(host={"frames": 0})).run()
    assert silent.events <= 1


def test_a_host_in_a_scene_without_an_sci_drives_its_wire():
    scene = scene_with(idle, ["I2C-A"], host={"frames": 1})
    assert set(scene.wires) == {"SDA", "SCL", "RX"}
    assert scene.run().sci_bytes == 12


def sends_ten(dsp: Dsp) -> None:
    sci = start_sci(dsp)
    for number in range(10):
        dsp.spin(lambda: sci.SCIFFTX.TXFFST < 16)
        sci.SCITXBUF.all = number
    dsp.spin(lambda: sci.SCICTL2.TXEMPTY == 1)


@pytest.mark.parametrize("disable", ["bits", ()])
def test_characters_count_in_both_directions(disable: object):
    """Characters that units send and receive are counted, with and without skipped bits."""
    result = scene_with(sends_ten, ["SCI-A"], host={"frames": 1}, disable=disable, duration="40 ms").run()
    assert (result.sci_bytes, result.sci_bytes_sent) == (12, 10)
    silent = scene_with(idle, ["SCI-A"], host={"frames": 1}, disable=disable).run()
    assert (silent.sci_bytes, silent.sci_bytes_sent) == (12, 0)


def test_two_units_share_the_wires():
    units = {
        "a": {"firmware": "imu_hil", "modules": ["I2C-A"]},
        "b": {"firmware": "imu_hil", "modules": ["I2C-A"], "ppm": 50},
    }
    scene = Scene(case(unit=units))
    assert set(scene.wires) == {"SDA", "SCL"}
    assert scene.units["b"].clock.hz == scene.units["a"].clock.hz * 1_000_050 / 1_000_000


def test_firmware_that_has_returned_from_main_is_reported():
    scene = scene_with(idle, [])
    scene.run()
    assert scene.doing(scene.units["dsp"]) == "has returned from main"
    assert scene.deadlocks() == []
    assert scene.kernel.next_time() == NEVER


def test_progress_goes_from_0_to_1():
    reported: list[float] = []
    Scene(case(host={"frames": 0})).run(progress=reported.append)
    assert reported[-1] == 1 and reported == sorted(reported) and len(reported) == 100


def test_a_run_starts_where_the_case_says():
    scene = Scene(case(start="30 d", controller={"order": ["gyroscope"], "rounds": 1, "first": "1 ms"}))
    starts: list[int] = []
    scene.head.on_round.append(lambda over: starts.append(over.start))
    scene.run()
    assert starts == [scene.timebase.ticks("30 d") + scene.timebase.ticks("1 ms")]


def test_a_device_whose_construction_never_ends_fails_the_run_at_its_start(tmp_path: Path):
    text = "class Device:\n    def __init__(self, bus):\n        while True: ...\n    def on_read(self): return 0\n"
    (tmp_path / "endless.py").write_text(text)
    tables = {"name": "x", "duration": "1 ms", "stall_limit": "50 ms"}
    tables |= {"device": {"it": {"model": "endless.py", "address": 0x42}}}
    scene = Scene(Case.model_validate(tables).from_source(Source(tmp_path / "case.toml", "")))
    result = scene.run()
    assert (result.verdict, result.simulated_s, result.events) == ("fail", 0, 0)
    assert len(result.stuck) == 1 and "endless.py" in result.stuck[0]
