"""Outputs and readable values do not change before `next_output` without an input, nor during `silent_edges` of SCL."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.f28335.i2c.module import I2c
from periph_sim.f28335.i2c.options import I2cOptions

from .. import i2c_bus
from ..i2c_bus import SCL, SDA, SLOT, Bench, Target, with_
from ..i2c_registers import FDF, IRS

OWN, OTHER = 0x50, 0x2A


class CheckedI2c(I2c):
    """Module that checks its predictions `next_output` and `silent_edges` at each call.

    early: the number of wake-ups before the predicted output; they changed nothing.
    silent: the number of edges that were predicted to be silent and changed nothing.
    """

    predicted = 0
    early = 0
    silent = 0
    left = -1  # predicted number of further silent edges of SCL before the time `first`; -1: no valid prediction
    first = 0
    scl_moved = -1_000

    def shown(self) -> tuple[int, ...]:
        return self.out, self.state.readable(), self.requests, self.held, len(self.notes)

    def predict(self) -> None:
        self.predicted = self.first = self.next_output()
        self.left = self.silent_edges()

    def pins(self, now: int, levels: int) -> int:
        before, moved = self.shown(), self._pins ^ levels
        if moved & 1 << SCL:
            apart, self.scl_moved = now - self.scl_moved > self.filter_width + 1, now
            self.left = self.left - 1 if self.left > 0 and apart else -1
        if moved & 1 << SDA and (levels | moved) & 1 << SCL:
            self.left = -1
        result = super().pins(now, levels)
        if self.left >= 0 and now < self.first:
            assert self.shown() == before
            self.silent += 1
        else:
            self.predict()
        self.predicted = self.next_output()
        return result

    def read(self, now: int, offset: int) -> int:
        value = super().read(now, offset)
        self.predict()
        return value

    def write(self, now: int, offset: int, value: int) -> None:
        super().write(now, offset, value)
        self.predict()

    def suspend(self, now: int, on: bool) -> None:
        super().suspend(now, on)
        self.predict()

    def wake(self, now: int) -> int:
        before = self.shown()
        result = super().wake(now)
        same = self.shown() == before
        assert same or now >= self.predicted, f"{before} became {self.shown()} before {self.predicted}"
        self.early += now < self.predicted
        if self.left >= 0 and now < self.first:
            assert same, f"{before} became {self.shown()}, with {self.left} silent edges left"
        else:
            self.predict()
        self.predicted = max(self.predicted, self.next_output())  # a prediction is valid until the next input
        return result


@pytest.fixture(autouse=True)
def checked_modules() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(i2c_bus, "I2c", CheckedI2c)
        yield


def early(chip: I2c) -> int:
    assert isinstance(chip, CheckedI2c)
    return chip.early


def test_next_output_of_a_slave_that_is_not_addressed_is_never():
    b = Bench(Target(OTHER))
    b.w("I2COAR", OWN)
    assert b.m.next_output() == NEVER
    b.w("I2CSAR", OTHER)
    assert b.write_all([0x5A]) == "S 2aW A 5a A P"  # sent by the module itself as master
    assert b.m.next_output() == NEVER


def test_next_output_and_silent_edges_of_a_receiving_slave_reach_to_the_end_of_the_byte():
    b = Bench(second=I2cOptions())
    b.w("I2COAR", OWN, b.s)
    b.mode("MST TRX STT STP", count=2)
    b.w("I2CDXR", 0x5A)
    b.edge(SCL, 1, 3)
    assert b.s.next_wake < NEVER and b.s.next_output() == NEVER
    assert b.s.silent_edges() == 2 * 5  # fall 3 to rise 8
    for _ in range(5):
        b.edge(SCL, 0)
    assert b.s.next_wake < NEVER and b.s.next_output() == NEVER and b.s.silent_edges() == 1
    b.edge(SCL, 0)
    assert b.s.next_output() == b.s.next_wake == b.now + 15 and b.s.silent_edges() == 0
    before = early(b.s)
    b.feed([0xA5])
    assert b.drain(2, b.s) == [0x5A, 0xA5]
    b.stopped()
    assert early(b.s) > before + 18


def test_next_output_includes_a_pending_code_of_i2cisrc():
    """XRDY is 1 when its enable is written; no line of the bus changes."""
    b = Bench()
    b.w("I2CIER", 0x10)
    assert b.m.next_output() == b.m.next_wake == b.now + 2


def test_next_output_of_a_module_in_reset_is_never():
    b = Bench(enable=False)
    b.w("I2CMDR", FDF)
    b.pull(SCL)
    assert b.m.next_output() == NEVER
    b.w("I2CMDR", FDF | IRS)
    b.release(SCL)
    b.run(SLOT)
    b.pull(SDA)
    assert b.m.next_output() == b.now + 15


def test_next_output_of_a_module_without_clock_is_never():
    b = bench(I2cOptions(), I2cOptions())
    read_from_slave(b)
    assert b.s.next_output() == b.now + 15
    b.s.gate(b.now, False)
    assert b.s.next_output() == NEVER


def write_to_slave(b: Bench) -> None:
    b.mode("MST TRX STT STP", count=2)
    b.w("I2CDXR", 0x5A)


def read_from_slave(b: Bench) -> None:
    """The slave has no data, so it holds SCL until the CPU writes some."""
    b.mode("MST STT STP", count=2)
    b.until(lambda: b.flag("SDIR", b.s) and not b.flag("XSMT", b.s))
    b.run(SLOT)
    b.w("I2CDXR", 0x35, b.s)


def read_from_slave_without_bcm(b: Bench) -> None:
    b.w("I2CEMDR", 0, b.s)
    read_from_slave(b)


def lose_arbitration(b: Bench) -> None:
    """Another party pulls SDA while the master sends ones; the master releases SDA at the filtered rise of SCL."""
    b.w("I2CSAR", 0x7F)
    write_to_slave(b)
    b.edge(SCL, 0, 2)
    b.pull(SDA)


def clocked_by_another(b: Bench) -> None:
    """SCL is pulled in the high phase of the master, whose low period begins at the filtered fall."""
    write_to_slave(b)
    b.edge(SCL, 1, 3)
    b.run(20)
    b.pull(SCL)
    b.run(SLOT)
    b.release(SCL)


def free_data(b: Bench) -> None:
    """A START and the fall of SCL are within one width of the filter: the slave reacts to both after the second."""
    b.mode("FDF TRX", 0, b.s)
    b.w("I2CDXR", 0x35, b.s)
    b.pull(SDA)
    b.run(5)
    b.pull(SCL)


def halt(b: Bench) -> None:
    """At a breakpoint, a slave holds SCL from the fall after a START on, which is within one width of the filter."""
    b.pull(SDA)
    b.run(5)
    b.pull(SCL)
    b.m.suspend(b.now, True)


def loop_back(b: Bench) -> None:
    b.w("I2COAR", OTHER)
    b.mode("FREE MST TRX STT STP DLB", count=1)
    b.w("I2CDXR", 0x5A)


def wait_for_the_bus(b: Bench) -> None:
    """The START is a low time after the STOP of another master."""
    b.pull(SDA)
    b.run(SLOT)
    b.mode("MST TRX STT STP")
    b.run(SLOT)
    b.release(SDA)


SCENARIOS = {
    of.__name__: of
    for of in (
        write_to_slave,
        read_from_slave,
        read_from_slave_without_bcm,
        lose_arbitration,
        clocked_by_another,
        free_data,
        halt,
        loop_back,
        wait_for_the_bus,
    )
}


def bench(first: I2cOptions, second: I2cOptions, rise: int = 0) -> Bench:
    """Return a bus with two modules, of which `s` has the address OWN, and a device with the address OTHER."""
    b = Bench(Target(OTHER, [0x12, 0x34]), options=first, second=second, rise=rise)
    b.w("I2COAR", OWN, b.s)
    b.w("I2CIER", 0x7F)
    b.w("I2CIER", 0x7F, b.s)
    return b


@pytest.mark.parametrize("name", SCENARIOS)
def test_nothing_changes_before_next_output(name: str):
    """`CheckedI2c` checks each wake-up; some of them are earlier than `next_output`."""
    b = bench(with_(stt_while_busy="foreign_waits"), I2cOptions())
    edges = len(b.edges)
    SCENARIOS[name](b)
    b.run(30 * SLOT)
    assert len(b.edges) > edges
    assert early(b.m) + early(b.s) > 0


ACTIONS: dict[str, Any] = {
    "write": lambda b, chip: b.mode("FREE MST TRX STT STP", 0, chip),
    "read": lambda b, chip: b.mode("FREE MST STT STP", 0, chip),
    "without end": lambda b, chip: b.mode("FREE MST TRX STT RM", 0, chip),
    "free data": lambda b, chip: b.mode("FDF TRX", 0, chip),
    "free data as master": lambda b, chip: b.mode("MST FDF TRX STT STP", 0, chip),
    "loopback": lambda b, chip: b.mode("FREE MST TRX STT STP DLB", 0, chip),
    "slave": lambda b, chip: b.mode("FREE", 0, chip),
    "off": lambda b, chip: b.w("I2CMDR", 0, chip),
    "stop": lambda b, chip: b.set("STP", chip),
    "start again": lambda b, chip: b.set("STT", chip),
    "refuse": lambda b, chip: b.set("NACKMOD", chip),
    "give": lambda b, chip: b.w("I2CDXR", 0x35, chip),
    "give ones": lambda b, chip: b.w("I2CDXR", 0xFF, chip),
    "take": lambda b, chip: b.r("I2CDRR", chip),
    "clear": lambda b, chip: b.w("I2CSTR", 0xFFFF, chip),
    "enable": lambda b, chip: b.w("I2CIER", 0x7F, chip),
    "code": lambda b, chip: b.r("I2CISRC", chip),
    "fifo": lambda b, chip: (b.w("I2CFFTX", 0x6000, chip), b.w("I2CFFRX", 0x2000, chip)),
    "bcm 0": lambda b, chip: b.w("I2CEMDR", 0, chip),
    "two bytes": lambda b, chip: b.w("I2CCNT", 2, chip),
    "breakpoint": lambda b, chip: (chip.suspend(b.now, True), b.settle()),
    "run on": lambda b, chip: (chip.suspend(b.now, False), b.settle()),
    "pull SDA": lambda b, chip: b.pull(SDA),
    "let SDA go": lambda b, chip: b.release(SDA),
    "pull SCL": lambda b, chip: b.pull(SCL),
    "let SCL go": lambda b, chip: b.release(SCL),
}
STEPS = st.tuples(st.sampled_from(sorted(ACTIONS)), st.sampled_from("ms"), st.integers(1, 12 * SLOT))


@st.composite
def options(draw: st.DrawFn) -> I2cOptions:
    """Draw values of a few options; the filter is not wide, to keep the runs short."""
    named = [of for of in fields(I2cOptions) if "values" in of.metadata]
    chosen = draw(st.lists(st.sampled_from(named), max_size=8, unique_by=lambda of: of.name))
    given = {of.name: draw(st.sampled_from(of.metadata["values"])) for of in chosen}
    return with_(noise_filter_cycles=draw(st.sampled_from([0, 1, 1, 3])), **given)


@pytest.mark.long
@settings(max_examples=200, deadline=None)
@given(options(), options(), st.sampled_from(sorted(SCENARIOS)), st.lists(STEPS, max_size=12), st.sampled_from([0, 30]))
def test_nothing_changes_before_next_output_with_random_actions(
    first: I2cOptions, second: I2cOptions, name: str, steps, rise: int
):
    """A scenario with random actions of firmware and of the test on the lines, with any values of options."""
    b = bench(first, second, rise)
    try:
        SCENARIOS[name](b)
    except AssertionError as error:
        if "the condition did not hold within" not in str(error):
            raise
    for action, which, cycles in steps:
        ACTIONS[action](b, b.m if which == "m" else b.s)
        b.run(cycles)
    b.run(20 * SLOT)
