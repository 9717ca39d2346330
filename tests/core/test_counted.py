"""Numbers of things."""

from __future__ import annotations

from periph_sim.core.counted import counted


def test_one_is_singular_and_all_others_are_plural():
    assert [counted(number, "I2C byte") for number in (0, 1, 2)] == ["0 I2C bytes", "1 I2C byte", "2 I2C bytes"]
