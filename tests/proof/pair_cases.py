"""Small cases whose rounds and frames start independently.

`write_lonely`: the emulator of firmware/c28x/imu_hil.asm has another address than the one to which the sensor head
sends requests. So the firmware waits during the whole round, and the table has few groups. Its service routine drops
the frame, which is faster than reading it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pytest

from periph_sim.proof import pair_table
from periph_sim.proof.calls import call_here
from periph_sim.proof.pair_groups import Sleep
from periph_sim.proof.pair_run import Task
from periph_sim.proof.pair_table import Cell, PairMaker
from periph_sim.proof.stretch import CoveredCase, Job
from periph_sim.proof.table_cases import check
from tests.scene.runs import TIMING

FIRMWARE = TIMING.parent / "firmware" / "c28x"
LONELY = """
name = "lonely"
start = "3 ms"
duration = "200 ms"

[unit.dsp]
oscclk = "20 MHz"
image = "imu.asm"
modules = ["I2C-A", "SCI-A", "GPIO"]

[controller]
rate = "400 kHz"
first = "12 ms"
period = "20 ms"
order = ["gyroscope"]

[host]
baud = 1562500
first = "9 ms"
period = "20 ms"
motion = {{ kind = "static" }}

[[budget]]
name = "latency"
measure = "interrupt latency SCIRXINTA"
max = "{limit} us"

[[budget]]
name = "service"
measure = "each time in interrupt SCIRXINTA"
max = "2 us"

[[budget]]
name = "age"
measure = "age"
max = "50 ms"

[[budget]]
name = "line"
measure = "from edge RX fall to interrupt SCIRXINTA enter"
max = "2 ms"
"""
OTHER_ADDRESS = ("GYROSCOPE     .set 0x68", "GYROSCOPE     .set 0x6B")
TAKES = """          MOV   @AR0,#FRAME_BYTES - 1
take:     MOV   AL,@SCIRXBUF
          ANDB  AL,#0xFF
          MOV   *XAR4++,AL
          BANZ  take,AR0--
          OR    @SCIFFRX,#0x4000  ; RXFFOVRCLR
          OR    @SCIFFRX,#0x0040  ; RXFFINTCLR
"""
DROPS = """          MOV   @SCIFFRX,#0x4020 | FRAME_BYTES  ; resets the FIFO
          MOV   @SCIFFRX,#0x6060 | FRAME_BYTES
"""
FAST = ("BRR           .set 40 ", "BRR           .set 1 ")  # a sample of the line each 8 cycles


def write_lonely(folder: Path, *changes: tuple[str, str], limit: float = 0.5) -> Path:
    """Write the case and its firmware, and return the path of the case.

    changes: replacements in the firmware. limit: the limit of the latency, in us.
    """
    return write_pair(folder, LONELY.format(limit=limit), OTHER_ADDRESS, FAST, *changes, (TAKES, DROPS))


def write_pair(folder: Path, text: str, *changes: tuple[str, str]) -> Path:
    for name in ("f28335.inc", "start.inc"):
        (folder / name).write_bytes((FIRMWARE / name).read_bytes())
    firmware = (FIRMWARE / "imu_hil.asm").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in firmware, old
        firmware = firmware.replace(old, new)
    (folder / "imu.asm").write_text(firmware, encoding="utf-8")
    case = folder / "pair.toml"
    case.write_text(text, encoding="utf-8")
    return case


def maker_of(
    job: Job, least_again: int = 200, on_estimate: Callable[[int, float], None] = lambda *_: None
) -> PairMaker:
    """Return the maker of a table whose rounds start with cycles of the CPU. All its runs are made in this process."""
    covered = CoveredCase(job)
    ignored = check(covered.case, with_pairs=True)
    return PairMaker(covered, job, ignored, lambda _: None, on_estimate, call_here, least_again, any_tick=False)


def keep_a_tenth(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the meetings in which the round does not start at tick 0 of an orbit: nine of ten in `write_lonely`.

    For tests that need a table of any size. tests/proof/test_pair_table.py makes a whole one.
    """
    all_tasks = PairMaker.tasks

    def some(maker: PairMaker, number: int, waits: Mapping[int, Sequence[Sleep]]) -> tuple[list[Task], list[Cell]]:
        tasks, cells = all_tasks(maker, number, waits)
        return [task for task in tasks if task.group.round == 0], [cell for cell in cells if cell.round == 0]

    monkeypatch.setattr(PairMaker, "tasks", some)
    monkeypatch.setattr(pair_table, "TIMED", 20)
