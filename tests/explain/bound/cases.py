"""The IMU emulator's case with changes, its service routine made longer where that is asked for."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.explain.bound import Report, report
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from tests.scene.runs import TIMING


def imu_hil(*changes: str, frame_us: int = 0) -> Case:
    return load(TIMING / "imu_hil_published.toml", [f"unit.dsp.settings.frame_cost={frame_us} us", *changes])


def reported(*changes: str, frame_us: int = 0, seconds: str = "0.1") -> Report:
    return report(imu_hil(*changes, frame_us=frame_us), Fraction(seconds))


def named(of: Report) -> dict[str, float | None]:
    """What was seen, in cycles, by measure."""
    return {each.bound.name: None if each.seen is None else float(each.seen / of.cycle) for each in of.beside}
