"""The wheel: its contents, and that it works in a repository with a package `firmware` of its own.

There are two kinds: the pure one, and one with the compiled core, if a core is compiled of these sources already. Each
is installed by pip in a separate environment with the packages that it needs at run time only: without Cython, without
a compiler on the path, and without these sources.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import venv
import zipfile
from collections.abc import Callable
from fcntl import LOCK_EX, flock
from importlib.metadata import distribution, requires
from pathlib import Path
from subprocess import PIPE, STDOUT, CompletedProcess

import pytest
from packaging.requirements import Requirement

import periph_sim
from periph_sim.form import BUILT, COMPILED, LIBRARY, MANIFEST, PACKAGE, VARIABLE, usable
from tests.docs.pages import CONSOLE, FILE, WIDTH, commands, matches

ROOT = Path(__file__).parents[1]

# Pages for the first hour, by stem, each with the section for it if that is not the whole page.
FIRST_HOUR = (("first_slave", ""), ("serial", ""), ("images", "A first image"))
MOST_LINES = 25  # maximum number of lines of an output on them
FEWEST_COMMANDS = 3  # minimum number of commands on them
IN_SENTENCE = re.compile(r"`(periph-sim \w[\w-]* [^`A-Z]+)`")  # complete commands, without a placeholder such as FILE

pytestmark = pytest.mark.long

CASE = """
name = "own"
duration = "3 ms"
[unit.dsp]
firmware = "../firmware/answer.py"
modules = ["I2C-A"]
[controller]
first = "1 ms"
period = "2 ms"
[[controller.request]]
name = "r"
address = 0x50
pointer = 0
count = 2
expect = "01 02"
[[budget]]
name = "wrong bytes"
measure = "wrong bytes"
max = 0
"""


def built(folder: Path, **variables: str) -> Path:
    """Build the wheel in `folder`, and return its path."""
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=ROOT,
        env={**os.environ, **variables},
        check=True,
        capture_output=True,
    )
    (file,) = folder.glob("*.whl")
    return file


def installed_in(folder: Path, wheel: Path, extra: str = "") -> Path:
    """Return the site-packages of a new environment with the wheel and with links to the packages that it needs.

    `extra` is an extra of the wheel, whose packages are linked too.
    """
    venv.create(folder, with_pip=False)
    (site,) = folder.glob("lib/python3*/site-packages")
    for name in needed("periph-sim", extra):
        files = distribution(name).files or []
        for top in {file.parts[0] for file in files} - {"..", "__pycache__"}:
            (site / top).symlink_to(distribution(name).locate_file(top))
    pip = [sys.executable, "-m", "pip", "--python", str(folder), "install", "--no-index", "--no-deps"]
    subprocess.run([*pip, "--no-compile", str(wheel)], check=True, capture_output=True)
    return site


def needed(name: str, extra: str = "") -> set[str]:
    """The names of the packages that a package needs to run, directly or indirectly, with one extra of its own."""
    found: set[str] = set()
    left = [(name, extra)]
    while left:
        package, of = left.pop()
        for text in requires(package) or []:
            one = Requirement(text)
            if one.name not in found and (one.marker is None or one.marker.evaluate({"extra": of})):
                found.add(one.name)
                left.append((one.name, ""))
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder shared by all processes of a test session."""
    base = tmp_path_factory.getbasetemp()
    shared = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "wheels"
    shared.mkdir(exist_ok=True)
    return shared


@pytest.fixture(scope="module")
def wheel(folder: Path) -> Path:
    return made_once(folder / "wheel", built)


@pytest.fixture(scope="module")
def installed(wheel: Path, folder: Path) -> Path:
    return made_once(folder / "pure", lambda place: installed_in(place, wheel))


@pytest.fixture(scope="module")
def first_hour(request: pytest.FixtureRequest, wheel: Path, folder: Path) -> Path:
    """The bin folder of an environment with a wheel, compiled if possible, and its extra `pytest`."""
    if usable(PACKAGE, BUILT)[0]:
        wheel = request.getfixturevalue("compiled_wheel")

    def make(place: Path) -> Path:
        site = installed_in(place, wheel, "pytest")
        program = python_of(site).with_name("pytest")
        program.write_text(f"#!{python_of(site)}\nimport pytest\nraise SystemExit(pytest.main())\n")
        program.chmod(0o755)
        return program.parent

    return made_once(folder / "first_hour", make)


