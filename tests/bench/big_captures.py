"""Captures of the size that people bring, made here: `.sr` files of 20, 50 and 76 million samples.

    dense   I2C, 20 million samples, 1.05 million edges: a flash being written and polled without a rest
    sparse  I2C, 50 million samples, 37 thousand edges: a sensor read now and then
    uart    115200 8n1 at 24 MHz, 76 million samples, 164 thousand edges

Written as sigrok writes them: deflate at its usual level, chunks of 4 MiB, one byte a sample.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path

import numpy as np

from tests.traces.formats.writers import frame_bits, sr_bytes, uart_wave

CHUNK = 4 << 20
BIT = 48  # samples of one bit on the I2C bus

ZERO, ONE, START, AGAIN, STOP, IDLE = range(6)

# SDA changes while SCL is low; a symbol begins there and ends short of the next change. Bit 0 is SCL, bit 1 is SDA.
SHAPES = {
    ZERO: ((18, 0, 0), (24, 1, 0), (6, 0, 0)),
    ONE: ((18, 0, 1), (24, 1, 1), (6, 0, 1)),
    START: ((18, 1, 1), (24, 1, 0), (6, 0, 0)),
    AGAIN: ((12, 0, 1), (12, 1, 1), (18, 1, 0), (6, 0, 0)),
    STOP: ((12, 0, 0), (12, 1, 0), (24, 1, 1)),
    IDLE: ((48, 1, 1),),
}


def i2c_samples(symbols: Iterable[int], length: int) -> bytes:
    """The samples of a sequence of symbols, then silence up to `length`."""
    shapes = np.array(
        [[scl | sda << 1 for count, scl, sda in SHAPES[kind] for _ in range(count)] for kind in sorted(SHAPES)],
        np.uint8,
    )
    wave = shapes[np.fromiter(symbols, np.int64)].ravel()[:length]
    return wave.tobytes() + bytes([3]) * (length - len(wave))


def byte(value: int, ack: bool = True) -> list[int]:
    return [ONE if value >> place & 1 else ZERO for place in range(7, -1, -1)] + [ZERO if ack else ONE]


def page_write(number: int) -> list[int]:
    """16 bytes to a flash, then its address until it has written them."""
    symbols = [START, *byte(0xA0), *byte(number >> 4 & 0xFF), *byte(number << 4 & 0xFF)]
    for place in range(16):
        symbols += byte(number * 31 + place * 37 & 0xFF)
    symbols += [STOP, IDLE, START]
    for _ in range(29):
        symbols += [*byte(0xA0, ack=False), AGAIN]
    return [*symbols, *byte(0xA0), STOP, IDLE]


def sensor_read(number: int) -> list[int]:
    """Six bytes from a register of a sensor."""
    symbols = [START, *byte(0xD0), *byte(0x1D), AGAIN, *byte(0xD1)]
    for place in range(6):
        symbols += byte(number * 7 + place * 59 & 0xFF, ack=place < 5)
    return [*symbols, STOP]


def dense(length: int = 20_000_000) -> bytes:
    symbols: list[int] = [IDLE] * 10
    number = 0
    while len(symbols) * BIT < length:
        symbols += page_write(number)
        number += 1
    return i2c_samples(symbols, length)


def sparse(length: int = 50_000_000) -> bytes:
    symbols: list[int] = []
    for number in range(176):
        symbols += sensor_read(number)
        symbols += [IDLE] * (length // BIT // 176 - len(sensor_read(number)))
    return i2c_samples(symbols, length)


def uart(length: int = 76_000_000, rate: int = 24_000_000, baud: int = 115_200) -> bytes:
    """Bursts of sixteen frames, each burst a few bits apart from the last."""
    values = np.random.default_rng(115200).integers(0, 256, 30_000).tolist()
    width = Fraction(rate, baud)
    silence = length * baud // rate - 10 * len(values) - 40  # bit times of it to spread
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
    """The three files, by name; those that are there already stay."""
    found = {}
    for name, (make, names, rate) in MAKERS.items():
        found[name] = path = folder / f"{name}.sr"
        if path.exists():
            continue
        samples = make()
        chunks = (samples[begin : begin + CHUNK] for begin in range(0, len(samples), CHUNK))
        path.write_bytes(sr_bytes(names, rate, *chunks, compression=zipfile.ZIP_DEFLATED))
    return found
