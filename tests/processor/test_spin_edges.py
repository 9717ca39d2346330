"""Waits at their edges: with a write on its way, and how much of a wait is made for real."""

from __future__ import annotations

from dataclasses import replace

from periph_sim.f28335.cpu.compiled_code_costs import BARE
from periph_sim.f28335.system.options import SystemOptions
from tests.processor.bench import Bench


def test_a_write_on_its_way_lands_though_the_wait_behind_it_is_skipped():
    """A pass of 3 cycles, its read outside of the block; the write before it lands 4 cycles after its issue."""
    bench = Bench([(1, 4, -1)], options=SystemOptions(write_lands=4), code=replace(BARE, poll_pass=3))

    def main() -> None:
        bench.cpu.compute(10)
        bench.flags.STATUS.all = 4  # C, which a 1 clears
        bench.note(f"{bench.cpu.spin(lambda: bench.pie_regs.PIEIER1.INTx1, timeout=100)} C={bench.chip.status}")

    assert bench.run(main, 50) == []
    assert bench.chip.status == 0, "the wait still lasts"
