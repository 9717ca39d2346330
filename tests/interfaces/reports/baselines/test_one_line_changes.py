"""Control against false passes: after a change of one line of firmware or scene, exactly the expected budgets break.

Each row has the change and its case; the budgets that break; those whose figures change and still hold; a part of the
explanation of the first broken one; and those that measured too little to be judged. No other figure may change.
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
}  # 1/8 s has six rounds; in 1/2 s the frames drift into the reads
SETTING = "unit.dsp.settings."


class Row(NamedTuple):
    change: str
    breaks: tuple[str, ...]
    moves: tuple[str, ...] = ()
    explanation: str = ""
    unjudged: tuple[str, ...] = ()
    case: str = "imu_hil_published"


ROUND = ("round complete", "schedule slack")
ANSWERED = ("response", "stretch")  # they occur only in reads that were answered
ROUNDS = ("round complete", "nacked rounds")  # they occur only in rounds that could begin

ROWS = [
    Row(f"{SETTING}model_cost=400 us", ("model execution",), explanation="400.000 us  100.0 %  span model"),
    Row(
        f"{SETTING}model_cost=18 ms",  # in a round, I2COAR has the magnetometer's address or none
        ("nacked rounds", "model execution", "wrong bytes", "data age"),
        ROUND,
        "address 0x68 not acknowledged",
        ANSWERED,
    ),
    Row(
        f"{SETTING}sdir_wait=false",
        ("wrong bytes", "data age"),
        explanation="I2CDXR = 0x01 written, before the read's START",
    ),
    Row(
        f"{SETTING}order=[0x68, 0x1e, 0x53]",
        ("nacked rounds", "data age"),
        ROUND,
        "address 0x53 not acknowledged",
        (*ANSWERED, "wrong bytes"),
    ),
    # 104 kbit/s: framing is wrong, and the receiver takes several characters on RX for one
    Row(f"{SETTING}brr=44", ("wrong bytes", "data age"), unjudged=("SCI FIFO high-water", "SCI overruns")),
    Row(
        f"{SETTING}fifo_level=13",  # a frame is read with the first character of the next one
        ("data age",),
        ("SCI FIFO high-water",),
        "SCIRXINTA entered",
    ),
    Row(
        f"{SETTING}fifo_level=11", ("wrong bytes", "data age"), ("SCI FIFO high-water",)
    ),  # each frame is read one byte short and shifted
    Row(
        "controller.order=['accelerometer', 'gyroscope', 'magnetometer']",
        ("nacked rounds", "data age"),
        ROUND,
        "wait for I2C-A.I2CSTR.AAS",
        (*ANSWERED, "wrong bytes"),
    ),
    Row(  # the firmware is still computing
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
    Row("host.period=25 ms", ("data age",), explanation="magnetometer (0x1E R), with older data"),
    Row("host.error=5", ("wrong bytes", "data age"), unjudged=("SCI FIFO high-water", "SCI overruns")),
    Row("host.lose=[[2, 4]]", ("wrong bytes", "data age")),  # frames have no start mark, so all later ones are shifted
    # The frames of this host end between two rounds, so an effect during a read does not show:
    Row(f"{SETTING}mask_during_i2c=true", ()),
    # the frames of this one drift through the reads:
    Row(
        f"{SETTING}mask_during_i2c=true",
        ("SCI interrupt latency",),
        explanation="interrupts are off",
        case="imu_hil_drift",
    ),
    Row(
        f"{SETTING}frame_cost=110 us",  # longer than the byte that I2CDXR holds in advance
        ("response", "stretch"),
        ROUND,
        "SCIRXINTA entered, preempting",
        case="imu_hil_drift",
    ),
    Row(
        f"{SETTING}frame_cost=200 us",  # SDIR rises in the service routine, and SCD = 1 then clears it
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
    """Return the largest and the smallest value of each budget and whether nothing was measured."""
    return {
        limit.budget.name: (limit.measure.silent, limit.measure.worst, limit.measure.least) for limit in scene.limits
    }


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.case}: {row.change}")
def test_a_change_breaks_the_expected_budgets_and_changes_no_other_figure(row: Row):
    before = unchanged(row.case)
    scene, result = run(row.case, row.change)
    now = figures(scene)
    assert {verdict.name for verdict in result.budgets if verdict.broken} == set(row.breaks)
    assert {verdict.name for verdict in result.budgets if not verdict.passed} == {*row.breaks, *row.unjudged}
    moved = {name for name in now if now[name] != before[name]}
    assert moved - set(row.unjudged) == {*row.breaks, *row.moves} - set(row.unjudged)
    if row.explanation:
        first = next(verdict for verdict in result.budgets if verdict.name == row.breaks[0])
        (one,) = explain(scene.case, [first], scene.typical(), LENGTHS[row.case]).values()
        assert row.explanation in "\n".join(text(one.chain))


def test_at_least_eight_kinds_of_change_break_a_budget():
    assert len({row.change.partition("=")[0] for row in ROWS if row.breaks}) >= 8
    for row in ROWS:
        known = {budget.name for budget in load(TIMING / f"{row.case}.toml").budget}
        assert {*row.breaks, *row.moves} <= known


def test_each_budget_of_the_case_is_broken_by_some_change():
    """The two exceptions need more than one change: a FIFO is served late only if frames also follow closely."""
    broken = {name for row in ROWS for name in row.breaks}
    rest = {budget.name for budget in load(TIMING / "imu_hil_published.toml").budget} - broken
    assert rest == {"SCI FIFO high-water", "SCI overruns"}
