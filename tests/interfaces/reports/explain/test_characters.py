"""Characters and their bits, compared with the levels from which the line is built.

tick 100   110                        bits of 10 ticks
S 1 0 1 0 0 0 0 P T T                 7 data bits, even parity, 2 stop bits
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.core.records import Kind, Record
from periph_sim.interfaces.reports.explain.characters import Character, characters
from periph_sim.interfaces.reports.explain.picture import svg_picture
from periph_sim.interfaces.reports.html.timeline import Lanes
from periph_sim.traces.capture.capture import Span, channel_of

from .made import drawn

FORM = UartFormat(7, "even", 2)
BIT = 10
WIRE = "SCI-B.TX"


def character(what: str = "end", end: int = 100 + BIT * FORM.length, expected: int | None = None) -> Character:
    """Return the character 0x05 on a line."""
    window = drawn("span model 0 240", end=240, kept=(Span(0, 250),))
    line = channel_of(WIRE, 0, [99, *range(100, 210, BIT)], [1, *FORM.levels(5)], 250)
    frame = [Record(n, t, Kind.FRAME, WIRE, s, 5, "", 0) for n, t, s in ((8, 100, "begin"), (9, end, what))]
    window = replace(
        window,
        records=(*window.records, *frame),
        edges=replace(window.edges, channels=(line,)),
        formats={WIRE: (Fraction(BIT), FORM)},
        expected={} if expected is None else {(WIRE, 100, 0): expected},
    )
    assert (f">{WIRE} bits<" in svg_picture(window)) == bool(characters(window)[0].bits)
    (found,) = characters(window)
    drawn_lanes = dict(Lanes(window, {"dsp": 1.0}, 100).timeline().groups)["UART"]
    assert [one.name for one in drawn_lanes] == [WIRE, f"{WIRE} bytes", *[f"{WIRE} bits"] * bool(found.bits)]
    assert any(drawn_lanes[1].strong) == (found.error or expected is not None)
    return found


def test_a_character_is_divided_at_the_ends_of_its_bits() -> None:
    found = character()
    assert [text for _, _, text in found.bits] == [*"S1010000PTT"]
    assert [(begin, end) for begin, end, _ in found.bits] == [(at, at + BIT) for at in range(100, 210, BIT)]
    assert [*found.parts()] == [(100, 110, "S"), (110, 180, "0x05"), *found.bits[8:]]


def test_a_character_of_another_length_is_not_divided() -> None:
    """Its format differs from that at the end of the run. The next start bit may end a frame half a bit early."""
    found = character(end=200)
    assert (found.bits, [*found.parts()]) == ((), [(100, 200, "0x05")])
    assert len(character(end=205).bits) == FORM.length


@pytest.mark.parametrize(("what", "expected", "text"), [("error", None, "0x05"), ("end", 7, "0x05 not 0x07")])
def test_a_wrong_character_has_the_expected_value(what: str, expected: int | None, text: str) -> None:
    found = character(what, expected=expected)
    assert (found.text, found.error) == (text, what == "error")
