"""Two units whose clocks have no common cycle: each one's cycles are its own, to the tick, whoever is named first."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

FIRMWARE = """
def main(dsp, settings):
    dsp.compute(300, "work")
    dsp.compute(70)
    dsp.compute(300, "again")
    dsp.spin(lambda: False, timeout=100_000)
"""
QUICK = '[unit.quick]\nfirmware = "work.py"\nmodules = []\n'
SLOW = '[unit.slow]\nfirmware = "work.py"\nmodules = []\noscclk = "14 MHz"\npll = 7\n'


def scene(folder: Path, units: str, kept: list[Record] | None = None) -> Scene:
    (folder / "work.py").write_text(FIRMWARE)
    case = folder / "two.toml"
    case.write_text(f'name = "two"\nduration = "100 us"\n{units}')
    records = [] if kept is None else kept
    return Scene(load(case, []), lambda recorder, _: recorder.subscribe((Kind.SPAN,), records.append))


#            0      2.000   2.467   4.467 us
# quick      |‾work‾‾|_______|‾again‾‾|__      150 MHz: 300, 370, 670 cycles
# slow       |‾work‾‾‾‾‾‾|____________|‾again‾‾|   49 MHz: 6.122, 7.551, 13.673 us
@pytest.mark.parametrize("units", [QUICK + SLOW, SLOW + QUICK], ids=["quick first", "slow first"])
def test_each_unit_counts_its_own_cycles(tmp_path: Path, units: str):
    kept: list[Record] = []
    made = scene(tmp_path, units, kept)
    made.run()
    for unit, mhz in (("quick", 150), ("slow", 49)):
        ticks = [record.tick for record in kept if record.where == unit]
        assert [made.timebase.seconds(tick) * mhz * 10**6 for tick in ticks] == [0, 300, 370, 670], unit
    assert made.timebase.per_second % (150 * 10**6) == 0 and made.timebase.per_second % (49 * 10**6) == 0


def test_a_wait_says_since_when_in_the_time_of_its_own_clock(tmp_path: Path):
    made = scene(tmp_path, QUICK + SLOW)
    made.kernel.run_until(made.timebase.ticks(Fraction(20, 10**6)))
    since = {name: made.doing(dsp).rpartition(" ")[0].rpartition(" ")[2] for name, dsp in made.units.items()}
    assert since == {"quick": "4.467", "slow": "13.673"}
