"""A scene imports, creates and executes nothing for features that its case does not name, in both forms.

The features are the rows of tests/scene/absent.py. A scene that has a feature shows that its row lists what it really
needs: all packages of the row are imported there, and their classes have instances.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from periph_sim import form
from periph_sim.form import BUILT, COMPILED, INTERPRETED, PACKAGE, VARIABLE
from tests.scene.absent import BARE, COUNTED, ENTRY_POINTS, OTHERS, OURS, ROWS, is_in_packages

FORMS = (INTERPRETED, COMPILED) if form.usable(PACKAGE, BUILT)[0] else (INTERPRETED,)

# Number of events in 10 ms of each scene. A higher number means that something the scene does not name has events.
EVENTS = {"slave": 50, "sci": 4, "bus": 14}


@cache
def report_of(name: str, which: str) -> dict[str, Any]:
    """Return the report of a process that runs this scene, then all others, then this one again."""
    environment = {key: value for key, value in os.environ.items() if key != VARIABLE}
    if which == INTERPRETED:
        environment[VARIABLE] = INTERPRETED
    command = [sys.executable, "-m", "tests.scene.absent", name]
    came = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert came.returncode == 0, came.stderr
    found: dict[str, Any] = json.loads(came.stdout)
    return found


def names_in_packages(names: list[str], packages: tuple[str, ...]) -> list[str]:
    return [name for name in names if is_in_packages(name, packages)]


def is_ours(module: str) -> bool:
    return PACKAGE.joinpath(*module.split(".")).with_suffix(".py").exists()


def instances(objects: dict[str, int], packages: tuple[str, ...]) -> dict[str, int]:
    return {name: count for name, count in objects.items() if is_in_packages(name.rpartition(".")[0], packages)}


@pytest.mark.parametrize("name", BARE)
def test_a_scene_has_nothing_of_features_that_it_does_not_name(name: str) -> None:
    absent = {what: row.packages for what, row in ROWS.items() if name not in row.present}
    for which in FORMS:
        found = report_of(name, which)
        imported = {what: names_in_packages(found["modules"], packages) for what, packages in absent.items()}
        assert {what: names for what, names in imported.items() if names} == {}
        assert (
            names_in_packages(found["modules"], ENTRY_POINTS) == []
            and sorted(set(found["modules"]) & set(OTHERS)) == []
        )
        made = {what: instances(found["objects again"], packages) for what, packages in absent.items()}
        assert {what: objects for what, objects in made.items() if objects} == {}, (
            "created because other scenes of the process had it before"
        )
        assert found["objects again"] == found["objects"]
        assert (found["events"], found["events again"]) == (EVENTS[name], EVENTS[name])


@pytest.mark.skipif(len(FORMS) == 1, reason="no core compiled of these sources: make core")
@pytest.mark.parametrize("name", BARE)
def test_both_forms_import_and_make_the_same(name: str) -> None:
    one, other = (report_of(name, which) for which in FORMS)
    assert one["objects"] == other["objects"]
    ours, others = ([module for module in found["modules"] if is_ours(module)] for found in (one, other))
    assert ours == others and len(ours) > 50


def test_a_scene_that_names_a_feature_has_all_of_its_packages() -> None:
    found = report_of(COUNTED, INTERPRETED)
    lacking = {
        what: [package for package in row.packages if not names_in_packages(found["all modules"], (package,))]
        for what, row in ROWS.items()
    }
    assert {what: packages for what, packages in lacking.items() if packages} == {}
    assert [what for what, row in ROWS.items() if not instances(found["named"][what], row.packages)] == []


@pytest.mark.parametrize("package", ENTRY_POINTS)
def test_each_entry_point_exists(package: str) -> None:
    assert find_spec(f"periph_sim.{package.removesuffix('.')}") is not None


# Imports of one entry point ----------------------------------------------------


CASE = """
name = "small"
duration = "10 ms"
[unit.dsp]
firmware = "responder"
modules = ["I2C-A"]
[controller]
period = "5 ms"
[[controller.request]]
name = "read"
address = 0x50
count = 2
expect = "01 02"
[[budget]]
name = "lost"
measure = "lost flags"
max = 0
"""
NAMED = ("recording", "budgets on lost flags")  # features of this case that the bare scene "slave" lacks
COMMAND = "import sys; sys.argv[1:] = {}; from periph_sim.cli import run_command; run_command()"
OPENED: dict[str, tuple[str, tuple[str, ...], set[str]]] = {
    "from Python": ("import periph_sim; periph_sim.run('small.toml')", ("api",), set()),
    "run": (COMMAND.format(["run", "small.toml"]), ("cli", "interfaces.commands."), {"click"}),
    "run --json": (COMMAND.format(["run", "small.toml", "--json"]), ("cli", "interfaces.commands."), {"click"}),
    "recorded": (
        "import periph_sim; periph_sim.run('small.toml', record='run.jsonl')",
        ("api", "traces.formats."),
        {"numpy", "zlib_ng"},
    ),
}


@pytest.mark.parametrize("entry_point", OPENED)
def test_an_entry_point_imports_no_other_one(entry_point: str, tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(CASE, "utf-8")
    program, packages, others = OPENED[entry_point]
    print_at_end = "import json, sys; before = {*sys.modules}; import atexit\n"
    print_at_end += "atexit.register(lambda: print(json.dumps(sorted({*sys.modules} - before)), file=sys.stderr))\n"
    command = [sys.executable, "-c", print_at_end + program]
    came = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    modules = [name.removeprefix(OURS) for name in json.loads(came.stderr)]
    assert [name for name in names_in_packages(modules, ENTRY_POINTS) if not is_in_packages(name, packages)] == []
    assert {name.partition(".")[0] for name in modules} & set(OTHERS) <= others
    assert [package for package in packages if not names_in_packages(modules, (package,))] == []
    absent = {what: row.packages for what, row in ROWS.items() if "slave" not in row.present and what not in NAMED}
    found = {
        what: names_in_packages(modules, packages) for what, packages in absent.items() if entry_point != "recorded"
    }
    assert {what: names for what, names in found.items() if names} == {}
