"""The published package `i2cdriver` works on a port whose other end is a case."""

from __future__ import annotations

import os
import select
import sys
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from periph_sim.outside import OutsideError, replay
from periph_sim.outside.drivers import I2cDriverPort
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from tests.outside.sessions import BUS, case
from tests.scene.runs import TIMING

i2cdriver = pytest.importorskip("i2cdriver", reason="i2cdriver is not installed: the extra drivers has it")


@pytest.fixture(autouse=True)
def patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the package's timeout of one second of real time, since the machine may be busy."""
    monkeypatch.setattr(i2cdriver.serial, "Serial", partial(_patient, i2cdriver.serial.Serial))


def _patient(opened: Callable[..., Any], port: str, baud: int, timeout: float) -> Any:
    assert timeout == 1
    return opened(port, baud, timeout=120)


def test_an_unmodified_program_reads_writes_and_scans(tmp_path: Path) -> None:
    link, log = tmp_path / "i2c", tmp_path / "log"
    chip = case("register_slave")
    with I2cDriverPort(chip, BUS, link=link, log=log) as port:
        assert port.path == str(link)
        driver = i2cdriver.I2CDriver(port.path)
        assert driver.scan(silent=True) == [0x50]
        assert driver.regwr(0x50, 4, [1, 2, 3])
        assert driver.regrd(0x50, 4, "<H") == 0x0201
        assert not driver.regwr(0x51, 4, 1)
        driver.setspeed(400)
        data = bytes(range(130))  # needs three commands
        assert driver.start(0x50, 0) and driver.write(b"\x10" + data)
        assert driver.start(0x50, 0) and driver.write([0x10]) and driver.start(0x50, 1)
        assert driver.read(130) == data
        driver.stop()
        driver.getstatus()
        assert (driver.product, driver.speed, driver.mode) == ("i2cdriver1", 400, "I")
        driver.ser.close()
        again = i2cdriver.I2CDriver(port.path)
        assert again.regrd(0x50, 0x10, 2) == b"\x00\x01"
        again.ser.close()
    assert not link.is_symlink()
    assert replay(chip, log).wire_bytes == port.result.wire_bytes > 300


def test_a_program_captures_the_traffic_of_others() -> None:
    heads = load(TIMING / "two_dsps.toml").model_copy(update={"budget": ()})
    with I2cDriverPort(heads, BUS) as port:
        assert all(
            one.daemon for one in threading.enumerate() if one.name == "i2cdriver"
        )  # a program may never close the port
        driver = i2cdriver.I2CDriver(port.path, reset="never")
        driver.ser.timeout = 0.05  # a capture then returns what has come until now, or nothing
        events = driver.capture_start()()
        seen = [next(events) for _ in range(3)]
        driver.ser.close()
    assert seen == [i2cdriver.START(0x68, 0, True), i2cdriver.BYTE(0x1D, 0, True), i2cdriver.START(0x68, 1, True)]


def test_impossible_ports_are_refused_when_they_are_made(tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("mine")
    before = len(os.listdir("/proc/self/fd"))
    with (
        pytest.raises(OutsideError, match="taken: File exists; give the link another name"),
        I2cDriverPort(case(), BUS, link=taken),
    ):
        pass
    with pytest.raises(OutsideError, match="SCL of case mine does not lead outside"), I2cDriverPort(case(), ["SDA"]):
        pass
    with pytest.raises(BadCase, match="no wire leads outside"), I2cDriverPort(case()):
        pass
    assert taken.read_text() == "mine"
    assert len(os.listdir("/proc/self/fd")) == before


def test_a_system_without_pseudo_terminals_is_refused_when_a_port_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "periph_sim.outside.live.i2cdriver_door", None)
    with pytest.raises(ImportError, match="i2cdriver_door"), I2cDriverPort(case(), BUS):
        pass


def test_a_port_is_raw_and_unread_answers_do_not_delay_its_end(tmp_path: Path) -> None:
    """Each question has a status of 80 bytes as answer, so the answers exceed the buffer of a pseudo-terminal."""
    link = tmp_path / "i2c"
    with I2cDriverPort(case("register_slave"), BUS, link=link) as port:
        client = os.open(port.path, os.O_RDWR | os.O_NOCTTY)
        os.write(client, b"e\n")
        assert os.read(client, 10) == b"\n"
        os.write(client, b"?" * 1000)
        assert select.select([client], [], [], 60)[0]
        link.unlink()
    os.close(client)
