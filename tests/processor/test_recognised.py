"""From the second wait on, a comparison of one field with a number is evaluated without Python; results are equal."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.records import EVERYWHERE, NOWHERE, OF_MODIFIES, Kind, Recorder, RecordSink
from periph_sim.processor.python.waits import Recogniser
from tests.processor.bench import Bench


@pytest.fixture(autouse=True)
def untraced(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pretend that nothing traces the lines: with a tracer each pass calls the function, so that it can be seen."""
    monkeypatch.setattr(sys, "gettrace", lambda: None)


flag_changes = st.lists(
    st.tuples(st.integers(1, 800), st.integers(0, 7), st.sampled_from([-1, -1, -1, 0])), min_size=1, max_size=20
)


class Kept(RecordSink):
    """A sink that keeps all records, and requests the places of the accesses selected by `places`."""

    def __init__(self, places: int) -> None:
        self.found: list[object] = []
        self._topics: list[object] = []
        self._places = places

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        self._topics.append((kind, where, what))
        return len(self._topics) - 1

    def places(self, tag: int) -> int:
        return self._places

    def keep(self, tag: int, number: int, tick: int, value: int, text: str, cause: int, field: str) -> None:
        self.found.append((tick, self._topics[tag], number, value, cause, str(text), field))


def run_of(changes, lead, form, interrupts, timeout, kinds, places=None):
    """Run firmware that waits by functions; return its log, events, skipped polls and records.

    form: applied to each condition; `partial` gives an object that is not recognised.
    places: the accesses whose places a sink of the records requests; None for a subscriber of whole records.
    """
    recorder, found = Recorder(), []
    if kinds and places is None:
        recorder.subscribe(kinds, lambda r: found.append((r.tick, r.kind, r.what, r.value, r.cause, str(r.text))))
    elif kinds:
        kept = Kept(places)
        found = kept.found
        recorder.subscribe(kinds, kept)
    bench = Bench(list(changes), recorder=recorder)
    flags, cpu = bench.flags, bench.cpu

    def isr() -> None:
        cpu.compute(9)
        bench.waits.spin(form(lambda: flags.STATUS.A != 1), timeout=30)
        bench.pie_regs.PIEACK.all = 1
        bench.note("served")

    cpu.program.handle("SEQ1INT", isr)
    if interrupts:
        bench.enable()

    def main() -> None:
        cpu.compute(lead)
        while True:
            bench.waits.spin(form(lambda: flags.STATUS.A == 1), timeout=timeout)
            bench.note("A")
            bench.waits.spin_either(form(lambda: flags.STATUS.B > 0), form(lambda: flags.STATUS.A < 1))
            bench.note("B")
            bench.waits.spin(form(lambda: flags.STATUS.all == 4), timeout=timeout)
            flags.STATUS.C = 1

    log = bench.run(main, 1200)
    return log, bench.kernel.events, cpu.program.polls_skipped, found


@settings(max_examples=120, deadline=None)
@given(
    changes=flag_changes,
    lead=st.integers(0, 40),
    interrupts=st.booleans(),
    timeout=st.sampled_from([21, 40, 100]),
    kinds=st.sampled_from([(), (Kind.WAIT, Kind.FLAG), (Kind.ACCESS, Kind.WAIT, Kind.IRQ), (Kind.ACCESS,)]),
    places=st.sampled_from([None, NOWHERE, OF_MODIFIES]),
)
def test_recognised_functions_give_the_results_of_calling_them_in_each_pass(
    changes, lead, interrupts, timeout, kinds, places
):
    runs = [run_of(changes, lead, form, interrupts, timeout, kinds, places) for form in (lambda f: f, partial)]
    recognised, called = runs
    assert recognised == called


def second_wait(function, bench: Bench):
    """Return the condition made of a function at its second use, after its register has been used once."""
    recogniser = Recogniser(bench.cpu.program)
    assert recogniser.condition(function) is None
    bench.flags.STATUS, bench.flags.COUNT  # noqa: B018
    return recogniser.condition(function)


