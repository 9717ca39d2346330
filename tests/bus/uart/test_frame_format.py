"""Levels of a UART frame: the levels that a format makes are valid in it, and all others are not."""

from __future__ import annotations

from itertools import product

import pytest

from periph_sim.bus.uart.frame_format import UartFormat


@pytest.mark.parametrize("parity", ["none", "even", "odd"])
@pytest.mark.parametrize("stop", [1, 2])
@pytest.mark.parametrize("address", [False, True])
def test_exactly_the_levels_that_a_format_makes_are_valid_in_it(parity: str, stop: int, address: bool) -> None:
    form = UartFormat(3, parity, stop, address)
    made = {tuple(form.levels(byte, bit)) for byte in range(8) for bit in range(1 + address)}
    for levels in product((0, 1), repeat=form.length):
        assert form.is_kept_by(list(levels)) == (levels in made)
