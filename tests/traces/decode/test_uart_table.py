"""The UART table against the reader of a wire, and the glitch filter."""

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
def test_the_reader_of_a_wire_gives_the_same_frames(
    sent: list[tuple[int, int]], spikes: list[int], form: UartFormat, width: int
):
    """Up to what it reads otherwise: a start bit that is over in its middle, and a fall in the middle of a stop bit."""
    begin, frames = Fraction(20), []
    for value, pause in sent:
        frames.append((begin, frame_bits(value & (1 << form.bits) - 1, form.bits, form.parity)))
        begin += form.length * width + pause
    samples = bytearray(uart_wave(frames, Fraction(width), int(begin) + 40))
    for spike in spikes:
        samples[1 + spike % (len(samples) - 1)] ^= 1
    capture = of_bytes(bytes(samples), ("RX",))
    found = uart.events(capture, "RX", Line(Fraction(10**6, width), form.bits, form.parity))
    heard = heard_on_wire(capture.channels[0], form, width)
    middle = (2 * form.length - 1) * width // 2
    falls = set(capture.channels[0].edges.tolist())
    until = min(
        (one.at for one in found if one.kind not in (UartRowKind.FRAME, UartRowKind.BREAK) or one.at + middle in falls),
        default=len(samples),
    )
    assert [(one.begin, one.value, one.good) for one in heard if one.begin < until] == [
        (one.at, one.value, not (one.parity_error or one.frame_error))
        for one in found
        if one.kind is UartRowKind.FRAME and one.at < until
    ]


def heard_on_wire(line: Channel, form: UartFormat, width: int) -> list[LineFrame]:
    """The frames of a line that is played on a wire, a sample a tick. The counter of characters has the same begins."""
    kernel = Kernel()
    wire = Wire(kernel, line.name, Recorder())
    pin, heard = wire.attach("sender"), []
    UartReader(wire, lambda: (Fraction(width), form)).on_end.append(heard.append)
    counter, begins = UartCounter(wire, lambda: (Fraction(width), form)), []
    counter.on_character.append(begins.append)
    for at, level in zip([0, *line.edges.tolist()], [line.initial, *line.levels.tolist()], strict=True):
        kernel.call_at(at, partial(pin.drive, level))
    kernel.run_until(kernel.now + 10**6)
    counter.finish(kernel.now)
    assert begins == [one.begin for one in heard]
    return heard


@given(
    st.lists(st.tuples(st.integers(0, 511), st.integers(0, 40)), min_size=1, max_size=8),
    st.sampled_from(PARITIES),
    st.integers(30, 200),
    st.integers(0, 2000),
    st.integers(5, 9),
)
@settings(max_examples=examples(40), deadline=None)
def test_frames_come_back_and_cut_anywhere_never_raise(
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
def test_frames_with_every_edge_a_little_off_come_back(sent: bytes, tenths: int, jitter: int, random: Random):
    """Two edges off by 12 percent each, and the samples they fall between, leave the middle of a bit alone."""
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
def test_time_stamps_are_read_as_the_samples_that_they_are_of(sent: bytes, tenths: int, tick: int, noise: int):
    """The same line as samples, and as ticks of a file of times: the same bytes, also with glitches."""
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
    step = sample_step(stamps)  # by chance of every second sample or so
    if step == tick:
        assert of_stamps.value.tolist() == of_samples.value.tolist()
        assert (of_stamps.at // tick).tolist() == of_samples.at.tolist()
    if not noise:
        assert of_stamps.value.tolist() == list(sent), "also where the edges lie on no finer raster than the bits"


@pytest.mark.parametrize("places", [(54,), (55,), (56,), (54, 55), (54, 56), (55, 56)])
def test_two_looks_of_three_outvote_the_third(places: tuple[int, ...]):
    """The third data bit of 4B is 0; it is looked at at samples 54, 55 and 56."""
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x4B))], Fraction(10), 200))
    for place in places:
        samples[place] ^= 1
    capture = of_bytes(bytes(samples), ("RX",))
    table = uart_table(capture, "RX", Line(100_000), vote=True)
    assert table.value.tolist() == [0x4F if len(places) == 2 else 0x4B]


def test_a_break_stands_behind_the_frame_it_also_makes():
    table = uart_table(of_bytes(uart_wave([(Fraction(20), [0] * 14)], Fraction(10), 300), ("RX",)), "RX", Line(100_000))
    assert [UartRowKind(kind).name for kind in table.kind.tolist()] == ["FRAME", "BREAK"]
    assert table.at.tolist() == [20, 20] and table.end.tolist() == [120, 160]
    assert table.frame_error.tolist() == [True, False] and table.value.tolist() == [0, -1]


@pytest.mark.parametrize(("length", "glitched"), [(1, True), (4, True), (5, False), (6, False)])
def test_what_is_shorter_than_half_a_bit_is_a_glitch(length: int, glitched: bool):
    """In a low bit of ten samples."""
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x00))], Fraction(10), 200))
    for place in range(length):
        samples[62 + place] ^= 1
    capture = of_bytes(bytes(samples), ("RX",))
    assert uart_table(capture, "RX", Line(100_000)).glitched.tolist() == [glitched]
    (frame,) = uart.events(capture, "RX", Line(100_000))
    assert frame.kind is UartRowKind.FRAME and frame.glitched == glitched


@pytest.mark.parametrize(("place", "unsure"), [(61, 0), (62, 1 << 4), (67, 1 << 4), (68, 1 << 4), (69, 0)])
def test_a_glitch_that_reaches_into_the_window_of_a_bit_makes_it_unsure(place: int, unsure: int):
    """Two samples long, in a low bit from sample 60 on whose window is samples 63 to 68."""
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x00))], Fraction(10), 200))
    samples[place : place + 2] = b"\x01\x01"
    capture = of_bytes(bytes(samples), ("RX",))
    table = uart_table(capture, "RX", Line(100_000))
    assert (table.glitched.tolist(), table.unsure.tolist()) == ([True], [unsure])


def test_a_glitch_in_a_frame_is_left_out():
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(0x4B))], Fraction(10), 200))
    samples[55] ^= 1  # in the middle of a bit
    samples[150] ^= 1
    assert uart_table(of_bytes(bytes(samples), ("RX",)), "RX", Line(100_000)).value.tolist() != [0x4B]
    assert uart_table(of_bytes(bytes(samples), ("RX",)), "RX", Line(100_000), glitch=2).value.tolist() == [0x4B]


def test_a_capture_without_a_rate_or_with_too_low_a_rate_is_refused():
    with pytest.raises(ValueError, match="frames need a time base and the file states no rate; state the rate"):
        uart_table(drawn("RX ----", rate=None), "RX", Line(9600))
    with pytest.raises(ValueError, match=r"0.00 samples a bit at 9600 baud; expected at least 2"):
        uart_table(drawn("RX ----", rate=1), "RX", Line(9600))
