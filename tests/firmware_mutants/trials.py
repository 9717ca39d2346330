"""A mutant tried: it goes in; the case and the budget that catch it come out, or nothing.

    mutant --compiled--> module --> Scene of each case in turn, a step at a time --> first budget that is broken
                                    '-- none --> figures that differ from the unchanged firmware's

A budget that is broken stops it. What breaks none may still move a budget's figures: `periph-sim check` says so.
"""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import count
from pathlib import Path
from time import process_time
from types import ModuleType
from typing import Any, NamedTuple

from periph_sim.board.firmware import Firmware
from periph_sim.board.scene import Scene
from periph_sim.case.load import load
from periph_sim.timing.budgets import Limit

from .changes import Mutant, mutants

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "firmware" / "python"
STARTUP = "startup"
START = ("start_pin", "start_i2c", "sci_fifo_receiver", "start_pie")
SERVICE = {
    "imu_hil": ("sci_received", "slave_config", "batch_read", "run"),
    "imu_hil_robust": (
        *("sci_received", "look_at_line", "own_address", "wait_for", "serve", "send", "wait_for_round"),
        *("look_at_round", "serve_round", "run", "start_timer"),
    ),
}
STEP = Fraction(1, 50)  # s: how often it is asked whether a budget is broken
PATIENCE = 20  # s of CPU time for a step


class Run(NamedTuple):
    """A case, for how long, with which changes."""

    case: str
    seconds: str
    changes: tuple[str, ...] = ()


RUNS = {
    "imu_hil": (
        Run("imu_hil", "0.24"),
        Run("imu_hil_drift", "0.5"),
        Run("imu_hil_400k", "0.1"),
    ),
    "imu_hil_robust": (
        Run("imu_hil", "0.24", ("unit.dsp.firmware=imu_hil_robust",)),
        Run("imu_hil_lost_byte", "1.2"),
        Run("imu_hil_silent_host", "1.2"),
        Run("imu_hil_stuck_sda", "0.5"),
        Run("imu_hil_reset", "0.7"),
        Run("imu_hil_glitches", "1"),
        Run("imu_hil_400k", "0.1", ("unit.dsp.firmware=imu_hil_robust",)),
    ),
}


@dataclass(frozen=True)
class Trial:
    """by: the budget that caught it, empty if none did. how: "broken", "moved" or "error"."""

    mutant: Mutant
    case: str = ""
    by: str = ""
    how: str = ""


Figures = dict[str, tuple[int, int, int]]


def all_mutants(firmware: str) -> list[Mutant]:
    """Those of a firmware's own code and of its start-up."""
    parts = ((firmware, SERVICE[firmware]), (STARTUP, START))
    return [one for name, functions in parts for one in mutants(name, _source(name), functions)]


def tried(firmware: str, mutant: Mutant) -> Trial:
    module = _mutated(firmware, mutant)
    moved = Trial(mutant)
    for run in RUNS[firmware]:
        try:
            by, figures = _ran(run, module)
        except Exception as error:  # firmware that cannot go on: a run says so, with its line
            return Trial(mutant, run.case, f"{type(error).__name__}: {error}".splitlines()[0], "error")
        if by:
            return Trial(mutant, run.case, by, "broken")
        if not moved.by:
            usual = usual_figures(firmware, run)
            differing = [name for name, figure in figures.items() if figure != usual[name]]
            moved = Trial(mutant, run.case, differing[0], "moved") if differing else moved
    return moved


@cache
def usual_figures(firmware: str, run: Run) -> Figures:
    """Those of the unchanged firmware, which no budget may catch."""
    by, figures = _ran(run, compiled(_source(firmware), firmware))
    assert not by, f"{run} fails with the unchanged firmware: {by}"
    return figures


def _ran(run: Run, module: Any) -> tuple[str, Figures]:
    """(the first budget that is broken, or what else is wrong; the figures of all)."""
    case = load(ROOT / "timing" / f"{run.case}.toml", list(run.changes))
    scene = Scene(case, programs={"dsp": Firmware("mutant", module.main, module.Settings)})
    end = scene.start + scene.timebase.ticks(run.seconds + " s", "nearest")
    step = scene.timebase.ticks(STEP)
    while scene.kernel.now + step < end:
        began = process_time()
        scene.kernel.run_until(scene.kernel.now + step)
        if process_time() - began > PATIENCE:
            return "it takes too long", {}
        broken = next((limit.budget.name for limit in scene.limits if _broken(limit)), "")
        if broken:
            return broken, {}
    result = scene.run(scene.timebase.seconds(end - scene.kernel.now))
    failed = next((verdict.name for verdict in result.budgets if not verdict.passed), "")
    if not failed and result.verdict == "fail":
        failed = "firmware waits for ever"
    figures = {one.budget.name: (one.measure.worst, one.measure.least, one.measure.count) for one in scene.limits}
    return failed, figures


def _broken(limit: Limit) -> bool:
    measure = limit.measure
    most, least = limit.limits.get("max"), limit.limits.get("min")
    if measure.silent or not measure.count:
        return False
    return (most is not None and measure.worst > most) or (least is not None and measure.least < least)


def _mutated(firmware: str, mutant: Mutant) -> Any:
    if mutant.file == firmware:
        return compiled(mutant.tree, firmware)
    start = compiled(mutant.tree, STARTUP)
    return compiled(_source(firmware), firmware, {f"firmware.python.{STARTUP}": start})


@cache
def _source(name: str) -> str:
    return (SOURCES / f"{name}.py").read_text(encoding="utf-8")


_number = count()


def compiled(source: str | ast.Module, name: str, stand_in: dict[str, ModuleType] | None = None) -> Any:
    """The module of a firmware's source. stand_in: modules that it imports instead of those of these names."""
    module = ModuleType(f"firmware_under_trial_{name}_{next(_number)}")
    kept = {other: sys.modules.get(other) for other in stand_in or {}}
    sys.modules[module.__name__] = module  # dataclasses look their module up by name
    sys.modules.update(stand_in or {})
    try:
        exec(compile(source, f"<{name}>", "exec"), module.__dict__)
    finally:
        for other, was in kept.items():
            sys.modules.pop(other)
            if was is not None:
                sys.modules[other] = was
    return module
