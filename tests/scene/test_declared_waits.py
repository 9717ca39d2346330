"""The responder with declared waits gives the records, events and verdicts of the polled one."""

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
    """Run the case with this firmware. The records have no places, since these are in two files."""
    case = load(TIMING / "responder.toml", [f"unit.dsp.firmware={firmware}", f"disable={disable}", *changes])
    scene, records = recorded(case, kinds)
    result = scene.run(Fraction("0.03"))
    return result, [(r.tick, r.kind, r.where, r.what, r.value, r.cause) for r in records]


@pytest.mark.parametrize("disable", ["bits", "[]"])
@pytest.mark.parametrize("kinds", [(), (Kind.FLAG, Kind.WAIT), (Kind.ACCESS, Kind.WAIT)], ids=["none", "waits", "all"])
@pytest.mark.parametrize("changes", [(), WRITES], ids=["reads", "writes"])
def test_the_responder_with_declared_waits_equals_the_polled_one(disable: str, kinds: tuple[Kind, ...], changes):
    asked, declared = (ran(name, disable, kinds, *changes) for name in ("responder", "responder_declared"))
    assert declared[1] == asked[1] and bool(kinds) == bool(asked[1])
    assert declared[0].events == asked[0].events and declared[0].counts == asked[0].counts
    assert [(b.name, b.verdict, b.worst) for b in declared[0].budgets] == [
        (b.name, b.verdict, b.worst) for b in asked[0].budgets
    ]
    assert declared[0].wire_bytes == asked[0].wire_bytes >= 60


@pytest.mark.parametrize("change", ["unit.dsp.settings.style=interrupt", "unit.dsp.settings.fifo=true"])
def test_the_other_styles_are_refused(change: str):
    with pytest.raises(
        FirmwareError, match="responder_declared is polled and has no FIFO; use responder for the other"
    ):
        ran("responder_declared", "[]", (), change)
