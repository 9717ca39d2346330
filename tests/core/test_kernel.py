"""Events are ordered by time, phase and order of scheduling; wires settle at the end of each phase."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.agent import Agent, SampledParty, Settleable
from periph_sim.core.kernel import CHIP, CPU, PADS, PROBE, STORM, TIMER, Kernel, SimulationStuck


@given(st.lists(st.tuples(st.integers(0, 50), st.sampled_from([TIMER, PADS, CHIP, CPU, PROBE])), max_size=40))
def test_events_run_in_the_order_of_their_keys(scheduled):
    kernel, log = Kernel(), []
    for number, (time, phase) in enumerate(scheduled):
        kernel.call_at(time, lambda key=(time, phase, number): log.append(key), phase)
    kernel.run_until(50)
    assert log == sorted(log) and len(log) == len(scheduled) == kernel.events
    assert TIMER < PADS < CHIP < CPU < PROBE


class EventLog(Agent):
    """Agent that logs the time and the tag of each of its events."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.notes: list[tuple[int, int]] = []

    def act(self, tag: int) -> None:
        self.notes.append((self.kernel.now, tag))


def test_an_agent_acts_with_the_tags_that_it_scheduled():
    kernel = Kernel()
    log = EventLog(kernel)
    for time, tag in ((7, 1), (3, 2), (7, 0)):
        kernel.schedule(time, log, tag)
    kernel.run_until(10)
    assert log.notes == [(3, 2), (7, 1), (7, 0)]


def test_cancelling_an_event_that_has_run_cancels_no_other():
    kernel = Kernel()
    log = EventLog(kernel)
    kept = kernel.schedule(3, log)
    kernel.schedule(5, log, 1)
    kernel.run_until(4)
    kernel.cancel(kept)
    kernel.run_until(10)
    assert log.notes == [(3, 0), (5, 1)]


@given(st.lists(st.tuples(st.integers(0, 20), st.booleans()), max_size=30))
def test_all_events_but_the_cancelled_ones_run(scheduled):
    kernel = Kernel()
    log = EventLog(kernel)
    events = [kernel.schedule(time, log, number) for number, (time, _) in enumerate(scheduled)]
    for event, (_, cancelled) in zip(events, scheduled, strict=True):
        if cancelled:
            kernel.cancel(event)
    kernel.run_until(20)
    left = [(time, number) for number, (time, cancelled) in enumerate(scheduled) if not cancelled]
    assert log.notes == sorted(left) and kernel.events == len(left)


@given(st.lists(st.tuples(st.integers(0, 3), st.booleans(), st.integers(0, 5)), min_size=1, max_size=30))
def test_a_rescheduled_event_is_ordered_like_a_new_one(scheduled):
    """One run reschedules a single event, whether it has run or was cancelled; the other schedules new events."""
    logs = []
    for reschedules in (True, False):
        kernel, log = Kernel(), EventLog(Kernel())
        log.kernel = kernel
        event = kernel.schedule(0, log, -1, CHIP)
        kernel.run_until(0)
        for number, (delay, cancelled, run) in enumerate(scheduled):
            if reschedules:
                kernel.reschedule(event, kernel.now + delay, number)
            else:
                event = kernel.schedule(kernel.now + delay, log, number, CHIP)
            kernel.schedule(kernel.now + delay, log, 100 + number, TIMER if number % 2 else CHIP)
            if cancelled:
                kernel.cancel(event)
            kernel.run_until(kernel.now + max(run, delay))
        logs.append(log.notes)
    assert logs[0] == logs[1]


def test_a_queued_event_cannot_be_rescheduled():
    kernel = Kernel()
    event = kernel.schedule(3, EventLog(kernel))
    with pytest.raises(ValueError, match=r"EventLog: cannot schedule at t=5 an event that is already queued for t=3"):
        kernel.reschedule(event, 5, 0)
    kernel.run_until(4)
    with pytest.raises(ValueError, match=r"EventLog: cannot schedule an event at t=3, because it is already t=4"):
        kernel.reschedule(event, 3, 0)
    kernel.reschedule(event, 4, 0)
    assert kernel.next_time() == 4


class Party(SampledParty):
    """Sampled party that logs its rank when notified and then requests samples for `then`."""

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
    """Wire that logs its negated rank when it settles and then requests samples for its parties."""

    def __init__(self, kernel: Kernel, log: list[int], parties: list[Party]) -> None:
        self.rank = kernel.rank()
        self.kernel, self.log, self.parties = kernel, log, parties

    def settle(self) -> None:
        self.log.append(-self.rank)
        for party in self.parties:
            self.kernel.request_sample(party)


