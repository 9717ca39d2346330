"""The compiled core is used only if it was built from the present sources; otherwise the reason is reported."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from _pytest.assertion.rewrite import AssertionRewritingHook
from _pytest.config import Config

from periph_sim import cli, form
from periph_sim.form import LIBRARY, MANIFEST, digest, stamps, usable

MODULES = ["core.one", "core.two"]


@pytest.fixture
def package(tmp_path: Path, monkeypatch) -> Path:
    """Return the folder of a package of two modules that has a build."""
    monkeypatch.syspath_prepend(tmp_path)
    package = tmp_path / "package"
    (package / "core").mkdir(parents=True)
    for name in ("one", "two"):
        (package / "core" / f"{name}.py").write_text(f"NAME = '{name}'\n")
    built = tmp_path / "built"
    built.mkdir()
    (built / LIBRARY).touch()
    (built / MANIFEST).write_text(json.dumps({"digest": digest(package, MODULES), "size": 0, "modules": MODULES}))
    return package


def test_a_build_of_the_present_sources_is_usable(package: Path):
    assert usable(package, package.parent / "built") == (MODULES, "")


@pytest.mark.parametrize(("unread", "runs"), [(0, True), (1, False)])
def test_sources_are_compared_only_if_one_was_written_after_the_build(package: Path, unread: int, runs: bool):
    """Size and time of each source are compared first; the digest in this manifest never agrees."""
    written = stamps(package, MODULES)
    written[0][0] += unread
    manifest = {"digest": "of others", "stamps": written, "size": 0, "modules": MODULES}
    (package.parent / "built" / MANIFEST).write_text(json.dumps(manifest))
    assert bool(usable(package, package.parent / "built")[0]) is runs


@pytest.mark.parametrize("file", ["one.py", "two.py"])
def test_a_build_of_other_sources_is_not_usable(package: Path, file: str):
    with (package / "core" / file).open("a") as source:
        source.write("\n")
    modules, why = usable(package, package.parent / "built")
    assert modules == [] and why == "the compiled core was built of other sources or for another Python"


@pytest.mark.parametrize("change", ["no source", "no library", "another size", "no manifest", "no JSON", "no digest"])
def test_an_incomplete_build_is_not_usable(package: Path, change: str):
    built = package.parent / "built"
    if change == "no source":
        (package / "core" / "one.py").unlink()
    elif change == "no library":
        (built / LIBRARY).unlink()
    elif change == "another size":  # as after a full disk or an interrupted copy
        (built / LIBRARY).write_bytes(b"half")
    elif change == "no manifest":
        (built / MANIFEST).unlink()
    else:
        (built / MANIFEST).write_text('{"modules": []}' if change == "no digest" else "{")
    modules, why = usable(package, built)
    assert modules == [] and why.startswith("the compiled core ")


@pytest.fixture
def found_first(package: Path, monkeypatch) -> None:
    """Import the compiled form of that package. Its library is empty, so it fails to load like one for another libc."""
    monkeypatch.setattr(sys, "path_importer_cache", {})
    monkeypatch.setattr(sys, "path_hooks", [form.finders(package, package.parent / "built", MODULES), *sys.path_hooks])


def test_the_error_of_a_library_that_does_not_load_names_the_remedies(found_first):
    with pytest.raises(form.DoesNotLoad) as error:
        importlib.import_module("package.core.one")
    assert str(error.value).startswith("the compiled core does not load here: ")
    assert str(error.value).endswith("; `make core` builds it anew, PERIPH_SIM_FORM=interpreted leaves it alone")


def test_a_hook_that_rewrites_assertions_of_all_modules_leaves_compiled_ones(package: Path, found_first, monkeypatch):
    """cocotb makes pytest install such a hook before all other imports."""
    (package / "core" / "three.py").write_text("NAME = 'three'\n")
    monkeypatch.setattr(
        sys, "meta_path", list(sys.meta_path)
    )  # because creating a pytest configuration adds a hook to this list, too
    hook = AssertionRewritingHook(Config.fromdictargs({}, ["-o", "python_files=*.py"]))
    sys.meta_path.insert(0, hook)
    assert importlib.import_module("package.core.three").__loader__ is hook
    with pytest.raises(form.DoesNotLoad):
        importlib.import_module("package.core.two")


def test_the_command_line_reports_a_library_that_does_not_load_in_one_line(monkeypatch, capsys):
    def refuse(*given: object, **options: object) -> None:
        raise form.DoesNotLoad("the compiled core does not load here: no such symbol")

    monkeypatch.setattr(cli.cli, "main", refuse)
    with pytest.raises(SystemExit) as ended:
        cli.run_command()
    assert ended.value.code == cli.MISTAKE
    assert capsys.readouterr().err == "Error: the compiled core does not load here: no such symbol\n"


def test_the_version_contains_the_name_of_the_form():
    environment = {**os.environ, form.VARIABLE: form.INTERPRETED}
    command = [sys.executable, "-m", "periph_sim", "--version"]
    came = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert came.stdout.endswith(", interpreted\n") and came.stderr == ""


@pytest.mark.parametrize(("value", "what"), [("nowhere/", "build"), ("interpretd", "form"), ("compiled", ""), ("", "")])
def test_a_misspelt_value_of_the_variable_is_reported_in_one_sentence(value: str, what: str):
    came = subprocess.run(
        [sys.executable, "-m", "periph_sim", "--version"],
        env={**os.environ, form.VARIABLE: value},
        capture_output=True,
        text=True,
        check=False,
    )
    if not what:
        assert came.returncode == 0 and "Error" not in came.stderr
        return
    assert (came.returncode, came.stdout) == (2, "")
    assert came.stderr == (
        f"Error: the environment variable PERIPH_SIM_FORM is {value!r}, but there is no such {what}; expected "
        "interpreted, compiled, hard (after `make core HARD=1`) or the folder of a build, as in build/mine/\n"
    )
