"""Frames of the host PC: their contents and times, and frames that are late or not sent."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import pytest

from periph_sim.bus.uart.sender import UartSender
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire
from periph_sim.devices.host_pc import Host, HostSchedule, PacedBy
from periph_sim.imu.host_frames import FRAME_BYTES, encode, ramp

BIT = 10
FRAME = FRAME_BYTES * 10 * BIT  # ticks


class HostRig:
    def __init__(self, schedule: HostSchedule, seed: int = 0) -> None:
        self.kernel = Kernel()
        recorder = Recorder()
        self.falls: list[int] = []
        wire = Wire(self.kernel, "RX", recorder)
        watch([wire], lambda tick, level: self.falls.append(tick) if not level else None)
        self.sender = UartSender(self.kernel, recorder, wire, Fraction(BIT))
        self.host = Host(self.kernel, self.sender, schedule, ramp, encode, seed)
        self.sent: list[tuple[int, tuple[int, ...], int]] = []
        self.host.sent.append(lambda number, values, tick: self.sent.append((number, values, tick)))

    def run(self, ticks: int) -> list[tuple[int, tuple[int, ...], int]]:
        self.kernel.run_until(self.kernel.now + ticks)
        return self.sent


def test_a_frame_is_six_values_low_byte_first():
    assert encode((1, -2, 0x1234, -0x8000, 0x7FFF, 0)) == bytes.fromhex("0100 feff 3412 0080 ff7f 0000")


def test_a_value_beyond_16_bits_is_rejected():
    with pytest.raises(OverflowError):
        encode((0x8000, 0, 0, 0, 0, 0))


def test_all_frames_of_twenty_minutes_are_different_and_valid():
    frames = [ramp(n) for n in range(60_000)]
    assert len(set(frames)) == len(frames)
    assert len({f[0:3] for f in frames}) == len(frames)
    assert all(len(encode(f)) == FRAME_BYTES for f in frames[::997])


def test_frames_are_sent_every_period_and_reported_at_the_end_of_their_last_stop_bit():
    rig = HostRig(HostSchedule(first=500, period=2000, frames=3))
    assert rig.run(20_000) == [(n, ramp(n), 500 + 2000 * n + FRAME) for n in range(3)]
    assert (rig.host.frames, rig.host.bytes, rig.host.late) == (3, 36, 0)
    assert rig.host.who == rig.sender.who


def test_a_lost_byte_shortens_only_its_frame():
    rig = HostRig(HostSchedule(first=0, period=2000, frames=2, lose=frozenset({(0, 5)})))
    sent = rig.run(20_000)
    assert [tick for _, _, tick in sent] == [FRAME - 10 * BIT, 2000 + FRAME]
    assert rig.host.bytes == 23


def test_a_frame_due_while_the_last_one_is_being_sent_is_counted_as_late_and_not_sent():
    rig = HostRig(HostSchedule(first=0, period=FRAME - 1, frames=4))
    assert [n for n, _, _ in rig.run(20_000)] == [0, 2]
    assert (rig.host.frames, rig.host.late) == (2, 2)


def test_a_frame_due_at_the_tick_at_which_the_last_one_ends_is_sent():
    rig = HostRig(HostSchedule(first=0, period=FRAME, frames=4))
    assert [n for n, _, _ in rig.run(20_000)] == [0, 1, 2, 3]


def test_jitter_depends_on_the_seed_alone():
    schedule = HostSchedule(first=0, period=2000, jitter=700, frames=8)
    starts = [tick - FRAME for _, _, tick in HostRig(schedule, seed=3).run(20_000)]
    assert starts == [tick - FRAME for _, _, tick in HostRig(schedule, seed=3).run(20_000)]
    assert starts != [tick - FRAME for _, _, tick in HostRig(schedule, seed=4).run(20_000)]
    late = [start - 2000 * n for n, start in enumerate(starts)]
    assert all(0 <= x <= 700 for x in late) and len(set(late)) > 1


def test_jitter_is_any_number_of_ticks_up_to_its_limit():
    rig = HostRig(HostSchedule(first=0, period=2000, jitter=2, frames=30), seed=3)
    assert {tick - FRAME - 2000 * number for number, _, tick in rig.run(60_000)} == {0, 1, 2}


def test_a_fast_clock_schedules_frames_without_rounding_drift():
    """12345 frames of a clock that is 20 ppm fast: the period is 2000 / 1.00002 ticks."""
    period = 2000 / (1 + Fraction(20, 1_000_000))
    rig = HostRig(HostSchedule(first=500, period=period))
    rig.run(500 + 12_345 * 2000)
    ends = [tick - FRAME for _, _, tick in rig.sent]
    assert len(ends) > 12_340
    assert all(begin == 500 + n * 2_000_000 * 1000 // 1_000_020 for n, begin in enumerate(ends))


def test_a_loop_with_a_pause_accumulates_its_delays():
    """Each frame begins up to 100 ticks late, and the next one is due a period after that."""
    rig = HostRig(HostSchedule(first=0, period=2000, jitter=100, paced_by="pause", frames=20), seed=3)
    begins = [tick - FRAME for _, _, tick in rig.run(100_000)]
    steps = [b - a for a, b in pairwise(begins)]
    assert all(2000 <= step <= 2100 for step in steps) and len(set(steps)) > 10
    assert begins[-1] == sum(steps) + begins[0] > 19 * 2000 + 500
    assert rig.host.due(19) == begins[18] + 2000


def test_a_silent_host_begins_no_frame_and_continues_to_count():
    rig = HostRig(HostSchedule(first=0, period=2000, silent=((4000, 8000),), frames=6))
    assert [number for number, _, _ in rig.run(20_000)] == [0, 1, 4, 5]  # silent from 4000, no longer at 8000
    assert (rig.host.frames, rig.host.late) == (4, 0)


def test_a_doubled_frame_is_sent_again_immediately():
    rig = HostRig(HostSchedule(first=0, period=4000, frames=3, twice=frozenset({1})))
    assert rig.run(20_000) == [(n, ramp(n), at + FRAME) for n, at in ((0, 0), (1, 4000), (1, 4000 + FRAME), (2, 8000))]
    assert (rig.host.frames, rig.host.bytes) == (4, 48)


@pytest.mark.parametrize("paced_by", ["schedule", "pause"])
def test_a_frame_that_is_due_when_a_doubled_frame_begins_again_is_late(paced_by: PacedBy):
    rig = HostRig(HostSchedule(first=0, period=FRAME, frames=3, twice=frozenset({0}), paced_by=paced_by))
    assert rig.run(20_000) == [(n, ramp(n), at + FRAME) for n, at in ((0, 0), (0, FRAME), (2, 2 * FRAME))]
    assert (rig.host.frames, rig.host.late) == (3, 1)


@pytest.mark.parametrize("paced_by", ["schedule", "pause"])
def test_the_position_of_a_tick_between_frames(paced_by: PacedBy):
    rig = HostRig(HostSchedule(first=1000, period=2000, paced_by=paced_by))
    assert rig.host.frame_at(0) == Fraction(-1, 2)
    rig.run(9000)
    assert [rig.host.frame_at(tick) for tick in (1000, 1500, 5000, 8999)] == [
        0,
        Fraction(1, 4),
        2,
        Fraction(7999, 2000),
    ]


def test_a_paused_host_knows_when_each_of_its_frames_was_due():
    rig = HostRig(HostSchedule(first=0, period=2000, paced_by="pause"))
    rig.run(200 * 2000)
    assert [rig.host.due(n) for n in (0, 1, 199)] == [0, 2000, 398_000]
    assert [rig.host.frame_at(tick) for tick in (500, 3000)] == [Fraction(1, 4), Fraction(3, 2)]


def test_a_paused_host_is_no_more_than_a_period_past_its_last_frame():
    rig = HostRig(HostSchedule(first=0, period=2000, jitter=400, paced_by="pause"), seed=1)
    rig.run(2150)  # the second one is due at 2000 and later
    assert rig.host.frame_at(2000 + 150) <= Fraction(1) + Fraction(150, 2000)
