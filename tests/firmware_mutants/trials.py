"""Try a mutant: find the case and the budget that catch it.

    mutant --compiled--> module --> Scene of each case in turn, a step at a time --> first budget that is broken
                                    '-- none --> figures that differ from the unchanged firmware's

A broken budget ends the trial. A mutant that breaks none may still change a figure of a budget, so that `periph-sim
check` fails. Cases are shortened so that a trial is affordable: faults come earlier, budgets are unchanged.
"""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib import import_module
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from periph_sim.interfaces.reports.baselines.compare import INSTANTS, compare
from periph_sim.interfaces.reports.baselines.files import Baseline
from periph_sim.interfaces.reports.baselines.outcome import baseline_of
from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from periph_sim.timing.budgets import BudgetJudge

from .changes import Mutant, mutants

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "firmware" / "python"
STARTUP = "startup"
PACKAGE = "periph_sim.firmware"  # the package from which firmware imports the start-up
FUNCTIONS = {
    "imu_hil": ("sci_received", "model", "slave_config", "batch_read", "run", "serve_frame_by_frame"),
    "imu_hil_robust": (
        *("sci_received", "look_at_line", "model", "own_address", "wait_for", "serve", "send", "wait_for_round"),
        *("look_at_round", "serve_round", "run", "start_timer"),
    ),
    "startup": ("start_pin", "start_i2c", "sci_fifo_receiver", "start_pie"),
}
FIRMWARES = {
    "imu_hil": "The firmware as published, in `imu_hil`, `imu_hil_400k`, `imu_hil_by_frame`, and `imu_hil` with every "
    "setting on.",
    "imu_hil_robust": "The firmware that a careful engineer would ship, in these two and the fault cases; with noise "
    "before a frame, with SCL held within a request, and with a head that leaves rounds out.",
    "startup": "The start-up of both, in `imu_hil` and `imu_hil_400k`; `imu_hil_reset` with the robust firmware.",
}
STEP = Fraction(1, 200)  # s: the interval at which budgets are checked
STALLED = "stall_limit=2 s"  # of CPU time


class Run(NamedTuple):
    """A case with a firmware.

    seconds: how long it runs.
    changes: changes of the case.
    functions: those whose mutants are run in it; empty for all.
    """

    firmware: str
    case: str
    seconds: str
    changes: tuple[str, ...] = ()
    functions: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.case}, {self.firmware}"


