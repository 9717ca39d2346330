"""One total order: time, then phase, then who asked first; wires settle at the end of each phase."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.agent import Agent, SampledParty, Settleable
from periph_sim.core.kernel import CHIP, CPU, PADS, PROBE, STORM, TIMER, Kernel, SimulationStuck


@given(st.lists(st.tuples(st.integers(0, 50), st.sampled_from([TIMER, PADS, CHIP, CPU, PROBE])), max_size=40))
def test_events_run_in_the_order_of_their_keys(asked):
    kernel, log = Kernel(), []
    for number, (time, phase) in enumerate(asked):
        kernel.call_at(time, lambda key=(time, phase, number): log.append(key), phase)
    kernel.run_until(50)
    assert log == sorted(log) and len(log) == len(asked) == kernel.events
    assert TIMER < PADS < CHIP < CPU < PROBE


class Diary(Agent):
    """Notes when it acted, and under which tag."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.notes: list[tuple[int, int]] = []

    def act(self, tag: int) -> None:
        self.notes.append((self.kernel.now, tag))


def test_an_agent_acts_under_the_tags_it_asked_for():
    kernel = Kernel()
    diary = Diary(kernel)
    for time, tag in ((7, 1), (3, 2), (7, 0)):
        kernel.schedule(time, diary, tag)
    kernel.run_until(10)
    assert diary.notes == [(3, 2), (7, 1), (7, 0)]


def test_a_promise_that_was_kept_stays_kept_and_takes_no_other_with_it():
    kernel = Kernel()
    diary = Diary(kernel)
    kept = kernel.schedule(3, diary)
    kernel.schedule(5, diary, 1)
    kernel.run_until(4)
    kernel.cancel(kept)
    kernel.run_until(10)
    assert diary.notes == [(3, 0), (5, 1)]


@given(st.lists(st.tuples(st.integers(0, 20), st.booleans()), max_size=30))
def test_cancelled_ones_alone_are_left_out(asked):
    kernel = Kernel()
    diary = Diary(kernel)
    events = [kernel.schedule(time, diary, number) for number, (time, _) in enumerate(asked)]
    for event, (_, taken_back) in zip(events, asked, strict=True):
        if taken_back:
            kernel.cancel(event)
    kernel.run_until(20)
    left = [(time, number) for number, (time, taken_back) in enumerate(asked) if not taken_back]
    assert diary.notes == sorted(left) and kernel.events == len(left)


@given(st.lists(st.tuples(st.integers(0, 3), st.booleans(), st.integers(0, 5)), min_size=1, max_size=30))
def test_a_renewed_promise_has_its_place_like_a_new_one(asked):
    """One agent renews its only event, whether kept or taken back; another one asks anew each time."""
    logs = []
    for renews in (True, False):
        kernel, log = Kernel(), Diary(Kernel())
        log.kernel = kernel
        event = kernel.schedule(0, log, -1, CHIP)
        kernel.run_until(0)
        for number, (delay, taken_back, run) in enumerate(asked):
            if renews:
                kernel.reschedule(event, kernel.now + delay, number)
            else:
                event = kernel.schedule(kernel.now + delay, log, number, CHIP)
            kernel.schedule(kernel.now + delay, log, 100 + number, TIMER if number % 2 else CHIP)
            if taken_back:
                kernel.cancel(event)
            kernel.run_until(kernel.now + max(run, delay))
        logs.append(log.notes)
    assert logs[0] == logs[1]


def test_a_promise_still_to_come_is_not_renewed():
    kernel = Kernel()
    event = kernel.schedule(3, Diary(kernel))
    with pytest.raises(ValueError, match=r"Diary: cannot schedule at t=5 an event that is already queued for t=3"):
        kernel.reschedule(event, 5, 0)
    kernel.run_until(4)
    with pytest.raises(ValueError, match=r"Diary: cannot schedule an event at t=3, because it is already t=4"):
        kernel.reschedule(event, 3, 0)
    kernel.reschedule(event, 4, 0)
    assert kernel.next_time() == 4


class Party(SampledParty):
    """Notes its rank when told, and what else it then asks for."""

    def __init__(self, kernel: Kernel, log: list[int]) -> None:
        self.due = self.plain = False
        self.rank = kernel.rank()
        self.log = log
        self.then: list[Party] = []
        self.kernel = kernel

    def deliver(self, now: int) -> None:
        self.log.append(self.rank)
        for party in self.then:
            self.kernel.request_sample(party)
        self.then = []


class Line(Settleable):
    """Notes its rank, negative, as it settles; has these parties told."""

    def __init__(self, kernel: Kernel, log: list[int], tells: list[Party]) -> None:
        self.rank = kernel.rank()
        self.kernel, self.log, self.tells = kernel, log, tells

    def settle(self) -> None:
        self.log.append(-self.rank)
        for party in self.tells:
            self.kernel.request_sample(party)


