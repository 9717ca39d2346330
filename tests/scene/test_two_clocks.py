"""Clocks of units: two units without a common cycle keep their own, and an I2C module uses its unit's SYSCLKOUT."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim import Dsp, Scene, load
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.processor.dsp import DspPlan
from tests.scene.runs import recorded

FIRMWARE = """
def main(dsp, settings):
    dsp.compute(300, "work")
    dsp.compute(70)
    dsp.compute(300, "again")
    dsp.spin(lambda: False, timeout=100_000)
"""
QUICK = '[unit.quick]\nfirmware = "work.py"\nmodules = []\n'
SLOW = '[unit.slow]\nfirmware = "work.py"\nmodules = []\noscclk = "14 MHz"\npll = 7\n'


def scene(folder: Path, units: str) -> tuple[Scene, list[Record]]:
    (folder / "work.py").write_text(FIRMWARE)
    case = folder / "two.toml"
    case.write_text(f'name = "two"\nduration = "100 us"\n{units}')
    return recorded(load(case), (Kind.SPAN,))


#            0      2.000   2.467   4.467 us
# quick      |‾work‾‾|_______|‾again‾‾|__      150 MHz: 300, 370, 670 cycles
# slow       |‾work‾‾‾‾‾‾|____________|‾again‾‾|   49 MHz: 6.122, 7.551, 13.673 us
@pytest.mark.parametrize("units", [QUICK + SLOW, SLOW + QUICK], ids=["quick first", "slow first"])
def test_each_unit_counts_its_own_cycles(tmp_path: Path, units: str):
    made, kept = scene(tmp_path, units)
    made.run()
    for unit, mhz in (("quick", 150), ("slow", 49)):
        ticks = [record.tick for record in kept if record.where == unit]
        assert [made.timebase.seconds(tick) * mhz * 10**6 for tick in ticks] == [0, 300, 370, 670], unit
    assert made.timebase.per_second % (150 * 10**6) == 0 and made.timebase.per_second % (49 * 10**6) == 0


def test_the_start_of_a_wait_is_shown_by_the_units_own_clock(tmp_path: Path):
    made, _ = scene(tmp_path, QUICK + SLOW)
    made.kernel.run_until(made.timebase.ticks(Fraction(20, 10**6)))
    since = {name: made.doing(dsp).rpartition(" ")[0].rpartition(" ")[2] for name, dsp in made.units.items()}
    assert since == {"quick": "4.467", "slow": "13.673"}


def duties(oscclk_mhz: int, pll: int, ipsc: int, switch_to: int = 0) -> list[str]:
    """Return the notes on I2C with this set-up. switch_to: the value of PLLCR that is written afterwards."""
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
    return [note.text for _, note in dsp.sockets["I2C-A"].notes]


@pytest.mark.rule("I2C-155")
@pytest.mark.parametrize(
    ("oscclk_mhz", "pll", "ipsc", "found"),
    [
        (30, 10, 14, ""),
        (20, 10, 9, ""),
        (20, 10, 14, "6.66667 MHz at SYSCLKOUT = 100 MHz"),
        (30, 10, 9, "15 MHz at SYSCLKOUT = 150 MHz"),
    ],
)
def test_the_limits_depend_on_the_units_own_clock(oscclk_mhz: int, pll: int, ipsc: int, found: str):
    expected = [f"I2CPSC = {ipsc} gives a module clock of {found}; expected 7 to 12 MHz"]
    assert duties(oscclk_mhz, pll, ipsc) == (expected if found else [])


@pytest.mark.rule("I2C-155")
def test_a_change_of_the_pll_with_an_enabled_module_is_noted():
    found = duties(30, 10, 14, switch_to=4)
    assert found and all("gives a module clock of" in text for text in found)
