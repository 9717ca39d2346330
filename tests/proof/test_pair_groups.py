"""Runs of groups, with a scene and records that are invented: a cycle has 10 ticks, and a sample of the SCI 80.

orbit    0 ........ 400 = 0      40 states, which repeat after 100 ticks apart from those of the SCI
group        R------------- now
          F  |<-entered
"""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.core.chip import NEVER
from periph_sim.core.records import Kind, Record
from periph_sim.proof import pair_groups
from periph_sim.proof.free_run import NotClosed
from periph_sim.proof.normal_state import NormalState
from periph_sim.proof.pair_groups import Cells, Group, GroupRun, GroupRunner, Orbit, Orbits, Sleep, far_ranges
from periph_sim.proof.record_digests import GroupDigest

Asleep = tuple[int, int, tuple[tuple[int, int], ...]]

I2CSTR = 0x7902
WAIT = Sleep(1000, 5000, 100, ((I2CSTR, 4),))  # a pass of 10 cycles
IN_WAIT: Asleep = (0, 10, ((I2CSTR, 4),))
STARTED_AT = 100_000


class Invented(GroupRunner):
    """A runner at cycle 2 of its only orbit, whose groups end 2000 ticks after their later start, at cycle 7.

    requested, entered, left: the ticks of the request and of the service routine, from the round or from a frame alone.
    accessed: the accesses after the service routine.
    asleep: the wait in which the firmware then is.
    """

    def __init__(self) -> None:
        self.records = GroupDigest()
        self.cells = Cells(0, 80, 0, 0)
        self.orbits = Orbits()
        self.orbits.own = 10
        self.orbits.add(Orbit(tuple(bytes([number]) for number in range(40)), 60))
        self.at = (0, 2)
        self.requested, self.entered, self.left = 500, 1000, 4999
        self.accessed: set[str] = set()
        self.asleep: Asleep | None = IN_WAIT
        self.started: list[tuple[int | None, int | None]] = []
        self.services = 1
        self.run: Any = SimpleNamespace(now=STARTED_AT, ticks_per_cycle=10, start=self._start, settle=self._settle)
        self.run.scene = SimpleNamespace(advance=lambda tick: None, kernel=SimpleNamespace(settle=lambda: None))
        self._requested = [0]
        self._unit = "dsp"
        operand = SimpleNamespace(place=SimpleNamespace(name="I2C-A"), register=SimpleNamespace(name="I2CSTR"))
        self._bus = SimpleNamespace()
        self._bus.find = lambda address, width: {(I2CSTR, 16): operand}[address, width]

    def _start(self, frame: int | None, start: int | None, count_from: int) -> None:
        self.started.append((frame, start))
        self.run.now = max(one for one in (frame, start) if one is not None)
        self.records.services, self.records.accessed_since = self.services, self.accessed
        self._requested[0] = count_from + self.requested
        self.records.entered, self.records.left = count_from + self.entered, count_from + self.left

    def _settle(self) -> None:
        self.run.now += 2000

    def place(self) -> tuple[int, int]:
        return 0, 7

    def _asleep(self) -> Asleep | None:
        return self.asleep


def test_places_and_times_of_a_group_are_counted_from_its_round_and_from_the_frames_cell():
    """The round can start at tick 30, 130, 230 or 330 of the orbit; with a frame's cell 150 ticks before it, at 330."""
    runner = Invented()
    found = runner.run_group(Group(30, -150), offset=7)
    ((frame, start),) = runner.started
    assert frame is not None and start is not None and frame > STARTED_AT
    assert (start, frame) == (STARTED_AT - 20 + 330, start - 150 + 7)
    assert (frame - 7) % 80 == 0
    assert found.delay == 500 + 150
    assert (found.after, found.length) == (0, 2000 + 150 - 7)
    assert found.shift == (70 - 330 - 2000) % 400
    assert runner.at == (0, 7)


@pytest.mark.parametrize(
    ("entered", "left", "is_within"), [(1000, 4999, True), (999, 4999, False), (1000, 5000, False)]
)
def test_a_service_routine_is_within_a_wait_if_the_wait_has_begun_and_not_ended(
    entered: int, left: int, is_within: bool
):
    runner = Invented()
    runner.entered, runner.left = entered, left
    assert runner.run_group(Group(30, 10), 0, WAIT).within is is_within


