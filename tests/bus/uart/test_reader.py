"""What is said of a UART line: begin, end and byte of each frame, whoever sent it."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.bus.uart.reader import UartMonitor
from periph_sim.bus.uart.sender import UartSender
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.wire import Wire

BIT = Fraction(100)


class Desk:
    """A line, a sender and the monitor."""

    def __init__(self, bit: Fraction = BIT, form: UartFormat | None = None, heard_as: UartFormat | None = None) -> None:
        self.records: list[Record] = []
        recorder = Recorder()
        recorder.subscribe([Kind.FRAME], self.records.append, {Kind.FRAME: {"RX"}})
        self.kernel = Kernel(0)
        self.wire = Wire(self.kernel, "RX", recorder)
        form = form or UartFormat()
        self.peer = UartSender(self.kernel, recorder, self.wire, bit, form)
        UartMonitor(self.wire, lambda: (bit, heard_as or form))

    def sends(self, data: bytes, gap: int | Fraction = 0) -> list[tuple[int, str, int]]:
        self.kernel.call_at(50, lambda: self.peer.send(data, Fraction(gap), lambda tick: None))
        self.kernel.run_until(10**7)
        return [(record.tick, record.what, record.value) for record in self.records]


def test_begin_and_end_of_each_frame_with_what_it_carries():
    assert Desk().sends(b"\x55\x00") == [
        (50, "begin", 0),
        (1050, "begin", 0),
        (1050, "end", 0x55),
        (2050, "end", 0x00),
    ] or Desk().sends(b"\x55\x00") == [(50, "begin", 0), (1050, "end", 0x55), (1050, "begin", 0), (2050, "end", 0x00)]


@given(
    st.binary(min_size=1, max_size=6),
    st.fractions(1, 60, max_denominator=7),
    st.integers(0, 3),
    st.sampled_from([UartFormat(), UartFormat(7, "even", 2), UartFormat(8, "odd"), UartFormat(5)]),
)
def test_whatever_the_format_it_hears_what_was_sent(data: bytes, bit: Fraction, gap: int, form: UartFormat):
    data = bytes(byte & (1 << form.bits) - 1 for byte in data)
    said = Desk(bit * 10, form).sends(data, gap)
    assert [value for _, what, value in said if what == "end"] == [*data]
    length = 1 + form.bits + (form.parity != "none") + form.stop
    begins = [tick for tick, what, _ in said if what == "begin"]
    assert begins == [50 + int(n * (length + gap) * bit * 10) for n in range(len(data))]
    assert all(what != "error" for _, what, _ in said)


def test_a_wrong_parity_is_an_error_and_not_an_end():
    said = Desk(form=UartFormat(8, "even"), heard_as=UartFormat(8, "odd")).sends(b"\x03")
    assert [(what, value) for _, what, value in said] == [("begin", 0), ("error", 3)]


def test_a_break_is_one_error():
    desk = Desk()
    pin = desk.wire.attach("test")
    desk.kernel.call_at(50, lambda: pin.drive(0))
    desk.kernel.call_at(5000, lambda: pin.drive(1))
    desk.kernel.run_until(10_000)
    assert [(r.tick, r.what, r.value) for r in desk.records] == [(50, "begin", 0), (1050, "error", 0)]


@pytest.mark.parametrize("early", [0, 30])
def test_the_next_start_bit_ends_a_frame_that_it_comes_before_the_end_of(early: int):
    """A sender a little faster than it is thought to be."""
    desk = Desk()
    pin = desk.wire.attach("test")
    for start in (50, 1050 - early):
        desk.kernel.call_at(start, lambda: pin.drive(0))
        desk.kernel.call_at(start + 900, lambda: pin.drive(1))
    desk.kernel.run_until(10_000)
    ends = [(r.tick, r.value) for r in desk.records if r.what == "end"]
    assert ends == [(1050 - early, 0), (2050 - early, 0)]