def test_comparisons_of_one_field_with_a_number_are_recognised():
    bench = Bench([])
    flags = bench.flags
    for function in (
        lambda: flags.STATUS.A == 1,
        lambda: flags.STATUS.A != 0,
        lambda: flags.STATUS.B < 1,
        lambda: flags.STATUS.B > 0,
        lambda: flags.STATUS.all == 7,
    ):
        assert second_wait(function, bench) is not None


def test_other_functions_are_not_recognised():
    bench = Bench([])
    flags, other, seen = bench.flags, SimpleNamespace(STATUS=bench.flags.STATUS), []
    for function in (
        lambda: flags.STATUS.A,
        lambda: flags.STATUS.A == 1 or flags.STATUS.B == 1,
        lambda: 1 == flags.STATUS.A,  # noqa: SIM300
        lambda: flags.STATUS.A >= 1,
        lambda: flags.STATUS.A == True,  # noqa: E712
        lambda: flags.STATUS.A == 2,  # never holds: Python must report that
        lambda: flags.STATUS.nothing == 1,
        lambda: flags.COUNT.N == 1,  # a read clears it
        lambda: other.STATUS.A == 1,
        lambda: (seen.append(1), flags.STATUS.A == 1)[1],
        lambda level=1: level == flags.STATUS.A,
        bench.flags.STATUS.when(A=1),
    ):
        assert second_wait(function, bench) is None


@pytest.mark.parametrize(
    ("places", "fields", "whole"), [(NOWHERE, True, True), (OF_MODIFIES, True, False), (None, False, False)]
)
def test_recognition_depends_on_the_places_that_subscribers_request(places, fields, whole):
    recorder = Recorder()
    recorder.subscribe([Kind.ACCESS], (lambda record: None) if places is None else Kept(places))
    bench = Bench([], recorder=recorder)
    flags = bench.flags
    whole_records = places is None  # such a subscriber may examine the state, so Python must make the passes
    assert (second_wait(lambda: flags.STATUS.A == 1, bench) is None) is whole_records
    assert (second_wait(lambda: flags.STATUS.all == 1, bench) is None) is whole_records
    bench.cpu.program.placed = lambda: None
    assert (second_wait(lambda: flags.STATUS.A == 1, bench) is not None) is fields
    assert (second_wait(lambda: flags.STATUS.all == 1, bench) is not None) is whole


def test_a_recognised_read_is_recorded_with_its_line_in_the_firmware():
    recorder, kept = Recorder(), Kept(EVERYWHERE)
    recorder.subscribe([Kind.ACCESS], kept)
    bench = Bench([(400, 1, -1)], recorder=recorder)

    def polls():
        for _ in range(3):
            bench.waits.spin(
                lambda: (
                    flags.STATUS.A  # here
                    == 1
                ),
                timeout=30,
            )

    flags = bench.flags
    bench.run(polls, 600)
    lines = Path(__file__).read_text("utf-8").splitlines()
    line = next(n for n, text in enumerate(lines, 1) if text.endswith("STATUS.A  # here"))
    found = [text for *_, text, _ in kept.found]
    assert len(found) == 3 and set(found) == {f"<lambda>:{line}"}


def test_a_recognised_function_uses_the_current_value_of_its_variable():
    one, two = Bench([]), Bench([])
    recogniser, found = Recogniser(one.cpu.program), []

    def asks(flags):
        return lambda: flags.STATUS.A == 1

    for bench in (one, two, two, one):
        bench.flags.STATUS  # noqa: B018
        found.append(recogniser.condition(asks(bench.flags)))
    assert found[0] is None and found[1] is found[2] is not None and found[3] is not found[1]


def test_a_function_with_an_unbound_variable_is_not_recognised():
    recogniser = Recogniser(Bench([]).cpu.program)

    def asks():
        function = lambda: flags.STATUS.A == 1  # noqa: E731
        assert recogniser.condition(function) is None
        assert recogniser.condition(function) is None
        with pytest.raises(NameError):
            function()
        flags = Bench([]).flags
        return flags

    asks()
