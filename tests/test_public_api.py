"""Public names exist and are imported lazily, and `run` judges as the command does."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import periph_sim
from periph_sim import BadCase, BadRecording, Run, load, make_case, run
from tests.interfaces.commands.conftest import Run as Command
from tests.interfaces.commands.conftest import periph_sim as command  # noqa: F401

TIMING = Path(__file__).parents[1] / "timing"


@pytest.mark.parametrize("name", periph_sim.__all__)
def test_every_public_name_exists(name: str):
    assert getattr(periph_sim, name).__name__ in (name, name.removesuffix("_capture"))
    assert name in dir(periph_sim)


def test_the_package_imports_lazily_and_an_unknown_name_is_an_error():
    code = (
        "import sys, periph_sim; print([m for m in sys.modules if m.startswith(('periph_sim.', 'numpy', 'pydantic'))])"
    )
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert outcome.stdout == "['periph_sim.form']\n"  # this module chooses the form of the core
    with pytest.raises(AttributeError, match="no attribute 'lod'"):
        _ = periph_sim.lod  # type: ignore[attr-defined]


def test_run_judges_a_file_as_the_command_does(command: Command):  # noqa: F811
    case = str(TIMING / "imu_hil_published.toml")
    report = json.loads(command("run", case, "--seconds", "0.03", "--set", "seed=2", "--json").out)
    result = run(case, ["seed=2"], seconds=Fraction(3, 100))
    assert (result.case, result.verdict) == (report["case"], report["verdict"])
    assert [(one.name, one.worst) for one in result.budgets] == [
        (one["name"], one["worst"]) for one in report["budgets"]
    ]


def idle(dsp, settings):
    dsp.compute(300)
    with dsp.span("work"):
        dsp.compute(1500)


SENDS = """\
name = "mine"
duration = "1 ms"

[unit.dsp]
firmware = "idle"
modules = ["SCI-A"]

[serial]
baud = 115200

[[serial.send]]
name = "hello"
to = "dsp.SCI-A"
file = "sent.jsonl"
at = "0.1 ms"

[[budget]]
name = "work"
measure = "span:work"
max = "20 us"
"""
TABLES = {
    "name": "mine",
    "duration": "1 ms",
    "unit": {"dsp": {"firmware": "idle", "modules": []}},
    "budget": [{"name": "work", "measure": "span:work", "max": "20 us"}],
}


def test_a_case_and_firmware_in_python_are_run_and_recorded(tmp_path: Path):
    result = run(make_case(**TABLES), programs={"dsp": idle}, record=tmp_path / "run.psr")
    (work,) = result.budgets
    assert (result.verdict, work.worst) == ("pass", 10.0)
    assert len(Run.read(tmp_path / "run.psr").table) > 0
    assert run(make_case(["budget.work.max=9 us"], **TABLES), programs={"dsp": idle}).verdict == "fail"


@pytest.mark.parametrize("name", ["mine", "a/b", "../b", "/b", ""])
def test_files_of_a_case_without_a_file_are_in_the_current_folder(name: str):
    made = make_case(**TABLES | {"name": name})
    assert made.folder == Path() and made.file == Path(f"make_case({name})")


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (
            lambda: make_case(name="mine", dura="1 ms"),
            "make_case(mine): there is no key 'dura'; did you mean duration?",
        ),
        (
            lambda: make_case(name="mine", duration="1 ms", seed=2**70),
            "make_case(mine): seed is an integer that does not fit 64 bits; give a smaller number",
        ),
        (
            lambda: make_case(name="mi\nne", duration="1 ms"),
            r"make_case(mi\nne): name: 'mi\nne' is no name; a name is one line of printable characters",
        ),
        (
            lambda: make_case(name="mine", duration="1 ms", controller={"order": ("gyro\nscope",)}),
            r"make_case(mine): controller.order.0: 'gyro\nscope' is no name",
        ),
        (lambda: run(make_case(**TABLES), ["seed=2"]), "changes go with a file; give them to load or make_case"),
        (lambda: run(make_case(**TABLES), seconds="3"), "seconds='3': '3' has no unit"),
        (lambda: run(make_case(**TABLES), programs={"dps": idle}), "case mine has no unit 'dps'; it has dsp"),
        (lambda: run("nowhere.toml"), "nowhere.toml: cannot be read"),
    ],
)
def test_a_wrong_argument_is_one_error_message(call, sentence: str):
    with pytest.raises(BadCase) as error:
        call()
    assert sentence in str(error.value) and "\n" not in str(error.value)


def test_why_and_lint_accept_the_file_of_a_run(tmp_path: Path) -> None:
    file = tmp_path / "run.psr"
    periph_sim.run("timing/responder.toml", record=file, seconds="2 ms")
    recorded = Run.read(file)
    asked = "SCL@1.9 ms"
    assert periph_sim.why(file, asked).back == periph_sim.why(recorded, asked).back
    assert periph_sim.lint(str(file)) == periph_sim.lint(recorded)
    with pytest.raises(periph_sim.NotInRun, match="there is no such file"):
        periph_sim.why("none.psr", asked)


@pytest.mark.parametrize("given", [Path, load], ids=["a file", "a case that was loaded before"])
@pytest.mark.parametrize("output", ["sent.jsonl", "link.jsonl"])
def test_no_recording_replaces_a_file_that_the_run_reads(tmp_path: Path, given: Callable[[Path], Any], output: str):
    """The outputs are a file of characters to send, and a link to the case, which `load` has read before the run."""
    case = tmp_path / "mine.toml"
    case.write_text(SENDS)
    (tmp_path / "sent.jsonl").write_text("hello")
    (tmp_path / "link.jsonl").symlink_to("mine.toml")
    with pytest.raises(BadRecording, match="found a file that this command reads"):
        run(given(case), programs={"dsp": idle}, record=tmp_path / output)
    assert (case.read_text(), (tmp_path / "sent.jsonl").read_text()) == (SENDS, "hello")