@pytest.mark.parametrize("end", [5000, NEVER])
@pytest.mark.parametrize(
    ("asleep", "accessed", "is_within"),
    [
        (IN_WAIT, (), True),
        (IN_WAIT, ("dsp R I2C-A.I2CSTR",), True),
        (IN_WAIT, ("dsp R I2C-A.I2CSTR", "dsp R I2C-A.I2CDRR"), False),
        (IN_WAIT, ("dsp W I2C-A.I2CSTR",), False),
        ((0, 9, IN_WAIT[2]), (), False),
        ((0, 10, ()), (), False),
        ((0, 10, ((I2CSTR, 5),)), (), False),
        (None, (), False),
    ],
)
def test_a_wait_goes_on_if_its_passes_are_as_before(
    end: int, asleep: Asleep | None, accessed: Sequence[str], is_within: bool
):
    for wait, expected in ((WAIT._replace(end=end), is_within), (None, True)):
        runner = Invented()
        runner.asleep, runner.accessed = asleep, {*accessed}
        assert runner.run_group(Group(30, 10), 0, wait).within is expected


@pytest.mark.parametrize(("group", "services"), [(Group(30, 10), 0), (Group(30, 10), 2), (Group(30, None), 1)])
def test_a_group_without_one_service_routine_for_each_frame_is_refused(group: Group, services: int):
    runner = Invented()
    runner.services = services
    with pytest.raises(NotClosed, match=f"a frame has {services} service routines of the SCI, not one"):
        runner.run_group(group)


def test_a_frame_that_the_firmware_notices_in_another_way_is_refused():
    runner = Invented()
    runner.records.noticed = "it sends"
    with pytest.raises(NotClosed, match="notices more of a frame than its service routine: it sends"):
        runner.check_frame(is_sent=True)


@pytest.mark.parametrize(
    ("asleep", "most", "found"), [(True, NEVER, (7, 10, ())), (True, 9, None), (False, NEVER, None)]
)
def test_a_wait_has_passes_without_limit(asleep: bool, most: int, found: Asleep | None):
    """A wait whose number of passes is limited ends by itself."""
    runner = Repeating((), ())
    state = {"_most": most, "_period": 10, "_spin": ()}
    runner._polls = SimpleNamespace(normal_state=lambda cycle, tick: state, asleep=asleep, began=7)
    assert runner._asleep() == found


def test_a_group_of_another_orbit_has_the_next_distance_at_which_the_frame_starts_with_a_cell():
    """In the present orbit, cells begin at ticks 20, 100, 180, 260 and 340. The last one is 10 ticks after a round."""
    runner = Invented()
    assert runner.like(Group(30, None)) == Group(30, None)
    assert runner.like(Group(None, 25)) == Group(None, 100)
    assert (runner.like(Group(30, 10)), runner.like(Group(30, 0))) == (Group(30, 10), Group(30, 10))


def test_the_request_of_a_frame_is_the_last_rise_of_a_flag_of_a_receiver():
    requested = [0]
    for tick, what, value in (
        (10, "PIEIFR9.INTx1", 1),
        (20, "PIEIFR9.INTx1", 0),
        (30, "PIEIFR9.INTx2", 1),
        (40, "PIEIFR9.INTx3", 1),
        (50, "PIEIFR8.INTx5", 1),
        (60, "PIEIFR8.INTx1", 1),
    ):
        pair_groups._note_request(requested, Record(0, tick, Kind.FLAG, "dsp.PIE", what, value, "", 0))
        assert requested[0] == {10: 10, 20: 10, 30: 10, 40: 40, 50: 50, 60: 50}[tick]


def test_runs_agree_if_the_rest_that_they_reach_and_what_happens_until_then_are_equal():
    run = GroupRun(0, 0, 0, 0, 0, 0, True)
    different = {name for name in GroupRun._fields if not run.is_like(run._replace(**{name: 2}))}
    assert different == {"after", "shift", "main", "routine", "delay"}


