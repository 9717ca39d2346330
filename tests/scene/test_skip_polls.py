"""`skip_polls = false` executes every pass of every wait: verdicts, figures and records are those of skipping."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING

CASES = {  # a round of each, or of what it does instead
    "imu_hil_image": ("0.0093",),
    "imu_hil": ("0.009", "host.first=1 ms", "controller.first=5 ms"),
    "imu_hil_robust": ("0.009", "unit.dsp.firmware=imu_hil_robust", "host.first=1 ms", "controller.first=5 ms"),
    "responder": ("0.006",),
    "captured_master": ("0.002",),
    "eeprom_log": ("0.008",),
    "uart_logger": ("0.004",),
}
COMPARED = (Kind.WAIT, Kind.FLAG, Kind.BUS, Kind.IRQ)


def run(path: Path, skip: bool, seconds: str, *changes: str) -> tuple[Result, list[Record], int]:
    """What came of it, its records in no order, and how many passes were skipped."""
    records: list[Record] = []
    skips = [f"unit.{unit}.skip_polls={str(skip).lower()}" for unit in load(path).unit]
    case = load(path, [f"duration={seconds} s", *changes, *skips])
    scene = Scene(case, lambda recorder, _: recorder.subscribe(COMPARED, records.append))
    result = scene.run()
    without_numbers = [record._replace(number=0, cause=0) for record in records]
    return result, sorted(without_numbers, key=str), sum(dsp.program.polls_skipped for dsp in scene.units.values())


@pytest.mark.parametrize("name", CASES)
def test_figures_and_records_are_those_of_skipping(name: str):
    seconds, *changes = CASES[name]
    path = TIMING / f"{name if (TIMING / f'{name}.toml').exists() else 'imu_hil'}.toml"
    (skipping, told, skipped), (executing, told_too, none) = (
        run(path, skip, seconds, *changes) for skip in (True, False)
    )
    assert skipped > 100 and none == 0
    assert (executing.budgets, executing.verdict) == (skipping.budgets, skipping.verdict)
    assert (executing.stuck, executing.notes, executing.wrong) == (skipping.stuck, skipping.notes, skipping.wrong)
    assert told_too == told and any(one.kind is Kind.WAIT for one in told)


HANGS: Mapping[str, tuple[str, str]] = {  # a wait for a byte that nobody sends
    "image": ("hangs.asm", """ .sect ".text", 0x9000
_c_int00: EALLOW
 MOVW DP,#0x7029 >> 6
 MOV @0x7029,#0x68
 MOVW DP,#0x7010 >> 6
 MOV @0x701C,#0x0400
 EDIS
 MOVW DP,#0x7050 >> 6
wait: TBIT @0x7055,#6
 SB wait,NTC
 ESTOP0
"""),
    "firmware": ("hangs.py", """def main(dsp, settings):
    dsp.spin(lambda: dsp.module("SCI-A").SCIRXST.RXRDY == 1)
"""),
}  # fmt: skip


@pytest.mark.parametrize("kind", HANGS)
def test_a_wait_that_nothing_can_end_is_stuck_either_way(kind: str, tmp_path: Path):
    name, source = HANGS[kind]
    (tmp_path / name).write_text(source, encoding="utf-8")
    case = tmp_path / "hangs.toml"
    case.write_text(
        f'name = "hangs"\nduration = "1 ms"\n[unit.dsp]\n{kind} = "{name}"\nmodules = ["SCI-A"]\n', encoding="utf-8"
    )
    skipping, executing = (run(case, skip, "0.001")[0] for skip in (True, False))
    assert (executing.stuck, executing.verdict) == (skipping.stuck, skipping.verdict)
    (sentence,) = skipping.stuck
    assert "waits for SCI-A.SCIRXST.RXRDY" in sentence and "would for ever" in sentence
    assert skipping.verdict == "fail"
