"""Moving experiments for tests: the case timing/imu_moving.toml with changes and a short duration."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from periph_sim.imu.moving.subject import EmulatorUnderTest, subject_of
from periph_sim.scene.case.load import load
from tests.scene.runs import TIMING

TWO_ANGLES = (
    'host.motion={kind = "sines", angles = ['
    '{of = "theta", amplitude = "40 deg", frequency = "0.2 Hz"}, '
    '{of = "phi", amplitude = "50 deg", frequency = "0.25 Hz"}]}'
)
STILL = 'host.motion={kind = "static", theta = "20 deg", phi = "-35 deg", psi = "60 deg"}'


def subject(seconds: str, *changes: str) -> EmulatorUnderTest:
    return subject_of(load(TIMING / "imu_moving.toml", list(changes)), Fraction(seconds))


def flight(folder: Path, rows: str) -> str:
    """Return the change to a recorded flight with these rows."""
    path = folder / "flight.csv"
    path.write_text(f"time [s],phi [deg],theta [deg],psi [deg],ax [g],ay [g],az [g]\n{rows}", encoding="utf-8")
    return f'host.motion={{kind = "flight", file = "{path}"}}'


def parameters(folder: Path, text: str) -> str:
    """Return the change to a set of parameters in TOML."""
    path = folder / "set.toml"
    path.write_text(text, encoding="utf-8")
    return f"unit.dsp.settings.parameters={path}"


def without_noise(one: EmulatorUnderTest) -> EmulatorUnderTest:
    """Return the same subject without noise, also in its firmware."""
    unit = one.case.unit[one.unit]
    settings = {name: value for name, value in unit.settings.items() if name != "noise_seed"}
    case = one.case.model_copy(update={"unit": {one.unit: unit.model_copy(update={"settings": settings})}})
    return replace(one, case=case, seed=None)