COLLIDING = ("host.first=3 ms",)  # so that frames end while a round is served
SETTINGS = (  # settings that the shipped cases do not use
    *("unit.dsp.settings.frame_cost=0.5 us", "unit.dsp.settings.models_run=frame"),
    *("unit.dsp.settings.mask_during_i2c=true", "budget.service latency.max=4 ms"),
)
BY_FRAME = ("model", "serve_frame_by_frame")
RUNS_SO_FAR = (
    "budget.runs of the models.exactly=6"  # in 90 ms: at the start, after the first round, and for four frames
)
ON_BUS = ("own_address", "wait_for", "serve", "send", "wait_for_round", "look_at_round", "serve_round", "start_timer")
ON_LINE = ("sci_received", "look_at_line", "wait_for_round", "look_at_round", "start_timer")
BREAK = (*COLLIDING, "host.jitter=0 s", "fault.0.at=24.034 ms", "fault.0.spread=0 s", "fault.0.times=1")
NO_FAULT = ("fault=[]", "host.jitter=0 s")
NOISE = (*COLLIDING, "host.jitter=0 s", "fault.0.at=21.7 ms", "fault.0.spread=0 s", "fault.0.times=1")
SCL_HELD = '{kind="hold", wire="SCL", length="1 ms", at="%s ms"}'  # longer than the patience of a wait
FRAME_TO_MODELS = '{name="frame to models", measure="from last frame RX end of burst to edge MODEL rise", max="5 ms"}'
RESET = Run("imu_hil_robust", "imu_hil_reset", "0.22", ("fault.0.at=45.4 ms", "fault.0.times=1"))
RUNS = {
    "imu_hil": (
        Run("imu_hil", "imu_hil", "0.09", COLLIDING),
        Run("imu_hil", "imu_hil_400k", "0.06", COLLIDING),
        Run("imu_hil", "imu_hil", "0.08", (*COLLIDING, *SETTINGS), ("sci_received", "batch_read", "run", *BY_FRAME)),
        Run("imu_hil", "imu_hil_by_frame", "0.09", (RUNS_SO_FAR,), ("sci_received", "batch_read", "run", *BY_FRAME)),
        Run(
            *("imu_hil", "imu_hil_stuck_sda", "0.1"),
            (*COLLIDING, "fault.0.at=38 ms", "fault.0.times=1", "budget.data age.max=80 ms"),
            ("batch_read",),
        ),
    ),
    "imu_hil_robust": (
        Run("imu_hil_robust", "imu_hil", "0.09", COLLIDING),
        Run("imu_hil_robust", "imu_hil_400k", "0.06", (*COLLIDING, "unit.dsp.settings.frame_cost=0.5 us")),
        Run("imu_hil_robust", "imu_hil_broken_line", "0.13", BREAK, ON_LINE),
        Run("imu_hil_robust", "imu_hil_broken_line", "0.09", (*COLLIDING, "controller.pointer_by=STOP"), ("serve",)),
        Run("imu_hil_robust", "imu_hil_lost_byte", "0.2", ("host.lose=[[2, 5], [4, 0], [6, 11]]",), ON_LINE),
        Run(
            *("imu_hil_robust", "imu_hil_silent_host", "0.2"),
            ('host.silent=[["60 ms", "50 ms"]]', "budget.4.after=135 ms"),
            ON_LINE,
        ),
        Run(
            *("imu_hil_robust", "imu_hil_stuck_sda", "0.16"),
            ("fault.0.at=38 ms", "fault.0.every=60 ms", "fault.0.times=2"),
            ON_BUS,
        ),
        RESET._replace(functions=("run", *ON_BUS)),
        Run("imu_hil_robust", "imu_hil_glitches", "0.4", (), ON_BUS),
        Run(  # noise that the receiver takes for a character, 1.3 ms before a frame
            *("imu_hil_robust", "imu_hil_broken_line", "0.07"),
            (*NOISE, "fault.0.width=60 us", "budget.data age.max=66 ms"),
            ("look_at_line",),
        ),
        Run(  # another device holds SCL after a register pointer and within a read
            *("imu_hil_robust", "imu_hil_broken_line", "0.13"),
            (
                *(*COLLIDING, f"fault=[{SCL_HELD % 45.14}, {SCL_HELD % 85.4}]"),
                *("budget.nacked rounds.max=2", "budget.wrong bytes.max=30", "budget.data age.max=64 ms"),
            ),
            ("serve", "send"),
        ),
        Run(  # a head that starts late and omits five of six rounds; frames end where such a round would be near
            *("imu_hil_robust", "imu_hil_broken_line", "0.2"),
            (
                *(*NO_FAULT, "host.first=19.4 ms", "controller.first=60 ms", "controller.period=120 ms"),
                *("budget.data age.max=150 ms", f"budget.SCI overruns={FRAME_TO_MODELS}"),
            ),
            ("wait_for_round", "look_at_round", "run", "start_timer"),
        ),
    ),
    "startup": (
        Run("imu_hil", "imu_hil", "0.09", COLLIDING),
        Run("imu_hil", "imu_hil_400k", "0.06", COLLIDING),
        RESET,
    ),
}


BROKEN, ENDED = "budget broken", "run ended"
MOVED, MOVED_IN_TIME = "figure moved", "instant moved"  # MOVED_IN_TIME: only the instant of a value differs


@dataclass(frozen=True)
class Trial:
    """The result of a mutant.

    by: the budget that caught it, or the error that ended the run; empty if nothing did.
    how: BROKEN, ENDED, MOVED, MOVED_IN_TIME or "".
    """

    mutant: Mutant
    case: str = ""
    by: str = ""
    how: str = ""


def all_mutants(file: str) -> list[Mutant]:
    """Return the mutants of a firmware, or of the start-up that both firmwares share."""
    return list(mutants(file, _source(file), FUNCTIONS[file]))


