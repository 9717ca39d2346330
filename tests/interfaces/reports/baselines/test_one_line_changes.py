"""The false-pass control: one line of firmware or scene changed, and exactly the budgets that it must break do break.

A row: what is changed, in which case; the budgets that break; those whose figures move and still hold; what the
explanation of the first broken one must say; those that measured too little to be judged. No other budget's figure may
move.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import NamedTuple

import pytest

from periph_sim.interfaces.reports.explain.chain import text
from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.interfaces.reports.explain.made import explain
from tests.scene.runs import TIMING

LENGTHS = {
    "imu_hil_published": Fraction(1, 8),
    "imu_hil_drift": Fraction(1, 2),
}  # six rounds; frames slide into the reads
SETTING = "unit.dsp.settings."


class Row(NamedTuple):
    change: str
    breaks: tuple[str, ...]
    moves: tuple[str, ...] = ()
    told: str = ""
    unjudged: tuple[str, ...] = ()
    case: str = "imu_hil_published"


ROUND = ("round complete", "schedule slack")
ANSWERED = ("response", "stretch")  # of which there are only those of reads that were answered
ROUNDS = ("round complete", "nacked rounds")  # of which there are only those of rounds that could begin

ROWS = [
    Row(f"{SETTING}model_cost=400 us", ("model execution",), told="400.000 us  100.0 %  span model"),
    Row(
        f"{SETTING}model_cost=18 ms",  # a round finds the magnetometer's address, or none, in I2COAR
        ("nacked rounds", "model execution", "wrong bytes", "data age"),
        ROUND,
        "address 0x68 not acknowledged",
        ANSWERED,
    ),
    Row(
        f"{SETTING}sdir_wait=false",
        ("wrong bytes", "data age"),
        told="I2CDXR = 0x01 written, before the read's START",
    ),
    Row(
        f"{SETTING}order=[0x68, 0x1e, 0x53]",
        ("nacked rounds", "data age"),
        ROUND,
        "address 0x53 not acknowledged",
        (*ANSWERED, "wrong bytes"),
    ),
    # 104 kbit/s: characters are framed wrongly, and several on RX are one to the receiver
    Row(f"{SETTING}brr=44", ("wrong bytes", "data age"), unjudged=("SCI FIFO high-water", "SCI overruns")),
    Row(
        f"{SETTING}fifo_level=13",  # a frame is taken with the first character of the next
        ("data age",),
        ("SCI FIFO high-water",),
        "SCIRXINTA entered",
    ),
    Row(
        f"{SETTING}fifo_level=11", ("wrong bytes", "data age"), ("SCI FIFO high-water",)
    ),  # one byte short: each frame slips
    Row(
        "controller.order=['accelerometer', 'gyroscope', 'magnetometer']",
        ("nacked rounds", "data age"),
        ROUND,
        "wait for I2C-A.I2CSTR.AAS",
        (*ANSWERED, "wrong bytes"),
    ),
    Row(  # it still computes
        "controller.first=100 us",
        ("nacked rounds", "data age"),
        ROUND,
        "span model, begun 194",
        (*ANSWERED, "wrong bytes"),
    ),
    Row(
        "controller.rate=50 kHz", (*ROUND, "data age"), ("response",), "1680.000 us  32.7 %  bits of gyroscope, 2 times"
    ),
    Row("controller.gap=500 us", ROUND, ("data age",), "1000.000 us  28.4 %  bus free between two transfers, 2 times"),
    Row(
        "controller.period=2 ms",
        ("missed rounds", "schedule slack"),
        ("data age",),
        "the one before still runs",
        ROUNDS,
    ),
    Row("host.period=25 ms", ("data age",), told="magnetometer (0x1E R), with older data"),
    Row("host.error=5", ("wrong bytes", "data age"), unjudged=("SCI FIFO high-water", "SCI overruns")),
    Row(
        "host.lose=[[2, 4]]", ("wrong bytes", "data age")
    ),  # nothing marks a frame's begin: all that follow are shifted
    # Frames of this host end between two rounds, so what only shows while a read is served does not show:
    Row(f"{SETTING}mask_during_i2c=true", ()),
    # those of this one slide through the reads:
    Row(
        f"{SETTING}mask_during_i2c=true",
        ("SCI interrupt latency",),
        told="interrupts are off",
        case="imu_hil_drift",
    ),
    Row(
        f"{SETTING}frame_cost=110 us",  # more than the byte that I2CDXR holds in advance
        ("response", "stretch"),
        ROUND,
        "SCIRXINTA entered, preempting",
        case="imu_hil_drift",
    ),
    Row(
        f"{SETTING}frame_cost=200 us",  # SDIR rises in the service routine, and SCD = 1 then writes it back: cleared
        ("missed rounds", "stretch"),
        ("SCI interrupt latency",),
        "I2CSTR.SDIR cleared by I2C-A.I2CSTR written",
        (*ROUNDS, "schedule slack"),
        case="imu_hil_drift",
    ),
]


def run(case: str, *changes: str) -> tuple[Scene, Result]:
    scene = Scene(load(TIMING / f"{case}.toml", list(changes)))
    return scene, scene.run(LENGTHS[case])


@cache
def unchanged(case: str) -> dict[str, tuple[object, ...]]:
    scene, result = run(case)
    assert result.verdict == "pass"
    return figures(scene)


def figures(scene: Scene) -> dict[str, tuple[object, ...]]:
    """Of each budget the largest and the smallest value; None where nothing was measured."""
    return {
        limit.budget.name: (limit.measure.silent, limit.measure.worst, limit.measure.least) for limit in scene.limits
    }


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.case}: {row.change}")
def test_a_change_breaks_what_it_must_and_moves_nothing_else(row: Row):
    before = unchanged(row.case)
    scene, result = run(row.case, row.change)
    now = figures(scene)
    assert {verdict.name for verdict in result.budgets if verdict.broken} == set(row.breaks)
    assert {verdict.name for verdict in result.budgets if not verdict.passed} == {*row.breaks, *row.unjudged}
    moved = {name for name in now if now[name] != before[name]}
    assert moved - set(row.unjudged) == {*row.breaks, *row.moves} - set(row.unjudged)
    if row.told:
        first = next(verdict for verdict in result.budgets if verdict.name == row.breaks[0])
        (one,) = explain(scene.case, [first], scene.typical(), LENGTHS[row.case]).values()
        assert row.told in "\n".join(text(one.chain))


def test_at_least_eight_kinds_of_change_are_caught_by_name():
    assert len({row.change.partition("=")[0] for row in ROWS if row.breaks}) >= 8
    for row in ROWS:
        known = {budget.name for budget in load(TIMING / f"{row.case}.toml").budget}
        assert {*row.breaks, *row.moves} <= known


def test_each_budget_of_the_case_is_broken_by_some_change():
    """All but the two that take more than one change: a FIFO is served late only if frames follow close, too."""
    broken = {name for row in ROWS for name in row.breaks}
    rest = {budget.name for budget in load(TIMING / "imu_hil_published.toml").budget} - broken
    assert rest == {"SCI FIFO high-water", "SCI overruns"}
