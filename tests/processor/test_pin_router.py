"""Levels of pads that modules receive through the multiplexer and as external interrupts."""

from __future__ import annotations

from functools import partial

from periph_sim.processor.dsp import Dsp
from tests.processor.test_dsp import run, unit

CYCLE = 20  # ticks
FRAME = 3 * 8 * 8  # cycles of start, data and stop bit with BRR = 0 and LSPCLK = SYSCLKOUT / 4


def sci_on_gpio28(dsp: Dsp) -> None:
    """Make SCI-A receive characters of one data bit on GPIO28, without the GPIO's synchroniser."""
    clocks, gpio = dsp.module("SYS"), dsp.module("GPIO")
    clocks.PCLKCR0.SCIAENCLK = 1
    gpio.GPAQSEL2.GPIO28 = 3
    gpio.GPAMUX2.GPIO28 = 1
    dsp.compute(10)
    dsp.module("SCI-A").SCICTL1.all = 0x21


def test_a_pad_that_is_low_when_the_multiplexer_connects_it_to_the_sci_begins_a_start_bit():
    dsp, kernel, wires = unit("GPIO", "SCI-A", RXD=28)
    wires["RXD"].attach("hand").drive(0)
    cycles: list[int] = []

    def main() -> None:
        sci, gpio = dsp.module("SCI-A"), dsp.module("GPIO")
        dsp.eallow()
        sci_on_gpio28(dsp)
        gpio.GPAMUX2.GPIO28 = 0
        sci.SCICTL1.all = 0x01  # SW RESET discards anything received before
        dsp.compute(10)
        sci.SCICTL1.all = 0x21
        for _ in range(500):  # no other event occurs meanwhile
            _ = sci.SCICCR.all
        gpio.GPAMUX2.GPIO28 = 1
        cycles.append(dsp.cpu.cycle)
        dsp.spin(lambda: sci.SCIRXST.FE == 1)
        cycles.append(dsp.cpu.cycle)

    run(dsp, kernel, main)
    given, framed = cycles
    assert FRAME - 8 < framed - given < FRAME + 16  # FE is set in the last tick of the stop bit and read after it


def test_an_external_interrupt_enabled_after_the_edge_of_a_shared_pin_makes_no_request():
    dsp, kernel, wires = unit("GPIO", "SCI-A", "XINT", RXD=28)
    hand = wires["RXD"].attach("hand")
    kernel.call_at(kernel.now + 5000 * CYCLE, lambda: hand.drive(0))
    asked: list[int] = []

    def main() -> None:
        dsp.eallow()
        sci_on_gpio28(dsp)
        dsp.module("GPIO").GPIOXINT1SEL.all = 28
        dsp.module("PIE").PIECTRL.ENPIE = 1
        dsp.compute(10_000)
        dsp.module("XINT").XINT1CR.all = 1  # falling edge, enabled
        dsp.compute(100)
        asked.append(dsp.module("PIE").PIEIFR1.INTx4)

    run(dsp, kernel, main)
    assert asked == [0]


def test_a_pad_with_a_pull_down_is_low_again_when_the_sci_releases_it():
    dsp, kernel, wires = unit("GPIO", "SCI-A", low=frozenset({29}), TXD=29)
    levels: list[int] = []

    def main() -> None:
        dsp.eallow()
        for function in (0, 1, 0):
            dsp.module("GPIO").GPAMUX2.GPIO29 = function
            dsp.compute(100)
            levels.append(wires["TXD"].level)

    run(dsp, kernel, main)
    assert levels == [0, 1, 0]


def events(second: int) -> int:
    """Return the events of a run in which two pads fall 5 and `second` ticks after a SYSCLKOUT edge."""
    dsp, kernel, wires = unit("GPIO", "SCI-A", "XINT", RXD=28, BUTTON=7)
    for wire, tick in zip(wires.values(), (5, second), strict=True):
        kernel.call_at(kernel.now + 5000 * CYCLE + tick, partial(wire.attach("hand").drive, 0))

    def main() -> None:
        gpio = dsp.module("GPIO")
        dsp.eallow()
        gpio.GPAMUX2.GPIO28 = 1
        gpio.GPIOXINT1SEL.all = 7
        dsp.module("XINT").XINT1CR.all = 1
        dsp.compute(10_000)

    run(dsp, kernel, main)
    return kernel.events


def test_edges_between_the_same_two_sysclkout_edges_are_sampled_once():
    assert events(5) == events(9) == events(22) - 1
