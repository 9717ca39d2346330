"""The sensor head's schedule on a bus without devices: each transfer is START, address, NACK, STOP."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import Any

import pytest

from periph_sim.bus.i2c.transfer import Transfer
from periph_sim.devices.sensor_head import SensorHead
from periph_sim.devices.sensor_rounds import Request, Round, Schedule
from periph_sim.imu.sensors import SENSORS as CHIPS
from tests.bus.i2c_rig import TIMING, UNIT, I2cRig

NACKED = 40 * UNIT  # duration of a transfer that is not acknowledged
GYRO = Request("gyroscope", 0x68, 0x1D, 6)
PLAIN = Request("plain", 0x10, None, 2)


class HeadRig:
    def __init__(self, schedule: Schedule, requests: list[Request], **more: Any) -> None:
        self.rig = I2cRig()
        self.head = SensorHead(self.rig.kernel, self.rig.controller, requests, schedule, **more)
        self.dues: list[int] = []
        self.missed: list[int] = []
        self.head.on_due.append(self.dues.append)
        self.head.on_missed.append(self.missed.append)
        self.rounds: list[Round] = []
        self.transfers: list[Transfer] = []
        self.head.on_round.append(self.rounds.append)
        self.head.on_transfer.append(self.transfers.append)

    def run(self, ticks: int) -> list[Round]:
        self.rig.run_until(self.rig.kernel.now + ticks)
        return self.rounds


def test_rounds_begin_every_period_and_requests_follow_after_the_gap():
    head_rig = HeadRig(Schedule(first=100, period=2000, gap=50, rounds=2), [PLAIN, PLAIN])
    rounds = head_rig.run(10_000)
    assert [(r.number, r.due, r.start, r.end) for r in rounds] == [
        (1, 100, 100, 100 + 2 * NACKED + 50),
        (2, 2100, 2100, 2100 + 2 * NACKED + 50),
    ]
    assert [(r.transfers, r.nacked) for r in rounds] == [(2, 2)] * 2
    assert [t.phases[0].start_at for t in head_rig.transfers] == [100, 550, 2100, 2550]
    assert head_rig.head.who == head_rig.rig.controller.who


def test_a_gap_is_at_least_the_bus_free_time():
    head_rig = HeadRig(Schedule(first=0, period=5000, gap=1, rounds=1), [PLAIN, PLAIN])
    head_rig.run(5000)
    assert head_rig.transfers[1].phases[0].start_at == NACKED + TIMING.free


def test_a_round_due_while_the_last_one_is_running_is_missed():
    head_rig = HeadRig(Schedule(first=0, period=NACKED - 1, gap=0, rounds=5), [PLAIN])
    rounds = head_rig.run(10_000)
    assert [r.number for r in rounds] == [1, 3, 5]
    assert (head_rig.head.missed, head_rig.head.rounds) == (2, 3)
    assert head_rig.dues == [number * (NACKED - 1) for number in range(5)]
    assert head_rig.missed == [NACKED - 1, 3 * (NACKED - 1)]


@pytest.mark.parametrize(("more", "begin", "missed"), [({}, 2000, 1), ({"ahead": 4 * NACKED}, 2000 - 4 * NACKED, 0)])
def test_the_set_up_of_chips_before_the_first_round_is_not_a_round(more: dict[str, int], begin: int, missed: int):
    head_rig = HeadRig(
        Schedule(first=2000, period=4000, gap=0, rounds=2, **more), [PLAIN], startup=[GYRO, PLAIN], by_stop=True
    )
    assert head_rig.head.at_rest
    head_rig.run(begin)
    assert not head_rig.head.at_rest
    rounds = head_rig.run(10_000)
    assert head_rig.head.at_rest and head_rig.head.missed == missed
    assert [one.number for one in rounds] == [1, 2][missed:]
    assert [one.name for one in head_rig.transfers[:4]] == ["gyroscope", "gyroscope", "plain", "plain"]
    assert head_rig.transfers[0].phases[0].start_at == begin


def test_a_round_delayed_by_a_stretching_slave_makes_the_next_one_missed():
    head_rig = HeadRig(Schedule(first=0, period=1000, gap=0, rounds=3), [PLAIN])
    head_rig.rig.pull((60, "scl", 0), (1500, "scl", 1))
    rounds = head_rig.run(10_000)
    assert [r.number for r in rounds] == [1, 3]
    assert head_rig.head.missed == 1


def test_jitter_depends_on_the_seed_alone_and_does_not_accumulate():
    schedule = Schedule(first=0, period=2000, gap=0, jitter=900, rounds=20)
    starts = [r.start for r in HeadRig(schedule, [PLAIN], seed=1).run(60_000)]
    assert HeadRig(schedule, [PLAIN]).run(60_000) == HeadRig(schedule, [PLAIN], seed=0).run(60_000)
    assert starts == [r.start for r in HeadRig(schedule, [PLAIN], seed=1).run(60_000)]
    assert starts != [r.start for r in HeadRig(schedule, [PLAIN], seed=2).run(60_000)]
    late = [start - 2000 * n for n, start in enumerate(starts)]
    assert all(0 <= x <= 900 for x in late) and len(set(late)) > 5
    assert [r.due for r in HeadRig(schedule, [PLAIN], seed=1).run(60_000)] == [2000 * n for n in range(20)]


@pytest.mark.parametrize(
    ("request_", "by_stop", "phases"),
    [
        (GYRO, False, [[(False, b"\x1d", 0), (True, b"", 6)]]),
        (GYRO, True, [[(False, b"\x1d", 0)], [(True, b"", 6)]]),
        (PLAIN, False, [[(True, b"", 2)]]),
        (Request("w", 0x10, 0x05, 0, write=b"\x0b"), False, [[(False, b"\x05\x0b", 0)]]),
        (Request("w", 0x10, None, 0, write=b"\x0b"), True, [[(False, b"\x0b", 0)]]),
        (Request("a", 0x10, None, 0), False, [[(False, b"", 0)]]),
        (Request("wr", 0x10, 0x05, 1, write=b"\x0b"), False, [[(False, b"\x05\x0b", 0), (True, b"", 1)]]),
    ],
)
def test_the_transfers_of_a_request(request_: Request, by_stop: bool, phases: list[list[tuple[bool, bytes, int]]]):
    transfers = request_.transfers(by_stop)
    assert [[(p.read, p.data, p.count) for p in t.phases] for t in transfers] == phases


@pytest.mark.parametrize(
    ("chip", "data", "values"),
    [
        ("gyroscope", "0001 0002 fffd", (1, 2, -3)),
        ("accelerometer", "0100 0200 fdff", (1, 2, -3)),
        ("magnetometer", "0001 0002 fffd", (1, -3, 2)),  # the HMC5883L sends the axes in the order x, z, y
    ],
)
def test_the_values_in_the_bytes_of_a_chip(chip: str, data: str, values: tuple[int, ...]):
    assert CHIPS[chip].values(bytes.fromhex(data)) == values


def test_a_chip_that_acknowledges_is_not_counted_as_nacked():
    head_rig = HeadRig(Schedule(first=0, period=5000, gap=0, rounds=1), [Request("w", 0x10, None, 0, write=b"\xff")])
    for slot in (33, 33 + 36):  # the ACK slots
        head_rig.rig.kernel.call_at(slot * UNIT + 1, partial(head_rig.rig.partner["sda"].drive, 0))
        head_rig.rig.kernel.call_at((slot + 4) * UNIT + 1, partial(head_rig.rig.partner["sda"].drive, 1))
    rounds = head_rig.run(5000)
    assert [(r.nacked, r.transfers) for r in rounds] == [(0, 1)]


def test_a_slow_clock_schedules_rounds_without_rounding_drift():
    """The test would detect an error of half a tick in 1000 periods."""
    period = Fraction(1000) / (1 - Fraction(30, 1_000_000))
    head_rig = HeadRig(Schedule(first=0, period=period, gap=0), [PLAIN])
    dues = [r.due for r in head_rig.run(2_000_000)]
    assert dues == [n * 1_000_000_000 // 999_970 for n in range(len(dues))] and len(dues) > 1990
