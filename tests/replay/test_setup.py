"""Properties of a capture's bus: usual low and high times of SCL, stretches, and the allowed length."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.core.input_error import InputError
from periph_sim.replay import BadReplay
from periph_sim.replay.session import SessionReplay
from periph_sim.replay.setup import Played, check_length, events_of, played, rate_of
from periph_sim.replay.uart import UartReplay
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Capture
from tests.replay.test_as_master import wave_of
from tests.scene.runs import TIMING
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.make_traces import FOLDER


def part(text: str, half: int = 20, first: int | None = None) -> Played:
    capture = wave_of(text, half).capture(4_000_000)
    return played(capture, "SCL", "SDA", first)


@pytest.mark.parametrize(
    ("wave", "half", "figures"),
    [
        ("S A0+ 07+ P", 20, (20, 20, 30, 0)),
        ("S A0+ ~400 07+ P", 20, (20, 20, 30, 400)),  # low for 420 samples once
        ("S A0+ 07+ P", 4, (4, 4, 6, 0)),
        ("S A0+ 07+ P", 3, (3, 3, 5, 0)),  # two samples more than usual, where that is more than half as much again
    ],
)
def test_low_high_and_stretches_in_samples(wave: str, half: int, figures: tuple[int, ...]):
    one = part(wave, half)
    assert (one.low, one.high, one.long_low, one.stretch) == figures
    assert (one.step, one.half_sample, one.rate, one.sample_rate) == (1, Fraction(1, 2), 4_000_000, 4_000_000)
    assert one.bit == pytest.approx(2 * half / 4e6)


def test_only_the_first_transfers_are_played_and_all_are_counted():
    one = part("S A0+ 07+ P S A1+ 12- P S A0+ P", first=2)
    assert (len(one.transfers), len(one.whole), len(one.expected), len(events_of(one.whole))) == (2, 3, 12, 16)
    assert list(one.answers_of_others([0x50])) == [] and [len(a) for a in one.answers_of_others([]).values()] == [2]


@pytest.mark.parametrize(
    ("wave", "place"),
    [
        ("S A0+ 0:", "in the middle of a byte, after 1 bit"),
        ("S A0+ 0: 0: 0:", "in the middle of a byte, after 3 bits"),
        ("S A0+ 0: 0: 0: 0: 0: 0: 0: 0:", "in the middle of a byte, after 8 bits"),
        ("S A0+ 07+", "before a STOP"),  # the ninth bit, the ACK, completes the byte
        ("S A0+ 07+ P", ""),
    ],
)
def test_a_note_says_where_the_capture_cuts_its_last_transfer(wave: str, place: str):
    sentence = f"the capture ends {place}: the rest of its last transfer is not compared"
    assert part(wave).notes == [sentence] * bool(place)


@pytest.mark.parametrize(("low", "step"), [(16, 8), (15, 1), (12, 1), (8, 1)])
def test_equal_distances_of_edges_are_a_sample_rate_only_if_a_low_phase_has_two_samples(low: int, step: int):
    """All edges are multiples of 8 positions apart, which may be the sample period or that of an ideal bus."""
    one = part("S A0+ 07+ P", half=20)
    vars(one).update(half_sample=Fraction(8, 2), low=Fraction(low))
    assert (one.step, one.sample_rate) == (step, Fraction(4_000_000, step))


def test_clock_pulses_before_the_first_start_are_noted():
    wave = wave_of("S A0+ 07+ P")
    pulses = bytes([0b11] * 20 + ([0b10] * 20 + [0b11] * 20) * 3)
    one = played(of_bytes(pulses + bytes(wave.samples), ("SCL", "SDA"), 4_000_000), "SCL", "SDA")
    assert one.notes == [
        "clock pulses before the capture's first START, of an unknown transfer, not played: 3",
    ]


def test_a_capture_longer_than_a_day_is_refused():
    capture = Capture(Path("long"), Fraction(10), 0, ())
    check_length(capture, 864_000)
    with pytest.raises(BadReplay, match=r"long: at 10 Hz there are 24 hours to play; expected at most 24; state the"):
        check_length(capture, 864_001)
    serial = replace(capture, length=864_001, channels=of_bytes(b"\x01", ("RX",), 10).channels)
    bus = formats.read(FOLDER / "imu_session.sr")
    with pytest.raises(BadReplay, match="long: at 10 Hz there are 24 hours to play"):
        UartReplay(load(TIMING / "uart_logger.toml"), serial, "RX")
    with pytest.raises(BadReplay, match="long: at 10 Hz there are 24 hours to play"):
        SessionReplay(load(TIMING / "imu_hil_published.toml"), bus, "SCL", "SDA", serial, "RX")
    with pytest.raises(InputError, match="a replay needs a time base and the file states no rate"):
        rate_of(replace(capture, rate=None))
