"""Pulses that real chips follow at once, against the same scene edge by edge: nothing that shows may differ."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.case.load import load
from tests.board.runs import TIMING
from tests.board.small import case
from tests.board.test_pulses_at_once import alike
from tests.board.test_real_chips import ACCEL, MAG, ORDER, THREE

pytestmark = pytest.mark.long


@pytest.mark.parametrize("name", ["real_chips", "imu_chips"])
def test_every_case(name: str):
    many, few = alike(load(TIMING / f"{name}.toml"), "0.25")
    assert few < many / 2


def test_a_unit_and_chips_on_one_bus():
    """The emulator takes the accelerometer's and the magnetometer's turn too: both send, ones give way to zeros."""
    unit = {"dsp": {"firmware": "imu_hil", "modules": ["I2C-A"]}}
    chips = {"accelerometer": ACCEL, "magnetometer": MAG}
    many, few = alike(case(unit=unit, chip=chips, controller={"order": ORDER}), "0.1")
    assert few < many


delays = st.sampled_from(["1 ns", "100 ns", "300 ns", "1249 ns", "1250 ns", "1251 ns", "2 us", "4 us"])
requests = st.lists(
    st.fixed_dictionaries(
        {
            "address": st.sampled_from([0x68, 0x53, 0x1E, 0x10]),
            "pointer": st.one_of(st.none(), st.integers(0, 0x40)),
            "count": st.integers(0, 8),
            "write": st.binary(max_size=3),
        }
    ),
    min_size=1,
    max_size=4,
)


@settings(max_examples=60, deadline=None)
@given(requests, st.lists(delays, min_size=3, max_size=3), st.sampled_from(["100 kHz", "400 kHz"]), st.booleans())
def test_any_requests_delays_and_rates(asked: list[dict[str, Any]], late: list[str], rate: str, by_stop: bool):
    chips = {name: chip | {"output_delay": delay} for (name, chip), delay in zip(THREE.items(), late, strict=True)}
    pointer_by = "STOP" if by_stop else "repeated START"
    for request in asked:
        if request["pointer"] is None:
            del request["pointer"]
    controller = {"request": asked, "rate": rate, "period": "7 ms", "pointer_by": pointer_by}
    alike(case(chip=chips, controller=controller), "0.03")
