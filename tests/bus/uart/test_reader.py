"""Records of a monitored UART line: the begin, the end and the byte of each frame."""

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


class MonitorRig:
    """A line, a sender and a monitor; the monitor can be set to another format than the sender."""

    def __init__(
        self, bit: Fraction = BIT, form: UartFormat | None = None, monitored_as: UartFormat | None = None
    ) -> None:
        self.records: list[Record] = []
        recorder = Recorder()
        recorder.subscribe([Kind.FRAME], self.records.append, {Kind.FRAME: {"RX"}})
        self.kernel = Kernel(0)
        self.wire = Wire(self.kernel, "RX", recorder)
        form = form or UartFormat()
        self.peer = UartSender(self.kernel, recorder, self.wire, bit, form)
        UartMonitor(self.wire, lambda: (bit, monitored_as or form))

    def sends(self, data: bytes, gap: int | Fraction = 0) -> list[tuple[int, str, int]]:
        self.kernel.call_at(50, lambda: self.peer.send(data, Fraction(gap), lambda tick: None))
        self.kernel.run_until(10**7)
        return [(record.tick, record.what, record.value) for record in self.records]


def test_begin_and_end_of_each_frame_are_recorded_with_its_byte():
    assert MonitorRig().sends(b"\x55\x00") == [
        (50, "begin", 0),
        (1050, "begin", 0),
        (1050, "end", 0x55),
        (2050, "end", 0x00),
    ] or MonitorRig().sends(b"\x55\x00") == [
        (50, "begin", 0),
        (1050, "end", 0x55),
        (1050, "begin", 0),
        (2050, "end", 0x00),
    ]


@given(
    st.binary(min_size=1, max_size=6),
    st.fractions(1, 60, max_denominator=7),
    st.integers(0, 3),
    st.sampled_from([UartFormat(), UartFormat(7, "even", 2), UartFormat(8, "odd"), UartFormat(5)]),
)
def test_the_monitor_reads_what_was_sent_in_any_format(data: bytes, bit: Fraction, gap: int, form: UartFormat):
    data = bytes(byte & (1 << form.bits) - 1 for byte in data)
    records = MonitorRig(bit * 10, form).sends(data, gap)
    assert [value for _, what, value in records if what == "end"] == [*data]
    length = 1 + form.bits + (form.parity != "none") + form.stop
    begins = [tick for tick, what, _ in records if what == "begin"]
    assert begins == [50 + int(n * (length + gap) * bit * 10) for n in range(len(data))]
    assert all(what != "error" for _, what, _ in records)


def test_a_wrong_parity_is_an_error_and_not_an_end():
    records = MonitorRig(form=UartFormat(8, "even"), monitored_as=UartFormat(8, "odd")).sends(b"\x03")
    assert [(what, value) for _, what, value in records] == [("begin", 0), ("error", 3)]


def test_a_break_is_recorded_as_one_error():
    rig = MonitorRig()
    pin = rig.wire.attach("test")
    rig.kernel.call_at(50, lambda: pin.drive(0))
    rig.kernel.call_at(5000, lambda: pin.drive(1))
    rig.kernel.run_until(10_000)
    assert [(r.tick, r.what, r.value) for r in rig.records] == [(50, "begin", 0), (1050, "error", 0)]


@pytest.mark.parametrize("early", [0, 30])
def test_an_early_start_bit_ends_the_frame_before_it(early: int):
    """The sender is slightly faster than the rate that the monitor is set to."""
    rig = MonitorRig()
    pin = rig.wire.attach("test")
    for start in (50, 1050 - early):
        rig.kernel.call_at(start, lambda: pin.drive(0))
        rig.kernel.call_at(start + 900, lambda: pin.drive(1))
    rig.kernel.run_until(10_000)
    ends = [(r.tick, r.value) for r in rig.records if r.what == "end"]
    assert ends == [(1050 - early, 0), (2050 - early, 0)]
