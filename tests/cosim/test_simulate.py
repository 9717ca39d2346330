"""What is missing, a source that is not there or does not compile: each is told as such."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.cosim import OutsideError, simulate
from periph_sim.cosim.simulate import missing


def test_a_simulator_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cocotb_tools")
    monkeypatch.setenv("PATH", "/nowhere")
    assert missing() == "iverilog, vvp is not on the path; install the simulator icarus"
    assert missing("spice").startswith("simulator 'spice' is unknown; it is one of icarus, verilator")
    with pytest.raises(OutsideError, match="iverilog, vvp is not on the path"):
        simulate(["bus.v"], "bus", "test_bus", folder="nowhere")


def test_sources_that_are_not_there_or_wrong(tmp_path: Path) -> None:
    if missing():
        pytest.skip(missing())
    with pytest.raises(OutsideError, match=r"nowhere.v: the source file does not exist"):
        simulate(["nowhere.v"], "bus", "test_bus", folder=tmp_path)
    source = tmp_path / "wrong.v"
    source.write_text("module bus; wire wire; endmodule\n")
    with pytest.raises(OutsideError, match="bus was not built by icarus"):
        simulate([source], "bus", "test_bus", folder=tmp_path)
