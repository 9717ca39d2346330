"""As built against corrected (appendix B): rates that are integrated give the true attitude, or do not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from periph_sim.imu.attitude import errors
from periph_sim.imu.models.parameters import Rates
from periph_sim.imu.moving import experiment as direct
from periph_sim.imu.moving.experiment import attitudes, truth
from periph_sim.imu.moving.subject import EmulatorUnderTest
from periph_sim.imu.samples import Readings
from tests.imu.motion import at_times
from tests.imu.moving.subjects import TWO_ANGLES, flight, parameters, subject, without_noise

FLOAT = "unit.dsp.settings.arithmetic=float64"
FINE = 'host.encoding={phi = "3.2e-5 rad", theta = "3.2e-5 rad"}'


def turned(attitude: np.ndarray, rates: np.ndarray, period: float) -> np.ndarray:
    """One quaternion further, at constant body rates in rad/s."""
    angle = np.linalg.norm(rates) * period
    axis = rates / np.linalg.norm(rates) if angle else rates
    w, (x, y, z) = np.cos(angle / 2), np.sin(angle / 2) * axis
    aw, ax, ay, az = attitude
    return np.array(
        [
            aw * w - ax * x - ay * y - az * z,
            aw * x + ax * w + ay * z - az * y,
            aw * y - ax * z + ay * w + az * x,
            aw * z + ax * y - ay * x + az * w,
        ]
    )


def drift(one: EmulatorUnderTest, rates: Rates) -> float:
    """Degrees between truth and what the gyroscope alone tells, at the end; each round shows the frame before."""
    one = without_noise(one).with_rates(rates)
    found = direct.computed_emulator(one).samples(one.sensors).gyro
    host = one.host
    times = np.array([float(host.first + n * host.period) for n in range(one.rounds - 1)])
    attitude = truth(one, times[:1])[0]
    for body in np.radians(found[2:]):
        attitude = turned(attitude, body, float(host.period))
    return float(errors([attitude], truth(one, times[-1:])).total[0])


def test_corrected_rates_integrate_to_the_true_attitude_and_those_as_built_do_not():
    """Two angles at once for 7 s; what is left of the corrected ones is LSB, frames' steps and steps of 20 ms."""
    one = subject("7", TWO_ANGLES, FLOAT)
    assert drift(one, "corrected") < 2.0
    assert drift(one, "as built") > 20.0


WAVE = 'host.motion={kind = "sines", angles = [{of = "%s", amplitude = "40 deg", frequency = "0.3 Hz"}]}'


@pytest.mark.parametrize(
    ("seconds", "changes"), [("6", []), *(("2", [WAVE % angle]) for angle in ("phi", "theta", "psi"))]
)
def test_they_agree_while_one_angle_moves_from_zero(seconds: str, changes: list[str]):
    """As in the servo sequence of the published experiment, of which appendix B says so."""
    one = subject(seconds, *changes)
    built, corrected = (direct.computed_emulator(one.with_rates(rates)).codes for rates in ("as built", "corrected"))
    assert all(np.array_equal(built[name], corrected[name]) for name in built)


def through_half_a_turn(tmp_path: Path, wrap: str, *changes: str) -> tuple[EmulatorUnderTest, Readings]:
    """Yaw from 150 on to 210 degrees in 3 s, which the host sends as -150."""
    through = flight(tmp_path, "0,0,0,150,0,0,0\n3,0,0,210,0,0,0\n")
    one = subject("3", through, parameters(tmp_path, f'wrap = "{wrap}"\n'), *changes)
    return one, direct.computed_emulator(one)


@pytest.mark.parametrize(
    ("arithmetic", "code"),
    [
        ("float64", -0x8000),  # saturated, as the converter would
        # -18 000 deg/s * 14.375 do not fit Q16: an odd number of turns of 2**16 LSB later it is a rate that may be
        ("q16", 3700),
    ],
)
def test_yaw_through_half_a_turn_is_one_wild_rate_as_built(tmp_path: Path, arithmetic: str, code: int):
    _, readings = through_half_a_turn(tmp_path, "as built", f"unit.dsp.settings.arithmetic={arithmetic}")
    about_z = readings.codes["gyroscope"][3:, 2]
    wild = about_z[np.abs(about_z - 20 * 14.375) > 1000]
    assert len(wild) == 1 and wild[0] == pytest.approx(code, abs=400)


def test_yaw_through_half_a_turn_goes_on_unwrapped_and_no_error_jumps(tmp_path: Path):
    one, readings = through_half_a_turn(tmp_path, "unwrapped")
    about_z = readings.samples(one.sensors).gyro[3:, 2]
    assert about_z == pytest.approx(np.full(len(about_z), 20.0), abs=1.0)
    yaw = np.degrees(at_times.attitudes(one.motion, readings.seconds)[:, 2])
    assert yaw.max() > 170 and yaw.min() < -140
    found = errors(attitudes(one, readings), truth(one, readings.seconds))
    assert np.abs(found.yaw[10:]).max() < 3 and found.total[10:].max() < 3
