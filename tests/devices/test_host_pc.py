"""The host's frames: what is sent when, what is left out."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.wire import Wire
from periph_sim.devices.host_pc import FRAME_BYTES, Host, HostSchedule, encode, ramp
from periph_sim.lines.uart_peer import UartPeer

BIT = 10
FRAME = FRAME_BYTES * 10 * BIT  # ticks


class Desk:
    def __init__(self, schedule: HostSchedule, seed: int = 0) -> None:
        self.kernel = Kernel()
        recorder = Recorder()
        self.falls: list[int] = []
        wire = Wire(self.kernel, "RX", recorder)
        wire.watch(lambda tick, level: self.falls.append(tick) if not level else None)
        self.host = Host(self.kernel, UartPeer(self.kernel, recorder, wire, Fraction(BIT)), schedule, seed=seed)
        self.sent: list[tuple[int, tuple[int, ...], int]] = []
        self.host.sent.append(lambda number, values, tick: self.sent.append((number, values, tick)))

    def run(self, ticks: int) -> list[tuple[int, tuple[int, ...], int]]:
        self.kernel.run_until(self.kernel.now + ticks)
        return self.sent


def test_a_frame_is_six_values_low_byte_first():
    assert encode((1, -2, 0x1234, -0x8000, 0x7FFF, 0)) == bytes.fromhex("0100 feff 3412 0080 ff7f 0000")


def test_a_value_that_does_not_fit_is_refused():
    with pytest.raises(OverflowError):
        encode((0x8000, 0, 0, 0, 0, 0))


def test_no_two_frames_of_twenty_minutes_are_equal_and_all_fit():
    frames = [ramp(n) for n in range(60_000)]
    assert len(set(frames)) == len(frames)
    assert len({f[0:3] for f in frames}) == len(frames)
    assert all(len(encode(f)) == FRAME_BYTES for f in frames[::997])


def test_frames_come_every_period_and_are_told_with_the_end_of_their_last_stop_bit():
    desk = Desk(HostSchedule(first=500, period=2000, frames=3))
    assert desk.run(20_000) == [(n, ramp(n), 500 + 2000 * n + FRAME) for n in range(3)]
    assert (desk.host.frames, desk.host.bytes, desk.host.late) == (3, 36, 0)


def test_a_lost_byte_shortens_its_frame_only():
    desk = Desk(HostSchedule(first=0, period=2000, frames=2, lose=frozenset({(0, 5)})))
    sent = desk.run(20_000)
    assert [tick for _, _, tick in sent] == [FRAME - 10 * BIT, 2000 + FRAME]
    assert desk.host.bytes == 23


def test_a_frame_due_while_the_last_is_still_sent_is_counted_late_and_not_sent():
    desk = Desk(HostSchedule(first=0, period=FRAME - 1, frames=4))
    assert [n for n, _, _ in desk.run(20_000)] == [0, 2]
    assert (desk.host.frames, desk.host.late) == (2, 2)


def test_a_frame_due_the_tick_the_last_one_ends_is_sent():
    desk = Desk(HostSchedule(first=0, period=FRAME, frames=4))
    assert [n for n, _, _ in desk.run(20_000)] == [0, 1, 2, 3]


def test_jitter_comes_from_the_seed_alone():
    schedule = HostSchedule(first=0, period=2000, jitter=700, frames=8)
    starts = [tick - FRAME for _, _, tick in Desk(schedule, seed=3).run(20_000)]
    assert starts == [tick - FRAME for _, _, tick in Desk(schedule, seed=3).run(20_000)]
    assert starts != [tick - FRAME for _, _, tick in Desk(schedule, seed=4).run(20_000)]
    late = [start - 2000 * n for n, start in enumerate(starts)]
    assert all(0 <= x <= 700 for x in late) and len(set(late)) > 1
