"""The data by which a controller reads the three sensors of an IMU: registers, scales and start-up requests.

The key `order` in the [controller] and [rounds] tables of a case contains the names of these sensors.

Source: the dissertation's Figure A.2 (order), Table 3.1 (scales); data sheets of ITG-3200 (registers 0x1D to 0x22),
ADXL345 (0x32 to 0x37), HMC5883L (0x03 to 0x08).
"""

from __future__ import annotations

from fractions import Fraction

from ..devices.sensor_rounds import ChipData, driver

SENSORS: dict[str, ChipData] = {
    "gyroscope": ChipData(
        0x68,
        0x1D,
        big=True,
        lsb_per_unit=Fraction(115, 8),
        unit="deg/s",
        # The driver selects the PLL with the x gyroscope as clock source, a sample rate of 1 kHz, a full scale of
        # 2000 deg/s and a low-pass filter of 42 Hz.
        startup=driver("gyroscope", 0x68, (0x00, "68"), ((0x3E, 0x01), (0x15, 0x00), (0x16, 0x1B))),
    ),
    "accelerometer": ChipData(
        0x53,
        0x32,
        big=False,
        lsb_per_unit=Fraction(256),
        unit="g",
        # The driver selects a sample rate of 100 Hz, full resolution and a range of 2 g, and starts to measure.
        startup=driver("accelerometer", 0x53, (0x00, "e5"), ((0x2C, 0x0A), (0x31, 0x08), (0x2D, 0x08))),
    ),
    "magnetometer": ChipData(
        0x1E,
        0x03,
        big=True,
        order=(0, 2, 1),
        lsb_per_unit=Fraction(660),
        unit="gauss",
        overflow=-4096,
        # The driver selects an output rate of 75 Hz, a range of 2.5 gauss and continuous measurement.
        startup=driver("magnetometer", 0x1E, (0x0A, "48 34 33"), ((0x00, 0x18), (0x01, 0x60), (0x02, 0x00))),
    ),
}
