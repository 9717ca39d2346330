"""A device described by its register map: pointer, widths, kinds of bits, updates, the interrupt pin."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from periph_sim.core.wire import Wire
from periph_sim.devices.targets.registers import RegisterDevice
from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.scene import Scene
from tests.devices.targets.bus_of import Bus

MS = 10**6  # ticks


def device(*register: dict[str, Any], folder: Path | None = None, **more: object) -> Bus:
    return Bus(folder, it={"model": "registers", "address": 0x48, "register": list(register), **more})


BYTES = [{"name": f"R{at}", "at": at, "reset": 0x10 + at} for at in range(3)]
WORDS = [{"name": "A", "at": 0, "width": 16, "reset": 0x1122}, {"name": "B", "at": 2, "width": 16, "reset": 0x3344}]
GAP = [BYTES[0], {"name": "R3", "at": 3, "reset": 0x13}]
COUNTED = [{**WORDS[0], "at": 0}, {**WORDS[1], "at": 1}]


@pytest.mark.parametrize(
    ("registers", "more", "read"),
    [
        (BYTES, {}, "10 11 12 00 00"),  # the last two bytes are beyond the map
        (BYTES, {"unmapped": 0xFF}, "10 11 12 ff ff"),
        (BYTES, {"wrap": "map"}, "10 11 12 10 11"),
        (BYTES, {"auto_increment": False}, "10 10 10 10 10"),
        (GAP, {}, "10 00 00 13 00"),
        (WORDS, {}, "11 22 33 44 00"),
        (WORDS, {"byte_order": "little"}, "22 11 44 33 00"),
        (COUNTED, {"pointer_counts": "registers"}, "11 22 33 44 00"),
        (COUNTED, {"pointer_counts": "registers", "auto_increment": False}, "11 22 11 22 11"),
        (COUNTED, {"pointer_counts": "registers", "wrap": "map"}, "11 22 33 44 11"),
    ],
)
def test_a_read_of_five_bytes_from_the_first_register(registers: list[dict[str, Any]], more: dict[str, Any], read: str):
    assert device(*registers, **more).do("48 W 00 Sr 48 R 5") == f"48 00 Sr 48 {read}"


def test_a_write_continues_after_a_gap_of_the_map():
    bus = device(*GAP)
    bus.do("48 W 00 aa bb cc dd")
    assert bus.do("48 W 00 Sr 48 R 4") == "48 00 Sr 48 aa 00 00 dd"


def test_the_pointer_is_kept_over_a_stop_and_can_have_two_bytes():
    bus = device(
        {"name": "FAR", "at": 0x1234, "reset": 0x77}, {"name": "NEXT", "at": 0x1235, "reset": 0x78}, pointer_bytes=2
    )
    assert bus.do("48 W 12 34") == "48 12 34"
    assert bus.do("48 R 1") == "48 77"
    assert bus.do("48 R 1") == "48 78"


@pytest.mark.parametrize(("size", "last"), [(1, 0xFF), (2, 0xFFFF)])
def test_a_register_beyond_the_range_of_the_pointer_is_rejected(size: int, last: int):
    word = {"name": "WORD", "width": 16}
    device({**word, "at": last - 1}, pointer_bytes=size)
    with pytest.raises(BadCase, match=rf"WORD reaches {last + 1:#x}, beyond {last:#x}, the last that a pointer of"):
        device({**word, "at": last}, pointer_bytes=size)


def test_the_pointer_wraps_from_its_last_value_to_0():
    bus = device({"name": "LAST", "at": 0xFF, "reset": 1}, {"name": "FIRST", "at": 0, "reset": 2})
    assert bus.do("48 W ff Sr 48 R 2") == "48 ff Sr 48 01 02"


def test_read_only_bits_are_kept_and_writing_1_clears_others():
    bus = device({"name": "MIXED", "at": 0, "reset": 0xF3, "read_only": 0xC0, "write_1_clears": 0x03})
    bus.do("48 W 00 01")  # bits 7:6 are kept, 5:4 become 0, and of 1:0 the one written with 1 is cleared
    assert bus.do("48 W 00 Sr 48 R 1").endswith("c2")
    bus.do("48 W 00 30")
    assert bus.do("48 W 00 Sr 48 R 1").endswith("f2")


def test_a_write_to_a_read_only_register_is_noted():
    bus = device({"name": "ID", "at": 0, "reset": 0x42, "read_only": True})
    assert bus.do("48 W 00 55 66") == "48 00 55 66"
    assert bus.do("48 W 00 Sr 48 R 1").endswith("42")
    assert bus.notes("it") == [
        "0x55 was written to ID, which is read-only",
        "0x66 was written to register 0x01, which is not in the map",
    ]


def test_bits_with_read_clears_are_read_as_1_once():
    bus = device({"name": "STATUS", "at": 0, "reset": 0x81, "read_clears": 0x01})
    assert bus.do("48 W 00 Sr 48 R 1").endswith("81")
    assert bus.do("48 W 00 Sr 48 R 1").endswith("80")


def test_a_register_of_16_bits_changes_with_its_last_byte():
    bus = device(*WORDS)
    bus.do("48 W 00 aa")  # its first byte only
    assert bus.do("48 W 00 Sr 48 R 2").endswith("11 22")
    bus.do("48 W 00 aa bb")
    assert bus.do("48 W 00 Sr 48 R 2").endswith("aa bb")
    bus.do("48 W 01 cc")
    assert bus.do("48 W 00 Sr 48 R 2").endswith("aa cc")


def test_a_value_that_changes_between_its_bytes_is_read_consistently():
    bus = device({"name": "COUNT", "at": 0, "width": 16, "every": "1 us", "values": [0x0100, 0x02FF] * 500})
    reads = [bus.do("48 W 00 Sr 48 R 2")[-5:] for _ in range(4)]
    assert set(reads) <= {"01 00", "02 ff"}


@pytest.mark.parametrize(("width", "counts"), [(8, "bytes"), (16, "registers")])
def test_without_auto_increment_each_read_returns_the_new_value(width: int, counts: str):
    register = {"name": "COUNT", "at": 0, "width": width, "every": "1 us", "step": 1}
    read = device(register, auto_increment=False, pointer_counts=counts).do("48 W 00 Sr 48 R 6")
    data = bytes.fromhex(read.partition(" Sr 48 ")[2])
    words = [data[place : place + width // 8] for place in range(0, 6, width // 8)]
    assert len(set(words)) == len(words)


@pytest.mark.parametrize("width", [8, 16])
@pytest.mark.parametrize("key", ["reset", "read_only", "write_1_clears", "read_clears", "values", "updates"])
def test_numbers_with_more_bits_than_their_register_are_rejected(width: int, key: str):
    def given(value: int) -> dict[str, Any]:
        more = {"values": {"every": "1 ms", "values": [value]}, "updates": {"updates": [["1 ms", value]]}}
        return {"name": "R", "at": 0, "width": width, **more.get(key, {key: value})}

    full = (1 << width) - 1
    device(given(full))
    with pytest.raises(BadCase, match=f"{full:#x}" if width == 8 else "expected 0 to 65535"):
        device(given(full + 1))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"every": "1 ms"}, "R: 'every' needs 'values' or 'step'"),
        ({"values": [1]}, "R: 'every' needs 'values' or 'step'"),
        ({"step": 1}, "R: 'every' needs 'values' or 'step'"),
        ({"every": "1 ms", "values": [1], "step": 1}, "R has more than one of 'updates', 'values' and"),
        ({"every": "1 ms", "step": 1, "updates": [["1 ms", 1]]}, "R has more than one of 'updates', 'values' and"),
        ({"first": "1 ms"}, "R: 'first' needs 'every'; give 'every', or remove 'first'"),
        ({"every": "0 s", "step": 1}, "R: 'every' must be longer than 0"),
        ({"read_only": 3, "write_1_clears": 2}, "bits of R are both read_only and write_1_clears"),
        ({"read_only": 2, "write_1_clears": 1}, ""),
        ({"every": "1 ms", "step": 1, "first": "0 s"}, ""),
    ],
)
def test_keys_that_contradict_each_other_are_rejected(given: dict[str, Any], said: str):
    if not said:
        device({"name": "R", "at": 0, **given})
        return
    with pytest.raises(BadCase, match=re.escape(said)):
        device({"name": "R", "at": 0, **given})


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("0xff", ""),
        ("0", ""),
        ("0x100", "steps.csv, line 2: 0x100 does not fit the 8 bits of R"),
        ("-1", "steps.csv, line 2: -0x1 does not fit the 8 bits of R"),
        ("x", "steps.csv, line 2: '1 ms,x' is no time and value; write them as 5 ms,0x12"),
    ],
)
def test_values_in_a_file_that_do_not_fit_their_register_are_rejected(value: str, said: str, tmp_path: Path):
    (tmp_path / "steps.csv").write_text(f"at,value\n1 ms,{value}\n")
    if not said:
        bus = device({"name": "R", "at": 0, "updates": "steps.csv"}, folder=tmp_path)
        bus.wait(2 * MS)
        assert bus.do("48 W 00 Sr 48 R 1")[-2:] == f"{int(value, 0):02x}"
        return
    with pytest.raises(BadCase, match=re.escape(said)):
        device({"name": "R", "at": 0, "updates": "steps.csv"}, folder=tmp_path)


@pytest.mark.parametrize(
    ("changes", "values"),
    [
        ({"updates": [["1 ms", 5], ["3 ms", 7]]}, "00 05 05 07 07"),
        ({"updates": "steps.csv"}, "00 05 05 07 07"),
        ({"updates": [["0 s", 9]]}, "09 09 09 09 09"),
        ({"every": "2 ms", "values": [1, 2]}, "00 00 01 01 02"),
        ({"every": "2 ms", "first": "0 s", "values": [1, 2]}, "01 01 02 02 02"),
        ({"every": "1 ms", "step": 1}, "00 01 02 03 04"),
        ({"every": "1 ms", "step": -1, "reset": 2}, "02 01 00 ff fe"),
    ],
)
def test_values_at_each_millisecond_follow_the_updates(changes: dict[str, Any], values: str, tmp_path: Path):
    (tmp_path / "steps.csv").write_text("time,value\n1 ms,0x05\n3 ms,7\n")
    bus = device({"name": "R", "at": 0, **changes}, folder=tmp_path)
    read = []
    for millisecond in range(5):
        bus.wait(millisecond * MS + MS // 2 - bus.kernel.now)
        read.append(bus.do("48 W 00 Sr 48 R 1")[-2:])
    assert " ".join(read) == values


DATA = {"name": "DATA", "at": 1, "every": "1 ms", "step": 1, "sets": {"register": "STATUS", "bits": 0x01}}
STATUS = {"name": "STATUS", "at": 0, "read_clears": 0x01}


@pytest.mark.parametrize("active", ["low", "high"])
def test_the_interrupt_pin_follows_its_bits(active: str):

    unit = {"firmware": "responder", "modules": ["I2C-A", "GPIO"], "pins": {"DRDY": 12}}
    it = {"model": "registers", "address": 0x48, "register": [STATUS, DATA]}
    it["interrupt"] = {"wire": "DRDY", "register": "STATUS", "bits": 1, "active": active}
    scene = Scene(Case.model_validate({"name": "x", "duration": "3 ms", "unit": {"dsp": unit}, "device": {"it": it}}))
    wire: Wire = scene.wires["DRDY"]
    per_ms = scene.timebase.per_second // 1000
    before = wire.level
    scene.kernel.run_until(per_ms - 1)
    idle = wire.level
    scene.kernel.run_until(per_ms)
    assert (idle, wire.level) == ((1, 0) if active == "low" else (0, 1)) and before == 1
    target = scene.devices["it"].target
    reply = target.answer(0x48 << 1 | 1)
    assert reply is not None and reply.send_byte(0) == 1
    scene.kernel.run_until(per_ms + 1)
    assert wire.level == idle  # STATUS was read
    scene.kernel.run_until(2 * per_ms)
    assert wire.level != idle  # the next value


@pytest.mark.parametrize("active", ["low", "high"])
@pytest.mark.parametrize(("bits", "expected"), [(1, "01000001"), (2, "11000011")])  # updates set 1, the reset sets 2
def test_without_power_the_interrupt_pin_is_idle_and_updates_are_skipped(bits: int, expected: str, active: str):
    unit = {"firmware": "responder", "modules": ["I2C-A", "GPIO"], "pins": {"DRDY": 12}}
    fault = {"kind": "off", "after": "1500 us", "until": "3500 us"}
    status = {**STATUS, "reset": 0x02}
    it = {"model": "registers", "address": 0x48, "register": [status, DATA], "fault": [fault]}
    it["interrupt"] = {"wire": "DRDY", "register": "STATUS", "bits": bits, "active": active}
    scene = Scene(Case.model_validate({"name": "x", "duration": "5 ms", "unit": {"dsp": unit}, "device": {"it": it}}))
    levels = []
    for half_ms in range(1, 9):
        scene.kernel.run_until(half_ms * scene.timebase.per_second // 2000)
        levels.append(scene.wires["DRDY"].level)
    # an update every 1 ms; no power from 1.5 to 3.5 ms
    assert levels == [int(pending == (active == "high")) for pending in map(int, expected)]
    target = scene.devices["it"].target
    assert isinstance(target, RegisterDevice) and target.values["DATA"] == 1


def test_data_ready_is_set_by_each_update_and_cleared_by_its_read():
    bus = device(STATUS, DATA)
    read = []
    for wait in (500_000, 1_000_000, 10_000):
        bus.wait(wait)
        read.append(bus.do("48 W 00 Sr 48 R 1")[-2:])
    assert read == ["00", "01", "00"]
