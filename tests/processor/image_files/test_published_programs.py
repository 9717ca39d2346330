"""Public images S9 to S14 run as far as the chip is modelled. Skipped if no folder of images is given.

    reset --> start-up, clocks --> a number of instructions, none illegal --> the function reached, the bytes sent

`make explore` runs ten times as many instructions.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.processor.image.program import ImageProgram
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene
from tests.processor.image_files.public_images import public_image
from tests.profiles import explores

MODULES = ["SCI-A", "SCI-B", "SCI-C", "I2C-A", "GPIO", "XINT", "TIMER0", "TIMER1", "TIMER2"]
STEP = Fraction(1, 200)  # seconds
MOST = 400  # steps
# InitECan waits for CANES.CCE of eCAN-A and -B to be 1 after it requests changes, and 0 after it ends the request.
CAN = [
    *({"register": canes, "value": 0x10} for canes in (0x6018, 0x6218)),
    {"register": 0x6018, "value": 0, "after": "8 ms"},
    {"register": 0x6218, "value": 0, "after": "12 ms"},
]


CLOCKS = ("SYS.PLLCR", "SYS.PLLSTS", "SYS.LOSPCP", "SYS.HISPCP", "SYS.PCLKCR0", "SYS.WDCR")


class Ran:
    """A run of a program until it has executed at least a number of instructions."""

    def __init__(self, name: str, instructions: int, kinds: Iterable[Kind] = (), **unit: Any) -> None:
        self.records: list[Record] = []
        tables = {"dsp": {"image": str(public_image(name)), "modules": MODULES, "skip_polls": False, **unit}}
        case = Case.model_validate({"name": name, "duration": "10 s", "unit": tables})
        wanted = {Kind.FRAME, Kind.IRQ, *kinds}
        self.scene = Scene(case, lambda recorder, _: recorder.subscribe(wanted, self.records.append))
        self.dsp = self.scene.units["dsp"]
        assert isinstance(self.dsp.program, ImageProgram)
        self.program = self.dsp.program
        kernel, step = self.scene.kernel, self.scene.timebase.ticks(STEP)
        for _ in range(MOST):
            kernel.run_until(kernel.now + step)
            if self.program.instructions >= instructions:
                break

    def function(self) -> str:
        return str(self.program.place()).partition(" (")[0]

    def sent(self, wire: str = "TX") -> bytes:
        return bytes(one.value & 0xFF for one in self.records if (one.where, one.what) == (wire, "end"))

    def begins(self, wire: str = "TX") -> list[float]:
        """Return the start times of its characters in ms."""
        per_ms = self.scene.timebase.per_second / 1000
        return [one.tick / per_ms for one in self.records if (one.where, one.what) == (wire, "begin")]

    def written(self) -> list[tuple[str, int]]:
        """Return the register writes in order, as names and values."""
        return [(one.what.removeprefix("W "), one.value) for one in self.records if one.what.startswith("W ")]


BOOTS = {
    "S9a": ({}, 1_000_000),  # AS608: uses three serial ports
    "S9b": ({"boot": "ram", "stub": CAN}, 1_000_000),  # drone control, not optimised
    "S9c": ({"boot": "ram", "stub": CAN}, 1_000_000),  # the same program, optimised
    "S9d": ({"boot": "ram"}, 1_000_000),  # QP/C: IRET through stack frames that it creates
    "S9e": ({}, 400_000),  # runs in flash, with wait states
    "S9f": ({}, 1_000_000),  # I2C lab
    "S11": ({}, 1_000_000),  # compiler 22.6
    "S12a": ({"boot": "flash"}, 1_000_000),
    "S12b": ({"boot": "ram"}, 1_000_000),
    "S13": ({}, 400_000),  # SYS/BIOS
    "S14": ({"boot": "flash"}, 1_000_000),  # flash monitor
}


@pytest.mark.parametrize("name", BOOTS)
def test_a_program_boots_and_executes_no_illegal_instruction(name: str):
    unit, instructions = BOOTS[name]
    instructions *= 10 if explores() else 1
    ran = Ran(name, instructions, **unit)
    assert ran.program.instructions >= instructions
    assert ran.dsp.resets == 0  # the watchdog was disabled in time
    assert ran.dsp.clock.hz > 30_000_000  # and the PLL was set
    assert not ran.program.finished


def test_two_builds_of_a_program_differ_as_their_sources_do():
    """S9b and S9c: their wires are silent until they receive something. Bit rates and pins are of two versions."""
    last = []
    for name in ("S9b", "S9c"):
        ran = Ran(name, 1_400_000, [Kind.ACCESS], boot="ram", stub=CAN)
        assert ran.sent() == ran.sent("SCI-B.TX") == ran.sent("SCI-C.TX") == b""
        last.append(dict(ran.written()))
    debug, release = last
    assert (debug["SCI-B.SCILBAUD"], release["SCI-B.SCILBAUD"]) == (121, 243)
    assert {what: debug[what] for what in CLOCKS} == {what: release[what] for what in CLOCKS}


def test_qp_switches_tasks_through_stack_frames_that_it_creates():
    ran = Ran("S9d", 700_000, boot="ram")
    assert ran.sent() == b"\nStav Tx IDLE!!"
    assert abs(ran.begins()[0] - 4.476) < 0.05


def test_a_board_test_in_flash_prints_its_banner_on_sci_c():
    ran = Ran("S9e", 500_000)
    assert ran.sent("SCI-C.TX").startswith(b"\r\n" + b"*" * 40)


def test_a_sender_built_with_another_compiler():
    """S10 sends 0x73 every 5 ms."""
    ran = Ran("S10", 2_600_000)
    begins = ran.begins()
    assert set(ran.sent()) == {0x73}
    assert abs(begins[0] - 4.49) < 0.05
    assert [round(after - before, 1) for before, after in pairwise(begins)][:2] == [5.0, 5.0]


def test_one_program_linked_to_flash_and_to_ram_makes_the_same_accesses():
    """S12: registers are first written in the same order, except for those that only flash needs."""
    orders = []
    for name, boot in (("S12a", "flash"), ("S12b", "ram")):
        ran = Ran(name, 1_000_000, [Kind.ACCESS], boot=boot)
        orders.append([*dict.fromkeys(what for what, _ in ran.written())])
    both = set(orders[0]) & set(orders[1])
    assert len(both) > 40
    assert [what for what in orders[0] if what in both] == [what for what in orders[1] if what in both]


def test_sys_bios_ticks_have_a_constant_period():
    """S13: its clock tick is the interrupt of timer 1, and tasks are switched by IRET."""
    ran = Ran("S13", 400_000)
    ticks = [one.tick for one in ran.records if one.kind is Kind.IRQ and one.what == "INT13" and one.value]
    per_ms = ran.scene.timebase.per_second / 1000
    periods = [round((after - before) / per_ms, 2) for before, after in pairwise(ticks)]
    assert len(periods) > 3 and set(periods) == {periods[0]}


def test_the_monitor_waits_for_a_command_before_it_calls_the_flash_api():
    ran = Ran("S14", 500_000, boot="flash")
    assert ran.function() == "SCIa_RxChar"
