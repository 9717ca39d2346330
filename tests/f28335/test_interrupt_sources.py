"""Every interrupt source requests if its flag and its enable are 1, and otherwise does not."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from periph_sim.core.options import options_from
from periph_sim.f28335.cpu_timer.module import CpuTimer
from periph_sim.f28335.cpu_timer.register_map import PRD, TCR, TPR
from periph_sim.f28335.system_options import SystemOptions

from .i2c_registers import AAS, FFEN, FFIENA, FFRST, INT1, INT2
from .i2c_rig import BIT, OTHER, OWN, Rig
from .sci_rig import SciRig, frame

# I2C: I2CINT1A ----------------------------------------------------------------------------------------

SOURCES = ["AL", "NACK", "ARDY", "RRDY", "XRDY", "SCD", "AAS"]  # bits 0 to 6 of I2CIER, SPRUG03B table 9


class Watching(Rig):
    """Rig that records the sources whose flag was 1 at any time."""

    seen = 0

    def settle(self) -> None:
        super().settle()
        status = self.status()
        self.seen |= status & 0x3F | (0x40 if status & AAS else 0)


def no_traffic(rig: Rig) -> None:
    rig.wait(4 * BIT)


def traffic_for_others(rig: Rig) -> None:
    rig.receive(0x12, address=OTHER)
    rig.restart(OTHER << 1 | 1)
    rig.send(0xFF)
    rig.stop()


def written_by_master(rig: Rig) -> None:
    rig.receive(0x12)
    rig.read("I2CDRR")
    rig.stop()


def read_by_master(rig: Rig) -> None:
    rig.begin_read()
    rig.write("I2CDXR", 0x5A)
    rig.acked()
    rig.read_byte(ack=False)
    rig.stop()


def as_master(rig: Rig) -> None:
    rig.write_other()
    rig.wait(30 * BIT)


def as_master_on_a_busy_bus(rig: Rig) -> None:
    rig.address(OTHER)
    as_master(rig)


SCENARIOS = [no_traffic, traffic_for_others, written_by_master, read_by_master, as_master, as_master_on_a_busy_bus]


@pytest.mark.rule("I2C-272", "I2C-273")
@pytest.mark.parametrize("scenario", SCENARIOS)
@pytest.mark.parametrize("source", range(7), ids=SOURCES)
def test_a_source_requests_if_its_flag_was_1(scenario: Callable[[Rig], None], source: int):
    rig = Watching()
    rig.begin()
    rig.write("I2CIER", 1 << source)
    rig.wait(20)
    scenario(rig)
    assert rig.requested(20) == (INT1 if rig.seen >> source & 1 else 0)
    assert rig.peek("I2CISRC") & 7 == (source + 1 if rig.seen >> source & 1 else 0)


def test_each_flag_but_xrdy_is_1_in_some_scenarios_only():
    shown = []
    for scenario in SCENARIOS:
        rig = Watching()
        rig.begin()
        scenario(rig)
        shown.append(rig.seen)
    ever, always = 0, 0x7F
    for flags in shown:
        ever, always = ever | flags, always & flags
    assert (ever, always) == (0x7F, 0x10), "only XRDY is 1 in all scenarios"


@pytest.mark.rule("I2C-273")
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_without_an_enable_no_flag_requests(scenario: Callable[[Rig], None]):
    rig = Watching()
    rig.begin()
    scenario(rig)
    rig.wait(20)
    assert rig.seen and rig.requested() == 0 and rig.peek("I2CISRC") == 0


# I2C: I2CINT2A ----------------------------------------------------------------------------------------


@pytest.mark.rule("I2C-297", "I2C-304")
@pytest.mark.parametrize(("tx", "rx"), [(0, 0), (FFIENA, 0), (0, FFIENA), (FFIENA, FFIENA)])
@pytest.mark.parametrize(("tx_level", "rx_level"), [(0, 1), (4, 2), (16, 16)])
def test_a_fifo_requests_if_its_flag_is_1_and_enabled(tx: int, rx: int, tx_level: int, rx_level: int):
    rig = Rig().begin(fifos=(FFEN | FFRST | tx | tx_level, FFRST | rx | rx_level))
    rig.address(OWN)
    for byte in (1, 2, 3):
        rig.send(byte)
    rig.stop()
    tx_flag, rx_flag = (rig.peek(name) >> 7 & 1 for name in ("I2CFFTX", "I2CFFRX"))
    assert (tx_flag, rx_flag) == (1, rx_level <= 3), "the count 0 of the transmit FIFO is not above any level"
    assert rig.requested() == (INT2 if tx or (rx and rx_flag) else 0)


# SCI --------------------------------------------------------------------------------------------------

LINES = {
    "idle": "1" * 30,
    "good": frame(0x4B) + "1" * 3,
    "no stop bit": frame(0x4B, bad="stop") + "1" * 3,
    "break": "0" * 25 + "1" * 3,
}


@pytest.mark.rule("SCI-139", "SCI-141", "SCI-142")
@pytest.mark.parametrize("text", LINES.values(), ids=LINES)
@pytest.mark.parametrize("enable", ["", "RXBKINTENA", "RXERRINTENA"])
def test_a_receive_source_requests_if_its_flag_rose_and_is_enabled(text: str, enable: str):
    rig = SciRig(**({enable: 1} if enable else {})).with_rxd(text)
    flags = rig.flags("RXRDY", "BRKDT", "RXERROR")
    rises = {"": 0, "RXBKINTENA": flags["RXRDY"] + flags["BRKDT"], "RXERRINTENA": flags["RXERROR"]}
    assert bool(rig.count("RXINT")) == bool(rises[enable])
    assert rig.count("TXINT") == 0


@pytest.mark.rule("SCI-160")
@pytest.mark.parametrize("words", range(4))
def test_without_txffiena_the_transmit_fifo_requests_nothing(words: int):
    for level in (0, 1, 3, 16):
        rig = SciRig(fifo=True, TXFFIL=level, TXFFIENA=0)
        rig.write("SCITXBUF", *range(words))
        rig.wait(11 * words + 1)
        assert (rig.get("TXFFINT"), rig.count("TXINT")) == (1, 0)
        rig.set(TXFFINTCLR=1)
        rig.wait(1)
        assert rig.count("TXINT") == 0


@pytest.mark.rule("SCI-177")
@pytest.mark.parametrize("level", [1, 2, 16])
def test_a_receive_fifo_requests_if_its_flag_is_1_and_enabled(level: int):
    for enabled in (0, 1):
        rig = SciRig(fifo=True, RXFFIL=level, RXFFIENA=enabled).with_rxd(frame(0x11) + frame(0x22) + "1")
        assert rig.get("RXFFINT") == (level <= 2)
        assert bool(rig.count("RXINT")) == bool(enabled and level <= 2)


@pytest.mark.rule("SCI-195")
@pytest.mark.parametrize("cdc", [0, 1])
def test_cdc_enables_a_second_measurement(cdc: int):
    rig = SciRig(brr=1, CDC=1)
    rig.send(frame(ord("A")) + "11", bit=1312)
    rig.set(ABDCLR=1, CDC=0)
    rig.set(CDC=cdc)
    rig.send(frame(ord("A")) + "11", bit=2592)
    assert (rig.get("ABD"), rig.get("SCILBAUD"), rig.count("TXINT")) == ((1, 80, 2) if cdc else (0, 40, 1))


# Timers -----------------------------------------------------------------------------------------------


@pytest.mark.rule("SYS-089")
@pytest.mark.parametrize("tie", [0, 1 << 14])
def test_a_timer_requests_if_it_has_reached_zero_and_tie_is_1(tie: int):
    timer = CpuTimer(options_from(SystemOptions, {}))
    timer.write(0, TCR.offset, 1 << 4)
    timer.write(0, PRD.offset, 999)
    timer.write(0, TPR.offset, 0)
    timer.write(0, TCR.offset, 1 << 5 | 1 << 15 | tie)
    for cycle in range(1, 999):
        timer.wake(cycle)
    assert timer.requests == 0 and not timer.peek(998, TCR.offset) >> 15
    for cycle in range(999, 1100):
        timer.wake(cycle)
    assert bool(timer.requests) == bool(tie) and timer.peek(1100, TCR.offset) >> 15
