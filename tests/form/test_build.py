"""Builds of small modules: both forms are equal, only changed modules are compiled, and errors are one message."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from shutil import which

import pytest

from periph_sim import form
from periph_sim.form import LIBRARY, PACKAGE, build
from tests.form.package import written

COMPARE = """
from fractions import Fraction
from periph_sim.core import time
from periph_sim.core.chip import NEVER
print(time.__file__.endswith(".py"))
for per_second, ppm in {rates}:
    base = time.Timebase(150_000_000)
    clock = time.Clock(base, 150_000_000 * (1 + Fraction(ppm) / 1_000_000), tick0=per_second, cycle0=7)
    for cycle in {cycles}:
        tick = clock.tick(cycle)
        print(tick, clock.cycle_at(tick), clock.cycle_at(tick + 1), clock.cycle_after(tick))
"""
RATES = [(at, ppm) for at in (0, 20) for ppm in ("0.001", "37", "-37", "1000", "0", "-0.001")]
CYCLES = [-5, 0, 6, 7, 8, 999_999, 108_000_000_000, 3 * 10**15, (1 << 62) // 20 - 10**14]


def test_without_a_c_compiler_runs_stay_interpreted(monkeypatch, tmp_path: Path):
    monkeypatch.setattr(build, "find_spec", lambda name: object())
    monkeypatch.setenv("CC", str(tmp_path / "no-such-cc"))
    with pytest.raises(build.NoBuild, match=r"there is no C compiler '.*no-such-cc'; install one"):
        build.compiler()


def test_without_cython_the_extra_is_named(monkeypatch, capsys):
    monkeypatch.setattr(build, "find_spec", lambda name: None)
    assert build.main() == 1
    assert capsys.readouterr().err == (
        "the core stays interpreted: Cython is not installed; "
        "install the extra `core`: pip install 'periph-sim[core]'\n"
    )


def test_without_pythons_headers_their_package_is_named(monkeypatch, tmp_path: Path):
    monkeypatch.setattr(build, "find_spec", lambda name: object())
    monkeypatch.setenv("CC", sys.executable)
    monkeypatch.setattr(build.sysconfig, "get_path", lambda name: str(tmp_path))
    with pytest.raises(
        build.NoBuild, match=r"Python.h is not installed; install Python's headers \(the package python3-"
    ):
        build.compiler()


@pytest.mark.parametrize("said", ["two", "0", "-1", "1.5"])
def test_an_invalid_number_of_jobs_is_reported(monkeypatch, capsys, said: str):
    monkeypatch.setenv("JOBS", said)
    assert build.main() == 1
    assert capsys.readouterr().err == (
        f"the core stays interpreted: JOBS={said}: expected a number of modules to compile at a time, 1 or more\n"
    )


def test_an_unknown_prefix_is_reported(capsys):
    assert build.main(["--hrad"]) == 1
    said = "the core stays interpreted: no compiled module's name begins with '--hrad'\n"
    assert capsys.readouterr().err == said


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (
            PermissionError(13, "Permission denied", "/site-packages/periph_sim/compiled"),
            "[Errno 13] Permission denied: '/site-packages/periph_sim/compiled'",
        ),
        (BrokenProcessPool("A process in the process pool was terminated"), "A process in the process pool was term"),
    ],
    ids=["a folder that cannot be written", "a compiler that is killed"],
)
def test_an_error_of_the_operating_system_is_reported(monkeypatch, capsys, error: Exception, said: str):
    def fail(*given: object) -> None:
        raise error

    monkeypatch.setattr(build, "build", fail)
    assert build.main() == 1
    assert capsys.readouterr().err.startswith(f"the core stays interpreted: {said}")


@pytest.mark.skipif(find_spec("Cython") is None, reason="Cython is missing")
def test_a_compilation_error_quotes_the_compiler_and_the_last_build_is_kept(tmp_path: Path, monkeypatch):
    built = tmp_path / "built"
    package = written(tmp_path, "own", one="# core: compiled\nclass One:\n    here: 'Annotated[list[One], 4]'\n")
    built.mkdir()
    (built / "kept").touch()
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(build, "compiler", lambda: "cc")
    with pytest.raises(build.NoBuild, match=r"(?s)one does not compile; .*Invalid type"):
        build.build(package, built, 1)
    assert [path.name for path in built.iterdir()] == ["kept"]


TWO_ARRAYS = """
# core: compiled
from typing import Annotated

