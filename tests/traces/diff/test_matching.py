"""Similarity of transfers, by common words, by addresses and by shape; groups of events of a capture."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.traces.decode.uart import Line
from periph_sim.traces.diff.matching import ENOUGH, i2c_groups, similar_runs, similarity, uart_groups
from tests.traces.decode.drawing import drawn, of_bytes
from tests.traces.diff.runs import group
from tests.traces.formats.writers import I2cWave, frame_bits, uart_wave

READ_68 = "START 0, address 68 R 1, ACK 2, byte 01 3, ACK 4, byte 02 5, NACK 6, STOP 7"


@pytest.mark.parametrize(
    ("other", "share"),
    [
        (READ_68, 1.0),
        (READ_68.replace("byte 02", "byte 03"), 7 / 8),
        ("START 0, address 68 R 1, NACK 2, STOP 3", 2 * 4 / 12),
        ("START 0, address 53 W 1, NACK 2, STOP 3", 2 * 3 / 12),
        ("START 0, address 53 W 1, ACK 2, byte 11 3, ACK 4, byte 22 5, ACK 6, byte 33 7, ACK 8", 2 * 3 / 17),
        ("START 0, address 68 R 1, ACK 2, byte 11 3", ENOUGH),  # the same address
        ("START 0, address 1E W 1, ACK 2, byte 11 3, ACK 4, byte 22 5, NACK 6, STOP 7", 5 / 8),
        ("STOP 0", 2 / 9),
    ],
)
def test_the_similarity_of_two_transfers(other, share):
    assert similarity(group(READ_68), group(other)) == pytest.approx(share)
    assert similarity(group(other), group(READ_68)) == pytest.approx(share)


def test_equal_shape_without_a_common_word_is_similar_enough():
    assert similarity([group("byte 41 0")[0]], [group("byte 42 0")[0]]) == ENOUGH
    assert similarity([group("byte 41 0")[0]], [group("STOP 0")[0]]) == 0


def test_the_pairing_with_the_highest_similarity_is_chosen():
    a = [group(READ_68), group(READ_68.replace("byte 01", "byte 77"))]
    b = [
        group(READ_68.replace("byte 01", "byte 77").replace("byte 02", "byte 78")),
        group("START 0, address 1E W 1, ACK 2"),
    ]
    assert [(run.a, run.b) for run in similar_runs(a, b)] == [(1, 0)]
    assert [(run.a, run.b) for run in similar_runs(b, a)] == [(0, 1)]
    assert [(run.a, run.b) for run in similar_runs(a, a)] == [(0, 0), (1, 1)]
    assert similar_runs(a, []) == similar_runs([], a) == []


def test_transfers_are_groups_of_words():
    capture = I2cWave(2, 1, idle=3).play("S A6+ 0F+ Sr A7- P S 101:").capture()
    first, second = i2c_groups(capture, "SCL", "SDA")
    assert [word for _, word, _ in first] == [
        *("START", "address 53 W", "ACK", "byte 0F", "ACK"),
        *("repeated START", "address 53 R", "NACK", "STOP"),
    ]
    assert [kind for kind, _, _ in first[:5]] == ["START", "address", "ACK", "byte", "ACK"]
    assert first[0][2] == 3
    assert [word for _, word, _ in second] == ["START", "cut byte 101"]


def test_bits_before_the_first_start_are_left_out():
    capture = drawn("""
    SCL __--__--__--__--------
    SDA --_________------___--
    """)
    assert [[event.word for event in group] for group in i2c_groups(capture, "SCL", "SDA")] == [["START", "STOP"]]


def test_frames_have_their_errors_and_breaks_are_events():
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
