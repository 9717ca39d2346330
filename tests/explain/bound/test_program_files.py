"""Which files a firmware is read from, for bounds: its own, those beside it, and start-up code, wherever they lie."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.explain.bound import program
from periph_sim.processor.source_location import PACKAGE
from periph_sim.scene.firmware_loader import load_firmware


@pytest.mark.parametrize("libraries", [program.LIBRARIES, (*program.LIBRARIES, str(Path(PACKAGE).parent))])
def test_start_up_code_is_read_where_the_package_is_among_libraries_too(
    monkeypatch: pytest.MonkeyPatch, libraries: tuple[str, ...]
) -> None:
    monkeypatch.setattr(program, "LIBRARIES", libraries)
    read = program.Program(load_firmware("responder").main).modules
    assert [Path(path).name for path in sorted(read)] == ["responder.py", "startup.py"]
