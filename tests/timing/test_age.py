"""The age of every read: of the frame whose values it has, also if no new frame was sent."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.time import NO_TIME
from periph_sim.devices.host_frames import host_frames
from periph_sim.imu.sensors import SENSORS as CHIPS
from periph_sim.timing.derived.origins import FrameOrigins, Origin
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.verdict import Verdict
from tests.scene.runs import Ran, run_file
from tests.timing.events_by_hand import ONE
from tests.timing.measures.hand_made_run import (
    ACCEL,
    GYRO,
    MAGNET,
    HandMadeRun,
    accel_bytes,
    gyro_bytes,
    magnet_bytes,
    read,
    wrote,
)
from tests.timing.test_occasions import never


def ages(run: HandMadeRun) -> list[tuple[int, int]]:
    """(age, tick) of each read, in order."""
    values, at = run.measure.all_kept()
    return list(zip(values.tolist(), at.tolist(), strict=True))


def kept(name: str = "age") -> HandMadeRun:
    run = HandMadeRun(name)
    run.measure.keep()
    return run


def test_every_read_has_the_age_of_the_frame_whose_values_it_has():
    run = kept()
    run.frame(1, 1000)
    run.transfer(read(GYRO, gyro_bytes(1), at=1700))
    run.transfer(read(GYRO, gyro_bytes(1), at=3700))  # the same values again: older
    run.frame(2, 4000)
    run.transfer(read(ACCEL, accel_bytes(2), at=4100))
    run.transfer(read(GYRO, gyro_bytes(1), at=4200))  # not yet the new frame
    run.transfer(read(MAGNET, magnet_bytes(2), at=4300))
    assert ages(run) == [(700, 1700), (2700, 3700), (100, 4100), (3200, 4200), (300, 4300)]


def test_values_of_no_frame_have_the_age_of_the_last_valid_ones():
    run = kept()
    run.frame(1, 1000)
    run.transfer(read(GYRO, gyro_bytes(1), at=1700))
    run.frame(2, 4000)
    run.transfer(read(GYRO, gyro_bytes(77), at=4200))  # values of no frame
    run.transfer(read(GYRO, gyro_bytes(2)[:4] + gyro_bytes(1)[4:], at=4300))  # mixed from two frames
    run.transfer(read(GYRO, gyro_bytes(2), at=4400))
    assert ages(run) == [(700, 1700), (3200, 4200), (3300, 4300), (400, 4400)]


def test_before_a_chip_has_shown_a_frame_its_age_is_that_of_the_first_frame():
    run = kept()
    run.transfer(read(GYRO, bytes(6), at=500))  # before the first frame there is no age
    run.frame(1, 1000)
    run.transfer(read(GYRO, bytes(6), at=1100))
    run.frame(2, 2000)
    run.transfer(read(GYRO, bytes(6), at=2100))
    assert ages(run) == [(100, 1100), (1100, 2100)]
    assert run.measure.occasions == 2


def test_a_read_can_begin_at_the_tick_at_which_the_first_frame_ends():
    run = kept()
    run.transfer(read(GYRO, bytes(6), at=0))
    run.frame(1, 1000)
    run.transfer(read(GYRO, gyro_bytes(1), at=999))
    run.transfer(read(GYRO, gyro_bytes(1), at=1000))
    run.transfer(read(GYRO, gyro_bytes(1), at=1001))
    assert ages(run) == [(0, 1000), (1, 1001)] and run.measure.occasions == 2


def test_a_refused_read_has_no_age_but_is_an_occasion():
    run = kept()
    run.frame(1, 1000)
    run.transfer(read(GYRO, gyro_bytes(1), at=1700))
    run.transfer(wrote(GYRO, at=2000, acked=False), never(GYRO))
    run.transfer(read(ACCEL, at=3000))  # acknowledged, but without a byte
    assert (run.measure.measured, run.measure.occasions) == (1, 3)


def test_the_age_of_a_chip_includes_only_its_reads():
    run = HandMadeRun(measure_named("age of magnetometer", ONE))
    run.measure.keep()
    run.frame(1, 1000)
    run.transfer(read(GYRO, gyro_bytes(1), at=1700))
    run.transfer(read(MAGNET, magnet_bytes(1), at=1900))
    assert ages(run) == [(900, 1900)]


@given(st.lists(st.tuples(st.sampled_from(["frame", "read"]), st.integers(0, 7)), max_size=40))
@settings(max_examples=200)
def test_an_age_decreases_only_with_a_newer_frame(happened: list[tuple[str, int]]):
    """The expected age is computed from the end of the newest frame shown so far that the bytes agree with."""
    run = kept()
    ended: dict[int, int] = {}
    shown = first = None
    wanted = []
    for step, (what, back) in enumerate(happened):
        now = 100 * step
        if what == "frame":
            number = 1 + len(ended)
            ended[number] = now
            first = now if first is None else first
            run.frame(number, now)
            continue
        number = max(0, len(ended) - back)  # 0: zeros, which belong to no frame
        run.transfer(read(GYRO, gyro_bytes(number) if number else bytes(6), at=now))
        if first is not None:
            shown = ended.get(number, shown) if number > len(ended) - 8 else shown
            wanted.append((now - (first if shown is None else shown), now))
    assert ages(run) == wanted


# The published emulator -------------------------------------------------------------------------------------------


def age_of(*changes: str, seconds: str = "0.5", limit: str = "25 ms") -> tuple[Ran, Verdict]:
    ran = run_file("imu_hil_published", seconds, f'budget=[{{name="a", measure="age", max="{limit}"}}]', *changes)
    return ran, ran.result.budgets[0]


@pytest.mark.parametrize("frames", [0, 1, 3, 4, 20])
def test_a_host_that_stops_sending_fails_the_budget(frames: int):
    ran, age = age_of(f"host.frames={frames}")
    assert ran.result.verdict == "fail" and not age.passed
    assert (age.verdict == "fail") == (frames > 0)


@pytest.mark.parametrize("place", [0, 5, 11])
def test_a_lost_byte_without_recovery_fails_the_budget(place: int):
    _, age = age_of(f"host.lose=[[3, {place}]]")
    assert age.broken and age.count == age.occasions == 75
    assert age.worst > 400_000


def test_every_read_of_every_chip_is_measured():
    ran, age = age_of()
    known = {chip.address for chip in CHIPS.values()}
    reads = [p for t in ran.transfers for p in t.phases if p.read and p.address in known]
    assert age.passed and age.count == len(reads) == 75


@pytest.mark.parametrize("period", ["2.5 ms", "1.1 ms"])
def test_correct_firmware_passes_with_many_frames_per_round(period: str):
    """Models run once per round of 20 ms, on the newest frame. 8 or 18 more frames follow before values are read."""
    ran = run_file("imu_hil_published", "0.2", f"host.period={period}")
    verdicts = {verdict.name: verdict for verdict in ran.result.budgets}
    assert (verdicts["wrong bytes"].worst, verdicts["wrong bytes"].count) == (0, 180)
    age = verdicts["data age"].worst
    assert 17_000 < age < 25_000  # from the frame before the models to the next round


def test_chips_that_remain_at_zero_are_not_judged_and_the_age_of_their_data_grows():
    ran = run_file("imu_hil_published", "0.4", "unit.dsp.settings.table={'0x68'='00 00 00 00 00 00'}")
    verdicts = {verdict.name: verdict for verdict in ran.result.budgets}
    assert verdicts["wrong bytes"].verdict == "not judged"
    assert "read as 0 from chips that never showed a host frame's values" in verdicts["wrong bytes"].found
    assert verdicts["data age"].verdict == "fail"


class NotAllCompared(FrameOrigins):
    """Origins that have left out the frames to which the bytes ff ff ... could belong."""

    def origin(self, address: int, got: bytes) -> Origin:
        return Origin(None, NO_TIME, bytes(6), judged=False) if got[0] == 0xFF else super().origin(address, got)


def test_a_read_not_compared_with_all_frames_has_no_age_and_no_wrong_bytes():
    run = HandMadeRun("age", origins=NotAllCompared(host_frames()))
    run.measure.keep()
    wrong = HandMadeRun("wrong bytes", origins=NotAllCompared(host_frames()))
    for each in (run, wrong):
        each.frame(1, 1000)
        each.transfer(read(GYRO, gyro_bytes(1), at=1700))
        assert not each.measure.not_judged
        each.transfer(read(GYRO, bytes([0xFF] * 6), at=4200))
        each.finish(5000)
    assert ages(run) == [(700, 1700)]
    assert run.measure.not_judged == "1 read may carry frames that were not compared with them"
    assert (wrong.measure.worst, wrong.measure.count) == (0, 6)
    assert wrong.measure.not_judged == "6 bytes may be of frames that were not compared with them"
