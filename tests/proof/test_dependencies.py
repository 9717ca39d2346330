"""The files on which a coverage depends: those that were read, except files that the tool itself has made."""

from __future__ import annotations

import os
import shutil
from fractions import Fraction
from pathlib import Path

from periph_sim.core.input_files import TEMPORARY, inputs_of_one_command
from periph_sim.interfaces.reports.coverage import choose
from periph_sim.proof.dependencies import dependencies, files_read
from periph_sim.proof.stretch import Job
from tests.scene.runs import TIMING


def test_headers_of_c_sources_are_dependencies_and_compiled_files_are_not(tmp_path: Path) -> None:
    """The compiler reads extra.inc, which the case does not name."""
    (tmp_path / "timing").mkdir()
    shutil.copytree(TIMING.parent / "firmware" / "c", tmp_path / "firmware" / "c")
    case = Path(shutil.copy(TIMING / "imu_hil_c.toml", tmp_path / "timing"))
    source, extra = (tmp_path / "firmware" / "c" / name for name in ("imu_hil.c", "extra.inc"))
    extra.write_text("#define EXTRA 1\n", encoding="utf-8")
    source.write_text('#include "extra.inc"\n' + source.read_text(encoding="utf-8"), encoding="utf-8")
    with inputs_of_one_command():
        depends = choose(Job(str(case), rounds=1), 1, (Fraction(0), Fraction(0))).depends
    sources = {f"../firmware/c/{name}" for name in ("imu_hil.c", "f28335.h", "extra.inc")}
    assert depends.files.keys() >= sources | {"imu_hil_c.toml"}
    assert not any(TEMPORARY in file for file in depends.files)
    assert depends.differences(case.parent) == []
    extra.write_text("#define EXTRA 2\n", encoding="utf-8")
    assert depends.differences(case.parent) == ["../firmware/c/extra.inc has changed"]


def test_files_are_noted_however_they_are_opened_for_reading(tmp_path: Path) -> None:
    one, two, three = (tmp_path / name for name in ("one", "two", "three"))
    one.touch()
    two.touch()
    with files_read() as read:
        os.close(os.open(one, os.O_RDONLY))
        two.read_bytes()
        three.write_bytes(b"")
    assert {name for name in read if name.startswith(str(tmp_path))} == {str(one), str(two)}


def test_a_folder_that_is_a_link_has_the_files_that_it_had(tmp_path: Path) -> None:
    """Paths are relative to the folder as it is named, not to the folder to which it links."""
    (tmp_path / "deep" / "real").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "deep" / "real")
    (tmp_path / "model.py").write_text("A = 1\n", encoding="utf-8")
    depends = dependencies(tmp_path / "link", [tmp_path / "model.py"])
    assert "../model.py" in depends.files
    assert depends.differences(tmp_path / "link") == []


def test_a_file_behind_a_link_and_a_parent_folder_is_a_dependency(tmp_path: Path) -> None:
    """The system follows the link before it goes to the parent folder."""
    (tmp_path / "deep" / "real").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "deep" / "real")
    image = tmp_path / "deep" / "image.asm"
    image.write_text("; one\n", encoding="utf-8")
    depends = dependencies(tmp_path / "link", [tmp_path / "link" / ".." / "image.asm"])
    assert "../deep/image.asm" in depends.files
    image.write_text("; two\n", encoding="utf-8")
    assert depends.differences(tmp_path / "link") == ["../deep/image.asm has changed"]


def test_a_new_file_that_could_be_read_instead_of_one_in_another_folder_is_a_difference(tmp_path: Path) -> None:
    for name in ("case/image.asm", "case/unread.inc", "shared/start.inc", "shared/unread.inc"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("; one\n", encoding="utf-8")
    case = tmp_path / "case"
    depends = dependencies(
        case, [case / "image.asm", tmp_path / "shared" / "start.inc", tmp_path / "shared/unread.inc"]
    )
    assert depends.differences(case) == []
    (case / "other.inc").write_text("; two\n", encoding="utf-8")
    assert depends.differences(case) == []
    (case / "start.inc").write_text("; two\n", encoding="utf-8")
    assert depends.differences(case) == ["start.inc is new"]


def test_a_nearer_project_is_a_difference(tmp_path: Path) -> None:
    """Plugins of the project can change the meaning of names in the case."""
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "case.toml").touch()
    depends = dependencies(tmp_path / "site", [tmp_path / "site" / "case.toml"])
    (tmp_path / "pyproject.toml").touch()
    assert depends.differences(tmp_path / "site") == ["../pyproject.toml is now the project of the case"]
