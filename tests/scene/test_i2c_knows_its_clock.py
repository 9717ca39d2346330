"""A unit tells its I2C module the SYSCLKOUT it has, at the start and when firmware changes it."""

from __future__ import annotations

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.processor.dsp import Dsp, DspPlan


def duties(oscclk_mhz: int, pll: int, ipsc: int, switch_to: int = 0) -> list[str]:
    """What is noted of I2C set up so. switch_to: PLLCR afterwards."""
    kernel, recorder = Kernel(), Recorder()
    plan = DspPlan("dsp", ("I2C-A",), {}, oscclk_hz=oscclk_mhz * 1_000_000, pll=pll)
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, plan)

    def main() -> None:
        i2c, sys = dsp.module("I2C-A"), dsp.module("SYS")
        dsp.eallow()
        sys.PCLKCR0.I2CAENCLK = 1
        dsp.compute(10)
        i2c.I2CPSC.all = ipsc
        i2c.I2CCLKL.all, i2c.I2CCLKH.all = 10, 5
        i2c.I2CMDR.IRS = 1
        if switch_to:
            sys.PLLSTS.DIVSEL = 0
            sys.PLLSTS.MCLKOFF = 1
            sys.PLLCR.DIV = switch_to

    dsp.start(main)
    kernel.run_until(300_000_000)
    return [note.text for _, note in dsp.socket("I2C-A").notes]


@pytest.mark.rule("I2C-155")
@pytest.mark.parametrize(
    ("oscclk_mhz", "pll", "ipsc", "told"),
    [
        (30, 10, 14, ""),
        (20, 10, 9, ""),
        (20, 10, 14, "6.66667 MHz at SYSCLKOUT = 100 MHz"),
        (30, 10, 9, "15 MHz at SYSCLKOUT = 150 MHz"),
    ],
)
def test_the_limits_count_from_the_units_own_clock(oscclk_mhz: int, pll: int, ipsc: int, told: str):
    expected = [f"I2CPSC = {ipsc} gives a module clock of {told}; expected 7 to 12 MHz"]
    assert duties(oscclk_mhz, pll, ipsc) == (expected if told else [])


@pytest.mark.rule("I2C-155")
def test_a_pll_that_is_set_anew_under_an_enabled_module_is_noticed():
    told = duties(30, 10, 14, switch_to=4)
    assert told and all("gives a module clock of" in text for text in told)