@given(st.permutations(range(4)), st.permutations(range(5)), st.permutations(range(6)), st.integers(0, 4))
def test_wires_settle_by_rank_and_parties_are_notified_by_rank_then_in_settling_order(lines, own, requested, split):
    """`own`: parties that request their own sample; `requested`: parties for which a settling wire requests it."""
    kernel, log = Kernel(), []
    parties = [Party(kernel, log) for _ in range(11)]
    wires = [Line(kernel, log, [parties[5 + one] for one in requested[i::4]]) for i in range(4)]
    late = parties[:split]
    parties[5].then = [parties[i] for i in own if parties[i] in late]
    for one in lines:
        kernel.moved(wires[one])
    for one in own:
        if parties[one] not in late:
            kernel.request_sample(parties[one])
            kernel.request_sample(parties[one])
    kernel.settle()
    by_rank = [party.rank for party in parties[split:5]]
    by_wires = [5 + one + 1 for i in range(4) for one in requested[i::4]]
    assert log == [-12, -13, -14, -15, *by_rank, *by_wires, *(party.rank for party in late)]


def test_the_error_of_an_agent_without_act_names_it():
    class Lazy(Agent):
        pass

    kernel = Kernel()
    kernel.schedule(1, Lazy())
    with pytest.raises(NotImplementedError, match="Lazy schedules events but does not define act"):
        kernel.run_until(1)


def test_scheduling_in_the_past_is_refused_with_the_name_of_the_caller():
    kernel = Kernel(100)
    with pytest.raises(
        ValueError, match=r"test_scheduling_in_the_past.*cannot schedule an event at t=50, because it is already t=100"
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


def test_quiet_until_is_the_next_event_or_the_tick_after_the_run():
    kernel, seen = Kernel(), []
    kernel.call_at(2, lambda: seen.append(kernel.quiet_until()))
    kernel.call_at(7, lambda: seen.append(kernel.quiet_until()))
    kernel.run_until(20)
    assert seen == [7, 21]


def test_endless_events_within_one_tick_end_the_run():
    kernel = Kernel()

    def again() -> None:
        kernel.call_at(kernel.now, again)

    kernel.call_at(1, again)
    with pytest.raises(SimulationStuck, match=rf"{STORM} events at t=1 without time passing.*again"):
        kernel.run_until(2)


class NestedAgent(Agent):
    """Agent that runs a nested loop inside its event until its next event, at `until`, releases it.

    results: for each nested loop, whether the wait was over at its end, and the time.
    """

    def __init__(self, kernel: Kernel, until: int) -> None:
        self.kernel, self.until = kernel, until
        self.results: list[tuple[bool, int]] = []

    def act(self, tag: int) -> None:
        if tag:
            self.kernel.released = True
        else:
            self.kernel.schedule(self.until, self, 1)
            released = self.kernel.run_nested(self)
            self.results.append((released, self.kernel.now))


def test_a_nested_loop_runs_due_events_until_it_is_released():
    kernel = Kernel()
    waits, log = NestedAgent(kernel, 20), EventLog(kernel)
    kernel.schedule(10, waits)
    for time in (12, 20, 25):
        kernel.schedule(time, log, time)
    kernel.run_until(30)
    assert waits.results == [(True, 20)] and log.notes == [(12, 12), (20, 20), (25, 25)]
    assert kernel.events == 5 and kernel.nested_owner is None


def test_a_nested_loop_leaves_events_after_the_end_of_the_run():
    kernel = Kernel()
    waits = NestedAgent(kernel, 40)
    kernel.schedule(10, waits)
    kernel.run_until(30)
    assert waits.results == [(False, 10)] and kernel.next_time() == 40 and kernel.now == 30


def test_a_nested_loop_does_not_call_plain_functions():
    kernel, log = Kernel(), []
    waits = NestedAgent(kernel, 20)
    kernel.schedule(10, waits)
    kernel.call_at(15, lambda: log.append(kernel.nested_owner))
    kernel.run_until(30)
    assert waits.results == [(False, 10)] and log == [None]


def test_events_of_one_tick_keep_their_order_in_nested_and_outer_loops():
    """Wires settle between phases even if the nested loop runs the events of one phase and the outer loop the next."""
    kernel = Kernel()
    waits, log = NestedAgent(kernel, 10), EventLog(kernel)
    for tag, phase in ((3, PROBE), (2, CPU), (1, PADS)):
        kernel.schedule(10, log, tag, phase)
    kernel.schedule(10, waits)
    kernel.run_until(10)
    assert log.notes == [(10, 1), (10, 2), (10, 3)] and waits.results == [(True, 10)]
