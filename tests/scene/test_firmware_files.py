"""Firmware of several files: relative imports, and messages of refused imports."""

from __future__ import annotations

import sys
import threading
from pathlib import Path

import pytest

from periph_sim.scene.firmware_loader import BadFirmware, load_firmware, settings_for
from tests.scene.small import sentence_of

MAIN = "from .shared import NAME\n\n\ndef main(dsp, settings):\n    pass\n"


def program(folder: Path, text: str = MAIN, **beside: str) -> str:
    folder.mkdir(exist_ok=True)
    for name, content in beside.items():
        (folder / f"{name}.py").write_text(content, encoding="utf-8")
    file = folder / "mine.py"
    file.write_text(text, encoding="utf-8")
    return str(file)


def name_in(file: str) -> object:
    return load_firmware(file).main.__globals__["NAME"]


def test_folders_with_files_of_one_name_are_kept_apart(tmp_path: Path) -> None:
    one = program(tmp_path / "one", shared="NAME = 'one'\n")
    two = program(tmp_path / "two", shared="NAME = 'two'\n")
    assert [name_in(one), name_in(two), name_in(one)] == ["one", "two", "one"]


def test_an_edited_file_beside_the_firmware_is_used_at_once_and_no_file_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    names = [name_in(program(tmp_path, shared=f"NAME = '{name}'\n")) for name in ("one", "two")]
    assert names == ["one", "two"]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["mine.py", "shared.py"]


def test_a_copy_of_a_shipped_program_finds_the_shipped_files(tmp_path: Path) -> None:
    shipped = Path(__file__).parents[2] / "firmware" / "python" / "imu_hil.py"
    main = load_firmware(program(tmp_path, shipped.read_text(encoding="utf-8"))).main
    assert main.__code__.co_filename == str(tmp_path / "mine.py")
    assert main.__globals__["models_of"].__code__.co_filename == str(shipped.with_name("imu_models.py"))


def test_a_file_beside_the_firmware_is_used_before_a_shipped_one(tmp_path: Path) -> None:
    assert name_in(program(tmp_path, MAIN.replace(".shared", ".responder"), responder="NAME = 'own'\n")) == "own"


def test_a_folder_beside_the_firmware_can_be_imported(tmp_path: Path) -> None:
    program(tmp_path / "drivers", "NAME = 'driver'\n")
    assert name_in(program(tmp_path, MAIN.replace(".shared", ".drivers.mine"))) == "driver"


def test_the_file_name_may_have_a_dot(tmp_path: Path) -> None:
    file = Path(program(tmp_path, shared="NAME = 'one'\n")).rename(tmp_path / "mine.v2.py")
    assert name_in(str(file)) == "one"


def test_shipped_programs_load_where_firmware_is_another_package(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("_firmware_shipped")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "firmware", None)  # an import of it fails
    assert callable(load_firmware("imu_hil_robust").main)


def test_settings_are_checked_with_the_names_of_the_module_that_they_come_from(tmp_path: Path) -> None:
    """An edited file is loaded again under the same module name, so the first module is no longer in `sys.modules`."""
    text = "from dataclasses import dataclass\nfrom periph_sim.firmware import HexBytes\nREPLAY = ('reply',)\n"
    text += "@dataclass\nclass Settings:\n    reply: HexBytes = b''\ndef main(dsp, settings): pass\n"
    file = tmp_path / "mine.py"
    file.write_text("from __future__ import annotations\n" + text)
    before = load_firmware(str(file))
    file.write_text("def main(dsp, settings): pass\n")
    load_firmware(str(file))
    assert vars(settings_for(before, {"reply": "12 34"})) == {"reply": b"\x12\x34"}


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("from .nowhere import NAME", "it imports .nowhere, but there is no nowhere.py beside it"),
        (
            "from shared import NAME",
            "No module named 'shared'; the shared.py beside it is imported with a dot: from .shared import ...",
        ),
        ("import nowhere_at_all", "No module named 'nowhere_at_all'"),
    ],
)
def test_a_refused_import_is_reported_with_its_correction(tmp_path: Path, line: str, message: str) -> None:
    file = program(tmp_path, MAIN.replace("from .shared import NAME", line), shared="NAME = 'one'\n")
    assert sentence_of(BadFirmware, lambda: load_firmware(file)) == f"firmware {file!r} cannot be loaded: {message}"


def test_a_file_is_loaded_while_other_threads_import(tmp_path: Path) -> None:
    """Scenes in threads import at the same time, each its own firmware."""
    file, interval = program(tmp_path, "def main(dsp, settings): pass\n"), sys.getswitchinterval()
    over: list[bool] = []
    made: list[str] = []

    def imports() -> None:
        while not over and len(made) < 200_000:
            made.append(f"other_{len(made)}")
            sys.modules[made[-1]] = sys

    other = threading.Thread(target=imports)
    try:
        sys.setswitchinterval(1e-6)
        other.start()
        assert all(callable(load_firmware(file).main) for _ in range(20))
    finally:
        over.append(True)
        other.join()
        sys.setswitchinterval(interval)
        for name in made:
            del sys.modules[name]
