"""Tables 5.1 and 5.2 of the dissertation, as printed: 10 000 samples at rest at 50 Hz, and memory of the code."""

from __future__ import annotations

from typing import NamedTuple

Three = tuple[float, float, float]  # x, y, z

SAMPLES = 10_000
RATE = 50  # Hz


class Row(NamedTuple):
    """One row, in g, deg/s or gauss. The variances of the magnetometer are printed as 0.0000."""

    mean: Three
    three_sigma: Three
    variance: Three


REAL = {
    "accelerometer": Row((-0.0188, 0.0196, -1.0007), (0.0831, 0.0801, 0.0887), (0.0008, 0.0007, 0.0009)),
    "gyroscope": Row((-3.1041, 3.5997, 0.0438), (0.1312, 0.1475, 0.1338), (0.0019, 0.0024, 0.0020)),
    "magnetometer": Row((0.3239, -0.0447, 0.0060), (0.0149, 0.0190, 0.0082), (0.0000, 0.0000, 0.0000)),
}
EMULATOR = {
    "accelerometer": Row((-0.0301, 0.0076, -1.0035), (0.0857, 0.0845, 0.0839), (0.0008, 0.0008, 0.0008)),
    "gyroscope": Row((-3.0313, 3.5380, 0.0535), (0.1452, 0.2370, 0.1356), (0.0023, 0.0062, 0.0020)),
    "magnetometer": Row((0.3231, -0.0447, 0.0056), (0.0164, 0.0187, 0.0097), (0.0000, 0.0000, 0.0000)),
}


class Memory(NamedTuple):
    """One row of Table 5.2: 16-bit words, and the printed share of RAM and flash in percent."""

    words: int
    ram: float
    flash: float


# Table 5.2: memory of the generated code. Its total is the row TOTAL.
MEMORY = {
    "Model_IMU": Memory(6396, 18.81, 2.50),
    "Model_IMU_main": Memory(130, 0.38, 0.05),
    "csl": Memory(183, 0.54, 0.07),
    "board": Memory(119, 0.35, 0.05),
    "i2c": Memory(36, 0.11, 0.01),
    "other routines": Memory(3839, 11.29, 1.50),
}
TOTAL = Memory(10703, 31.48, 4.18)
