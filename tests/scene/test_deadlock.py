"""Firmware that waits for an event that cannot occur: it is reported with the reason, and the run fails."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from periph_sim import Dsp, Result, Scene, load
from periph_sim.core.phrases import counted
from periph_sim.firmware import sci_fifo_receiver, start_i2c, start_pin
from tests.interfaces.commands.conftest import Run, desk, periph_sim
from tests.scene.runs import TIMING
from tests.scene.small import case, command, given, scene_with, started_i2c, unit

__all__ = ["desk", "periph_sim"]

HEAD = {"order": ["gyroscope"], "first": "1 ms", "period": "10 ms"}


def waits_for_aas(dsp: Dsp) -> None:
    i2c = started_i2c(dsp, own_address=0x68)
    dsp.spin(lambda: i2c.I2CSTR.AAS == 1)


def waits_for_a_word(dsp: Dsp) -> None:
    sci_fifo_receiver(dsp, 40, 12)
    sci = dsp.module("SCI-A")
    dsp.spin_either(lambda: sci.SCIFFRX.RXFFST == 12, lambda: sci.SCIRXST.BRKDT == 1)


def test_a_unit_that_waits_alone_on_the_bus_is_stuck():
    result = scene_with(waits_for_aas, ["I2C-A"]).run()
    assert result.verdict == "fail"
    assert result.stuck == [
        "dsp waits for I2C-A.I2CSTR.AAS since 0.360 us and would for ever: "
        "I2C-A has nothing due and no party will change SDA or SCL"
    ]


def test_every_register_that_is_polled_is_named():
    (sentence,) = scene_with(waits_for_a_word, ["SCI-A"]).run().stuck
    assert "waits for SCI-A.SCIFFRX.RXFFST and SCI-A.SCIRXST.BRKDT since" in sentence
    assert sentence.endswith("SCI-A has nothing due and no party will change RX")


def test_traffic_elsewhere_does_not_hide_a_stuck_wait():
    """The bus has traffic for ever, but the firmware waits for a character, and no party drives the serial line."""
    result = scene_with(waits_for_a_word, ["I2C-A", "SCI-A"], controller=HEAD).run()
    assert len(result.stuck) == 1 and result.verdict == "fail"


def test_the_wait_for_a_frame_of_a_host_is_no_deadlock():
    scene = scene_with(waits_for_a_word, ["I2C-A", "SCI-A"], controller=HEAD, host={"first": "5 s"})
    assert scene.run().stuck == []


def test_firmware_that_waits_for_an_agent_that_has_finished_is_idle():
    short = HEAD | {"order": ["accelerometer"], "rounds": 1}
    result = scene_with(waits_for_aas, ["I2C-A"], controller=short).run()
    assert result.counts["rounds"] == 1
    assert (result.verdict, result.stuck) == ("not judged", [])  # it has no budgets


def test_a_slave_is_idle_after_the_last_round_of_its_case():
    result = Scene(load(TIMING / "responder.toml", ["controller.rounds=2"])).run()
    assert (result.verdict, result.stuck, result.counts["rounds"]) == ("pass", [], 2)


def test_two_units_that_wait_for_each_other():
    unit = {"firmware": "responder", "modules": ["I2C-A"]}
    changes = [f"unit.{name}.{key}={value!r}" for name in ("a", "b") for key, value in unit.items()]
    loaded = load(TIMING / "responder.toml", changes)
    alone = loaded.model_copy(
        update={"controller": None, "budget": (), "unit": {name: loaded.unit[name] for name in "ab"}}
    )
    result = Scene(alone).run()
    assert [line.split(" ")[0] for line in result.stuck] == ["a", "b"]
    assert all(line.endswith("I2C-A has nothing due and no party will change SDA or SCL") for line in result.stuck)


def two_units(one: Callable[[Dsp], None], other: Callable[[Dsp], None], *modules: str, **more: Any) -> list[str]:
    """Return the units that are stuck at the end. modules: of `one`; the other unit has an I2C-A."""
    made = case(unit={"one": unit("I2C-A", *modules), "other": unit("I2C-A")}, **more)
    result = Scene(made, programs=given(one=one, other=other)).run()
    return [sentence.split(" ")[0] for sentence in result.stuck]


def long_timer(dsp: Dsp, tcr: int, name: str = "TIMER0") -> Any:
    """Start a timer with this TCR that would expire after the end of the run, and return it."""
    timer = dsp.module(name)
    timer.PRD.all = timer.PRDH.all = 0xFFFF
    timer.TCR.all = tcr
    return timer


def writes_a_byte(dsp: Dsp) -> None:
    """Write a byte to address 0x68 as the bus master, and end."""
    start_i2c(dsp)
    i2c = dsp.module("I2C-A")
    command(i2c, 0x68, 1, first=0x5A)
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)


def hangs_after_a_byte(dsp: Dsp) -> None:
    writes_a_byte(dsp)
    i2c = dsp.module("I2C-A")
    i2c.I2CSTR.SCD = 1
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)


def reads_bytes(dsp: Dsp) -> None:
    """Read bytes as the slave at 0x68, for ever."""
    i2c = started_i2c(dsp, own_address=0x68)
    while True:
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
        assert i2c.I2CDRR.all == 0x5A


def test_a_slave_is_idle_beside_a_master_that_has_ended_and_stuck_beside_one_that_hangs():
    assert two_units(writes_a_byte, reads_bytes) == []
    assert two_units(hangs_after_a_byte, reads_bytes) == ["one", "other"]


def test_a_master_that_computes_or_waits_for_a_timer_may_go_on():
    def computes(dsp: Dsp) -> None:
        writes_a_byte(dsp)
        dsp.compute(10**9)

    def waits(dsp: Dsp) -> None:
        writes_a_byte(dsp)
        timer = long_timer(dsp, 0x20)
        dsp.spin(lambda: timer.TCR.TIF == 1)

    assert two_units(computes, reads_bytes) == []
    assert two_units(waits, reads_bytes, "TIMER0") == []


def test_frames_elsewhere_and_a_chip_that_only_answers_do_not_hide_a_wait():
    """The bus is quiet, and only a unit that waits, too, could begin a transfer; frames arrive on RX for ever."""
    chip = {"gyroscope": {"model": "itg3200", "values": {"fixed": [0, 0, 0]}}}

    def hangs(dsp: Dsp) -> None:
        start_i2c(dsp)
        i2c = dsp.module("I2C-A")
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)

    assert two_units(hangs, waits_for_aas, "SCI-A", chip=chip, host={"period": "2 ms"}) == ["one", "other"]


def test_a_wait_for_a_stopped_timer_is_stuck_and_one_for_a_running_timer_is_not():
    def waits_for_tif(dsp: Dsp, stop: int) -> None:
        timer = dsp.module("TIMER0")
        timer.PRD.all = 1000
        timer.TCR.all = 0x20 | stop << 4
        dsp.spin(lambda: timer.TCR.TIF == 1)

    stopped = scene_with(lambda dsp: waits_for_tif(dsp, 1), ["TIMER0"]).run()
    (sentence,) = stopped.stuck
    assert sentence.endswith("TIMER0 has nothing due and no wire leads there")
    running = scene_with(lambda dsp: waits_for_tif(dsp, 0), ["TIMER0"]).run()
    assert running.stuck == []


def test_a_wait_is_no_deadlock_while_a_timer_with_an_enabled_interrupt_runs():
    def helped(dsp: Dsp, eint: bool) -> None:
        long_timer(dsp, 0x4020)
        dsp.handle("TINT0", lambda: None)
        dsp.module("PIE").PIECTRL.ENPIE = 1
        dsp.module("PIE").PIEIER1.INTx7 = 1
        dsp.enable_interrupt(1)
        if eint:
            dsp.eint()
        waits_for_aas(dsp)

    modules = ["I2C-A", "TIMER0"]
    assert scene_with(lambda dsp: helped(dsp, True), modules).run().stuck == []
    assert len(scene_with(lambda dsp: helped(dsp, False), modules).run().stuck) == 1


def test_firmware_in_idle_is_reported_as_waiting_in_idle():
    def sleeps(dsp: Dsp) -> None:
        dsp.cpu.idle()

    scene = scene_with(sleeps, [])
    scene.run()
    line = sleeps.__code__.co_firstlineno + 1
    assert scene.doing(scene.units["dsp"]) == f"waits in IDLE for an interrupt at line {line} of test_deadlock.py"


# Lines that are held low ----------------------------------------------------------


def never_writes(dsp: Dsp) -> None:
    """Acknowledge the address and never write a byte, so that the module holds SCL."""
    waits_for_aas(dsp)
    i2c = dsp.module("I2C-A")
    dsp.spin(lambda: i2c.I2CSTR.RSFULL == 1)


def run_with_held_scl(**more: object) -> tuple[Scene, Result]:
    request = {"address": 0x68, "count": 6}
    head = {"first": "1 ms", "period": "10 ms", "stuck_after": "5 ms", "request": [request], **more}
    scene = scene_with(never_writes, ["I2C-A"], duration="50 ms", controller=head)
    return scene, scene.run()


def test_a_slave_that_stretches_for_ever_is_reported_as_the_holder_of_scl():
    scene, result = run_with_held_scl()
    (sentence,) = result.stuck
    assert sentence.startswith("SCL is held low by dsp.SCLA at ")
    assert "dsp waits for I2C-A.I2CSTR.RSFULL since " in sentence
    assert scene.wires["SCL"].held_by() == ["dsp.SCLA"]
    assert (result.counts["stuck"], result.counts["missed"], result.counts["rounds"]) == (1, 4, 0)
    assert result.verdict == "fail"


def test_an_endless_stretch_is_a_deadlock_if_the_controller_has_nothing_else_to_do():
    _, result = run_with_held_scl(rounds=1)
    assert len(result.stuck) == 2 and result.verdict == "fail"
    assert result.stuck[1].endswith("I2C-A has nothing due and no party will change SDA or SCL")


def test_a_long_stretch_that_ends_is_counted_but_fails_only_by_budget():
    def slow(dsp: Dsp) -> None:
        waits_for_aas(dsp)
        dsp.compute(1_500_000)  # 10 ms
        i2c = dsp.module("I2C-A")
        i2c.I2CDXR.all = 0x5A
        dsp.spin(lambda: i2c.I2CSTR.NACK == 1)

    head = {"first": "1 ms", "stuck_after": "5 ms", "rounds": 1, "request": [{"address": 0x68, "count": 1}]}
    result = scene_with(slow, ["I2C-A"], duration="50 ms", controller=head).run()
    assert (result.counts["stuck"], result.counts["rounds"]) == (1, 1)
    assert result.verdict == "not judged"  # it has no budgets


FOREVER = """\
def main(dsp, settings):
    i2c = dsp.module("I2C-A")
    dsp.spin(lambda: i2c.I2CSTR.XRDY == 1)
