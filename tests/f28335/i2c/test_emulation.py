"""The I2C at breakpoints (SPRUG03B Table 5, FREE), and debugger reads without side effects (Tables 10 and 11)."""

from __future__ import annotations

import pytest

from ..i2c_bus import SCL, SLOT, Bench, Foreign, Target

rule = pytest.mark.rule


def start(b: Bench, way: str, free: str = "") -> None:
    b.w("I2CCNT", 1)
    if way == "transmitter":
        b.mode("MST TRX STT STP " + free, data=0x5A)
    else:
        b.mode("MST STT STP " + free)


def finish(b: Bench, way: str) -> None:
    if way == "receiver":
        assert b.drain(1) == [0x3C]
    assert b.decoded_at_stop() == ("S 50W A 5a A P" if way == "transmitter" else "S 50R A 3c N P")


@rule("I2C-323")
@pytest.mark.parametrize("pulse", [1, 5, 9, 12])
@pytest.mark.parametrize("way", ["transmitter", "receiver"])
@pytest.mark.parametrize("scl", [pytest.param(0, marks=rule("I2C-321")), pytest.param(1, marks=rule("I2C-322"))])
def test_a_breakpoint_holds_scl_from_the_next_low_on(scl: int, way: str, pulse: int):
    b = Bench(Target(gives=[0x3C]))
    start(b, way)
    edge = b.edge(SCL, scl, pulse)
    b.run(60)
    b.suspend(True)
    assert not scl or b.edge(SCL, 0) == edge + 150
    assert b.held(50 * SLOT)
    b.suspend(False)
    finish(b, way)


@rule("I2C-325")
@pytest.mark.parametrize("way", ["transmitter", "receiver"])
def test_with_free_a_breakpoint_changes_nothing(way: str):
    edges = []
    for stop in (False, True):
        b = Bench(Target(gives=[0x3C]))
        start(b, way, "FREE")
        b.edge(SCL, 0, 4)
        b.suspend(stop)
        finish(b, way)
        edges.append(b.edges)
    assert edges[0] == edges[1]


@rule("I2C-322", "I2C-323")
def test_a_breakpoint_that_is_over_before_scl_falls_changes_nothing():
    edges = []
    for stop in (False, True):
        b = Bench(Target())
        start(b, "transmitter")
        b.edge(SCL, 1, 4)
        b.suspend(stop)
        b.run(60)
        b.suspend(False)
        finish(b, "transmitter")
        edges.append(b.edges)
    assert edges[0] == edges[1]


@rule("I2C-325")
def test_with_free_a_slave_continues_at_a_breakpoint():
    b = Bench(Foreign("S 50W 12 34 P"), own=0x50)
    b.mode("FREE")
    b.edge(SCL, 0, 4)
    b.suspend(True)
    assert b.drain(2) == [0x12, 0x34]
    b.run(4 * SLOT)
    assert b.foreign.acknowledges == "AAA"


@rule("I2C-326")
def test_a_debugger_read_of_i2cdrr_leaves_rrdy_and_rsfull():
    b = Bench(Target(gives=[1, 2, 3]))
    b.mode("MST STT STP", count=3)
    b.until(lambda: b.flag("RSFULL"))
    assert b.peek("I2CDRR") == 1
    assert b.peek("I2CDRR") == 1
    assert b.flags("RSFULL RRDY") == "RSFULL RRDY"
    assert b.r("I2CDRR") == 1
    assert not b.flag("RSFULL")


@rule("I2C-327", "I2C-328")
@pytest.mark.parametrize("name, code", [("AL", 1), ("NACK", 2), ("SCD", 6)])
def test_a_debugger_read_of_i2cisrc_leaves_the_code_and_its_flag(name: str, code: int):
    partners = {"AL": [Target(0x48), Foreign("S 48W 77 P", at=None)], "NACK": [], "SCD": [Target()]}[name]
    b = Bench(*partners)
    b.w("I2CIER", 1 << code - 1)
    b.mode("MST TRX STT STP", count=1, data=1)
    b.until(lambda: b.flag(name))
    b.run(50)
    assert [b.peek("I2CISRC"), b.peek("I2CISRC")] == [code, code]
    assert b.flag(name)
    assert b.r("I2CISRC") == code
    assert not b.flag(name)