@given(st.permutations(range(4)), st.permutations(range(5)), st.permutations(range(6)), st.integers(0, 4))
def test_wires_settle_by_rank_and_parties_are_told_by_rank_and_then_as_wires_move(lines, asked, told, split):
    """`asked` ask by themselves; the wires have `told` told, each its own, in the order in which the wires settle."""
    kernel, log = Kernel(), []
    parties = [Party(kernel, log) for _ in range(11)]
    wires = [Line(kernel, log, [parties[5 + one] for one in told[i::4]]) for i in range(4)]
    late = parties[:split]
    parties[5].then = [parties[i] for i in asked if parties[i] in late]
    for one in lines:
        kernel.moved(wires[one])
    for one in asked:
        if parties[one] not in late:
            kernel.request_sample(parties[one])
            kernel.request_sample(parties[one])
    kernel.settle()
    by_rank = [party.rank for party in parties[split:5]]
    by_wires = [5 + one + 1 for i in range(4) for one in told[i::4]]
    assert log == [-12, -13, -14, -15, *by_rank, *by_wires, *(party.rank for party in late)]


def test_an_agent_that_does_not_say_what_it_does_is_named():
    class Lazy(Agent):
        pass

    kernel = Kernel()
    kernel.schedule(1, Lazy())
    with pytest.raises(NotImplementedError, match="Lazy schedules events but does not define act"):
        kernel.run_until(1)


def test_the_past_is_refused_with_who_asked():
    kernel = Kernel(100)
    with pytest.raises(
        ValueError, match=r"test_the_past.*cannot schedule an event at t=50, because it is already t=100"
    ):
        kernel.call_at(50, lambda: None)
    with pytest.raises(ValueError, match="already t=100"):
        kernel.run_until(99)


def test_a_run_ends_with_its_last_tick_and_not_before():
    kernel, log = Kernel(), []
    kernel.call_at(10, lambda: log.append(10))
    kernel.call_at(11, lambda: log.append(11))
    kernel.run_until(10)
    assert log == [10] and kernel.now == 10 and kernel.next_time() == 11


def test_stop_ends_a_run_in_the_present_event():
    kernel = Kernel()
    kernel.call_at(3, kernel.stop)
    kernel.call_at(4, lambda: pytest.fail("the run was stopped"))
    kernel.run_until(10)
    assert kernel.now == 3


def test_a_lease_ends_at_the_next_event_or_after_the_horizon():
    kernel, seen = Kernel(), []
    kernel.call_at(2, lambda: seen.append(kernel.quiet_until()))
    kernel.call_at(7, lambda: seen.append(kernel.quiet_until()))
    kernel.run_until(20)
    assert seen == [7, 21]


def test_a_storm_inside_one_tick_is_told():
    kernel = Kernel()

    def again() -> None:
        kernel.call_at(kernel.now, again)

    kernel.call_at(1, again)
    with pytest.raises(SimulationStuck, match=rf"{STORM} events at t=1 without time passing.*again"):
        kernel.run_until(2)


class Waits(Agent):
    """Waits in the middle of its turn for the turn that it asks for at `until`, and notes how that came out."""

    def __init__(self, kernel: Kernel, until: int) -> None:
        self.kernel, self.until = kernel, until
        self.came: list[tuple[bool, int]] = []

    def act(self, tag: int) -> None:
        if tag:
            self.kernel.released = True
        else:
            self.kernel.schedule(self.until, self, 1)
            helped = self.kernel.run_nested(self)
            self.came.append((helped, self.kernel.now))


def test_who_waits_in_the_middle_of_a_turn_does_what_is_due_until_it_is_released():
    kernel = Kernel()
    waits, diary = Waits(kernel, 20), Diary(kernel)
    kernel.schedule(10, waits)
    for time in (12, 20, 25):
        kernel.schedule(time, diary, time)
    kernel.run_until(30)
    assert waits.came == [(True, 20)] and diary.notes == [(12, 12), (20, 20), (25, 25)]
    assert kernel.events == 5 and kernel.nested_owner is None


def test_what_is_due_after_the_end_of_the_run_is_left_by_a_helper():
    kernel = Kernel()
    waits = Waits(kernel, 40)
    kernel.schedule(10, waits)
    kernel.run_until(30)
    assert waits.came == [(False, 10)] and kernel.next_time() == 40 and kernel.now == 30


def test_a_plain_function_is_not_called_in_the_turn_of_a_helper():
    kernel, log = Kernel(), []
    waits = Waits(kernel, 20)
    kernel.schedule(10, waits)
    kernel.call_at(15, lambda: log.append(kernel.nested_owner))
    kernel.run_until(30)
    assert waits.came == [(False, 10)] and log == [None]


def test_events_of_one_instant_keep_their_order_whoever_does_them():
    """What an event moves settles before those of a later phase, also where a helper did the one and not the other."""
    kernel = Kernel()
    waits, diary = Waits(kernel, 10), Diary(kernel)
    for tag, phase in ((3, PROBE), (2, CPU), (1, PADS)):
        kernel.schedule(10, diary, tag, phase)
    kernel.schedule(10, waits)
    kernel.run_until(10)
    assert diary.notes == [(10, 1), (10, 2), (10, 3)] and waits.came == [(True, 10)]
