"""Profile and line coverage of an assembled program: where its time was spent, and which lines were executed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from periph_sim.processor.image_files.assemble import assemble_file
from tests.interfaces.commands.conftest import Run, periph_sim  # noqa: F401

# 1 ms at 7.5 MHz after reset is 7500 cycles. _work takes 104: RPT 1, NOP 99, LRETR 4, to an even
# address.
SOURCE = """\
WDCR .set 0x7029
 .reserve ".stack", 0x400, 0x40
 .sect ".text", 0x9000
 .global _c_int00, _work, _never
_c_int00: MOV @SP,#0x400
 EALLOW
 MOVW DP,#WDCR >> 6
 MOV @WDCR,#0x68
 EDIS
 MOVB XAR2,#9
 NOP
again: LCR #_work
 BANZ again,AR2--
 TBIT @AL,#0
 SB over,TC
 NOP
over: IDLE
 ESTOP0
_work: RPT #98 || NOP
 LRETR
_never: NOP
 LRETR
"""
CASE = 'name = "own"\nduration = "1 ms"\n[unit.dsp]\nimage = "own.out"\nmodules = ["GPIO"]\n'


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("own.asm").write_text(SOURCE)
    Path("own.out").write_bytes(assemble_file(Path("own.asm"))[1])
    Path("own.toml").write_text(CASE)
    return Path("own.toml")


def profile(periph_sim: Run, *more: str) -> dict[str, dict[str, float]]:  # noqa: F811
    result = periph_sim("profile", "own.toml", "--json", *more)
    assert result.status == 0, result.err
    return {one["function"]: one for one in json.loads(result.out)["units"]["dsp"]}


def test_time_is_counted_for_the_executing_function_and_waits_separately(periph_sim: Run, case: Path):  # noqa: F811
    found = profile(periph_sim)
    assert set(found) == {"_c_int00", "_work"}
    work, boot = found["_work"], found["_c_int00"]
    assert (work["calls"], boot["calls"]) == (10, 1)
    assert work["self_s"] == work["total_s"] == pytest.approx(10 * 104 / 7.5e6)
    assert boot["total_s"] == pytest.approx(1e-3)
    assert boot["self_s"] == pytest.approx(1e-3 - 10 * 104 / 7.5e6)
    assert work["waits_s"] == 0 and boot["waits_s"] > 0.8e-3
    assert (work["file"], work["line"], work["pc"]) == ("own.asm", 19, "0x009013")
    result = periph_sim("profile", "own.toml")
    assert "own.asm:19" in result.out and max(map(len, result.out.splitlines())) <= 80


def test_stacks_are_written_for_speedscope(periph_sim: Run, case: Path):  # noqa: F811
    profile(periph_sim, "--speedscope", "own.json")
    made = json.loads(Path("own.json").read_text())
    names = [frame["name"] for frame in made["shared"]["frames"]]
    (shown,) = made["profiles"]
    assert [[names[frame] for frame in stack] for stack in shown["samples"]] == [["_c_int00"], ["_c_int00", "_work"]]
    assert sum(shown["weights"]) == pytest.approx(1e-3)
    assert made["shared"]["frames"] == [
        {"name": "_c_int00", "file": "own.asm", "line": 5},
        {"name": "_work", "file": "own.asm", "line": 19},
    ]
    # https://www.speedscope.app/file-format-schema.json, FileFormat.File and FileFormat.SampledProfile
    assert set(made) == {"$schema", "name", "exporter", "activeProfileIndex", "shared", "profiles"}
    assert set(shown) == {"type", "name", "unit", "startValue", "endValue", "samples", "weights"}
    assert (shown["type"], shown["unit"], shown["startValue"]) == ("sampled", "seconds", 0)


def test_lines_functions_and_branches_are_written_as_lcov(periph_sim: Run, case: Path):  # noqa: F811
    profile(periph_sim, "--lcov", "own.info")
    report = Path("own.info").read_text().splitlines()
    lines = {number: text.split()[0] for number, text in enumerate(SOURCE.splitlines(), 1) if text.startswith(" ")}
    counts = dict(line[3:].split(",") for line in report if line.startswith("DA:"))
    assert counts["5"] == counts["11"] == "1"
    assert counts["12"] == counts["19"] == counts["20"] == "10"
    assert counts["21"] == counts["22"] == "0" and lines[22] == "LRETR"
    functions = [line for line in report if line.startswith(("FN:", "FNDA:"))]
    assert functions == [
        "FN:5,_c_int00",
        "FN:19,_work",
        "FN:21,_never",
        "FNDA:1,_c_int00",
        "FNDA:10,_work",
        "FNDA:0,_never",
    ]
    branches = {tuple(line[5:].split(",")[::2]): line.split(",")[3] for line in report if line.startswith("BRDA:")}
    assert branches == {("13", "0"): "1", ("13", "1"): "9", ("15", "0"): "1", ("15", "1"): "0"}
    assert report[:2] == ["TN:own", "SF:own.asm"] and report[-1] == "end_of_record"
    assert "BRF:4" in report and "BRH:3" in report


def test_a_unit_in_python_has_no_profile(periph_sim: Run, case: Path):  # noqa: F811
    case.write_text(CASE.replace('image = "own.out"', 'firmware = "responder"').replace('"GPIO"', '"I2C-A"'))
    result = periph_sim("profile", "own.toml")
    assert (result.status, result.out) == (2, "")
    assert "no unit runs an image, and a profile is of images" in result.err and result.err.count("\n") == 1


def test_an_image_without_lines_is_not_covered_and_leaves_no_file(periph_sim: Run, case: Path):  # noqa: F811
    from periph_sim.processor.image_files.assemble import assemble
    from periph_sim.processor.image_files.coff2 import write

    Path("own.out").write_bytes(write(assemble(SOURCE)))
    result = periph_sim("profile", "own.toml", "--lcov", "own.info")
    assert (result.status, result.out) == (2, "")
    assert "it tells no lines of its source" in result.err
    assert not Path("own.info").exists()


POLLS = """\
 .reserve ".stack", 0x400, 0x40
 .sect ".text", 0x9000
 .global _c_int00, _wait
