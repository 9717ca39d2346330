"""Serial EEPROMs 24C02 to 24LC512, with page writes and NACKs while they write.

    START, address+W, word address (1 or 2 bytes), data ... STOP --> the page's buffer is stored: busy for write_time
                                                                      |  page 0x20 to 0x3f  |
                                                  data at 0x3e, 0x3f, 0x20, 0x21: never beyond the page
    START, address+R, data ...                 --> from the address pointer on, which wraps from the memory's end to 0

The address pointer is the word address that was last written. It advances with each data byte. While the memory is
busy, it does not acknowledge its address, so a master can poll for the acknowledge. 24C04, 24C08 and 24C16 use the
device address for the upper bits of the word address. A write without a STOP, or a write that ends in the middle of a
byte, is not stored.

Source: Microchip DS20001709 (24LC02B), DS21708 (24LC04B), DS21710 (24LC08B), DS20002213 (24LC16B), DS21072 (24LC32A),
DS20001189 (24LC64), DS20001191 (24LC128), DS20001203 (24LC256), DS20001754 (24LC512); Atmel doc0180 (AT24C02 to 16).
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NamedTuple

from msgspec import Meta

from ...core.convert import After, Before
from ...core.input_files import read_input
from ...core.registers import NamedByte
from ...core.state import State
from ...core.table import DurationRange, Spread, Table, duration, hex_bytes
from . import BadDevice, PlainReply, TargetContext, address_among

FIRST = 0x50  # lowest device address: binary 1010, then three bits for the pins A2 to A0 or the block
SHEETS = "24Cxx data sheets, write operations"
ERASED = 0xFF


class Part(NamedTuple):
    """The geometry of a memory.

    size: number of bytes.
    page: number of bytes of a page.
    word: number of bytes of the word address.
    blocks: number of device addresses; if there are several, each addresses a block of 256 bytes.
    """

    size: int
    page: int
    word: int
    blocks: int


PARTS = {
    "02": Part(256, 8, 1, 1),
    "04": Part(512, 16, 1, 2),
    "08": Part(1024, 16, 1, 4),
    "16": Part(2048, 16, 1, 8),
    "32": Part(4096, 32, 2, 1),
    "64": Part(8192, 32, 2, 1),
    "128": Part(16384, 64, 2, 1),
    "256": Part(32768, 64, 2, 1),
    "512": Part(65536, 128, 2, 1),
}
MAKES = ("24c", "24lc", "24aa")
# Prefixes of the families whose memories of up to 16 Kbit ignore the pins A0 to A2, and so respond to all 8 addresses.
WITHOUT_PINS = ("24lc", "24aa")
MODELS = tuple(f"{make}{size}" for size in PARTS for make in MAKES)


def part_of(model: str) -> Part:
    """Return the geometry of a model in MODELS."""
    return PARTS[_split(model)[1]]


def blocks_of(model: str) -> int:
    """Return the number of device addresses to which a model in MODELS responds."""
    make, size = _split(model)
    part = PARTS[size]
    return 8 if part.word == 1 and make in WITHOUT_PINS else part.blocks


def _split(model: str) -> tuple[str, str]:
    """Split a model's name into its prefix in MAKES and its key in PARTS: "24lc64" into "24lc" and "64"."""
    make = next(make for make in MAKES if model.startswith(make) and model.removeprefix(make) in PARTS)
    return make, model.removeprefix(make)


def _power_of_two(value: int) -> int:
    if value & value - 1:
        raise ValueError("a page is a power of two")
    return value


def _contents(value: object) -> object:
    if isinstance(value, str) and Path(value).suffix in IMAGES:
        return Path(value)
    try:
        return hex_bytes(value)
    except ValueError as error:
        raise ValueError(f"{error}, or name a file: {', '.join(IMAGES)}") from None


class Settings(Table, frozen=True, kw_only=True):
    """An EEPROM: `24c`, `24lc` or `24aa`, then 02, 04, 08, 16, 32, 64, 128, 256 or 512.

    contents: bytes from address 0, or a `.bin` or Intel `.hex` file; the rest is 0xFF
    page: page size in bytes; if omitted, 8 (02), 16 (04 to 16), 32 (32, 64), 64 (128, 256), 128 (512)
    write_time: duration or range of a write
    write_protect: `true`, or a wire of `pins` that protects while high
    """

    contents: Annotated[bytes | Path, Before(_contents, str | list[int])] = b""
    page: Annotated[int, Meta(ge=1, le=256), After(_power_of_two)] | None = None
    write_time: DurationRange = Spread(duration("5 ms"), duration("5 ms"))
    write_protect: bool | str = False


