"""A session's I2C controller, call by call: its edges, the answers, and other parties on the bus."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.outside import OutsideError
from periph_sim.outside.errors import ArbitrationLost
from periph_sim.outside.session import Session
from periph_sim.scene.case.load import load
from tests.outside.sessions import BUS, Records, begun, bus, case, refuses
from tests.scene.runs import TIMING


def test_a_transfer_call_by_call_as_in_drivers() -> None:
    """S 50W A 00 A  Sr 50R A c1 A c2 N P"""
    session, _ = bus()
    master = session.i2c
    assert master.start(0x50)
    assert session.level("SCL") == 0
    assert master.write(0)
    session.advance(session.now + session.ticks("3 ms"))  # nothing happens while SCL is held
    assert master.start(0x50, read=True)
    assert [master.read(ack=True), master.read(ack=False)] == [1, 2]
    master.stop()
    assert session.level("SCL") == session.level("SDA") == 1


def test_transfers_with_and_without_an_answer() -> None:
    session, _ = bus()
    assert session.i2c.transfer(0x50, b"\x00", 5) == bytes([1, 2, 3, 4, 5])
    assert session.i2c.transfer(0x33, b"\x00", 5) is None
    assert session.i2c.transfer(0x33) is None
    assert session.i2c.transfer(0x50) == b""
    assert session.i2c.transfer(0x50, b"\x00", 1) == b"\x01"


def edges_of(bits: str, half: int, hold: int) -> tuple[list[tuple[int, str, int]], int]:
    """Return the edges of "S 0110 Sr 1 P" and the time of its end, in ticks from the START."""
    edges, at, sda = [], 0, 1

    def move(tick: int, line: str, level: int) -> None:
        edges.append((tick, line, level))

    for part in bits.replace("Sr", "R").replace(" ", ""):
        if part != "S":  # SCL fell at `at`; a repeated START needs SDA high before, a STOP needs it low
            level = {"R": 1, "P": 0}.get(part, part)
            if int(level) != sda:
                sda = int(level)
                move(at + hold, "SDA", sda)
            at += half
            move(at, "SCL", 1)
            at += half
        if part in "SRP":
            sda = int(part == "P")
            move(at, "SDA", sda)
            at += half
        if part != "P":
            move(at, "SCL", 0)
    return edges, at


@pytest.mark.parametrize(
    ("rate", "half", "hold"), [("100 kHz", 15_000, 900), ("1 MHz", 1500, 750), ("5 MHz", 300, 150)]
)
def test_every_edge_is_at_the_time_given_by_the_rate(rate: str, half: int, hold: int) -> None:
    """Half a period low, half high; SDA 300 ns after SCL's fall or in the middle of its low time; no target answers."""
    session, records = bus()
    master, begin = session.i2c, session.now
    assert session.ticks_per_second == 3_000_000_000
    master.rate = rate
    assert (master.rate, master.reads, master.writes) == (rate, False, False)
    assert not master.start(0x33) and master.writes and not master.reads
    assert master.bits(0, 1, 1) == [0, 1, 1]
    assert not master.start(0x33, read=True) and master.reads and not master.writes
    assert [master.read(ack=True), master.read(ack=False)] == [0xFF, 0xFF]
    master.stop()
    made = [(one.tick - begin, one.where, one.value) for one in records.kept if one.kind is Kind.EDGE]
    expected, over = edges_of("S 01100110 1 011 Sr 01100111 1 11111111 0 11111111 1 P", half, hold)
    assert (made, session.now - begin, master.held) == (expected, over, False)


def test_a_late_call_moves_sda_before_scl() -> None:
    """S 33W N, a pause, P: SDA falls when `stop` is called, SCL rises a tick later, SDA half a period after that."""
    session, records = bus()
    session.i2c.start(0x33)
    late = session.now + session.ticks("1 ms")
    session.advance(late)
    session.i2c.stop()
    made = [
        (one.tick - late, one.where, one.value) for one in records.kept if one.kind is Kind.EDGE and one.tick >= late
    ]
    assert made == [(0, "SDA", 0), (1, "SCL", 1), (15_001, "SDA", 1)]


