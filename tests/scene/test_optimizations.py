"""Every shipped case gives the same records and results whichever optimizations are off.

A skipped read of a wait leaves no record of its access, so records of reads are compared only with polls on.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from periph_sim import Result, load
from periph_sim.core.records import Kind, Record
from periph_sim.scene.case.optimizations import ALL, BITS, DECODING, OPTIMIZATIONS, POLLS
from periph_sim.scene.plan import ScenePlan
from tests.scene.runs import TIMING, recorded
from tests.scene.test_bit_skip import BUT_EDGES, Disable, figures, run

# The cases of timing/trade act in the middle of bytes and frames: resets, clock gates, spikes, reads of pads.
CASES = sorted(str(path.relative_to(TIMING))[:-5] for path in (*TIMING.glob("*.toml"), *TIMING.glob("trade/*.toml")))
IMAGES = ("imu_hil_image",)


# Each poll is executed, so the first frame and the first round are early if the firmware is ready and needs no set-up.
EARLY = {"host": "host.first=0.3 ms", "controller": "controller.first=1 ms"}
UNCHANGED = {"imu_hil_image": "0.0115", "imu_hil_c": "0.0055", "real_chips": "0.011"}


def seconds_of(name: str) -> str:
    return "0.0077" if name == "imu_hil_c" else "0.05"  # each poll of C sources is executed


def without_reads(records: list[Record]) -> list[tuple[object, ...]]:
    """Return the records except reads, without their numbers and causes."""
    return [
        record._replace(number=0, cause=0)
        for record in records
        if record.kind is not Kind.ACCESS or not record.what.startswith("R ")
    ]


@pytest.mark.parametrize("disable", [(BITS,), (DECODING,)], ids=["bits", "decoding"])
@pytest.mark.parametrize("name", CASES)
def test_every_case_gives_the_same_records_without_optimizations(name: str, disable: Disable):
    if DECODING in disable and name not in IMAGES:
        pytest.skip("it runs no image")
    case = load(TIMING / f"{name}.toml")
    default, plain = (run(case, names, BUT_EDGES, seconds_of(name)) for names in ((), disable))
    assert figures(default[0]) == figures(plain[0])
    assert default[1] == plain[1] and len(plain[1]) > 20


@pytest.mark.parametrize("name", CASES)
def test_every_case_gives_the_same_records_except_reads_without_any_optimization(name: str):
    path = TIMING / f"{name}.toml"
    changes = [change for part, change in EARLY.items() if name not in UNCHANGED and getattr(load(path), part)]
    case, seconds = load(path, changes), UNCHANGED.get(name, "0.0045")
    default, plain = (run(case, names, BUT_EDGES, seconds) for names in ((), (ALL,)))
    results = [figures(one[0]) for one in (default, plain)]
    counts = [one["counts"].pop("polls_skipped") for one in results]
    assert results[0] == results[1]
    assert counts[1] == 0
    assert without_reads(default[1]) == without_reads(plain[1]) and len(plain[1]) > 20


def is_on(name: str, disable: tuple[str, ...]) -> bool:
    case = load(TIMING / "responder.toml").model_copy(update={"disable": disable})
    return ScenePlan(case).ticks.optimizes(name)


def test_each_name_switches_off_one_optimization():
    for name in OPTIMIZATIONS:
        assert not is_on(name, (name,)) and not is_on(name, (ALL,)) and is_on(name, ())
        assert all(is_on(other, (name,)) for other in OPTIMIZATIONS if other != name)


def test_a_run_without_optimizations_executes_each_edge_and_each_poll():
    case = load(TIMING / "responder.toml")
    results = [run(case, disable, (), "0.011")[0] for disable in ((), (BITS,), (POLLS,), (ALL,))]
    default, bits, polls, everything = (result.events for result in results)
    assert default < bits < everything and default < polls < everything
    assert results[3].bytes_skipped == results[3].counts["polls_skipped"] == 0


WAITING = {  # changes so that each runs one round, or one unit of its work
    "imu_hil_image": ("0.0093",),
    "imu_hil": ("0.009", "host.first=1 ms", "controller.first=5 ms"),
    "imu_hil_robust": ("0.009", "unit.dsp.firmware=imu_hil_robust", "host.first=1 ms", "controller.first=5 ms"),
    "responder": ("0.006",),
    "captured_master": ("0.002",),
    "eeprom_log": ("0.008",),
    "uart_logger": ("0.004",),
}
COMPARED = (Kind.WAIT, Kind.FLAG, Kind.BUS, Kind.IRQ)


def run_polled(path: Path, skip: bool, seconds: str, *changes: str) -> tuple[Result, list[Record], int]:
    """Return the result, the records without their order, and the number of skipped passes."""
    skips = [f"unit.{unit}.skip_polls={str(skip).lower()}" for unit in load(path).unit]
    case = load(path, [f"duration={seconds} s", *changes, *skips])
    scene, records = recorded(case, COMPARED)
    result = scene.run()
    without_numbers = [record._replace(number=0, cause=0) for record in records]
    return result, sorted(without_numbers, key=str), sum(dsp.program.polls_skipped for dsp in scene.units.values())


@pytest.mark.parametrize("name", WAITING)
def test_results_and_records_without_skipped_polls_are_those_with_them(name: str):
    seconds, *changes = WAITING[name]
    path = TIMING / f"{name if (TIMING / f'{name}.toml').exists() else 'imu_hil'}.toml"
    (skipping, records, skipped), (executing, other_records, none) = (
        run_polled(path, skip, seconds, *changes) for skip in (True, False)
    )
    assert skipped > 100 and none == 0
    assert (executing.budgets, executing.verdict) == (skipping.budgets, skipping.verdict)
    assert (executing.stuck, executing.notes, executing.wrong) == (skipping.stuck, skipping.notes, skipping.wrong)
    assert other_records == records and any(one.kind is Kind.WAIT for one in records)


HANGS: Mapping[str, tuple[str, str]] = {  # a wait for a byte that is never sent
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
def test_a_wait_that_nothing_can_end_is_stuck_with_and_without_skipping(kind: str, tmp_path: Path):
    name, source = HANGS[kind]
    (tmp_path / name).write_text(source, encoding="utf-8")
    case = tmp_path / "hangs.toml"
    case.write_text(
        f'name = "hangs"\nduration = "1 ms"\n[unit.dsp]\n{kind} = "{name}"\nmodules = ["SCI-A"]\n', encoding="utf-8"
    )
    skipping, executing = (run_polled(case, skip, "0.001")[0] for skip in (True, False))
    assert (executing.stuck, executing.verdict) == (skipping.stuck, skipping.verdict)
    (sentence,) = skipping.stuck
    assert "waits for SCI-A.SCIRXST.RXRDY" in sentence and "would for ever" in sentence
    assert skipping.verdict == "fail"
