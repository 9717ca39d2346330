"""The time from a write of I2CDXR to the release of SCL: the copy, SDA's set-up time and the output pin.

write |-- copy: a module clock, 0 with BCM --|-- set-up: module clocks, at least a cycle --|-- pin: cycles --| SCL
"""

from __future__ import annotations

import pytest

from periph_sim.processor.dsp import Dsp
from tests.scene import small

CYCLE = 20  # ticks


@pytest.mark.parametrize(
    ("prescaler", "bcm", "setup", "pin", "cycles"),
    [
        (9, 0, 1, 1, 10 + 10 + 1),
        (9, 1, 1, 1, 0 + 10 + 1),
        (9, 1, 3, 1, 0 + 30 + 1),
        (9, 1, 0, 1, 0 + 1 + 1),
        (0, 0, 1, 1, 1 + 1 + 1),
        (0, 1, 1, 0, 0 + 1 + 0),
        (0, 1, 2, 2, 0 + 2 + 2),
        (14, 0, 0, 0, 15 + 1 + 0),
    ],
)
def test_the_time_to_the_release_of_scl(prescaler: int, bcm: int, setup: int, pin: int, cycles: int):
    def main(dsp: Dsp) -> None:
        dsp.eallow()
        dsp.module("SYS").PCLKCR0.I2CAENCLK = 1
        i2c = dsp.module("I2C-A")
        i2c.I2CPSC.IPSC = prescaler
        i2c.I2CEMDR.BCM = bcm
        dsp.compute(1000)

    options = {"i2c": {"sda_setup_before_scl_release": setup}, "system": {"gpio_out_delay": pin}}
    scene = small.scene_with(main, ["I2C-A"], {"options": options})
    scene.run()
    delay = scene.measured.i2c_release_delay("dsp")
    chip = scene.units["dsp"].sockets["I2C-A"].chip
    depended = set(chip.touched)
    assert delay(scene.kernel.now) == cycles * CYCLE
    assert chip.touched == depended


def test_reading_the_delay_touches_no_open_question():
    def main(dsp: Dsp) -> None:
        dsp.compute(1000)

    scene = small.scene_with(main, ["I2C-A"])
    scene.run()
    assert scene.measured.i2c_release_delay("dsp")(scene.kernel.now) > 0
    assert not scene.units["dsp"].sockets["I2C-A"].chip.touched
