"""Table of UART frames: agreement with the reader of a wire, random lines, and the glitch filter."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import ceil
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.bus.uart.reader import LineFrame, UartCounter, UartReader
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.wire import Wire
from periph_sim.traces.capture.capture import Channel
from periph_sim.traces.capture.sampling import sample_step
from periph_sim.traces.decode import uart
from periph_sim.traces.decode.table_columns import select
from periph_sim.traces.decode.uart import PARITIES, Line, UartRowKind, uart_table
from tests.profiles import examples
from tests.traces.decode.drawing import drawn, of_bytes
from tests.traces.formats.writers import frame_bits, uart_wave


@given(
    st.lists(st.tuples(st.integers(0, 255), st.integers(0, 30)), max_size=8),
    st.lists(st.integers(0, 3000), max_size=6),
    st.builds(UartFormat, st.integers(1, 8), st.sampled_from(["none", "even", "odd"])),
    st.integers(4, 30),
)
@settings(max_examples=examples(80), deadline=None)
def test_the_reader_of_a_wire_finds_the_same_frames(
    sent: list[tuple[int, int]], spikes: list[int], form: UartFormat, width: int
):
    """They agree up to the first start bit that ends before its middle or fall in the middle of a stop bit, which the
    reader treats differently.
    """
    begin, frames = Fraction(20), []
    for value, pause in sent:
        frames.append((begin, frame_bits(value & (1 << form.bits) - 1, form.bits, form.parity)))
        begin += form.length * width + pause
    samples = bytearray(uart_wave(frames, Fraction(width), int(begin) + 40))
    for spike in spikes:
        samples[1 + spike % (len(samples) - 1)] ^= 1
    capture = of_bytes(bytes(samples), ("RX",))
    found = uart.events(capture, "RX", Line(Fraction(10**6, width), form.bits, form.parity))
    of_reader = read_on_wire(capture.channels[0], form, width)
    middle = (2 * form.length - 1) * width // 2
    falls = set(capture.channels[0].edges.tolist())
    until = min(
        (one.at for one in found if one.kind not in (UartRowKind.FRAME, UartRowKind.BREAK) or one.at + middle in falls),
        default=len(samples),
    )
    assert [(one.begin, one.value, one.good) for one in of_reader if one.begin < until] == [
        (one.at, one.value, not (one.parity_error or one.frame_error))
        for one in found
        if one.kind is UartRowKind.FRAME and one.at < until
    ]


def read_on_wire(line: Channel, form: UartFormat, width: int) -> list[LineFrame]:
    """Frames that UartReader finds when the line is replayed on a wire, one sample per tick.

    The counter of characters must find the same begins.
    """
    kernel = Kernel()
    wire = Wire(kernel, line.name, Recorder())
    pin, of_reader = wire.attach("sender"), []
    UartReader(wire, lambda: (Fraction(width), form)).on_end.append(of_reader.append)
    counter, begins = UartCounter(wire, lambda: (Fraction(width), form)), []
    counter.on_character.append(begins.append)
    for at, level in zip([0, *line.edges.tolist()], [line.initial, *line.levels.tolist()], strict=True):
        kernel.call_at(at, partial(pin.drive, level))
    kernel.run_until(kernel.now + 10**6)
    counter.finish(kernel.now)
    assert begins == [one.begin for one in of_reader]
    return of_reader


@given(
    st.lists(st.tuples(st.integers(0, 511), st.integers(0, 40)), min_size=1, max_size=8),
    st.sampled_from(PARITIES),
    st.integers(30, 200),
    st.integers(0, 2000),
    st.integers(5, 9),
)
@settings(max_examples=examples(40), deadline=None)
def test_frames_are_decoded_and_a_capture_can_be_cut_anywhere(
    sent: list[tuple[int, int]], parity: str, tenths: int, kept: int, bits: int
):
    width = Fraction(tenths, 10)
    line = Line(Fraction(10**7, tenths), bits, parity)
    frames, begin = [], Fraction(20)
    for value, pause in sent:
        begin += pause
        frames.append((begin, frame_bits(value & (1 << bits) - 1, bits, parity)))
        begin += line.frame * width
    samples = uart_wave(frames, width, int(begin) + 40)
    table = uart_table(of_bytes(samples, ("RX",)), "RX", line)
    assert table.value.tolist() == [value & (1 << bits) - 1 for value, _ in sent]
    assert not table.parity_error.any() and not table.frame_error.any()
    part = of_bytes(samples[: kept + 1], ("RX",))
    whole = uart_table(part, "RX", line)
    whole = select(whole, whole.kind == UartRowKind.FRAME)
    assert all(a.tolist() == b[: len(a)].tolist() for a, b in zip(whole, table, strict=True))


@given(
    st.binary(min_size=1, max_size=12),
    st.integers(80, 400),
    st.integers(0, 12),
    st.randoms(use_true_random=False),
)
@settings(max_examples=examples(40), deadline=None)
def test_frames_with_jitter_on_every_edge_are_decoded(sent: bytes, tenths: int, jitter: int, random: Random):
    """Jitter of up to 12 percent and the sampling of edges do not reach the middle of a bit."""
    width = Fraction(tenths, 10)
    levels, at = [(Fraction(0), 1)], Fraction(30)
    for value in sent:
        for number, bit in enumerate(frame_bits(value)):
            levels.append((at + number * width + width * random.randint(-jitter, jitter) / 100, bit))
        at += (10 + random.randint(0, 3)) * width
    samples = bytearray([1]) * (int(at) + 30)
    for (begin, level), (end, _) in pairwise([*levels, (Fraction(len(samples)), 1)]):
        samples[ceil(begin) : ceil(end)] = bytes([level]) * (ceil(end) - ceil(begin))
    table = uart_table(of_bytes(bytes(samples), ("RX",)), "RX", Line(Fraction(10**7, tenths)))
    assert table.value.tolist() == list(sent) and not table.frame_error.any()


@given(st.binary(min_size=1, max_size=4), st.integers(20, 200), st.integers(1, 40), st.integers(0, 7))
@settings(max_examples=examples(40), deadline=None)
def test_time_stamps_are_decoded_like_the_samples_that_they_come_from(sent: bytes, tenths: int, tick: int, noise: int):
    """The same line as samples and as time stamps has the same bytes, even with glitches."""
    width = Fraction(tenths, 10)
    frames = [(Fraction(20) + 11 * width * n, frame_bits(value)) for n, value in enumerate(sent)]
    line = bytearray(uart_wave(frames, width, int(40 + 11 * width * len(sent))))
    for place in range(noise):
        line[(20 + 7 * place) % len(line)] ^= 1
    capture = of_bytes(bytes(line), ("RX",))
    wire = capture.channels[0]
    stretched = Channel("RX", 0, wire.initial, wire.edges * tick)
    stamps = replace(
        capture, rate=capture.rate * tick, length=capture.length * tick, channels=(stretched,), sampled=False
    )
    of_samples = uart_table(capture, "RX", Line(Fraction(10**7, tenths)))
    of_stamps = uart_table(stamps, "RX", Line(Fraction(10**7, tenths)))
    step = sample_step(stamps)  # larger than `tick` if, by chance, all edges are on a coarser grid
    if step == tick:
        assert of_stamps.value.tolist() == of_samples.value.tolist()
        assert (of_stamps.at // tick).tolist() == of_samples.at.tolist()
    if not noise:
        assert of_stamps.value.tolist() == list(sent), (
            "the bytes are correct even if the edges are on the grid of the bits"
        )


@pytest.mark.parametrize("places", [(54,), (55,), (56,), (54, 55), (54, 56), (55, 56)])
def test_two_of_three_samples_outvote_the_third(places: tuple[int, ...]):
    """The third data bit of 4B is 0. It is sampled at 54, 55 and 56."""
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x4B))], Fraction(10), 200))
    for place in places:
        samples[place] ^= 1
    capture = of_bytes(bytes(samples), ("RX",))
    table = uart_table(capture, "RX", Line(100_000), vote=True)
    assert table.value.tolist() == [0x4F if len(places) == 2 else 0x4B]


def test_a_break_follows_the_frame_that_it_also_is():
    table = uart_table(of_bytes(uart_wave([(Fraction(20), [0] * 14)], Fraction(10), 300), ("RX",)), "RX", Line(100_000))
    assert [UartRowKind(kind).name for kind in table.kind.tolist()] == ["FRAME", "BREAK"]
    assert table.at.tolist() == [20, 20] and table.end.tolist() == [120, 160]
    assert table.frame_error.tolist() == [True, False] and table.value.tolist() == [0, -1]


@pytest.mark.parametrize(("length", "glitched"), [(1, True), (4, True), (5, False), (6, False)])
def test_a_pulse_shorter_than_half_a_bit_is_a_glitch(length: int, glitched: bool):
    """The pulse is in a low bit of ten samples."""
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x00))], Fraction(10), 200))
    for place in range(length):
        samples[62 + place] ^= 1
    capture = of_bytes(bytes(samples), ("RX",))
    assert uart_table(capture, "RX", Line(100_000)).glitched.tolist() == [glitched]
    (frame,) = uart.events(capture, "RX", Line(100_000))
    assert frame.kind is UartRowKind.FRAME and frame.glitched == glitched


@pytest.mark.parametrize(("place", "unsure"), [(61, 0), (62, 1 << 4), (67, 1 << 4), (68, 1 << 4), (69, 0)])
def test_a_glitch_that_overlaps_the_window_of_a_bit_makes_it_unsure(place: int, unsure: int):
    """The glitch has two samples, in a low bit that begins at sample 60 and has its window at samples 63 to 68."""
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x00))], Fraction(10), 200))
    samples[place : place + 2] = b"\x01\x01"
    capture = of_bytes(bytes(samples), ("RX",))
    table = uart_table(capture, "RX", Line(100_000))
    assert (table.glitched.tolist(), table.unsure.tolist()) == ([True], [unsure])


def test_the_filter_removes_a_glitch_in_a_frame():
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x4B))], Fraction(10), 200))
    samples[55] ^= 1  # in the middle of a bit
    samples[150] ^= 1
    assert uart_table(of_bytes(bytes(samples), ("RX",)), "RX", Line(100_000)).value.tolist() != [0x4B]
    assert uart_table(of_bytes(bytes(samples), ("RX",)), "RX", Line(100_000), glitch=2).value.tolist() == [0x4B]


def test_a_capture_without_a_rate_or_with_too_low_a_rate_is_rejected():
    with pytest.raises(ValueError, match="frames need a time base and the file states no rate; state the rate"):
        uart_table(drawn("RX ----", rate=None), "RX", Line(9600))
    with pytest.raises(ValueError, match=r"0.00 samples a bit at 9600 baud; expected at least 2"):
        uart_table(drawn("RX ----", rate=1), "RX", Line(9600))
