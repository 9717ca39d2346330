"""SPI-A in scenes: a master and a slave that are joined by cables exchange words."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from periph_sim import Dsp, Scene
from periph_sim.processor.python.register_view import ModulePort
from tests.scene.small import case, given, scene_with, unit

SENT = (0x1234, 0xFFFF, 0x8001)
CABLES = [{"from": f"left.SPI-A.{signal}", "to": f"right.SPI-A.{signal}"} for signal in ("SIMO", "SOMI", "CLK", "STE")]


def started(dsp: Dsp, control: int) -> ModulePort:
    """Start SPI-A with words of 16 bits at LSPCLK / 10. control: SPICTL."""
    dsp.eallow()
    dsp.module("SYS").PCLKCR0.SPIAENCLK = 1
    if dsp.has("GPIO"):
        gpio = dsp.module("GPIO")
        for pin in range(54, 58):
            setattr(gpio.GPBMUX2, f"GPIO{pin}", 1)
            setattr(gpio.GPBQSEL2, f"GPIO{pin}", 3)
    dsp.edis()
    spi = dsp.module("SPI-A")
    spi.SPICCR.all = 0x0F
    spi.SPICTL.all = control
    spi.SPIBRR.all = 9
    spi.SPICCR.all = 0x8F
    return spi


class Exchange:
    """Firmware of two units. by_master, by_slave: the words that each received."""

    def __init__(self) -> None:
        self.by_master: list[int] = []
        self.by_slave: list[int] = []

    def master(self, dsp: Dsp) -> None:
        spi = started(dsp, 0x06)  # MASTER_SLAVE, TALK
        for word in SENT:
            dsp.compute(3000)
            spi.SPITXBUF.all = word
            dsp.spin(lambda: spi.SPISTS.INT_FLAG == 1)
            self.by_master.append(spi.SPIRXBUF.all)

    def slave(self, dsp: Dsp) -> None:
        spi = started(dsp, 0x03)  # TALK, SPIINTENA
        pie = dsp.module("PIE")
        answers: Iterator[int] = iter((0xA5A5, 0x0001, 0xFFFE, 0))
        spi.SPITXBUF.all = next(answers)

        def on_word() -> None:
            self.by_slave.append(spi.SPIRXBUF.all)
            spi.SPITXBUF.all = next(answers)
            pie.PIEACK.all = 1 << 5

        dsp.handle("SPIRXINTA", on_word)
        pie.PIECTRL.ENPIE = 1
        pie.PIEIER6.INTx1 = 1
        dsp.enable_interrupt(6)
        dsp.eint()
        while True:
            dsp.cpu.idle()


@pytest.mark.parametrize("modules", [["SPI-A"], ["SPI-A", "GPIO"]], ids=["usual pins", "multiplexed pins"])
def test_a_master_and_a_slave_exchange_words(modules: list[str]) -> None:
    """A cable's wire has the name of its first end; a budget names the interrupt."""
    exchange = Exchange()
    programs = given(left=exchange.master, right=exchange.slave)
    budget = {"name": "a word is taken in time", "measure": "interrupt latency right: SPIRXINTA", "max": "1 us"}
    units = {name: unit(*modules) for name in programs}
    scene = Scene(case("1 ms", unit=units, cable=CABLES, budget=[budget]), programs=programs)
    result = scene.run()
    assert exchange.by_slave == [*SENT]
    assert exchange.by_master == [0xA5A5, 0x0001, 0xFFFE]
    assert [(one.passed, one.count) for one in result.budgets] == [(True, 3)]
    assert {"left.SPI-A.SIMO", "left.SPI-A.CLK"} <= set(scene.wires)


PINS = {"SPI-A.SIMO": 16, "SPI-A.SOMI": 17, "SPI-A.CLK": 18, "SPI-A.STE": 19}


@pytest.mark.parametrize("pins", [{}, PINS], ids=["usual pins", "named pins"])
def test_pins_without_a_wire_are_noted_with_the_keys_to_add(pins: dict[str, int]) -> None:
    def main(dsp: Dsp) -> None:
        gpio = dsp.module("GPIO")
        dsp.eallow()
        for pin in PINS.values():
            setattr(gpio.GPAMUX2, f"GPIO{pin}", 1)

    notes = scene_with(main, ["SPI-A", "GPIO"], {"pins": pins}, duration="1 ms").run().notes
    expected = (
        "dsp: SPI-A has SIMO on GPIO16 and SOMI on GPIO17 and CLK on GPIO18 and STE on GPIO19, where the case has no "
        'wire; add pins = { "SPI-A.SIMO" = 16, "SPI-A.SOMI" = 17, "SPI-A.CLK" = 18, "SPI-A.STE" = 19 } to the unit'
    )
    assert [note for note in notes if "no wire" in note] == ([] if pins else [expected])
