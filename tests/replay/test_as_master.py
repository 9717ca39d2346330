"""Scripts of a master that imitates a captured controller, and transfers that it cannot imitate."""

from __future__ import annotations

from fractions import Fraction

import pytest

from firmware.python.captured_master import TransferPart, parts
from periph_sim.replay import i2c_script as reasons
from periph_sim.replay.i2c_script import as_master
from periph_sim.replay.setup import played
from tests.traces.formats.writers import I2cWave


def wave_of(text: str, half: int = 20) -> I2cWave:
    """Return the traffic of `I2cWave.play`, with 200 samples of silence after each STOP and 40 more after the last one.

    Without P at the end of `text`, the capture ends there.
    """
    end = " .40" if text.endswith("P") else ""
    return I2cWave(half, half // 5, idle=400).play(text.replace("P", "P .200") + end)


def script_of(text: str) -> reasons.AsMaster:
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
def test_a_script_has_the_notation_of_the_specification(wave: str, script: list[str]):
    found = script_of(wave)
    assert found.script == script and found.left_out == {}
    assert len(found.pauses) == len(found.done) == len(script)


@pytest.mark.parametrize(
    ("wave", "reason"),
    [
        ("S A0+ 00+", reasons.CUT),
        ("S A0- 00+ P", reasons.AGAINST),
        ("S A0+ 0: P", reasons.BROKEN),
        ("S A0- 0: Sr A0+ 00+ P", reasons.AGAINST),
        ("S A1+ P", reasons.NO_DATA),
        ("S P", reasons.EMPTY),
    ],
)
def test_transfers_that_the_module_cannot_do_as_master_are_left_out_with_the_reason(wave: str, reason: str):
    found = script_of(f"S A0+ 07+ P {wave}")
    assert found.script == ["50 W 07"] and found.left_out == {reason: 1}


def test_long_low_phases_are_stretches_of_the_target_in_ticks():
    """A bit is low for 20 and high for 20 positions of 10 ticks. There are no stretches before an address."""
    found = script_of("S A1+ ~400 12+ 34- P S ~400 A0+ ~400 07+ P")
    first, second = found.answers[0x50]
    assert first.data == b"\x12\x34"
    ((byte, bit, ticks),) = first.stretches
    assert (byte, bit) == (0, 0) and 4150 <= ticks <= 4250
    assert [(byte, bit) for byte, bit, _ in second.stretches] == [(0, 0)]


def test_a_script_is_parsed():
    assert parts("50 W 00 1F Sr 51 R 6") == [TransferPart(0x50, b"\x00\x1f"), TransferPart(0x51, count=6)]
    assert parts("1E R 2 ACK") == [TransferPart(0x1E, count=2, ack_last=True)]
    assert parts("50 W") == [TransferPart(0x50)] and parts("50 R 0") == [TransferPart(0x50, count=0)]


@pytest.mark.parametrize("text", ["50", "50 X 1", "50 R", "50 R 1 NACK", "", "50 W 00 Sr"])
def test_an_invalid_script_is_refused(text: str):
    with pytest.raises(ValueError, match="is not a part of a transfer"):
        parts(text)
