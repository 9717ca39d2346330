"""The responder whose waits are declared is the polled one: equal records, events and verdicts at every level."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim import FirmwareError, Result, load
from periph_sim.core.records import Kind
from tests.scene.runs import TIMING, recorded

WRITES = (
    "controller.request.0.count=3",
    "controller.request.0.expect=01 02 03",
    "controller.request.0.write=11 22 33 44",
)


def ran(firmware: str, disable: str, kinds: tuple[Kind, ...], *changes: str) -> tuple[Result, list[tuple[Any, ...]]]:
    """The case with this firmware; its records without the places, which lie in two files."""
    case = load(TIMING / "responder.toml", [f"unit.dsp.firmware={firmware}", f"disable={disable}", *changes])
    scene, records = recorded(case, kinds)
    result = scene.run(Fraction("0.03"))
    return result, [(r.tick, r.kind, r.where, r.what, r.value, r.cause) for r in records]


@pytest.mark.parametrize("disable", ["bits", "[]"])
@pytest.mark.parametrize("kinds", [(), (Kind.FLAG, Kind.WAIT), (Kind.ACCESS, Kind.WAIT)], ids=["none", "waits", "all"])
@pytest.mark.parametrize("changes", [(), WRITES], ids=["reads", "writes"])
def test_the_responder_with_declared_waits_is_the_polled_one(disable: str, kinds: tuple[Kind, ...], changes):
    asked, declared = (ran(name, disable, kinds, *changes) for name in ("responder", "responder_declared"))
    assert declared[1] == asked[1] and bool(kinds) == bool(asked[1])
    assert declared[0].events == asked[0].events and declared[0].counts == asked[0].counts
    assert [(b.name, b.verdict, b.worst) for b in declared[0].budgets] == [
        (b.name, b.verdict, b.worst) for b in asked[0].budgets
    ]
    assert declared[0].wire_bytes == asked[0].wire_bytes >= 60


@pytest.mark.parametrize("change", ["unit.dsp.settings.style=interrupt", "unit.dsp.settings.fifo=true"])
def test_the_other_styles_are_those_of_the_responder(change: str):
    with pytest.raises(
        FirmwareError, match="responder_declared is polled and has no FIFO; use responder for the other"
    ):
        ran("responder_declared", "[]", (), change)
