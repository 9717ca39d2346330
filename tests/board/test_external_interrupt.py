"""From a pin edge through qualifier, XINT, PIE and CPU to the service routine, on a whole unit."""

from __future__ import annotations

import pytest

from periph_sim.board.dsp import Dsp, DspPlan
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire

CYCLE = 20  # ticks
WINDOW = {0: 0, 1: 2, 2: 5}  # QSEL -> qualification window in SYSCLKOUT cycles, QUALPRD = 0


@pytest.mark.rule("SYS-140", "SYS-079", "SYS-080", "SYS-121")
@pytest.mark.parametrize("qsel", [0, 1, 2])
@pytest.mark.parametrize("phase", [0, 1, 7, 19])
def test_a_pin_edge_reaches_the_vector_fetch_within_its_window_and_twelve_cycles(qsel, phase):
    kernel, recorder = Kernel(), Recorder()
    wire = Wire(kernel, "BUTTON", recorder)
    hand = wire.attach("hand")
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("GPIO", "XINT"), {7: wire}))
    entered: list[int] = []

    def main() -> None:
        gpio, xint, pie = dsp.module("GPIO"), dsp.module("XINT"), dsp.module("PIE")
        dsp.eallow()
        gpio.GPAQSEL1.GPIO7 = qsel
        gpio.GPIOXINT1SEL.all = 7
        dsp.edis()
        xint.XINT1CR.all = 1  # falling edge, enabled
        dsp.handle("XINT1", lambda: entered.append(dsp.cpu.cycle))
        pie.PIECTRL.ENPIE = 1
        pie.PIEIER1.INTx4 = 1
        pie.PIEACK.all = 0xFFF
        dsp.enable_interrupt(1)
        dsp.eint()
        dsp.compute(10_000)

    dsp.start(main)
    edge = 2000 * CYCLE + phase
    kernel.at(edge, lambda: hand.drive(0))
    kernel.run_until(5000 * CYCLE)
    (first_instruction,) = entered
    vector_fetch = dsp.clock.tick(first_instruction - 9)
    assert 0 < vector_fetch - edge <= (WINDOW[qsel] + 12) * CYCLE
