"""What a scene does not name is not there: nothing imported, no object, no event, in both forms.

The list is tests/scene/absent.py. That a row names what its thing really needs, a scene that has it shows: there all
of the row's rooms are imported, and their classes have instances.
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
from tests.scene.absent import BARE, COUNTED, DOORS, OTHERS, OURS, ROWS, in_room

FORMS = (INTERPRETED, COMPILED) if form.usable(PACKAGE, BUILT)[0] else (INTERPRETED,)

# Events of 10 ms of each: one more than these is had by something that the scene does not name.
EVENTS = {"slave": 50, "sci": 4, "bus": 14}


@cache
def told(name: str, which: str) -> dict[str, Any]:
    """By a process that runs this scene, then all others, then this one again."""
    environment = {key: value for key, value in os.environ.items() if key != VARIABLE}
    if which == INTERPRETED:
        environment[VARIABLE] = INTERPRETED
    command = [sys.executable, "-m", "tests.scene.absent", name]
    came = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert came.returncode == 0, came.stderr
    found: dict[str, Any] = json.loads(came.stdout)
    return found


def in_rooms(names: list[str], rooms: tuple[str, ...]) -> list[str]:
    return [name for name in names if in_room(name, rooms)]


def is_ours(module: str) -> bool:
    return PACKAGE.joinpath(*module.split(".")).with_suffix(".py").exists()


def instances(objects: dict[str, int], rooms: tuple[str, ...]) -> dict[str, int]:
    return {name: count for name, count in objects.items() if in_room(name.rpartition(".")[0], rooms)}


@pytest.mark.parametrize("name", BARE)
def test_what_a_scene_does_not_name_is_not_there(name: str) -> None:
    absent = {what: row.rooms for what, row in ROWS.items() if name not in row.present}
    for which in FORMS:
        found = told(name, which)
        imported = {what: in_rooms(found["modules"], rooms) for what, rooms in absent.items()}
        assert {what: names for what, names in imported.items() if names} == {}
        assert in_rooms(found["modules"], DOORS) == [] and sorted(set(found["modules"]) & set(OTHERS)) == []
        made = {what: instances(found["objects again"], rooms) for what, rooms in absent.items()}
        assert {what: objects for what, objects in made.items() if objects} == {}, "made, since others had it before"
        assert found["objects again"] == found["objects"]
        assert (found["events"], found["events again"]) == (EVENTS[name], EVENTS[name])


@pytest.mark.skipif(len(FORMS) == 1, reason="no core compiled of these sources: make core")
@pytest.mark.parametrize("name", BARE)
def test_both_forms_import_and_make_the_same(name: str) -> None:
    one, other = (told(name, which) for which in FORMS)
    assert one["objects"] == other["objects"]
    ours, others = ([module for module in found["modules"] if is_ours(module)] for found in (one, other))
    assert ours == others and len(ours) > 50


def test_a_scene_that_names_it_has_all_of_it() -> None:
    found = told(COUNTED, INTERPRETED)
    lacking = {
        what: [room for room in row.rooms if not in_rooms(found["all modules"], (room,))] for what, row in ROWS.items()
    }
    assert {what: rooms for what, rooms in lacking.items() if rooms} == {}
    assert [what for what, row in ROWS.items() if not instances(found["named"][what], row.rooms)] == []


@pytest.mark.parametrize("room", DOORS)
def test_each_door_is_there(room: str) -> None:
    assert find_spec(f"periph_sim.{room.removesuffix('.')}") is not None


# Through one door no other is opened ----------------------------------------------------


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
NAMED = ("recording", "budgets on lost flags")  # by this case, but for the bare scene "slave"
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


@pytest.mark.parametrize("door", OPENED)
def test_through_one_door_no_other_is_opened(door: str, tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(CASE, "utf-8")
    program, rooms, others = OPENED[door]
    told_at_end = "import json, sys; before = {*sys.modules}; import atexit\n"
    told_at_end += "atexit.register(lambda: print(json.dumps(sorted({*sys.modules} - before)), file=sys.stderr))\n"
    command = [sys.executable, "-c", told_at_end + program]
    came = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    modules = [name.removeprefix(OURS) for name in json.loads(came.stderr)]
    assert [name for name in in_rooms(modules, DOORS) if not in_room(name, rooms)] == []
    assert {name.partition(".")[0] for name in modules} & set(OTHERS) <= others
    assert [room for room in rooms if not in_rooms(modules, (room,))] == []
    absent = {what: row.rooms for what, row in ROWS.items() if "slave" not in row.present and what not in NAMED}
    found = {what: in_rooms(modules, rooms) for what, rooms in absent.items() if door != "recorded"}
    assert {what: names for what, names in found.items() if names} == {}
