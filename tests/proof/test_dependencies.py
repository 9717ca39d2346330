"""The files on which a coverage depends: those that were read, and none that the tool itself has made."""

from __future__ import annotations

import shutil
from fractions import Fraction
from pathlib import Path

from periph_sim.core.input_files import TEMPORARY, inputs_of_one_command
from periph_sim.interfaces.reports.coverage import choose
from periph_sim.proof.dependencies import dependencies
from periph_sim.proof.stretch import Job
from tests.scene.runs import TIMING


def test_headers_of_c_sources_are_dependencies_and_compiled_files_are_not(tmp_path: Path) -> None:
    """The compiler reads extra.inc, which neither the case nor a file named by it has as a name."""
    (tmp_path / "timing").mkdir()
    shutil.copytree(TIMING.parent / "firmware" / "c", tmp_path / "firmware" / "c")
    case = Path(shutil.copy(TIMING / "imu_hil_c.toml", tmp_path / "timing"))
    source, extra = (tmp_path / "firmware" / "c" / name for name in ("imu_hil.c", "extra.inc"))
    extra.write_text("#define EXTRA 1\n", encoding="utf-8")
    source.write_text('#include "extra.inc"\n' + source.read_text(encoding="utf-8"), encoding="utf-8")
    with inputs_of_one_command():
        depends = choose(Job(str(case), rounds=3), 1, (Fraction(0), Fraction(0))).depends
    sources = {f"../firmware/c/{name}" for name in ("imu_hil.c", "f28335.h", "extra.inc")}
    assert depends.files.keys() >= sources | {"imu_hil_c.toml"}
    assert not any(TEMPORARY in file for file in depends.files)
    assert depends.differences(case.parent) == []
    extra.write_text("#define EXTRA 2\n", encoding="utf-8")
    assert depends.differences(case.parent) == ["../firmware/c/extra.inc has changed"]


def test_a_folder_that_is_a_link_has_the_files_that_it_had(tmp_path: Path) -> None:
    """Paths are relative to the folder as it is named, not to the folder to which it links."""
    (tmp_path / "deep" / "real").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "deep" / "real")
    (tmp_path / "model.py").write_text("A = 1\n", encoding="utf-8")
    depends = dependencies(tmp_path / "link", [tmp_path / "model.py"])
    assert "../model.py" in depends.files
    assert depends.differences(tmp_path / "link") == []
