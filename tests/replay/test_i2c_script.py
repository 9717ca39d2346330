"""The two halves of a capture, the controller's edges and the targets' answers, which together give the capture."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.bus.i2c.replayed_sides import Answer, Move
from periph_sim.replay.i2c_script import (
    Edge,
    Turn,
    as_target,
    controllers_half,
    hurried,
    most_frequent,
    moves,
    turns,
    usual_hold,
)
from periph_sim.traces import formats
from periph_sim.traces.decode import i2c
from periph_sim.traces.decode.i2c import Transfer
from periph_sim.traces.formats import Capture
from tests.replay.bus import both_halves
from tests.traces.decode.drawing import drawn
from tests.traces.formats.make_traces import FOLDER
from tests.traces.formats.writers import I2cWave

SCL, SDA = True, False


def traffic(words: str) -> Capture:
    return I2cWave(4, 1, idle=10).play(words).capture()


def edges_of(capture: Capture, hold: Fraction = Fraction(1)) -> list[tuple[float, str]]:
    """Return the controller's edges of the first transfer, as position and "scl 0"."""
    (transfer, *_) = i2c.transfers(capture)
    return [(float(e.at), f"{'scl' if e.clock else 'sda'} {e.level}") for e in controllers_half(transfer, hold)]


READ_OF_ONES = """
    SCL ---- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __-- __--
    SDA ---_ _--- ---- ---- ---- ---- ---- ---- ---- -___ _--- ---- ---- ---- ---- ---- ---- ---- -___ ___-
"""


def test_the_controllers_half_has_every_edge_of_scl_and_releases_sda_for_the_target():
    edges = edges_of(drawn(READ_OF_ONES))
    clock = [(at, what) for at, what in edges if what.startswith("scl")]
    assert clock[:4] == [(4, "scl 0"), (6, "scl 1"), (8, "scl 0"), (10, "scl 1")] and len(clock) == 2 * 19
    # START; all ones; no ACK of the target; the controller's ACK after the byte, where SDA fell; release; STOP
    assert [(at, what) for at, what in edges if what.startswith("sda")] == [
        (3, "sda 0"),
        (5, "sda 1"),
        (73, "sda 0"),
        (79, "sda 1"),
    ]


def test_an_sda_edge_in_the_sample_of_an_scl_edge_is_moved_half_a_sample_into_the_low_phase():
    with_fall = drawn(
        """
        SCL ---- __-- __-- __-- __-- __-- __-- __-- __-- __-- __--
        SDA ---_ ---- ____ ---- ____ ---- ____ ---- ____ ____ ___-
        """
    )
    assert edges_of(with_fall)[:6] == [
        (3, "sda 0"),
        (4, "scl 0"),
        (4.5, "sda 1"),
        (6, "scl 1"),
        (8, "scl 0"),
        (8.5, "sda 0"),
    ]
    with_rise = drawn(
        """
        SCL ---- __-- __-- __-- __-- __-- __-- __-- __-- __-- __--
        SDA ---_ __-- --__ __-- --__ __-- --__ __-- --__ ____ ___-
        """
    )
    assert edges_of(with_rise)[:6] == [
        (3, "sda 0"),
        (4, "scl 0"),
        (5.5, "sda 1"),
        (6, "scl 1"),
        (8, "scl 0"),
        (9.5, "sda 0"),
    ]


def test_rounding_of_moves_does_not_accumulate():
    edges = [Edge(Fraction(n), SCL, n & 1) for n in range(100, 108)]
    assert [move.after for move in moves(edges, Fraction(10, 3))] == [0, 3, 4, 3, 3, 4, 3, 3]
    assert moves(edges[:2], Fraction(4)) == [Move(0, SCL, 0), Move(4, SCL, 1)]


def test_a_hurried_controller_releases_scl_early_and_sets_sda_before():
    edges = [
        Edge(Fraction(0), SDA, 0),
        Edge(Fraction(4), SCL, 0),
        Edge(Fraction(90), SDA, 1),
        Edge(Fraction(100), SCL, 1),
        Edge(Fraction(105), SCL, 0),
        Edge(Fraction(106), SDA, 0),
        Edge(Fraction(110), SCL, 1),
        Edge(Fraction(115), SDA, 1),
    ]
    assert [edge.at for edge in hurried(edges, Fraction(10))] == [0, 4, 9, 14, 19, 20, 24, 29]
    assert hurried(edges, Fraction(96)) == edges


def test_low_phases_that_are_longer_by_one_sample_are_kept():
    """SCL is low for 20 or 21 samples alternately, as sampling causes it, and once for 30."""
    lows = [20, 21, 21, 30, 21]
    edges, at = [Edge(Fraction(0), SCL, 0)], 0
    for low in lows:
        at += low
        edges += [Edge(Fraction(at), SCL, 1), Edge(Fraction(at + 20), SCL, 0)]
        at += 20
    assert hurried(edges, Fraction(20), step=1)[:7] == edges[:7]
    assert [edge.at - was.at for edge, was in zip(hurried(edges, Fraction(20), step=1), edges, strict=True)][7:] == [
        -10
    ] * 4


def test_the_targets_half_has_a_turn_for_each_address():
    found = i2c.transfers(traffic("S A6+ 32+ Sr A7+ FB+ FF- P .10 S D0- P"))
    written, read, refused = turns(found)
    assert written == Turn(0x53, False, Answer(True, acks=(True,)), 10, 10 + 4 + 8 * 8 + 4, None)
    stops = [transfer.stop.at for transfer in found if transfer.stop is not None]
    assert read.answer == Answer(True, b"\xfb\xff") and read.read
    assert refused.answer == Answer(False)
    assert [read.stop, refused.stop] == stops
    assert most_frequent([written, read, refused]) == 0x53
    assert most_frequent([refused, written]) == 0x53, "an acknowledged address counts more than a refused one"
    assert most_frequent([]) is None