class Eeprom(PlainReply):
    """A serial memory on the bus. `answer` returns this object itself as the reply. memory: the stored bytes."""

    STATE = State("memory _place _pointer _begin _buffer _written", ticks="_busy_until")

    def __init__(self, part: Part, addresses: tuple[int, ...], settings: Settings, place: TargetContext) -> None:
        self.addresses = addresses
        self.pointer_bytes = part.word
        self.memory = bytearray([ERASED]) * part.size
        self._part = part
        self._page = settings.page or part.page
        self._write_time = settings.write_time
        self._place = place
        self._locked = settings.write_protect is True
        name = settings.write_protect
        self._lock = place.wire(name) if isinstance(name, str) else None
        self.power_on()

    def power_on(self) -> None:
        """Handle the return of the supply. The contents are kept, and a write in progress counts as completed."""
        self._pointer = 0
        self._begin: int  # first address of the present write
        self._buffer: dict[int, int] = {}
        self._written: int  # number of data bytes received in this write, including bytes that later bytes replaced
        self._busy_until = 0

    def answer(self, address_byte: int) -> Eeprom | None:
        if address_byte >> 1 not in self.addresses or self._place.kernel.now < self._busy_until:
            return None
        if self._part.blocks > 1:
            self._pointer = (address_byte >> 1 & self._part.blocks - 1) << 8 | self._pointer & 0xFF
        return self

    def named(self, value: int, before: int | None) -> NamedByte:
        return NamedByte(f"{self._pointer:#06x}")

    def send_byte(self, byte: int) -> int:
        value = self.memory[self._pointer]
        self._pointer = (self._pointer + 1) % self._part.size
        return value

    def receive_byte(self, byte: int, value: int) -> bool:
        if byte < self._part.word:
            above = self._pointer & ~0xFF if self._part.word == 1 else self._pointer << 8
            self._pointer = (above | value) % self._part.size
            self._begin, self._written = self._pointer, 0
        else:
            self._written += 1
            self._buffer[self._pointer] = value
            page = self._pointer & -self._page
            self._pointer = page | self._pointer + 1 & self._page - 1
        return True

    def on_end(self, stop: bool, whole: bool) -> None:
        buffer, self._buffer = self._buffer, {}
        if not buffer:
            return
        if not stop or not whole:
            how = "a STOP in the middle of a byte" if stop else "a START instead of a STOP"
            self._place.duty(f"the write at {self._begin:#06x} is not stored: {how} ended it", SHEETS)
        elif self._locked or (self._lock is not None and self._lock.level):
            self._place.duty(f"the write at {self._begin:#06x} is not stored: the memory is write-protected", SHEETS)
        else:
            page = self._begin & -self._page
            if self._begin - page + self._written > self._page:
                end = page + self._page - 1
                self._place.duty(
                    f"the write at {self._begin:#06x} went beyond its page's end, {end:#06x}, on to {page:#06x}", SHEETS
                )
            for address, value in buffer.items():
                self.memory[address] = value
            place = self._place
            least, most = place.ticks(self._write_time.least), place.ticks(self._write_time.most)
            self._busy_until = place.kernel.now + place.random.randint(least, most)


def build(model: str, settings: Settings, place: TargetContext) -> Eeprom:
    part, blocks = part_of(model), blocks_of(model)
    first = address_among(place, model, tuple(range(FIRST, FIRST + 8, blocks)))
    try:
        eeprom = Eeprom(part, tuple(range(first, first + blocks)), settings, place)
    except ValueError as error:
        raise BadDevice(str(error), "write_protect") from None
    if settings.page is not None and settings.page > part.size:
        raise BadDevice(f"a page of {settings.page} bytes is longer than a {model}, which has {part.size}", "page")
    contents = settings.contents
    if isinstance(contents, Path):
        try:
            contents = image(place.folder / contents)
        except ValueError as error:
            raise BadDevice(str(error), "contents") from None
    if len(contents) > part.size:
        raise BadDevice(f"it has {len(contents)} bytes, but a {model} holds {part.size}", "contents")
    eeprom.memory[: len(contents)] = contents
    return eeprom


IMAGES = (".bin", ".hex")
MOST = 1 << 24  # all addresses in an Intel HEX file are below this; every serial memory is smaller
DATA, END, SEGMENT, LINEAR = 0, 1, 2, 4  # kinds of records in Intel HEX; records of start addresses are ignored


def image(path: Path) -> bytes:
    """Read the contents of a memory from a .bin file, or from a .hex file in Intel's format, with 0xFF in its gaps.

    Raise ValueError, whose message names the file and, for an invalid line of a .hex file, the line.
    """
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
            memory.extend([0xFF] * (begin + len(data) - len(memory)))
            memory[begin : begin + len(data)] = data
        elif kind in (SEGMENT, LINEAR) and len(data) == 2:
            base = int.from_bytes(data, "big") << (4 if kind == SEGMENT else 16)
    raise ValueError(f"{path}: it has no end record, :00000001FF; it is truncated, or not Intel HEX")


def _record(where: str, line: str) -> tuple[int, int, bytes]:
    """Parse a line ":LLAAAATT data CC" to (kind, address, data). Raise ValueError, with `where`, if it is invalid."""
    try:
        raw = bytes.fromhex(line.removeprefix(":"))
    except ValueError:
        raw = b""
    if not line.startswith(":") or len(raw) < 5 or len(raw) != raw[0] + 5:
        raise ValueError(f"{where}: {line[:40]!r} is no record of Intel HEX such as :02000000ABCD86")
    if sum(raw) & 0xFF:
        raise ValueError(f"{where}: its checksum is {raw[-1]:#04x}, but {-sum(raw[:-1]) & 0xFF:#04x} was expected")
    return raw[3], int.from_bytes(raw[1:3], "big"), raw[4:-1]
