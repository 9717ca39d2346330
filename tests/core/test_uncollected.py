"""While many objects are made that all stay, the garbage collector looks for none of them, and works again after."""

from __future__ import annotations

import gc

import pytest

from periph_sim.core.uncollected import uncollected


def test_nothing_is_collected_meanwhile() -> None:
    @uncollected()
    def build() -> bool:
        return gc.isenabled()

    assert not build()
    assert gc.isenabled()


def test_it_is_on_again_after_an_error() -> None:
    with pytest.raises(ValueError, match="as it builds"), uncollected():
        assert not gc.isenabled()
        raise ValueError("as it builds")
    assert gc.isenabled()


def test_who_had_it_off_finds_it_off() -> None:
    gc.disable()
    try:
        with uncollected():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
