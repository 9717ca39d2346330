"""The settings that the drivers of the sensor head write before the first round, as the chips receive them."""

from __future__ import annotations

import pytest

from periph_sim.devices.chips import chip_models
from periph_sim.imu.sensors import SENSORS as CHIPS
from tests.devices.bench import TIMEBASE, Bench, steady

G_2, GAUSS_2_5, DEG_S_2000 = 0, 3, 3  # codes of full scales


@pytest.mark.parametrize(
    ("name", "model", "fields"),
    [
        (
            "gyroscope",
            "itg3200",
            {"PWR_MGM.CLK_SEL": 1, "SMPLRT_DIV.SMPLRT_DIV": 0, "DLPF_FS.FS_SEL": DEG_S_2000, "DLPF_FS.DLPF_CFG": 3},
        ),
        (
            "accelerometer",
            "adxl345",
            {"BW_RATE.Rate": 10, "DATA_FORMAT.FULL_RES": 1, "DATA_FORMAT.Range": G_2, "POWER_CTL.Measure": 1},
        ),
        ("magnetometer", "hmc5883l", {"CRA.MA": 0, "CRA.DO": 6, "CRA.MS": 0, "CRB.GN": GAUSS_2_5, "Mode.MD": 0}),
    ],
)
def test_a_driver_sets_rate_scale_and_mode_of_its_chip(name: str, model: str, fields: dict[str, int]):
    bench = Bench(chip_models()[model](TIMEBASE, steady(0, 0, 0)))
    for request in CHIPS[name].startup:
        for transfer in request.transfers(by_stop=False):
            assert bench.transfer(*transfer.phases).acked
            assert all(bytes(phase.got) == phase.expect for phase in transfer.phases if phase.read)
    chip = bench.chips[0]
    assert {field: chip.get(*field.split(".")) for field in fields} == fields
    assert chip.lsb_per_unit == CHIPS[name].lsb_per_unit and not chip.notes
