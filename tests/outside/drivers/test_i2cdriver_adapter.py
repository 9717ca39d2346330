"""The protocol of the I2CDriver, byte by byte, on a session's bus without a port and a program."""

from __future__ import annotations

from binascii import crc_hqx
from random import Random

import pytest

from periph_sim.outside import Session
from periph_sim.outside.drivers.i2cdriver_adapter import I2cDriver
from periph_sim.scene.case.load import load
from tests.outside.sessions import BUS
from tests.outside.test_i2c_master import beside_another_controller
from tests.outside.test_register_slave import slave
from tests.scene.runs import TIMING

ACKED, REFUSED, TIMED_OUT = b"1", b"0", b"2"
WRITE, READ = b"s\xa0", b"s\xa1"  # START with address 0x50


def adapter(session: Session | None = None) -> I2cDriver:
    session = session or slave(registers="0a 0b 0c 0d")
    return I2cDriver(session, session.ticks("100 us"))


@pytest.mark.parametrize(
    ("sent", "said"),
    [
        (b"e\x00e\xff", b"\x00\xff"),
        (b"@" * 64 + b"1478w" + b"vff" + b"m" + WRITE[:1] + b"e!", b"X!"),
        (WRITE + b"\xc0\x01" + READ + b"\x82p", ACKED * 3 + b"\x0b\x0c\x0d"),
        (WRITE + b"\xc2\x10\xaa\xbb" + b"p" + b"r\x50\x10\x03", ACKED * 2 + b"\xaa\xbb\x00"),
        (b"r\x50\x02\x01" + READ + b"a\x02\x80p", b"\x0c" + ACKED + b"\x0d\x00\x00"),
        (b"r\x50\x00\x00", b"\x0a\x0b\x0c\x0d" + bytes(252)),  # a count of 0 means 256
        (READ + b"a\x00", ACKED + b"\x0a\x0b\x0c\x0d" + bytes(252)),
        (b"s\x40\xc1\x01\x02p", REFUSED + REFUSED),
        (b"s\x41\x81p" + b"r\x20\x00\x02", REFUSED + b"\xff" * 4),
        (b"\x83\xc0\x00p", b"\xff" * 4 + REFUSED),  # without a START there is nothing to read or to write to
        (b"s\xa1\xc0\x00\x80p", ACKED + REFUSED + b"\x0a"),
        (WRITE + b"x" + b"r\x50\x00\x01", ACKED + b"3\x0a"),
        (b"b\x0a\x1a\x02\x12\x0a@e!", b"\x03\x01!"),  # SCL and SDA high, SCL low
    ],
)
def test_replies(sent: bytes, said: bytes) -> None:
    assert adapter().receive(sent) == said
    slowly = adapter()
    assert b"".join(slowly.receive(bytes([byte])) for byte in sent) == said


def test_the_last_byte_of_a_read_is_not_acknowledged() -> None:
    session, acked = slave(registers="0a 0b 0c 0d"), []
    session.scene.on_transfer(lambda transfer: acked.extend(phase.acks for phase in transfer.phases))
    adapter(session).receive(READ + b"\x82p")
    assert acked == [[True, True, False]]


def test_time_passes_before_each_start() -> None:
    session = slave(registers="0a")
    driver = I2cDriver(session, session.ticks("3 ms"))
    before = session.now
    driver.receive(b"r\x50\x00\x01")
    assert session.ticks("6 ms") < session.now - before < session.ticks("6.5 ms")


def test_a_scan_reports_each_address() -> None:
    session = slave(registers="0a")
    reports = adapter(session).receive(b"d")
    assert session.level("SCL") == session.level("SDA") == 1 and not session.i2c.held
    assert len(reports) == 112
    assert [address for address, report in enumerate(reports, 8) if report == ACKED[0]] == [0x50]


def test_the_status_contains_rate_lines_pull_ups_and_checksum() -> None:
    driver = adapter()
    booted = driver.receive(b"?")
    assert booted == b"[i2cdriver1 F28335 000000000 5.000 000 25.0 I 1 1 100 24 ffff".ljust(79) + b"]"
    driver.receive(b"4u\x09" + WRITE + b"\xc0\x31p")
    checksum = f"{crc_hqx(bytes([0xA0, 0x31]), 0xFFFF):04x}"
    assert driver.receive(b"?").split()[9:12] == [b"400", b"09", checksum.encode()]
    assert driver.receive(b"1?").split()[9] == b"100"
    assert driver.receive(b"4_?") == booted
    assert len(driver.receive(b"J")) == 80


