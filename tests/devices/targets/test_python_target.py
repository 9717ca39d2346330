"""A class of the user as a device: its hooks, the services of its bus, and the messages about its mistakes."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.processor.user_code import FirmwareError
from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.case.origin import Source
from periph_sim.scene.scene import Scene
from tests.devices.targets.bus_of import Bus

US = 1_000  # ticks

ECHO = """\
class Device:
    def __init__(self, bus):
        self.bus = bus
        self.value = 0

    def on_write(self, byte):
        self.value = byte
        return byte != 0xEE

    def on_read(self):
        return self.value ^ 0xFF
"""


def device(folder: Path, text: str, **more: object) -> Bus:
    (folder / "mine.py").write_text(text, encoding="utf-8")
    return Bus(folder, mine={"model": "mine.py", "address": 0x42, **more})


def test_bytes_are_passed_to_its_hooks(tmp_path: Path):
    bus = device(tmp_path, ECHO)
    assert bus.do("42 W 0f Sr 42 R 2") == "42 0f Sr 42 f0 f0"
    assert bus.do("42 W 01 ee") == "42 01 ee!"
    assert bus.do("43 R 1") == "43!"


def test_an_access_without_a_hook_is_not_acknowledged(tmp_path: Path):
    bus = device(
        tmp_path, "class Device:\n    def __init__(self, bus): ...\n    def on_read(self):\n        return 1\n"
    )
    assert bus.do("42 W 01") == "42!"
    assert bus.do("42 R 1") == "42 01"


ALL = """\
from dataclasses import dataclass

@dataclass
class Settings:
    first: int = 7

class Device:
    def __init__(self, bus, settings):
        self.bus, self.log, self.settings = bus, [], settings

    def on_address(self, read):
        self.log.append(f"{'read' if read else 'write'} at {int(self.bus.now * 1_000_000)} us")
        return len(self.log) != 4

    def on_write(self, byte):
        self.bus.stretch("40 us")
        self.bus.after("1 ms", lambda: self.log.append("later"))

    def on_read(self):
        return self.settings.first

    def on_stop(self):
        self.bus.note(f"log: {', '.join(self.log)}")
"""


def test_its_bus_gives_the_time_stretches_calls_back_later_and_takes_notes(tmp_path: Path):
    bus = device(tmp_path, ALL, first=9, stretch={"length": "10 us", "access": "write"})  # the longer stretch applies
    assert bus.do("42 W 01 Sr 42 R 1") == "42 01 Sr 42 09"
    phase = bus.last.phases[0]
    assert phase.stretch == 40 * US - 1300  # from the fall of SCL, of which the controller holds 1.3 us itself
    bus.wait(1_200 * US)
    assert bus.do("42 W 01") == "42!"
    assert bus.do("42 R 1") == "42 09"
    assert bus.notes("mine")[0].startswith("log: write at 20 us, read at ")
    assert bus.notes("mine")[-1].split(", ")[2] == "later"


PINS = """\
class Device:
    def __init__(self, bus):
        self.pin = bus.pin("DRDY")

    def on_write(self, level):
        self.pin.drive(level)

    def on_read(self):
        return self.pin.level
"""


def test_its_pins_drive_wires_and_read_their_levels(tmp_path: Path):
    unit = {"firmware": "responder", "modules": ["I2C-A", "GPIO"], "pins": {"DRDY": 12}}
    (tmp_path / "mine.py").write_text(PINS, encoding="utf-8")
    tables = {"name": "x", "duration": "1 s", "unit": {"dsp": unit}, "device": {"mine": {"model": "mine.py"}}}
    tables["device"]["mine"]["address"] = 0x42
    scene = Scene(Case.model_validate(tables).from_source(Source(tmp_path / "case.toml", "")))
    target = scene.devices["mine"].target
    shown = []
    for level in (0, 1):
        target.receive_byte(0, level)
        scene.kernel.run_until(scene.kernel.now)
        shown.append((scene.wires["DRDY"].level, target.send_byte(0)))
    assert shown == [(0, 0), (1, 1)]
    with pytest.raises(FirmwareError, match=r"line 6 of mine\.py: drive was given 2; expected 0 or 1"):
        target.receive_byte(0, 2)


LATE = """\
class Device:
    def __init__(self, bus):
        self.bus = bus

    def on_write(self, level):
        for _ in range(100):
            pin = self.bus.pin("DRDY")
        before = pin.level
        pin.drive(level)
        self.bus.note(f"{before}, then {pin.level}")
        self.bus.after("1 us", lambda: self.bus.note(f"{self.bus.pin('DRDY').level} later"))
