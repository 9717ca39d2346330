"""Files of firmware are distinguished from those of the package in both forms; a location in an image has parts."""

from __future__ import annotations

import pytest

import periph_sim
from periph_sim.interfaces.reports.explain.chain import place_of
from periph_sim.processor.source_location import Parts, instruction_location, is_firmware, is_ours, parsed, statement

PACKAGE = periph_sim.__file__.removesuffix("__init__.py")


@pytest.mark.parametrize(
    ("file", "ours"),
    [
        (f"{PACKAGE}processor/bus.py", True),
        ("periph_sim/processor/bus.py", True),  # what frames of compiled modules name
        (f"{PACKAGE}firmware/startup.py", False),
        (f"{PACKAGE}examples/blink.py", False),
        ("/home/me/blink.py", False),
    ],
)
def test_files_of_the_package_are_no_firmware_but_start_up_code_and_shipped_programs_are(file: str, ours: bool):
    assert is_ours(file) is ours and is_firmware(file) is not ours


@pytest.mark.parametrize(
    ("place", "text"),
    [
        (("_serve", 0x9000, "src/imu_hil.asm", 77), "_serve (imu_hil.asm:77, 0x009051)"),
        (("_serve", 0x9000, "..\\src\\main.c", 7), "_serve (main.c:7, 0x009051)"),
        (("_serve", 0x9040, "", 0), "_serve+0x11 (0x009051)"),
        (("", 0x9051, "", 0), "0x009051"),
        (("", 0x9051, "boot.asm", 3), "boot.asm:3, 0x009051"),
    ],
)
def test_a_place_names_what_is_known(place: tuple[str, int, str, int], text: str):
    found = instruction_location(*place, 0x9051)
    assert found == found.for_people() == text
    assert (found.path, found.line) == (place[2].replace("\\", "/"), place[3])


def test_a_recorded_place_gives_its_parts_back():
    assert parsed("_serve (imu_hil.asm:77, 0x009051)") == Parts("_serve", "imu_hil.asm", 77, 0x9051)
    assert parsed("_serve+0x11 (0x009051)") == Parts("_serve+0x11", "", 0, 0x9051)
    assert parsed("Bus::send(int) (bus (1).cpp:7, 0x009051)") is None
    assert parsed("Bus::send(int) (bus.cpp:7, 0x009051)") == Parts("Bus::send(int)", "bus.cpp", 7, 0x9051)
    assert parsed("batch_read:107") is None
    assert parsed("0x009051") is None


def test_the_instructions_of_a_source_line_are_one_statement():
    assert statement("_isr (main.c:7, 0x009051)") == statement("_isr (main.c:7, 0x009053)") == "_isr (main.c:7)"
    assert statement("_isr+0x1 (0x009051)") != statement("_isr+0x3 (0x009053)")
    assert statement("batch_read:107") == "batch_read:107"


def test_an_explanation_shows_it_with_its_file():
    in_run = place_of(instruction_location("_serve", 0x9000, "src/imu_hil.asm", 77, 0x9051))
    assert in_run is not None and in_run.file is not None
    assert (str(in_run), in_run.file.as_posix()) == ("imu_hil.asm:77 (_serve, 0x009051)", "src/imu_hil.asm")
    assert str(place_of("_serve (imu_hil.asm:77, 0x009051)")) == "imu_hil.asm:77 (_serve, 0x009051)"
    assert str(place_of("_serve+0x11 (0x009051)")) == "_serve+0x11 (0x009051)"
    assert str(place_of("batch_read:107")) == "batch_read:107"
