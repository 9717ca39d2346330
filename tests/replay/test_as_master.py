"""What a master is told so that it does as a captured controller did, and what it cannot be told."""

from __future__ import annotations

from fractions import Fraction

import pytest

from firmware.python.captured_master import TransferPart, parts
from periph_sim.replay import i2c_script as reasons
from periph_sim.replay.i2c_script import as_master
from periph_sim.replay.setup import played
from tests.traces.formats.writers import I2cWave


def wave_of(text: str, half: int = 20) -> I2cWave:
    """The traffic of `I2cWave.play`, with 200 samples of silence behind each STOP, and 40 more behind the last one.

    Without P at its end the capture ends there.
    """
    end = " .40" if text.endswith("P") else ""
    return I2cWave(half, half // 5, idle=400).play(text.replace("P", "P .200") + end)


def told(text: str) -> reasons.AsMaster:
    part = played(wave_of(text).capture(4_000_000), "SCL", "SDA")
    return as_master(part.transfers, part.long_low, Fraction(10))


@pytest.mark.parametrize(
    ("wave", "script"),
    [
        ("S A0+ 00+ P", ["50 W 00"]),
        ("S A0+ 00+ 1F+ Sr A1+ 12+ 34- P", ["50 W 00 1F Sr 50 R 2"]),
        ("S A1+ 12+ 34+ P", ["50 R 2 ACK"]),
        ("S A0- P S A0- P S A0+ P", ["50 W", "50 W", "50 W"]),
        ("S A0+ 00- P", ["50 W 00"]),
        ("S A1- P", ["50 R 0"]),
    ],
)
def test_a_script_is_written_as_the_specification_draws_it(wave: str, script: list[str]):
    found = told(wave)
    assert found.script == script and found.left_out == {}
    assert len(found.pauses) == len(found.done) == len(script)


@pytest.mark.parametrize(
    ("wave", "why"),
    [
        ("S A0+ 00+", reasons.CUT),
        ("S A0- 00+ P", reasons.AGAINST),
        ("S A0+ 0: P", reasons.BROKEN),
        ("S A0- 0: Sr A0+ 00+ P", reasons.AGAINST),
        ("S A1+ P", reasons.NO_DATA),
        ("S P", reasons.EMPTY),
    ],
)
def test_what_a_master_of_this_module_cannot_do_is_left_out_with_the_reason(wave: str, why: str):
    found = told(f"S A0+ 07+ P {wave}")
    assert found.script == ["50 W 07"] and found.left_out == {why: 1}


def test_long_low_phases_are_the_targets_stretches_in_ticks():
    """A bit is 20 low, 20 high; a position is 10 ticks. Before an address nobody stretches."""
    found = told("S A1+ ~400 12+ 34- P S ~400 A0+ ~400 07+ P")
    first, second = found.answers[0x50]
    assert first.data == b"\x12\x34"
    ((byte, bit, ticks),) = first.stretches
    assert (byte, bit) == (0, 0) and 4150 <= ticks <= 4250
    assert [(byte, bit) for byte, bit, _ in second.stretches] == [(0, 0)]


def test_a_script_is_read_back():
    assert parts("50 W 00 1F Sr 51 R 6") == [TransferPart(0x50, b"\x00\x1f"), TransferPart(0x51, count=6)]
    assert parts("1E R 2 ACK") == [TransferPart(0x1E, count=2, ack_last=True)]
    assert parts("50 W") == [TransferPart(0x50)] and parts("50 R 0") == [TransferPart(0x50, count=0)]


@pytest.mark.parametrize("text", ["50", "50 X 1", "50 R", "50 R 1 NACK", "", "50 W 00 Sr"])
def test_a_script_that_is_none_is_refused(text: str):
    with pytest.raises(ValueError, match="is not a part of a transfer"):
        parts(text)
