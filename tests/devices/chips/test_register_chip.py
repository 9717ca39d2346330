"""The base of register chips: what chips of the last release may still do."""

from __future__ import annotations

import pytest

from periph_sim.devices.chips.hmc5883l import Hmc5883l
from tests.devices.bench import TIMEBASE

SECOND = 10**9  # in ticks of TIMEBASE


def test_a_chip_with_the_former_name_of_advance_to_works_and_is_warned_about():
    called: list[int] = []
    with pytest.warns(DeprecationWarning, match=r"^Former\.catch_up is now called advance_to; "):

        class Former(Hmc5883l):
            def catch_up(self, now: int) -> None:
                super().catch_up(now)
                called.append(now)

    def samples(kind: type[Hmc5883l]) -> list[int]:
        """The ticks at which the chip samples its source within a second."""
        asked: list[int] = []
        chip = kind(TIMEBASE, lambda tick: (asked.append(tick) or 0, 0, 0), 0x1E)
        chip.write(0, 2, 0x00)  # continuous measurement
        chip.read(SECOND, 3)
        return asked

    assert samples(Former) == samples(Hmc5883l) != []
    assert called == [0, SECOND]
