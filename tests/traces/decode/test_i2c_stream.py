"""The stream decoder, which takes single samples, agrees with the array decoder, and both agree with sigrok."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Capture
from periph_sim.traces.decode import i2c
from periph_sim.traces.decode.i2c_stream import BITS, BYTE, BYTE_OVER, COUNTED, KINDS, RISE, SCL, SDA, START, I2cStream
from periph_sim.traces.decode.i2c_table import I2cRowKind, i2c_table
from tests.captures.test_captures_decode import i2c_lines
from tests.profiles import examples
from tests.traces.decode.drawing import Plain, of_bytes, plain
from tests.traces.decode.random_lines import captures
from tests.traces.formats.sigrok import sigrok_says
from tests.traces.formats.writers import I2cWave

MOVES = ("start", "again", "stop", "byte", "byte", "cut")
TROUBLE = ("hold", "spike", "spike")


def streamed(capture: Capture) -> list[Plain]:
    """Return the events that a stream decoder reports, each bit with the position at which it was reported."""
    found: list[Plain] = []
    for span in capture.known(*capture.channels):
        scl, sda = (channel.cut(span) for channel in capture.channels)
        stream, bits = I2cStream(scl.initial | sda.initial << 1), []
        edges = np.union1d(scl.edges, sda.edges)
        for at, levels in zip(edges.tolist(), (scl.at(edges) | sda.at(edges) << 1).tolist(), strict=True):
            busy, index = stream.busy, stream.index
            event = stream.sample(levels)
            assert event != BYTE_OVER or stream.index == index + 1
            if event >= START:  # START, STOP or the end of a byte
                found += byte_of(bits, COUNTED[len(bits)], index, stream)
                bits = []
            if event & KINDS >= START and (busy or event & KINDS == START):
                found.append(("REPEATED_START" if busy and stream.busy else "START" if stream.busy else "STOP", at))
            elif event == RISE and stream.busy:
                bits.append((at, levels >> 1))
        index = stream.index
        if len(bits) == BITS:
            stream.byte_over()  # the span ends before the fall of SCL that would show it
        found += byte_of(bits, len(bits), index, stream)
    return found


def byte_of(bits: list[tuple[int, int]], count: int, index: int, stream: I2cStream) -> list[Plain]:
    """A byte and its ACK, as far as they are complete. The attributes of the stream must agree with a complete byte."""
    at, levels = [place for place, _ in bits[:count]], tuple(level for _, level in bits[:count])
    if count < 8:
        return [("CUT", at[0], levels)] if count else []
    value = int("".join(map(str, levels[:8])), 2)
    address: Plain = "ADDRESS", at[0], value >> 1, bool(value & 1), at[7]
    byte = ("DATA", at[0], value, stream.read) if index >= 0 else address
    if count == 8:
        return [byte]
    assert (stream.byte, stream.acked) == (value, not levels[8])
    assert index >= 0 or (stream.address, stream.read) == (value >> 1, value & 1)
    return [byte, ("NACK" if levels[8] else "ACK", at[8])]


def bus(random: Random, count: int, sound: bool = False) -> Capture:
    """Transfers with cut bytes and simultaneous edges; if not `sound`, also with held lines and spikes.

    A sound bus can be read by sigrok: it has no START or STOP in an address or just before the eighth bit of a byte.
    """
    wave = I2cWave(random.randint(2, 4), random.randint(0, 1), idle=random.randint(1, 3))
    for move in random.choices(MOVES if sound else MOVES + TROUBLE, k=count):
        match move:
            case "byte":
                wave.byte(random.randrange(256), random.random() < 0.7)
            case "cut":
                for _ in range(random.randint(1, 6 if sound else 9)):
                    wave.bit(random.randint(0, 1))
                wave.stop()
            case "hold":
                wave.samples += bytes([random.randrange(4)]) * random.randint(1, 30)
            case "spike":
                wave.samples[-random.randint(1, min(40, len(wave.samples)))] ^= random.randint(1, 3)
            case condition:
                getattr(wave, condition)()
                if sound and condition != "stop":
                    wave.byte(random.randrange(256))
    kept = len(wave.samples) if sound else random.randint(1, len(wave.samples))
    return of_bytes(bytes(wave.samples[:kept]), ("SCL", "SDA"))


@given(captures(("SCL", "SDA")) | st.builds(bus, st.randoms(use_true_random=False), st.integers(1, 30)))
@settings(max_examples=examples(80), deadline=None)
def test_streams_arrays_and_transfers_have_the_same_events(capture: Capture):
    assert streamed(capture) == plain(i2c.events(capture))
    assert [event for transfer in i2c.transfers(capture) for event in i2c.events_of(transfer)] == i2c.events(capture)


@given(captures(("SCL", "SDA")) | st.builds(bus, st.randoms(use_true_random=False), st.integers(1, 30)))
@settings(max_examples=examples(80), deadline=None)
def test_bytes_of_the_array_decoder_end_where_those_of_the_stream_end(capture: Capture):
    ends: list[int] = []
    for span in capture.known(*capture.channels):
        scl, sda = (channel.cut(span) for channel in capture.channels)
        stream = I2cStream(scl.initial | sda.initial << 1)
        edges = np.union1d(scl.edges, sda.edges)
        levels = (scl.at(edges) | sda.at(edges) << 1).tolist()
        ends += [at for at, now in zip(edges.tolist(), levels, strict=True) if stream.sample(now) & BYTE]
    table = i2c_table(capture)
    is_ninth = (table.kind == I2cRowKind.ACK) | (table.kind == I2cRowKind.NACK)
    assert table.end[is_ninth & (table.end > table.at)].tolist() == ends


@pytest.mark.parametrize("shown", [0x00, 0xFF, 0x53, 0xAC])
def test_seven_bits_at_once_have_the_effect_of_seven_pulses(shown: int):
    streams = clocked, skipped = I2cStream(SCL), I2cStream(SCL)
    for stream in streams:
        stream.condition(start=True)
        stream.sample(0)
    for place in range(7, 0, -1):
        clocked.sample(SCL | SDA * (shown >> place & 1))
        clocked.sample(SDA * (shown >> place - 1 & 1))
    skipped.skip(shown)
    assert clocked.levels == skipped.levels
    for stream in streams:
        ended = [stream.sample(levels) for levels in (SCL | SDA * (shown & 1), 0, SCL, 0)]
        assert (ended[-1], stream.byte, stream.acked, stream.bits) == (BYTE_OVER, shown, True, 0)


@pytest.mark.skipif(shutil.which("sigrok-cli") is None, reason="sigrok-cli is not installed")
@pytest.mark.parametrize("seed", range(3))
def test_sigrok_gives_the_same_events(tmp_path: Path, seed: int):
    capture = bus(Random(seed), 400, sound=True)
    formats.write(capture, tmp_path / "x.sr")
    said = re.findall(r"^(\d+)-\d+ i2c-1: ([A-Z].*)$", sigrok_says(tmp_path / "x.sr", "i2c"), re.MULTILINE)
    assert i2c_lines(streamed(capture)) == [(int(at), text) for at, text in said] != []
