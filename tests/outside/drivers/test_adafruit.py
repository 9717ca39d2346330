"""Adafruit's published drivers work with chip models, and with firmware that emulates a chip.

The drivers assume 4 mg per LSB, while the ADXL345 has 1/256 g, and 1/1100 gauss, while the HMC5883L has 1/1090.
"""

from __future__ import annotations

import pytest

from periph_sim.api import make_case
from periph_sim.outside import Session
from periph_sim.outside.drivers import I2C
from tests.outside.test_any_order import pins
from tests.outside.test_register_slave import slave

WHY = "Adafruit's drivers are not installed: the extra drivers has them"
adxl34x = pytest.importorskip("adafruit_adxl34x", reason=WHY)
lsm303dlh_mag = pytest.importorskip("adafruit_lsm303dlh_mag", reason=WHY)

G = 9.80665


def chips() -> tuple[Session, I2C]:
    felt = {"accelerometer": ["0.5", "-0.25", "1"], "magnetometer": ["0.32", "-0.04", "0.16"]}
    models = {"accelerometer": "adxl345", "magnetometer": "hmc5883l"}
    tables = {name: {"model": models[name], "values": {"fixed": felt[name]}} for name in felt}
    session = Session(make_case(name="chips", duration="1 s", outside={"wires": ["SDA", "SCL"]}, chip=tables))
    return session, I2C(session, pause="200 ms")


def test_an_accelerometer_model_is_driven_as_the_chip() -> None:
    _, i2c = chips()
    sensor = adxl34x.ADXL345(i2c)
    assert sensor.acceleration == pytest.approx((128 * 0.004 * G, -64 * 0.004 * G, 256 * 0.004 * G), abs=1e-6)
    sensor.range = adxl34x.Range.RANGE_16_G
    sensor.data_rate = adxl34x.DataRate.RATE_200_HZ
    assert (sensor.range, sensor.data_rate) == (adxl34x.Range.RANGE_16_G, adxl34x.DataRate.RATE_200_HZ)
    assert sensor.offset == (0, 0, 0)


def test_a_magnetometer_model_is_driven_as_the_chip() -> None:
    _, i2c = chips()
    sensor = lsm303dlh_mag.LSM303DLH_Mag(i2c)
    assert sensor.magnetic[:2] == pytest.approx((349 / 11, -44 / 11))  # 0.32 * 1090, -0.04 * 1090
    sensor.mag_rate = lsm303dlh_mag.MAGRATE_75
    assert sensor.magnetic[:2] == pytest.approx((349 / 11, -44 / 11))


def test_firmware_is_driven_as_the_chip() -> None:
    """An F28335 has the registers of an ADXL345: its identity at 0 and a sample at 0x32."""
    registers = bytearray(0x39)
    registers[0] = 0xE5
    registers[0x32:0x38] = (
        (100).to_bytes(2, "little") + (-50 & 0xFFFF).to_bytes(2, "little") + (256).to_bytes(2, "little")
    )
    sensor = adxl34x.ADXL345(I2C(slave(address=0x53, registers=registers.hex(" "))))
    assert sensor.acceleration == pytest.approx((100 * 0.004 * G, -50 * 0.004 * G, 256 * 0.004 * G), abs=1e-6)
    sensor.data_rate = adxl34x.DataRate.RATE_100_HZ
    assert sensor.data_rate == adxl34x.DataRate.RATE_100_HZ


def test_firmware_with_i2c_in_software_is_driven_as_the_chip() -> None:
    """The emulator on GPIO pins has received no frame, so its data bytes are 0; the driver also writes registers."""
    sensor = adxl34x.ADXL345(I2C(pins()))
    assert sensor.acceleration == (0, 0, 0)
    sensor.range = adxl34x.Range.RANGE_8_G
    assert sensor.range == adxl34x.Range.RANGE_8_G


def test_a_missing_chip_gives_the_error_of_the_driver() -> None:
    with pytest.raises(ValueError, match="No I2C device at address: 0x53"):
        adxl34x.ADXL345(I2C(slave(address=0x20)))