"""


def test_repeated_requests_return_the_same_pin_and_its_level_changes_after_the_hook(tmp_path: Path):
    unit = {"firmware": "responder", "modules": ["I2C-A", "GPIO"], "pins": {"DRDY": 12}}
    (tmp_path / "mine.py").write_text(LATE, encoding="utf-8")
    mine = {"model": "mine.py", "address": 0x42}
    tables = {"name": "x", "duration": "1 s", "unit": {"dsp": unit}, "device": {"mine": mine}}
    scene = Scene(Case.model_validate(tables).from_source(Source(tmp_path / "case.toml", "")))
    for level in (0, 1):
        scene.devices["mine"].target.receive_byte(0, level)
        scene.kernel.run_until(scene.kernel.now + scene.timebase.per_second // 100_000)
    notes = [note.text for note in scene.devices["mine"].log.notes]
    assert notes == ["1, then 1", "0 later", "0, then 0", "1 later"]


IDLE = """\
class Device:
    def __init__(self, bus):
        self.bus = bus

    def on_write(self, byte):
        self.bus.after("100 us", lambda: self.bus.stretch("50 us"))
"""


def test_a_stretch_after_the_transfer_holds_scl_and_belongs_to_no_phase(tmp_path: Path):
    bus = device(tmp_path, IDLE)
    assert bus.do("42 W 01") == "42 01"
    shown = []
    for _ in range(5):
        bus.wait(35 * US)
        shown.append(bus.scene.wires["SCL"].level)
    assert shown == [1, 1, 0, 0, 1]
    assert [phase.stretch for phase in bus.last.phases] == [0]


@pytest.mark.parametrize(
    ("text", "more", "sentence"),
    [
        ("", {}, "mine.py has no class Device"),
        (
            "class Device:\n    pass\n",
            {},
            "mine.py: class Device has neither on_write nor on_read; give it one of them at",
        ),
        (
            "class Device:\n    def on_read(self): return 1\n",
            {},
            "mine.py: Device takes (); expected __init__(self, bus)",
        ),
        (
            "class Device:\n    def __init__(self): ...\n    def on_read(self): return 1\n",
            {},
            "line 2 of mine.py: Device takes (); expected __init__(self, bus)",
        ),
        (
            "class Device:\n    def __init__(self, bus): ...\n    def on_write(self): ...\n",
            {},
            "line 3 of mine.py: on_write takes (self); expected on_write(self, byte)",
        ),
        ("class Device\n", {}, "mine.py cannot be loaded: line 1: expected ':'"),
        ("x = 1\ny = x.z\n", {}, "mine.py cannot be loaded: line 2 of mine.py: AttributeError: 'int' object has no"),
        (
            "from .other import x\n",
            {},
            "mine.py cannot be loaded: it imports .other, but there is no other.py beside it",
        ),
        (ECHO, {"speed": 3}, "mine.py takes no settings; give it a dataclass Settings, or leave speed out"),
        (ALL, {"frist": 3}, "device mine.py has no setting 'frist'; did you mean first?"),
    ],
)
def test_a_file_that_is_not_a_device_is_rejected_with_a_sentence(
    tmp_path: Path, text: str, more: dict[str, int], sentence: str
):
    with pytest.raises(BadCase) as caught:
        device(tmp_path, text, **more)
    assert sentence in str(caught.value) and "case.toml" in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("return 256", "device mine: on_read, line 7 of mine.py, returned 256; expected a byte, 0 to 0xFF"),
        ("return", "device mine: on_read, line 7 of mine.py, returned None; expected a byte, 0 to 0xFF"),
        ("return self.nothing", "device mine: AttributeError at line 8 of mine.py: 'Device' object has no attribute"),
        ("self.bus.stretch(20)", 'device mine, line 8 of mine.py: 20 has no unit; write for instance "20 ms"'),
        ("self.bus.pin('DRDY')", "device mine, line 8 of mine.py: there is no wire 'DRDY'; name it in a unit's pins"),
        ("self.bus.after('1 us', self.fail)", "device mine: ZeroDivisionError at line 5 of mine.py: integer division"),
    ],
)
def test_a_mistake_of_a_hook_is_reported_with_its_line(tmp_path: Path, line: str, sentence: str):
    text = f"""\
class Device:
    def __init__(self, bus):
        self.bus = bus
    def fail(self):
        return 1 // 0

    def on_read(self):
        {line}
        {"return 0" if "after" in line else ""}
"""
    bus = device(tmp_path, text)
    with pytest.raises(FirmwareError) as caught:
        bus.do("42 R 1")
    assert str(caught.value).startswith(sentence) and "\n" not in str(caught.value)


def test_two_copies_of_a_file_are_two_devices(tmp_path: Path):
    (tmp_path / "mine.py").write_text(ECHO, encoding="utf-8")
    bus = Bus(tmp_path, a={"model": "mine.py", "address": 0x42}, b={"model": "mine.py", "address": 0x43})
    bus.do("42 W 01")
    assert bus.do("43 R 1") == "43 ff"
