"""A data register that receives the value that it already has makes a record like any other change."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from periph_sim.core.records import RECORDED, Kind, Record
from periph_sim.firmware import start_i2c
from periph_sim.firmware.sci import start_sci
from periph_sim.processor.dsp import Dsp
from periph_sim.records.cause_trace.causes import change_seen
from periph_sim.scene import unit as unit_module
from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from tests.records.scenes import recorded
from tests.scene.runs import TIMING
from tests.scene.small import case

REQUEST = {"address": 0x68, "write": "55 55 55", "count": 3}


def changes(
    monkeypatch: pytest.MonkeyPatch, main: Callable[[Dsp], None], module: str, field: str, **more: Any
) -> list[Record]:
    """All records of a field of the module while `main` runs."""
    found: list[Record] = []
    program = Firmware("under test", lambda dsp, settings: main(dsp), None)
    monkeypatch.setattr(unit_module, "load_firmware", lambda name: program)
    made = case(unit={"dsp": {"firmware": "under test", "modules": [module]}}, **more)
    Scene(made, lambda recorder, _: recorder.subscribe(RECORDED, found.append)).run()
    return [one for one in found if (one.kind, one.where, one.what) == (Kind.FLAG, f"dsp.{module}", field)]


def receives(dsp: Dsp, fifo: bool) -> None:
    sci = start_sci(dsp, fifo=fifo)
    while True:
        if fifo:
            dsp.spin(lambda: sci.SCIFFRX.RXFFST == 4)
            assert [sci.SCIRXBUF.all for _ in range(4)] == [0x55] * 4
        else:
            dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
            assert sci.SCIRXBUF.all == 0x55


@pytest.mark.parametrize("fifo", [False, True])
@pytest.mark.parametrize("field", ["SCIRXBUF.RXDT", "SCIRXEMU.ERXDT"])
def test_each_equal_character_is_a_record(monkeypatch: pytest.MonkeyPatch, fifo: bool, field: str):
    """In FIFO mode, SCIRXBUF has the next word after each read."""
    serial = {"baud": 114_329, "send": [{"to": "dsp.SCI-A", "text": "U" * 8, "at": "1 ms"}]}
    found = changes(monkeypatch, lambda dsp: receives(dsp, fifo), "SCI-A", field, serial=serial)
    assert [record.value for record in found] == [0x55] * 8
    assert all(record.cause for record in found)


def test_each_equal_write_of_scitxbuf_is_a_record(monkeypatch: pytest.MonkeyPatch):
    def sends(dsp: Dsp) -> None:
        sci = start_sci(dsp, fifo=False)
        for _ in range(3):
            dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
            sci.SCITXBUF.all = 0xAA

    assert [record.value for record in changes(monkeypatch, sends, "SCI-A", "SCITXBUF.TXDT")] == [0xAA] * 3


def answers(dsp: Dsp) -> None:
    """Receive three bytes as a slave, and send three."""
    start_i2c(dsp, own_address=0x68)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    for _ in range(3):
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
        assert i2c.I2CDRR.all == 0x55
    for _ in range(3):
        dsp.spin(lambda: i2c.I2CSTR.XRDY == 1)
        i2c.I2CDXR.all = 0x77


@pytest.mark.parametrize(("field", "value"), [("I2CDRR.DATA", 0x55), ("I2CDXR.DATA", 0x77)])
@pytest.mark.parametrize("disable", ["bits", ()])
def test_each_equal_byte_of_i2c_is_a_record(monkeypatch: pytest.MonkeyPatch, field: str, value: int, disable: object):
    head = {"first": "1 ms", "rounds": 1, "request": [REQUEST]}
    found = changes(monkeypatch, answers, "I2C-A", field, controller=head, disable=disable)
    assert [record.value for record in found] == [value] * 3


def test_the_cause_of_each_read_of_a_fifo_is_the_word_that_it_reads():
    """Words of the frames are repeated. The change that a read saw is always after the read before it."""
    run = recorded(load(TIMING / "imu_hil_published.toml", []), "0.07")
    reads = run.rows(Kind.ACCESS, "dsp", "R SCI-A.SCIRXBUF").tolist()
    assert len(reads) == 4 * 12
    seen = [change_seen(run, row, run.record(row)) for row in reads]
    assert all(change is not None and before < change for before, change in zip([-1, *reads], seen, strict=False))