"""


def test_the_command_reports_stuck_firmware_with_status_1(periph_sim: Run, desk: Path):
    Path("forever.py").write_text(FOREVER, encoding="utf-8")
    Path("alone.toml").write_text(
        'name = "alone"\nduration = "1 ms"\n[unit.dsp]\nfirmware = "forever.py"\nmodules = ["I2C-A"]\n',
        encoding="utf-8",
    )
    came = periph_sim("run", "alone.toml")
    assert came.status == 1
    assert (
        "stuck: dsp waits for I2C-A.I2CSTR.XRDY since 0.000 us and would for ever: PCLKCR gives I2C-A no clock"
    ) in came.out


def test_a_module_without_clock_sees_no_traffic():
    def forgot_pclkcr(dsp: Dsp) -> None:
        i2c = dsp.module("I2C-A")
        i2c.I2COAR.all = 0x68
        i2c.I2CMDR.IRS = 1
        dsp.spin(lambda: i2c.I2CSTR.AAS == 1)

    result = scene_with(forgot_pclkcr, ["I2C-A"], controller=HEAD).run()
    (sentence,) = result.stuck
    assert sentence.endswith("PCLKCR gives I2C-A no clock")
    assert result.counts["nacked"] == result.counts["rounds"] == 1


# Watchdog ----------------------------------------------------------------------


def scene_from_boot(firmware: Callable[[Dsp], None], duration: str, *modules: str) -> Scene:
    """Return a scene that starts from boot, with the watchdog on and the PLL off.

    SYSCLKOUT is 7.5 MHz, and WDCNTR overflows after 512 * 256 cycles of OSCCLK.
    """
    return scene_with(firmware, list(modules), {"from_boot": True}, duration=duration)


@pytest.mark.parametrize(("duration", "resets"), [("4.3 ms", 0), ("4.4 ms", 1), ("8.8 ms", 2), ("44 ms", 10)])
def test_firmware_that_does_not_service_the_watchdog_restarts(duration: str, resets: int):
    began: list[int] = []

    def forgets(dsp: Dsp) -> None:
        began.append(dsp.cpu.cycle)
        dsp.compute(10**9)

    result = scene_from_boot(forgets, duration).run()
    assert result.counts["resets"] == resets
    assert len(began) == resets + 1
    line = forgets.__code__.co_firstlineno + 2
    expected = f"dsp: its watchdog reset it at forgets:{line}, first at 4369.067 us ({counted(resets, 'time')})"
    assert [note for note in result.notes if "watchdog" in note] == [expected] * (resets > 0)


def test_a_watchdog_reset_ends_a_spin_that_nothing_else_ends():
    began: list[int] = []

    def waits(dsp: Dsp) -> None:
        began.append(dsp.cpu.cycle)
        pie = dsp.module("PIE")
        dsp.spin(lambda: pie.PIECTRL.ENPIE == 1)

    result = scene_from_boot(waits, "9 ms").run()
    assert result.counts["resets"] == 2 and len(began) == 3
    assert result.stuck == []  # the watchdog is due


def turns_on_the_sci(dsp: Dsp) -> None:
    dsp.eallow()
    dsp.module("SYS").PCLKCR0.SCIAENCLK = 1
    dsp.edis()


@pytest.mark.parametrize("clock", [True, False])
def test_a_watchdog_reset_ends_a_poll_of_a_module(clock: bool):
    def waits(dsp: Dsp) -> None:
        if clock:
            turns_on_the_sci(dsp)
        sci = dsp.module("SCI-A")
        dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)

    result = scene_from_boot(waits, "9 ms", "SCI-A").run()
    assert (result.counts["resets"], result.stuck) == (2, [])


def test_a_serviced_watchdog_never_resets():
    def careful(dsp: Dsp) -> None:
        system = dsp.module("SYS")
        while True:
            dsp.compute(30_000)
            dsp.eallow()
            system.WDKEY.all = 0x55
            system.WDKEY.all = 0xAA
            dsp.edis()

    assert scene_from_boot(careful, "50 ms").run().counts["resets"] == 0


MEMORY = {"memory": {"model": "24lc64"}}
ADC = {
    "adc": {
        "model": "registers",
        "address": 0x48,
        "register": [{"name": "STATUS", "at": 0}],
        "interrupt": {"wire": "DRDY", "register": "STATUS"},
    }
}


def test_a_device_that_only_answers_changes_no_line_by_itself():
    (sentence,) = scene_with(waits_for_aas, ["I2C-A"], device=MEMORY).run().stuck
    assert sentence.endswith("I2C-A has nothing due and no party will change SDA or SCL")


def test_the_wait_for_a_devices_interrupt_pin_is_no_deadlock(tmp_path: Path):
    """The device could still change its interrupt pin, as a host could still send frames."""
    text = "def main(dsp, settings):\n    gpio = dsp.module('GPIO')\n    dsp.spin(lambda: gpio.GPADAT.GPIO12 == 0)\n"
    (tmp_path / "waits.py").write_text(text, encoding="utf-8")
    unit = {"firmware": str(tmp_path / "waits.py"), "modules": ["I2C-A", "GPIO"], "pins": {"DRDY": 12}}
    result = Scene(case("1 ms", unit={"dsp": unit}, device=ADC)).run()
    assert result.stuck == [] and result.verdict != "fail"


def test_a_missing_acknowledgement_is_reported_and_an_output_of_the_unit_is_not():
    """The module holds the bus after the NACK, and no STOP follows because the firmware requests none."""

    def ignores_nack(dsp: Dsp) -> None:
        i2c = started_i2c(dsp)
        start_pin(dsp, 34)
        command(i2c, 0x51, 2, 0x6620, first=0x10)  # STT, MST, TRX, IRS
        dsp.spin(lambda: i2c.I2CSTR.ARDY == 1)
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)

    (sentence,) = scene_with(ignores_nack, ["I2C-A", "GPIO"], {"pins": {"GOOD": 34}}, duration="1 ms").run().stuck
    head, _, rest = sentence.partition("no party will change ")
    assert "waits for I2C-A.I2CSTR.SCD since" in head
    assert re.fullmatch(r"SDA or SCL; I2CSTR.NACK is set since (\d+\.\d+) us: address 0x51 was not acknowledged", rest)


@pytest.mark.parametrize(("module", "vector", "line"), [("TIMER1", "INT13", 13), ("TIMER2", "INT14", 14)])
def test_a_timer_without_the_pie_may_wake_a_unit_if_it_runs(module: str, vector: str, line: int):
    def sleeps(dsp: Dsp, stop: int) -> None:
        long_timer(dsp, 0x4020 | stop << 4, module)
        dsp.handle(vector, lambda: None)
        dsp.enable_interrupt(line)
        dsp.eint()
        dsp.cpu.idle()

    assert scene_with(lambda dsp: sleeps(dsp, 0), [module]).run().stuck == []
    (sentence,) = scene_with(lambda dsp: sleeps(dsp, 1), [module]).run().stuck
    assert sentence.endswith(f"{module} has nothing due and no wire leads there")


@pytest.mark.parametrize("disable", [[], ["polls"]])
def test_a_wait_with_a_timeout_is_no_deadlock(disable: list[str]):
    def waits_20_ms_at_most(dsp: Dsp) -> None:
        i2c = started_i2c(dsp, own_address=0x68)
        dsp.spin(lambda: i2c.I2CSTR.AAS == 1, timeout=20 * 150_000)

    result = scene_with(waits_20_ms_at_most, ["I2C-A"], disable=disable).run()
    assert result.stuck == [] and result.verdict == "not judged"
