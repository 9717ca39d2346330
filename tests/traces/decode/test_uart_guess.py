"""Guess of the settings of a line from its edges: confidence, alternatives, and lines that cannot be guessed."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from periph_sim.traces.capture.capture import Capture
from periph_sim.traces.decode.uart_guess import SHAPES, USUAL, Guess, guess
from periph_sim.traces.decode.uart_line import line_of
from tests.profiles import examples
from tests.traces.decode.drawing import drawn, of_bytes
from tests.traces.formats.writers import frame_bits, uart_wave

RATE = 4_000_000
TEXT = b"The quick brown fox jumps over the lazy dog, 0123456789 times\r\n"


def sent(baud: int, shape: str, values: bytes, pause: int = 3, invert: bool = False, rate: int = RATE) -> Capture:
    """A line with frames of one format, every fourth followed by a pause of `pause` bits."""
    line = line_of(str(baud), shape)
    width = Fraction(rate, baud)
    frames, begin = [], Fraction(20) + 12 * width
    for number, value in enumerate(values):
        frames.append((begin, frame_bits(value & (1 << line.bits) - 1, line.bits, line.parity, int(line.stop))))
        begin += (line.frame + (pause if number % 4 == 3 else 0)) * width
    samples = uart_wave(frames, width, int(begin + 12 * width))
    return of_bytes(bytes(1 - sample for sample in samples) if invert else samples, ("RX",), rate)


def settings_of(found: Guess) -> tuple[object, str, bool]:
    return found.line.baud, found.line.shape, found.line.invert


@pytest.mark.parametrize("baud", [300, 1200, 9600, 19200, 31250, 57600, 115200, 230400, 460800, 500000])
def test_usual_rates_are_guessed(baud: int):
    found = guess(sent(baud, "8n1", TEXT, rate=max(RATE // 20, 8 * baud)), "RX")
    assert settings_of(found) == (baud, "8n1", False)
    assert found.sure > 0.5 and found.errors == 0 and found.frames == len(TEXT)


def test_each_usual_rate_is_guessed_from_two_bytes():
    doubled = [300 << n for n in range(10)] + [14_400 << n for n in range(8)]
    slow = [50, 75, 110, 134, 150, 200, 1800, 7200]
    whole = [1_000_000 * n // 16 for n in (2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 56, 64, 96, 128, 192)]
    others = [31_250, 56_000, 74_880, 100_000, 345_600, 576_000]
    rates = sorted([*doubled, *slow, *whole, *others])
    assert rates == sorted(USUAL)
    for baud in rates:
        assert guess(sent(baud, "8n1", b"\x55\x0f", rate=8 * baud), "RX", "8n1", False).line.baud == baud


@pytest.mark.parametrize("shape", [*SHAPES[:-1], "8n2", "7e2"])
@pytest.mark.parametrize("invert", [False, True])
def test_usual_formats_and_both_polarities_are_guessed(shape: str, invert: bool):
    values = bytes(Random(8).sample(range(256), 80))
    found = guess(sent(115200, shape, values, invert=invert), "RX")
    assert settings_of(found) == (115200, f"{shape[:2]}1", invert)


@given(st.integers(0, 10**6), st.integers(-250, 250), st.integers(16, 200))
@example(17504, 250, 23)  # measured 0.5 % too fast on top of 2.5 %
@settings(max_examples=examples(40), deadline=None)
def test_the_rate_is_guessed_from_random_bytes_of_a_clock_that_is_off(seed: int, off: int, samples: int):
    values = Random(seed).randbytes(40)
    baud = 115200 * (10**4 + off) // 10**4  # up to 2.5 percent
    found = guess(sent(baud, "8n1", values, rate=115200 * samples), "RX")
    assert settings_of(found) == (115200, "8n1", False)
    assert found.measured == pytest.approx(baud, rel=0.01)


def test_an_unusual_rate_is_taken_from_the_edges():
    found = guess(sent(82_000, "8n1", TEXT), "RX")
    assert found.line.baud == pytest.approx(82_000, rel=0.01) and found.line.shape == "8n1"


def test_the_bit_time_follows_from_low_pulses_and_not_from_pauses_or_breaks():
    lows, highs = (10, 20, 10, 30, 112, 10, 20), (13, 17, 26, 14, 21, 19, 33)
    wave = "".join("_" * low + "-" * high for low, high in zip(lows, highs, strict=True))
    found = guess(drawn(f"RX ----{wave}"), "RX", "8n1", False)
    assert found.measured == 100_000


def test_the_bit_time_is_guessed_from_bytes_without_single_bits():
    found = guess(sent(115200, "8n1", bytes([0x1C, 0xC0, 0x38, 0x0C, 0x80, 0xE0]) * 4), "RX")
    assert settings_of(found) == (115200, "8n1", False)


@pytest.mark.parametrize(("samples", "values"), [("3.8", TEXT), ("4.1", bytes.fromhex("0e660e")), ("2.5", b"f\xccf")])
def test_the_rate_is_guessed_with_few_samples_per_bit(samples: str, values: bytes):
    found = guess(sent(9600, "8n1", values, rate=int(9600 * Fraction(samples))), "RX", "8n1", False)
    assert (found.line.baud, found.errors) == (9600, 0)


@pytest.mark.parametrize("invert", [False, True])
def test_of_two_possible_polarities_the_one_with_the_longer_idle_level_is_guessed(invert: bool):
    found = guess(sent(9600, "8n1", b"\x0f" * 20, pause=30, invert=invert), "RX")
    assert settings_of(found) == (9600, "8n1", invert)


def test_given_settings_are_not_guessed():
    found = guess(sent(9600, "7e1", TEXT), "RX", shape="8n1", invert=False)
    assert settings_of(found) == (9600, "8n1", False)


def test_with_few_different_bytes_the_parity_is_reported_as_uncertain():
    found = guess(sent(9600, "8n1", bytes([0x55, 0x33] * 20)), "RX")
    assert found.line.shape == "8n1" and "7e1" in found.also and found.sure <= 0.5
    assert "7e1" in str(found) and "would fit, too" in str(found)


def test_breaks_are_not_counted_as_errors():
    width = Fraction(RATE, 19200)
    frames, begin = [], Fraction(50)
    for header in range(6):
        frames.append((begin, [0] * 14))
        begin += 15 * width
        for value in (0x55, 0x10 + header, 0x77):
            frames.append((begin, frame_bits(value)))
            begin += 11 * width
        begin += 40 * width
    found = guess(of_bytes(uart_wave(frames, width, int(begin)), ("LIN",), RATE), "LIN")
    assert settings_of(found) == (19200, "8n1", False) and found.errors == 0


def test_a_line_without_pulses_or_a_rate_is_rejected():
    with pytest.raises(ValueError, match="RX has 0 edges and no pulse to guess a baud rate from; state it"):
        guess(drawn("RX --------"), "RX")
    with pytest.raises(ValueError, match="RX has 1 edge and no pulse"):
        guess(drawn("RX ----____"), "RX")
    with pytest.raises(
        ValueError, match="a guess of the baud rate needs a time base and the file states no rate; state the rate"
    ):
        guess(drawn("RX --__--__", rate=None), "RX")