class One:
    low: Annotated[list[int], 4]

class Two:
    low: Annotated[list[int], 8]
"""


@pytest.mark.skipif(find_spec("Cython") is None, reason="Cython is missing")
def test_code_to_which_no_checks_can_be_added_is_reported_in_one_line(tmp_path: Path, monkeypatch, capsys):
    package = written(tmp_path, "arrays", one=TWO_ARRAYS)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(build, "compiler", lambda: "cc")
    assert build.status_of(lambda: build.build(package, tmp_path / "built", 1), "the core stays interpreted") == 1
    said = "one does not compile; two arrays are called 'low', of different lengths; rename one of them"
    assert capsys.readouterr().err == f"the core stays interpreted: {said}\n"


ONE = """
# core: compiled
from . import NAME

class One:
    def __init__(self):
        self.count = 0
    def more(self, by: int) -> object:
        self.count += by
        return NAME, self.count
"""


@pytest.mark.skipif(find_spec("Cython") is None or which("cc") is None, reason="Cython or a C compiler is missing")
def test_modules_of_one_name_are_distinct_and_only_changed_ones_are_compiled(tmp_path, monkeypatch, capsys):
    package, built = tmp_path / "rooms", tmp_path / "built"
    for room in ("left", "right"):
        (package / room).mkdir(parents=True)
        (package / room / "__init__.py").write_text(f"NAME = {room!r}\n")
        (package / room / "one.py").write_text(ONE)
    (package / "__init__.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    imported = ["rooms", "rooms.left", "rooms.left.one", "rooms.right", "rooms.right.one"]
    for name in imported:
        monkeypatch.setitem(sys.modules, name, None)  # so that none of them remains imported after the test
        del sys.modules[name]
    monkeypatch.setattr(sys, "path_importer_cache", {})

    def printed() -> list[str]:
        build.build(package, built, 1)
        return capsys.readouterr().out.splitlines()

    assert printed() == ["1/2 left.one", "2/2 right.one"]
    (package / "left" / "one.py").write_text(ONE)
    assert printed() == [build.NOTHING_TO_DO]
    stamps = json.loads((built / form.MANIFEST).read_text("utf-8"))["stamps"]
    assert stamps == form.stamps(package, ["left.one", "right.one"])
    (package / "right" / "one.py").write_text(ONE.replace("+= by", "+= 2 * by"))
    assert printed() == ["1/1 right.one"]
    modules, _ = form.usable(package, built)
    assert modules == ["left.one", "right.one"]

    for name in imported:  # because the build has imported the sources
        del sys.modules[name]
    monkeypatch.setattr(sys, "path_importer_cache", {})
    monkeypatch.setattr(sys, "path_hooks", [form.finders(package, built, [*modules, "left.two"]), *sys.path_hooks])
    for room, expected in (("left", ("left", 3)), ("right", ("right", 6))):
        module = import_module(f"rooms.{room}.one")
        assert module.One().more(3) == expected
        assert (module.__name__, module.__package__) == (f"rooms.{room}.one", f"rooms.{room}")
        assert module.__file__ == str(built / LIBRARY)
    with pytest.raises(form.DoesNotLoad, match="does not define module export function"):
        import_module("rooms.left.two")


def compiler_that(folder: Path, does: str) -> str:
    """Return the path of a "C compiler" that is a shell script with these lines."""
    script = folder / "cc"
    script.write_text(f"#!/bin/sh\n{does}\n")
    script.chmod(0o755)
    return str(script)


@pytest.mark.posix("a shell script as the compiler")
def test_a_linker_without_the_sorting_option_is_called_again_without_it(tmp_path: Path):
    cc = compiler_that(tmp_path, f'case "$*" in *{build.SORTED}*) exit 1;; esac\necho "$@" > {LIBRARY}')
    build.link(["core.one", "core.two"], tmp_path, cc)
    assert (tmp_path / LIBRARY).read_text() == f"-shared core.one.o core.two.o -o {LIBRARY}\n"


@pytest.mark.skipif(find_spec("Cython") is None, reason="Cython is missing")
@pytest.mark.posix("a shell script as the compiler")
def test_the_function_that_adds_tracebacks_is_declared_cold(tmp_path: Path, monkeypatch):
    package = written(tmp_path, "rooms", one="def more(count):\n    return count + 1\n")
    (package / "one.pxd").write_text("")
    monkeypatch.chdir(tmp_path)
    build.compile_one("one", ["one"], "rooms", compiler_that(tmp_path, "cp one.c kept.c"))
    c_text = (tmp_path / "kept.c").read_text()
    assert c_text.count("__attribute__((cold)) static void __Pyx_AddTraceback(") == 1


@pytest.mark.parametrize(("platform", "given"), [("linux", []), ("darwin", ["-undefined", "dynamic_lookup"])])
def test_on_macos_the_linker_leaves_the_names_of_python_to_the_loader(monkeypatch, tmp_path: Path, platform, given):
    commands: list[list[str]] = []

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        commands.append(command)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(build, "run", run)
    monkeypatch.setattr(build.sys, "platform", platform)
    build.link(["one"], tmp_path, "cc")
    assert commands == [["cc", "-shared", *given, "one.o", "-o", build.LIBRARY, build.SORTED]]


@pytest.mark.posix("a shell script as the compiler")
def test_a_link_error_quotes_the_linker(tmp_path: Path):
    cc = compiler_that(tmp_path, "echo no space left >&2; exit 1")
    with pytest.raises(build.NoBuild, match=r"(?s)the compiled modules do not link; .*cc says:\nno space left"):
        build.link(["core.one"], tmp_path, cc)


@pytest.mark.long
@pytest.mark.skipif(not form.usable(PACKAGE, form.BUILT)[0], reason="no core compiled of these sources: make core")
def test_clocks_convert_the_same_in_both_forms():
    """Compiled integers have 64 bits: 0.001 to 1000 ppm, with negative cycles and cycles up to the longest run."""
    code = COMPARE.format(rates=RATES, cycles=CYCLES)
    compiled, interpreted = (
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, form.VARIABLE: chosen},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.splitlines()
        for chosen in (form.COMPILED, form.INTERPRETED)
    )
    assert (compiled[0], interpreted[0]) == ("False", "True")
    assert compiled[1:] == interpreted[1:] and len(compiled) == 1 + len(RATES) * len(CYCLES)


def test_a_source_without_declarations_is_reported_in_one_line(monkeypatch, capsys, tmp_path: Path):
    (tmp_path / "one.py").write_text("# core: compiled\nclass One:\n    def set(self, it):\n        self.it = it.it\n")
    monkeypatch.setattr(build, "PACKAGE", tmp_path)
    monkeypatch.setattr(build, "BUILT", tmp_path / "built")
    monkeypatch.setattr(build, "compiler", lambda: "cc")
    monkeypatch.setattr(build, "import_module", lambda name: build)
    assert build.main() == 1
    said = "one.py:4: nothing says the type of One.it; annotate it in the class"
    assert capsys.readouterr().err == f"the core stays interpreted: {said}\n"


@pytest.mark.posix("signals to a group of processes")
@pytest.mark.skipif(find_spec("Cython") is None, reason="Cython is missing")
def test_ctrl_c_ends_a_build_without_compiling_the_remaining_modules(tmp_path: Path):
    """All processes of the terminal's group receive the signal while the first of eight modules is being compiled."""
    built, calls = tmp_path / "built", tmp_path / "calls.txt"
    modules = {f"m{number}": "# core: compiled\n\n\nclass One:\n    pass\n" for number in range(8)}
    package = written(tmp_path, "rooms", **modules)
    compiler = tmp_path / "slow-cc"
    compiler.write_text('#!/bin/sh\necho called >> "$CALLS"\nexec sleep 1\n')
    compiler.chmod(0o755)
    code = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from pathlib import Path; from periph_sim.form import build\n"
        f"build.build(Path({str(package)!r}), Path({str(built)!r}), 1)"
    )
    environment = {**os.environ, "CC": str(compiler), "CALLS": str(calls), "PYTHONPATH": str(tmp_path)}
    with subprocess.Popen(
        [sys.executable, "-c", code], env=environment, start_new_session=True, stderr=subprocess.DEVNULL
    ) as process:
        while not calls.exists() and process.poll() is None:
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGINT)
        assert process.wait(60) != 0
    assert len(calls.read_text().splitlines()) <= 3 and not built.exists()
