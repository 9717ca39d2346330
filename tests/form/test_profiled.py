"""A build that is optimized for cases uses the counts of their runs; if it fails, the existing build is kept."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from shutil import which

import pytest

from periph_sim.form import LIBRARY, build, profiled
from tests.form.package import written

with_gcc = pytest.mark.skipif(find_spec("Cython") is None or which("gcc") is None, reason="Cython or gcc is missing")

WORK = """
# core: compiled
class Work:
    def __init__(self):
        self.steps = 0
        self.last = 0
    def collatz(self, number: int) -> int:
        while number > 1:
            number = 3 * number + 1 if number % 2 else number // 2
            self.steps += 1
            self.last = number
        return self.steps
"""
RUN = """
import os
import sys
from pathlib import Path
from periph_sim.form import finders

def run(number):
    sys.path_hooks.insert(0, finders(Path(__file__).parent, Path(os.environ["PERIPH_SIM_FORM"]), {modules}))
    sys.path_importer_cache.clear()
    from profiled_own.work import Work
    Work().collatz(int(number))
"""


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of a package with one compiled module, whose "cases" are numbers."""
    package = written(tmp_path, "profiled_own", work=WORK)
    (package / "__init__.py").write_text(RUN.format(modules=["work"]))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("CC", "gcc")
    return package


@with_gcc
def test_the_module_is_compiled_with_the_counts_of_the_run(own: Path, capfd):
    built = own / "compiled"
    build.build(own, built, 1)
    ordinary = (built / LIBRARY).read_bytes()
    profiled.build_for(["27", "6171"], own, built, 1)
    assert capfd.readouterr().out.split("\n") == ["1/1 work"] * 2 + ["counted 27", "counted 6171", "1/1 work", ""]
    assert (built / LIBRARY).read_bytes() != ordinary
    assert b"gcov" not in (built / LIBRARY).read_bytes()  # the final build has no counters
    build.build(own, built, 1)
    assert capfd.readouterr().out == f"{build.NOTHING_TO_DO}\n"


@with_gcc
@pytest.mark.parametrize(
    ("text", "case", "said"),
    [
        (RUN.format(modules=["work"]), "once", r"^once does not run, so nothing was counted; ValueError: .*'once'$"),
        (
            "import os\n\ndef run(number):\n    os.kill(os.getpid(), 9)\n",
            "27",
            r"^27 does not run, so nothing was counted; exit status -9$",
        ),
        (RUN.format(modules=[]), "27", "did not use the compiled core, so nothing was counted"),
    ],
    ids=["a case that does not run", "a process that is killed", "a run without the compiled core"],
)
def test_without_counts_the_existing_build_is_kept(own: Path, text: str, case: str, said: str):
    (own / "__init__.py").write_text(text)
    with pytest.raises(build.NoBuild, match=said):
        profiled.build_for([case], own, own / "compiled", 1)
    assert not (own / "compiled").exists()


@pytest.mark.posix("a shell script as the compiler")
def test_the_error_for_another_compiler_than_gcc_quotes_the_compiler(own: Path, tmp_path: Path, monkeypatch, capsys):
    script = tmp_path / "other"
    script.write_text("#!/bin/sh\necho \"error: unknown argument: '-fprofile-partial-training'\" >&2; exit 1\n")
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    monkeypatch.setattr(profiled, "PACKAGE", own)
    monkeypatch.setattr(profiled, "BUILT", own / "compiled")
    monkeypatch.setattr(build, "find_spec", lambda name: name)
    assert profiled.main(["27"]) == 1
    said = capsys.readouterr().err
    assert said.startswith(f"the build is left as it was: {script} cannot optimize for a case; name gcc 12 or newer in")
    assert said.endswith("error: unknown argument: '-fprofile-partial-training'\n\n")


def test_a_build_for_no_case_is_refused(capsys):
    assert profiled.main([]) == 1
    assert capsys.readouterr().err == (
        "the build is left as it was: no case is named; name the cases to optimize for: "
        "python -m periph_sim.form.profiled CASE ...\n"
    )
