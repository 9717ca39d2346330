"""Rounds and stretches determined from the bus: on hand-made transfers, and compared with controller and records."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from fractions import Fraction
from functools import cache

import pytest

from periph_sim import BadCase, Scene, load
from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.core.records import Kind, Record
from periph_sim.core.time import NO_TIME
from periph_sim.devices.sensor_rounds import Request, Round
from periph_sim.timing.rounds import BusRounds, MasterSchedule
from tests.scene.runs import TIMING, recorded
from tests.scene.small import sentence_of
from tests.timing.events_by_hand import pairs

A, B, C = 0x10, 0x20, 0x30
ONE = tuple(t for address in (A, B) for t in Request(f"{address:#x}", address, 0x05, 2).transfers(by_stop=False))


class RoundsRig:
    """Rounds with requests to A and B, a pointer and two bytes each. The first is due at 100, then one every 1000."""

    def __init__(self, **asked: object) -> None:
        self.begun_at = NO_TIME
        rounds = self.rounds = BusRounds(
            MasterSchedule(**({"requests": ONE, "period": 1000, "first": 100} | asked)), lambda: self.begun_at
        )
        self.over: list[Round] = []
        self.due: list[int] = []
        self.missed: list[int] = []
        self.transfers: list[Transfer] = []
        rounds.on_round.append(self.over.append)
        rounds.on_due.append(self.due.append)
        rounds.on_missed.append(self.missed.append)
        rounds.on_transfer.append(self.transfers.append)

    def ask(self, address: int, at: int, *, length: int = 40, acked: bool = True, pointer: int = 0x05) -> None:
        phases = [Phase(address, read=False, data=bytes([pointer] * acked), acked=acked, start_at=at)]
        if acked:
            phases.append(Phase(address, read=True, acked=True, got=bytearray(b"\1\2"), start_at=at + 10))
        self.rounds.transfer(Transfer("", phases, stop_at=at + length))

    def round(self, at: int, length: int = 40) -> None:
        self.ask(A, at)
        self.ask(B, at + 50, length=length)

    def times(self) -> list[tuple[int, int, int]]:
        return [(r.due, r.start, r.end) for r in self.over]


def test_a_round_lasts_from_its_first_start_to_the_stop_of_its_last_request():
    rig = RoundsRig()
    rig.round(100)
    rig.round(1100)
    rig.rounds.finish(1500)
    assert rig.times() == [(100, 100, 190), (1100, 1100, 1190)]
    assert (rig.due, rig.missed) == ([100, 1100], [])
    assert [t.name for t in rig.transfers] == ["0x10", "0x20"] * 2


def test_a_start_delayed_for_longer_than_the_schedule_allows_is_part_of_the_round():
    rig = RoundsRig(late=20)
    rig.round(110)
    rig.round(1300)
    assert rig.times() == [(100, 110, 200), (1100, 1120, 1390)]


def test_a_round_that_does_not_begin_before_the_next_one_is_due_is_missed():
    rig = RoundsRig()
    rig.round(100, length=1900)  # until 2050
    rig.round(2100)
    rig.rounds.finish(2900)
    assert (rig.due, rig.missed) == ([100, 1100, 2100], [1100])


def test_a_round_cut_off_by_the_end_does_not_count_and_those_due_meanwhile_are_missed():
    rig = RoundsRig()
    rig.ask(A, 100)
    rig.rounds.finish(2200)
    assert (rig.over, rig.due, rig.missed) == ([], [1100, 2100], [1100, 2100])
    held = RoundsRig()
    held.begun_at = 100  # a START without a STOP
    held.rounds.finish(1200)
    assert (held.due, held.missed) == ([1100], [1100])


def test_refused_requests_are_counted_in_their_round():
    rig = RoundsRig()
    rig.ask(A, 100, acked=False)
    rig.ask(B, 150)
    rig.ask(B, 1100)  # there is no request to A, so none was refused
    assert [(r.nacked, r.end) for r in rig.over] == [(1, 190), (0, 1140)]
    assert [p.start_at for p in rig.transfers[0].phases] == [100, NO_TIME], "the read was never begun"
    assert [p.count for p in rig.transfers[0].phases] == [0, 2]


def test_a_round_that_lacks_requests_is_missed_once():
    three = (*ONE, *Request("0x30", C, 0x05, 2).transfers(by_stop=False))
    rig = RoundsRig(requests=three)
    for at in (100, 1100, 2100, 3100):
        rig.ask(A, at)
        if at != 1100:
            rig.ask(B, at + 50, pointer=0x77 if at == 2100 else 0x05)  # another register
        if at > 100:
            rig.ask(C, at + 100)
    assert rig.missed == [1100, 1200, 2200], "the next round shows that the first one lacks C"
    rig.ask(C, 4100)  # without requests to A and B
    rig.rounds.finish(4200)
    assert rig.missed == [1100, 1200, 2200, 4100] and len(rig.over) == 4


def test_a_round_that_begins_again_was_aborted():
    rig = RoundsRig()
    rig.ask(A, 100)
    rig.round(1100)
    assert rig.times() == [(1100, 1100, 1190)] and rig.due == [100, 1100]
    assert rig.missed == [1100]


def test_transfers_that_are_not_requests_belong_to_no_round():
    rig = RoundsRig()
    rig.ask(A, 100)
    rig.ask(C, 150)
    rig.ask(A, 160, pointer=0x77)
    rig.ask(B, 210)
    assert rig.times() == [(100, 100, 250)] and len(rig.transfers) == 4


def test_the_start_up_is_before_the_first_round():
    rig = RoundsRig(startup=ONE)
    rig.round(20)
    assert rig.over == [] and rig.rounds.at_start()
    rig.round(100)
    assert rig.times() == [(100, 100, 190)]


def test_without_a_known_schedule_a_round_is_due_a_period_after_the_one_before():
    rig = RoundsRig(first=None)
    rig.round(777)
    rig.round(1780)  # the clock of the master is slow
    rig.round(4200)  # nearer to 3780 than to 4780
    rig.rounds.finish(4300)
    assert rig.missed == [2780] and rig.due == [777, 1780, 2780, 4200]


# Compared with the controller and with the records -----------------------------------------------------------


class Ran:
    """A run with all its records, the reports of the controller, and those determined from the bus."""

    def __init__(self, name: str, seconds: str, *changes: str) -> None:
        case = load(TIMING / f"{name}.toml", list(changes))
        self.scene, self.records = scene, _ = recorded(case, keep_values=True)
        self.rounds: list[Round] = []
        self.transfers: list[Transfer] = []
        self.missed: list[int] = []
        if scene.head is not None:
            scene.head.on_round.append(self.rounds.append)
            scene.head.on_transfer.append(self.transfers.append)
            scene.head.on_missed.append(self.missed.append)
        self.rounds_on_bus: list[Round] = []
        self.transfers_on_bus: list[Transfer] = []
        self.missed_on_bus: list[int] = []
        scene.on_round(self.rounds_on_bus.append)
        scene.on_transfer(self.transfers_on_bus.append)
        scene.bus.rounds.on_missed.append(self.missed_on_bus.append)
        self.result = scene.run(Fraction(seconds))

    def values(self, name: str) -> list[tuple[int, int]]:
        """(value, tick) of each value of a budget."""
        return pairs(next(limit.measure for limit in self.scene.limits if limit.budget.name == name))


BUDGETS = """budget=[
    {name="stretch", measure="stretch", max="9 s"}, {name="round", measure="round", max="9 s"},
    {name="slack", measure="slack", min="0 s"}, {name="gap", measure="gap between rounds", min="0 s"},
    {name="held", measure="SCL held per transfer", max="9 s"}, {name="reaction", measure="reaction", max="9 s"}]"""
STRETCHED = ("unit.dsp.settings.frame_cost=110 us",)
SCENES = [
    ("imu_hil_drift", "0.47", STRETCHED),
    ("imu_hil_published", "0.3", ("unit.dsp.settings.model_cost=45 ms",)),
    ("imu_hil_stuck_sda", "0.4", ()),
    ("imu_hil_glitches", "0.2", ()),
]


@cache
def ran(place: int) -> Ran:
    name, seconds, changes = SCENES[place]
    return Ran(name, seconds, BUDGETS, *changes)


def summary(transfer: Transfer) -> tuple[object, ...]:
    phases = [(p.address, p.read, p.count, p.acked, bytes(p.got), p.start_at, p.stretch) for p in transfer.phases]
    answers = [(p.answer_from, p.answer_at) for p in transfer.phases if p.read]
    return transfer.name, transfer.stop_at, transfer.acked, phases, answers


@pytest.mark.parametrize("place", range(len(SCENES)))
def test_rounds_from_the_bus_are_those_of_the_controller(place: int):
    """In these scenes, the controller is delayed, clears the bus, and has to ignore clocks of other parties."""
    run = ran(place)
    assert len(run.rounds) >= 9 and [summary(t) for t in run.transfers_on_bus] == [summary(t) for t in run.transfers]
    assert run.rounds_on_bus == [
        Round(n, r.due, r.start, r.end, r.nacked, r.transfers) for n, r in enumerate(run.rounds, 1)
    ]
    assert run.missed_on_bus == run.missed


def lows(records: list[Record], held_by: Callable[[str], bool]) -> list[tuple[int, int]]:
    """(rise, time from the release by the last matching holder to the rise), for each low of SCL with such a holder."""
    found, holds, let_go = [], False, NO_TIME
    for r in records:
        if r.where != "SCL" or r.kind not in (Kind.EDGE, Kind.HOLD):
            continue
        if r.value:
            if holds or let_go != NO_TIME:
                found.append((r.tick, 0 if holds else r.tick - let_go))
            holds, let_go = False, NO_TIME
            continue
        holding = any(held_by(who) for who in r.text.split(", "))
        if holds and not holding:
            let_go = r.tick
        holds = holding
    return found


def test_stretch_is_the_time_scl_stays_low_after_its_release_by_the_controller():
    run = ran(0)
    let_go = lows(run.records, lambda who: who == "controller")
    starts = [r.tick for r in run.records if r.kind is Kind.BUS and r.what in ("START", "repeated START")]
    wanted = [
        (max(held for rise, held in let_go if begin < rise <= end), begin)
        for begin, end in zip(starts, [*starts[1:], run.scene.kernel.now], strict=True)
    ]
    assert run.values("stretch") == wanted[: len(run.values("stretch"))] and len(wanted) >= 130
    assert max(wanted)[0] > 50 * 3000


def on_bus(records: list[Record]) -> list[tuple[int, int, int]]:
    """(START, address, STOP) of each transfer."""
    found, begin, address = [], 0, 0
    for r in records:
        if r.kind is Kind.BUS and r.what == "START":
            begin, address = r.tick, -1
        elif r.kind is Kind.BUS and r.what == "address" and address < 0:
            address = r.value >> 2
        elif r.kind is Kind.BUS and r.what == "STOP":
            found.append((begin, address, r.tick))
    return found


@pytest.mark.parametrize("place", [0, 1])
def test_round_slack_and_gap_agree_with_the_recorded_bytes(place: int):
    """A round has three transfers: gyroscope, accelerometer, magnetometer. Rounds are due every 20 ms from 5 ms."""
    run = ran(place)
    transfers = on_bus(run.records)
    rounds = [
        (a, c)
        for (a, x, _), (_, y, _), (_, z, c) in zip(*[iter(transfers)] * 3, strict=False)
        if (x, y, z) == (0x68, 0x53, 30)
    ]
    assert len(rounds) >= 6 and run.values("round") == [(end - begin, begin) for begin, end in rounds]
    ms = run.scene.timebase.per_second // 1000
    assert run.values("slack") == [
        (5 * ms + ((begin - 5 * ms) // (20 * ms) + 1) * 20 * ms - end, end) for begin, end in rounds
    ]
    gaps = [(later - end, end) for (_, end), (later, _) in itertools.pairwise(rounds)]
    assert run.values("gap") == gaps and gaps


def test_the_time_scl_is_held_is_the_sum_over_the_low_phases_of_a_transfer():
    run = ran(0)
    by_others = lows(run.records, lambda who: not who.startswith("dsp."))
    wanted = [
        (sum(held for rise, held in by_others if begin < rise <= end), begin) for begin, _, end in on_bus(run.records)
    ]
    assert run.values("held") == wanted and max(wanted)[0] > 50 * 3000


def test_reaction_is_from_the_last_flag_before_each_write():
    run = ran(0)
    wanted, asked = [], NO_TIME
    for r in run.records:
        if r.kind is Kind.BUS and r.what == "START":
            asked = NO_TIME
        elif r.kind is Kind.FLAG and r.what in ("I2CSTR.SDIR", "I2CSTR.XRDY") and r.value:
            asked = r.tick
        elif r.kind is Kind.ACCESS and r.what == "W I2C-A.I2CDXR" and asked != NO_TIME:
            wanted.append((r.tick - asked, asked))
            asked = NO_TIME
    assert run.values("reaction") == wanted and len(wanted) > 300


# A unit that is the master ------------------------------------------------------------------------------------------

ROUNDS = 'rounds={period="20 ms", order=["gyroscope", "accelerometer", "magnetometer"]}'
WORDS = """budget=[
    {name="stretch", measure="stretch", max="0 us"}, {name="round", measure="round", max="9 s"},
    {name="slack", measure="slack", min="0 s"}, {name="gap", measure="gap between rounds", min="0 s"},
    {name="missed", measure="missed rounds", max=0}, {name="nacked", measure="nacked rounds", max=0},
    {name="response", measure="response", max="1 ms"}]"""


def test_the_same_measures_judge_firmware_that_is_the_master():
    run = Ran("two_dsps", "0.2", ROUNDS, WORDS)
    transfers = on_bus(run.records)
    rounds = list(zip(transfers[::3], transfers[2::3], strict=True))
    assert [address for _, address, _ in transfers[:3]] == [0x68, 0x53, 0x1E] and len(rounds) >= 8
    assert run.values("round") == [(last[2] - first[0], first[0]) for first, last in rounds]
    period = run.scene.timebase.per_second // 50
    assert run.values("slack") == [(first[0] + period - last[2], last[2]) for first, last in rounds]
    verdicts = {v.name: v for v in run.result.budgets}
    assert verdicts["missed"].counted == verdicts["nacked"].counted == str(len(rounds))
    assert all(v.passed for v in verdicts.values())
    wanted = [held for _, held in lows(run.records, lambda who: who.startswith("head."))]
    assert max(value for value, _ in run.values("stretch")) == max(wanted) == 0


def test_a_slave_that_stretches_is_measured_with_firmware_as_the_master():
    """The head makes requests while the models of the other unit run."""
    run = Ran("two_dsps", "0.1", ROUNDS, WORDS, "unit.head.settings.period=4 ms", "unit.imu.settings.model_cost=3 ms")
    wanted = [held for _, held in lows(run.records, lambda who: who.startswith("head."))]
    assert max(value for value, _ in run.values("stretch")) == max(wanted) > 0
    assert not run.result.budgets[0].passed


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (("imu_hil_published", ROUNDS), "rounds: [controller] says its rounds already; leave one of them out"),
        (("uart_logger", ROUNDS), "rounds: it needs a bus, and no unit has I2C-A"),
        (
            ("captured_master", 'rounds={period="20 ms"}'),
            "rounds: it has no requests; give it order or [[rounds.request]]",
        ),
        (
            ("captured_master", 'rounds={period="20 ms", order=["giroscope"]}'),
            "rounds.order: there is no chip 'giroscope'; did",
        ),
        (
            ("captured_master", 'budget=[{name="r", measure="round", max="1 s"}]'),
            "budget.r.measure: 'round' needs [controller], or [rounds] for a unit that is the master, in the scene",
        ),
        (
            ("captured_master", 'budget=[{name="r", measure="gap between rounds", max="1 s"}]'),
            "budget.r.measure: 'gap between rounds' needs [controller] or [rounds] in the scene, which has none",
        ),
    ],
)
def test_invalid_rounds_are_rejected(changes: tuple[str, ...], said: str):
    name, *given = changes
    assert said in sentence_of(BadCase, lambda: Scene(load(TIMING / f"{name}.toml", list(given))))