@pytest.fixture(scope="module")
def compiled_wheel(folder: Path) -> Path:
    if not usable(PACKAGE, BUILT)[0]:
        pytest.skip("no core compiled of these sources: make core")
    return made_once(folder / "compiled_wheel", lambda place: built(place, HATCH_BUILD_HOOKS_ENABLE="1"))


@pytest.fixture(scope="module")
def compiled(compiled_wheel: Path, folder: Path) -> Path:
    return made_once(folder / "compiled", lambda place: installed_in(place, compiled_wheel))


def made_once(place: Path, make: Callable[[Path], Path]) -> Path:
    """Return the result of `make`, which the first process of the test session that needs it makes in `place`."""
    made = place.with_suffix(".made")
    with place.with_suffix(".lock").open("w") as lock:
        flock(lock, LOCK_EX)
        if not made.exists():
            made.write_text(str(make(place)))
        return Path(made.read_text())


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A user's repository whose package `firmware` must not be imported; two of its files are the case's firmware."""
    for folder in ("firmware", "timing"):
        (tmp_path / folder).mkdir()
    (tmp_path / "firmware" / "__init__.py").write_text("raise RuntimeError('the repository own firmware package')\n")
    (tmp_path / "firmware" / "answer.py").write_text("from .shared import Settings, main\n")
    (tmp_path / "firmware" / "shared.py").write_text("from .responder import Settings, main\n")
    (tmp_path / "timing" / "own.toml").write_text(CASE)
    return tmp_path


def python_of(site: Path) -> Path:
    """Return the Python of the environment of a wheel."""
    return site.parents[2] / "bin" / "python"


def command(site: Path, repository: Path, *arguments: str, changed: Path | None = None) -> CompletedProcess[str]:
    """Run where no compiler is found: a wheel in its own form, and the clone in that of the other tests.

    `changed` is a folder that is searched first.
    """
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "", "PATH": ""}
    environment.pop("PYTHONPATH", None)
    if site != ROOT:
        environment.pop(VARIABLE, None)
    if site == ROOT or changed is not None:
        environment["PYTHONPATH"] = str(changed or ROOT)
    return subprocess.run(
        [sys.executable if site == ROOT else python_of(site), "-m", "periph_sim", *arguments],
        cwd=repository,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_all_files_are_below_the_package_and_none_is_missing(wheel: Path) -> None:
    names = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert {name.partition("/")[0] for name in names} == {"periph_sim"}
    sources = [
        file.relative_to(ROOT).as_posix()
        for folder in ("periph_sim", "firmware/python", "firmware/c28x", "firmware/c", "timing")
        for file in (ROOT / folder).rglob("*")
        if file.is_file() and not {"__pycache__", "compiled"} & set(file.parts)
    ]
    assert names == {re.sub("^(firmware|timing)/", r"periph_sim/examples/\1/", name) for name in sources}
    assert "periph_sim/py.typed" in names


def test_a_platform_wheel_also_contains_the_compiled_core(wheel: Path, compiled_wheel: Path) -> None:
    assert re.fullmatch(r"periph_sim-[\d.]+-cp3\d+-cp3\d+-\w+\.whl", compiled_wheel.name), compiled_wheel.name
    more = set(zipfile.ZipFile(compiled_wheel).namelist()) - set(zipfile.ZipFile(wheel).namelist())
    expected = {f"periph_sim/compiled/{name}" for name in (LIBRARY, MANIFEST)}
    assert {name for name in more if ".dist-info/" not in name} == expected


LOOK = """
import importlib.util, json, sys, periph_sim
absent = [name for name in ("Cython", "pytest", "hatchling", "pip") if importlib.util.find_spec(name) is None]
print(json.dumps([periph_sim.__file__, sys.path, absent]))
"""


def test_an_environment_has_neither_sources_nor_tools(installed: Path, compiled: Path, repository: Path) -> None:
    for site in (installed, compiled):
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        look = [python_of(site), "-c", LOOK]
        result = subprocess.run(look, cwd=repository, env=environment, capture_output=True, text=True, check=True)
        file, path, absent = json.loads(result.stdout)
        assert Path(file).parent == site / "periph_sim" and not Path(file).is_symlink()
        assert absent == ["Cython", "pytest", "hatchling", "pip"]
        assert [one for one in path if one and Path(one).resolve() == ROOT] == []
        assert (site.parents[2] / "bin" / "periph-sim").is_file()


def test_the_compiled_core_runs_from_its_wheel_and_records_the_same(
    installed: Path, compiled: Path, repository: Path
) -> None:
    recorded = []
    for site, form in ((installed, "interpreted"), (compiled, COMPILED)):
        ran = command(site, repository, "run", "timing/own.toml", "--record", "run.jsonl", "--json")
        assert (ran.returncode, ran.stderr) == (0, "")
        assert json.loads(ran.stdout)["form"] == form
        recorded.append((repository / "run.jsonl").read_bytes())
    assert recorded[0] == recorded[1] and recorded[0].count(b"\n") > 100


def test_a_changed_source_disables_the_compiled_core_with_a_notice(
    compiled: Path, repository: Path, tmp_path: Path
) -> None:
    changed = shutil.copytree(compiled / "periph_sim", tmp_path / "changed" / "periph_sim")
    with (changed / "core" / "wire.py").open("a") as source:
        source.write("# changed by a user\n")
    result = command(compiled, repository, "--version", changed=changed.parent)
    assert result.stdout.endswith(", interpreted\n")
    assert result.stderr == (
        "the compiled core was built of other sources or for another Python, so it is left alone and this run is "
        "interpreted; `python -m periph_sim.form.build` builds it anew\n"
    )


def test_wheel_and_command_have_the_version_of_the_package(wheel: Path, installed: Path, repository: Path) -> None:
    assert wheel.name == f"periph_sim-{periph_sim.__version__}-py3-none-any.whl"
    result = command(installed, repository, "--version")
    assert result.stdout == f"periph-sim, version {periph_sim.__version__}, interpreted\n"


def test_a_case_runs_in_a_repository_with_its_own_firmware_package(installed: Path, repository: Path) -> None:
    result = command(installed, repository, "run", "timing/own.toml")
    assert (result.returncode, result.stderr) == (0, "")
    assert "own: PASS" in result.stdout
    assert not list(repository.rglob("__pycache__"))


def test_a_shipped_case_has_the_same_figures_and_places(installed: Path, repository: Path) -> None:
    """Lints name the lines of the firmware."""
    case = ("timing", "imu_hil_no_sdir.toml")
    printed = []
    for site, examples in ((ROOT, ROOT), (installed, installed / "periph_sim" / "examples")):
        ran = command(site, repository, "run", str(examples.joinpath(*case)), "--seconds", "0.3", "--record", "run.psr")
        lints = command(site, repository, "lint", "run.psr")
        printed.append((ran.stdout, ran.stderr, lints.stdout, lints.stderr))
    assert printed[0] == printed[1]
    assert "batch_read:" in printed[0][2]


def test_a_shipped_case_keeps_its_baseline(installed: Path, repository: Path) -> None:
    case = installed / "periph_sim/examples/timing/imu_hil_broken_line.toml"
    result = command(installed, repository, "check", str(case))
    assert (result.returncode, result.stderr) == (0, ""), result.stdout


@pytest.mark.parametrize(("name", "heading"), FIRST_HOUR)
def test_the_commands_of_a_page_of_the_first_hour_work_as_printed(
    first_hour: Path, tmp_path: Path, name: str, heading: str
) -> None:
    """The commands run in an empty folder, in a shell that finds the wheel's `periph-sim`, pytest and system commands.

    Commands within a sentence are run last; no output is shown for them, so they must succeed.
    """
    page = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
    if heading:
        _, _, page = page.partition(f"\n## {heading}\n")
        page, _, _ = page.partition("\n## ")
    for file, text in FILE.findall(page):
        (tmp_path / file).write_text(text, encoding="utf-8")
    path = f"{first_hour}{os.pathsep}{os.defpath}"
    environment = {"PATH": path, "COLUMNS": WIDTH, "TERM": "dumb", "LC_ALL": "C.UTF-8", "HOME": str(tmp_path)}

    def shell(line: str) -> CompletedProcess[str]:
        return subprocess.run(
            ["bash", "-c", line], cwd=tmp_path, env=environment, stdout=PIPE, stderr=STDOUT, text=True, check=False
        )

    typed = [one for block in CONSOLE.findall(page) for one in commands(block)]
    assert len(typed) >= FEWEST_COMMANDS
    for line, shown in typed:
        result = "".join(f"{text.rstrip()}\n" for text in shell(line).stdout.splitlines())
        assert matches(shown, result), f"{line}\n{result}"
        assert shown.count("\n") <= MOST_LINES, line
    for line in IN_SENTENCE.findall(page):
        done = shell(line)
        assert done.returncode == 0, f"{line}\n{done.stdout}"
