"""Readings of the head over SCI, firmware and I2C equal those computed from the same frames and noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.moving import experiment as direct
from periph_sim.imu.moving import on_wires
from tests.imu.moving.subjects import TWO_ANGLES, flight, parameters, subject, without_noise


def agree(came: on_wires.Emulated, computed: dict[str, np.ndarray]) -> bool:
    return all(np.array_equal(codes, computed[name][came.runs]) for name, codes in came.readings.codes.items())


@pytest.mark.parametrize(
    "changes",
    [
        (),
        ("unit.dsp.settings.arithmetic=float64",),
        ("unit.dsp.settings.arithmetic=float32",),
        ("unit.dsp.settings.arithmetic=q12 saturating",),
        ("host.jitter=10 ms",),  # frames are late, so some runs get the previous frame
        ("host.frames=9",),  # then no frames come, and the last one is used repeatedly with new noise
        ("host.period=33 ms",),  # some runs have no new frame and use the previous one twice
        ("host.period=7 ms",),  # some frames are used by no run
        ("unit.dsp.settings.model_cost=15 ms",),
    ],
    ids=["q16", "float64", "float32", "q12", "late", "lost", "slow host", "quick host", "slow models"],
)
def test_bytes_are_those_computed_without_wires(changes: tuple[str, ...]):
    one = subject("0.6", TWO_ANGLES, *changes)
    came = on_wires.emulator(one)
    assert len(came.readings.seconds) == len(came.runs) >= 20
    computed = direct.computed_emulator(one, came.frames)
    assert agree(came, computed.codes)
    assert len(np.unique(came.readings.codes["accelerometer"][:, 0])) > 8, "the values change with motion and noise"


@settings(max_examples=12)
@given(st.integers(6_573_000, 6_581_000))
def test_a_frame_that_ends_while_the_models_begin_is_attributed_correctly(first_ns: int):
    """The models begin at 7.62 ms; a frame takes 1.04 ms, and its last bits may come after it was used."""
    one = subject("0.07", TWO_ANGLES, f"host.first={first_ns} ns")
    came = on_wires.emulator(one)
    assert agree(came, direct.computed_emulator(one, came.frames).codes)


def test_other_noise_frames_or_arithmetic_give_other_bytes():
    one = subject("0.6", TWO_ANGLES)
    came = on_wires.emulator(one)
    for change in ("unit.dsp.settings.noise_seed=2", "unit.dsp.settings.arithmetic=q8"):
        assert not agree(came, direct.computed_emulator(subject("0.6", TWO_ANGLES, change), came.frames).codes)
    assert not agree(came, direct.computed_emulator(one, np.maximum(came.frames - 1, -1)).codes)


@pytest.mark.parametrize(
    ("change", "period"),
    [
        ("host.period=20 ms", "20 ms"),
        ("host.period=33 ms", "20 ms"),
        ("host.period=7 ms", "20 ms"),
        ("host.frames=9", "20 ms"),
        ("controller.period=25 ms", "25 ms"),
        ("host.first=5 ms", "20 ms"),
    ],
)
def test_the_schedule_determines_the_frame_of_each_run(change: str, period: str, tmp_path: Path):
    one = subject("0.6", change, parameters(tmp_path, f'period = "{period}"'))
    came = on_wires.emulator(one)
    assert came.frames[: one.rounds].tolist() == direct.frames_by_schedule(one).tolist()
    assert came.readings.seconds == pytest.approx(direct.computed_emulator(one).seconds)


def test_without_frames_the_values_stay_and_the_noise_changes():
    """Section 3.4: the models run although no host data came, which keeps the noise changing."""
    came = on_wires.emulator(subject("0.6", TWO_ANGLES, "host.frames=9")).readings.codes["gyroscope"][14:]
    assert np.abs(came.mean(axis=0) - 14.375 * np.array([-3.0272, 3.5388, 0.0500])).max() < 1.5, "only the bias is left"
    assert all(len(np.unique(axis)) > 2 for axis in came.T)
    without = direct.computed_emulator(without_noise(subject("0.6", TWO_ANGLES, "host.frames=9"))).codes["gyroscope"][
        14:
    ]
    assert (without == without[0]).all()


def turning(tmp_path: Path, *changes: str) -> np.ndarray:
    """Return the rate about x in deg/s in each round except the first ones, while roll turns at 10 deg/s."""
    one = without_noise(subject("0.5", flight(tmp_path, "0,0,0,0,0,0,0\n9,90,0,0,0,0,0\n"), *changes))
    return on_wires.emulator(one).readings.samples(one.sensors).gyro[4:, 0]


def test_a_lost_frame_gives_a_rate_of_0_and_then_twice_the_rate(tmp_path: Path):
    """The backward difference of frames is 0 when the previous one is used again, and then that of two steps."""
    every, second = turning(tmp_path), turning(tmp_path, "host.period=40 ms")
    assert every == pytest.approx(np.full(len(every), 10.0), abs=0.5)  # 1e-4 rad per frame are 0.3 deg/s
    slow = np.sort(second)
    assert slow[: len(slow) // 2] == pytest.approx(np.zeros(len(slow) // 2), abs=0.1)
    assert slow[-(len(slow) // 2) :] == pytest.approx(np.full(len(slow) // 2, 20.0), abs=0.5)


def test_frames_at_twice_the_rate_have_no_effect(tmp_path: Path):
    assert turning(tmp_path, "host.period=10 ms") == pytest.approx(turning(tmp_path), abs=0.5)


def test_real_chips_sample_the_motion_within_their_own_periods():
    """Without motion both read the same except for noise and LSB; the chips' data are of the last 13.4 ms."""
    one = subject("0.4", 'host.motion={kind = "static", theta = "20 deg"}')
    quiet = without_noise(one)
    chips, computed = on_wires.chips(quiet), direct.computed_sensors(quiet)
    for name, codes in chips.codes.items():
        assert (codes == computed.codes[name]).all()
    assert chips.overflow == -4096