def test_a_held_line_is_a_timeout_and_a_reset_reports_which() -> None:
    session = slave(registers="0a")
    driver = adapter(session)
    stranger = session.scene.wire("SCL").attach("stranger")
    stranger.drive(0)
    assert driver.receive(WRITE + b"\xc0\x00p") == TIMED_OUT + b"2"
    assert driver.receive(b"x") == b"2"  # SDA is high
    stranger.drive(1)
    session.advance(session.now + 1)
    assert (
        driver.receive(b"x\xc0\x00" + WRITE + b"p") == b"3" + REFUSED + ACKED
    )  # neither has a START; the timeout is over


@pytest.mark.parametrize(
    ("held", "commands", "reports"),
    [
        ("SCL", b"\xc0\x00", TIMED_OUT),  # a byte
        ("SDA", READ + b"\xc0\x00", TIMED_OUT * 2),  # a repeated START, and a byte
        ("SDA", b"p\xc0\x00", TIMED_OUT),  # a STOP and a byte; the byte has the first report
    ],
)
def test_a_transfer_ended_by_a_held_line_reports_a_timeout_and_no_ack(
    held: str, commands: bytes, reports: bytes
) -> None:
    """S 50W A, then a line is held. The bus is released."""
    session = slave(registers="0a")
    driver = adapter(session)
    assert not driver.capturing and driver.receive(WRITE) == ACKED
    session.scene.wire(held).attach("stranger").drive(0)
    assert driver.receive(commands) == reports
    assert session.level("SCL") == (held == "SDA")


def test_lost_arbitration_is_reported() -> None:
    driver = I2cDriver(beside_another_controller(), 0)
    assert driver.receive(b"s\xfe\xc0\x00p") == b"44"


def test_a_reset_frees_a_bus_that_was_left_within_a_read() -> None:
    session = slave(registers="00")
    driver = adapter(session)
    assert driver.receive(READ) == ACKED  # and drives the first bit, a 0
    assert session.pulls("SDA")
    assert driver.receive(b"x") == b"3"
    assert not session.pulls("SDA")
    assert driver.receive(b"r\x50\x01\x01") == b"\x00"


def test_a_capture_records_the_traffic_of_others() -> None:
    """One F28335 reads the chips of another: 68W 1D, 68R 11 12 ..., captured in tokens of three bits and an ACK."""
    changes = ["unit.imu.settings.table={0x68='11 12 13 14 15 16'}", "budget=[]"]
    case = load(TIMING / "two_dsps.toml", changes)
    session = Session(case, BUS)
    driver = adapter(session)
    assert driver.receive(b"c") == b"" and driver.capturing
    session.advance(session.ticks("25 ms"))
    got = driver.captured()
    nibbles = [nibble for byte in got for nibble in (byte >> 4, byte & 15)]
    # START, 0xD0 ACK = 110 100 000, 0x1D ACK = 000 111 010; START, 0xD1 ACK = 110 100 010, 0x11 ACK = 000 100 010
    assert nibbles[:14] == [1, 14, 12, 8, 8, 15, 10, 1, 14, 12, 10, 8, 12, 10]
    assert [nibbles.count(token) for token in (1, 2)] == [6, 3]
    assert driver.receive(b"@") == b"" and not driver.capturing
    session.advance(session.ticks("45 ms"))
    assert driver.captured() == b"" and driver.receive(b"e@") == b"@"
    driver.receive(b"c")
    session.advance(session.ticks("65 ms"))
    assert driver.receive(b"c") == driver.captured() == b"", "the end of a capture discards its remaining tokens"


@pytest.mark.parametrize("sent", [b"c", b"b", b"b\x02@"])
def test_a_capture_and_bit_mode_release_the_bus(sent: bytes) -> None:
    """After START and an address SCL is held low, and released when a capture or bit mode begins, or bit mode ends."""
    session = slave(registers="0a")
    driver = adapter(session)
    assert driver.receive(WRITE) == ACKED and session.level("SCL") == 0
    driver.receive(sent)
    assert session.level("SCL") == 1


def test_commands_work_after_garbage() -> None:
    draw = Random(12)
    driver = adapter()
    for _ in range(12):
        driver.receive(bytes(draw.choice([*range(32), *b"srpaxubcm@", 0x82, 0xC1]) for _ in range(30)))
        driver.receive(b"@" * 256)
        assert driver.receive(b"x") == b"3"
        assert driver.receive(b"e\x42") == b"\x42"
