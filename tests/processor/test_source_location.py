"""Source locations: files of firmware or of the package, and the parts of a location in an image."""

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
        ("periph_sim/processor/bus.py", True),  # as in frames of compiled modules
        (f"{PACKAGE}firmware/startup.py", False),
        (f"{PACKAGE}examples/blink.py", False),
        ("/home/me/blink.py", False),
    ],
)
def test_start_up_code_and_shipped_programs_are_firmware_and_other_files_of_the_package_are_not(file: str, ours: bool):
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
def test_a_location_contains_the_known_parts(place: tuple[str, int, str, int], text: str):
    found = instruction_location(*place, 0x9051)
    assert found == found.for_people() == text
    assert (found.path, found.line) == (place[2].replace("\\", "/"), place[3])


def test_the_text_of_a_location_is_parsed_to_its_parts():
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


def test_an_explanation_shows_the_location_with_its_file():
    in_run = place_of(instruction_location("_serve", 0x9000, "src/imu_hil.asm", 77, 0x9051))
    assert in_run is not None and in_run.file is not None
    assert (str(in_run), in_run.file.as_posix()) == ("imu_hil.asm:77 (_serve, 0x009051)", "src/imu_hil.asm")
    assert str(place_of("_serve (imu_hil.asm:77, 0x009051)")) == "imu_hil.asm:77 (_serve, 0x009051)"
    assert str(place_of("_serve+0x11 (0x009051)")) == "_serve+0x11 (0x009051)"
    assert str(place_of("batch_read:107")) == "batch_read:107"
