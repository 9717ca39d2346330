"""External interrupts: edges that request, and the counters. The inputs are qualified levels."""

from __future__ import annotations

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.f28335.gpio.module import Gpio
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.f28335.xint.module import Xint
from periph_sim.f28335.xint.register_map import XINT
from periph_sim.processor.dsp import Dsp, DspPlan
from tests.waves import DiagramRig

FALLING, RISING, FALLING_TOO, BOTH = 0, 1, 2, 3


def control(polarity: int, enable: int = 1) -> int:
    return polarity << 2 | enable


class Rig(DiagramRig):
    """Rows: `XINTn` is a level, `ENABLE` that of all lines, `req` the requests of a column, `CTR1` is XINT1CTR."""

    def __init__(self, polarity: int) -> None:
        self.xint = Xint()
        self.now = 0
        self.polarity = polarity
        self.levels = 0

    def drive(self, now: int, signal: str, level: int) -> None:
        if signal == "ENABLE":
            for offset in range(7):
                self.xint.write(now, offset, control(self.polarity, level))
        else:
            bit = 1 << self.xint.INPUTS.index(signal)
            self.levels = self.levels & ~bit | level * bit
            self.xint.pins(now, self.levels)

    def run_until(self, time: int) -> None:
        self.now = time
        self.requested, self.xint.requests = self.xint.requests, 0

    def show(self, signal: str) -> int:
        return self.requested if signal == "req" else self.xint.peek(self.now, XINT["XINT1CTR"].offset)


@pytest.mark.rule("SYS-080")
@pytest.mark.parametrize(
    ("polarity", "requested"),
    [
        (FALLING, "0 . . 1 0 . . ."),
        (RISING, "0 1 0 . . 1 0 ."),
        (FALLING_TOO, "0 . . 1 0 . . ."),
        (BOTH, "0 1 0 1 0 1 0 ."),
    ],
)
def test_polarity_selects_the_edges(polarity, requested):
    Rig(polarity).check(f"""
        > ENABLE  1 . . . . . 0 .
        > XINT1   0 1 . 0 . 1 . 0
        < req     {requested}
    """)


@pytest.mark.rule("SYS-080")
def test_edges_of_a_disabled_line_request_nothing_then_or_later():
    Rig(BOTH).check("""
        > ENABLE  0 . . . 1 . .
        > XINT1   0 1 0 1 . 0 .
        < req     0 . . . . 1 0
    """)


@pytest.mark.parametrize("line", range(7))
def test_each_line_has_its_own_request_bit(line):
    xint = Xint()
    xint.write(0, line, control(RISING))
    xint.pins(1, 0x7F)
    assert xint.requests == 1 << line


@pytest.mark.rule("SYS-081")
def test_the_counter_restarts_at_a_valid_edge_and_counts_cycles():
    Rig(RISING).check("""
        > ENABLE  1 . . . . . . . . . . .
        > XINT1   0 . . 1 . . . 0 . . 1 .
        < CTR1    0 1 2 0 1 2 3 4 5 6 0 1
    """)


@pytest.mark.rule("SYS-081")
def test_the_counter_stops_while_the_interrupt_is_disabled():
    Rig(RISING).check("""
        > ENABLE  1 . . 0 . . 1 . .
        > XINT1   0 1 . . 0 1 . . .
        < CTR1    0 . 1 2 . . . 3 4
    """)


@pytest.mark.rule("SYS-081")
@pytest.mark.parametrize(("line", "name"), [(0, "XINT1CTR"), (1, "XINT2CTR")])
def test_each_counter_has_16_bits_and_counts_for_its_own_line(line, name):
    xint = Xint()
    xint.write(0, line, control(RISING))
    xint.pins(10, 1 << line)
    offset = XINT[name].offset
    assert [xint.read(now, offset) for now in (10, 11, 10 + 0xFFFF, 10 + 0x10000)] == [0, 1, 0xFFFF, 0]
    other = XINT["XINT2CTR" if name == "XINT1CTR" else "XINT1CTR"].offset
    assert xint.read(20, other) == 0
    xint.write(20, offset, 0)
    assert xint.read(20, offset) == 10  # read only


def test_reset_disables_everything():
    xint = Xint()
    xint.write(0, 0, control(BOTH))
    xint.pins(5, 1)
    xint.reset(10)
    assert (xint.requests, xint.enabled, xint.read(20, 0), xint.read(20, 8)) == (0, 0, 0, 0)


def test_enabling_xnmi_is_noted_as_not_modelled():
    xint = Xint()
    xint.write(0, XINT["XNMICR"].offset, 0b0010)
    assert not xint.notes
    xint.write(0, XINT["XNMICR"].offset, 0b0011)
    assert [note.code for note in xint.notes] == ["unknown"]
    assert xint.read(0, XINT["XNMICR"].offset) == 0b0011


def test_updating_the_level_of_a_disabled_line_is_no_edge():
    """The level of a line, which is not followed while the line is disabled, is updated before it is enabled."""
    gpio, xint = Gpio(SystemOptions()), Xint()

    def write(now: int, offset: int, value: int) -> None:
        xint.settle(now, gpio.xint_levels(now))
        xint.write(now, offset, value)
        gpio.watch_xints(now, xint.enabled)

    def deliver(now: int) -> None:
        if gpio.changed:
            xint.pins(now, gpio.xint_levels(now))
        gpio.changed.clear()

    gpio.wire(1)  # XINT1 and XINT2 select GPIO0 after reset
    gpio.edges(0, 1)
    gpio.edges(5, 0)
    gpio.edges(7, 1)
    assert not gpio.changed
    write(10, 0, control(BOTH))
    deliver(10)
    assert xint.requests == 0
    gpio.edges(20, 0, exact=False)
    deliver(20)
    assert xint.requests == 0b01
    write(21, 1, control(BOTH))
    deliver(21)
    assert xint.requests == 0b01


@pytest.mark.parametrize("name", ["XINT1CTR", "XINT2CTR"])
def test_a_wait_for_a_counter_ends(name):
    """The counter changes without events, so no pass of the polling loop may be skipped."""
    kernel = Kernel()
    dsp = Dsp(kernel, Timebase(150_000_000), Recorder(), DspPlan("dsp", ("GPIO", "XINT"), {}, code=BARE))
    counter, control = dsp.module("XINT")[name], dsp.module("XINT")[name.replace("CTR", "CR")]
    waited: list[int] = []

    def main() -> None:
        control.ENABLE = 1
        begin = dsp.cpu.cycle
        dsp.spin(lambda: counter.INTCTR >= 1000)
        waited.append(dsp.cpu.cycle - begin)

    dsp.start(main)
    kernel.run_until(20 * 5000)
    assert [1000 <= cycles <= 1020 for cycles in waited] == [True]
