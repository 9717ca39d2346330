"""While many objects are made that all stay, the garbage collector looks for none of them, and works again after."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from periph_sim.core.uncollected import uncollected

MANY = 10 * gc.get_threshold()[0]


@contextmanager
def passes() -> Iterator[list[str]]:
    """What the collector does meanwhile."""
    seen: list[str] = []

    def told(phase: str, info: dict[str, int]) -> None:
        seen.append(phase)

    gc.callbacks.append(told)
    try:
        yield seen
    finally:
        gc.callbacks.remove(told)


def many(end: int = MANY) -> list[list[int]]:
    return [[number] for number in range(end)]


def test_nothing_is_collected_meanwhile() -> None:
    with passes() as plain:
        many()
    assert plain
    with passes() as seen:

        @uncollected()
        def build() -> tuple[int, int]:
            return len(many()), len(seen)

        assert build() == (MANY, 0)
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
            many(3)
        assert not gc.isenabled()
    finally:
        gc.enable()
