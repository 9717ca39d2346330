"""Which files are the firmware's: those of the package are not, whichever form they run in."""

from __future__ import annotations

import pytest

import periph_sim
from periph_sim.processor.source_location import is_firmware, is_ours

PACKAGE = periph_sim.__file__.removesuffix("__init__.py")


@pytest.mark.parametrize("folder", [PACKAGE, "periph_sim/"])  # sources, and what frames of compiled modules name
def test_files_of_the_package_are_ours_and_no_firmware(folder: str):
    assert is_ours(f"{folder}processor/bus.py") and not is_firmware(f"{folder}processor/bus.py")


@pytest.mark.parametrize("file", [f"{PACKAGE}firmware/startup.py", f"{PACKAGE}examples/blink.py", "/home/me/blink.py"])
def test_start_up_code_and_shipped_programs_are_firmware(file: str):
    assert is_firmware(file) and not is_ours(file)
