"""Edges of the UART sender: each is at the exact rational time of its bit, rounded down to a tick."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.bus.uart.sender import UartSender
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire

NONE = Fraction(0)


class Line:
    """A UART sender on a wire.

    edges: (tick, level) of each edge; over: the tick at which each burst was reported as over
    """

    def __init__(self, bit: Fraction, frame: UartFormat | None = None, start: int = 0) -> None:
        self.kernel = Kernel(start)
        recorder = Recorder()
        self.frames: list[Record] = []
        recorder.subscribe([Kind.FRAME], self.frames.append)
        self.edges: list[tuple[int, int]] = []
        self.over: list[int] = []
        wire = Wire(self.kernel, "RX", recorder)
        watch([wire], lambda tick, level: self.edges.append((tick, level)))
        self.peer = UartSender(self.kernel, recorder, wire, bit, frame)

    def send(self, data: bytes, gap: Fraction = NONE) -> list[tuple[int, int]]:
        self.peer.send(data, gap, self.over.append)
        self.kernel.run_until(self.kernel.now + 30_000_000)
        return self.edges


def levels(edges: list[tuple[int, int]], bit: int, bits: int) -> str:
    """The level in the middle of each of `bits` bits, as a string of 0 and 1. `bit`: ticks of a bit."""
    shown, level, left = "", 1, list(edges)
    for n in range(bits):
        while left and left[0][0] <= n * bit + bit // 2:
            level = left.pop(0)[1]
        shown += str(level)
    return shown


def test_each_byte_is_recorded_as_an_unsigned_number() -> None:
    """In compiled code, the bytes of a typed `bytes` object would be signed from 128 on."""
    line = Line(Fraction(100))
    line.send(bytes([0, 127, 128, 0xE8, 255]))
    assert [record.value for record in line.frames] == [0, 127, 128, 0xE8, 255]


@pytest.mark.parametrize(
    ("frame", "byte", "wire"),
    [
        (UartFormat(), 0x55, "0 10101010 1"),
        (UartFormat(), 0x00, "0 00000000 1"),
        (UartFormat(), 0xFF, "0 11111111 1"),
        (UartFormat(), 0x81, "0 10000001 1"),
        (UartFormat(bits=7), 0x81, "0 1000000 1"),
        (UartFormat(parity="even"), 0x01, "0 10000000 1 1"),
        (UartFormat(parity="odd"), 0x01, "0 10000000 0 1"),
        (UartFormat(parity="even"), 0x03, "0 11000000 0 1"),
        (UartFormat(parity="odd"), 0x03, "0 11000000 1 1"),
        (UartFormat(bits=5, parity="even", stop=2), 0x1F, "0 11111 1 11"),
    ],
)
def test_a_frame_is_sent_least_significant_bit_first(frame: UartFormat, byte: int, wire: str):
    bits = wire.replace(" ", "")
    line = Line(Fraction(100), frame)
    assert levels(line.send(bytes([byte])), 100, len(bits)) == bits
    assert line.over == [100 * len(bits)]


def test_frames_follow_immediately_or_after_a_gap_in_bits():
    assert levels(Line(Fraction(100)).send(b"\x00\x00"), 100, 20) == "00000000010000000001"
    assert levels(Line(Fraction(100)).send(b"\x00\x00", Fraction(3)), 100, 23) == "0000000001" + "111" + "0000000001"
    assert Line(Fraction(100)).send(b"\x00\x00", Fraction(1, 3))[2] == (1033, 0)


@given(
    data=st.binary(min_size=1, max_size=12),
    bit=st.fractions(min_value=20, max_value=40_000, max_denominator=1_000_000),
    gap=st.fractions(min_value=0, max_value=20, max_denominator=16),
    start=st.integers(min_value=0, max_value=10**16),
)
def test_every_edge_is_at_the_exact_time_of_its_bit_at_any_rate(data: bytes, bit: Fraction, gap: Fraction, start: int):
    line = Line(bit, start=start)
    expected, level, at = [], 1, Fraction(0)
    for byte in data:
        for wanted in (0, *(byte >> i & 1 for i in range(8)), 1):
            if wanted != level:
                level = wanted
                expected.append((start + int(at * bit), level))
            at += 1
        at += gap
    assert line.send(data, gap) == expected
    assert line.over == [start + int((at - gap) * bit)]


def test_no_edge_drifts_in_a_long_burst():
    bit = Fraction(26_041, 1) + Fraction(2, 3)
    edges = Line(bit).send(b"\x55" * 36)
    assert edges[-1][0] == int((36 * 10 - 1) * bit)


def test_a_burst_is_busy_until_its_last_stop_bit_ends():
    line = Line(Fraction(100))
    line.peer.send(b"\xff", NONE, line.over.append)
    line.kernel.run_until(999)  # the last edge was at 100
    assert line.peer.busy
    with pytest.raises(ValueError, match="host: asked to send while a burst is still on the wire"):
        line.peer.send(b"\x00", NONE, line.over.append)
    line.kernel.run_until(1000)
    assert not line.peer.busy


def test_a_burst_without_bytes_is_over_at_once():
    line = Line(Fraction(100), start=7)
    assert line.send(b"") == [] and line.over == [7]


def test_each_byte_is_recorded_at_its_start_bit():
    line = Line(Fraction(100))
    line.send(b"\x12\x34", Fraction(2))
    assert [(r.tick, r.where, r.what, r.value) for r in line.frames] == [
        (0, "host", "byte", 0x12),
        (1200, "host", "byte", 0x34),
    ]
