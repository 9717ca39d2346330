"""Table of I2C events: bits with their timing, 10-bit addresses, ends of rows, the glitch filter."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Capture, Span, within
from periph_sim.traces.decode import i2c
from periph_sim.traces.decode.i2c_table import I2cRowKind, I2cTable, i2c_bits, i2c_table, impossible_rate
from tests.profiles import examples
from tests.traces.decode.drawing import drawn, of_bytes, plain
from tests.traces.decode.random_lines import captures
from tests.traces.decode.test_i2c_stream import streamed
from tests.traces.formats.make_traces import FOLDER
from tests.traces.formats.writers import I2cWave


def of(traffic: str, half: int = 4, hold: int = 1) -> Capture:
    return I2cWave(half, hold, idle=10).play(traffic).capture()


def rows(table: I2cTable) -> list[tuple[str, int, int]]:
    """(kind, at, value) of each row."""
    return [
        (I2cRowKind(k).name, at, v)
        for k, at, v in zip(*(c.tolist() for c in (table.kind, table.at, table.value)), strict=True)
    ]


@given(captures(("SCL", "SDA")))
@settings(max_examples=examples(40), deadline=None)
def test_every_bit_has_the_timing_of_its_pulse(capture: Capture):
    bits = i2c_bits(capture)
    found = {
        at: (value, low if low >= 0 else None, high if high >= 0 else None)
        for at, value, low, high in zip(*(c.tolist() for c in (bits.at, bits.value, bits.low, bits.high)), strict=True)
    }
    assert found == pulses(capture)
    for transfer in i2c.transfers(capture):
        for bit in [*transfer.lead, *(bit for phase in transfer.phases for byte in phase.bytes for bit in byte.bits)]:
            assert found[bit.at] == (bit.value, bit.low, bit.high)


def pulses(capture: Capture) -> dict[int, tuple[int, int | None, int | None]]:
    """SDA at each rise of SCL, with the distances to the edges of SCL before and after it, if they are known."""
    found = {}
    for span in capture.known(*capture.channels):
        scl, sda = (channel.cut(span) for channel in capture.channels)
        edges = [None, *scl.edges.tolist(), None]
        for before, at, behind, level in zip(edges, edges[1:], edges[2:], scl.levels, strict=False):
            if level:
                value = (sda.initial + sum(edge <= at for edge in sda.edges.tolist())) % 2
                found[at] = value, before and at - before, behind and behind - at
    return found


@given(
    st.lists(st.tuples(st.integers(0, 255), st.booleans()), min_size=1, max_size=5), st.randoms(use_true_random=False)
)
@settings(max_examples=examples(40), deadline=None)
def test_transfers_with_random_lengths_of_phases_are_decoded(content: list[tuple[int, bool]], random: Random):
    samples = bytearray([3]) * random.randint(1, 30)
    samples += bytes([1]) * random.randint(1, 20)  # START
    sda = 0

    def pulse(value: int) -> None:
        nonlocal sda
        low = random.randint(2, 40)
        hold = random.randint(1, low - 1)
        samples.extend(bytes([sda << 1]) * hold + bytes([value << 1]) * (low - hold))
        samples.extend(bytes([1 | value << 1]) * random.randint(1, 30))
        sda = value

    for value, ack in content:
        for place in range(7, -1, -1):
            pulse(value >> place & 1)
        pulse(0 if ack else 1)
    pulse(0)
    samples += bytes([3]) * random.randint(1, 30)  # STOP
    capture = of_bytes(bytes(samples), ("SCL", "SDA"))
    table = i2c_table(capture)
    kinds = [I2cRowKind(kind) for kind in table.kind.tolist()]
    assert kinds[0] is I2cRowKind.START and kinds[-1] is I2cRowKind.STOP
    bytes_seen = [byte.value for phase in i2c.transfers(capture)[0].phases for byte in phase.bytes]
    assert [value for value, _ in content] == bytes_seen
    assert [kind is I2cRowKind.ACK for kind in kinds if kind in (I2cRowKind.ACK, I2cRowKind.NACK)] == [
        ack for _, ack in content
    ]
    values = table.value[
        (table.kind == I2cRowKind.ADDRESS) | (table.kind == I2cRowKind.DATA) | (table.kind == I2cRowKind.ADDRESS_LOW)
    ]
    assert (values[1:] & 0xFF).tolist() == [value for value, _ in content[1:]]
    assert values[0] == content[0][0] >> 1 and bool(table.read[1]) == bool(content[0][0] & 1)


def test_a_row_ends_where_scl_falls_after_its_last_bit():
    table = i2c_table(of("S A6+ P"))  # SDA falls at 10, SCL at 14, rises at 18, 26, ...
    assert rows(table) == [("START", 10, -1), ("ADDRESS", 18, 0x53), ("ACK", 82, -1), ("STOP", 94, -1)]
    assert table.last.tolist() == [10, 74, 82, 94]
    assert table.end.tolist() == [10, 78, 86, 94]
    assert table.bits.tolist() == [0, 8, 1, 0]


def test_an_ack_ends_at_the_condition_in_its_pulse():
    """If a STOP or a repeated START is in the ninth pulse of SCL, the row of the ACK ends where it begins."""
    table = i2c_table(of("S 10100110: P .100 S 10100110: Sr A7+ P"))  # in the first, SCL rises at 82, SDA at 86
    assert rows(table)[:4] == [("START", 10, -1), ("ADDRESS", 18, 0x53), ("ACK", 82, -1), ("STOP", 86, -1)]
    assert table.end[:4].tolist() == [10, 78, 86, 86]
    assert [name for name, *_ in rows(table)[4:8]] == ["START", "ADDRESS", "NACK", "REPEATED_START"]
    assert (table.end[:-1] <= table.at[1:]).all()


@pytest.mark.parametrize(("kept", "ends"), [(82, [10, 78]), (86, [10, 78, 82]), (87, [10, 78, 86, 86])])
def test_an_ack_ends_at_the_condition_in_its_pulse_even_if_scl_never_falls_again(kept: int, ends: list[int]):
    """SCL rises at 82. SDA rises at 86, which is a STOP. The capture ends before, between or after these edges."""
    assert i2c_table(within(of("S 10100110: P"), Span(0, kept))).end.tolist() == ends


def test_a_ten_bit_address_has_two_bytes_and_one_value():
    bus = of("S F4+ 42+ 99+ Sr F5+ 55- P")
    found = [(kind, value) for kind, _, value in rows(i2c_table(bus)) if value >= 0]
    assert found == [("ADDRESS", 0x7A), ("ADDRESS_LOW", 0x242), ("DATA", 0x99), ("ADDRESS", 0x7A), ("DATA", 0x55)]
    assert streamed(bus) == plain(i2c.events(bus))


def test_the_bytes_of_an_unacknowledged_ten_bit_address_are_not_joined():
    kinds = [kind for kind, _, _ in rows(i2c_table(of("S F4- 42+ P")))]
    assert kinds == ["START", "ADDRESS", "NACK", "DATA", "ACK", "STOP"]


def test_the_bits_of_a_cut_byte_are_a_number():
    table = i2c_table(of("S 101: P"))
    assert rows(table) == [("START", 10, -1), ("CUT", 18, 0b101), ("STOP", 46, -1)]
    assert table.bits.tolist() == [0, 3, 0]


def test_the_filter_removes_glitches_on_both_lines():
    bus = I2cWave(half=20, hold=6, idle=10).play("S D0+ 1D+ Sr D1+ 55+ A0- P")
    clean = rows(i2c_table(bus.capture()))
    samples = bytearray(bus.samples)
    for place in range(15, len(samples) - 15, 37):
        near = {samples[n] for n in range(place - 4, place + 6)}
        if len(near) == 1:  # far from edges
            samples[place] ^= 1
            samples[place + 1] ^= 3
    spiked = of_bytes(bytes(samples), ("SCL", "SDA"))
    assert rows(i2c_table(spiked)) != clean
    assert rows(i2c_table(spiked, glitch=3)) == clean


def test_a_stretch_is_a_long_low_phase_of_its_bit():
    bits = i2c_bits(of("S 1: ~300 0:", half=5, hold=2))
    assert bits.low.tolist() == [5, 305] and bits.high.tolist() == [5, -1]


def test_an_idle_or_dead_bus_has_no_rows():
    for lines in (
        "SCL --------\nSDA --------",
        "SCL ________\nSDA ________",
        "SCL --------\nSDA -_-_----",
        "SCL ????\nSDA ----",
    ):
        assert streamed(drawn(lines)) == plain(i2c.events(drawn(lines)))
        assert len(i2c_bits(drawn(lines)).at) == 0


def test_a_missing_channel_is_rejected_with_the_existing_ones():
    with pytest.raises(LookupError, match=r"there is no channel 'SCL'; it has a, b"):
        i2c_table(drawn("a ----\nb ----"))


NACK = FOLDER / "nack.sr"  # a 100 kHz bus, sampled at 4 MHz


@pytest.mark.parametrize(
    ("rate", "clock"),
    [(1, "0.025 Hz"), (1000, "25 Hz"), (4_000, ""), (4 * 10**6, ""), (200 * 10**6, ""), (4 * 10**9, "1e+08 Hz")],
)
def test_a_rate_is_impossible_if_scl_would_have_an_impossible_frequency(rate: int, clock: str):
    said = impossible_rate(formats.read(NACK, Fraction(rate)), "SCL")
    assert (f"SCL would run at {clock}; expected 100 Hz to 5 MHz" in said) if clock else said == ""


def test_with_few_clocks_no_rate_is_impossible():
    assert impossible_rate(drawn("SCL -_-_-_-_-_-_-_-_", rate=1), "SCL") == "", "fewer clocks than in a byte"
    assert impossible_rate(drawn("SCL -" + "_-" * 9, rate=1), "SCL") != ""
    assert impossible_rate(drawn("SCL -" + "_-" * 9, rate=None), "SCL") == ""
