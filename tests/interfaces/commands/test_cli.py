"""The command line: each command is a file, help imports no command, and a command does not import the others."""

from __future__ import annotations

import errno
import importlib
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim import form
from periph_sim.cli import PACKAGES, ROOT, SECTIONS, cli, is_closed_pipe
from periph_sim.interfaces.commands.command_frame import MISTAKES, VERSION
from tests.interfaces.commands.conftest import Run

TRACE = str(Path(__file__).resolve().parents[3] / "traces" / "host_frames.sr")
HEAVY = (
    "pydantic",
    "rich",
    "greenlet",
    "periph_sim.scene",
    "periph_sim.scene.case",
    "periph_sim.f28335",
    "periph_sim.bus",
)


def imported_by(*arguments: str, before: str = "") -> list[str]:
    """The modules that a fresh `periph-sim` has loaded when it ends. `before` is code that runs first."""
    code = f"{before}\nimport sys, periph_sim.cli as c\ntry: c.run_command()\nfinally: print('\\nloaded', *sys.modules)"
    result = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    return result.stdout.rpartition("\nloaded ")[2].split()


def test_each_file_with_a_click_command_is_a_command_with_its_name():
    names = cli.list_commands(None)  # type: ignore[arg-type]
    assert {"decode", "regs", "replay", "run"} <= set(names)
    for name in names:
        command = cli.get_command(None, name)  # type: ignore[arg-type]
        assert command is not None and command.name == name
    files = [file for package in PACKAGES for file in ROOT.joinpath(*package.split(".")).glob("*.py")]
    assert len(names) < len(files), "helper modules in the folder must not be commands"


UNUSED = (  # by a short run of imu_hil; a run uses arrays only if it is long
    "asyncio",
    "numpy",
    "pydantic",
    "rich",
    "periph_sim.records.races",
    "periph_sim.imu.motion.flight",
)


def test_a_run_imports_only_what_it_uses():
    case = Path(__file__).parents[3] / "timing" / "imu_hil.toml"
    loaded = imported_by("run", str(case), "--seconds", "20 ms")
    assert {"periph_sim.imu.motion.sines", "periph_sim.imu.near_gaussian"} <= set(loaded)
    assert not set(UNUSED) & set(loaded)


COMMANDS = cli.list_commands(None)  # type: ignore[arg-type]


def test_help_lists_every_command_in_a_section_with_its_first_sentence(periph_sim: Run):
    result = periph_sim("--help")
    assert result.status == 0 and "run Run CASE and judge its budgets" in " ".join(result.out.split())
    titles = [line for line in result.out.splitlines() if line.endswith(":") and not line.startswith(" ")]
    assert titles == ["Options:", *(f"{title}:" for title in SECTIONS.values())]
    run, understand = (result.out.index(f"\n{SECTIONS[section]}:") for section in ("run", "understand"))
    assert run < result.out.index("\n  check ") < understand < result.out.index("\n  worst ")


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_a_command_begins_with_examples_and_fits_80_columns(periph_sim: Run, name: str):
    result = periph_sim(name, "--help")
    usage, _, rest = result.out.partition("\n\n")
    assert usage.startswith("Usage: ") and rest.startswith(f"  $ periph-sim {name}")
    assert max(map(len, result.out.splitlines())) <= 80


@pytest.mark.parametrize("name", sorted({*COMMANDS} - {"decode"}))
def test_json_of_every_command_says_its_schema(name: str):
    """Commands with --json print it with one of two functions. decode, with an object per line, is not tested here."""
    command = cli.get_command(None, name)  # type: ignore[arg-type]
    assert command is not None and command.callback is not None
    if any("--json" in option.opts for option in command.params):
        assert re.search(rf'print_(json|answer)\(\s*"{name}",', inspect.getsource(command.callback))


def test_a_json_object_begins_with_schema_and_version_and_ends_with_the_form(periph_sim: Run):
    report = periph_sim("diff", TRACE, TRACE, "--uart", "rx=RX,baud=115200,format=8n1", "--json").json_object
    assert list(report)[:2] == ["schema", "schema_version"]
    assert list(report)[-1] == "form" and report["form"] == form.running
    assert (report["schema"], report["schema_version"]) == ("periph-sim diff", VERSION)


def test_the_error_for_a_misspelt_command_suggests_the_nearest_one(periph_sim: Run):
    assert "there is no command 'rgs'; did you mean regs?" in periph_sim.refused("rgs")


@pytest.mark.parametrize("arguments", [("--help",), ("decode", "--help"), ("decode", TRACE, "--format", "csv")])
def test_commands_without_chips_do_not_import_them(arguments: tuple[str, ...]):
    loaded = imported_by(*arguments)
    assert "periph_sim.cli" in loaded
    assert [name for name in loaded if name.startswith(HEAVY)] == []


@pytest.mark.parametrize("name", sorted(MISTAKES))
def test_each_name_in_mistakes_is_an_exception_class(name: str):
    module, _, error = name.rpartition(".")
    assert issubclass(getattr(importlib.import_module(module), error), Exception)


def started(*arguments: str, stdout: object) -> subprocess.CompletedProcess[str]:
    code = "import periph_sim.cli; periph_sim.cli.run_command()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], stdout=stdout, stderr=subprocess.PIPE, text=True, check=False
    )


def test_a_full_disk_is_one_error_message():
    if not Path("/dev/full").is_char_device():
        pytest.skip("there is no /dev/full")
    with open("/dev/full", "w") as full:
        result = started("schema", stdout=full)
    message = "Error: standard output: found no space left on device, expected room for the output"
    assert result.stderr == f"{message}; make room, or redirect it\n"
    assert result.returncode == 2


def test_a_closed_pipe_ends_with_status_141_and_no_message():
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as closed:
        result = started("schema", stdout=closed)
    assert (result.returncode, result.stderr) == (141, "")


def test_windows_reports_a_closed_pipe_as_an_invalid_argument(monkeypatch: pytest.MonkeyPatch):
    errors = BrokenPipeError(errno.EPIPE, ""), OSError(errno.EINVAL, ""), OSError(errno.EINVAL, "", "file.toml")
    found = {}
    for name in ("posix", "nt"):
        with monkeypatch.context() as system:
            system.setattr(os, "name", name)
            found[name] = [is_closed_pipe(error) for error in errors]
    assert found == {"posix": [True, False, False], "nt": [True, True, False]}
