"""The emulator's models run after each round or as soon as a frame is complete: age and stretch with each order."""

from __future__ import annotations

import pytest

from tests.scene.runs import Ran, run_file

FRAME_BY_FRAME = "unit.dsp.settings.models_run=frame"
MEASURED = (
    'budget=[{name="age", measure="age", max="1 s"}, {name="stretch", measure="stretch", max="1 s"}, '
    '{name="wrong bytes", measure="wrong bytes", max=0}]'
)


def measured(*changes: str, seconds: str = "0.3") -> tuple[float, float, Ran]:
    """Return the largest age in ms, the longest stretch in us, and the run."""
    ran = run_file("imu_hil_published", seconds, MEASURED, *changes)
    age, stretch, wrong = ran.result.budgets
    assert wrong.worst == 0 and age.worst is not None and stretch.worst is not None
    return float(age.worst) / 1000, float(stretch.worst), ran


@pytest.mark.parametrize("first_ms", [2, 7, 13])
def test_a_frame_that_the_models_process_at_once_is_read_in_the_next_round(first_ms: int):
    """A frame takes 1.04 ms; the magnetometer is read 1.95 ms into a round that begins at 5 ms."""
    age, stretch, _ = measured(FRAME_BY_FRAME, f"host.first={first_ms} ms")
    read = {2: 5, 7: 25, 13: 25}[first_ms]
    assert age == pytest.approx(read + 1.95 - first_ms - 1.04, abs=0.05) and stretch == 0


@pytest.mark.parametrize("first_ms", [2, 7, 13])
def test_models_that_run_after_a_round_process_the_frame_that_arrived_before_it(first_ms: int):
    age, stretch, _ = measured(f"host.first={first_ms} ms")
    read = {2: 25, 7: 45, 13: 45}[first_ms]
    assert age == pytest.approx(read + 1.95 - first_ms - 1.04, abs=0.05) and stretch == 0


def test_models_that_are_still_running_in_a_round_make_the_published_routine_hang():
    """The frame ends 50 us into the gyroscope's address, so SDIR is set when the models end.

    The read and write that clear SCD clear SDIR too: the routine then waits for SDIR for ever, and SCL is held.
    """
    ran = run_file("imu_hil_published", "0.1", FRAME_BY_FRAME, "host.first=4.01 ms")
    assert ran.answered() == [] and "dsp waits for I2C-A.I2CSTR.SDIR" in ran.result.stuck[0]


def test_without_new_frames_the_models_run_after_each_round():
    _, _, ran = measured(
        FRAME_BY_FRAME, "host.frames=2", "unit.dsp.settings.arithmetic=q16", "unit.dsp.settings.noise_seed=1"
    )
    magnetometers = [read[2] for read in ran.read()[5:]]
    assert len(set(magnetometers)) > len(magnetometers) // 2  # noise changes the codes
