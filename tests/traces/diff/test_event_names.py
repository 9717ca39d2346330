"""Captures as words: what can be compared of each event, and where it was."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.traces.decode.uart import Line
from periph_sim.traces.diff.event_names import i2c_groups, uart_groups
from tests.traces.decode.drawing import drawn, of_bytes
from tests.traces.formats.writers import I2cWave, frame_bits, uart_wave


def i2c(draw) -> list[list[tuple[str, str, int]]]:
    wave = I2cWave(2, 1, idle=3)
    draw(wave)
    return [[*map(tuple, group)] for group in i2c_groups(of_bytes(bytes(wave.samples), ("SCL", "SDA")), "SCL", "SDA")]


def test_transfers_are_groups_of_words():
    def draw(wave: I2cWave) -> None:
        wave.start()
        wave.byte(0xA6)
        wave.byte(0x0F)
        wave.again()
        wave.byte(0xA7, ack=False)
        wave.stop()
        wave.start()
        for bit in (1, 0, 1):
            wave.bit(bit)

    first, second = i2c(draw)
    assert [word for _, word, _ in first] == [
        *("START", "address 53 W", "ACK", "byte 0F", "ACK"),
        *("repeated START", "address 53 R", "NACK", "STOP"),
    ]
    assert [kind for kind, _, _ in first[:5]] == ["START", "address", "ACK", "byte", "ACK"]
    assert first[0][2] == 3
    assert [word for _, word, _ in second] == ["START", "cut byte 101"]


def test_what_comes_before_the_first_start_is_left_out():
    capture = drawn("""
    SCL __--__--__--__--------
    SDA --_________------___--
    """)
    assert [[event.word for event in group] for group in i2c_groups(capture, "SCL", "SDA")] == [["START", "STOP"]]


def test_frames_say_their_errors_and_breaks_are_events():
    width = Fraction(10)
    frames = [
        (Fraction(20), frame_bits(0x41, 8, "even")),
        (Fraction(200), [*frame_bits(0x42, 8, "odd")]),
        (Fraction(400), [0] * 15),
        (Fraction(600), frame_bits(0x43, 8, "even")[:5]),
    ]
    capture = of_bytes(uart_wave(frames, width, 650), ("RX",), 1_000_000)
    found = uart_groups(capture, "RX", Line(100_000, 8, "even"))
    words = [(event.kind, event.word, event.at) for (event,) in found]
    assert words[:4] == [
        ("frame", "41", 20),
        ("frame", "42 PE", 200),
        ("frame", "00 FE", 400),
        ("break", "break", 400),
    ]
    assert words[-1][0] == "cut frame"


def test_nine_bits_have_three_digits():
    capture = of_bytes(uart_wave([(Fraction(20), frame_bits(0x1A5, 9))], Fraction(10), 200), ("RX",), 1_000_000)
    assert [event.word for (event,) in uart_groups(capture, "RX", Line(100_000, 9))] == ["1A5"]
