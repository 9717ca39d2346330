"""`/dev/i2c-N` on a session's bus, opened by number: with smbus2 as it is published, and as plain files."""

from __future__ import annotations

import errno
import fcntl
import os
from collections.abc import Callable
from typing import Any

import pytest

from periph_sim.outside.drivers import i2c_dev
from periph_sim.outside.drivers.i2c_dev import (
    BLOCK_DATA,
    BLOCK_PROC_CALL,
    I2C_BLOCK,
    RETRIES,
    SLAVE,
    SMBUS,
    TENBIT,
    TIMEOUT,
)
from tests.outside.sessions import fails
from tests.outside.test_i2c_master import beside_another_controller
from tests.outside.test_register_slave import slave

smbus2 = pytest.importorskip("smbus2", reason="smbus2 is not installed: the extra dev has it")


@pytest.fixture
def number_1() -> Any:
    with i2c_dev({1: slave(address=0x20, registers="01 02 03 04 05 06")}):
        yield smbus2.SMBus(1)


def test_bytes_words_and_blocks(number_1: Any) -> None:
    bus = number_1
    assert bus.read_byte_data(0x20, 2) == 3
    bus.write_byte_data(0x20, 0x10, 0xA5)
    assert bus.read_byte_data(0x20, 0x10) == 0xA5
    assert bus.read_word_data(0x20, 0) == 0x0201
    bus.write_word_data(0x20, 0x12, 0xBEEF)
    assert bus.read_i2c_block_data(0x20, 0x12, 2) == [0xEF, 0xBE]
    bus.write_i2c_block_data(0x20, 0x20, [3, 7, 8, 9])
    assert bus.read_block_data(0x20, 0x20) == [7, 8, 9]
    bus.write_block_data(0x20, 0x30, [5, 6])
    assert bus.read_i2c_block_data(0x20, 0x30, 3) == [2, 5, 6]
    bus.write_byte(0x20, 4)
    assert [bus.read_byte(0x20), bus.read_byte(0x20)] == [5, 6]
    assert bus.process_call(0x20, 0x40, 0x1234) == 0
    bus.write_quick(0x20)
    assert bus.block_process_call(0x20, 0x20, [9]) == [9, 0, 0, 0, 0, 0, 0, 0]


def test_its_functions_are_those_that_it_supports(number_1: Any) -> None:
    every = smbus2.I2cFunc
    cannot = every.ADDR_10BIT | every.PROTOCOL_MANGLING | every.NOSTART | every.SLAVE | every.SMBUS_HOST_NOTIFY
    assert number_1.funcs == sum(every) & ~cannot


@pytest.mark.parametrize("length", [1, 32])
def test_blocks_have_1_to_32_bytes(number_1: Any, length: int) -> None:
    bus, data = number_1, [*range(100, 100 + length)]
    bus.write_block_data(0x20, 0x40, data)
    assert bus.read_block_data(0x20, 0x40) == data
    assert bus.read_i2c_block_data(0x20, 0x41, length) == data
    bus.write_i2c_block_data(0x20, 0x80, data)
    assert bus.read_i2c_block_data(0x20, 0x80, length) == data
    bus.write_byte_data(0x20, 0x40, 33)
    match = "a block of 33 bytes was received; expected 1 to 32"
    fails(errno.EPROTO, bus.read_block_data, 0x20, 0x40, match=match)


@pytest.mark.parametrize("length", [0, 33])
def test_a_block_of_another_length_is_refused_before_it_is_sent(length: int) -> None:
    session = slave(address=0x20)
    with i2c_dev({1: session}, pause="0 us"), smbus2.SMBus(1) as bus:
        before = session.now
        for size, write in ((BLOCK_DATA, 0), (I2C_BLOCK, 0), (I2C_BLOCK, 1), (BLOCK_PROC_CALL, 0)):
            asked = smbus2.smbus2.i2c_smbus_ioctl_data.create(read_write=write, command=1, size=size)
            asked.data.contents.block[0] = length
            fcntl.ioctl(bus.fd, SLAVE, 0x20)
            match = f"a block of {length} bytes; expected 1 to 32"
            fails(errno.EINVAL, fcntl.ioctl, bus.fd, SMBUS, asked, match=match)
        assert session.now == before


