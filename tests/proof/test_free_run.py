"""Runs whose starts are chosen: the message for states that do not repeat."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from periph_sim.proof.free_run import FreeRun
from periph_sim.proof.normal_state import NormalState


class AwakeRun(FreeRun):
    """A run whose firmware is in no wait."""

    def __init__(self) -> None:
        self._program = SimpleNamespace(cpu=SimpleNamespace(polls=SimpleNamespace(asleep=False)))


@pytest.mark.parametrize(("count", "names"), [(1, "a"), (4, "a, b, c, d"), (5, "a, b, c, d and 1 more")])
def test_four_attributes_that_do_not_repeat_are_named(count: int, names: str):
    before: NormalState = dict.fromkeys("abcdefg", 0)
    after = before | dict.fromkeys("abcdefg"[:count], 1)
    error = AwakeRun().not_repeating(before, after)
    assert str(error) == f"the state does not repeat while the firmware waits: {names}"
