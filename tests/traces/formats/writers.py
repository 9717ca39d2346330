"""Waves and capture files for tests. Equal samples give equal bytes on every machine."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Self

from periph_sim.traces.capture.capture import Capture
from tests.traces.decode.drawing import of_bytes


def zip_bytes(members: Mapping[str, bytes], compression: int = zipfile.ZIP_STORED) -> bytes:
    """A zip without date and host, so that equal members give equal bytes if stored (deflate differs by version)."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, content in members.items():
            info = zipfile.ZipInfo(name)
            info.create_system = 3
            info.compress_type = compression
            archive.writestr(info, content)
    return buffer.getvalue()


def metadata(names: Sequence[str], rate: str, unitsize: int = 1) -> bytes:
    probes = [f"probe{number}={name}" for number, name in enumerate(names, 1)]
    lines = [
        "[global]",
        "sigrok version=0.5.2",
        "",
        "[device 1]",
        "capturefile=logic-1",
        f"total probes={len(names)}",
        f"samplerate={rate}",
        "total analog=0",
        *probes,
        f"unitsize={unitsize}",
    ]
    return "\n".join([*lines, ""]).encode()


def sr_bytes(
    names: Sequence[str], rate: str, *chunks: bytes, unitsize: int = 1, compression: int = zipfile.ZIP_STORED
) -> bytes:
    """A version 2 session: probe k of `names` is bit k of each little-endian sample."""
    members = {"version": b"2", "metadata": metadata(names, rate, unitsize)}
    members |= {f"logic-1-{number}": chunk for number, chunk in enumerate(chunks, 1)}
    return zip_bytes(members, compression)


def sr_file(path: Path, names: Sequence[str], rate: str, samples: bytes) -> str:
    """Write a version 2 session; return its path."""
    path.write_bytes(sr_bytes(names, rate, samples))
    return str(path)


def dsl_bytes(channels: Mapping[str, Sequence[int]], rate: str, block: int = 4, version: int = 3, **keys: str) -> bytes:
    """A DSView session with these levels, in blocks of `block` bytes. keys: changed keys of the header."""
    length = len(next(iter(channels.values())))
    blocks = ceil(length / (8 * block))
    stated = {
        "driver": "virtual-session",
        "device mode": "0",
        "capturefile": "data",
        "total samples": str(length),
        "total probes": str(len(channels)),
        "total blocks": str(blocks),
        "samplerate": rate,
    }
    stated |= {f"probe{number}": name for number, name in enumerate(channels)}
    stated |= {key.replace("_", " "): value for key, value in keys.items()}
    lines = ["[version]", f"version = {version}", "[header]", *(f"{key} = {value}" for key, value in stated.items())]
    members = {"header": "\n".join([*lines, ""]).encode(), "decoders": b"[]", "session": b"{}"}
    for number, levels in enumerate(channels.values()):
        packed = sum(level << place for place, level in enumerate(levels)).to_bytes(block * blocks, "little")
        members |= {f"L-{number}/{n}": packed[n * block : (n + 1) * block] for n in range(blocks)}
    return zip_bytes(members)


class I2cWave:
    """Generates samples of SCL (bit 0) and SDA (bit 1) as controller and targets would drive them.

    SCL is low and high for `half` samples each; SDA changes `hold` samples after SCL has fallen.
    Both lines are high for the first `idle` samples.
    """

    def __init__(self, half: int = 20, hold: int = 4, idle: int = 0) -> None:
        self.half = half
        self.hold = hold
        self.samples = bytearray()
        self._sda = 1
        self.idle(idle)

    def idle(self, samples: int) -> None:
        self._put(1, 1, samples)

    def start(self) -> None:
        """Add a START: SDA falls half a period before SCL."""
        self._put(1, 0, self.half)

    def again(self) -> None:
        """Add a repeated START: one more SCL pulse, in whose middle SDA falls."""
        self._low(1)
        self._put(1, 1, self.half)
        self._put(1, 0, self.half)

    def stop(self) -> None:
        self._low(0)
        self._put(1, 0, self.half)
        self._put(1, 1, self.half)

    def bit(self, value: int) -> None:
        self._low(value)
        self._put(1, value, self.half)

    def byte(self, value: int, ack: bool = True) -> None:
        for place in range(7, -1, -1):
            self.bit(value >> place & 1)
        self.bit(0 if ack else 1)

    def transfer(self, *values: int, nack_last: bool = False) -> None:
        """Add a START, the bytes with their acknowledges, and a STOP."""
        self.start()
        for place, value in enumerate(values, 1):
            self.byte(value, ack=not nack_last or place < len(values))
        self.stop()

    def play(self, traffic: str) -> Self:
        """Add traffic that is given in words, and return the wave: `S A0+ 12- P .400 S 101:`

        S, Sr, P    START, repeated START, STOP
        A0+, A0-    a byte with ACK, or with NACK
        101:        three bits
        .400        both lines are high for 400 samples
        ~400        SCL is low for 400 samples
        """
        conditions = {"S": self.start, "Sr": self.again, "P": self.stop}
        for word in traffic.split():
            if word in conditions:
                conditions[word]()
            elif word[0] == ".":
                self.idle(int(word[1:]))
            elif word[0] == "~":
                self._put(0, self._sda, int(word[1:]))
            elif word[-1] == ":":
                for bit in word[:-1]:
                    self.bit(int(bit))
            else:
                self.byte(int(word[:-1], 16), ack=word[-1] == "+")
        return self

    def capture(self, rate: int = 1_000_000) -> Capture:
        return of_bytes(bytes(self.samples), ("SCL", "SDA"), rate)

    def saved(self, folder: Path) -> str:
        """Write the samples at 4 MHz as a .sr file; return its path."""
        return sr_file(folder / "wave.sr", ["SCL", "SDA"], "4 MHz", bytes(self.samples))

    def _low(self, value: int) -> None:
        self._put(0, self._sda, self.hold)
        self._put(0, value, self.half - self.hold)

    def _put(self, scl: int, sda: int, samples: int) -> None:
        self.samples += bytes([scl | sda << 1]) * samples
        self._sda = sda


def uart_wave(frames: Iterable[tuple[Fraction, Sequence[int]]], width: Fraction, length: int) -> bytes:
    """Samples of a line that idles high. A frame is its begin and the levels of its bits, each `width` samples long."""
    line = bytearray([1]) * length
    for begin, bits in frames:
        for number, bit in enumerate(bits):
            first, last = ceil(begin + number * width), ceil(begin + (number + 1) * width)
            line[first:last] = bytes([bit]) * (last - first)
    return bytes(line[:length])


def frame_bits(value: int, bits: int = 8, parity: str = "none", stop: int = 1) -> list[int]:
    """The levels of a frame: start bit, data from the least significant bit, parity, stop bits."""
    data = [value >> place & 1 for place in range(bits)]
    ones = sum(data)
    checks = {"none": [], "even": [ones & 1], "odd": [1 - (ones & 1)], "mark": [1], "space": [0]}
    return [0, *data, *checks[parity], *[1] * stop]
