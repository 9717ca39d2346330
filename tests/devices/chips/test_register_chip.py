"""The base class of register chips accepts chips that were written for the last release."""

from __future__ import annotations

import pytest

from periph_sim.devices.chips.hmc5883l import Hmc5883l
from tests.devices.bench import TIMEBASE

SECOND = 10**9  # in ticks of TIMEBASE


def test_a_chip_that_overrides_the_former_name_of_advance_to_works_with_a_warning():
    called: list[int] = []
    with pytest.warns(DeprecationWarning, match=r"^Former\.catch_up is now called advance_to; "):

        class Former(Hmc5883l):
            def catch_up(self, now: int) -> None:
                super().catch_up(now)
                called.append(now)

    def samples(kind: type[Hmc5883l]) -> list[int]:
        """The ticks within a second at which a chip of this class samples its source."""
        asked: list[int] = []
        chip = kind(TIMEBASE, lambda tick: (asked.append(tick) or 0, 0, 0), 0x1E)
        chip.write(0, 2, 0x00)  # continuous measurement
        chip.read(SECOND, 3)
        return asked

    assert samples(Former) == samples(Hmc5883l) != []
    assert called == [0, SECOND]
