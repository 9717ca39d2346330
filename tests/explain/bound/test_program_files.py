"""Which files a firmware is read from, for bounds: its own, those beside it, and start-up code, wherever they lie."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from periph_sim.explain.bound import program
from periph_sim.processor.source_location import PACKAGE
from periph_sim.scene.firmware_loader import load_firmware


@pytest.mark.parametrize("libraries", [program.LIBRARIES, (*program.LIBRARIES, str(PACKAGE))])
def test_start_up_code_is_read_where_the_package_is_among_libraries_too(
    monkeypatch: pytest.MonkeyPatch, libraries: tuple[str, ...]
) -> None:
    monkeypatch.setattr(program, "LIBRARIES", libraries)
    read = program.Program(load_firmware("responder").main).modules
    assert [Path(path).name for path in sorted(read)] == ["responder.py", "slave_module.py", "startup.py"]


def test_modules_that_a_module_of_the_firmware_imports_are_read_too(tmp_path: Path) -> None:
    """program.py imports near.py, which imports far.py."""
    for name, text in (
        ("far", "def far(dsp):\n    dsp.compute(1)\n"),
        ("near", "from .far import far\n\n\ndef near(dsp):\n    far(dsp)\n"),
        ("program", "from .near import near\n\n\ndef main(dsp, settings):\n    near(dsp)\n"),
    ):
        (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    read = program.Program(load_firmware(str(tmp_path / "program.py")).main).modules
    assert [Path(path).name for path in sorted(read)] == ["far.py", "near.py", "program.py"]


def test_what_a_main_uses_that_is_of_no_module_is_read_too(tmp_path: Path) -> None:
    (tmp_path / "near.py").write_text("def main(dsp, settings):\n    dsp.compute(1)\n", encoding="utf-8")
    names: dict[str, Any] = {"__name__": "never_imported", "near": load_firmware(str(tmp_path / "near.py")).main}
    exec("def main(dsp, settings):\n    near(dsp, settings)\n", names)
    read = program.Program(names["main"])
    assert [Path(path).name for path in read.modules] == ["near.py"] and read.unreadable == {"<string>"}
