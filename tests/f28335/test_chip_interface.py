"""The interface of every chip: names of its pins, its initial outputs and wake-up, and unused words and bits."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from periph_sim.core.chip import ANY_CHANGED, NEVER, NO_CHANGE
from periph_sim.f28335.cpu_timer.module import CpuTimer
from periph_sim.f28335.gpio.module import Gpio
from periph_sim.f28335.i2c.module import I2c
from periph_sim.f28335.pie.module import Pie
from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.spi.module import Spi
from periph_sim.f28335.system_control.module import SystemControl
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.f28335.xint.module import Xint

from .i2c_rig import Rig

SYSTEM = SystemOptions()
PINS = tuple(f"GPIO{n}" for n in range(88))
SPI_PINS = ("SIMO", "SOMI", "CLK", "STE")
XINTS = ("XINT1", "XINT2", "XINT3", "XINT4", "XINT5", "XINT6", "XINT7")

# chip: inputs, outputs, cycles from an input to its effect, levels of the outputs, first wake-up
CHIPS: list[tuple[Callable[[], Any], tuple[str, ...], tuple[str, ...], int, int, int]] = [
    (I2c, ("SCL", "SDA"), ("SCL", "SDA"), 1, 3, NEVER),
    (Sci, ("RXD",), ("TXD",), 2, 1, NEVER),
    (Spi, SPI_PINS, SPI_PINS, 0, 15, NEVER),
    (partial(Gpio, SYSTEM), PINS, PINS, 0, 0, NEVER),
    (Xint, XINTS, (), 0, 0, NEVER),
    (partial(Pie, SYSTEM), (), (), 0, 0, NEVER),
    (partial(CpuTimer, SYSTEM), (), (), 0, 0, 0x10000),
    (partial(SystemControl, 30_000_000, SYSTEM), (), (), 0, 0, 256 * 512 // 4),
]


@pytest.mark.parametrize(("make", "inputs", "outputs", "width", "out", "wake"), CHIPS)
def test_initial_values_of_a_new_chip(
    make: Callable[[], Any],
    inputs: tuple[str, ...],
    outputs: tuple[str, ...],
    width: int,
    out: int,
    wake: int,
):
    chip = make()
    assert (inputs, outputs) == (chip.INPUTS, chip.OUTPUTS)
    assert (chip.filter_width, chip.out, chip.next_wake) == (width, out, wake)
    assert (chip.requests, chip.held, chip.notes, chip.touched - {"pll_lock_clock"}) == (0, 0, [], set())


@pytest.mark.parametrize("make", [row[0] for row in CHIPS])
def test_words_without_a_register_and_bits_without_a_field_read_0_and_ignore_writes(make: Callable[[], Any]):
    chip = make()
    chip.gate(0, True)
    words = {r.offset + half: (r, half) for r in chip.MAP for half in range(-(-r.width // 16))}
    before = [chip.peek(1, offset) for offset in words]
    for hole in set(range(max(words))) - words.keys():
        chip.write(1, hole, 0xFFFF)
        assert (hole, chip.read(1, hole)) == (hole, 0)
    assert [chip.peek(1, offset) for offset in words] == before
    for offset, (register, half) in words.items():
        chip.write(1, offset, 0xFFFF)
        named = sum(field.mask for field in register.fields) >> 16 * half
        assert (register.name, chip.peek(1, offset) & ~named) == (register.name, 0)


@pytest.mark.parametrize("make", [row[0] for row in CHIPS if not row[1]])
def test_a_chip_without_inputs_refuses_levels(make: Callable[[], Any]):
    with pytest.raises(ValueError, match="no input pins"):
        make().pins(0, 1)


@pytest.mark.parametrize("chip", [Xint(), Pie(SYSTEM)])
def test_a_wake_up_of_a_chip_without_timing_changes_nothing(chip: Any):
    assert chip.wake(0) == NO_CHANGE


def test_i2c_filter_width_follows_ipsc_at_the_end_of_a_reset_by_irs():
    rig = Rig(noise_filter_cycles=3)
    widths = [rig.chip.filter_width]
    rig.begin()
    widths.append(rig.chip.filter_width)
    rig.write("I2CMDR", 0)
    rig.write("I2CPSC", 9)
    widths.append(rig.chip.filter_width)
    rig.begin()
    widths.append(rig.chip.filter_width)
    rig.chip.reset(rig.now)
    widths.append(rig.chip.filter_width)
    assert widths == [3, 3 * 15, 3 * 15, 3 * 10, 3]


@pytest.mark.parametrize("divider", [1, 2, 4, 6, 8, 10, 12, 14])
def test_sci_accepts_the_dividers_of_lospcp(divider: int):
    chip = Sci()
    chip.gate(0, True)
    chip.set_lspclk(0, divider, 0)
    for offset, value in ((3, 9), (1, 0x22), (9, 0x00)):
        chip.write(0, offset, value)
    edges: list[int] = []
    while len(edges) < 2:
        now, before = chip.next_wake, chip.out
        chip.wake(now)
        if chip.out != before:
            edges.append(now)
    fall, rise = edges  # start bit and one data bit of 0
    assert (rise - fall, fall % divider) == (2 * 8 * 10 * divider, 0)


def test_sci_applies_overdue_changes_before_a_change_of_its_input():
    """The input changes in the last cycle of the start bit on TXD: TXD is 0 then, and 1 in the next cycle."""
    chip = Sci()
    chip.gate(0, True)
    chip.write(0, 1, 0x22)
    chip.write(0, 9, 0xFF)
    begin = chip.next_wake
    assert chip.pins(begin + 63, 0) == ANY_CHANGED
    assert chip.out == 0
    chip.wake(begin + 64)
    assert chip.out == 1
