"""Generator of traces/*.sr. `python -m tests.traces.formats.make_traces` writes them, and a test compares them.

All values are invented, within the ranges of the sensors; see traces/README.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from tests.traces.formats.writers import I2cWave, frame_bits, sr_bytes, uart_wave

FOLDER = Path(__file__).resolve().parents[3] / "traces"

# Address, register pointer, six bytes: a head at rest and level.
ROUND = (
    (0x68, 0x1D, (0x00, 0x12, 0xFF, 0xF3, 0x00, 0x05)),  # ITG-3200: X, Y, Z, high byte first
    (0x53, 0x32, (0xFB, 0xFF, 0x05, 0x00, 0x00, 0xFF)),  # ADXL345: X, Y, Z, low byte first
    (0x1E, 0x03, (0x00, 0xD6, 0x00, 0x04, 0xFF, 0xE2)),  # HMC5883L: X, Z, Y, high byte first
)

# Six little-endian signed words: roll, pitch, yaw in 1e-4 rad, accelerations in 1e-3 g.
FRAMES = ((0, 873, -1745, 0, 0, -1000), (17, 890, -1728, 12, -9, -1003))


def imu_round() -> bytes:
    """One request round at 100 kHz with 40 samples per bit: gyroscope, accelerometer, magnetometer."""
    wave = I2cWave(idle=400)
    for address, pointer, values in ROUND:
        read_registers(wave, address, pointer, values)
        wave.idle(200)
    return sr_bytes(["SCL", "SDA"], "4 MHz", bytes(wave.samples))


def nack() -> bytes:
    """An accelerometer at 100 kHz that does not acknowledge twice and then answers."""
    wave = I2cWave(idle=400)
    for _ in range(2):
        wave.transfer(0x53 << 1, nack_last=True)
        wave.idle(800)
    read_registers(wave, 0x53, 0x00, (0xE5,))
    wave.idle(200)
    return sr_bytes(["SCL", "SDA"], "4 MHz", bytes(wave.samples))


def host_frames() -> bytes:
    """Two frames of 12 bytes at 115200 8n1, 5 ms apart, sampled at 1 MHz."""
    width = Fraction(10**6, 115200)
    bits = []
    for number, words in enumerate(FRAMES):
        content = b"".join(word.to_bytes(2, "little", signed=True) for word in words)
        bits += [(Fraction(300 + 5000 * number) + 10 * width * n, frame_bits(byte)) for n, byte in enumerate(content)]
    return sr_bytes(["RX"], "1 MHz", uart_wave(bits, width, 6700))


def seven_even() -> bytes:
    """Text at 19200 7e1, sampled at 200 kHz, then a byte without its stop bit and a break of 14 bits."""
    width = Fraction(200_000, 19_200)
    at = Fraction(400)
    bits = []
    for byte in b"seven even\r\n":
        bits.append((at, frame_bits(byte, 7, "even")))
        at += 10 * width
    at += 20 * width
    bits.append((at, [*frame_bits(0x55, 7, "even")[:-1], 0]))
    at += 14 * width
    bits.append((at, [0] * 14))
    return sr_bytes(["RX"], "200 kHz", uart_wave(bits, width, int(at + 30 * width)))


def glitch_4f() -> bytes:
    """One byte at 115200 8n1, sampled at 2 MHz, with one inverted sample in the middle of its fifth data bit."""
    width = Fraction(2 * 10**6, 115200)
    line = bytearray(uart_wave([(Fraction(60), frame_bits(0x4F))], width, 400))
    line[60 + int(Fraction(11, 2) * width)] ^= 1
    return sr_bytes(["RX"], "2 MHz", bytes(line))


def read_registers(wave: I2cWave, address: int, pointer: int, values: Sequence[int]) -> None:
    """Add a write of the pointer, a repeated START and a read whose last byte the controller does not acknowledge."""
    *others, last = (f"{value:02X}" for value in values)
    sent = " ".join([*(f"{value}+" for value in others), f"{last}-"])
    wave.play(f"S {address << 1:02X}+ {pointer:02X}+ Sr {address << 1 | 1:02X}+ {sent} P")


TRACES = {
    "imu_round.sr": imu_round,
    "nack.sr": nack,
    "host_frames.sr": host_frames,
    "uart_7e1_break.sr": seven_even,
    "uart_glitch_4f.sr": glitch_4f,
}

if __name__ == "__main__":
    for name, make in TRACES.items():
        (FOLDER / name).write_bytes(make())