_c_int00: MOV @SP,#0x400
 LCR #_wait
 ESTOP0
_wait: MOVW DP,#0x6FC0 >> 6
pass: TBIT @0x6FC0,#4
 SB pass,NTC
 LRETR
"""


@pytest.mark.parametrize("more", [(), ("--lcov", "own.info")])
def test_skipped_polls_are_waits_with_and_without_line_counts(
    periph_sim: Run,  # noqa: F811
    case: Path,
    more: tuple[str, ...],
):
    """The wait takes 1 ms except for a few passes of 10 cycles each before polls are skipped."""
    Path("own.asm").write_text(POLLS)
    Path("own.out").write_bytes(assemble_file(Path("own.asm"))[1])
    found = profile(periph_sim, *more)["_wait"]
    assert 0.97e-3 < found["waits_s"] < found["self_s"] < 1e-3


LOCKS = """\
 .sect ".text", 0x9000
 .global _c_int00
_c_int00: EALLOW
 MOVW DP,#0x7029 >> 6
 MOV @0x7029,#0x68
 MOVW DP,#0x7011 >> 6
 MOV @0x7021,#10
lock: TBIT @0x7011,#0
 SB lock,NTC
 ESTOP0
"""


def test_the_length_of_a_wait_is_correct_if_the_clock_changes_at_its_end(periph_sim: Run, case: Path):  # noqa: F811
    """The PLL locks after 131072 cycles of 30 MHz, 4.369 ms; then SYSCLKOUT is ten times as fast."""
    Path("own.asm").write_text(LOCKS)
    Path("own.out").write_bytes(assemble_file(Path("own.asm"))[1])
    found = profile(periph_sim, "--seconds", "0.005")["_c_int00"]
    assert 4.3e-3 < found["waits_s"] < 131_072 / 30e6
