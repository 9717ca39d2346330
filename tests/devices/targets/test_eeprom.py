"""EEPROMs 24C02 to 24LC512: pages, write times, addresses, contents. The figures are from the data sheets."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.devices.targets.eeprom import image, part_of
from tests.devices.targets.bus_of import Bus

MS = 10**6  # ticks

# (model, bytes, page, bytes of the word address, addresses), from page 1 of the Microchip and Atmel data sheets
SHEETS = [
    ("24c02", 256, 8, 1, "50"),
    ("24c04", 512, 16, 1, "50 51"),
    ("24c08", 1024, 16, 1, "50 51 52 53"),
    ("24c16", 2048, 16, 1, "50 51 52 53 54 55 56 57"),
    ("24lc02", 256, 8, 1, "50 51 52 53 54 55 56 57"),  # A0 to A2 are not connected
    ("24lc32", 4096, 32, 2, "50"),
    ("24lc64", 8192, 32, 2, "50"),
    ("24lc128", 16384, 64, 2, "50"),
    ("24lc256", 32768, 64, 2, "50"),
    ("24lc512", 65536, 128, 2, "50"),
]


def eeprom(model: str = "24lc64", **more: object) -> Bus:
    return Bus(eeprom={"model": model, **more})


@pytest.mark.parametrize(("model", "size", "page", "word", "addresses"), SHEETS)
def test_sizes_pages_and_addresses_are_those_of_the_data_sheets(
    model: str, size: int, page: int, word: int, addresses: str
):
    assert part_of(model)[:3] == (size, page, word)
    bus = eeprom(model, contents=list(range(16)))
    start = "00 " * word
    assert " ".join(f"{a:02x}" for a in range(0x48, 0x60) if bus.do(f"{a:02x} W") == f"{a:02x}") == addresses
    last = addresses.split()[-1] if model.startswith("24c") else "50"
    word_address = (size - 1).to_bytes(3, "big")[-word:].hex(" ")
    assert bus.do(f"{last} W {word_address} Sr {last} R 3").split()[-3:] == ["ff", "00", "01"]  # rolls over to 0
    bus.do(f"50 W {start}" + "ee " * page + "dd")  # one byte more than a page
    bus.wait(5 * MS)
    read = bus.do(f"50 W {start}Sr 50 R {page + 1}").split()[-page - 1 :]
    assert read == ["dd", *["ee"] * (page - 1), read[-1]] and read[-1] in ("ff", f"{page:02x}")


def test_a_page_write_wraps_within_its_page():
    bus = eeprom()
    bus.do("50 W 00 fe 11 22 33 44")
    assert bus.notes("eeprom") == ["the write at 0x00fe went beyond its page's end, 0x00ff, on to 0x00e0"]
    bus.wait(5 * MS)
    assert bus.do("50 W 00 fe Sr 50 R 4") == "50 00 fe Sr 50 11 22 ff ff"
    assert bus.do("50 W 00 e0 Sr 50 R 3") == "50 00 e0 Sr 50 33 44 ff"


def test_a_page_can_be_a_single_byte():
    bus = eeprom(page=1)
    bus.do("50 W 00 07 11 22")
    assert bus.notes("eeprom") == ["the write at 0x0007 went beyond its page's end, 0x0007, on to 0x0007"]
    bus.wait(5 * MS)
    assert bus.do("50 W 00 07 Sr 50 R 2") == "50 00 07 Sr 50 22 ff"


def test_a_write_of_a_full_page_does_not_change_other_pages():
    bus = eeprom("24c02")
    bus.do("50 W 08 01 02 03 04 05 06 07 08")
    assert bus.notes("eeprom") == []


@pytest.mark.parametrize(("given", "longest"), [({}, 5.0), ({"write_time": "3.3 ms"}, 3.3)])
def test_it_is_busy_for_its_write_time_after_the_stop(given: dict[str, str], longest: float):
    bus = eeprom(**given)
    bus.do("50 W 00 00 55")
    stop = bus.kernel.now
    while bus.do("50 W") == "50!":
        pass
    asked = bus.last.phases[0].start_at
    assert longest * MS - 60_000 < asked - stop < longest * MS + 60_000  # a poll takes 30 us
    assert bus.do("50 W 00 00 Sr 50 R 1").endswith("55")


def test_a_range_of_write_times_is_drawn_by_the_seed():
    def polls() -> list[int]:
        bus = eeprom(write_time="200 us to 900 us")
        counts = []
        for _ in range(4):
            bus.do("50 W 00 00 55")
            counts.append(1)
            while bus.do("50 W") == "50!":
                counts[-1] += 1
        return counts

    assert polls() == polls() and len(set(polls())) > 1


def test_a_pointer_alone_writes_nothing_and_does_not_make_it_busy():
    bus = eeprom(contents="0a 0b")
    assert bus.do("50 W 00 01") == "50 00 01"
    assert bus.do("50 R 1") == "50 0b"
    assert bus.do("50 R 1") == "50 ff"  # continues where the last read ended


def test_a_write_that_ends_with_a_start_is_not_stored():
    bus = eeprom()
    assert bus.do("50 W 00 00 55 Sr 50 R 1") == "50 00 00 55 Sr 50 ff"
    bus.do("50 W 00 00 Sr 50 R 1")
    assert bus.notes("eeprom") == ["the write at 0x0000 is not stored: a START instead of a STOP ended it"]
    assert bus.scene.devices["eeprom"].target.memory[0] == 0xFF


def test_a_write_that_ends_in_the_middle_of_a_byte_is_not_stored():
    cut = {"kind": "condition", "condition": "STOP", "at": "100 us", "late": "500 ns"}  # in the second byte of data
    bus = Bus(faults=(cut,), eeprom={"model": "24lc64"})
    bus.do("50 W 00 00 ff ff")
    assert bus.notes("eeprom") == ["the write at 0x0000 is not stored: a STOP in the middle of a byte ended it"]
    assert bus.do("50 W") == "50"  # nothing is written, so it is not busy


def test_block_bits_of_the_device_address_are_the_upper_bits_of_the_word_address():
    bus = eeprom("24c16")
    bus.do("53 W 10 77")
    bus.wait(5 * MS)
    assert bus.scene.devices["eeprom"].target.memory[0x310] == 0x77
    assert bus.do("50 W 10 Sr 53 R 1") == "50 10 Sr 53 77"  # the block bits of the read apply


def test_a_write_protected_memory_acknowledges_and_stores_nothing():
    bus = eeprom(write_protect=True)
    assert bus.do("50 W 00 00 55") == "50 00 00 55"
    assert bus.do("50 W 00 00 Sr 50 R 1") == "50 00 00 Sr 50 ff"  # at once: there is no write cycle
    assert bus.notes("eeprom") == ["the write at 0x0000 is not stored: the memory is write-protected"]


INTEL_HEX = ":0400100001020304E2\n:020000040000FA\n:01FFFE0009F9\n:00000001FF\n"


def test_contents_can_fill_a_memory_to_its_last_byte():
    bus = eeprom("24c02", contents=[*range(0x100)])
    assert bus.do("50 W fe Sr 50 R 3") == "50 fe Sr 50 fe ff 00"


def test_contents_are_read_from_files_beside_the_case(tmp_path: Path):
    (tmp_path / "a.bin").write_bytes(b"\x01\x02")
    (tmp_path / "b.hex").write_text(INTEL_HEX)
    bus = Bus(
        tmp_path,
        a={"model": "24lc64", "contents": "a.bin"},
        b={"model": "24lc512", "address": 0x51, "contents": "b.hex"},
    )
    assert bus.do("50 W 00 00 Sr 50 R 3").endswith("01 02 ff")
    assert bus.do("51 W 00 10 Sr 51 R 5").endswith("01 02 03 04 ff")
    assert bus.do("51 W ff fe Sr 51 R 2").endswith("09 ff")


def record(kind: int, address: int, *data: int) -> str:
    """Return a line of Intel HEX."""
    raw = bytes([len(data), *address.to_bytes(2, "big"), kind, *data])
    return f":{raw.hex()}{-sum(raw) & 0xFF:02X}"


END = record(1, 0)


@pytest.mark.parametrize(
    ("records", "memory"),
    [
        (["", record(0, 2, 0x11, 0x22), "", END], b"\xff\xff\x11\x22"),
        ([record(0, 2, 0x11), record(0, 0, 0x33, 0x44, 0x55), END], b"\x33\x44\x55"),  # the later record applies
        ([record(5, 0, 0, 0, 1, 0), record(3, 0, 0, 1, 0, 0), record(0, 0, 0x11), END], b"\x11"),  # start addresses
        ([record(4, 0, 0, 1), record(0, 1, 0x11), END], bytes([0xFF]) * 0x10001 + b"\x11"),
        ([record(2, 0, 0, 1), record(0, 1, 0x11), END, "anything"], bytes([0xFF]) * 0x11 + b"\x11"),
        ([record(4, 0, 0, 0xFF), record(0, 0xFFFF, 0x11), END], bytes([0xFF]) * 0xFFFFFF + b"\x11"),
    ],
)
def test_records_of_intel_hex(records: list[str], memory: bytes, tmp_path: Path):
    (tmp_path / "a.hex").write_text("\n".join(records))
    assert image(tmp_path / "a.hex") == memory


@pytest.mark.parametrize(
    ("records", "sentence"),
    [
        ([record(4, 0, 0, 0xFF), record(0, 0xFFFF, 0x11, 0x22), END], "line 2: address 0xffffff is beyond any serial"),
        ([END[1:]], "line 1: '00000001FF' is no record of Intel HEX such as :02000000ABCD86"),
        ([":0000"], "line 1: ':0000' is no record"),
        ([":00000001"], "line 1: ':00000001' is no record"),
        ([":01000001FE"], "line 1: ':01000001FE' is no record"),
        (["", END[:-1] + "E"], "line 2: its checksum is 0xfe, but 0xff was expected"),
    ],
)
def test_invalid_records_are_rejected_with_their_line(records: list[str], sentence: str, tmp_path: Path):
    (tmp_path / "a.hex").write_text("\n".join(records))
    with pytest.raises(ValueError, match=f"a.hex, {sentence}"):
        image(tmp_path / "a.hex")
