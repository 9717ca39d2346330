"""Observers of an SCI's lines have no effect on them."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim import Dsp, Firmware, make_case
from periph_sim.firmware import start_sci
from periph_sim.outside import Change, Session
from periph_sim.scene.uart_lines import line_of
from periph_sim.scene.uart_side import UartSide
from periph_sim.traces.decode.uart_line import Line
from tests.scene import small

LINES = ("RX", "TX")
CYCLE = 20  # ticks


def echo(dsp: Any, settings: Any) -> None:
    """Send back each character, plus one."""
    sci = start_sci(dsp, "SCI-A", 0, 7, fifo=False)  # a bit of 64 cycles at 2.34 MBd
    while True:
        dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
        word = sci.SCIRXBUF.RXDT
        dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
        sci.SCITXBUF.all = word + 1 & 0xFF


def changes_of_tx(phase: int) -> list[Change]:
    """Return the changes of TX if twelve characters begin `phase` cycles late."""
    case = make_case(name="echo", duration="1 ms", unit={"dsp": {"firmware": "echo", "modules": ["SCI-A"]}})
    session = Session(case, LINES, programs={"dsp": Firmware("echo", echo, None)})
    line = session.serial("scia", 2_343_750)
    found = session.advance(session.ticks("20 us") + phase * CYCLE)
    line.write(bytes(range(0x50, 0x5C)))
    found += session.advance(session.ticks("120 us"))
    return [change for change in found if change.line == "TX"]


def test_counting_characters_changes_no_edge(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rate is read at a start bit, possibly in the cycle in which the SCI begins to send."""
    counted = [changes_of_tx(phase) for phase in range(64)]
    monkeypatch.setattr(UartSide, "count", lambda side, wires: None)
    assert counted == [changes_of_tx(phase) for phase in range(64)]
    assert all(len(changes) > 60 for changes in counted)


@pytest.mark.parametrize(
    ("sciccr", "brr", "line"),
    [
        (0x07, 40, Line(Fraction(37_500_000, 8 * 41), 8, "none", 1)),
        (0x67, 40, Line(Fraction(37_500_000, 8 * 41), 8, "even", 1)),
        (0xA6, 0x1F4, Line(Fraction(37_500_000, 8 * 501), 7, "odd", 2)),
        (0x00, 0, Line(Fraction(37_500_000, 16), 1, "none", 1)),  # with BRR = 0 a bit has 16 cycles
    ],
)
def test_the_rate_and_format_of_an_sci(sciccr: int, brr: int, line: Line) -> None:
    def main(dsp: Dsp) -> None:
        sci = start_sci(dsp, "SCI-A")
        sci.SCICCR.all, sci.SCIHBAUD.all, sci.SCILBAUD.all = sciccr, brr >> 8, brr & 0xFF
        dsp.compute(1000)

    scene = small.scene_with(main, ["SCI-A"])
    scene.run()
    assert line_of(scene.units["dsp"]) == line
