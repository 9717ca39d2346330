"""`periph-sim compliance`: exit status, table, JSON and error messages."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.compliance import check
from tests.interfaces.commands.conftest import Run
from tests.unwrapped import unwrapped

ROOT = Path(__file__).parents[3]
IMU_ROUND = str(ROOT / "traces" / "imu_round.sr")
HOST_FRAMES = str(ROOT / "traces" / "host_frames.sr")


def test_an_undecidable_rule_has_status_0_unless_strict(periph_sim: Run):
    """Periods of 10 us sampled at 4 MHz: an uncertainty of 0.25 us is too large to judge 100 kHz."""
    out = periph_sim.passes("compliance", IMU_ROUND, "--mode", "standard")
    assert out.splitlines()[-1].startswith("UNDECIDABLE at this sample rate: fSCL; ")
    assert "undecidable, 243 of 243" in out and "each time good to 250 ns either way" in out
    assert periph_sim("compliance", IMU_ROUND, "--mode", "standard", "--strict").status == 1


def test_a_bus_too_fast_fails(periph_sim: Run):
    """At --rate 16 MHz, four times the true sample rate, SCL runs at 400 kHz."""
    result = periph_sim("compliance", IMU_ROUND, "--mode", "standard", "--rate", "16 MHz")
    assert result.status == 1 and result.out.splitlines()[-1].startswith("FAIL: fSCL, ")


def test_json_is_one_object(periph_sim: Run):
    _, found = periph_sim.json("compliance", IMU_ROUND, "--mode", "fast", "--map", "scl=0,sda=1")
    assert (found["mode"], found["verdict"], len(found["rows"])) == ("fast", "undecidable at this sample rate", 14)


def test_a_recorded_run_is_judged_exactly(periph_sim: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A controller at exactly 100 kHz is at the limit and passes; at 105 kHz it fails."""
    monkeypatch.chdir(ROOT)
    case, path = "timing/responder.toml", str(tmp_path / "run.psr")
    assert periph_sim("run", case, "--seconds", "10 ms", "--record", path).status == 0
    assert periph_sim.passes("compliance", path, "--mode", "standard", "--strict").splitlines()[-1] == "PASS"
    periph_sim("run", case, "--seconds", "10 ms", "--record", path, "--set", "controller.rate=105 kHz")
    result = periph_sim("compliance", path, "--mode", "standard")
    assert result.status == 1 and result.out.splitlines()[-1] == "FAIL: fSCL"


@pytest.mark.parametrize("mode", ["standard", "fast"])
def test_a_start_alone_measures_nothing_and_is_status_1(periph_sim: Run, tmp_path: Path, mode: str):
    csv = tmp_path / "start.csv"
    csv.write_text("Time [s],SCL,SDA\n0.000000000,1,1\n0.000100000,1,0\n0.000200000,1,0\n")
    result = periph_sim("compliance", str(csv), "--mode", mode)
    assert (result.status, result.out.splitlines()[-1]) == (1, "NOT JUDGED: nothing was measured")
    found = periph_sim("compliance", str(csv), "--mode", mode, "--json").json_object
    assert found["verdict"] == "not judged: nothing was measured"
    with pytest.raises(AssertionError, match="no time of the I2C limits was measured"):
        check(formats.read(csv), "SCL", "SDA", mode).assert_compliant()


def test_the_uncertainty_of_time_stamps_is_their_grid(periph_sim: Run, tmp_path: Path):
    edges = "#0 1! 1'\n#8 0'\n#5008 0!\n#10008 1!\n#15016 1'\n#15040\n"
    vcd = tmp_path / "stamps.vcd"
    vcd.write_text(f"$timescale 1 ns $end $var wire 1 ! SCL $end $var wire 1 ' SDA $end $enddefinitions $end\n{edges}")
    result = periph_sim("compliance", str(vcd), "--mode", "standard")
    assert "each time good to 8 ns either way" in result.out
    assert "all its edges are multiples of 8 ns apart" in unwrapped(result.out)
    assert "times exact" in periph_sim("compliance", str(vcd), "--mode", "standard", "--exact").out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([IMU_ROUND], "Missing option '--mode'"),
        ([IMU_ROUND, "--mode", "quick"], "'quick' is not one of 'standard', 'fast', 'fast-plus'"),
        (
            [IMU_ROUND, "--mode", "fast", "--map", "scl=0,sda=7"],
            "there is no channel '7'; it has SCL, SDA",
        ),
        ([IMU_ROUND, "--mode", "fast", "--map", "scl=0"], "expected scl and sda"),
        ([IMU_ROUND, "--mode", "fast", "--rate", "quick"], "--rate: 'quick' is no sample rate"),
        ([IMU_ROUND, "--mode", "fast", "--exact"], "samples of an analyser, so --exact cannot be true"),
        ([HOST_FRAMES, "--mode", "fast"], "the limits are those of I2C; map it with --map scl=...,sda=..."),
        (["none.sr", "--mode", "fast"], "none.sr, the file: found no such file or directory"),
    ],
)
def test_bad_input_is_one_error_message_with_status_2(periph_sim: Run, arguments: list[str], message: str):
    assert message in periph_sim.refused("compliance", *arguments)


def test_lines_without_a_start_are_refused(periph_sim: Run, tmp_path: Path):
    csv = tmp_path / "quiet.csv"
    csv.write_text("Time [s],SCL,SDA\n0.000000000,1,1\n0.000010000,0,1\n0.000020000,0,1\n")
    message = periph_sim.refused("compliance", str(csv), "--mode", "fast")
    assert "no I2C START on 'SCL' and 'SDA'; 'SDA' does not change in the capture" in message
    csv.write_text("Time [s],SCL,SDA\n0.000000000,1,1\n0.000010000,0,1\n0.000020000,0,0\n")
    assert "no I2C START on 'SCL' and 'SDA'; the lines may be swapped" in periph_sim.refused(
        "compliance", str(csv), "--mode", "fast"
    )