def test_the_service_routine_of_a_far_frame_is_well_within_the_wait():
    """It is entered 250 ticks after the first tick of the cell, and left after 400. 8 cycles and 4 passes are kept."""
    first, short = Sleep(1000, 5000, 100, ()), Sleep(6000, 6700, 100, ())
    longer, last = short._replace(end=6710), Sleep(9000, NEVER, 50, ())
    found = far_ranges([first, short, longer, last], Cells(0, 80, 250, 400), 10)
    assert found == [
        (1000 - 250 + 80, 5000 - 400 - 80 - 400, first),
        (6000 - 250 + 80, 6710 - 400 - 80 - 400, longer),
        (9000 - 250 + 80, NEVER - 400 - 80 - 200, last),
    ]


# Orbits ------------------------------------------------------------------------------


class Repeating(GroupRunner):
    """A runner whose states are given by the number of cycles since the start."""

    def __init__(self, own: Sequence[object], sci: Sequence[object]) -> None:
        self.orbits = Orbits()
        self._sci, self._lspclk = ("dsp.SCI",), {"dsp.SYS.chip.lspclk_phase"}
        self.run: Any = SimpleNamespace(now=800, ticks_per_cycle=10, scene=None, state=self._state)
        self.run.next_cycle = self._next_cycle
        self.run.not_repeating = lambda before, after: NotClosed(f"{before} is not {after}")
        self._of_own, self._of_sci = own, sci

    def _state(self) -> NormalState:
        cycle = self.run.now // 10
        phase, sci = cycle % 4, self._of_sci[cycle % len(self._of_sci)]
        own = self._of_own[cycle % len(self._of_own)]
        return {"dsp.SCI-A.chip._rx": sci, "dsp.SYS.chip.lspclk_phase": phase, "dsp.program": own}

    def _next_cycle(self) -> None:
        self.run.now += 10


@pytest.fixture
def periods(monkeypatch: pytest.MonkeyPatch) -> dict[str, int]:
    """The SCI has a period of 8 cycles."""
    found = {"dsp.SCI-A.chip._rx_clock._cycle": 8, "dsp.program.cpu.polls.began": 10}
    monkeypatch.setattr(pair_groups, "periods_of", lambda scene: found)
    monkeypatch.setattr(pair_groups, "period_of", lambda scene: 40)
    return found


def test_an_orbit_has_the_states_of_one_period_and_the_place_of_the_first_one(periods: dict[str, int]):
    runner = Repeating(range(10), range(8))
    runner.run.now = 1030
    assert runner.place() == (0, 0)
    (orbit,) = runner.orbits.known
    assert (orbit.cycles, orbit.origin, runner.orbits.own, runner.run.now) == (40, 1030 % 80, 10, 1030 + 400)
    runner.run.now += 50
    assert runner.place() == (0, 5) and len(runner.orbits.known) == 1


def test_the_own_period_of_firmware_that_sleeps_is_a_cycle(periods: dict[str, int], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(pair_groups, "period_of", lambda scene: 8)
    runner = Repeating([0], range(8))
    assert (runner.place(), runner.orbits.own) == ((0, 0), 1)


@pytest.mark.parametrize(
    ("own", "sci", "reason"),
    [
        (range(11), range(8), "is not"),
        (range(5), range(4), "the states of rest have different periods"),  # each state is there twice
        (range(20), range(8), "the states of rest have different periods"),  # those of a known orbit repeat after 10
        ([*range(39), 0], range(8), "the states of rest have different periods"),  # the own states repeat after 39
    ],
)
def test_states_that_do_not_repeat_with_the_periods_of_the_clocks_are_refused(
    own: Sequence[int], sci: Sequence[int], reason: str, periods: dict[str, int]
):
    runner = Repeating(own, sci)
    runner.orbits.own = 10 if len(own) == 20 else 0
    with pytest.raises(NotClosed, match=reason):
        runner.place()


@pytest.mark.parametrize("other", [{"dsp.SCI-B.chip._rx_clock._cycle": 16}, {}])
def test_a_unit_needs_one_period_of_its_scis(other: dict[str, int], periods: dict[str, int]):
    runner = Repeating(range(10), range(8))
    assert runner.sci_period() == 8
    if not other:
        periods.clear()
    periods |= other
    with pytest.raises(NotClosed, match="it has more than one SCI, or none is on"):
        runner.sci_period()
