"""Decoder of I2C: events at the positions used by logic analysers, and the timing and drivers used by the replay."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces.decode import i2c
from periph_sim.traces.decode.i2c import Party
from tests.profiles import examples
from tests.traces.decode.drawing import Plain, drawn, of_bytes, plain
from tests.traces.formats.writers import I2cWave

C, T = Party.CONTROLLER, Party.TARGET


def wave(traffic: str, half: int = 4, hold: int = 1) -> I2cWave:
    return I2cWave(half, hold, idle=10).play(traffic)


def events(traffic: str) -> list[Plain]:
    return plain(i2c.events(wave(traffic).capture()))


def transfers(traffic: str, half: int = 4, hold: int = 1) -> list[i2c.Transfer]:
    return i2c.transfers(wave(traffic, half, hold).capture())


# Events -----------------------------------------------------------------------


def test_an_acknowledged_address():
    capture = drawn(
        """
        SCL ---- __-- __-- __-- __-- __-- __-- __-- __-- __-- __--
        SDA ---_ _--- -___ _--- -___ ____ _--- ---- ---- -___ ___-
        """
        # S    1    0    1    0    0    1    1    R    A    P
    )
    assert plain(i2c.events(capture)) == [("START", 3), ("ADDRESS", 6, 0b1010011, True, 34), ("ACK", 38), ("STOP", 43)]


def test_every_event_has_the_position_used_by_analysers():
    assert events("S A6+ A5- P") == [  # SDA falls at 10, SCL at 14, rises at 18, 26, ...
        ("START", 10),
        ("ADDRESS", 18, 0x53, False, 18 + 7 * 8),
        ("ACK", 18 + 8 * 8),
        ("DATA", 18 + 9 * 8, 0xA5, False),
        ("NACK", 18 + 17 * 8),
        ("STOP", 18 + 18 * 8 + 4),
    ]


def test_a_repeated_start_changes_the_direction():
    found = events("S 3C+ 03+ Sr 3D+ 12+ 34- P")
    kinds = [event[0] for event in found]
    first, second = ["START", "ADDRESS", "ACK", "DATA", "ACK"], ["REPEATED_START", "ADDRESS", "ACK", "DATA", "ACK"]
    assert kinds == [*first, *second, "DATA", "NACK", "STOP"]
    assert [event for event in found if event[0] == "DATA"] == [
        ("DATA", 90, 0x03, False),
        ("DATA", 246, 0x12, True),
        ("DATA", 318, 0x34, True),
    ]


def test_the_address_is_seven_bits_and_ten_bit_addresses_are_not_joined():
    found = events("S F6+ 42+ P")
    assert (found[1][0], found[1][2]) == ("ADDRESS", 0b1111011)
    assert (found[3][0], found[3][2]) == ("DATA", 0x42)


@given(st.lists(st.tuples(st.integers(0, 255), st.booleans()), min_size=1, max_size=4), st.integers(2, 9))
@settings(max_examples=examples(40), deadline=None)
def test_any_bytes_are_decoded_at_any_speed(content: list[tuple[int, bool]], half: int):
    words = [f"{value:02X}{'-+'[ack]}" for value, ack in content]
    (phase,) = transfers(" ".join(["S", *words, "P"]), half)[0].phases
    assert [(byte.value, byte.acked) for byte in phase.bytes] == content
    assert {bit.high for byte in phase.bytes for bit in byte.bits} == {half}


def test_start_and_stop_are_found_within_an_address():
    assert events("S 101: P") == [("START", 10), ("CUT", 18, (1, 0, 1)), ("STOP", 46)]


def test_a_byte_interrupted_by_a_start_is_cut():
    kinds = [event[0] for event in events("S A0+ 1: Sr A1+ P")]
    assert kinds == ["START", "ADDRESS", "ACK", "CUT", "REPEATED_START", "ADDRESS", "ACK", "STOP"]


def test_an_acknowledge_is_decoded_even_if_the_stop_is_in_its_clock_pulse():
    found = events(f"S {0x51:08b}: P")  # the pulse of the STOP is the only one after the byte
    assert found == [("START", 10), ("ADDRESS", 18, 0x28, True, 74), ("ACK", 82), ("STOP", 86)]


# Both lines in one sample --------------------------------------------------------


def test_with_simultaneous_edges_a_rise_of_scl_takes_the_new_level_and_a_fall_the_old_one():
    capture = drawn(
        """
        SCL ----__--__--__--
        SDA ---___----__----
        """
    )
    # SDA rises with SCL at 6, falls with it at 10, and rises as SCL falls at 12, which is no STOP
    assert plain(i2c.events(capture)) == [("START", 3), ("CUT", 6, (1, 0, 1))]
    assert i2c.shared_edges(capture) == 3


def test_simultaneous_edges_make_neither_start_nor_stop():
    capture = drawn(
        """
        SCL ----____----____----
        SDA ----____----____----
        """
    )
    assert plain(i2c.events(capture)) == []
    assert i2c.shared_edges(capture) == 4


def test_glitches_of_sda_while_scl_is_low_are_ignored():
    bus = wave("S 31+", half=6)
    clean = i2c.events(bus.capture())
    samples = bytearray(bus.samples)
    for place, sample in enumerate(samples):
        low_around = all(not samples[n] & 1 for n in range(place - 1, min(place + 2, len(samples))))
        if place and low_around and place % 2:
            samples[place] = sample ^ 2
    assert samples != bus.samples
    assert i2c.events(of_bytes(bytes(samples), ("SCL", "SDA"))) == clean


# Begin and end of a capture ---------------------------------------------------------------------


def test_bits_before_the_first_start_are_a_lead_without_events():
    late = wave("S A6+ P S A7+ P").samples[30:]  # after two of nine bits
    first, second = i2c.transfers(of_bytes(bytes(late), ("SCL", "SDA")))
    assert [bit.value for bit in first.lead] == [1, 0, 0, 1, 1, 0, 0, 0]  # the last one is the pulse of the STOP
    assert first.stop is not None and not first.phases
    assert list(i2c.events_of(first)) == []
    assert second.stop is not None and second.phases[0].address == 0x53
    assert second.gap == 4


def test_a_capture_that_ends_within_a_byte_has_its_bits():
    (transfer,) = transfers("S A6+ 1101:")
    assert transfer.stop is None
    last = transfer.phases[0].bytes[-1]
    assert last.value is None and last.acked is None and last.bits[-1].high is None
    assert events("S A6+ 1101:")[-1] == ("CUT", 90, (1, 1, 0, 1))


def test_a_capture_that_ends_before_the_ninth_bit_keeps_the_byte():
    traffic = f"S {0xA6:08b}:"
    assert events(traffic) == [("START", 10), ("ADDRESS", 18, 0x53, False, 74)]
    assert transfers(traffic)[0].phases[0].bytes[0].acked is None


def test_an_idle_or_dead_bus_has_no_transfers():
    assert i2c.transfers(drawn("SCL --------\nSDA --------")) == []
    assert i2c.transfers(drawn("SCL ________\nSDA ________")) == []


def test_no_byte_is_decoded_across_an_unknown_span():
    marks = ["".join("_-"[sample >> bit & 1] for sample in wave("S A6+ 00+ P").samples) for bit in (0, 1)]
    holed = [wave[:100] + "?" * 20 + wave[120:] for wave in marks]
    found = i2c.transfers(drawn(f"SCL {holed[0]}\nSDA {holed[1]}"))
    assert len(found) == 2
    assert found[0].phases[0].address == 0x53 and found[0].stop is None
    assert found[1].phases == () and found[1].stop is not None and found[1].gap is None


# Timing and drivers ---------------------------------------------------------------


def test_each_bit_has_its_clock_times_and_the_change_of_sda():
    bits = transfers("S 80+ P", half=5, hold=2)[0].phases[0].bytes[0].bits
    fall = 15
    assert bits[0] == i2c.Bit(1, fall + 5, 5, 5, fall + 2, C)
    assert bits[1] == i2c.Bit(0, fall + 15, 5, 5, fall + 12, C)
    assert bits[2] == i2c.Bit(0, fall + 25, 5, 5, None, C)


def test_a_stretched_clock_is_a_long_low_phase():
    bits = transfers("S 1: ~300 0:", half=5, hold=2)[0].phases[0].bytes[0].bits
    assert [bit.low for bit in bits] == [5, 305]


def test_the_drivers_of_bits_follow_from_the_direction():
    write, read = transfers("S D0+ 1D+ Sr D1+ 55+ AA- P")[0].phases
    drivers = [[bit.driver for bit in byte.bits] for byte in write.bytes + read.bytes]
    assert drivers == [[C] * 8 + [T]] * 3 + [[T] * 8 + [C]] * 2
    assert (write.address, write.read, write.data) == (0x68, False, (0x1D,))
    assert (read.address, read.read, read.data) == (0x68, True, (0x55, 0xAA))


def test_conditions_and_gaps_have_their_times():
    first, second = transfers(2 * "S D0+ 1D+ Sr D1+ 55- P .30 ")
    assert first.phases[0].start == i2c.Condition(10, None, None, 4)
    again = first.phases[1].start
    assert (again.low, again.high, again.hold) == (4, 4, 4)
    assert first.stop is not None
    assert (first.stop.low, first.stop.high, first.stop.hold) == (4, 4, None)
    assert first.gap is None
    assert second.gap == second.phases[0].start.at - first.stop.at == 34


def test_a_stop_immediately_after_a_start():
    found = i2c.transfers(drawn("SCL ------------\nSDA --____---_--"))
    assert [(t.phases[0].start, t.stop, t.gap) for t in found] == [
        (i2c.Condition(2, None, None, None), i2c.Condition(6, None, None, None), None),
        (i2c.Condition(9, None, None, None), i2c.Condition(10, None, None, None), 3),
    ]


def test_a_second_stop_is_ignored():
    assert events("S A6+ P P") == events("S A6+ P")


def test_a_missing_channel_is_rejected_with_the_existing_ones():
    with pytest.raises(LookupError, match=r"there is no channel 'SCL'; it has a, b"):
        i2c.events(drawn("a ----\nb ----"))