def test_a_stretched_clock_is_still_high_for_half_a_period() -> None:
    """
    us    5    10   15   20   25 27                60   65
    SCL   |____|----|____|----|__ held by a target |----|____
    """
    records = Records()
    held = {"kind": "hold", "wire": "SCL", "at": "1027 us", "length": "33 us"}
    session = begun(case(fault=[held]), subscribe=records.subscribe)
    assert session.i2c.start(0x50)
    us, began = session.ticks("1 us"), session.scene.start + session.ticks("1 ms")
    clock = [one.tick - began for one in records.kept if one.kind is Kind.EDGE and one.where == "SCL"]
    assert clock[:7] == [5 * us, 10 * us, 15 * us, 20 * us, 25 * us, 60 * us, 65 * us]


@pytest.mark.parametrize("rate", ["0 Hz", "fast", "-1 Hz", "10 GHz"])
def test_an_invalid_rate_is_refused(rate: str) -> None:
    with pytest.raises(OutsideError, match=f"rate '{rate}': expected a frequency above 0 and up to 5 MHz"):
        bus()[0].i2c.rate = rate


def test_calls_in_the_wrong_order_are_refused() -> None:
    master = bus()[0].i2c
    refuses("stop: there is no transfer to end", master.stop)
    refuses("write: there is no transfer to write in", master.write, 1)
    assert master.start(0x50)
    refuses("read: there is no transfer to read in", master.read, ack=True)
    refuses("write: 256 is no byte", master.write, 1, 256)
    refuses("address 0x80: expected 0 to 0x7f", master.start, 0x80)


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ((0x50, b"", -1), "count -1: expected the number of bytes to read, 0 or more"),
        ((0x50, "ab"), "data 'ab': expected bytes"),
        ((0x50, [300]), r"data \[300\]: expected bytes"),
        (("0x50",), "address '0x50': expected 0 to 0x7f"),
    ],
)
def test_an_invalid_transfer_is_refused_without_bus_traffic(asked: tuple[Any, ...], sentence: str) -> None:
    session, _ = bus()
    refuses(sentence, session.i2c.transfer, *asked)
    assert session.i2c.transfer(0x50, b"\x00", 1) == b"\x01"


def test_a_line_held_by_others_is_reported_with_their_names() -> None:
    held = {"kind": "hold", "wire": "SCL", "at": "2 ms", "length": "100 ms"}
    session = Session(case(fault=[held]), BUS)
    session.advance(session.ticks("2 ms") + 10)
    refuses(r"SCL is held low by .* for more than 25 ms; the bus was let go", session.i2c.start, 0x50)
    assert session.now == session.ticks("27 ms") + 10 + 1
    session.advance(session.ticks("110 ms"))
    assert session.i2c.transfer(0x50, b"\x00", 1) == b"\x01"


def test_a_session_without_both_wires_has_no_controller() -> None:
    with pytest.raises(OutsideError, match="SCL of case mine does not lead outside; name both"):
        _ = Session(case(), ("SDA",)).i2c


def test_single_bits_can_end_within_a_byte_and_clear_frees_the_bus() -> None:
    session, _ = bus()
    master = session.i2c
    assert master.start(0x50, read=True)
    assert master.bits(1, 1, 1) == [0, 0, 0]  # bits of 0x01
    assert session.pulls("SDA")
    assert master.clear() and not session.pulls("SDA")
    assert master.transfer(0x50, count=1) is not None
    refuses("bits: there is no transfer to clock bits in", master.bits, 1)
    master.start(0x50)
    refuses(r"bits: found \(1, 2\), expected 0, pulled low, or 1, let go", master.bits, 1, 2)
    assert (master.reads, master.writes) == (False, True)
    stranger = session.scene.wire("SDA").attach("stranger")
    stranger.drive(0)  # afterwards only one of the lines is high
    assert not master.clear() and session.level("SCL") == 1
    stranger.drive(1)
    session.scene.wire("SCL").attach("stranger").drive(0)
    assert not master.clear()


def beside_another_controller() -> Session:
    """Return a session at the time of a START to 0x68 by another unit."""
    heads = load(TIMING / "two_dsps.toml").model_copy(update={"budget": ()})
    found = Session(heads, BUS)
    pulled = found.advance(found.ticks("21 ms"))
    start = next(change.at for change in pulled if (change.line, change.level) == ("SDA", 0))
    session = Session(heads, BUS)
    session.advance(start)
    return session


def test_lost_arbitration_releases_the_bus() -> None:
    session = beside_another_controller()
    refuses(
        "another controller has won the bus; begin again when it is free",
        session.i2c.start,
        0x7F,
        error=ArbitrationLost,
    )
    assert not session.i2c.held
    session.advance(session.ticks("30 ms"))
    assert session.finish().wire_bytes == 27  # the winner's round of three chips
