"""Selection of the tests that run in both forms, and their run."""

from __future__ import annotations

from periph_sim.form import PACKAGE
from periph_sim.form.sources import Sources
from tests.interpreted import TESTS, folders, left_out, main


def test_folders_of_tests_correspond_to_packages_and_are_named_once() -> None:
    assert folders(["bus.i2c.monitor", "core.fifo", "core.time", "f28335.i2c.slave"]) == [
        "tests/bus/i2c",
        "tests/core",
        "tests/f28335/i2c",
    ]
    assert folders(["f28335.i2c.slave", "f28335.gpio.module", "f28335.pins"]) == ["tests/f28335"]


def test_a_package_without_tests_is_tested_by_the_one_above_it() -> None:
    assert not (TESTS / "processor" / "python").exists()
    assert folders(["processor.python.loop"]) == ["tests/processor"]


def test_packages_without_compiled_modules_are_left_out() -> None:
    assert left_out(["outside.session"]) == ["tests/outside/drivers", "tests/outside/live"]
    assert left_out(["outside.session", "outside.live.view.status"]) == ["tests/outside/drivers"]
    assert left_out(["processor.image.cpu"]) == []


def test_each_compiled_module_has_tests_in_these_folders() -> None:
    modules = Sources(PACKAGE).compiled()
    found = folders(modules)
    assert found and all((TESTS.parent / one).is_dir() for one in found)
    assert [m for m in modules if not any(f"tests/{m.replace('.', '/')}".startswith(f"{one}/") for one in found)] == []
    assert [m for m in modules if f"tests/{m.replace('.', '/')}".startswith((*left_out(modules), "nowhere"))] == []


def test_without_a_compiled_core_nothing_runs_again(monkeypatch, tmp_path, capsys) -> None:
    monkeypatch.setattr("periph_sim.form.BUILT", tmp_path)
    assert main(["--no-such-option"]) == 0
    assert capsys.readouterr().out == "no core is compiled of these sources, so there is nothing to run again\n"


def test_the_tests_run_interpreted_and_their_exit_status_is_returned(monkeypatch) -> None:
    started = []

    def run(command, env, check):
        started.append((command[2:], env["PERIPH_SIM_FORM"]))
        return type("Done", (), {"returncode": 5})

    monkeypatch.setattr("tests.interpreted.form.usable", lambda package, built: (["core.fifo"], ""))
    monkeypatch.setattr("tests.interpreted.subprocess.run", run)
    assert main(["-n", "2"]) == 5
    assert started == [(["pytest", "-n", "2", "tests/core"], "interpreted")]
