"""Captures of realistic size, generated here: `.sr` files of 20, 50 and 76 million samples.

    dense   I2C, 20 million samples, 1.03 million edges: a flash that is written and polled continuously
    sparse  I2C, 50 million samples, 37 thousand edges: a sensor that is read at intervals
    uart    115200 8n1 at 24 MHz, 76 million samples, 164 thousand edges

They have the format that sigrok writes: deflate at its default level, chunks of 4 MiB, one byte per sample.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np

from tests.traces.formats.writers import I2cWave, frame_bits, sr_bytes, uart_wave

CHUNK = 4 << 20
BIT = 48  # samples of one bit on the I2C bus


def page_write(wave: I2cWave, number: int) -> None:
    """Write 16 bytes to a flash, and poll its address until it has stored them."""
    place = number >> 4 & 0xFF, number << 4 & 0xFF
    wave.transfer(0xA0, *place, *(number * 31 + byte * 37 & 0xFF for byte in range(16)))
    wave.idle(BIT)
    wave.start()
    for _ in range(29):
        wave.byte(0xA0, ack=False)
        wave.again()
    wave.byte(0xA0)
    wave.stop()
    wave.idle(BIT)


def sensor_read(wave: I2cWave, number: int) -> None:
    """Read six bytes from a register of a sensor."""
    wave.start()
    wave.byte(0xD0)
    wave.byte(0x1D)
    wave.again()
    wave.byte(0xD1)
    for place in range(6):
        wave.byte(number * 7 + place * 59 & 0xFF, ack=place < 5)
    wave.stop()


def dense(length: int = 20_000_000) -> bytes:
    wave = I2cWave(BIT // 2, BIT // 8, idle=10 * BIT)
    number = 0
    while len(wave.samples) < length:
        page_write(wave, number)
        number += 1
    return bytes(wave.samples[:length])


def sparse(length: int = 50_000_000) -> bytes:
    wave = I2cWave(BIT // 2, BIT // 8)
    for number in range(176):
        sensor_read(wave, number)
        wave.idle((number + 1) * length // 176 - len(wave.samples))
    return bytes(wave.samples)


def uart(length: int = 76_000_000, rate: int = 24_000_000, baud: int = 115_200) -> bytes:
    """Return bursts of sixteen frames with a pause of a few bits between bursts."""
    values = np.random.default_rng(115200).integers(0, 256, 30_000).tolist()
    width = Fraction(rate, baud)
    silence = length * baud // rate - 10 * len(values) - 40  # bit times to distribute over the pauses
    pause = silence // (len(values) // 16 + 1)
    begins = (20 + 10 * number + number // 16 * pause for number in range(len(values)))
    frames = ((begin * width, frame_bits(value)) for begin, value in zip(begins, values, strict=True))
    return uart_wave(frames, width, length)


MAKERS: dict[str, tuple[Callable[[], bytes], list[str], str]] = {
    "dense": (dense, ["SCL", "SDA"], "8 MHz"),
    "sparse": (sparse, ["SCL", "SDA"], "8 MHz"),
    "uart": (uart, ["RX"], "24 MHz"),
}


def write(folder: Path) -> dict[str, Path]:
    """Write the three files, except those that exist, and return their paths by name."""
    found = {}
    for name, (make, names, rate) in MAKERS.items():
        found[name] = path = folder / f"{name}.sr"
        if path.exists():
            continue
        samples = make()
        chunks = (samples[begin : begin + CHUNK] for begin in range(0, len(samples), CHUNK))
        path.write_bytes(sr_bytes(names, rate, *chunks, compression=zipfile.ZIP_DEFLATED))
    return found