def test_an_incomplete_byte_is_answered_with_its_first_bits_and_ones():
    (turn,) = turns(i2c.transfers(traffic("S A7+ 010:")))
    assert turn.answer.data == bytes([0b01011111]) and turn.stop is None


def test_the_usual_hold_is_the_median_of_the_controller_or_half_a_position():
    wave = I2cWave(20, 7, idle=10).play("S A6+ 32+ Sr A7+ FB- P")
    assert usual_hold(i2c.transfers(wave.capture())) == 7
    assert usual_hold([]) == Fraction(1, 2)
    wave = I2cWave(20, 7, idle=10).play("S A7+")
    wave.hold = 11
    assert usual_hold(i2c.transfers(wave.play("55+ 55+ 55+").capture())) == 7, "the hold of targets is ignored"


# Both halves ----------------------------------------------------------------------


def check_both_halves(capture: Capture, transfers: list[Transfer] | None = None) -> None:
    found = i2c.transfers(capture) if transfers is None else transfers
    outcome = both_halves(capture, found)
    assert outcome.divergence is None and outcome.agreed == len(i2c.events(capture))
    assert outcome.lag == 0


@pytest.mark.parametrize("name", ["imu_round.sr", "nack.sr"])
def test_both_halves_together_are_the_capture(name: str):
    check_both_halves(formats.read(FOLDER / name))


def test_both_halves_of_unusual_endings():
    """They are a repeated START after one bit of a byte, and a STOP in the ninth pulse of an acknowledged last byte."""
    check_both_halves(traffic("S A0- 0: Sr A1+ FF+ .8 S P"))  # SDA rises while SCL is still high


def test_both_halves_of_a_capture_that_ends_within_a_byte():
    for ending in ("~1", "~6"):  # with SCL low, and with SCL high
        check_both_halves(traffic(f"S A0+ 10: {ending}"))


@pytest.mark.parametrize(("ending", "last"), [("~1", (54, "scl 0")), ("", (50, "scl 1"))])
def test_the_last_fall_of_scl_is_an_edge_if_the_capture_has_it(ending: str, last: tuple[int, str]):
    """START is at 10, SCL falls at 14, rises at 18 and every 8 positions from there; five bits."""
    found = [edge for edge in edges_of(traffic(f"S 01010: {ending}")) if edge[1].startswith("scl")]
    assert found[-1] == last


@settings(max_examples=60, deadline=None)
@given(
    half=st.integers(1, 12),
    data=st.data(),
    turns_=st.lists(
        st.tuples(st.integers(0, 127), st.booleans(), st.binary(max_size=3), st.booleans(), st.booleans()),
        min_size=1,
        max_size=4,
    ),
)
def test_both_halves_of_any_traffic_are_that_traffic(half, data, turns_):
    wave = I2cWave(half, data.draw(st.integers(0, half - 1)), idle=3).play("S")
    for number, (address, read, content, acked, restart) in enumerate(turns_):
        wave.byte(address << 1 | read, ack=acked)
        for place, byte in enumerate(content if acked else b""):
            wave.byte(byte, ack=not read or place + 1 < len(content))
        if number + 1 < len(turns_):
            wave.play("Sr" if restart else "P .5 S")
    wave.play("P .1")
    check_both_halves(wave.capture())


END = 10_000


def write(begin: int, *, ack: bool = True, stop: int | None = None, address: int = 0x50) -> Turn:
    return Turn(address, False, Answer(ack, acks=(True,)), begin, begin + 10, stop)


def read(begin: int, data: bytes, *, ack: bool = True, stop: int | None = None, address: int = 0x50) -> Turn:
    return Turn(address, True, Answer(ack, data), begin, begin + 10, stop)


def test_replies_are_the_reads_that_were_answered_in_order():
    target = as_target(
        0x50,
        [read(0, b"\x01", stop=50), read(100, b"\xff", ack=False, stop=150), read(200, b"\x02\x03", stop=250)],
        END,
    )
    assert target.replies == [b"\x01", b"\x02\x03"] and target.busy == []


def test_a_refusal_after_a_write_is_a_busy_time_that_ends_halfway_to_the_next_answer():
    turns = [
        write(0, stop=100),
        write(200, stop=300),
        write(400, ack=False, stop=450),
        write(500, ack=False),
        write(600, stop=700),
    ]
    target = as_target(0x50, turns, END)
    assert target.busy == [0, Fraction(510 + 600, 2) - 300, 0]
    assert target.asleep is None and target.refused == 0


def test_refusals_at_the_start_set_the_time_asleep():
    assert as_target(0x50, [write(10, ack=False), write(100)], END).asleep == Fraction(20 + 100, 2)
    assert as_target(0x50, [write(10, ack=False)], END).asleep == END


def test_refusals_at_the_end_are_a_busy_time_to_the_end():
    assert as_target(0x50, [write(0, stop=100), write(200, ack=False)], END).busy == [END - 100]


def test_refusals_that_cannot_be_imitated_are_counted():
    """After a read, or after a write that a repeated START ended, the firmware has no busy time."""
    turns = [
        read(0, b"\x01", stop=100),
        write(200, ack=False),
        write(300),
        write(400, ack=False),
        write(500, ack=False),
    ]
    target = as_target(0x50, turns, END)
    assert target.refused == 3 and target.busy == [] and target.asleep is None


def test_other_addresses_are_ignored():
    turns = [write(0, stop=100), write(200, ack=False, address=0x51), read(300, b"\x01", address=0x51)]
    target = as_target(0x50, turns, END)
    assert target.busy == [0] and target.replies == [] and target.refused == 0
