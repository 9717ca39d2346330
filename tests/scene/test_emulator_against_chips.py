"""Differences between the emulating F28335 and the three real chips: none in the controller's own rounds.

The emulator is imu_hil_published.toml, and the chips are imu_chips.toml. Both have the values of the same frames. Other
requests than those of the rounds are answered differently.
"""

from __future__ import annotations

from functools import cache

import pytest

from periph_sim.scene.case.load import load
from periph_sim.traces.decode import i2c
from tests.scene.runs import TIMING, Edges, Ran, run_case, run_file

pytestmark = pytest.mark.long

EMULATOR, CHIPS = "imu_hil_published", "imu_chips"


def both(*changes: str) -> tuple[Ran, Ran]:
    return run_file(EMULATOR, "0.1", *changes), run_file(CHIPS, "0.1", *changes)


def requests(*tables: str) -> tuple[str, str]:
    return "controller.order=[]", f"controller.request=[{', '.join(tables)}]"


def in_seconds(run: Ran) -> list[tuple[float, ...]]:
    """Return the times that a controller can measure: START, end of the address, first bit of data, STOP, stretch."""
    second = run.scene.timebase.per_second
    return [
        tuple(tick / second for tick in (p.start_at, p.answer_from, p.answer_at, t.stop_at, p.stretch) if tick >= 0)
        for transfers in run.rounds
        for t in transfers
        for p in t.phases
    ]


@pytest.mark.parametrize("rate", ["100 kHz", "400 kHz"])
def test_in_200_rounds_all_bytes_and_all_times_of_the_controller_are_the_same(rate: str):
    change = f"controller.rate={rate}"
    emulator, chips = run_file(EMULATOR, "4", change), run_file(CHIPS, "4", change)
    assert len(chips.rounds) == 200
    assert emulator.read() == chips.read()
    assert in_seconds(emulator) == in_seconds(chips)
    assert len({tuple(round_) for round_ in chips.read()}) >= 199, "the data vary"
    assert [set(run.answered()) for run in (emulator, chips)] == [{"GAM"}] * 2


@cache
def sda_delays(name: str) -> set[float]:
    """Return the delays from the fall of SCL to a change of SDA by the target, in ns, in the data bits of reads."""
    edges = Edges()
    run = run_case(load(TIMING / f"{name}.toml"), "0.2", edges.subscribe)
    per_ns = run.scene.timebase.per_second // 10**9
    found = set()
    for transfer in i2c.transfers(edges.capture(run.scene.kernel.now + 1)):
        for byte in (byte for phase in transfer.phases if phase.read for byte in phase.bytes[1:]):
            for bit in byte.bits[1:8]:
                if bit.sda is not None and bit.low is not None:
                    found.add((bit.sda - (bit.at - bit.low)) / per_ns)
    return found


def test_changes_of_sda_differ_only_in_time_within_the_low_phase_of_scl():
    """Both change SDA within the low phase of a bit, so a controller samples the same levels."""
    assert sda_delays(CHIPS) == {300}
    emulated = sda_delays(EMULATOR)
    assert min(emulated) > 0 and max(emulated) < 1000 and emulated != {300}


def test_identification_registers_differ():
    """The emulator sends its data whatever the pointer is."""
    ask = requests(
        "{address=0x68, pointer=0, count=1}", "{address=0x53, pointer=0, count=1}", "{address=0x1e, pointer=10}"
    )
    emulator, chips = both(*ask)
    assert [r[:2] for r in chips.read()] == [["68", "e5"]] * 5
    assert chips.read()[0][2].startswith("48 34 33")
    assert emulator.read()[1] == ["00", "0c", "00 01 f8 30 03 e8"]


def test_data_from_another_pointer_differ():
    """In a burst that begins at the temperature, the rates are two bytes later."""
    ask = requests("{address=0x68, pointer=0x1b, count=8}", '{chip="accelerometer"}', '{chip="magnetometer"}')
    emulator, chips = both(*ask)
    assert chips.read()[1][0] == "c1 80 00 01 03 e8 f8 30"
    assert emulator.read()[1][0] == "00 01 03 e8 f8 30 00 00"
    assert chips.read()[1][1:] == emulator.read()[1][1:]


def test_bytes_after_the_sixth_differ():
    """The HMC5883L returns to x and sets LOCK again, so its data do not change. The emulator sends zeros."""
    ask = requests('{chip="gyroscope"}', '{chip="accelerometer"}', "{address=0x1e, pointer=3, count=7}")
    emulator, chips = both(*ask)
    assert emulator.read()[1][2] == "00 01 f8 30 03 e8 00"
    first, *later = [round_[2] for round_ in chips.read()]
    assert set(later) == {first}


def test_answers_to_another_order_differ():
    emulator, chips = both('controller.order=["accelerometer", "gyroscope", "magnetometer"]')
    assert chips.answered() == ["AGM"] * 5
    assert emulator.answered()[:2] == ["-G-", "A-M"]


def test_answers_after_a_stop_between_pointer_and_read_differ():
    """The chips keep their pointer. The emulator takes the STOP after the pointer for the end of the request."""
    emulator, chips = both("controller.pointer_by=STOP")
    assert chips.answered() == ["GGAAMM"] * 5 and "00 01 03 e8 f8 30" in chips.read()[1]
    assert emulator.answered() == ["G-A-MM"] * 5
    assert max(p.stretch for r in emulator.rounds for t in r for p in t.phases) > 0
    assert max(p.stretch for r in chips.rounds for t in r for p in t.phases) == 0


@pytest.mark.parametrize(
    ("request_", "register"),
    [
        ('{address=0x68, pointer=0x15, count=0, write="07"}', "I2C-A.I2CSTR.SDIR"),  # a driver's set-up
        ("{address=0x68, count=6}", "I2C-A.I2CSTR.RRDY"),  # a read without a pointer
    ],
)
def test_a_write_or_a_read_without_pointer_hangs_the_emulator(request_: str, register: str):
    ask = requests(request_, '{chip="gyroscope"}')
    emulator, chips = both(*ask)
    assert set(chips.answered()) == {"0G"}
    assert emulator.result.counts["rounds"] == 0 and emulator.result.counts["stuck"] == 1
    assert register in emulator.result.stuck[0] and "SCL is held low by dsp.GPIO33" in emulator.result.stuck[0]
