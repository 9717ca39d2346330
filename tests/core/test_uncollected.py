"""`uncollected` disables the garbage collector in its block and then restores its former state."""

from __future__ import annotations

import gc

import pytest

from periph_sim.core.uncollected import uncollected


def test_the_collector_is_disabled_in_the_block() -> None:
    @uncollected()
    def build() -> bool:
        return gc.isenabled()

    assert not build()
    assert gc.isenabled()


def test_the_collector_is_enabled_again_after_an_error() -> None:
    with pytest.raises(ValueError, match="as it builds"), uncollected():
        assert not gc.isenabled()
        raise ValueError("as it builds")
    assert gc.isenabled()


def test_a_disabled_collector_stays_disabled() -> None:
    gc.disable()
    try:
        with uncollected():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
