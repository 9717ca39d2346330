"""Rates as built and corrected (appendix B): where they agree, and yaw through half a turn, as built and unwrapped."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from periph_sim.imu.attitude import errors
from periph_sim.imu.moving import experiment as direct
from periph_sim.imu.moving.experiment import attitudes, truth
from periph_sim.imu.moving.subject import EmulatorUnderTest
from periph_sim.imu.samples import Readings
from tests.imu.motion import at_times
from tests.imu.moving.subjects import flight, parameters, subject

WAVE = 'host.motion={kind = "sines", angles = [{of = "%s", amplitude = "40 deg", frequency = "0.3 Hz"}]}'


@pytest.mark.parametrize(
    ("seconds", "changes"), [("6", []), *(("2", [WAVE % angle]) for angle in ("phi", "theta", "psi"))]
)
def test_both_rates_agree_while_one_angle_moves_from_zero(seconds: str, changes: list[str]):
    """The servo sequence of the published experiment is such a motion, as appendix B states."""
    one = subject(seconds, *changes)
    built, corrected = (direct.computed_emulator(one.with_rates(rates)).codes for rates in ("as built", "corrected"))
    assert all(np.array_equal(built[name], corrected[name]) for name in built)


def through_half_a_turn(tmp_path: Path, wrap: str, *changes: str) -> tuple[EmulatorUnderTest, Readings]:
    """Return a subject whose yaw goes from 150 to 210 degrees (sent as -150) in 3 s, and its readings."""
    through = flight(tmp_path, "0,0,0,150,0,0,0\n3,0,0,210,0,0,0\n")
    one = subject("3", through, parameters(tmp_path, f'wrap = "{wrap}"\n'), *changes)
    return one, direct.computed_emulator(one)


@pytest.mark.parametrize(
    ("arithmetic", "code"),
    [
        ("float64", -0x8000),  # saturated, as by the converter
        # -18 000 deg/s * 14.375 do not fit Q16; wrapped by an odd multiple of 2**16 LSB they are a plausible rate
        ("q16", 3700),
    ],
)
def test_yaw_through_half_a_turn_gives_one_wrong_rate_as_built(tmp_path: Path, arithmetic: str, code: int):
    _, readings = through_half_a_turn(tmp_path, "as built", f"unit.dsp.settings.arithmetic={arithmetic}")
    about_z = readings.codes["gyroscope"][3:, 2]
    wild = about_z[np.abs(about_z - 20 * 14.375) > 1000]
    assert len(wild) == 1 and wild[0] == pytest.approx(code, abs=400)


def test_unwrapped_yaw_through_half_a_turn_gives_no_jump(tmp_path: Path):
    one, readings = through_half_a_turn(tmp_path, "unwrapped")
    about_z = readings.samples(one.sensors).gyro[3:, 2]
    assert about_z == pytest.approx(np.full(len(about_z), 20.0), abs=1.0)
    yaw = np.degrees(at_times.attitudes(one.motion, readings.seconds)[:, 2])
    assert yaw.max() > 170 and yaw.min() < -140
    found = errors(attitudes(one, readings), truth(one, readings.seconds))
    assert np.abs(found.yaw[10:]).max() < 3 and found.total[10:].max() < 3
