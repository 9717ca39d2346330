"""`busio.I2C`, as drivers call it, transfers on a session's bus."""

from __future__ import annotations

import errno
from typing import Any

import pytest

from periph_sim.outside.drivers import I2C
from periph_sim.outside.session import Session
from tests.outside.sessions import fails
from tests.outside.test_register_slave import slave


def bus() -> I2C:
    return I2C(slave(registers="e5 02 03", address=0x53))


def test_calls_of_drivers() -> None:
    i2c = bus()
    assert i2c.try_lock() and not i2c.try_lock()
    i2c.unlock()
    assert i2c.try_lock()
    assert i2c.scan() == [0x53]
    got = bytearray(4)
    i2c.writeto(0x53, b"\x00", end=1)
    i2c.readfrom_into(0x53, got, start=1, end=3)
    assert got == b"\x00\xe5\x02\x00"
    i2c.writeto(0x53, b"\xff\x02\x77\x88", start=1)
    i2c.writeto_then_readfrom(0x53, b"\x02\x01", got, out_end=1, in_start=2)
    assert got == b"\x00\xe5\x77\x88"


def test_without_bounds_the_whole_buffer_is_transferred() -> None:
    """S 53W 01 P   S 53R 02 03 P   S 53W 00 Sr 53R E5 02 P"""
    i2c, got = bus(), bytearray(2)
    i2c.writeto(0x53, b"\x01")
    i2c.readfrom_into(0x53, got)
    assert got == b"\x02\x03"
    i2c.writeto_then_readfrom(0x53, b"\x00", got)
    assert got == b"\xe5\x02"


def test_a_scan_omits_the_reserved_addresses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(I2C, "_asks", lambda _, address: True)
    assert bus().scan() == list(range(0x08, 0x78))


def test_a_missing_acknowledge_is_an_oserror() -> None:
    with bus() as i2c:
        for call, data in ((i2c.writeto, b"\x00"), (i2c.readfrom_into, bytearray(1))):
            fails(errno.ENODEV, call, 0x20, data, match="address 0x20 was not acknowledged")
        got = bytearray(1)
        i2c.writeto_then_readfrom(0x53, b"\x00", got)
        assert got == b"\xe5"


@pytest.mark.parametrize("address", [-1, 0x80, "0x50"])
def test_an_invalid_address_is_an_invalid_argument(address: Any) -> None:
    with bus() as i2c:
        fails(errno.EINVAL, i2c.writeto, address, b"\x00", match=f"address {address!r}: expected 0 to 0x7f")


def test_a_held_bus_is_a_timeout(monkeypatch: pytest.MonkeyPatch) -> None:
    session = slave()
    i2c = I2C(session)
    session.scene.wire("SCL").attach("stranger").drive(0)
    match = "SCL is held low by stranger for more than 25 ms"
    fails(errno.ETIMEDOUT, i2c.writeto, 0x50, b"\x00", match=match)


def test_scl_runs_at_the_frequency_given_or_at_100_khz() -> None:
    session = slave()
    I2C(session)
    assert session.i2c.rate == "100000 Hz"
    I2C(session, frequency=400_000)
    assert session.i2c.rate == "400000 Hz"


def test_time_passes_between_calls() -> None:
    session: Session = slave()
    i2c = I2C(session, frequency=400_000, pause="3 ms")
    before = session.now
    i2c.writeto(0x50, b"\x00")
    assert session.ticks("3 ms") < session.now - before < session.ticks("3.2 ms")