def test_unsupported_transfers_and_flags_are_refused(number_1: Any) -> None:
    asked = smbus2.smbus2.i2c_smbus_ioctl_data.create(size=9)
    fcntl.ioctl(number_1.fd, SLAVE, 0x20)
    message = smbus2.i2c_msg.write(0x20, [1])
    message.flags = 0x10  # ten bits
    fails(errno.EOPNOTSUPP, fcntl.ioctl, number_1.fd, SMBUS, asked, match="no SMBus transfer: 9")
    said = "flags 0x10 of a message; only reading is one here"
    fails(errno.EOPNOTSUPP, number_1.i2c_rdwr, message, match=said)


def test_messages_with_repeated_starts(number_1: Any) -> None:
    write, read = smbus2.i2c_msg.write(0x20, [1]), smbus2.i2c_msg.read(0x20, 3)
    number_1.i2c_rdwr(write, read)
    assert list(read) == [2, 3, 4]


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda bus: bus.read_byte_data(0x33, 0), errno.ENXIO),
        (lambda bus: bus.write_byte_data(0x33, 0, 0), errno.ENXIO),
        (lambda bus: bus.i2c_rdwr(smbus2.i2c_msg.read(0x33, 1)), errno.ENXIO),
        (lambda bus: bus.i2c_rdwr(smbus2.i2c_msg.write(0x80, [1])), errno.EINVAL),
        (lambda bus: bus.i2c_rdwr(smbus2.i2c_msg.write(0x20, [1]), smbus2.i2c_msg.read(0x80, 1)), errno.EINVAL),
        (lambda bus: bus.read_block_data(0x20, 0x70), errno.EPROTO),  # the count in the block is 0
    ],
)
def test_failures_have_the_error_codes_of_linux_and_leave_the_bus_free(
    call: Callable[[Any], object], code: int, number_1: Any
) -> None:
    fails(code, call, number_1)
    assert number_1.read_byte_data(0x20, 0) == 1


def test_lost_arbitration_has_the_error_code_for_another_attempt() -> None:
    with i2c_dev({1: beside_another_controller()}, pause="0 us"), smbus2.SMBus(1) as bus:
        fails(errno.EAGAIN, bus.write_byte, 0x7F, 0, match="another controller has won the bus")


def test_plain_files_and_their_refusals() -> None:
    with i2c_dev({3: slave(registers="0a 0b")}):
        file = os.open("/dev/i2c-3", os.O_RDWR)
        fails(errno.EINVAL, os.read, file, 1, match="no address was given")
        fcntl.ioctl(file, SLAVE, 0x50)
        assert os.write(file, b"\x00") == 1
        assert os.read(file, 2) == b"\x0a\x0b"
        for request, argument, code in (
            (SLAVE, 0x80, errno.EINVAL),
            (TENBIT, 1, errno.EINVAL),
            (0x1234, 0, errno.ENOTTY),
        ):
            fails(code, fcntl.ioctl, file, request, argument)
        assert (RETRIES, TIMEOUT, TENBIT) == (0x701, 0x702, 0x704)  # linux/i2c-dev.h
        for request in (TENBIT, RETRIES, TIMEOUT):
            assert fcntl.ioctl(file, request, 0) == 0
        os.close(file)
        fails(errno.ENOENT, os.open, "/dev/i2c-4", os.O_RDWR)


def test_the_program_computes_for_a_pause_before_each_transfer() -> None:
    ends = []
    for pause in ("0 us", "1 ms"):
        session = slave(address=0x20)
        with i2c_dev({1: session}, pause=pause), smbus2.SMBus(1) as bus:
            bus.write_quick(0x20)
            ends.append(session.now)
    assert ends[1] - ends[0] == session.ticks("1 ms")


