"""Run the shipped cases in full with a mutant as their firmware.

mutant --> each case of its firmware, as shipped --> "case: budget", or ""
"""

from __future__ import annotations

from fractions import Fraction
from time import process_time
from typing import Any

from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene

from .changes import Mutant
from .trials import ROOT, STALLED, STEP, broken, mutated

# The cases that a firmware passes; for the robust one, also those that docs/flagship.md runs with it.
SHIPPED = {
    "imu_hil": ("imu_hil", "imu_hil_400k", "imu_hil_by_frame", "imu_hil_published", "imu_hil_drift"),
    "imu_hil_robust": (
        *("imu_hil_robust", "imu_hil", "imu_hil_400k", "imu_hil_broken_line", "imu_hil_doubled_frame"),
        *("imu_hil_glitches", "imu_hil_lost_byte", "imu_hil_module_reset", "imu_hil_reset"),
        *("imu_hil_silent_host", "imu_hil_spikes", "imu_hil_stuck_sda"),
    ),
}


PATIENCE = (
    150  # s of CPU time for all cases of a mutant, which take 2 s; a mutant whose waits execute each pass is slow
)


def detected(mutant: Mutant) -> str:
    """Return the case and the budget that fails first with this mutant, or "" if all cases pass."""
    module = mutated(mutant.file, mutant)
    began = process_time()
    for name in SHIPPED[mutant.file]:
        if process_time() - began < PATIENCE and (found := failing(name, module)):
            return found
    return ""


def failing(name: str, module: Any, seconds: str = "") -> str:
    """Return the case and the first budget that fails in it, or "" if all pass.

    seconds: to run, instead of the duration of the case.
    """
    case = load(ROOT / "timing" / f"{name}.toml", [STALLED])
    scene = Scene(case, programs={"dsp": Firmware("mutant", module.main, module.Settings)})
    end = scene.start + scene.timebase.ticks(Fraction(seconds) if seconds else case.duration, "nearest")
    step = scene.timebase.ticks(STEP * 4)
    began = process_time()
    while scene.kernel.now + step < end and not scene.stalled and process_time() - began < PATIENCE:
        scene.advance(scene.kernel.now + step)
        for limit in scene.limits:
            if broken(limit):
                return f"{name}: {limit.budget.name}"
    if process_time() - began >= PATIENCE:
        return ""
    result = scene.run(max(Fraction(0), scene.timebase.seconds(end - scene.kernel.now)))
    failed = next((verdict.name for verdict in result.budgets if not verdict.passed), "")
    if not failed and result.verdict == "fail":
        failed = "firmware waits for ever"
    return f"{name}: {failed}" if failed else ""
