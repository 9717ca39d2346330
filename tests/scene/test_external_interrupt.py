"""From a pin edge through qualifier, XINT, PIE and CPU to the service routine, on a whole unit."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.f28335.cpu.compiled_code_costs import BARE
from periph_sim.processor.dsp import Dsp, DspPlan

CYCLE = 20  # ticks
WINDOW = {0: 0, 1: 2, 2: 5}  # QSEL -> qualification window in SYSCLKOUT cycles, QUALPRD = 0


@pytest.mark.rule("SYS-140", "SYS-079", "SYS-080", "SYS-121")
@pytest.mark.parametrize("qsel", [0, 1, 2])
@pytest.mark.parametrize("phase", [0, 1, 7, 19])
def test_a_pin_edge_reaches_the_vector_fetch_within_its_window_and_twelve_cycles(qsel, phase):
    kernel, recorder = Kernel(), Recorder()
    wire = Wire(kernel, "BUTTON", recorder)
    hand = wire.attach("hand")
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("GPIO", "XINT"), {7: wire}, code=BARE))
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
    kernel.call_at(edge, lambda: hand.drive(0))
    kernel.run_until(5000 * CYCLE)
    (first_instruction,) = entered
    vector_fetch = dsp.clock.tick(first_instruction - 9)
    assert 0 < vector_fetch - edge <= (WINDOW[qsel] + 12) * CYCLE


def heard(levels: list[tuple[int, int]], modules: tuple[str, ...], pin: int, setup: Callable[[Dsp], None]) -> int:
    """How often XINT1, on both edges of a pad that has these levels at these ticks, is served."""
    kernel, recorder = Kernel(), Recorder()
    wire = Wire(kernel, "PAD", recorder)
    hand = wire.attach("hand")
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", modules, {pin: wire}))
    served: list[int] = []

    def main() -> None:
        gpio, xint, pie = dsp.module("GPIO"), dsp.module("XINT"), dsp.module("PIE")
        dsp.eallow()
        setup(dsp)
        gpio.GPIOXINT1SEL.all = pin
        dsp.edis()
        xint.XINT1CR.all = 0b1101  # both edges, enabled
        dsp.handle("XINT1", lambda: served.append(dsp.cpu.cycle) or pie.PIEACK.__setattr__("all", 1))
        pie.PIECTRL.ENPIE = 1
        pie.PIEIER1.INTx4 = 1
        pie.PIEACK.all = 0xFFF
        dsp.enable_interrupt(1)
        dsp.eint()
        dsp.compute(10_000)

    dsp.start(main)
    for tick, level in levels:
        kernel.call_at(2000 * CYCLE + tick, partial(hand.drive, level))
    kernel.run_until(5000 * CYCLE)
    return len(served)


def to_sci(dsp: Dsp) -> None:
    gpio = dsp.module("GPIO")
    gpio.GPAMUX2.GPIO28 = 1
    gpio.GPAQSEL2.GPIO28 = 3


@pytest.mark.parametrize("setup", [lambda dsp: None, to_sci], ids=["synchronised", "asynchronous"])
def test_a_pin_of_the_sci_can_interrupt_as_well(setup):
    """A wake-up by the start bit, say: GPIOXINTnSEL takes the pad whatever the multiplexer makes of it."""
    assert heard([(0, 0), (40_000, 1)], ("GPIO", "XINT", "SCI-A"), 28, setup) == 2


@pytest.mark.parametrize("setup", [lambda dsp: None, to_sci], ids=["synchronised", "asynchronous"])
@pytest.mark.parametrize(
    ("rise", "seen"),
    [
        (19, 0),  # fell and rose between two SYSCLKOUT edges: no sample shows it
        (21, 1),  # two edges a cycle apart, one flag in PIEIFR
    ],
)
def test_a_pulse_between_two_sysclkout_edges_is_no_edge(setup, rise, seen):
    assert heard([(1, 0), (rise, 1)], ("GPIO", "XINT", "SCI-A"), 28, setup) == seen