def tried(mutant: Mutant) -> Trial:
    moved = Trial(mutant)
    for run in RUNS[mutant.file]:
        if run.functions and mutant.function not in run.functions:
            continue
        try:
            by, figures = _ran(run, mutated(run.firmware, mutant))
        except Exception as error:  # firmware that cannot continue; a run reports its line
            return Trial(mutant, str(run), f"{type(error).__name__}: {error}".splitlines()[0], ENDED)
        if by or figures is None:
            return Trial(mutant, str(run), by, BROKEN)
        moved = _moved(mutant, str(run), usual_figures(run), figures) or moved
        if moved.how == MOVED:
            break
    return moved


def _moved(mutant: Mutant, case: str, usual: Baseline, figures: Baseline) -> Trial | None:
    """Return a trial with the first difference that `check` reports; a value precedes an instant."""
    changes = [change for change in compare(usual, figures) if not change.note]
    values = [change for change in changes if change.figure not in INSTANTS]
    for how, found in ((MOVED, values), (MOVED_IN_TIME, changes)):
        if found:
            return Trial(mutant, case, found[0].budget or found[0].figure, how)
    return None


@cache
def usual_figures(run: Run) -> Baseline:
    """Return the figures of the unchanged firmware, which must pass all budgets."""
    by, figures = _ran(run, unchanged(run.firmware))
    assert figures is not None and not by, f"{run} fails with the unchanged firmware: {by}"
    return figures


def _ran(run: Run, module: Any) -> tuple[str, Baseline | None]:
    """Return the first budget that is broken or not judged (or that firmware hangs), and the figures of all budgets."""
    case = load(ROOT / "timing" / f"{run.case}.toml", [*run.changes, STALLED])
    scene = Scene(case, programs={"dsp": Firmware("mutant", module.main, module.Settings)})
    end = scene.start + scene.timebase.ticks(run.seconds + " s", "nearest")
    step = scene.timebase.ticks(STEP)
    while scene.kernel.now + step < end:
        scene.kernel.run_until(scene.kernel.now + step)
        found = next((limit.budget.name for limit in scene.limits if broken(limit)), "")
        if found:
            return found, None
    result = scene.run(scene.timebase.seconds(end - scene.kernel.now))
    failed = next((verdict.name for verdict in result.budgets if not verdict.passed), "")
    if not failed and result.verdict == "fail":
        failed = "firmware waits for ever"
    return failed, baseline_of(scene, result)


def unchanged(firmware: str) -> Any:
    """Return the module of the unchanged firmware."""
    return compiled(_source(firmware), firmware)


def broken(limit: BudgetJudge) -> bool:
    """True if the measured value exceeds a limit, which no later value can correct."""
    measure = limit.measure
    most, least = limit.plan.limits.get("max"), limit.plan.limits.get("min")
    if measure.silent or not measure.count:
        return False
    return (most is not None and measure.worst > most) or (least is not None and measure.least < least)


def mutated(firmware: str, mutant: Mutant) -> Any:
    if mutant.file == firmware:
        return compiled(mutant.tree(), firmware)
    package = ModuleType(PACKAGE)
    package.__dict__.update(vars(import_module(PACKAGE)))
    start = compiled(mutant.tree(), STARTUP)
    package.__dict__.update({name: getattr(start, name) for name in FUNCTIONS[STARTUP]})
    return compiled(_source(firmware), firmware, {PACKAGE: package})


@cache
def _source(name: str) -> str:
    folder = ROOT / PACKAGE.replace(".", "/") if name == STARTUP else SOURCES
    return (folder / f"{name}.py").read_text(encoding="utf-8")


_number = count()


def compiled(source: str | ast.Module, name: str, stand_in: dict[str, ModuleType] | None = None) -> Any:
    """Return the module of a firmware's source; `stand_in` has modules to import instead of those of these names."""
    module = ModuleType(f"firmware_under_trial_{name}_{next(_number)}")
    module.__package__ = PACKAGE if name == STARTUP else "firmware.python"  # for its relative imports
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