def test_other_files_are_not_affected(tmp_path: Any) -> None:
    opened, ioctl = os.open, fcntl.ioctl
    with i2c_dev({}):
        file = os.open(tmp_path / "a", os.O_RDWR | os.O_CREAT)
        os.write(file, b"abc")
        os.lseek(file, 0, os.SEEK_SET)
        assert os.read(file, 3) == b"abc"
        os.close(file)
    assert (os.open, fcntl.ioctl) == (opened, ioctl)


def code_of(*data: int) -> int:
    """Return the CRC-8, computed by division of polynomials as in SMBus 3.2 section 6.4.1.3."""
    rest = int.from_bytes(bytes(data), "big") << 8
    while rest.bit_length() > 8:
        rest ^= 0x107 << rest.bit_length() - 9
    return rest


def test_packet_error_codes_are_sent_and_checked() -> None:
    """The chip does not support them: it stores a received code as data, and sends the bytes that follow the data."""
    read, word = code_of(0x40, 0x00, 0x41, 0xAB), code_of(0x40, 0x04, 0x41, 0x12, 0x34)
    block = code_of(0x40, 0x08, 0x41, 2, 7, 8)
    registers = bytes([0xAB, read, 0, 0, 0x12, 0x34, word, 0, 2, 7, 8, block]).hex(" ")
    with i2c_dev({1: slave(address=0x20, registers=registers)}), smbus2.SMBus(1) as bus:
        assert bus.funcs & smbus2.I2cFunc.SMBUS_PEC
        bus.pec = 1
        assert bus.read_byte_data(0x20, 0) == 0xAB
        assert bus.read_word_data(0x20, 4) == 0x3412
        assert bus.read_block_data(0x20, 8) == [7, 8]
        bus.write_byte_data(0x20, 0x40, 0x99)
        bus.write_block_data(0x20, 0x50, [5, 6])
        assert bus.read_i2c_block_data(0x20, 0x40, 2) == [
            0x99,
            code_of(0x40, 0x40, 0x99),
        ]  # a block read of I2C has no code of its own
        assert bus.read_i2c_block_data(0x20, 0x50, 4) == [2, 5, 6, code_of(0x40, 0x50, 2, 5, 6)]
        bus.write_byte(0x20, 0x60)
        assert bus.read_i2c_block_data(0x20, 0x60, 1) == [code_of(0x40, 0x60)]
        bus.write_quick(0x20)
        right = code_of(0x40, 0x20, 0x41, 0)
        fails(errno.EBADMSG, bus.read_byte_data, 0x20, 0x20, match=f"error code 0x00; expected {right:#04x}")
        bus.pec = 0
        assert bus.read_byte_data(0x20, 0x20) == 0


def test_a_file_opened_by_name_is_the_adapter() -> None:
    """Blinka's pure Python SMBus does so."""
    pureio = pytest.importorskip(
        "Adafruit_PureIO.smbus", reason="Adafruit-PureIO is not installed: see the extra drivers"
    )
    with i2c_dev({1: slave(address=0x20, registers="01 02 03 04")}):
        bus = pureio.SMBus(1)
        assert bus.read_byte_data(0x20, 2) == 3
        bus.write_byte_data(0x20, 2, 0x33)
        bus.write_byte(0x20, 1)
        assert bytes(bus.read_bytes(0x20, 2)) == b"\x02\x33"
        bus.close()
        fails(errno.ENOENT, pureio.SMBus, 7)


def test_a_file_returned_by_open_is_the_adapter() -> None:
    with i2c_dev({1: slave(address=0x20, registers="01 02 03 04")}):
        with open("/dev/i2c-1", "r+b", buffering=0) as file:
            fails(errno.EINVAL, file.write, b"\x00", match="no address was given")
            assert fcntl.ioctl(file, SLAVE, 0x20) == 0
            assert file.write(b"\x03") == 1 and file.read(1) == b"\x04"
            assert file.readable() and file.writable() and file.fileno() >= 1 << 20
        fails(errno.ENOENT, open, "/dev/i2c-2", "rb")
