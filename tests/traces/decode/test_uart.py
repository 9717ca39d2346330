"""Decoder of UART frames: every option, and every error of a line."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces.decode import uart
from periph_sim.traces.decode.uart import Event, Line, UartRowKind
from tests.profiles import examples
from tests.refusals import refusal
from tests.traces.decode.drawing import drawn, of_bytes
from tests.traces.formats.writers import frame_bits, uart_wave

MEGA = Line(baud=100_000)  # ten samples per bit in a drawing


def seen(bits: list[int], line: Line, width: Fraction | int = 10, tail: int = 40) -> list[Event]:
    width = Fraction(width)
    samples = uart_wave([(Fraction(20), bits)], width, 20 + int(len(bits) * width) + tail)
    return uart.events(of_bytes(samples, ("RX",), round(line.baud * width)), "RX", line)


def framed(at: int, end: int, value: int, *faults: int, bits: int = 8) -> Event:
    """A frame event. faults: parity error, frame error, glitched, unsure."""
    return Event(UartRowKind.FRAME, at, end, value, bits, *faults)


def broken(at: int, end: int) -> Event:
    return Event(UartRowKind.BREAK, at, end)


def cut(at: int, end: int, bits: tuple[int, ...]) -> Event:
    return Event(UartRowKind.CUT, at, end, sum(bit << place for place, bit in enumerate(bits)), len(bits))


def test_one_frame():
    assert seen(frame_bits(0x4B), MEGA) == [framed(20, 120, 0x4B)]


@pytest.mark.parametrize("parity", uart.PARITIES)
@pytest.mark.parametrize("bits", [5, 7, 8, 9])
@pytest.mark.parametrize("stop", [1, 2])
def test_every_frame_format(parity: str, bits: int, stop: int):
    line = Line(100_000, bits, parity, stop)
    value = 0x155 & (1 << bits) - 1
    end = 20 + 10 * (1 + bits + (parity != "none") + stop)
    assert seen(frame_bits(value, bits, parity, stop), line) == [framed(20, end, value, bits=bits)]


@pytest.mark.parametrize(("bits", "value"), [(1, 1), (16, 0xA5C3)])
def test_the_shortest_and_the_longest_frame(bits: int, value: int):
    end = 20 + 10 * (1 + bits + 1)
    assert seen(frame_bits(value, bits), Line(100_000, bits)) == [framed(20, end, value, bits=bits)]


@pytest.mark.parametrize(("sent", "expected"), [("even", "odd"), ("odd", "even"), ("mark", "space"), ("space", "mark")])
def test_the_wrong_parity_is_an_error(sent: str, expected: str):
    (frame,) = seen(frame_bits(0x31, 8, sent), Line(100_000, 8, expected))
    assert frame == framed(20, 130, 0x31, True, False)


def test_a_low_stop_bit_is_a_frame_error():
    assert seen([*frame_bits(0xF0)[:-1], 0], MEGA) == [framed(20, 120, 0xF0, False, True)]


def test_a_low_phase_as_long_as_a_frame_is_also_a_break():
    assert seen([0] * 10, MEGA) == [framed(20, 120, 0, False, True), broken(20, 120)]
    assert seen([0] * 14, MEGA) == [framed(20, 120, 0, False, True), broken(20, 160)]
    assert seen([0] * 9, MEGA) == [framed(20, 120, 0)]


def test_a_break_without_an_end_in_the_capture_is_not_reported():
    assert seen([0] * 30, MEGA, tail=0) == [framed(20, 120, 0, False, True)]


def test_a_low_glitch_shorter_than_half_a_bit_is_a_rejected_start():
    samples = bytearray([1]) * 300
    samples[30:34] = bytes(4)
    wave = uart_wave([(Fraction(60), frame_bits(0x99))], Fraction(10), 300)
    both = bytes(a & b for a, b in zip(samples, wave, strict=True))
    assert uart.events(of_bytes(both, ("RX",)), "RX", MEGA) == [
        Event(UartRowKind.REJECTED, 30, 34),
        framed(60, 160, 0x99),
    ]


def glitched(*places: int, value: int = 0x4B, vote: bool = False) -> list[Event]:
    """Events of a frame with ten samples per bit from sample 20, with single samples inverted."""
    samples = bytearray(uart_wave([(Fraction(20), frame_bits(value))], Fraction(10), 200))
    for place in places:
        samples[place] ^= 1
    return uart.events(of_bytes(bytes(samples), ("RX",)), "RX", MEGA, vote)


@pytest.mark.parametrize("place", range(21, 114))
def test_a_glitch_in_the_window_where_receivers_sample_makes_the_bit_unsure(place: int):
    r"""The windows of the bits:

    bit                0         1         2
        ----__________----------__________...
             \ ^^^^^^^  ..^^^^^^.  ..^^^^^^.     ^ in the window, . outside of it
    """
    if place % 10 in (9, 0):  # next to an edge of the frame, it only moves the edge
        return
    (frame,) = glitched(place, vote=True)
    bit, within = divmod(place - 20, 10)
    inside = within <= 8 if bit == 0 else 3 <= within <= 8
    assert frame == framed(20, 120, 0x4B, False, False, True, 1 << bit if inside else 0)


def test_a_glitch_in_the_middle_of_a_bit_changes_one_sample_but_not_a_vote_of_three():
    """4B has the bits 1 1 0 1 0 0 1 0. The third one is sampled at 55."""
    assert glitched(55) == [framed(20, 120, 0x4F, False, False, True, 1 << 3)]
    assert glitched(55, vote=True) == [framed(20, 120, 0x4B, False, False, True, 1 << 3)]
    assert glitched(54, 55, vote=True) == [framed(20, 120, 0x4F, False, False, True, 1 << 3)], "two of three samples"


def test_glitches_in_the_start_bit_make_it_unsure_and_a_vote_can_reject_it():
    (frame,) = glitched(22, 27)
    assert frame.kind is UartRowKind.FRAME and (frame.value, frame.unsure) == (0x4B, 1)
    rejected, *_ = glitched(24, 26, vote=True)
    assert rejected == Event(UartRowKind.REJECTED, 20, 24), "the first and the last of the three samples are high"


def test_a_pulse_of_half_a_bit_is_not_a_glitch():
    (frame,) = glitched(50, 51, 52, 53, 54)
    assert frame == framed(20, 120, 0x4B)


def test_a_line_that_starts_low_waits_for_its_first_falling_edge():
    samples = bytes(35) + uart_wave([(Fraction(20), frame_bits(0x12))], Fraction(10), 200)
    assert uart.events(of_bytes(samples, ("RX",)), "RX", MEGA) == [framed(55, 155, 0x12)]


def test_a_line_that_rises_once_has_no_frames():
    assert uart.events(drawn("RX " + "_" * 120 + "-" * 20), "RX", MEGA) == []


def test_consecutive_frames_and_a_sender_five_percent_fast():
    for width in (Fraction(10), Fraction(96, 10)):
        frames = [(20 + 10 * width * n, frame_bits(byte)) for n, byte in enumerate(b"U\x00\xff3")]
        samples = uart_wave(frames, width, 500)
        found = uart.events(of_bytes(samples, ("RX",)), "RX", MEGA)
        assert [frame.value for frame in found if frame.kind is UartRowKind.FRAME] == list(b"U\x00\xff3")


@pytest.mark.parametrize("kept", [1, 4, 6, 25, 94])
def test_a_frame_cut_by_the_end_of_the_capture_has_its_bits(kept: int):
    samples = uart_wave([(Fraction(20), frame_bits(0b1100101))], Fraction(10), 20 + kept)
    bits = (1, 0, 1, 0, 0, 1, 1, 0)[: max(0, (kept - 6) // 10)]
    assert uart.events(of_bytes(samples, ("RX",)), "RX", MEGA) == [cut(20, 20 + kept, bits)]


def test_an_unknown_span_cuts_a_frame_and_later_frames_are_decoded():
    wave = uart_wave([(Fraction(20), frame_bits(0x4B)), (Fraction(300), frame_bits(0x21))], Fraction(10), 450)
    marks = "".join("_-"[level] for level in wave)
    holed = drawn(f"RX {marks[:70]}{'?' * 100}{marks[170:]}")
    assert uart.events(holed, "RX", MEGA) == [cut(20, 70, (1, 1, 0, 1)), framed(300, 400, 0x21)]


def test_an_inverted_line():
    samples = uart_wave([(Fraction(20), frame_bits(0x4B)), (Fraction(160), [0] * 12)], Fraction(10), 400)
    turned = bytes(1 - level for level in samples)
    found = uart.events(of_bytes(turned, ("RX",)), "RX", Line(100_000, invert=True))
    assert found == [framed(20, 120, 0x4B), framed(160, 260, 0, False, True), broken(160, 280)]


@given(st.integers(0, 255), st.integers(30, 2000), st.integers(0, 99))
@settings(max_examples=examples(40), deadline=None)
def test_any_byte_is_decoded_at_any_phase_with_three_or_more_samples_per_bit(value: int, tenths: int, phase: int):
    width = Fraction(tenths, 10)
    begin = 20 + Fraction(phase, 100)
    samples = uart_wave([(begin, frame_bits(value))], width, 40 + int(11 * width))
    found = uart.events(of_bytes(samples, ("RX",), tenths * 1000), "RX", Line(10_000))
    assert [(f.value, f.frame_error) for f in found if f.kind is UartRowKind.FRAME] == [(value, False)]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"baud": 0}, "baud is 0; expected more than 0"),
        ({"baud": 9600, "bits": 0}, "0 data bits; expected 1 to 16"),
        ({"baud": 9600, "bits": 17}, "17 data bits; expected 1 to 16"),
        ({"baud": 9600, "parity": "evn"}, "parity 'evn'; did you mean even?"),
        ({"baud": 9600, "stop": 3}, "3 stop bits; expected 1, 3/2 or 2"),
    ],
)
def test_invalid_options_are_rejected(options: dict[str, Any], message: str):
    assert refusal(ValueError, Line, **options) == message
