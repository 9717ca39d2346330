"""The contents of a memory from a file, as bytes from address 0 on: .bin as it is, .hex in Intel's format."""

from __future__ import annotations

from pathlib import Path

from ...core.input_files import read_input

IMAGES = (".bin", ".hex")
ERASED = 0xFF
MOST = 1 << 24  # beyond all serial memories
DATA, END, SEGMENT, LINEAR = 0, 1, 2, 4  # kinds of records; those of start addresses are irrelevant


def image(path: Path) -> bytes:
    """Read the file; gaps are 0xFF. ValueError, one sentence with the file and its line."""
    try:
        data = read_input(path)
    except OSError as error:
        raise ValueError(
            f"{path} cannot be read ({error.strerror}); its path is relative to the folder of the case"
        ) from None
    return data if path.suffix == ".bin" else _intel_hex(path, data.decode("ascii", "replace"))


def _intel_hex(path: Path, text: str) -> bytes:
    memory = bytearray()
    base = 0
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        kind, address, data = _record(f"{path}, line {number}", line.strip())
        if kind == END:
            return bytes(memory)
        if kind == DATA:
            begin = base + address
            if begin + len(data) > MOST:
                raise ValueError(f"{path}, line {number}: address {begin:#x} is beyond any serial memory")
            memory.extend([ERASED] * (begin + len(data) - len(memory)))
            memory[begin : begin + len(data)] = data
        elif kind in (SEGMENT, LINEAR) and len(data) == 2:
            base = int.from_bytes(data, "big") << (4 if kind == SEGMENT else 16)
    raise ValueError(f"{path}: it has no end record, :00000001FF; it is truncated, or not Intel HEX")


def _record(where: str, line: str) -> tuple[int, int, bytes]:
    """Parse a line ":LLAAAATT data CC" to (kind, address, data)."""
    try:
        raw = bytes.fromhex(line.removeprefix(":"))
    except ValueError:
        raw = b""
    if not line.startswith(":") or len(raw) < 5 or len(raw) != raw[0] + 5:
        raise ValueError(f"{where}: {line[:40]!r} is no record of Intel HEX such as :02000000ABCD86")
    if sum(raw) & 0xFF:
        raise ValueError(f"{where}: its checksum is {raw[-1]:#04x}, but {-sum(raw[:-1]) & 0xFF:#04x} was expected")
    return raw[3], int.from_bytes(raw[1:3], "big"), raw[4:-1]
